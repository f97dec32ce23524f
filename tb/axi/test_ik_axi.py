# SPDX-License-Identifier: Apache-2.0
"""Job tests of ``ik_axi``: results, accessed addresses, bursts, joint limits, counters and throughput.

The pytest cases also run faults.py and registers.py, at several parameter sets; `make soak-memory` runs more jobs.
"""

import json
import os
from pathlib import Path

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles

from model.io.stimuli import arm_limits
from model.io.trajectories import make
from model.io.words import to_words
from tb.axi.bench import ARM, BURSTS, BYTES, CHANNELS, LAYOUT, Bench, bench_test
from tb.axi.instances import CORE, ECHO, FOLDED, echoing, named
from tb.sim.env import simulator
from tb.sim.shared import passes
from tb.sim.timeout import timed_test

JOBS = int(os.environ.get("IK_AXI_JOBS", "120"))
"""Random jobs: half without pauses, half with pauses on all channels. JOBS // 20 more pause one memory channel each."""

BASE = 0x40000 - 512  # base address of the areas; the smallest tested instance has an address space of 1 MiB

QUICKEST = 2  # clocks from AR accepted to the first R beat for a memory without added latency

BATCH, LONG = 100, 600
"""Numbers of targets of the timed jobs. The trajectory `reach` has 100 targets; the long job repeats it."""


def bursts(address: int, count: int, bench: Bench) -> list[tuple[int, int]]:
    """Return the expected bursts of ``count`` records from ``address`` on, each as (address, beats)."""
    expected = []
    while count:
        size = min(count, bench.per_burst - address // BYTES % bench.per_burst)
        expected.append((address, size * bench.beats))
        address, count = address + size * BYTES, count - size
    return expected


@bench_test()
async def one_record(bench):
    await bench.solve(BASE, BASE + 0x2000, 1)
    await bench.solve(BASE + BYTES, BASE, 1, first=1)


@bench_test()
async def edges_of_bursts(bench):
    """Run jobs that start and end at, before and after a burst boundary, with various alignments of the destination."""
    whole = bench.per_burst
    for k, skip in enumerate((0, 1, whole - 1)):
        for count in (1, 2, whole - 1, whole, whole + 1, 2 * whole + 1):
            source, destination = 0x8000 + skip * BYTES, 0x20000 + (k * count + count) % whole * BYTES
            bench.monitor.bursts = {"ar": [], "aw": []}
            await bench.solve(source, destination, count, first=count)
            wanted = {"ar": bursts(source, count, bench), "aw": bursts(destination, count, bench)}
            assert bench.monitor.bursts == wanted, f"{count} records: {bench.monitor.bursts}, expected {wanted}"


@bench_test()
async def pages(bench):
    """Run a job whose areas start just below a 4 KiB boundary and cross several more."""
    await bench.solve(0x10000 - BYTES, 0x20000 - 3 * BYTES, 300)
    assert len(bench.monitor.bursts["ar"]) >= 300 // bench.per_burst


@bench_test()
async def neighbours(bench):
    """Run jobs on adjacent areas, in either order, and on areas at opposite ends of the address space."""
    count, end = 2 * bench.per_burst + 3, 1 << bench.addr_width
    size = count * BYTES
    for source, destination in ((0x3000, 0x3000 + size), (0x3000 + size, 0x3000), (0, end - size), (end - size, 0)):
        await bench.solve(source, destination, count)


@cocotb.parametrize(stalled=["none", "all", *CHANNELS[:-1]])
@timed_test(10 + JOBS)
async def many_jobs(dut, stalled):
    """Run random jobs, mostly small, on disjoint areas, with pauses on no channel, all channels or one memory channel.

    Append the numbers of jobs and records to the file named by IK_AXI_DONE.
    """
    bench = Bench(dut, seed=2, latency=len(stalled) % 3 * 7)
    await bench.reset()
    jobs, solved = JOBS // 2, 0
    if stalled == "all":
        bench.stall(*CHANNELS)
    elif stalled != "none":
        bench.stall(stalled, share=0.7)
        jobs = JOBS // 20
    numbers = bench.random
    limit = min(1 << bench.addr_width, 1 << 40) // BYTES
    for _ in range(jobs):
        count = numbers.choice((numbers.randint(1, 12), numbers.randint(1, 40), numbers.randint(1, 120)))
        source = destination = 0
        while abs(source - destination) < count:
            if numbers.random() < 0.3:  # close together
                source = numbers.randint(200, limit - 400)
                destination = source + numbers.choice((-1, 1)) * (count + numbers.randint(0, 3))
            else:
                source, destination = (numbers.randint(8, limit - 200) for _ in range(2))
        await bench.solve(source * BYTES, destination * BYTES, count, first=numbers.randrange(bench.pool))
        solved += count
    bench.check()
    if path := os.environ.get("IK_AXI_DONE"):
        with Path(path).open("a") as file:
            file.write(f"{jobs} {solved}\n")


async def limits(bench):
    """over_limit depends only on the W high bits of each limit register; the other bits are random."""
    numbers, low = bench.random, 32 - bench.width
    half = 1 << bench.width - 1
    for limits in (arm_limits(bench.width), [tuple(numbers.choices(range(-half, half), k=2)) for _ in range(7)]):
        bench.limits = limits
        for k, ends in enumerate(bench.limits, start=1):
            for name, end in zip(("LOW", "HIGH"), ends, strict=True):
                await bench.write(f"LIMIT_{name}{k}", end % (2 * half) << low | numbers.getrandbits(low))
        bench.results, bench.flags, bench.tags = bench.answers(bench.records)
        seen = np.bitwise_or.reduce(bench.flags[:60])
        assert seen >> 8 == 255 or seen >> 8 == 127, f"flags {seen:#x}: a joint is never over its limits"
        await bench.solve(BASE, BASE + 0x8000, 60)


if ARM and os.environ.get("IK_AXI_CORE") != "echo":  # COCOTB_TEST_FILTER runs skipped tests as well
    limits = bench_test(seed=11)(limits)


@cocotb.parametrize(blocked=["r", "aw", "w", "b"])
@bench_test()
async def blocked_channel(bench, blocked):
    """Block one channel: requests never exceed the FIFO slots or the burst limit. Release it: all results are right."""
    count = bench.places + 12 * bench.per_burst
    destination = 0x80000
    for name in ("ar", "aw", "b"):
        bench.channel(name).queue_occupancy_limit = 64  # accept every request
    bench.channel(blocked).pause = True
    await bench.start(0x40000, destination, count, first=0)
    clocks = 30 * bench.places + 4 * count * bench.beats // bench.per_burst + (bench.lap - 1) * count
    await ClockCycles(bench.dut.clk, clocks)
    assert bench.dut.u_job.busy.value == 1
    most = dict(bench.monitor.most)
    assert most["reads"] <= BURSTS and most["writes"] <= BURSTS, f"{most}"
    assert most["places"] <= bench.places + 1, f"{most}"  # one record may be on W
    if blocked == "r":
        assert most["reads"] == min(BURSTS, bench.places // bench.per_burst), f"{most}"
    else:  # every allowed request has been made
        assert blocked != "b" or most["writes"] == BURSTS, f"{most}"
        records = sum(beats for _, beats in bench.monitor.bursts["ar"]) // bench.beats
        limit = bench.places + 1 + {"aw": 10, "w": 0, "b": BURSTS}[blocked] * bench.per_burst
        assert bench.places - bench.per_burst < records <= limit, f"{records} records requested, limit {limit}"
    bench.channel(blocked).pause = False
    assert (await bench.ended())["done"] == 1
    bench.compare(destination, 0, count)


@bench_test(latency=20)
async def counters(bench):
    """CLOCKS counts busy clocks; the stall counters count clocks in which a beat is due but not transferred."""
    await bench.solve(0x4000, 0x8000, 20)
    assert await bench.read("READ_STALLS") >= 20 and await bench.read("WRITE_STALLS") == 0
    bench.stall("w", share=0.8)
    busy = [0]

    async def count():
        while True:
            await ClockCycles(bench.dut.clk, 1)
            busy[0] += int(bench.dut.u_job.busy.value)

    watch = cocotb.start_soon(count())
    await bench.solve(0x4000, 0x8000, 60)
    watch.cancel()
    clocks, waited = await bench.read("CLOCKS"), await bench.read("WRITE_STALLS")
    assert abs(clocks - busy[0]) <= 1, f"{clocks} counted, busy for {busy[0]}"
    assert 60 < waited < clocks


@cocotb.parametrize(latency=[QUICKEST + more for more in (0, 16, 32, 64, 128)])
@timed_test()
async def rates(dut, latency):
    """Check that without added latency, the read bus (with a folded core: the core) is busy at least 95 % of the time.
    Append a row to the file named by IK_AXI_RATES. ``latency`` is the number of clocks from AR accepted to the first R
    beat; B has the same added latency."""
    words = None if ARM else to_words(make("reach"), 32)[0]
    bench = Bench(dut, latency=latency - QUICKEST, words=words)
    await bench.reset()
    assert ARM or bench.pool == BATCH
    clocks = {}
    for count in (1, BATCH):
        await bench.solve(0x40000, 0x80000, count)
        clocks[count] = await bench.read("CLOCKS")
    results = LAYOUT.result_words(bench.memory.read(0x80000, BATCH * BYTES), bench.width)
    bench.monitor.beats = {"ar": [], "r": []}
    await bench.solve(0x40000, 0x80000, LONG)
    bench.check()
    requested, beats = bench.monitor.beats.values()
    assert beats[0] - requested[0] == latency, f"{beats[0] - requested[0]} clocks to the first beat, expected {latency}"
    span = beats[-1] - beats[0] + 1
    share = max(len(beats), (bench.lap > 1) * bench.lap * LONG) / span
    if path := os.environ.get("IK_AXI_RATES"):
        row = {"whole": bench.per_burst, "latency": latency, "share": share, "each": span / LONG}
        row |= {"first": clocks[1], "last": clocks[BATCH], "results": results.tolist()}
        with Path(path).open("a") as file:
            file.write(json.dumps(row) + "\n")
    assert latency > QUICKEST or share >= 0.95, f"{share:.3f} of bus or core for {LONG * BYTES} bytes"


MODULES = "tb.axi.test_ik_axi,tb.axi.faults,tb.axi.registers"
FEW = "one_record|limits|stalled=(none|all)"
ICARUS = simulator() == "icarus"
MANY_RECORDS = "pages|rates|stalled=(ar|r|aw|w|b)$"
"""Tests with many records. Icarus skips them: Verilator is ten times faster, and the other tests cover X."""
SAME = "every_field|pulses|strobes|unmapped_address|rates/latency=(18|66|130)"
"""Tests that do not depend on parameters: only one instance for wrist targets and one for hand poses run them."""


def run(parameters: dict[str, int], jobs: int, tests: str, core: str = "core", **options) -> None:
    """Run cocotb tests on an instance, with ``jobs`` random jobs; Icarus, which is slow, runs at most 10."""
    jobs, faults = (min(jobs, 10), 3) if ICARUS else (jobs, max(8, jobs // 20))
    env = {"IK_AXI_JOBS": str(jobs), "IK_AXI_FAULTS": str(faults), "IK_AXI_CORE": core, "COCOTB_TEST_FILTER": tests}
    label = f"ik_axi-{core}-{named(parameters)}"
    passes(label, toplevel="ik_axi", module=MODULES, parameters=parameters, env=env, **options)


@pytest.mark.sim
@pytest.mark.bench("ik_axi", without=("ik_axis", "ik_arm"))
@pytest.mark.cost(40)
@pytest.mark.parametrize(
    "parameters",
    ECHO[:1] if ICARUS else [*ECHO[:4], *(pytest.param(one, marks=pytest.mark.slow) for one in ECHO[4:])],
    ids=named,
)
def test_around_the_core(tmp_path, parameters):
    """Run tests with an echo in place of the datapath; Icarus runs only the short ones, on one instance."""
    left_out = MANY_RECORDS if ICARUS else SAME if parameters not in (ECHO[0], ECHO[3]) else ""
    tests = f"^(?!.*({left_out}))" if left_out else ""
    jobs = 80 if parameters == ECHO[0] else 30
    run(parameters, jobs, tests, "echo", **echoing(tmp_path))


@pytest.mark.sim
@pytest.mark.cost(20)
@pytest.mark.parametrize(
    "parameters", [CORE[0], *(pytest.param(one, marks=pytest.mark.slow) for one in (*CORE[1:], *FOLDED))], ids=named
)
def test_with_the_core(parameters):
    """Run a few tests with the real datapaths. Icarus runs fewer: it would take minutes for ARM = 1 at W = 32."""
    few = "one_record|limits" if parameters == CORE[-1] else FEW
    tests = f"{FEW}|latency=2$"
    if parameters in FOLDED:  # targets wait in front of the core
        tests += "|blocked_channel|soft_reset/|reset_during|bus_errors|after_a_reset"
    run(parameters, 8 if parameters in FOLDED else 20, few if ICARUS else tests)

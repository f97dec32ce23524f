# SPDX-License-Identifier: Apache-2.0
"""Stream tests of ``ik_axis`` and ``ik_arm``: stalls on both sides, tags, order, rate, latency, reset during traffic.

Each test compares every result, tag and flag with the bit-true model. Some also compare every node, which takes most
of their simulation time. tb/axi/rules checks the AXI4-Stream rules in every clock. Each cocotb test is a pytest case;
all cases of a parameter set share one build and simulation.
"""

import os
import re
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from functools import partial

import cocotb
import numpy as np
import pytest
from cocotb import regression
from cocotb.triggers import ClockCycles, FallingEdge, Timer

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.fold.program import program
from tb.core.functional_coverage import STALLS, every_kind
from tb.core.pipeline import PATTERNS, Pipeline, bursts
from tb.sim.env import simulator
from tb.sim.shared import Shared
from tb.sim.timeout import timed_test


@asynccontextmanager
async def started(dut, nodes: bool = False) -> AsyncIterator[Pipeline]:
    """Yield the bench after reset; at the end, wait for all results and check the bench. With ``nodes`` the bench
    compares every node, not only the results."""
    bench = Pipeline(dut, nodes)
    if cocotb.SIM_NAME.startswith("Icarus"):  # Verilator has no X
        cocotb.start_soon(bench.driver.unknown_while_idle())
    await bench.reset(clocks=int(os.environ.get("IK_RESET", "4")))
    yield bench
    await bench.drain()
    bench.check()


def places(bench: Pipeline) -> int:
    """Return the number of targets that are admitted while m_axis_tready is low.

    A pipeline has a FIFO whose depth is the pipeline's latency plus 3, rounded up to a power of two. In a folded core,
    one result waits at the output, and the next target stalls before it writes its result; a third target may be loaded
    before the stall. A core that chooses the branch holds one more result.
    """
    if bench.period == 1:
        latency = fixed.latency(bench.datapath, bench.width) - fixed.FIFO_CLOCKS
        return 1 << int(np.ceil(np.log2(latency + 3)))
    _, made = program(bench.width, bench.path.entity.removeprefix("ik_"))
    first, _ = made.results
    return 2 + (first > bench.period + max(made.loads.values())) + bench.path.chooses


@timed_test()
async def one_result_per_clock(dut):
    """Check that without stalls, results leave in consecutive clocks (folded core: one per period) with the specified
    latency. Check that DIGIT selects the kind of each divider and root."""
    async with started(dut, nodes=True) as bench:
        bench.driver.send(bench.mixed(200 if bench.period == 1 else 20, seed=1))
        await bench.drain()
        clocks = [row[3] for row in bench.monitor.results]
        assert (np.diff(clocks) == bench.period).all(), f"results come {sorted(set(np.diff(clocks)))} clocks apart"
        expected = fixed.latency(bench.datapath, bench.width)
        latencies = sorted(set(bench.monitor.latencies))
        assert latencies == [expected], f"latencies {latencies}, expected {expected}"
        # largest specified latency: up to W = 18, from W = 19
        limits = {"paper": (363, 363), "fold": (115, 115), "arm": (105, 130), "choose": (118, 143)}
        limits |= {"fold_arm": (320, 320), "fold_choose": (370, 370)}
        most = limits.get(bench.datapath.removesuffix("16"), (38, 44))[bench.width > 18]
        assert expected <= most, f"latency {expected}, more than {most}"
        recurrences = [node for node in bench.scoreboard.nodes if node.kind in ("div", "root")]
        for node in recurrences:  # of the paper's datapath
            digit = hasattr(getattr(bench.module(node), f"u_{node.name}"), "g_digit")
            assert digit == (int(dut.DIGIT.value) == 1), f"{node.name} is of the other kind than DIGIT selects"
        assert bool(recurrences) == (bench.datapath == "paper")


@cocotb.parametrize(idle=list(PATTERNS), stall=list(PATTERNS))
@timed_test()
async def stalls(dut, idle, stall):
    """Cross input gaps with output stalls. Without gaps, a "long" stall fills the FIFO."""
    async with started(dut) as bench:
        for port, pattern, seed in ((bench.driver.source, idle, 1), (bench.sink, stall, 2)):
            port.set_pause_generator(PATTERNS[pattern](np.random.default_rng(seed)))
        count = 60 if bench.period == 1 else 8
        if (idle, stall) == ("none", "long"):
            count = max(count, places(bench) + 60)
        bench.driver.send(bench.mixed(count, seed=3))


@cocotb.parametrize(idle=[False, True], stall=[False, True])
@timed_test()
async def every_flag_in_every_region(dut, idle, stall):
    """Send targets near each singular pose and targets far from all; cross input gaps with output stalls.

    Pauses are random, so targets whose coverage bin is still empty are sent again, up to 9 times. An extra target goes
    first, since the first target always follows idle clocks.
    """
    async with started(dut, nodes=not idle and not stall) as bench:
        random = np.random.default_rng(7)
        for port, pauses in ((bench.driver.source, idle), (bench.sink, stall)):
            if pauses:
                port.set_pause_generator(bool(number) for number in iter(lambda: random.integers(8), None))
        targets = every_kind(bench.width, bench.datapath)
        if bench.path.side and not bench.path.chooses:
            wrists = every_kind(bench.width)
            hands = [(0, 1 << bench.width - 2, 0, 0, 0, n % 8) for n in range(len(wrists))]  # tool, Qh, branch
            targets = np.concatenate([np.column_stack([wrists, hands]), targets])
        for _ in range(10):
            bench.driver.send(np.concatenate([targets[-1:], targets]))
            await bench.drain()
            targets = every_kind(bench.width, bench.datapath, STALLS[idle + 2 * stall])
            if not len(targets):
                break


@timed_test()
async def full(dut):
    """Check that the core admits :func:`places` targets while m_axis_tready is low; then take all results."""
    async with started(dut) as bench:
        most, more = places(bench), 50 if bench.period == 1 else 5
        bench.sink.pause = True
        bench.driver.send(bench.mixed(most + more, seed=4))
        latency = fixed.latency(bench.datapath, bench.width)
        await ClockCycles(dut.clk, most * bench.period + latency + 20, FallingEdge)
        admitted = len(bench.monitor.admitted)
        assert admitted == most, f"{admitted} targets admitted, there are {most} places"
        assert dut.s_axis_tready.value == 0, "tready is high without a place"
        assert dut.m_axis_tvalid.value == 1, "tvalid waits for tready"
        bench.sink.pause = False


@timed_test()
async def results_wait(dut):
    """Check that a folded core delays a result's first write only until the previous result has left. With branch
    choice, which buffers one more result, the tested waits cause no delay. The other datapaths have a FIFO."""
    async with started(dut) as bench:
        if bench.period == 1:
            return
        _, made = program(bench.width, bench.path.entity.removeprefix("ik_"))
        first, last = made.results
        spare = bench.period - 2 - (last - first)
        bench.sink.pause = True
        bench.driver.send(bench.mixed(8, seed=9))
        offered, waited = [], []
        for clocks in (1, spare - 1, spare, spare + 1, 1, spare + 5, 1, 1):
            while dut.m_axis_tvalid.value == 0:
                await FallingEdge(dut.clk)
            offered.append(bench.monitor.clock)
            await ClockCycles(dut.clk, clocks, FallingEdge)
            bench.sink.pause = False
            while dut.m_axis_tready.value == 0:
                await FallingEdge(dut.clk)
            waited.append(bench.monitor.clock - offered[-1])
            bench.sink.pause = True
            await FallingEdge(dut.clk)
        late = [0 if bench.path.chooses else max(0, clocks - spare) for clocks in waited]
        assert {spare, spare + 1} <= {*waited}, f"results waited for {waited} clocks"
        delays = [clocks - bench.period for clocks in np.diff(offered).tolist()]
        assert delays == late[:-1], f"after waits of {waited} clocks results are {delays} late, expected {late[:-1]}"


@cocotb.parametrize(after=["few", "many", "out", "full"])
@timed_test()
async def reset_in_traffic(dut, after):
    """Reset with few or many targets in flight, while results leave, or with a full FIFO. Check that all targets are
    dropped and that later targets give results."""
    async with started(dut) as bench:
        latency = fixed.latency(bench.datapath, bench.width)
        bench.sink.pause = after == "full"
        bench.driver.send(bench.mixed(1000, seed=5))
        clocks = {"few": 3, "many": latency // 2, "out": latency + bench.period + 30, "full": 2 * latency + 20}
        await ClockCycles(dut.clk, clocks[after])
        await bench.reset(clocks=1)
        before = len(bench.monitor.results)
        assert (before > 0) == (after == "out"), f"{before} results before the reset"
        bench.sink.pause = False
        await ClockCycles(dut.clk, latency + 20, FallingEdge)
        assert len(bench.monitor.results) == before, "a target from before the reset was answered"
        bench.driver.send(bench.mixed(50 if bench.period == 1 else 5, seed=6))


@timed_test()
async def reset_in_any_clock(dut):
    """Reset for one clock after 1 to 200 clocks of traffic with gaps and stalls; check the later results.

    Only every 11th count is simulated; `make formal` proves all.
    """
    async with started(dut) as bench:
        for clocks in range(1, 201, 11):
            for port, seed in ((bench.driver.source, clocks), (bench.sink, clocks + 1)):
                port.set_pause_generator(bursts(np.random.default_rng(seed)))
            bench.driver.send(bench.mixed(clocks // bench.period + 3, seed=clocks))
            await ClockCycles(dut.clk, clocks)
            await bench.reset(clocks=1)
            for port in (bench.driver.source, bench.sink):
                port.clear_pause_generator()
                port.pause = False
            bench.driver.send(bench.mixed(2, seed=clocks))
            await bench.drain()


@timed_test()
async def admitted_after_a_reset(dut):
    """Check that a target waiting at the end of a reset is admitted after a fixed number of clocks. The reset lasts one
    or two clocks and may start in any clock of a folded core's period."""
    async with started(dut) as bench:
        after = {}  # clocks from the end of a reset to the admission -> reset in which they were counted
        for clocks in range(2 * bench.period + 8):
            bench.driver.send(bench.mixed(3, seed=1))
            await ClockCycles(dut.clk, 1 + clocks // 2)
            await bench.reset(clocks=1 + clocks % 2)
            ended, admitted = bench.monitor.clock, len(bench.monitor.admitted)
            bench.driver.send(bench.mixed(1, seed=2))
            while len(bench.monitor.admitted) == admitted:
                await FallingEdge(dut.clk)
            after.setdefault(bench.monitor.clock - ended, f"{1 + clocks % 2} clocks after {1 + clocks // 2}")
        assert len(after) == 1, f"clocks from a reset to an admission: {after}"


@timed_test()
async def not_ready_under_reset(dut):
    """Check that tready falls as soon as reset is asserted, so that no target is admitted under reset."""
    async with started(dut) as bench:
        bench.driver.send(bench.mixed(2, seed=8))
        while dut.s_axis_tready.value != 1:
            await FallingEdge(dut.clk)
        dut.rst.value = 1
        await Timer(1, unit="ns")
        assert dut.s_axis_tready.value == 0, "tready is high under reset"
        await bench.reset()


@timed_test()
async def ready_before_valid(dut):
    """Check that without targets a pipeline is ready, the folded core is not, and no result leaves."""
    async with started(dut) as bench:
        for _ in range(20):
            await FallingEdge(dut.clk)
            assert dut.s_axis_tready.value == (bench.period == 1), "tready waits for tvalid"
            assert dut.m_axis_tvalid.value == 0, "a result without a target"


# One set per datapath; tag widths 3 and 8. At W = 23 the paper datapath takes 255 clocks, for which a FIFO of 256 slots
# would be too short. Streams do not depend on the word length. So Icarus, which is slow, runs lean at W = 18; on the
# paper datapath and the whole arm it runs only the tests in FEW.
ROWS = [("fold", 24, 8), ("paper", 23, 3), ("arm", 18, 3), ("choose", 18, 3), ("fold_arm", 24, 3)]
ROWS += [("fold_choose", 24, 3), ("fold_arm16", 18, 3), ("lean", 18, 3) if simulator() == "icarus" else ("lean", 32, 8)]
SETS = {f"{datapath}-{width}": (datapath, width, tag_width) for datapath, width, tag_width in ROWS}
BYTES = {"bytes-18": ("lean", 18, 3), "arm_bytes-18": ("arm", 18, 3)}
"""Sets of ``ik_axis_bytes`` and ``ik_arm_bytes``."""
GENERATORS = [value for value in globals().copy().values() if isinstance(value, regression.TestGenerator)]
TESTS = [test.name for generator in GENERATORS for test in generator.generate_tests()]

pytestmark = [pytest.mark.sim, pytest.mark.cost(60)]


LARGE = ("paper-23", "arm-18", "choose-18", "fold_arm-24", "fold_choose-24") if simulator() == "icarus" else ()
FEW = ("one_result", "idle=bursts/stall=bursts", "full", "after=out", "results_wait")
PARTS = dict.fromkeys((*LARGE, "fold_arm16-18"), FEW) | dict.fromkeys(BYTES, ("idle=bursts/stall=bursts", "after=out"))
"""Set -> parts of the names of the tests that it runs; other sets run all tests. fold_arm16 differs from fold_arm only
in the fetch of steps, whose reset test_power_up covers."""


def options(top: str, parameters: dict[str, int], names: list[str]) -> dict:
    """Return the arguments of :func:`tb.sim.runner.simulate` for the tests ``names``."""
    wanted = "|".join(re.escape(f"test_streams.{name}") + "$" for name in names)
    env = {"COCOTB_TEST_FILTER": wanted}
    return {"toplevel": top, "module": "tb.core.test_streams", "parameters": parameters, "env": env}


def cases() -> Iterator:
    """Yield a case for each parameter set and each of its tests.

    The ``bench`` mark is for the modules around the datapath and for a folded datapath, which can stall.
    test_every_node.py has the marks for the other datapaths.
    """
    for key, (datapath, width, tag_width) in (SETS | BYTES).items():
        path = MODELS[datapath]
        top = path.top + "_bytes" * (key in BYTES)
        parameters = {"W": width, "TAG_W": tag_width, **path.parameters}
        simulation = Shared(f"streams-{key}", partial(options, top, parameters))
        others = {other.entity for other in MODELS.values() if not path.times or other.entity != path.entity}
        marks = [pytest.mark.bench(top, without=others), *[pytest.mark.slow] * (key in BYTES)]
        for name in TESTS:
            if any(part in name for part in PARTS.get(key, [""])):
                yield pytest.param(simulation, name, id=f"{key}-{name}", marks=marks)


@pytest.mark.parametrize(("simulation", "name"), list(cases()))
def test_streams(request, simulation, name):
    """Run a test. The parameter sets in `BYTES` also check that random padding bits of targets have no effect and that
    results are sign-extended."""
    simulation.check(request, name)

# SPDX-License-Identifier: Apache-2.0
"""Fault tests of ``ik_axi``: refused areas, bus errors, starts while busy, resets.

After each fault the bus is quiet, only the job's areas have been accessed, and the next job succeeds.
"""

import os

import cocotb
from cocotb.triggers import ClockCycles, FallingEdge
from cocotbext.axi import AxiResp

from tb.axi.bench import BYTES, CHANNELS, Bench, bench_test
from tb.axi.ik_regs import CODES

ROUNDS = int(os.environ.get("IK_AXI_FAULTS", "12"))  # number of random faults of each kind

SOURCE, DESTINATION = 0x40000 - 5 * BYTES, 0x80000 - 2 * BYTES
DONE, ERROR, REFUSED = 1, 2, 4  # bits of IRQ_STATUS


def failure(code: str) -> dict[str, int]:
    return {"busy": 0, "done": 0, "error": 1, "code": CODES[code]}


async def next_job(bench: Bench) -> None:
    bench.memory.faults.clear()
    await bench.solve(SOURCE, DESTINATION, 13, first=bench.random.randrange(bench.pool))
    await bench.write("IRQ_STATUS", DONE)


@bench_test()
async def refused_areas(bench):
    """A job with illegal or overlapping areas is refused after 4 clocks, before any access to memory."""
    end = 1 << bench.addr_width
    cases = [
        (0x1004, 0x2000, 4, "source_misaligned", 0x1004),
        (0x1000 + BYTES // 2, 0x2010, 4, "source_misaligned", 0x1000 + BYTES // 2),
        (0x1000, 0x2000 + BYTES // 2, 4, "destination_misaligned", 0x2000 + BYTES // 2),
        (0x1000, 0x2001, 4, "destination_misaligned", 0x2001),
        (end - BYTES, 0x2000, 2, "source_beyond", end - BYTES),
        (0x1000, end - 3 * BYTES, 4, "destination_beyond", end - 3 * BYTES),
        (0x1000, 0x1000, 1, "overlap", 0x1000),
        (0x1000, 0x1000 + 3 * BYTES, 4, "overlap", 0x1000 + 3 * BYTES),
        (0x1000 + 3 * BYTES, 0x1000, 4, "overlap", 0x1000),
        (0x1000, 0x1080, 1 << 20, "overlap", 0x1080) if bench.addr_width > 26 else (0, BYTES, 2, "overlap", BYTES),
        (BYTES, 0x2000, 0xFFFFFFFF, "source_beyond" if bench.addr_width < 38 else "overlap", 0),
    ]
    for bit in range(bench.addr_width, 64):
        cases.append(((1 << bit) + 0x1000, 0x2000, 1, "source_beyond", None))
        cases.append((0x1000, (1 << bit) + 0x2000, 1, "destination_beyond", None))
    for source, destination, count, code, address in cases:
        await bench.start(source, destination, count)
        status = await bench.ended(20)
        assert status == failure(code), f"{source:#x} {destination:#x}: {status}"
        if address:
            assert await bench.wide("ERROR") == address
        assert await bench.read("WRITTEN") == 0 and await bench.read("CLOCKS") == 4
    assert not any(bench.monitor.bursts.values()), "a refused job accesses memory"
    await bench.write("IRQ_STATUS", ERROR)
    await next_job(bench)


@bench_test()
async def no_records(bench):
    """A job with COUNT = 0 is done at once, even if its areas are illegal."""
    for source, destination in ((0x1000, 0x2000), (0x1000, 0x1000), (3, 5), (1 << 63, 1 << 63)):
        await bench.start(source, destination, 0)
        assert await bench.ended(20) == {"busy": 0, "done": 1, "error": 0, "code": 0}
        assert await bench.read("IRQ_STATUS") == DONE
        await bench.write("IRQ_STATUS", DONE)
    assert not any(bench.monitor.bursts.values())
    await next_job(bench)


@bench_test(seed=5, latency=9)
async def bus_errors(bench):
    """Results before a failing R beat or W burst are written; ERROR is the address of that beat or burst.

    Errors cycle through read and write, each with DECERR and SLVERR. A good job follows two of three errors.
    """
    numbers, beat_bytes = bench.random, bench.data_width // 8
    for k in range(4 * ROUNDS):
        if k == 2 * ROUNDS:
            bench.stall(*CHANNELS)
        side, area = (("read", SOURCE), ("write", DESTINATION))[k // 2 % 2]
        answer, other = ("slverr", "decerr") if k % 2 else ("decerr", "slverr")
        count = numbers.randint(1, 100) if k != 1 else 512  # the last record index, 511, is all ones
        bad = numbers.randrange(count * bench.beats) * beat_bytes
        bad = {0: 0, 1: count * BYTES - beat_bytes, 2: 0}.get(k, bad)
        faults = {area + bad: AxiResp[answer.upper()]}
        if k % 3 == 0:  # a second fault, which is not reported
            faults.setdefault(area + count * BYTES - 4, AxiResp[other.upper()])
        address = area + bad
        if side == "write":
            address = max(area, address - address % (bench.per_burst * BYTES))
        good = (address - area) // BYTES
        rest = bench.memory.read(DESTINATION + good * BYTES, (count - good + 8) * BYTES)
        bench.memory.faults = faults
        await bench.start(SOURCE, DESTINATION, count, first=k)
        status, expected = await bench.ended(), failure(f"{side}_{answer}")
        assert status == expected, f"{status}, expected {expected}; {bench.memory.errors[:1]}"
        assert await bench.wide("ERROR") == address, f"{await bench.wide('ERROR'):#x}, expected {address:#x}"
        assert await bench.read("IRQ_STATUS") == ERROR
        await bench.write("IRQ_STATUS", ERROR)
        assert await bench.read("IRQ_STATUS") == 0 and await bench.read("WRITTEN") == good
        bench.compare(DESTINATION, k, good)
        after = bench.memory.read(DESTINATION + good * BYTES, len(rest))
        assert side == "write" or after == rest, "a record after the error is written"
        if k % 3:
            await next_job(bench)


@bench_test(seed=7)
async def errors_on_both(bench):
    """A job with a read error and a write error reports one of them; the first WRITTEN results are in memory."""
    numbers = bench.random
    for k in range(ROUNDS):
        count = numbers.randint(20, 90)
        read, write = numbers.randrange(count), numbers.randrange(count)
        bench.memory.faults = {SOURCE + read * BYTES: AxiResp.SLVERR, DESTINATION + write * BYTES: AxiResp.DECERR}
        await bench.start(SOURCE, DESTINATION, count, first=k)
        status = await bench.ended()
        codes = [CODES["read_slverr"], *([CODES["write_decerr"]] if write < read else [])]
        assert status["error"] and status["code"] in codes, f"{status}, read {read}, write {write}"
        written = await bench.read("WRITTEN")
        assert written <= min(read, write if write < read else read)
        bench.compare(DESTINATION, k, written)
        await next_job(bench)


@bench_test()
async def start_while_busy(bench):
    """A start during a job is refused and sets its own interrupt bit; new parameters apply to the next job only."""
    bench.stall("r", "w")
    await bench.start(SOURCE, DESTINATION, 60, first=0)
    await bench.start(0x10000, 0x20000, 7)
    assert bench.dut.u_job.busy.value == 1 and await bench.read("IRQ_STATUS") == REFUSED
    assert bench.dut.irq.value == 0
    await bench.write("IRQ_ENABLE", REFUSED)
    await ClockCycles(bench.dut.clk, 3)
    assert bench.dut.irq.value == 1
    assert (await bench.ended())["done"] == 1
    assert await bench.read("IRQ_STATUS") == REFUSED | DONE, "IRQ_STATUS.refused is cleared by the end of the job"
    bench.compare(DESTINATION, 0, 60)
    await bench.write("IRQ_STATUS", REFUSED)
    assert await bench.read("IRQ_STATUS") == DONE
    await ClockCycles(bench.dut.clk, 3)
    assert bench.dut.irq.value == 0
    bench.place(0x10000, 9, 7)
    bench.memory.readable, bench.memory.writable = (0x10000, 0x10000 + 7 * BYTES), (0x20000, 0x20000 + 7 * BYTES)
    await bench.write("CONTROL", 1)
    assert (await bench.ended())["done"] == 1
    bench.compare(0x20000, 9, 7)


@cocotb.parametrize(paused=[False, True])
@bench_test(seed=8, latency=12)
async def soft_reset(bench, paused):
    """A soft reset at a random clock of a job completes open bus transactions and clears STATUS and IRQ_STATUS."""
    numbers = bench.random
    if paused:
        bench.stall(*CHANNELS)
    ended = 0
    for k in range(2 * ROUNDS):
        count = numbers.randint(30, 60)
        await bench.write("IRQ_ENABLE", 7)
        await bench.start(SOURCE, DESTINATION, count, first=k)
        await ClockCycles(bench.dut.clk, numbers.randrange(400) if k % 4 else numbers.randrange(8))
        ended += bench.dut.u_job.busy.value == 0
        await bench.write("CONTROL", 3)
        await bench.ended()
        await ClockCycles(bench.dut.clk, 4)
        assert bench.monitor.quiet(), "transactions are open after a soft reset"
        assert await bench.read("STATUS") == 0 and await bench.read("IRQ_STATUS") == 0 and bench.dut.irq.value == 0
        kept = await bench.read("COUNT"), await bench.wide("SOURCE"), await bench.wide("DESTINATION")
        assert kept == (count, SOURCE, DESTINATION) and await bench.read("IRQ_ENABLE") == 7
        bench.compare(DESTINATION, k, await bench.read("WRITTEN"))
        if k % 2:  # a start reuses the kept parameters
            await bench.write("CONTROL", 1)
            assert (await bench.ended())["done"] == 1
            bench.compare(DESTINATION, k, count)
        else:
            await next_job(bench)
        await bench.write("IRQ_STATUS", 7)
    assert ended < ROUNDS, "most jobs ended before the reset"


@bench_test(seed=10, latency=100)
async def soft_reset_after_an_error(bench):
    """A soft reset also clears the error of the running job."""
    seen = 0
    for k in range(6):
        bench.memory.faults = {SOURCE: AxiResp.SLVERR}
        await bench.start(SOURCE, DESTINATION, 60, first=k)
        while bench.dut.u_job.code.value == 0:
            await FallingEdge(bench.dut.clk)
        await bench.write("CONTROL", 3)
        await FallingEdge(bench.dut.clk)
        seen += bench.dut.u_job.aborted.value == 1
        await bench.ended()
        await ClockCycles(bench.dut.clk, 4)
        assert await bench.read("STATUS") == 0
        await next_job(bench)
    assert seen, "every job ended before the reset"


@bench_test(seed=9)
async def reset_during_a_job(bench):
    """The next job succeeds after a reset of the core and the memory's ports."""
    for k in range(4):
        await bench.start(SOURCE, DESTINATION, 50, first=k)
        await ClockCycles(bench.dut.clk, 20 + 60 * k)
        await bench.reset()
        assert await bench.read("STATUS") == 0 and await bench.read("COUNT") == 0
        await bench.solve(SOURCE, DESTINATION, 30)

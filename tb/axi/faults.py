# SPDX-License-Identifier: Apache-2.0
"""Fault tests of ``ik_axi``: refused areas, bus errors, starts while busy, soft resets.

After each fault the bus must be quiet, bytes outside the areas untouched, and the next job must work.
"""

from __future__ import annotations

import os

import cocotb
from cocotb.triggers import ClockCycles, FallingEdge
from cocotbext.axi import AxiResp

from model.io.words import BYTES
from tb.axi.ik_regs import CODES
from tb.axi.machine import CHANNELS, Machine, started

ROUNDS = int(os.environ.get("IK_AXI_FAULTS", "12"))
"""Number of random faults of each kind."""

SOURCE, DESTINATION = 0x40000 - 5 * BYTES, 0x80000 - 2 * BYTES
DONE, ERROR, REFUSED = 1, 2, 4  # bits of IRQ_STATUS


async def ends_with(machine: Machine, code: str, address: int) -> None:
    """Wait for the running job to end; check the error in STATUS, ERROR and IRQ_STATUS."""
    status = await machine.ended()
    wanted = {"busy": 0, "done": 0, "error": 1, "code": CODES[code]}
    assert status == wanted, f"{status}, expected {wanted}; {machine.memory.errors[:1]}"
    assert await machine.wide("ERROR") == address, f"{await machine.wide('ERROR'):#x}, expected {address:#x}"
    assert await machine.read("IRQ_STATUS") == ERROR
    await machine.write("IRQ_STATUS", ERROR)
    assert await machine.read("IRQ_STATUS") == 0


async def next_job(machine: Machine) -> None:
    machine.memory.faults.clear()
    await machine.solve(SOURCE, DESTINATION, 13, first=machine.random.randrange(machine.pool))


@cocotb.test()
async def refused_areas(dut):
    """Illegal areas are refused within a few clocks, before any access."""
    machine = await started(dut)
    end = 1 << machine.addr_width
    cases = [
        (0x1004, 0x2000, 4, "source_misaligned", 0x1004),
        (0x1010, 0x2010, 4, "source_misaligned", 0x1010),
        (0x1000, 0x2010, 4, "destination_misaligned", 0x2010),
        (0x1000, 0x2001, 4, "destination_misaligned", 0x2001),
        (end - 32, 0x2000, 2, "source_beyond", end - 32),
        (0x1000, end - 96, 4, "destination_beyond", end - 96),
        (0x1000, 0x1000, 1, "overlap", 0x1000),
        (0x1000, 0x1060, 4, "overlap", 0x1060),
        (0x1060, 0x1000, 4, "overlap", 0x1000),
        (0x1000, 0x1080, 1 << 20, "overlap", 0x1080) if machine.addr_width > 26 else (0x0, 0x20, 2, "overlap", 0x20),
        (0x20, 0x2000, 0xFFFFFFFF, "source_beyond" if machine.addr_width < 38 else "overlap", 0),
    ]
    for bit in range(machine.addr_width, 64):
        cases += [
            ((1 << bit) + 0x1000, 0x2000, 1, "source_beyond", None),
            (0x1000, (1 << bit) + 0x2000, 1, "destination_beyond", None),
        ]
    for source, destination, count, code, address in cases:
        await machine.start(source, destination, count, accepted=False)
        status = await machine.ended(20)
        wanted = {"busy": 0, "done": 0, "error": 1, "code": CODES[code]}
        assert status == wanted, f"{source:#x} {destination:#x}: {status}"
        if address:
            assert await machine.wide("ERROR") == address
        assert await machine.read("WRITTEN") == 0 and await machine.read("CLOCKS") == 4
    assert not (machine.monitor.bursts_read or machine.monitor.bursts_written), "an access of a job that was refused"
    await machine.write("IRQ_STATUS", ERROR)
    await next_job(machine)
    machine.check()


@cocotb.test()
async def no_records(dut):
    """A job of count 0 is done at once, whatever its areas."""
    machine = await started(dut)
    for source, destination in ((0x1000, 0x2000), (0x1000, 0x1000), (3, 5), (1 << 63, 1 << 63)):
        await machine.start(source, destination, 0)
        assert await machine.ended(20) == {"busy": 0, "done": 1, "error": 0, "code": 0}
        assert await machine.read("IRQ_STATUS") == DONE
        await machine.write("IRQ_STATUS", DONE)
    assert not (machine.monitor.bursts_read or machine.monitor.bursts_written)
    await next_job(machine)
    machine.check()


@cocotb.test()
@cocotb.parametrize(answer=["slverr", "decerr"])
async def error_on_read(dut, answer):
    """Only the records before the failing beat are written, and ERROR is the address of this beat."""
    machine = await started(dut, seed=5, latency=9)
    numbers, beat_bytes = machine.random, machine.data_width // 8
    for k in range(ROUNDS):
        if k == ROUNDS // 2:
            machine.stall(*CHANNELS)
        count = numbers.randint(1, 200) if k != 1 else 512  # the last record index, 511, is all ones
        bad = numbers.randrange(count) * BYTES + numbers.randrange(machine.beats) * beat_bytes
        if k == 0:
            bad = 0
        if k == 1:
            bad = count * BYTES - beat_bytes
        good = bad // BYTES
        machine.place(SOURCE, k, count)
        rest = machine.memory.peek(DESTINATION + good * BYTES, (count - good + 8) * BYTES)
        code = AxiResp[answer.upper()]
        machine.memory.faults = {SOURCE + bad: code}
        if k % 3 == 0:  # only the first is reported
            machine.memory.faults[SOURCE + count * BYTES - 4] = AxiResp.DECERR
        if good * BYTES + BYTES > count * BYTES - 4 > bad:
            machine.memory.faults = {SOURCE + bad: code}
        await machine.start(SOURCE, DESTINATION, count)
        await ends_with(machine, f"read_{answer}", SOURCE + bad)
        assert await machine.read("WRITTEN") == good
        machine.compare(DESTINATION, k, good)
        assert machine.memory.peek(DESTINATION + good * BYTES, len(rest)) == rest, "written behind the error"
        await next_job(machine)
        await machine.write("IRQ_STATUS", DONE)
    machine.check()


@cocotb.test()
@cocotb.parametrize(answer=["slverr", "decerr"])
async def error_on_write(dut, answer):
    """WRITTEN counts the bursts before the failing one, and ERROR is the address of this burst."""
    machine = await started(dut, seed=6, latency=5)
    numbers = machine.random
    for k in range(ROUNDS):
        if k == ROUNDS // 2:
            machine.stall(*CHANNELS)
        count = numbers.randint(1, 90)
        bad = numbers.randrange(count) if k else 0
        address = DESTINATION + bad * BYTES
        burst = max(DESTINATION, address - address % (machine.whole * BYTES))
        machine.place(SOURCE, k, count)
        machine.memory.faults = {address + 4 * numbers.randrange(8): AxiResp[answer.upper()]}
        if k % 3 == 0 and bad + machine.whole < count:  # only the first is reported
            machine.memory.faults[DESTINATION + (count - 1) * BYTES] = AxiResp.SLVERR
        await machine.start(SOURCE, DESTINATION, count)
        await ends_with(machine, f"write_{answer}", burst)
        written = await machine.read("WRITTEN")
        assert written == (burst - DESTINATION) // BYTES
        machine.compare(DESTINATION, k, written)
        await next_job(machine)
        await machine.write("IRQ_STATUS", DONE)
    machine.check()


@cocotb.test()
async def errors_in_turn(dut):
    """DECERR and SLVERR in turn, on reads and on writes: each job reports its own error."""
    machine = await started(dut)
    for answer in ("decerr", "slverr", "decerr"):
        for side, address in (("read", SOURCE), ("write", DESTINATION)):
            machine.place(SOURCE, 0, 3)
            machine.memory.faults = {address: AxiResp[answer.upper()]}
            await machine.start(SOURCE, DESTINATION, 3)
            await ends_with(machine, f"{side}_{answer}", address)
    await next_job(machine)
    machine.check()


@cocotb.test()
async def errors_on_both(dut):
    """One error on each side: the first to arrive is reported, and WRITTEN records are in memory."""
    machine = await started(dut, seed=7)
    numbers = machine.random
    for k in range(ROUNDS):
        count = numbers.randint(20, 90)
        machine.place(SOURCE, k, count)
        read, write = numbers.randrange(count), numbers.randrange(count)
        faults = {SOURCE + read * BYTES: AxiResp.SLVERR, DESTINATION + write * BYTES: AxiResp.DECERR}
        machine.memory.faults = faults
        await machine.start(SOURCE, DESTINATION, count)
        status = await machine.ended()
        codes = [CODES["read_slverr"], *([CODES["write_decerr"]] if write < read else [])]
        assert status["error"] and status["code"] in codes, f"{status}, read {read}, write {write}"
        written = await machine.read("WRITTEN")
        assert written <= min(read, write if write < read else read)
        machine.compare(DESTINATION, k, written)
        await next_job(machine)
    machine.check()


@cocotb.test()
async def start_while_busy(dut):
    """A start while busy is refused with its own interrupt; new parameters apply to the next job only."""
    machine = await started(dut)
    machine.stall("r", "w")
    machine.place(SOURCE, 0, 60)
    await machine.start(SOURCE, DESTINATION, 60)
    await machine.start(0x10000, 0x20000, 7, accepted=False)
    assert dut.u_job.busy.value == 1 and await machine.read("IRQ_STATUS") == REFUSED
    assert dut.irq.value == 0
    await machine.write("IRQ_ENABLE", REFUSED)
    await ClockCycles(dut.clk, 3)
    assert dut.irq.value == 1
    assert (await machine.ended())["done"] == 1
    assert await machine.read("IRQ_STATUS") == REFUSED | DONE, "refused is sticky"
    machine.compare(DESTINATION, 0, 60)
    await machine.write("IRQ_STATUS", REFUSED)
    assert await machine.read("IRQ_STATUS") == DONE
    await ClockCycles(dut.clk, 3)
    assert dut.irq.value == 0
    machine.place(0x10000, 9, 7)
    machine.memory.readable, machine.memory.writable = (0x10000, 0x10000 + 7 * BYTES), (0x20000, 0x20000 + 7 * BYTES)
    await machine.write("CONTROL", 1)
    assert (await machine.ended())["done"] == 1
    machine.compare(0x20000, 9, 7)
    machine.check()


@cocotb.test()
@cocotb.parametrize(paused=[False, True])
async def soft_reset(dut, paused):
    """A soft reset in any clock of a job completes open bus transactions and clears all status."""
    machine = await started(dut, seed=8, latency=12)
    numbers = machine.random
    if paused:
        machine.stall(*CHANNELS)
    ended = 0
    for k in range(2 * ROUNDS):
        count = numbers.randint(30, 60)
        machine.place(SOURCE, k, count)
        await machine.write("IRQ_ENABLE", 7)
        await machine.start(SOURCE, DESTINATION, count)
        await ClockCycles(dut.clk, numbers.randrange(400) if k % 4 else numbers.randrange(8))
        ended += dut.u_job.busy.value == 0
        await machine.write("CONTROL", 3)
        await machine.ended()
        for _ in range(4):
            await FallingEdge(dut.clk)
        assert machine.monitor.quiet(), "transactions are open behind a soft reset"
        assert await machine.read("STATUS") == 0 and await machine.read("IRQ_STATUS") == 0 and dut.irq.value == 0
        kept = await machine.read("COUNT"), await machine.wide("SOURCE"), await machine.wide("DESTINATION")
        assert kept == (count, SOURCE, DESTINATION) and await machine.read("IRQ_ENABLE") == 7
        machine.compare(DESTINATION, k, await machine.read("WRITTEN"))
        if k % 2:  # the kept parameters are valid for a job
            await machine.write("CONTROL", 1)
            assert (await machine.ended())["done"] == 1
            machine.compare(DESTINATION, k, count)
        else:
            await next_job(machine)
        await machine.write("IRQ_STATUS", 7)
    assert ended < ROUNDS, "most of the resets came too late"
    machine.check()


@cocotb.test()
async def soft_reset_behind_an_error(dut):
    """A soft reset also clears an error that the job has already met."""
    machine = await started(dut, seed=10, latency=100)
    seen = 0
    for k in range(6):
        machine.place(SOURCE, k, 60)
        machine.memory.faults = {SOURCE: AxiResp.SLVERR}
        await machine.start(SOURCE, DESTINATION, 60)
        while dut.u_job.code.value == 0:
            await FallingEdge(dut.clk)
        await machine.write("CONTROL", 3)
        await FallingEdge(dut.clk)
        seen += dut.u_job.aborted.value == 1
        await machine.ended()
        for _ in range(4):
            await FallingEdge(dut.clk)
        assert await machine.read("STATUS") == 0
        await next_job(machine)
    assert seen, "the job was over each time"
    machine.check()


@cocotb.test()
async def reset_in_the_middle(dut):
    """A reset of core and memory during a job: the next job works."""
    machine = await started(dut, seed=9)
    for k in range(4):
        machine.place(SOURCE, k, 50)
        await machine.start(SOURCE, DESTINATION, 50)
        await ClockCycles(dut.clk, 20 + 60 * k)
        await machine.reset()
        assert await machine.read("STATUS") == 0 and await machine.read("COUNT") == 0
        await machine.solve(SOURCE, DESTINATION, 30)
    machine.check()

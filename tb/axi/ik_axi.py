# SPDX-License-Identifier: Apache-2.0
"""Job tests of ``ik_axi``: results equal the model's, neighbouring bytes stay untouched, and the AXI rules hold."""

from __future__ import annotations

import os
from pathlib import Path

import cocotb
from cocotb.triggers import ClockCycles

from model.io.words import BYTES
from tb.axi.machine import CHANNELS, Machine, started

JOBS = int(os.environ.get("IK_AXI_JOBS", "120"))
"""Number of random jobs, half of them with pauses."""

BASE = 0x40000 - 512
"""Base address of the areas; the smallest tested instance has an address space of 1 MiB."""


def bursts(address: int, count: int, whole: int, beats: int) -> list[tuple[int, int]]:
    """Return the expected bursts of an area as (address, beats)."""
    found = []
    while count:
        size = min(count, whole - address // BYTES % whole)
        found.append((address, size * beats))
        address, count = address + size * BYTES, count - size
    return found


@cocotb.test()
async def one_record(dut):
    """One target gives one result."""
    machine = await started(dut)
    await machine.solve(BASE, BASE + 0x2000, 1)
    await machine.solve(BASE + BYTES, BASE, 1, first=1)
    machine.check()


@cocotb.test()
async def edges_of_bursts(dut):
    """Jobs that start and end at, before and after a burst boundary, with another alignment at the destination."""
    machine = await started(dut)
    whole = machine.whole
    for k, skip in enumerate((0, 1, whole - 1)):
        for count in (1, 2, whole - 1, whole, whole + 1, 2 * whole + 1):
            machine.monitor.bursts_read.clear()
            machine.monitor.bursts_written.clear()
            source, destination = 0x8000 + skip * BYTES, 0x20000 + (k * count + count) % whole * BYTES
            await machine.solve(source, destination, count, first=count)
            assert machine.monitor.bursts_read == bursts(source, count, whole, machine.beats)
            written = machine.monitor.bursts_written
            assert written == bursts(destination, count, whole, machine.beats), f"{count} records: {written}"
    machine.check()


@cocotb.test()
async def pages(dut):
    """Areas that cross several 4 KiB boundaries, starting just below one."""
    machine = await started(dut)
    await machine.solve(0x10000 - BYTES, 0x20000 - 3 * BYTES, 300)
    machine.check()
    assert len(machine.monitor.bursts_read) >= 300 // machine.whole


@cocotb.test()
async def long_job(dut):
    """A job of many times the FIFO depth, with pauses: no slot is lost."""
    machine = await started(dut, seed=4)
    machine.stall("ar", "r", "aw", "w", "b")
    await machine.solve(0x40000 - 3 * BYTES, 0x80000 - BYTES, 1500)
    machine.check()


@cocotb.test()
async def neighbours(dut):
    """Destination directly after and directly before the source, at both ends of the address space."""
    machine = await started(dut)
    count, end = 2 * machine.whole + 3, 1 << machine.addr_width
    size = count * BYTES
    for source, destination in ((0x3000, 0x3000 + size), (0x3000 + size, 0x3000), (0, end - size), (end - size, 0)):
        machine.place(source, 0, count)
        await machine.start(source, destination, count)
        status = await machine.ended()
        assert status["done"], f"source {source:#x}, destination {destination:#x}: {status}"
        machine.compare(destination, 0, count)
    machine.check()


async def random_jobs(machine: Machine, jobs: int) -> None:
    """Run jobs of mostly small sizes on random disjoint areas; then append their counts to the file IK_AXI_DONE."""
    numbers = machine.random
    limit = min(1 << machine.addr_width, 1 << 40) // BYTES
    solved = 0
    for _ in range(jobs):
        count = numbers.choice((numbers.randint(1, 12), numbers.randint(1, 40), numbers.randint(1, 120)))
        source = destination = 0
        while abs(source - destination) < count:
            if numbers.random() < 0.3:  # close together
                source = numbers.randint(200, limit - 400)
                destination = source + numbers.choice((-1, 1)) * (count + numbers.randint(0, 3))
            else:
                source, destination = (numbers.randint(8, limit - 200) for _ in range(2))
        await machine.solve(source * BYTES, destination * BYTES, count, first=numbers.randrange(machine.pool))
        solved += count
    machine.check()
    if path := os.environ.get("IK_AXI_DONE"):
        with Path(path).open("a") as file:
            file.write(f"{jobs} {solved}\n")


@cocotb.test()
async def many_jobs(dut):
    """Random jobs without pauses."""
    machine = await started(dut, seed=2)
    await random_jobs(machine, JOBS // 2)


@cocotb.test()
@cocotb.parametrize(stalled=["all", *(c for c in CHANNELS if c != "lite")])
async def many_jobs_with_pauses(dut, stalled):
    """Random jobs, with random pauses on all channels or on one."""
    machine = await started(dut, seed=3, latency=len(stalled) % 3 * 7)
    machine.stall(*(CHANNELS if stalled == "all" else (stalled,)), share=0.3 if stalled == "all" else 0.7)
    await random_jobs(machine, JOBS // 2 if stalled == "all" else JOBS // 20)


@cocotb.test()
@cocotb.parametrize(shut=["r", "aw", "w", "b"])
async def nobody_answers(dut, shut):
    """Block one channel: requests stay within FIFO slots and burst limit; after release every result is right."""
    machine = await started(dut)
    count = machine.places + 12 * machine.whole
    source, destination = 0x40000, 0x80000
    machine.place(source, 0, count)
    for port in (machine.reader.ar_channel, machine.writer.aw_channel, machine.writer.b_channel):
        port.queue_occupancy_limit = 64  # accept every request
    channel = getattr(machine.reader if shut == "r" else machine.writer, f"{shut}_channel")
    channel.pause = True
    await machine.start(source, destination, count)
    await ClockCycles(dut.clk, 30 * machine.places + 4 * count * machine.beats // machine.whole)
    assert dut.u_job.busy.value == 1
    most = dict(machine.monitor.most)
    assert most["reads"] <= 8 and most["writes"] <= 8, f"{most}"
    assert most["places"] <= machine.places + 1, f"{most}"  # one record may be on W
    promised = {"r": ("reads", min(8, machine.places // machine.whole)), "b": ("writes", 8)}
    if shut in promised:
        name, number = promised[shut]
        assert most[name] == number, f"{most}, {number} are promised"
    if shut != "r":  # every allowed request has been made
        room = 8 * machine.whole if shut == "b" else 0
        asked = sum(beats for _, beats in machine.monitor.bursts_read) // machine.beats
        most_asked = machine.places + 1 + room + (shut == "aw") * 10 * machine.whole
        assert machine.places - machine.whole < asked <= most_asked, f"{asked} records asked for"
    channel.pause = False
    assert (await machine.ended())["done"] == 1
    machine.compare(destination, 0, count)
    machine.check()


@cocotb.test()
async def counters(dut):
    """CLOCKS counts busy clocks; the stall counters count clocks in which a due beat does not move."""
    machine = await started(dut, latency=20)
    await machine.solve(0x4000, 0x8000, 20)
    assert await machine.read("READ_STALLS") >= 20 and await machine.read("WRITE_STALLS") == 0
    machine.stall("w", share=0.8)
    busy = [0]

    async def count():
        while True:
            await ClockCycles(dut.clk, 1)
            busy[0] += int(dut.u_job.busy.value)

    watch = cocotb.start_soon(count())
    await machine.solve(0x4000, 0x8000, 60)
    watch.cancel()
    clocks, waited = await machine.read("CLOCKS"), await machine.read("WRITE_STALLS")
    assert abs(clocks - busy[0]) <= 1, f"{clocks} counted, busy for {busy[0]}"
    assert 60 < waited < clocks
    machine.check()

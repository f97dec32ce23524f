# SPDX-License-Identifier: Apache-2.0
"""Simulation of the C driver on ``ik_axi``: the driver's object code, IK_DRIVER, runs in a thread, and each register
access takes its clocks in the simulation.

Tests require the model's target words in memory and exactly the model's result values. Each hardware error must give
its code, and the next call must work.
"""

from __future__ import annotations

import ctypes
import os
from pathlib import Path

import cocotb
import numpy as np
from cocotb.task import bridge, resume
from cocotb.triggers import ClockCycles, RisingEdge
from cocotbext.axi import AxiResp

from model.io.words import BYTES, FIELDS, Targets, result_values, target_records, to_words
from tb.axi.binding import Driver
from tb.axi.ik_regs import OFFSETS
from tb.axi.machine import CHANNELS, Machine, started
from tb.axi.memory import PAGE

LIBRARY = Path(os.environ["IK_DRIVER"])

RECORDS = 24
"""Capacity of each buffer."""

SIZE = RECORDS * BYTES

PATIENCE = 4000
"""Limit in clocks for an interrupt to arrive."""

ARMS = {"metres": (0.33, 0.27), "millimetre": (330.0, 270.0), "small": (1.1e-3, 0.9e-3), "large": (1e6, 1.4e6)}


def areas(machine: Machine) -> tuple[int, int]:
    """Return the bus addresses of targets and results; above 32 bits if the address width allows it."""
    base = (3 << 36) * (machine.addr_width > 37)
    return base + 0x41000 - 5 * BYTES, base + 0x82000 - 2 * BYTES


class Platform:
    """Buffers and driver callbacks: polling on coherent memory, or interrupts with a non-coherent cache.

    The cache may write dirty lines of the results back at any time; this model does so when a job ends.
    """

    def __init__(
        self, machine: Machine, interrupt: bool, polls: int = 2000, places: tuple[int, int] | None = None
    ) -> None:
        self.machine, self.interrupt = machine, interrupt
        self.buffers: dict[int, ctypes.Array] = {}  # bus address -> the CPU's view
        self.clean: dict[int, bytes] = {}  # cache contents when last coherent with memory
        self.jobs: list[bytes] = []  # target records of each job
        self.naps = 0
        self.running = False  # the driver has started a job
        self.woken = False  # by an abort
        self.race = False  # another host starts a job just before the driver does
        self.source, self.destination = places or areas(machine)
        seen = [(self._place(address), address) for address in (self.source, self.destination)]
        self.driver = Driver(LIBRARY, self, *seen, RECORDS, cache=interrupt, interrupt=interrupt, polls=polls)

    def _place(self, address: int) -> int:
        if self.interrupt:
            self.buffers[address] = ctypes.create_string_buffer(b"\xa5" * SIZE, SIZE)
            self.clean[address] = b""
            return ctypes.addressof(self.buffers[address])
        memory, first = self.machine.memory, address // PAGE
        pages = range(first, (address + SIZE - 1) // PAGE + 1)
        held = memory.peek(first * PAGE, len(pages) * PAGE)
        buffer = ctypes.create_string_buffer(held, len(held))
        self.buffers[address] = buffer
        for k, page in enumerate(pages):  # shared by CPU and bus
            memory.pages[page] = memoryview(buffer).cast("B")[k * PAGE : (k + 1) * PAGE]
        return ctypes.addressof(buffer) + address % PAGE

    # ---- callbacks ---------------------------------------------------------------------------------------------------

    @resume
    async def _read(self, offset: int) -> int:
        answer = await self.machine.lite.read(offset, 4)
        assert answer.resp == AxiResp.OKAY, f"read of {offset:#x}: {answer.resp}"
        return int.from_bytes(answer.data, "little")

    def read(self, offset: int) -> int:
        return self._read(offset)

    @resume
    async def _write(self, offset: int, value: int) -> None:
        answer = await self.machine.lite.write(offset, value.to_bytes(4, "little"))
        assert answer.resp == AxiResp.OKAY, f"write to {offset:#x}: {answer.resp}"

    def write(self, offset: int, value: int) -> None:
        memory = self.machine.memory
        if offset == OFFSETS["COUNT"]:
            memory.readable = (self.source, self.source + value * BYTES)
            memory.writable = (self.destination, self.destination + value * BYTES)
        if (offset, value) == (OFFSETS["CONTROL"], 1):
            self.machine.monitor.failed.clear()
            self.running = True
            self.jobs.append(memory.peek(self.source, memory.readable[1] - self.source))
            if self.race:
                self._write(offset, value)
        if offset == OFFSETS["IRQ_STATUS"] and self.interrupt and self.running:
            self.running = False
            self._evict()
        self._write(offset, value)

    def _evict(self) -> None:
        at, clean = self.destination, self.clean[self.destination]
        dirty = self.buffers[at].raw
        for k in range(0, SIZE, BYTES):
            if dirty[k : k + BYTES] != clean[k : k + BYTES]:
                self.machine.memory.poke(at + k, dirty[k : k + BYTES])
        self.clean[at] = dirty

    def _bus_address(self, at: int) -> int:
        return next(address for address, buffer in self.buffers.items() if ctypes.addressof(buffer) == at)

    def flush(self, at: int, size: int) -> None:
        address, data = self._bus_address(at), ctypes.string_at(at, size)
        self.machine.memory.poke(address, data)
        self.clean[address] = data + self.clean[address][size:]

    def invalidate(self, at: int, size: int) -> None:
        address = self._bus_address(at)
        data = self.machine.memory.peek(address, size)
        ctypes.memmove(at, data, size)
        self.clean[address] = data + self.clean[address][size:]

    @resume
    async def _interrupted(self) -> bool:
        for _ in range(PATIENCE):
            if self.machine.dut.irq.value == 1 or self.woken:
                return True
            await RisingEdge(self.machine.dut.clk)
        return False

    @resume
    async def _low(self) -> None:
        await ClockCycles(self.machine.dut.clk, 4)
        assert self.machine.dut.irq.value == 0, "the handler has not acknowledged"

    def wait(self) -> bool:
        """Wait for the interrupt; every second call wakes spuriously."""
        self.naps += 1
        if self.naps % 2:
            return True
        if not self._interrupted():
            return False
        if self.woken:
            self.woken = False
            return True
        assert self.driver.linked.ik_irq(ctypes.byref(self.driver.core)) & 1, "not ours"
        self._low()
        assert not self.driver.linked.ik_irq(ctypes.byref(self.driver.core)) & 1, "an interrupt of another"
        return True

    # ---- calls -------------------------------------------------------------------------------------------------------

    async def start_up(self) -> None:
        assert await bridge(self.driver.start_up)() == "none"

    def targets(self, count: int, arm: str = "metres") -> np.ndarray:
        """Return targets in and out of reach, with phi of many turns."""
        numbers = np.random.default_rng(self.machine.random.randrange(1 << 32))
        d1, d2 = ARMS[arm]
        columns = dict(zip("xyz", numbers.uniform(-0.8, 0.8, (3, count)) * (d1 + d2), strict=True))
        columns |= {"phi": numbers.normal(0, 100, count), "d1": np.full(count, d1)}
        columns["d2"] = d2 * numbers.uniform(0.5, 1, count)
        return self.driver.targets(columns, numbers.integers(0, 1 << 32, count))

    async def call(self, targets: np.ndarray, code: str = "none", written: int | None = None, address: int = 0) -> None:
        """Solve targets, expect this code, and compare target words and all returned results with the model."""
        self.jobs.clear()
        written = (len(targets) if code == "none" else 0) if written is None else written
        machine, core = self.machine, self.driver.core
        got, results = await bridge(self.driver.solve)(targets)
        said = f"{got} with {core.written} of {len(targets)}, {core.error_address:#x}; {machine.memory.errors[:1]}"
        assert (got, core.written, core.error_address) == (code, written, address), said
        words, _ = to_words(Targets(name="test", **{name: targets[name] for name in FIELDS}), 32)
        records = target_records(words, targets["tag"])
        placed = b"".join(self.jobs)
        assert not written or placed == records[: max(len(placed), written * BYTES)], "words of targets"
        answers, flags, tags = machine.answers(records)
        values = result_values(answers, machine.width)[:written]
        assert (results["qs"] == values[:, :4]).all() and (results["qe"] == values[:, 4:]).all(), "values"
        assert (results["flags"] == flags[:written]).all() and (results["tag"] == tags[:written]).all(), "flags, tags"

    async def good_call(self, count: int = 5) -> None:
        self.machine.memory.faults.clear()
        await self.call(self.targets(count))


async def ready(dut, interrupt: bool, seed: int = 1, **options) -> Platform:
    platform = Platform(await started(dut, seed=seed, pool=8), interrupt, **options)
    await platform.start_up()
    return platform


MODES = cocotb.parametrize(interrupt=[False, True])


@cocotb.test()
async def who_is_there(dut):
    """ik_init reports the core's parameters and aborts a job that was already running."""
    machine = await started(dut, pool=60)
    machine.place(0x10000, 0, 60)
    await machine.write("IRQ_ENABLE", 7)
    await machine.start(0x10000, 0x20000, 60)
    platform = Platform(machine, interrupt=False)
    await platform.start_up()
    core = platform.driver.core
    assert (core.width, core.data_width, core.addr_width) == (machine.width, machine.data_width, machine.addr_width)
    assert (core.latency, core.lean) == (int(dut.LATENCY.value), machine.datapath == "lean")
    assert await machine.read("IRQ_ENABLE") == 0 and await machine.read("STATUS") == 0
    await platform.good_call()
    assert dut.irq.value == 0
    machine.check()


@cocotb.test()
@MODES
@cocotb.parametrize(arm=list(ARMS))
async def solves(dut, interrupt, arm):
    """Calls shorter than a buffer, of exactly one and of several buffers, with arms in any unit."""
    platform = await ready(dut, interrupt)
    if arm == "large":
        platform.machine.stall(*CHANNELS)
    for count in (1, RECORDS, 2 * RECORDS + 3):
        await platform.call(platform.targets(count, arm))
        assert len(platform.jobs) == -(-count // RECORDS)
    platform.machine.check()


@cocotb.test()
@MODES
@cocotb.parametrize(on=["read", "write"])
@cocotb.parametrize(answer=["slverr", "decerr"])
async def error_on_the_bus(dut, interrupt, on, answer):
    """A bus error in the second job of a call keeps the results written before it."""
    platform = await ready(dut, interrupt)
    machine = platform.machine
    for bad in (0, RECORDS - 2):
        area = platform.source if on == "read" else platform.destination
        place = address = area + bad * BYTES
        if on == "write":  # ERROR is the address of its burst
            address = max(area, place - place % (machine.whole * BYTES))
        second = cocotb.start_soon(fault_in_second_job(platform, place, AxiResp[answer.upper()]))
        written = RECORDS + (address - area) // BYTES
        await platform.call(platform.targets(2 * RECORDS + 3), f"{on}_{answer}", written, address)
        second.cancel()
        await platform.good_call()
    machine.check()


async def fault_in_second_job(platform: Platform, place: int, answer: AxiResp) -> None:
    while len(platform.jobs) < 2:
        await RisingEdge(platform.machine.dut.clk)
    platform.machine.memory.faults = {place: answer}


@cocotb.test()
@MODES
async def refused_areas(dut, interrupt):
    """Illegal buffers are refused with the matching code and without any access."""
    machine = await started(dut, pool=8)
    source, destination = areas(machine)
    beyond = (1 << machine.addr_width) - 4 * BYTES
    cases = [
        (source + 4, destination, "source_misaligned"),
        (source, destination + 16, "destination_misaligned"),
        (beyond, destination, "source_beyond"),
        (source, beyond, "destination_beyond"),
        (source, source + 4 * BYTES, "overlap"),
    ]
    for places in cases:
        platform = Platform(machine, interrupt, places=places[:2])
        await platform.start_up()
        await platform.call(platform.targets(5), places[2], 0, places[0] if "source" in places[2] else places[1])
    assert not (machine.monitor.bursts_read or machine.monitor.bursts_written), "an access of a job that was refused"
    platform = Platform(machine, interrupt)
    await platform.start_up()
    await platform.good_call()
    machine.check()


@cocotb.test()
@MODES
async def busy(dut, interrupt):
    """A job of another host is left alone and nothing is written, even if it started just before ours."""
    platform = await ready(dut, interrupt)
    machine = platform.machine
    machine.stall("r", "w")
    other = (0x10000, 0x10000 + 8 * BYTES)
    machine.place(other[0], 0, 8)
    await machine.start(*other, 8)
    await platform.call(platform.targets(5), "busy")
    assert not platform.jobs and (await machine.ended())["done"] == 1
    machine.compare(other[1], 0, 8)
    await platform.good_call()
    platform.race = True
    await platform.call(platform.targets(5), "busy")
    platform.race = False
    await machine.ended()
    await platform.good_call()
    machine.check()


@cocotb.test()
@MODES
async def aborted(dut, interrupt):
    """An abort from another thread during a call soft-resets the core and leaves the bus quiet."""
    platform = await ready(dut, interrupt, seed=3)
    machine = platform.machine
    machine.reader.ar_channel.pause = True  # keeps the job running

    async def elsewhere():
        await ClockCycles(dut.clk, 700)
        platform.driver.linked.ik_abort(ctypes.byref(platform.driver.core))
        platform.woken = True
        machine.reader.ar_channel.pause = False

    task = cocotb.start_soon(elsewhere())
    await platform.call(platform.targets(2 * RECORDS), "aborted")
    await task
    assert machine.monitor.quiet() and await machine.read("STATUS") == 0 and len(platform.jobs) == 1
    await platform.good_call(2 * RECORDS)
    machine.check()


@cocotb.test()
@MODES
async def memory_hangs(dut, interrupt):
    """A hanging memory times the call out; further calls report busy until the memory responds."""
    platform = await ready(dut, interrupt, polls=30)
    machine = platform.machine
    machine.reader.r_channel.pause = True
    await platform.call(platform.targets(5), "timeout")
    assert (await machine.fields("STATUS"))["busy"] == 1
    await platform.call(platform.targets(5), "busy")
    machine.reader.r_channel.pause = False
    assert not any((await machine.ended()).values()), "it was not aborted"
    await platform.good_call()
    machine.check()

# SPDX-License-Identifier: Apache-2.0
"""Tests of the C driver on a simulated ``ik_axi``. The driver runs in a thread; register accesses take simulated time.

IK_DRIVER is the path of the driver's shared library. Target words in memory and results must equal the model's.
"""

import ctypes
import os
from pathlib import Path

import cocotb
import numpy as np
from cocotb.task import bridge, resume
from cocotb.triggers import ClockCycles, RisingEdge
from cocotbext.axi import AxiResp

from model.io.flags import BAD_HAND, OVER_BIT
from model.io.words import FIELDS, Targets, result_values, to_words
from tb.axi.bench import ARM, BYTES, CHANNELS, LAYOUT, Bench, bench_test
from tb.axi.binding import REGISTER, Driver

LIBRARY = Path(os.environ["IK_DRIVER"])
RECORDS = 24  # capacity of each buffer in records
SIZE = RECORDS * BYTES
PAGE = 4096  # bytes of a segment of the simulated memory
PATIENCE = 4000  # maximum number of clocks until an interrupt


class Platform:
    """Buffers and callbacks of the driver: polling with coherent memory, or interrupts with a non-coherent cache.

    A real cache may write back dirty lines of the result buffer at any time; this model does so at the end of a job.
    """

    def __init__(self, bench: Bench, interrupt: bool, polls: int = 2000) -> None:
        self.bench, self.memory, self.interrupt = bench, bench.memory, interrupt
        self.buffers: dict[int, ctypes.Array] = {}  # bus address -> the CPU's view
        self.clean: dict[int, bytes] = {}  # cache contents when last coherent with memory
        self.jobs: list[bytes] = []  # target records of each job
        self.waits = 0
        self.running = False  # the driver has started a job
        self.woken = False  # an abort has ended the wait
        self.race = False  # another host starts a job just before the driver does
        self.second_faults: dict[int, AxiResp] = {}  # memory faults during the second job of a call
        base = (3 << 36) * (bench.addr_width > 37)
        self.source, self.destination = base + 0x41000 - 5 * BYTES, base + 0x82000 - 2 * BYTES
        self.areas = [(self._buffer(address), address) for address in (self.source, self.destination)]
        self.driver = Driver(LIBRARY, self, RECORDS, interrupt=interrupt, polls=polls, arm=ARM)

    def _buffer(self, address: int) -> int:
        """Create the buffer at a bus address and return the CPU's pointer to it."""
        if self.interrupt:
            self.buffers[address] = ctypes.create_string_buffer(b"\xa5" * SIZE, SIZE)
            self.clean[address] = b""
            return ctypes.addressof(self.buffers[address])
        first = address - address % PAGE
        held = self.memory.read(first, -(-(address % PAGE + SIZE) // PAGE) * PAGE)
        self.buffers[address] = buffer = ctypes.create_string_buffer(held, len(held))
        for at in range(0, len(held), PAGE):  # shared by CPU and bus
            self.memory.segs[first + at] = memoryview(buffer).cast("B")[at : at + PAGE]
        return ctypes.addressof(buffer) + address % PAGE

    @resume
    async def read(self, offset: int) -> int:
        return await self.bench.read(REGISTER[offset])

    @resume
    async def _write(self, offset: int, value: int) -> None:
        answer = await self.bench.write(REGISTER[offset], value)
        assert answer == AxiResp.OKAY, f"write to {REGISTER[offset]}: {answer}"

    def write(self, offset: int, value: int) -> None:
        memory, register = self.memory, REGISTER[offset]
        if register == "COUNT":
            memory.readable = (self.source, self.source + value * BYTES)
            memory.writable = (self.destination, self.destination + value * BYTES)
        if (register, value) == ("CONTROL", 1):
            self.bench.monitor.failed.clear()
            self.running = True
            self.jobs.append(memory.read(self.source, memory.readable[1] - self.source))
            if len(self.jobs) == 2:
                memory.faults = self.second_faults
            if self.race:
                self._write(offset, value)
        if register == "IRQ_STATUS" and self.interrupt and self.running:
            self.running = False
            self._evict()
        self._write(offset, value)

    def _evict(self) -> None:
        at, clean = self.destination, self.clean[self.destination]
        dirty = self.buffers[at].raw
        for k in range(0, SIZE, BYTES):
            if dirty[k : k + BYTES] != clean[k : k + BYTES]:
                self.memory.write(at + k, dirty[k : k + BYTES])
        self.clean[at] = dirty

    def _bus_address(self, at: int) -> int:
        return next(address for address, buffer in self.buffers.items() if ctypes.addressof(buffer) == at)

    def flush(self, at: int, size: int) -> None:
        address, data = self._bus_address(at), ctypes.string_at(at, size)
        self.memory.write(address, data)
        self.clean[address] = data + self.clean[address][size:]

    def invalidate(self, at: int, size: int) -> None:
        address = self._bus_address(at)
        data = self.memory.read(address, size)
        ctypes.memmove(at, data, size)
        self.clean[address] = data + self.clean[address][size:]

    @resume
    async def _interrupted(self) -> bool:
        for _ in range(PATIENCE):
            if self.bench.dut.irq.value == 1 or self.woken:
                return True
            await RisingEdge(self.bench.dut.clk)
        return False

    @resume
    async def _low(self) -> None:
        await ClockCycles(self.bench.dut.clk, 4)
        assert self.bench.dut.irq.value == 0, "the interrupt is not acknowledged"

    def wait(self) -> bool:
        """Wait for the interrupt; return False on timeout. Every second call returns at once: a spurious wake-up."""
        self.waits += 1
        if self.waits % 2:
            return True
        if not self._interrupted():
            return False
        if self.woken:
            self.woken = False
            return True
        assert self.driver.call("ik_irq") & 1, "ik_irq ignores the interrupt"
        self._low()
        assert not self.driver.call("ik_irq") & 1, "ik_irq handles an interrupt of another device"
        return True

    def targets(self, count: int) -> np.ndarray:
        """Return random targets, in and out of reach, with phi of many turns."""
        numbers = np.random.default_rng(self.bench.random.randrange(1 << 32))
        d1, d2 = 0.33, 0.27
        columns = dict(zip("xyz", numbers.uniform(-0.8, 0.8, (3, count)) * (d1 + d2), strict=True))
        columns |= {"phi": numbers.normal(0, 100, count), "d1": np.full(count, d1)}
        columns["d2"] = d2 * numbers.uniform(0.5, 1, count)
        if ARM:
            hand = numbers.normal(0, 1, (count, 4))
            columns |= {"tool": numbers.uniform(-0.2, 0.2, count), "branch": numbers.integers(0, 8, count)}
            columns["hand"] = hand / np.linalg.norm(hand, axis=1)[:, None] * numbers.choice([1, 1, 1.1], (count, 1))
        return self.driver.targets(columns, numbers.integers(0, 1 << 32, count))

    async def call(self, targets: np.ndarray, code: str = "none", written: int | None = None, address: int = 0) -> None:
        """Solve targets; check the code, the number of results and the error address; compare words with the model."""
        self.jobs.clear()
        written = (len(targets) if code == "none" else 0) if written is None else written
        bench, core = self.bench, self.driver.core
        got, results = await bridge(self.driver.solve)(targets)
        seen = f"{got} with {core.written} of {len(targets)}, {core.error_address:#x}; {bench.memory.errors[:1]}"
        assert (got, core.written, core.error_address) == (code, written, address), seen
        words, exponent = to_words(Targets(name="test", **{name: targets[name] for name in FIELDS}), 32)
        tags = targets["tag"]
        if ARM:
            more = np.column_stack([np.ldexp(targets["tool"], exponent), targets["hand"]])
            words = np.hstack([words, np.rint(np.ldexp(more, 30)).astype(np.int64)])
            tags = targets["branch"].astype(np.int64) << 24 | tags & 0xFFFFFF
        records = LAYOUT.packed(words, tags)
        placed = b"".join(self.jobs)
        assert not written or placed == records[: max(len(placed), written * BYTES)], "words of targets"
        answers, flags, tags = bench.answers(records)
        values, first = result_values(answers, bench.width)[:written], 7 * ARM
        assert (results["qs"] == values[:, first:][:, :4]).all(), "qs"
        assert (results["qe"] == values[:, first + 4 :]).all(), "qe"
        if ARM:
            assert (results["th"] == answers[:written, :7] * (2 * np.pi / 2**bench.width)).all(), "th"
            assert (results["over_limit"] == (flags >> OVER_BIT | flags & BAD_HAND)[:written]).all(), "over_limit"
        assert (results["flags"] == flags[:written] & 255).all(), "flags"
        assert (results["tag"] == tags[:written]).all(), "tags"

    async def good_call(self, count: int = 5) -> None:
        self.bench.memory.faults.clear()
        await self.call(self.targets(count))


async def ready(bench: Bench, interrupt: bool, **options) -> Platform:
    platform = Platform(bench, interrupt, **options)
    assert await bridge(platform.driver.start_up)() == "none"
    return platform


MODES = cocotb.parametrize(interrupt=[False, True])


@bench_test()
async def ik_init(bench):
    """ik_init reports the core's parameters and aborts a job that was already running."""
    await bench.write("IRQ_ENABLE", 7)
    await bench.start(0x10000, 0x20000, 60, first=0)
    platform = await ready(bench, interrupt=False)
    core = platform.driver.core
    assert (core.width, core.data_width, core.addr_width) == (bench.width, bench.data_width, bench.addr_width)
    assert (core.latency, core.lean) == (int(bench.dut.LATENCY.value), bench.datapath != "paper")
    assert (core.arm, core.fold) == (ARM, bench.datapath.startswith("fold"))
    assert await bench.read("IRQ_ENABLE") == 0 and await bench.read("STATUS") == 0
    await platform.good_call()
    assert bench.dut.irq.value == 0


@MODES
@cocotb.parametrize(stalled=[False, True])
@bench_test()
async def solves(bench, interrupt, stalled):
    """Solve one target, exactly one buffer of targets, and more than two buffers of targets."""
    platform = await ready(bench, interrupt)
    if stalled:
        bench.stall(*CHANNELS)
    for count in (1, RECORDS, 2 * RECORDS + 3):
        await platform.call(platform.targets(count))
        assert len(platform.jobs) == -(-count // RECORDS)


@cocotb.parametrize(on=["read", "write"])
@cocotb.parametrize(answer=["slverr", "decerr"])
@bench_test()
async def bus_error(bench, on, answer):
    """After a bus error in its second job, a call returns the error's code and the results written before the error."""
    platform = await ready(bench, interrupt=True)
    for bad in (0, RECORDS - 2):
        area = platform.source if on == "read" else platform.destination
        place = address = area + bad * BYTES
        if on == "write":  # ERROR has the address of the burst
            address = max(area, place - place % (bench.per_burst * BYTES))
        platform.second_faults = {place: AxiResp[answer.upper()]}
        written = RECORDS + (address - area) // BYTES
        await platform.call(platform.targets(2 * RECORDS + 3), f"{on}_{answer}", written, address)
        await platform.good_call()


@bench_test()
async def busy(bench):
    """A call during another host's job, even if the job has just started, returns busy and does not disturb the job."""
    platform = await ready(bench, interrupt=True)
    bench.stall("r", "w")
    other = 0x10000 + 8 * BYTES  # destination of the other host's job
    await bench.start(0x10000, other, 8, first=0)
    await platform.call(platform.targets(5), "busy")
    assert not platform.jobs and (await bench.ended())["done"] == 1
    bench.compare(other, 0, 8)
    await platform.good_call()
    platform.race = True
    await platform.call(platform.targets(5), "busy")
    platform.race = False
    await bench.ended()
    await platform.good_call()


@MODES
@bench_test(seed=3)
async def aborted(bench, interrupt):
    """An abort from another thread during a call soft-resets the core and leaves the bus quiet."""
    platform = await ready(bench, interrupt)
    bench.channel("ar").pause = True  # keeps the job running

    async def abort():
        await ClockCycles(bench.dut.clk, 700)
        platform.driver.linked.ik_abort(ctypes.byref(platform.driver.core))
        platform.woken = True
        bench.channel("ar").pause = False

    task = cocotb.start_soon(abort())
    await platform.call(platform.targets(2 * RECORDS), "aborted")
    await task
    assert bench.monitor.quiet() and await bench.read("STATUS") == 0 and len(platform.jobs) == 1
    await platform.good_call(2 * RECORDS)


@MODES
@bench_test()
async def memory_hangs(bench, interrupt):
    """A call times out when the memory hangs; further calls return busy until the memory responds."""
    platform = await ready(bench, interrupt, polls=60)
    bench.channel("r").pause = True
    await platform.call(platform.targets(5), "timeout")
    assert (await bench.fields("STATUS"))["busy"] == 1
    await platform.call(platform.targets(5), "busy")
    bench.channel("r").pause = False
    assert not any((await bench.ended()).values()), "the job was not aborted"
    await platform.good_call()

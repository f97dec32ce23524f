# SPDX-License-Identifier: Apache-2.0
"""Bench of ``ik_axi``: clock, register access, memory with faults, monitor of the memory port, checks of results."""

import functools
import logging
import os
import random
from collections.abc import Callable, Iterator

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.queue import Queue
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, SimTimeoutError, Timer, with_timeout
from cocotb.utils import get_sim_time
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiReadBus, AxiResp, AxiWriteBus
from cocotbext.axi.axi_slave import AxiSlaveRead, AxiSlaveWrite
from cocotbext.axi.sparse_memory import SparseMemory

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.io.stimuli import arm_targets, mixed
from model.io.words import ARM_RECORDS, RECORDS
from tb.axi.ik_regs import FIELDS, OFFSETS
from tb.sim.timeout import timed_test

SEED = int(os.environ.get("IK_AXI_SEED", "0"))  # seed that changes the jobs, targets and pauses of every test

PERIOD = 10  # clock period in ns
BURSTS = 8  # maximum number of outstanding bursts in each direction
ACCESS = 5000  # maximum number of clocks from the start of a register access to its response
PATIENCE = 50000  # maximum number of clocks without a handshake on the memory port

ARM = bool(getattr(getattr(getattr(cocotb, "top", None), "ARM", None), "value", 0))
"""True if the simulated instance solves hand poses (parameter ARM = 1)."""

LAYOUT = ARM_RECORDS if ARM else RECORDS
BYTES = LAYOUT.size

CHANNELS = ("ar", "r", "aw", "w", "b", "lite")
"""Names for `Bench.stall`: the channels of the memory port, and ``lite`` for all channels of the register port."""


class Memory(SparseMemory):
    """Sparse memory. `errors` has a message for each access outside the source and destination areas."""

    def __init__(self) -> None:
        super().__init__(1 << 64)
        self.faults: dict[int, AxiResp] = {}  # address of a 32-bit word -> response
        self.readable = self.writable = (0, 0)  # first byte, first byte after the area
        self.errors: list[str] = []

    def access(self, kind: str, area: tuple[int, int], address: int, length: int) -> AxiResp | None:
        """Record an error if an access leaves ``area``. Return the first fault in the accessed bytes, or None."""
        if not (area[0] <= address and address + length <= area[1]):
            now = f"{get_sim_time('ns'):.0f} ns"
            self.errors.append(f"{kind} of {length} bytes at {address:#x}, outside {area[0]:#x} to {area[1]:#x}, {now}")
        return next((code for at, code in self.faults.items() if address <= at < address + length), None)


class Responder:
    """Mixin for `Reader` and `Writer`: delay each response by ``latency`` clocks, in order; insert injected faults."""

    letter: str  # name of the response channel

    def __init__(self, bus, clock, reset, memory: Memory, latency: int) -> None:
        super().__init__(bus, clock, reset, target=memory)
        self.fault: AxiResp | None = None
        channel = getattr(self, f"{self.letter}_channel")
        send, waiting = channel.send, Queue()

        async def forward():
            while True:
                item, due = await waiting.get()
                if (left := round((due - get_sim_time("ns")) / PERIOD)) > 0:
                    await ClockCycles(self.clock, left)
                await send(item)

        async def accept(item):
            if self.fault is not None:
                setattr(item, f"{self.letter}resp", self.fault)
                self.fault = None
            if latency:
                waiting.put_nowait((item, get_sim_time("ns") + latency * PERIOD))
            else:
                await send(item)

        channel.send = accept
        if latency:
            cocotb.start_soon(forward())


class Reader(Responder, AxiSlaveRead):
    letter = "r"

    async def _read(self, address, length):
        self.fault = self.target.access("read", self.target.readable, address, length)
        return self.target.read(address, length)


class Writer(Responder, AxiSlaveWrite):
    """Write channels of the memory. A beat with a fault is not written; the other beats of its burst are written."""

    letter = "b"

    async def _write(self, address, data):
        fault = self.target.access("write", self.target.writable, address, len(data))
        self.fault = self.fault or fault
        if fault is None:
            self.target.write(address, data)


class Monitor:
    """Monitor of the memory port, sampled at every falling edge. It checks what tb/axi/rules does not.

    `Bench.check` fails if `errors` is not empty. A reset clears only the state of open transactions.
    """

    def __init__(self, dut, record_beats: int) -> None:
        self.dut, self.record_beats = dut, record_beats
        self.errors: list[str] = []
        self.clock = 0
        self.beats: dict[str, list[int]] = {"ar": [], "r": []}  # clocks of the handshakes
        self.bursts: dict[str, list[tuple[int, int]]] = {"ar": [], "aw": []}  # address, beats
        self.most = {"reads": 0, "writes": 0, "places": 0}
        self.valid = {name: getattr(dut, f"m_axi_{name}valid") for name in CHANNELS[:-1]}
        self.ready = {name: getattr(dut, f"m_axi_{name}ready") for name in CHANNELS[:-1]}
        parts = ("addr", "len", "size", "burst", "cache", "prot", "id")
        self.payload = {name: [getattr(dut, f"m_axi_{name}{part}") for part in parts] for name in self.bursts}
        self.kind = ((BYTES // record_beats).bit_length() - 1, 1, 0b0011, 0, 0)  # size, burst, cache, prot, id
        core = dut.u_records.g_arm.u_arm if ARM else dut.u_records.g_axis.u_axis
        self.axis_valid, self.axis_ready = core.s_axis_tvalid, core.s_axis_tready
        self.targets = dut.u_records.g_wait.u_targets if int(dut.DATAPATH.value) == 2 else None  # of a folded core
        self._clear()

    def _clear(self) -> None:
        self.open = {"ar": 0, "aw": 0}  # bursts requested and not yet complete
        self.requested = self.sent = 0  # beats
        self.moved = self.clock  # clock of the last handshake
        self.failed: dict[str, int] = {}  # address channel -> clock of the first error, after which no burst may start
        self.offered: set[str] = set()  # address channels whose current burst is counted but not yet accepted

    def error(self, text: str) -> None:
        self.errors.append(f"clock {self.clock}: {text}")

    async def run(self) -> None:
        await Timer(1, unit="ns")
        while True:
            await FallingEdge(self.dut.clk)
            self.clock += 1
            assert self.clock - self.moved < PATIENCE, f"no beat for {PATIENCE} clocks; {self.errors[:1]}"
            if self.dut.rst.value == 0:
                self._sample()
            else:
                self._clear()

    def _sample(self) -> None:
        valid = {name for name, handle in self.valid.items() if handle.value == 1}
        moved = {name for name in valid if self.ready[name].value == 1}
        for name in sorted(valid & self.bursts.keys() - self.offered):
            self._burst(name, *(int(handle.value) for handle in self.payload[name]))
        self.offered = valid & self.bursts.keys() - moved
        if moved:
            self.moved = self.clock
        self.sent += "w" in moved
        for name in moved & self.beats.keys():
            self.beats[name].append(self.clock)
        if "r" in moved:
            self.open["ar"] -= int(self.dut.m_axi_rlast.value)
            if self.dut.m_axi_rresp.value != 0:
                self.failed.setdefault("ar", self.clock)
        if "b" in moved:
            self.open["aw"] -= 1
            if self.dut.m_axi_bresp.value != 0:
                self.failed = {name: self.clock for name in self.bursts} | self.failed
        for name in ("r", "b"):
            if self.ready[name].value != 1:
                self.error(f"m_axi_{name}ready is low")
        if self.targets is None:
            if self.axis_valid.value == 1 and self.axis_ready.value != 1:
                self.error("the core is not ready for a target")
        elif self.targets.wr_en.value == 1:
            slots = 1 << int(self.targets.LOG2.value)
            if (int(self.targets.wr_ptr.value) - int(self.targets.rd_ptr.value)) % (2 * slots) == slots:
                self.error("the FIFO of targets is full")
        if moved or self.offered:
            counts = (*self.open.values(), -(-(self.requested - self.sent) // self.record_beats))
            self.most = {name: max(most, n) for (name, most), n in zip(self.most.items(), counts, strict=True)}

    def _burst(self, name: str, address: int, length: int, *kind: int) -> None:
        self.bursts[name].append((address, length + 1))
        self.open[name] += 1
        self.requested += (name == "ar") * (length + 1)
        if self.clock > self.failed.get(name, self.clock) + 1:
            self.error(f"m_axi_{name}: a burst after an error")
        if self.open[name] > BURSTS:
            self.error(f"m_axi_{name}: {self.open[name]} outstanding bursts, at most {BURSTS} allowed")
        if kind != self.kind:
            self.error(f"m_axi_{name}: size, burst, cache, prot, id are {kind}, expected {self.kind}")

    def quiet(self) -> bool:
        return not any(self.open.values())


def random_words(count: int, seed: int) -> np.ndarray:
    """Return 32-bit words of ``count`` wrist targets of all kinds, shape (N, 6); if ARM, of hand poses, (N, 11)."""
    words = arm_targets(count, 32, seed)[:, :11] if ARM else mixed(count, 32, seed)
    numbers = np.random.default_rng(seed)
    words[::7, :3] += numbers.integers(-(1 << 14), 1 << 14, (len(words[::7]), 3))  # low bits, rounded if W < 32
    words[5, :6] = (2**31 - 1, -(2**31), 2**31 - 1, 2**31 - 1, 2**31 - 1, 1)  # saturation and wrap-around
    return np.clip(words, -(2**31), 2**31 - 1)


class Bench:
    """Bench of one ``ik_axi``. It drives the clock, so a test creates only one bench. Jobs use a pool of targets."""

    def __init__(self, dut, seed: int = 1, latency: int = 0, words: np.ndarray | None = None) -> None:
        self.dut = dut
        for name in ("cocotb", "cocotb.regression"):
            logging.getLogger(f"{name}.{dut._name}").setLevel(logging.WARNING)
        seed += 100 * SEED  # the seeds of tests are below 100
        self.random = random.Random(seed)
        Clock(dut.clk, PERIOD, unit="ns").start(start_high=False)
        dut.rst.value = 1
        self.width, self.data_width = int(dut.W.value), int(dut.DATA_W.value)
        self.addr_width = int(dut.ADDR_W.value)
        number = int(dut.DATAPATH.value)
        self.datapath = {1: "arm", 2: "fold_arm"}[number] if ARM else ("paper", "lean", "fold")[number]
        self.limits: list[tuple[int, int]] | None = None  # (low, high) of each joint, in words of the core
        self.registers = [name for name in OFFSETS if ARM or not name.startswith("LIMIT_")]
        self.beats = 8 * BYTES // self.data_width  # beats of a record
        self.per_burst = 1 << int(dut.LOG2_BURST.value)  # records of a whole burst
        self.latency = fixed.latency(self.datapath, self.width)
        self.lap = MODELS[self.datapath].lap(self.width)  # clocks from one target to the next
        # FIFO slots of the core, or of targets in front of a folded one
        self.places = 2 * self.per_burst if number == 2 else 1 << self.latency.bit_length()
        self.memory = Memory()
        self.monitor = Monitor(dut, self.beats)
        cocotb.start_soon(self.monitor.run())
        self.lite = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axi"), dut.clk, dut.rst)
        self.reader = Reader(AxiReadBus.from_prefix(dut, "m_axi"), dut.clk, dut.rst, self.memory, latency)
        self.writer = Writer(AxiWriteBus.from_prefix(dut, "m_axi"), dut.clk, dut.rst, self.memory, latency)
        words = random_words(600, seed) if words is None else words
        self.pool = len(words)
        self.records = LAYOUT.packed(words, np.random.default_rng(seed + 1).integers(0, 1 << 32, self.pool))
        self.results, self.flags, self.tags = self.answers(self.records)

    def answers(self, records: bytes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the model's results, flags and tags for target records."""
        kept, tags, branch = LAYOUT.core_words(records, self.width)
        names = list(MODELS[self.datapath].results)
        if os.environ.get("IK_AXI_CORE") == "echo" and ARM:  # tb/axi/ik_lean_arm.v
            results, flags = kept[:, np.arange(len(names)) % 11], kept[:, 0] & 0xFFFF ^ branch << 13
        elif os.environ.get("IK_AXI_CORE") == "echo":  # tb/axi/ik_lean.v
            results, flags = np.roll(kept, 1, axis=1), kept[:, 0] & 0xFF
        else:
            answer = fixed.run(kept, self.width, self.datapath, branch, self.limits)
            results, flags = answer.results, answer.flags
        return results[:, [names.index(name) for name in LAYOUT.results]], flags, tags

    def place(self, source: int, first: int, count: int) -> None:
        """Write ``count`` targets, from index ``first`` of the pool, to address ``source``; wrap at the pool's end."""
        data = (self.records * (2 + (first + count) // self.pool))[first * BYTES : (first + count) * BYTES]
        self.memory.write(source, data)

    async def reset(self) -> None:
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 1
        for _ in range(int(os.environ.get("IK_RESET", "3"))):
            await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)

    async def write(self, register: str, value: int) -> AxiResp:
        access = self.lite.write(OFFSETS[register], value.to_bytes(4, "little"))
        return (await self._answer(access, f"write of {register}")).resp

    async def read(self, register: str) -> int:
        answer = await self._answer(self.lite.read(OFFSETS[register], 4), f"read of {register}")
        assert answer.resp == AxiResp.OKAY, f"{register}: {answer.resp.name} from rtl/axi/ik_axi_regs.v"
        return int.from_bytes(answer.data, "little")

    async def _answer(self, access, what: str):
        try:
            return await with_timeout(access, ACCESS * PERIOD, "ns")
        except SimTimeoutError:
            raise AssertionError(f"no answer to the {what} for {ACCESS} clocks") from None

    async def fields(self, register: str) -> dict[str, int]:
        value = await self.read(register)
        return {name: value >> f.low & (1 << f.high - f.low + 1) - 1 for name, f in FIELDS[register].items()}

    async def wide(self, name: str) -> int:
        return await self.read(f"{name}_LO") | await self.read(f"{name}_HI") << 32

    async def start(self, source: int, destination: int, count: int, first: int | None = None) -> None:
        """Write a job's parameters in random order and start it.

        If ``first`` is given, write targets from this index of the pool, and permit access to the job's areas only.
        """
        values = {"COUNT": count}
        for name, value in (("SOURCE", source), ("DESTINATION", destination)):
            values |= {f"{name}_LO": value & 0xFFFFFFFF, f"{name}_HI": value >> 32}
        names = list(values)
        self.random.shuffle(names)
        for name in names:
            await self.write(name, values[name])
        if first is not None:
            self.place(source, first, count)
            self.memory.readable = (source, source + count * BYTES)
            self.memory.writable = (destination, destination + count * BYTES)
        self.monitor.failed.clear()
        await self.write("CONTROL", 1)

    async def ended(self, most: int = 100000) -> dict[str, int]:
        """Wait for the end of the job and return the fields of STATUS. Raise AssertionError after ``most`` clocks."""
        for _ in range(most):
            await FallingEdge(self.dut.clk)
            if self.dut.u_job.busy.value == 0:
                return await self.fields("STATUS")
        raise AssertionError(f"busy for {most} clocks; {self.monitor.errors[:1]}")

    async def solve(self, source: int, destination: int, count: int, first: int = 0) -> None:
        """Run a job on ``count`` targets from index ``first`` of the pool. Check its success and its results."""
        await self.start(source, destination, count, first)
        status = await self.ended()
        wanted = {"busy": 0, "done": 1, "error": 0, "code": 0}
        assert status == wanted, f"{count} records: {status} {self.monitor.errors[:1]}"
        assert await self.read("WRITTEN") == count
        self.compare(destination, first, count)

    def compare(self, destination: int, first: int, count: int) -> None:
        """Compare results in memory with the model's results for ``count`` targets from index ``first`` of the pool."""
        part = np.arange(first, first + count) % self.pool
        wanted = LAYOUT.written(self.results[part], self.flags[part], self.tags[part], self.width)
        got = self.memory.read(destination, count * BYTES)
        if got != wanted:
            k = next(k for k in range(count) if got[k * BYTES :][:BYTES] != wanted[k * BYTES :][:BYTES])
            rows = [part[k * BYTES :][:BYTES].hex(" ", 4) for part in (got, wanted)]
            raise AssertionError(f"result {k} of {count} at {destination:#x}: {rows[0]}, expected {rows[1]}")

    def check(self) -> None:
        """Check that memory and monitor have recorded no error and that no transaction is open."""
        errors = self.memory.errors + self.monitor.errors
        assert not errors, f"{len(errors)} errors, the first: {errors[0]}"
        assert self.monitor.quiet(), "transactions are open"

    def channel(self, name: str):
        """Return the memory's side of a channel."""
        return getattr(self.reader if name in ("ar", "r") else self.writer, f"{name}_channel")

    def stall(self, *channels: str, share: float = 0.3) -> None:
        """Pause channels at random: each stretch of clocks is a pause with probability ``share``."""
        write, read = self.lite.write_if, self.lite.read_if
        lite = [write.aw_channel, write.w_channel, write.b_channel, read.ar_channel, read.r_channel]
        for name in channels:
            for port in lite if name == "lite" else [self.channel(name)]:
                port.set_pause_generator(self._pauses(share))

    def _pauses(self, share: float) -> Iterator[bool]:
        numbers = random.Random(self.random.random())
        while True:
            stop = numbers.random() < share
            yield from [stop] * (numbers.choice((1, 1, 1, 2, 5, 20)) if stop else numbers.randint(1, 8))


def bench_test(**options) -> Callable:
    """Return a decorator for cocotb tests: start a bench with ``options``, run the test, check the bench."""

    def decorate(function):
        @timed_test()
        @functools.wraps(function)
        async def run(dut, **parameters):
            bench = Bench(dut, **options)
            await bench.reset()
            await function(bench, **parameters)
            bench.check()

        return run

    return decorate

# SPDX-License-Identifier: Apache-2.0
"""Bench of ``ik_axi``: clock, reset, registers, memory, monitor, and the checks of a job's results."""

from __future__ import annotations

import logging
import os
import random
from collections.abc import Iterator

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiReadBus, AxiResp, AxiWriteBus

from model.dataflow import fixed
from model.io.stimuli import mixed
from model.io.words import BYTES, core_words, result_records, target_records
from tb.axi.ik_regs import FIELDS, OFFSETS
from tb.axi.memory import Memory, Reader, Writer
from tb.axi.monitor import Monitor

SEED = int(os.environ.get("IK_AXI_SEED", "0"))
"""Seed that changes the jobs, targets and pauses of every test."""

GUARD = 256
"""Bytes on either side of the results that a job must not change."""


def random_words(count: int, seed: int) -> np.ndarray:
    """Return 32-bit targets of all kinds, (N, 6)."""
    words = mixed(count, 32, seed)
    numbers = np.random.default_rng(seed)
    words[::7, :3] += numbers.integers(-(1 << 14), 1 << 14, (len(words[::7]), 3))  # bits that are rounded
    words[5] = (2**31 - 1, -(2**31), 2**31 - 1, 2**31 - 1, 2**31 - 1, 1)  # saturation and wrap-around
    return np.clip(words, -(2**31), 2**31 - 1)


class Machine:
    """Bench around one ``ik_axi``; it owns the clock, so a test creates one."""

    def __init__(self, dut, seed: int = 1, pool: int = 600, latency: int = 0, words: np.ndarray | None = None) -> None:
        self.dut = dut
        for name in ("cocotb", "cocotb.regression"):
            logging.getLogger(f"{name}.{dut._name}").setLevel(logging.WARNING)
        seed += 100 * SEED  # the seeds of tests are below 100
        self.random = random.Random(seed)
        Clock(dut.clk, 10, unit="ns").start(start_high=False)
        dut.rst.value = 1
        self.width, self.data_width = int(dut.W.value), int(dut.DATA_W.value)
        self.addr_width = int(dut.ADDR_W.value)
        self.datapath = "lean" if int(dut.DATAPATH.value) else "paper"
        self.beats = 256 // self.data_width  # beats of a record
        self.whole = 1 << int(dut.LOG2_BURST.value)  # records of a burst
        self.latency = fixed.latency(self.datapath, self.width)
        self.places = 1 << self.latency.bit_length()  # FIFO slots for one result per clock
        self.memory = Memory()
        self.monitor = Monitor(dut, self.beats, self.whole * self.beats, self.places)
        cocotb.start_soon(self.monitor.run())
        self.lite = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axi"), dut.clk, dut.rst)
        self.reader = Reader(AxiReadBus.from_prefix(dut, "m_axi"), dut.clk, dut.rst, self.memory, latency)
        self.writer = Writer(AxiWriteBus.from_prefix(dut, "m_axi"), dut.clk, dut.rst, self.memory, latency)
        self._pool(random_words(pool, seed) if words is None else words, seed)

    def _pool(self, words: np.ndarray, seed: int) -> None:
        """Create the pool of 32-bit targets and compute the model's results."""
        tags = np.random.default_rng(seed + 1).integers(0, 1 << 32, len(words))
        self.records = target_records(words, tags)
        self.results, self.flags, self.tags = self.answers(self.records)

    def answers(self, records: bytes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the model's results, flags and tags for target records."""
        kept, tags = core_words(records, self.width)
        if os.environ.get("IK_AXI_CORE") == "echo":  # tb/axi/ik_lean.v
            return np.roll(kept, 1, axis=1), kept[:, 0] & 0xFF, tags
        answer = fixed.run(kept, self.width, self.datapath)
        return answer.results, answer.flags, tags

    @property
    def pool(self) -> int:
        return len(self.tags)

    def expected(self, first: int, count: int) -> bytes:
        """Return the result records of ``count`` targets of the pool, starting at ``first``."""
        part = np.arange(first, first + count) % self.pool
        return result_records(self.results[part], self.flags[part], self.tags[part], self.width)

    def place(self, source: int, first: int, count: int) -> None:
        """Write targets of the pool to memory."""
        data = (self.records * (2 + (first + count) // self.pool))[first * BYTES : (first + count) * BYTES]
        self.memory.poke(source, data)

    # ---- registers ---------------------------------------------------------------------------------------------------

    async def reset(self) -> None:
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, 3)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)

    async def write(self, register: str, value: int) -> AxiResp:
        return (await self.lite.write(OFFSETS[register], value.to_bytes(4, "little"))).resp

    async def read(self, register: str) -> int:
        answer = await self.lite.read(OFFSETS[register], 4)
        assert answer.resp == AxiResp.OKAY, f"{register}: {answer.resp}"
        return int.from_bytes(answer.data, "little")

    async def fields(self, register: str) -> dict[str, int]:
        value = await self.read(register)
        return {name: value >> f.low & (1 << f.high - f.low + 1) - 1 for name, f in FIELDS[register].items()}

    async def wide(self, name: str) -> int:
        return await self.read(f"{name}_LO") | await self.read(f"{name}_HI") << 32

    async def start(self, source: int, destination: int, count: int, accepted: bool = True) -> None:
        """Write the parameters in random order, then start; an accepted job may access its areas only."""
        values = {"COUNT": count}
        for name, value in (("SOURCE", source), ("DESTINATION", destination)):
            values |= {f"{name}_LO": value & 0xFFFFFFFF, f"{name}_HI": value >> 32}
        names = list(values)
        self.random.shuffle(names)
        for name in names:
            await self.write(name, values[name])
        if accepted:
            self.memory.readable = (source, source + count * BYTES)
            self.memory.writable = (destination, destination + count * BYTES)
        self.monitor.failed.clear()
        await self.write("CONTROL", 1)

    async def ended(self, most: int = 100000) -> dict[str, int]:
        """Return STATUS at the end of a job; fail after ``most`` clocks."""
        for _ in range(most):
            await FallingEdge(self.dut.clk)
            if self.dut.u_job.busy.value == 0:
                return await self.fields("STATUS")
        raise AssertionError(f"busy for {most} clocks; {self.monitor.errors[:1]}")

    # ---- jobs --------------------------------------------------------------------------------------------------------

    async def solve(self, source: int, destination: int, count: int, first: int = 0) -> None:
        """Run a job that must succeed: every result is right and no other byte changes."""
        self.place(source, first, count)
        size = count * BYTES
        before = (self.memory.peek(destination - GUARD, GUARD), self.memory.peek(destination + size, GUARD))
        await self.start(source, destination, count)
        status = await self.ended()
        wanted = {"busy": 0, "done": 1, "error": 0, "code": 0}
        assert status == wanted, f"{count} records: {status} {self.monitor.errors[:1]}"
        assert await self.read("WRITTEN") == count
        self.compare(destination, first, count)
        after = (self.memory.peek(destination - GUARD, GUARD), self.memory.peek(destination + size, GUARD))
        assert after == before, f"bytes beside {destination:#x} + {size:#x} have changed"

    def compare(self, destination: int, first: int, count: int) -> None:
        """Compare the results in memory with the model's."""
        got, wanted = self.memory.peek(destination, count * BYTES), self.expected(first, count)
        if got != wanted:
            k = next(k for k in range(count) if got[k * BYTES :][:BYTES] != wanted[k * BYTES :][:BYTES])
            rows = [part[k * BYTES :][:BYTES].hex(" ", 4) for part in (got, wanted)]
            raise AssertionError(f"result {k} of {count} at {destination:#x}: {rows[0]}, expected {rows[1]}")

    def check(self) -> None:
        """Check everything that must hold at the end of a test."""
        errors = self.memory.errors + self.monitor.errors
        assert not errors, f"{len(errors)} errors, the first: {errors[0]}"
        assert self.monitor.quiet(), "transactions are open"

    def stall(self, *channels: str, share: float = 0.3) -> None:
        """Pause channels at random: ar, r, aw, w, b, or lite for all register channels."""
        ports = {
            "ar": self.reader.ar_channel,
            "r": self.reader.r_channel,
            "aw": self.writer.aw_channel,
            "w": self.writer.w_channel,
            "b": self.writer.b_channel,
        }
        lite = self.lite.write_if, self.lite.read_if
        for channel in channels:
            if channel == "lite":
                for port in (lite[0].aw_channel, lite[0].w_channel, lite[0].b_channel):
                    port.set_pause_generator(self._pauses(share))
                for port in (lite[1].ar_channel, lite[1].r_channel):
                    port.set_pause_generator(self._pauses(share))
            else:
                ports[channel].set_pause_generator(self._pauses(share))

    def _pauses(self, share: float) -> Iterator[bool]:
        numbers = random.Random(self.random.random())
        while True:
            stop = numbers.random() < share
            yield from [stop] * (numbers.choice((1, 1, 1, 2, 5, 20)) if stop else numbers.randint(1, 8))


CHANNELS = ("ar", "r", "aw", "w", "b", "lite")


async def started(dut, seed: int = 1, **options) -> Machine:
    machine = Machine(dut, seed, **options)
    await machine.reset()
    return machine

# SPDX-License-Identifier: Apache-2.0
"""Memory for tests: AXI4 slaves of cocotbext-axi with injected faults and a check of every access."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

import cocotb
from cocotb.queue import Queue
from cocotb.triggers import ClockCycles
from cocotb.utils import get_sim_time
from cocotbext.axi import AxiResp
from cocotbext.axi.axi_slave import AxiSlaveRead, AxiSlaveWrite

PAGE = 4096

Area = tuple[int, int]
"""First byte, and first byte after the area."""


PERIOD = 10
"""Clock period in ns."""

DEEP = 64
"""Number of transactions that a memory with latency accepts before its first response."""


class Memory:
    """Bytes by address, with a pattern where nothing was written; only two areas may be accessed."""

    def __init__(self) -> None:
        self.pages: dict[int, bytearray] = {}
        self.faults: dict[int, AxiResp] = {}  # address of a 32-bit word -> response
        self.readable: Area = (0, 0)
        self.writable: Area = (0, 0)
        self.errors: list[str] = []

    def _page(self, address: int) -> bytearray:
        number = address // PAGE
        if number not in self.pages:
            self.pages[number] = bytearray((number * 37 + k * 11) & 0xFF for k in range(PAGE))
        return self.pages[number]

    def peek(self, address: int, length: int) -> bytes:
        found = bytearray()
        while len(found) < length:
            at = address + len(found)
            found += self._page(at)[at % PAGE :][: length - len(found)]
        return bytes(found)

    def poke(self, address: int, data: bytes) -> None:
        done = 0
        while done < len(data):
            at = address + done
            part = min(len(data) - done, PAGE - at % PAGE)
            self._page(at)[at % PAGE : at % PAGE + part] = data[done : done + part]
            done += part

    def fault(self, address: int, length: int) -> AxiResp | None:
        return next((code for at, code in self.faults.items() if address <= at < address + length), None)

    def watch(self, what: str, area: Area, address: int, length: int) -> None:
        if not (area[0] <= address and address + length <= area[1]):
            self.errors.append(f"{what} of {length} bytes at {address:#x}, outside of {area[0]:#x} to {area[1]:#x}")


def later(source: Callable[[], Awaitable], clock, clocks: int) -> Callable[[], Awaitable]:
    """Delay the items of ``source`` by ``clocks``, in order and pipelined."""
    waiting: Queue = Queue()

    async def fill():
        while True:
            found = await source()
            waiting.put_nowait((found, get_sim_time("ns") + clocks * PERIOD))

    async def take():
        found, due = await waiting.get()
        left = round((due - get_sim_time("ns")) / PERIOD)
        if left > 0:
            await ClockCycles(clock, left)
        return found

    cocotb.start_soon(fill())
    return take


class Reader(AxiSlaveRead):
    """Read channels; a latency delays all data by this number of clocks."""

    def __init__(self, bus, clock, reset, memory: Memory, latency: int = 0) -> None:
        self.memory = memory
        self.answer: AxiResp | None = None
        super().__init__(bus, clock, reset)
        if latency:
            self.ar_channel.queue_occupancy_limit = DEEP
            self.ar_channel.recv = later(self.ar_channel.recv, clock, latency)
        send = self.r_channel.send

        async def answered(beat):
            if self.answer is not None:
                beat.rresp, self.answer = self.answer, None
            await send(beat)

        self.r_channel.send = answered

    async def _read(self, address, length):
        self.memory.watch("read", self.memory.readable, address, length)
        self.answer = self.memory.fault(address, length)
        return self.memory.peek(address, length)


class Writer(AxiSlaveWrite):
    """Write channels. A faulty beat is not written; the other beats of its burst are."""

    def __init__(self, bus, clock, reset, memory: Memory, latency: int = 0) -> None:
        self.memory = memory
        self.answer: AxiResp | None = None
        super().__init__(bus, clock, reset)
        send = self.b_channel.send
        if latency:
            responses: Queue = Queue()
            due, now = later(responses.get, clock, latency), send

            async def forward():
                while True:
                    await now(await due())

            cocotb.start_soon(forward())
            send = responses.put

        async def answered(response):
            if self.answer is not None:
                response.bresp, self.answer = self.answer, None
            await send(response)

        self.b_channel.send = answered

    async def _write(self, address, data):
        self.memory.watch("write", self.memory.writable, address, len(data))
        fault = self.memory.fault(address, len(data))
        if fault is not None:
            self.answer = self.answer or fault
            return
        self.memory.poke(address, data)

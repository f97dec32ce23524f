# SPDX-License-Identifier: Apache-2.0
"""Test that ``ik_delay`` and ``ik_ring`` return every word N clocks later. Test ``ik_fifo`` against a queue: order,
loss, duplication, stalls, latency, throughput, reset at several fill levels.
"""

import itertools
import random
from collections import deque
from functools import partial

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from tb.units.unit import Case, Tests, checks, runs, sets_of, unsigned

LATENCY = 2  # clocks from writing a word to offering it


def delay(W: int, N: int) -> Tests:
    words = unsigned(W)

    def each_place():
        """Return zeros for every ring location, then ones, then zeros, to toggle every bit."""
        lap = 1 << max(N, 1).bit_length()
        return [word for word in (0, words[-1], 0) for _ in range(lap)]

    return checks({"d": words}, {"q": words}, lambda d: d, each_place, latency=N)


def ring(W: int, N: int) -> Tests:
    async def after_a_reset(test, dut) -> None:
        dut.rst.value = 1
        for level in (0, 1, 0):
            dut.clk.value = level
            await Timer(5, unit="ns")
        dut.rst.value = 0
        await test(dut)

    return {name: partial(after_a_reset, test) for name, test in delay(W, N).items()}


class Fifo:
    """Bench of ``ik_fifo`` with a reference queue and checks in every clock.

    The FIFO is full with ``depth`` words in the memory and one in the output register.
    """

    def __init__(self, dut, width: int, depth: int) -> None:
        self.dut, self.width, self.depth = dut, width, depth
        self.clock = 0
        self.queue: deque[tuple[int, int]] = deque()  # (word, clock of writing)
        self.read: list[tuple[int, int]] = []  # (word, clock of leaving)
        Clock(dut.clk, 10, unit="ns").start(start_high=False)

    def word(self) -> int:
        return random.getrandbits(self.width)

    def has_room(self) -> bool:
        """Return True if a word may be written in the next clock. The word offered then is in the output register."""
        offered = bool(self.queue) and self.queue[0][1] + LATENCY <= self.clock + 1
        return len(self.queue) - offered < self.depth

    async def step(self, word: int | None = None, ready: bool = False, rst: bool = False) -> None:
        """Run one clock; write ``word`` unless it is None; compare the output with the queue."""
        dut = self.dut
        assert word is None or rst or self.has_room(), "the testbench writes into a full FIFO"
        await RisingEdge(dut.clk)
        dut.rst.value = int(rst)
        dut.wr_en.value = int(word is not None)
        dut.wr_data.value = self.word() if word is None else word
        dut.m_ready.value = int(ready)
        await FallingEdge(dut.clk)
        self.clock += 1
        if rst:  # acts at the next rising edge; the output of this clock is still valid
            self.queue.clear()
            return
        where = f"clock {self.clock}, {len(self.queue)} of {self.depth} words inside"
        valid, data = str(dut.m_valid.value), str(dut.m_data.value)
        due = bool(self.queue) and self.queue[0][1] + LATENCY <= self.clock
        assert valid == str(int(due)), f"m_valid={valid}, expected {int(due)} in {where}"
        if due:
            bits = format(self.queue[0][0], f"0{self.width}b")
            assert data == bits, f"m_data={data}, expected {bits} in {where}"
            if ready:
                self.read.append((self.queue.popleft()[0], self.clock))
        if word is not None:
            self.queue.append((word, self.clock))

    async def drain(self) -> None:
        """Read all words, then check for a few clocks that none follows."""
        for _ in range(len(self.queue) + LATENCY):
            await self.step(ready=True)
        assert not self.queue, f"{len(self.queue)} words never came out"
        for _ in range(3):
            await self.step(ready=True)


async def traffic(fifo: Fifo, write: float, read: float) -> None:
    """Write and read with probabilities ``write`` and ``read`` in each clock; only a full FIFO stops the writer."""
    start, count = fifo.clock + 1, 300 + 3 * fifo.depth
    sent = []
    for _ in range(count):
        word = fifo.word() if random.random() < write and fifo.has_room() else None
        sent += [] if word is None else [word]
        await fifo.step(word, ready=random.random() < read)
    await fifo.drain()
    assert [word for word, _ in fifo.read] == sent and len(sent) > 40, f"{len(sent)} words in, {len(fifo.read)} out"
    if write == read == 1 and fifo.depth >= 4:  # a smaller depth does not cover the latency
        assert [clock for _, clock in fifo.read] == list(range(start + LATENCY, start + LATENCY + count))


async def reset_with_words_inside(fifo: Fifo) -> None:
    """Write several words, wait, reset for one clock; check that old words are dropped and new words come out.

    A word written during the reset is dropped as well.
    """
    for fill, wait, writing in itertools.product([0, 1, fifo.depth // 2, fifo.depth], [0, 1, 3], [False, True]):
        for word in [fifo.word() for _ in range(fill)] + [None] * wait:
            await fifo.step(word)
        await fifo.step(fifo.word() if writing else None, ready=bool(wait % 2), rst=True)
        for ready in (True, False, True, True):
            await fifo.step(ready=ready)
        sent = [fifo.word() for _ in range(fifo.depth)]
        fifo.read.clear()
        for word in sent:
            await fifo.step(word)
        await fifo.drain()
        assert [word for word, _ in fifo.read] == sent


def fifo(W: int, LOG2: int) -> Tests:
    tests = {"reset_with_words_inside": reset_with_words_inside}
    for write, read in itertools.product((1, 0.8, 0.2), repeat=2):
        tests[f"traffic_{write}_{read}"] = partial(traffic, write=write, read=read)

    async def started(test, dut) -> None:
        bench = Fifo(dut, W, 1 << LOG2)
        await bench.step(rst=True)
        await test(bench)

    return {name: partial(started, test) for name, test in tests.items()}


CASES = (
    Case("ik_delay", delay, sets_of("W N", (8, 0), (70, 5)), sets_of("W N", (8, 1), (32, 40))),
    Case("ik_ring", ring, sets_of("W N", (40, 18)), sets_of("W N", (8, 3), (16, 12), (96, 65), (2, 300))),
    Case("ik_fifo", fifo, sets_of("W LOG2", (16, 2)), sets_of("W LOG2", (8, 1), (208, 5))),
)
test_storage, vectors = runs(CASES)

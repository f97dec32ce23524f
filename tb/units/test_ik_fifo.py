# SPDX-License-Identifier: Apache-2.0
"""``ik_fifo`` against a queue: order, loss, duplication, stalls, latency, throughput, reset at several fill levels."""

import itertools
import random
from collections import deque
from functools import partial

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from tb.units.unit import Tests, places, runs, sets_of

LATENCY = 2  # clocks from writing a word to offering it


class Fifo:
    """Bench of ``ik_fifo`` with a reference queue and checks in every clock.

    The writer fills it completely: ``depth`` words in the memory and one in the output register.
    """

    def __init__(self, dut, width: int, depth: int) -> None:
        self.dut, self.width, self.depth = dut, width, depth
        self.clock = 0
        self.queue: deque[tuple[int, int]] = deque()  # (word, clock of writing)
        self.read: list[tuple[int, int]] = []  # (word, clock of leaving)
        self.stalled: str | None = None
        Clock(dut.clk, 10, unit="ns").start()

    def word(self) -> int:
        return random.getrandbits(self.width)

    def has_room(self) -> bool:
        """Return True if a word may be written in the next clock; an offered word is then in the output register."""
        offered = bool(self.queue) and self.queue[0][1] + LATENCY <= self.clock + 1
        return len(self.queue) - offered < self.depth

    async def step(self, word: int | None = None, ready: bool = False, rst: bool = False) -> None:
        """Run one clock, writing ``word`` unless it is None."""
        dut = self.dut
        assert word is None or rst or self.has_room(), "the testbench writes into a full FIFO"
        await RisingEdge(dut.clk)
        dut.rst.value = int(rst)
        dut.wr_en.value = int(word is not None)
        dut.wr_data.value = self.word() if word is None else word
        dut.m_ready.value = int(ready)
        await FallingEdge(dut.clk)
        self.clock += 1
        if rst:
            # Reset acts at the next rising edge; the output of this clock is still valid.
            self.queue.clear()
            self.stalled = None
            return
        where = f"clock {self.clock}, {len(self.queue)} of {self.depth} words inside"
        valid, data = str(dut.m_valid.value), str(dut.m_data.value)
        due = bool(self.queue) and self.queue[0][1] + LATENCY <= self.clock
        assert valid == str(int(due)), (
            f"m_valid={valid}, expected {int(due)} in {where}; next word and its clock: {[*self.queue][:1]}"
        )
        if self.stalled is not None:
            assert data == self.stalled, f"m_data changed from {self.stalled} to {data} while stalled, in {where}"
        if due:
            bits = format(self.queue[0][0], f"0{self.width}b")
            assert data == bits, f"m_data={data}, expected {bits} in {where}"
            if ready:
                self.read.append((self.queue.popleft()[0], self.clock))
        self.stalled = data if due and not ready else None
        if word is not None:
            self.queue.append((word, self.clock))

    async def reset(self, clocks: int = 1, **signals) -> None:
        for _ in range(clocks):
            await self.step(rst=True, **signals)

    async def drain(self) -> None:
        """Read all words, then check for a few clocks that none follows."""
        for _ in range(len(self.queue) + LATENCY):
            await self.step(ready=True)
        assert not self.queue, f"{len(self.queue)} words never came out"
        for _ in range(3):
            await self.step(ready=True)


def pattern(name: str, depth: int):
    """Yield an endless pattern of enables, one per clock."""
    while True:
        match name:
            case "always":
                yield True
            case "single":
                yield from (True, False)
            case "random":
                yield random.random() < 0.5
            case "bursts":
                yield from [True] * random.randint(8, depth + 8)
                yield from [False] * random.randint(1, depth + 8)
            case _:
                raise ValueError(name)


async def traffic(fifo, write, read):
    """Compare with the queue in every clock; only the capacity stops the writer."""
    sent = []
    writes, reads = pattern(write, fifo.depth), pattern(read, fifo.depth)
    for may_write, ready, _ in zip(writes, reads, range(300 + 3 * fifo.depth), strict=False):
        word = fifo.word() if may_write and fifo.has_room() else None
        if word is not None:
            sent.append(word)
        await fifo.step(word, ready)
    await fifo.drain()
    assert [word for word, _ in fifo.read] == sent and len(sent) > 40, f"{len(sent)} words in, {len(fifo.read)} out"


async def latency_and_throughput(fifo):
    """The first word leaves two clocks after it was written, then one word per clock."""
    await fifo.step()
    start = fifo.clock + 1
    for k in range(3 * fifo.depth):
        await fifo.step(k % (1 << fifo.width), ready=True)
    await fifo.drain()
    at = [clock - start - LATENCY for _, clock in fifo.read]
    assert at == list(range(3 * fifo.depth)), f"words left {LATENCY} + {at[:10]}.. clocks after the first was written"


async def fill_to_the_brim_and_drain(fifo):
    """Fill the FIFO completely without reading, several times, from different memory addresses."""
    for _ in range(3):
        while fifo.has_room():
            await fifo.step(fifo.word())
        assert len(fifo.queue) == fifo.depth + 1, f"{len(fifo.queue)} words went in"
        for _ in range(5):
            await fifo.step()
        for _ in range(fifo.depth // 4 + 1):
            await fifo.step(ready=True)
        await fifo.drain()


async def reset_with_words_inside(fifo, fill, wait, writing):
    """A reset of one clock, some clocks after the last word: old words are dropped, new ones come out.

    A word written during the reset is dropped as well.
    """
    for _ in range({"empty": 0, "one": 1, "half": fifo.depth // 2, "full": fifo.depth}[fill]):
        await fifo.step(fifo.word())
    for _ in range(wait):
        await fifo.step()
    await fifo.reset(word=fifo.word() if writing else None, ready=bool(wait % 2))
    for ready in (True, False, True, True):
        await fifo.step(ready=ready)
    sent = [fifo.word() for _ in range(fifo.depth)]
    fifo.read.clear()
    for word in sent:
        await fifo.step(word)
    await fifo.drain()
    assert [word for word, _ in fifo.read] == sent


def bench(W: int, LOG2: int) -> Tests:
    tests = {"fill_to_the_brim_and_drain": fill_to_the_brim_and_drain}
    if LOG2 >= 2:  # a smaller depth does not cover the latency
        tests["latency_and_throughput"] = latency_and_throughput
    for write, read in itertools.product(["always", "single", "random", "bursts"], repeat=2):
        tests[f"traffic_{write}_{read}"] = partial(traffic, write=write, read=read)
    for fill, wait, writing in itertools.product(["empty", "one", "half", "full"], [0, 1, 3], [False, True]):
        name = f"reset_{fill}_{wait}{'_writing' if writing else ''}"
        tests[name] = partial(reset_with_words_inside, fill=fill, wait=wait, writing=writing)

    async def started(test, dut) -> None:
        fifo = Fifo(dut, W, 1 << LOG2)
        await fifo.reset()
        await test(fifo)

    return {name: partial(started, test) for name, test in tests.items()} | {"places": places("mem", 1 << LOG2, W)}


fifo = sets_of("W LOG2")
test_ik_fifo = runs("ik_fifo", bench, fifo(16, 2), more=[fifo(8, 1), fifo(208, 9)])

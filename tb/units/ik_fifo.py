# SPDX-License-Identifier: Apache-2.0
"""``ik_fifo`` against a queue: order, loss, repetition, stalls, latency, throughput, reset at several fill levels."""

import random
from collections import deque

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from tb.units.unit import parameters

P = parameters()
W, DEPTH = P["W"], 1 << P["LOG2"]
LATENCY = 2  # clocks from a word's writing to its offer


class Fifo:
    """``ik_fifo``, a queue beside it, and the checks of every clock.

    The writer goes to the limit: DEPTH words in the memory and one in the output register.
    """

    def __init__(self, dut) -> None:
        self.dut = dut
        self.clock = 0
        self.queue: deque[tuple[int, int]] = deque()  # (word, clock of writing)
        self.read: list[tuple[int, int]] = []  # (word, clock of leaving)
        self.stalled: str | None = None
        Clock(dut.clk, 10, unit="ns").start()

    def has_room(self) -> bool:
        """May a word be written in the next clock?  The first is then in the output register if it is offered."""
        offered = bool(self.queue) and self.queue[0][1] + LATENCY <= self.clock + 1
        return len(self.queue) - offered < DEPTH

    async def step(self, word: int | None = None, ready: bool = False, rst: bool = False) -> None:
        """One clock: writes ``word`` unless it is None."""
        dut = self.dut
        assert word is None or rst or self.has_room(), "the testbench writes into a full FIFO"
        await RisingEdge(dut.clk)
        dut.rst.value = int(rst)
        dut.wr_en.value = int(word is not None)
        dut.wr_data.value = random.getrandbits(W) if word is None else word
        dut.m_ready.value = int(ready)
        await FallingEdge(dut.clk)
        self.clock += 1
        if rst:
            # Acts at the next rising edge; what is offered in this clock is offered still.
            self.queue.clear()
            self.stalled = None
            return
        where = f"clock {self.clock}, {len(self.queue)} of {DEPTH} words inside"
        valid, data = str(dut.m_valid.value), str(dut.m_data.value)
        due = bool(self.queue) and self.queue[0][1] + LATENCY <= self.clock
        assert valid == str(int(due)), (
            f"m_valid={valid}, expected {int(due)} in {where}; next word and its clock: {[*self.queue][:1]}"
        )
        if self.stalled is not None:
            assert data == self.stalled, f"m_data changed from {self.stalled} to {data} while stalled, in {where}"
        if due:
            expected = self.queue[0][0]
            assert data == format(expected, f"0{W}b"), f"m_data={data}, expected {expected:0{W}b} in {where}"
            if ready:
                self.read.append((self.queue.popleft()[0], self.clock))
        self.stalled = data if due and not ready else None
        if word is not None:
            self.queue.append((word, self.clock))

    async def reset(self, clocks: int = 1, **signals) -> None:
        for _ in range(clocks):
            await self.step(rst=True, **signals)

    async def drain(self) -> None:
        """Reads all that is inside, and waits a little for what should not come."""
        for _ in range(len(self.queue) + LATENCY):
            await self.step(ready=True)
        assert not self.queue, f"{len(self.queue)} words never came out"
        for _ in range(3):
            await self.step(ready=True)


def pattern(name: str):
    """Yes or no for each clock."""
    while True:
        match name:
            case "always":
                yield True
            case "single":
                yield from (True, False)
            case "random":
                yield random.random() < 0.5
            case "bursts":
                yield from [True] * random.randint(8, DEPTH + 8)
                yield from [False] * random.randint(1, DEPTH + 8)
            case _:
                raise ValueError(name)


@cocotb.test()
@cocotb.parametrize(write=["always", "single", "random", "bursts"], read=["always", "single", "random", "bursts"])
async def traffic(dut, write, read):
    """Every clock against the queue, with the writer stopped only by the capacity."""
    fifo = Fifo(dut)
    await fifo.reset()
    sent = []
    for may_write, ready, _ in zip(pattern(write), pattern(read), range(300 + 3 * DEPTH), strict=False):
        word = random.getrandbits(W) if may_write and fifo.has_room() else None
        if word is not None:
            sent.append(word)
        await fifo.step(word, ready)
    await fifo.drain()
    assert [word for word, _ in fifo.read] == sent and len(sent) > 40, f"{len(sent)} words in, {len(fifo.read)} out"


@cocotb.test(skip=DEPTH < 4)  # fewer places do not cover the latency
async def latency_and_throughput(dut):
    """The first word comes two clocks after it was written, then one each clock."""
    fifo = Fifo(dut)
    await fifo.reset()
    await fifo.step()
    start = fifo.clock + 1
    for k in range(3 * DEPTH):
        await fifo.step(k % (1 << W), ready=True)
    await fifo.drain()
    at = [clock - start for _, clock in fifo.read]
    assert at == list(range(LATENCY, LATENCY + 3 * DEPTH)), f"words left {at[:10]}.. clocks after the first was written"


@cocotb.test()
async def fill_to_the_brim_and_drain(dut):
    """As many words as go in while nobody reads, several times, from different places of the memory on."""
    fifo = Fifo(dut)
    await fifo.reset()
    for _ in range(3):
        while fifo.has_room():
            await fifo.step(random.getrandbits(W))
        assert len(fifo.queue) == DEPTH + 1, f"{len(fifo.queue)} words went in"
        for _ in range(5):
            await fifo.step()
        for _ in range(DEPTH // 4 + 1):
            await fifo.step(ready=True)
        await fifo.drain()


@cocotb.test()
@cocotb.parametrize(fill=["empty", "one", "half", "full"], wait=[0, 1, 3], writing=[False, True])
async def reset_with_words_inside(dut, fill, wait, writing):
    """A reset of one clock, some clocks after the last word: no old word comes out, new ones do.

    A word that is written during the reset is forgotten too.
    """
    fifo = Fifo(dut)
    await fifo.reset()
    for _ in range({"empty": 0, "one": 1, "half": DEPTH // 2, "full": DEPTH}[fill]):
        await fifo.step(random.getrandbits(W))
    for _ in range(wait):
        await fifo.step()
    await fifo.reset(word=random.getrandbits(W) if writing else None, ready=bool(wait % 2))
    for ready in (True, False, True, True):
        await fifo.step(ready=ready)
    sent = [random.getrandbits(W) for _ in range(DEPTH)]
    fifo.read.clear()
    for word in sent:
        await fifo.step(word)
    await fifo.drain()
    assert [word for word, _ in fifo.read] == sent

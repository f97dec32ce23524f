# SPDX-License-Identifier: Apache-2.0
"""Test that ``ik_delay`` and ``ik_ring`` return every word N clocks later. Test ``ik_fifo`` against a queue: order,
loss, duplication, stalls, latency, throughput, reset at several fill levels. Test modules of the folded core against
their definitions; while ``go`` is 0, these modules must hold their state."""

import itertools
import random
from collections import defaultdict, deque
from collections.abc import Iterable
from functools import partial

import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from model.dataflow import angles
from model.dataflow.expressions import round_shift
from model.dataflow.fold.steps import CUTS, NORMS
from tb.units.unit import BIT, Case, Ports, Tests, checks, pairs, runs, sets_of, signed, unsigned, with_go, wrapped

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
    """Bench of ``ik_fifo`` that compares the outputs in every clock with a queue.

    The FIFO is full with ``depth`` words in the memory and one in the output register.
    """

    def __init__(self, dut, width: int, depth: int) -> None:
        self.dut, self.width, self.depth = dut, width, depth
        self.clock = 0
        self.queue: deque[tuple[int, int]] = deque()  # (word, clock of writing)
        Clock(dut.clk, 10, unit="ns").start(start_high=False)

    def offers(self, clock: int) -> bool:
        """Return True if the output register has a word in a clock."""
        return bool(self.queue) and self.queue[0][1] + LATENCY <= clock

    async def step(self, write: bool = False, ready: bool = False, rst: bool = False) -> None:
        """Run one clock. If ``write``, write a random word unless the FIFO is full."""
        dut, word = self.dut, random.getrandbits(self.width)
        write = write and (rst or len(self.queue) - self.offers(self.clock + 1) < self.depth)
        await RisingEdge(dut.clk)
        for port, value in {"rst": rst, "wr_en": write, "wr_data": word, "m_ready": ready}.items():
            getattr(dut, port).value = int(value)
        await FallingEdge(dut.clk)
        self.clock += 1
        if rst:  # acts at the next rising edge; the output of this clock is still valid
            self.queue.clear()
            return
        where = f"clock {self.clock}, {len(self.queue)} of {self.depth} words inside"
        valid, data, due = str(dut.m_valid.value), str(dut.m_data.value), self.offers(self.clock)
        assert valid == str(int(due)), f"m_valid={valid}, expected {int(due)} in {where}"
        if due:
            bits = format(self.queue[0][0], f"0{self.width}b")
            assert data == bits, f"m_data={data}, expected {bits} in {where}"
            if ready:
                self.queue.popleft()
        if write:
            self.queue.append((word, self.clock))

    async def drain(self) -> None:
        """Read all words, then read for a few more clocks."""
        for _ in range(len(self.queue) + LATENCY + 3):
            await self.step(ready=True)


async def traffic(fifo: Fifo, write: float, read: float) -> None:
    """Write and read with probabilities ``write`` and ``read`` in each clock."""
    for _ in range(300 + 3 * fifo.depth):
        await fifo.step(random.random() < write, random.random() < read)
    await fifo.drain()


async def reset_with_words_inside(fifo: Fifo) -> None:
    """Write words, wait, reset for one clock, fill again. The reset drops all words, even one written during it."""
    for fill, wait, writing in itertools.product([0, 1, fifo.depth // 2, fifo.depth], [0, 1, 3], [False, True]):
        for write in [True] * fill + [False] * wait:
            await fifo.step(write)
        await fifo.step(writing, ready=bool(wait % 2), rst=True)
        for ready in (True, False, True, True):
            await fifo.step(ready=ready)
        for _ in range(fifo.depth):
            await fifo.step(write=True)
        await fifo.drain()


def fifo(W: int, LOG2: int) -> Tests:
    tests = {"reset_with_words_inside": reset_with_words_inside}
    for write, read in itertools.product((1, 0.8, 0.2), repeat=2):
        tests[f"traffic_{write}_{read}"] = partial(traffic, write=write, read=read)

    async def started(test, dut) -> None:
        bench = Fifo(dut, W, 1 << LOG2)
        await bench.step(rst=True)
        await test(bench)

    return {name: partial(started, test) for name, test in tests.items()}


def memory(D: int, AD: int, DOWN: int, RW: int) -> Tests:
    """Check 64 read/write words, followed by constant powers of two."""
    written, powers = 64, 64

    def vectors() -> Iterable[Ports]:
        """Yield enough random accesses to reach every address through each port.

        No clock reads the address that it writes, because the result is undefined.
        """
        for _ in range(4000):
            at = random.randrange(written)
            read = [random.randrange(last) for last in (written + powers, written + powers, written)]
            ports = dict(zip(("a_at", "b_at", "r_at"), read, strict=True))
            yield ports | {"w_en": int(at not in read), "w_at": at, "w": random.getrandbits(D)}

    content: list[int | None] = [None] * written + [1 << D - 1 >> (n if n < AD else n - DOWN) for n in range(powers)]
    reads: list[Ports] = []

    def expected(taken: list[Ports], now: Ports) -> Ports:
        for at in taken[len(reads) :]:
            words = ((port, content[at[f"{port}_at"]]) for port in "abr")
            known = {port: word for port, word in words if word is not None}  # the others are undefined
            shifts = {"a": lambda w: w >> D - AD, "b": int, "r": lambda w: w >> D - 1 - RW & (1 << RW) - 1}
            reads.append({port: shifts[port](word) for port, word in known.items()})
            if at["w_en"]:
                content[at["w_at"]] = at["w"]
        return reads[-1]

    return {"words": partial(with_go, vectors=vectors, clocks=1, expected=expected)}


def mul(D: int, TILE: int, WORD: int, ROOT: int, SINE: int) -> Tests:
    """Check the exact product or, for most values of `cut`, the sum of separately truncated tiles."""
    low = D - TILE
    last = {"plain": WORD - 2, "double": WORD - 3, "word": WORD, "root": 2 * low + ROOT, "sine": 2 * low + SINE}

    def expected(taken: list[Ports], now: Ports) -> Ports:
        a, b, cut = taken[-3]["a"], taken[-3]["b"], CUTS[taken[-1]["cut"]]
        if cut in ("exact", "power"):
            return {"p": wrapped(a, signed(D)) * wrapped(b, signed(D)) % (1 << 2 * D)}
        a_low, b_low = a % (1 << low), b % (1 << low)
        a_high, b_high = (wrapped(word >> low, signed(TILE)) for word in (a, b))
        outer = a_high * b_high << 2 * low
        if cut in ("plain", "double") and 2 * low > WORD - 3:  # kept part of the product of the low halves
            outer += (a_low >> low - 2) * (b_low >> low - 2) << 2 * low - 4
        tiles = outer, a_high * b_low << low, a_low * b_high << low
        return {"p": sum(tile >> last[cut] << last[cut] for tile in tiles) % (1 << 2 * D)}

    def word() -> int:
        """Return a random word, or one close to 0 or to either end."""
        near = random.choice((0, 0, 1 << D - 1)) + random.choice((-2, -1, 0, 1, 2))
        return random.choice((random.getrandbits(D), random.getrandbits(D), near % (1 << D)))

    def factors() -> Iterable[Ports]:
        return ({"a": word(), "b": word(), "cut": random.randrange(len(CUTS))} for _ in range(2000))

    return {"products": partial(with_go, vectors=factors, clocks=3, expected=expected)}


def norm(W: int, D: int, XW: int, LAST: int, DROP: int) -> Tests:
    """Check left shifts: by the largest even count that fits, or by the count n."""
    kinds, words = ("", *NORMS), (1 << XW) - 1

    def expected(taken: list[Ports], now: Ports) -> Ports:
        t, kind = taken[-2]["t"], kinds[taken[-2]["kind"]]
        if kind == "count":  # each bit of the count is sampled with its shift stage
            n = taken[-2]["n"] & 0b100001 | taken[-1]["n"] & 0b011000 | now["n"] & 0b000110
            return {"word": (t << n & words) >> XW - D >> DROP << DROP}
        if kind == "inverse":
            t ^= words
        if kind == "unit":
            t = t >> LAST << LAST
        t = t % (1 << (2 * W - 2 if kind == "arm" else 2 * W)) << 2
        pairs = (XW - t.bit_length()) // 2 if t else W // 2 if kind == "arm" else W - 1
        limited = kind == "unit" and taken[-2]["t"] >> 2 * W - 2 & 1
        mantissa = (1 << D - 1) - 1 if limited else (t << 2 * pairs & words) >> XW - D + 1
        return {"word": mantissa, "zero": int(t == 0), "pairs": pairs}

    def sums() -> Iterable[Ports]:
        """Yield ports with a random sum t of random length. For the kind "inverse", 9 of 10 sums are complemented."""
        for _ in range(2000):
            kind = random.randrange(len(kinds))
            t = random.getrandbits(random.randint(0, XW))
            t ^= words * (kinds[kind] == "inverse" and random.random() < 0.9)
            yield {"t": t, "kind": kind, "n": random.getrandbits(6)}

    return {"normals": partial(with_go, vectors=sums, clocks=2, expected=expected)}


def fold_angle(W: int) -> Tests:
    """Run a ball joint's program on random quaternions and check ``th``; some points (w, k) or (i, j) are on an axis.

    The program stores the angle d of (i, j) in h and outputs s + d and s - d, where s is the angle of (w, k). Then it
    outputs twice the angle of (|(w, k)|, |(i, j)|) and twice the angle of (i, -w). Signs and half turns are random."""
    head, last = angles.iterations(W)
    loaded, done = head + 3, last - head + 1  # clocks from a load of x to `over`, from there to the angle
    again = 2 * loaded + 1
    twice = again + max(head + 1, done + 1)
    elbow = twice + done + 1
    lap = elbow + loaded + done + 2

    async def joints(dut) -> None:
        quaternions = np.array([(*a, *b) for a, b in zip(pairs(W, 200), pairs(W, 200), strict=True)])
        w, i, j, k = quaternions.T
        ij, wk = angles.vector(i, j, W), angles.vector(w, k, W)
        size = np.array([ij[1], wk[1], angles.iterate(wk[0], ij[0], W)[1], angles.vector(i, -w, W)[1]]).T
        events, shown = defaultdict(dict), {}
        events[0]["over"] = 1  # clears Y
        for n, ((w, i, j, k), sizes) in enumerate(zip(quaternions.tolist(), size.tolist(), strict=True)):
            start, negative = 1 + lap * n, random.choices(BIT, k=4)
            d, s, b, e = (-angle if minus else angle for angle, minus in zip(sizes, negative, strict=True))
            loads = ((0, i, j, 0b00, 0), (loaded + 1, w, k, 0b10, 0), (elbow, i, w, 0b01, 1))
            for (clock, x, y, rounding, opposite), minus in zip(loads, (*negative[:2], negative[3]), strict=True):
                events[start + clock] |= {"load_x": 1, "word": x % (1 << W)}
                events[start + clock + 2] |= {"load_y": 1, "word": y % (1 << W), "rounding": rounding}
                events[start + clock + 2] |= {"negative": minus, "opposite": opposite}
            for clock in (loaded, again, twice, elbow + loaded):
                events[start + clock]["over"] = 1
            events[start + again] |= {"again": 1, "rounding": 0b01, "negative": negative[2]}
            for clock in (loaded + done, twice + done, elbow + loaded + done):
                events[start + clock]["to_h"] = 1
            results = {again + done: s + d, again + done + 1: s - d, twice + done + 1: 2 * b, lap - 1: 2 * e}
            for clock, angle in results.items():
                half, minus = random.choice(BIT), int(clock == again + done + 1)
                events[start + clock] |= {"half": half, "minus": minus}
                shown[start + clock] = (round_shift(angle, angles.ANGLE) + (half << W - 1)) % (1 << W)

        idle = dict.fromkeys(("load_x", "load_y", "over", "again", "to_h"), 0)
        unused = {"word": W, "opposite": 1, "rounding": 2, "negative": 1, "minus": 1, "half": 1}
        program = []
        for clock in range(max(events) + 1):
            # Ports that the program does not use in a clock have no effect.
            program.append(idle | {port: random.getrandbits(bits) for port, bits in unused.items()} | events[clock])

        def expected(taken: list[Ports], now: Ports) -> Ports:
            clock = len(taken)
            return {"th": shown[clock]} if clock in shown and now is program[clock] else {}

        await with_go(dut, lambda: program, 0, expected)

    return {"joints": joints}


CASES = (
    Case("ik_delay", delay, sets_of("W N", (8, 0), (70, 5)), sets_of("W N", (8, 1), (32, 40))),
    Case("ik_ring", ring, sets_of("W N", (40, 18)), sets_of("W N", (8, 3), (16, 12), (96, 65), (2, 300))),
    Case("ik_fifo", fifo, sets_of("W LOG2", (16, 2)), sets_of("W LOG2", (8, 1), (208, 5))),
    Case("ik_fold_angle", fold_angle, sets_of("W", (5,), (32,)), sets_of("W", (6,), (17,))),
    Case("ik_fold_memory", memory, sets_of("D AD DOWN RW", (26, 26, 11, 11), (33, 31, 11, 11))),
    Case(
        "ik_fold_mul", mul, sets_of("D TILE WORD ROOT SINE", (26, 16, 25, 5, 4), (29, 18, 29, 8, 7), (35, 18, 33, 8, 7))
    ),
    Case(
        "ik_fold_norm", norm, sets_of("W D XW LAST DROP", (18, 26, 38, 11, 1), (24, 33, 50, 17, 2), (32, 35, 66, 29, 0))
    ),
)
test_storage, vectors = runs(CASES)

# SPDX-License-Identifier: Apache-2.0
"""Test ``ik_vector`` and ``ik_fold_angle`` against their model; test ``ik_double``, steps and limits of joints against
their definitions."""

import itertools
import random
from collections import defaultdict
from functools import partial

import numpy as np

from model.dataflow import angles
from model.dataflow.expressions import round_shift
from model.dataflow.formats import Latency
from tb.units.unit import BIT, Case, Ports, Tests, checks, runs, sets_of, signed, some, unsigned, with_go, wrapped


def words(W: int, count: int = 1000) -> list[tuple[int, int]]:
    """Return vectors of words in random order: all if W is at most 6, else ``count``, a quarter on an axis."""
    if W <= 6:
        return random.sample(list(itertools.product(signed(W), signed(W))), 1 << 2 * W)
    pairs = [(x * random.choice((0, 1, 1, 1)), y) for x, y in some(count, signed(W), signed(W))]
    return [pair if random.random() < 0.8 else pair[::-1] for pair in pairs]


def vector(W: int) -> Tests:
    """Check length and angle in separate tests, because their latencies differ."""
    inputs = {"x": signed(W + 4), "y": signed(W + 4)}

    def of_words():
        return [(x << angles.GUARD, y << angles.GUARD) for x, y in words(W)]

    def of_lengths():
        return [(abs(x) >> 1, abs(y) >> 1) for x, y in some(500, *inputs.values())]

    def bench(port: str, outputs: range, which: int, latency: str, named: list) -> Tests:
        def model(x, y):
            return (angles.iterate(np.array(x), np.array(y), W)[which],)

        options = {"latency": Latency(W)[latency], "columns": True, "corners": named, "good": (9, 4)}
        tests = checks(inputs, {port: outputs}, model, of_words, of_lengths, **options)
        return {f"{name}_{port}": test for name, test in tests.items()}

    exact = [((x, 0), 0) for x in (0, 8, 1 << W)] + [((x, 0), -(1 << W + 3)) for x in (-8, -(1 << W))]
    lengths = bench("length", unsigned(W + 3), 0, "vector_x", [])
    return lengths | bench("angle", signed(W + 4), 1, "vector", exact)


def fold_angle(W: int) -> Tests:
    """Check ``th`` in the program of a ball joint, repeated for random quaternions.

    The program stores the angle d of (i, j) in h and shows s + d and s - d, where s is the angle of (w, k). Most times
    it then shows twice the angle of the vector of both lengths; sometimes it first shows twice the angle of (i, -w)."""
    head, last = angles.iterations(W)
    rest = last - head  # iterations of the second stage

    async def joints(dut) -> None:
        """Drive random quaternions, some with vectors on an axis, with either sign, with and without half a turn."""
        quaternions = [(*a, *b) for a, b in zip(words(W, 200), words(W, 200), strict=True)]
        random.shuffle(quaternions)
        events, wanted, clock = defaultdict(dict), {}, 0

        def at(when: int, **ports: int) -> None:
            events[when] |= ports

        def load(x: int, y: int, rounding: int, negative: int, opposite: int = 0) -> int:
            """Load a vector from `clock` on; return the clock in which the first stage has finished it."""
            one = clock + random.choice((0, 0, 1))
            two = one + random.choice((2, 2, 4))
            at(one, load_x=1, word=x % (1 << W))
            at(two, load_y=1, word=y % (1 << W), rounding=rounding, negative=negative, opposite=opposite)
            return two + head + 1

        def show(when: int, angle: int, minus: int = 0) -> None:
            half = random.getrandbits(1)
            at(when, minus=minus, half=half)
            wanted[when] = (round_shift(angle, angles.ANGLE) + (half << W - 1)) % (1 << W)

        def signs(angle) -> tuple[int, int]:
            negative = random.getrandbits(1)
            return negative, int(-angle if negative else angle)

        w, i, j, k = np.array(quaternions).T
        ij, wk = angles.vector(i, j, W), angles.vector(w, k, W)
        tilts, elbows = angles.iterate(wk[0], ij[0], W)[1], angles.vector(i, -w, W)[1]
        at(0, over=1)  # clears Y
        for n, (w, i, j, k) in enumerate(quaternions):
            clock += 1
            if random.random() < 0.3:
                negative_4, elbow = signs(elbows[n])
                clock = load(i, w, 0b01, negative_4, opposite=1)
                at(clock, over=1)
                at(clock + rest + 1, to_h=1)
                show(clock + rest + 2, 2 * elbow)
                clock = max(clock + 1, clock + rest + 1 - head)
            negative, d = signs(ij[1][n])
            clock = load(i, j, 0b00, negative)
            at(clock, over=1)
            at(clock + rest + 1 + random.choice((0, 0, 1)) * (head + 3 > rest + 1), to_h=1)
            clock += 1
            again = random.random() < 0.7
            negative, s = signs(wk[1][n])
            clock = load(w, k, 0b10, negative)
            negative, b = signs(tilts[n])
            at(clock, over=1, **({"again": 1, "rounding": 0b01, "negative": negative} if again else {}))
            show(clock + rest + 1, s + d)
            show(clock + rest + 2, s - d, minus=1)
            clock += max(head + 1, rest + 2)
            if again:
                at(clock, over=1)
                at(clock + rest + 1, to_h=1)
                show(clock + rest + 2, 2 * b)
                clock = max(clock, clock + rest - 2 - head)

        idle = dict.fromkeys(("load_x", "load_y", "over", "again", "to_h"), 0)
        unused = {"word": W, "opposite": 1, "rounding": 2, "negative": 1, "minus": 1, "half": 1}
        program = []
        for when in range(max(events) + 1):
            # Ports that the program does not use in a clock have no effect.
            program.append(idle | {port: random.getrandbits(bits) for port, bits in unused.items()} | events[when])

        def expected(taken: list[Ports], now: Ports) -> Ports:
            when = len(taken)
            return {"th": wanted[when]} if when in wanted and now is program[when] else {}

        await with_go(dut, lambda: program, 0, expected)

    return {"joints": joints}


def double(IW: int, OW: int) -> Tests:
    """Check that q is 2 a, or -2 a, rounded half up, modulo one turn."""
    q = unsigned(OW)
    return checks(
        {"a": unsigned(IW), "negate": BIT},
        {"q": q},
        lambda a, negate: wrapped(round_shift(-2 * a if negate else 2 * a, IW - OW), q),
        latency=1,
    )


def over(W: int, th: int, low: int, high: int) -> int:
    return int((th - low) % (1 << W) > (high - low) % (1 << W))


def limit(W: int) -> Tests:
    angle = unsigned(W)
    return checks({"th": angle, "low": angle, "high": angle}, {"over": BIT}, partial(over, W), latency=1)


def fold_limit(W: int) -> Tests:
    def of_joint(joint: int, th: int, limits: int) -> int:
        return over(W, th, *(limits >> W * n & (1 << W) - 1 for n in (2 * joint - 2, 2 * joint - 1)))

    def near():
        drawn = some(2000, range(1, 8), range(-1, 2), unsigned(14 * W))
        return [(n, ((arcs >> W * (2 * n - 1 - arcs % 2)) + by) % (1 << W), arcs) for n, by, arcs in drawn]

    inputs = {"joint": unsigned(3), "th": unsigned(W), "limits": unsigned(14 * W)}
    return checks(inputs, {"over": BIT}, of_joint, near, latency=1, fits=lambda joint, *_: joint)


def step(W: int, STEP: int, NEGATED: int) -> Tests:
    """Check both steps. As limits are static, the next vector decides whether there are any."""
    turn, angle, most = 1 << W, unsigned(W), (2 << STEP) - 1

    def size(at: int, ref_at: int, span: int, whole: bool) -> int:
        gap = at - ref_at
        if whole:
            gap = (gap + turn // 2) % turn - turn // 2
        return most if at > span else (~gap if gap < 0 else gap) >> W - STEP

    def reference(*columns):
        rows = list(zip(*columns, strict=True))
        for (th, ref, low, high), (*_, next_low, next_high) in zip(rows, [*rows[1:], rows[-1]], strict=True):
            whole, span = (next_high - next_low) % turn == turn - 1, (high - low) % turn
            other = -th if NEGATED else th + turn // 2
            yield [size((one - low) % turn, (ref - low) % turn, span, whole) for one in (th, other)]

    inputs = dict.fromkeys(("th", "ref_th", "low", "high"), angle)
    steps = dict.fromkeys(("step_0", "step_1"), unsigned(STEP + 1))
    return checks(inputs, steps, lambda *columns: zip(*reference(*columns), strict=True), latency=3, columns=True)


CASES = (
    Case("ik_vector", vector, sets_of("W", (6,)), sets_of("W", (5,), (17,), (24,), (32,))),
    Case("ik_fold_angle", fold_angle, sets_of("W", (5,), (32,)), sets_of("W", (6,), (17,))),
    Case("ik_double", double, sets_of("IW OW", (8, 4), (36, 32))),
    Case("ik_limit", limit, sets_of("W", (4,), (32,))),
    Case(
        "ik_step",
        step,
        sets_of("W STEP NEGATED", (3, 3, 0), (3, 3, 1), (24, 12, 1)),
        sets_of("W STEP NEGATED", (32, 12, 0)),
    ),
    Case("ik_fold_limit", fold_limit, sets_of("W", (4,), (32,))),
)
test_angles, vectors = runs(CASES)

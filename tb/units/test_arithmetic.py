# SPDX-License-Identifier: Apache-2.0
"""Test sums, products, ``ik_div`` and ``ik_root`` against Python integers and fractions.

With SQUARE, a product is the square of ``a``, and ``b`` has no effect.
"""

import itertools
import math
import random
from fractions import Fraction
from functools import partial

import numpy as np

from model.dataflow.expressions import wrap
from model.dataflow.formats import GUARD, Latency
from model.dataflow.mul3 import TILE, mul3, unseen
from tb.units.unit import BIT, Case, Tests, checks, corners, rounded, runs, sets_of, signed, some, unsigned, wrapped


def extreme_halves(width: int):
    """Return all pairs of words with extreme halves, for every carry across the middle and extreme values of tiles."""
    low = width // 2
    high, last = signed(width - low), (1 << low) - 1
    ends = {high[0], -1, 0, 1, high[-1]}
    halves = [(k << low) + rest for k in ends for rest in (0, 1, last // 2 + 1, last - 1, last)]
    return itertools.product(halves, halves)


def sums(IW: int, SH: int, OW: int, SUB_B: int = 0, SUB_C: int | None = None, SAT: int = 1, **delays: int) -> Tests:
    """Check the exact sum, rounded half up; it is saturated if SAT is 1. SUB_B or SUB_C subtracts the last operand."""
    IN, Q = signed(IW), signed(OW)
    operands, sub = 2 if SUB_C is None else 3, SUB_B or SUB_C

    def reference(*vector):
        *first, last = vector
        q = rounded(sum(first) + (-last if sub else last), SH)
        return min(max(q, Q[0]), Q[-1]), int(q not in Q)

    def operands_of(wanted):
        """Return operands whose result is ``wanted``. If none exist, a returned operand is out of range."""
        rest, chosen = wanted, []
        for k in range(operands - 1, -1, -1):
            # as large as this operand may be, but not larger than needed
            chosen.append(min(max(rest // (k + 1), IN[0]), IN[-1]))
            rest -= chosen[-1]
        chosen[-1] = (chosen[-1] + rest) * (-1 if sub else 1)
        return tuple(chosen)

    # top: the least sum that overflows upwards; low: the least sum that does not overflow
    half = 1 << SH - 1 if SH else 0
    top, low = (Q[-1] << SH) + (half or 1), (Q[0] << SH) - half
    cases = [(0, 0, 0), (top - 1, Q[-1], 0), (low, Q[0], 0)]
    cases += [(top, Q[-1], 1), (low - 1, Q[0], 1)] if SAT else []
    cases += [(half, 1, 0), (-half, 0, 0), (half - 1, 0, 0), (-half - 1, -1, 0), (-3 * half, -1, 0)] if SH else []
    return checks(
        {port: IN for port in "abc"[:operands]},
        {"q": Q, "ovf": BIT},
        reference,
        latency=Latency(32)[f"sum{operands}"],
        delays=delays,
        corners=[(operands_of(wanted), (q, ovf)) for wanted, q, ovf in cases],
        good=(1 << SH,) + (0,) * (operands - 1),
        fits=lambda *vector: SAT or reference(*vector)[1] == 0,  # SAT = 0: formats guarantee sums in q's range
    )


def wide(W: int, SUB: int, **delays: int) -> Tests:
    """Check the sum or difference modulo 2^W."""
    words = signed(W)

    def small_results():
        """Return pairs with a result near 0 or +-2^(W/2), because comparisons use the sign of q."""
        near = [s * (1 << W // 2) * k + e for s in (-1, 1) for k in (0, 1) for e in (-1, 0, 1)]
        drawn = [a for (a,) in some(100, words)]
        return [(a, wrapped((a if SUB else -a) + little, words)) for a in drawn for little in near]

    def reference(a, b):
        return wrapped(a - b if SUB else a + b, words)

    inputs, streams = {"a": words, "b": words}, (partial(extreme_halves, W), small_results)
    return checks(inputs, {"q": words}, reference, *streams, latency=Latency(32)["wide"], delays=delays)


def half(W: int, MINUS: int) -> Tests:
    """Check (1 +- c) / 2, clamped to [0, 1]. q has one fraction bit more than c: q's word is the word of 1 +- c."""
    one = 1 << W - 2

    def around_one():
        return [s * one + e for s in (-1, 1) for e in range(-20, 21)]

    def reference(c):
        return min(max(one - c if MINUS else one + c, 0), 2 * one)

    return checks({"c": signed(W)}, {"q": unsigned(W)}, reference, around_one, latency=Latency(32)["mux"])


def pick(W: int) -> Tests:
    """Check that q is a, b or -b, modulo 2^W."""
    words = signed(W)

    def reference(a, b, use_b, minus):
        return wrapped(-b if minus else b, words) if use_b else a

    inputs = {"a": words, "b": words, "use_b": BIT, "minus": BIT}
    return checks(inputs, {"q": words}, reference, latency=Latency(32)["mux"])


def exact(W: int, SQUARE: int) -> Tests:
    def reference(a, b):
        return a * (a if SQUARE else b)

    ports, latency = {"a": signed(W), "b": signed(W)}, Latency(32)["square" if SQUARE else "product"]
    return checks(ports, {"p": signed(2 * W)}, reference, partial(extreme_halves, W), latency=latency)


def mul(AW: int, BW: int, SH: int, OW: int, SQUARE: int = 0, **delays: int) -> Tests:
    A, B, Q = signed(AW), signed(BW), signed(OW)

    def reference(a, b):
        return rounded(a * (a if SQUARE else b), SH)

    half = 1 << SH - 1 if SH else 0
    ties = [((1, half), 1), ((-1, half), 0), ((1, half - 1), 0), ((-1, half + 1), -1), ((3, half), 2), ((-3, half), -1)]
    return checks(
        {"a": A, "b": B},
        {"q": Q},
        reference,
        latency=Latency(32)["mul"],
        delays=delays,
        corners=ties if half > 1 and not SQUARE else (),
        good=(A[-1] // 2, 1 << SH // 2),
        fits=lambda a, b: reference(a, b) in Q,  # as the datapath's formats guarantee
    )


def of_tiles(AW: int, BW: int, SH: int, OW: int, TILE: int = TILE, SQUARE: int = 0, **delays: int) -> Tests:
    """Check a product that is a sum of tiles. Each tile is truncated two bits below q's LSB. The sum is rounded half up
    and taken modulo 2^OW."""
    A, B, Q = signed(AW), signed(BW), signed(OW)
    a_last, b_last = (1 << bits for bits in unseen(AW, BW, TILE))
    a_low, b_low = 1 << max(AW - TILE, 0), 1 << max(BW - min(TILE, 18), 0)

    def sum_of_tiles(a, b):
        b = a if SQUARE else b
        a, b = a - a % a_last, b - b % b_last
        a_lo, b_lo = a % a_low, b % b_low
        tiles = [(a - a_lo) * (b - b_lo), (a - a_lo) * b_lo, a_lo * (b - b_lo)]
        if 4 * a_low * b_low > 1 << SH:  # two bits of each
            tiles.append(4 * a_lo // a_low * (4 * b_lo // b_low) * a_low * b_low // 16)
        return (sum(4 * tile // (1 << SH) for tile in tiles) + 2) // 4

    def reference(a, b):
        words, b = list(map(sum_of_tiles, a, b)), a if SQUARE else b
        assert mul3(np.array(a), np.array(b), SH, AW, BW, TILE).tolist() == words, "the model is no product of tiles"
        return ([wrapped(word, Q) for word in words],)

    def extreme_high_parts():
        return [(a // a_low * a_low, b // b_low * b_low) for a in corners(A) for b in corners(B)]

    def halves_of_a_place():
        """Return operands with a product of half an LSB, or as small as the lowest tile (omitted or estimated)."""
        a, b = 1 << SH // 2, 1 << SH - 1 - SH // 2
        pairs = [(a, b), (-a, b), (a - 1, b), (a_low, b_low // 2), (a_low // 2, -b_low), (a_low - 1, b_low - 1)]
        return [(a, b) for a, b in [*pairs, (-1, b_low - 1)] if a in A and b in B]

    options = {"latency": Latency(32)["mul3"], "columns": True, "delays": delays}
    return checks({"a": A, "b": B}, {"q": Q}, reference, extreme_high_parts, halves_of_a_place, **options)


def scale(COUNT: int, AW: int, BW: int, SH: int, OW: int, **delays: int) -> Tests:
    """Check the product of ``b`` and each word of ``a`` against the model, which :func:`of_tiles` checks."""

    def reference(a, b):
        words = [wrap(np.array(a) >> AW * k, AW) for k in range(COUNT)]
        products = [mul3(word, np.array(b), SH, AW, BW, TILE) % (1 << OW) for word in words]
        return (sum(product << OW * k for k, product in enumerate(products)).tolist(),)

    ports, outputs = {"a": unsigned(COUNT * AW), "b": signed(BW)}, {"q": unsigned(COUNT * OW)}
    return checks(ports, outputs, reference, columns=True, latency=Latency(32)["mul3"], delays=delays)


def div(NW: int, DW: int, SH: int, QW: int, LAT: int, DIGIT: int = 0, **delays: int) -> Tests:
    """Check that q is the floor of n 2^SH / d, saturated; for d <= 0, the least word if n < 0, else the greatest."""
    N, D, Q = signed(NW), signed(DW), signed(QW)

    def reference(n, d):
        if d > 0 and (floor := math.floor(Fraction(n << SH, d))) in Q:
            return floor, 0
        return Q[0] if n < 0 else Q[-1], 1

    def next_to_quotients():
        """Yield (dividend, divisor). The dividend is the least that gives a random quotient, or differs from it by 1.
        Half of these quotients are near 0 or near an end of q's range; the others span twice the range."""
        ends, divisors = [q + e for q in (Q[0], Q[-1], 0) for e in (-2, -1, 0, 1)], [d for d in corners(D) if d > 0]
        for _ in range(4000):
            d = random.choice((random.randint(1, (1 << random.randint(1, DW - 1)) - 1), random.choice(divisors)))
            q = random.choice((random.randint(2 * Q[0], 2 * Q[-1]), random.choice(ends)))
            n = math.ceil(Fraction(q * d, 1 << SH)) + random.choice((-1, 0, 0, 1))
            if n in N:
                yield n, d

    return checks(
        {"n": N, "d": D},
        {"q": Q, "ovf": BIT},
        reference,
        next_to_quotients,
        latency=LAT,
        delays=delays,
        corners=[((0, 0), (Q[-1], 1)), ((-1, 0), (Q[0], 1)), ((1, -1), (Q[-1], 1))],
        good=(min(3, N[-1]), D[-1] // 2 + 1),
    )


def root(NW: int, SH: int, QW: int, LAT: int, DIGIT: int = 0) -> Tests:
    """Check that q is the floor of sqrt(n 2^SH), saturated; for n < 0 it is 0, and neg is 1."""
    N, Q = signed(NW), signed(QW)

    def near_squares():
        """Return, for each of many roots, the least radicand that has this root, and the radicand one below. A wrong
        floor shows first at these radicands."""
        last = math.isqrt(N[-1] << SH)
        roots = [random.randint(0, last) for _ in range(500)] + [Q[-1], Q[-1] + 1]
        roots += [random.getrandbits(random.randint(1, max(QW - 2, 1))) for _ in range(500)]
        first = [-(-(r * r) >> SH) for r in roots if r <= last]
        return [n + e for n in first for e in (0, -1) if n + e in N]

    def reference(n):
        return (min(math.isqrt(n << SH), Q[-1]), 0) if n >= 0 else (0, 1)

    return checks({"n": N}, {"q": Q, "neg": BIT}, reference, near_squares, latency=LAT)


SUM, PRODUCT, DIV, ROOT = "IW SH OW SUB_", "AW BW SH OW", "NW DW SH QW LAT", "NW SH QW LAT"
DELAYED = sets_of(f"{SUM}B", (4, 1, 3, 1), DA=2, DB=1) + sets_of(f"{SUM}B", (4, 1, 3, 1), DB=3)
CASES = (
    *(
        Case(
            module,
            sums,
            sets_of(names, (4, 1, 3, 1), (32 + GUARD, GUARD, 32, 0)) + delayed,
            [
                # q holds any sum; nothing to round
                *sets_of(names, (4, 1, 3, 0), (4, 2, 2, 1), (4, 0, 8, 1), (32 + GUARD, 0, 32 + GUARD, 1)),
                *sets_of(names, (4, 1, 3, 0), (32 + GUARD, GUARD, 32, 1), SAT=0),
            ],
        )
        for module, names, delayed in (("ik_sum2", f"{SUM}B", DELAYED), ("ik_sum3", f"{SUM}C", []))
    ),
    Case(
        "ik_wide",
        wide,
        sets_of("W SUB", (6, 1), (66, 0), (66, 1)) + sets_of("W SUB", (6, 1), DA=1, DB=3),
        sets_of("W SUB", (4, 0), (4, 1), (6, 0), (34, 1), (38, 0)),
    ),
    Case("ik_half", half, sets_of("W MINUS", (8, 0), (32, 1)), sets_of("W MINUS", (8, 1), (32, 0))),
    Case("ik_pick", pick, [{"W": 32}], [{"W": 4}]),
    Case(
        "ik_exact",
        exact,
        sets_of("W SQUARE", (5, 0), (33, 0), (33, 1)),
        sets_of("W SQUARE", (5, 1), (6, 0), (35, 0), (35, 1)),  # W = 35 gives tiles of 18x18 bits
    ),
    Case(
        "ik_mul",
        mul,
        [
            *sets_of(PRODUCT, (5, 5, 3, 7), (32, 32, 24, 32 + GUARD), (33, 33, 0, 66)),
            *sets_of(PRODUCT, (32, 32, 24, 32 + GUARD), SQUARE=1),
        ],
        [
            # the longest words of one tile and of all; a product of 32-bit words with 30 fraction bits
            *sets_of(PRODUCT, (18, 18, 10, 18 + GUARD), (6, 33, 5, 34), (35, 35, 30, 40), (32, 32, 30, 32)),
            *sets_of(PRODUCT, (5, 5, 3, 7), (33, 33, 0, 66), SQUARE=1),
            *sets_of(PRODUCT, (5, 5, 3, 7), DA=3, DB=1),
            *sets_of(PRODUCT, (5, 5, 3, 7), SQUARE=1, DA=2),
        ],
    ),
    Case(
        "ik_mul3",
        of_tiles,
        [
            *sets_of(PRODUCT, (5, 6, 5, 8), TILE=4),
            *sets_of(PRODUCT, (35, 35, 33, 36)),
            *sets_of(PRODUCT, (6, 6, 6, 8), TILE=4, SQUARE=1),
        ],
        [
            *sets_of(PRODUCT, (33, 33, 31, 33), SQUARE=1),
            *sets_of(PRODUCT, (25, 25, 23, 25), TILE=25, SQUARE=1),  # a is not split
            *sets_of(PRODUCT, (33, 35, 31, 35), (25, 25, 23, 25), (19, 23, 15, 23), (35, 35, 34, 35), (17, 17, 15, 17)),
            # low bits of the result; one bit of each mixed tile
            *sets_of(PRODUCT, (6, 5, 4, 4), (5, 6, 7, 4), TILE=4),
            # more bits than the result has; a or b is not split
            *sets_of(PRODUCT, (4, 6, 3, 12), (4, 6, 4, 5), (6, 4, 4, 5), TILE=5),
            *sets_of(PRODUCT, (25, 25, 23, 25), (31, 31, 29, 31), TILE=25),
            *sets_of(PRODUCT, (33, 31, 31, 31), TILE=16),  # the last bit of a is ignored
            *sets_of(PRODUCT, (5, 6, 5, 8), TILE=4, DA=1, DB=4),
        ],
    ),
    Case(
        "ik_scale",
        scale,
        sets_of(PRODUCT, (20, 20, 18, 20), COUNT=3),
        sets_of(PRODUCT, (25, 25, 23, 25), COUNT=2, DA=2, DB=1),
    ),
    Case(
        "ik_div",
        div,
        [
            *sets_of(DIV, (6, 5, 2, 5, 7), (32 + GUARD, 32, 22, 32, Latency(32)["div"])),  # p_e of (13)
            *sets_of(DIV, (6, 5, 2, 5, 4), DIGIT=1),
        ],
        [
            *sets_of(DIV, (32 + GUARD, 32, 22, 32, Latency(32)["div"]), DIGIT=1),
            # quotient wider than both operands; divisor wider than the other words
            *sets_of(DIV, (4, 7, 1, 9, 0), (4, 8, 1, 5, 3)),
            *sets_of(DIV, (6, 5, 2, 5, 7), DD=3),
            *sets_of(DIV, (6, 5, 2, 5, 6), DIGIT=1, DD=2),
            # LAT: two bits per stage and a spare clock; one bit per stage; that and spare clocks
            *sets_of(DIV, (6, 5, 2, 5, 5), (6, 5, 2, 5, 6), (6, 5, 2, 5, 9), DIGIT=1),
            # all dividend bits are stored; fewer rows than quotient bits; no dividend bit is stored, odd number of rows
            *sets_of(DIV, (6, 5, 0, 5, 4), (4, 7, 1, 9, 6), (6, 6, 5, 4, 5), (6, 6, 5, 4, 4), DIGIT=1),
            # dividends far too large; one row; any quotient fits; all words as wide as the partial quotient
            *sets_of(DIV, (8, 2, 0, 3, 4), (2, 2, 0, 2, 3), (8, 4, 0, 12, 9), (2, 8, 3, 8, 4), DIGIT=1),
            *sets_of(DIV, (32, 32, 30, 32, 32), (18, 18, 16, 18, 30), DIGIT=1),
        ],
    ),
    Case(
        "ik_root",
        root,
        [
            *sets_of(ROOT, (10, 5, 8, 4), (32, 30, 32, Latency(32)["root"])),
            *sets_of(ROOT, (10, 5, 8, 5), (33, 29, 32, Latency(32)["root"]), DIGIT=1),
        ],
        [
            *sets_of(ROOT, (10, 0, 6, 0), (10, 5, 5, 4)),  # some roots do not fit
            # LAT: two bits per stage and a spare clock; one bit per stage; that and spare clocks; two bits per stage
            *sets_of(ROOT, (10, 5, 8, 6), (10, 5, 8, 8), (10, 5, 8, 11), (10, 2, 7, 4), DIGIT=1),
            # all radicand bits are stored; fewer rows than result bits; some roots do not fit
            *sets_of(ROOT, (10, 0, 6, 6), (10, 1, 6, 4), (10, 3, 12, 7), (10, 5, 5, 5), (10, 5, 5, 4), DIGIT=1),
            # no radicand bit is stored: every nonzero root is too large; one row
            *sets_of(ROOT, (10, 8, 4, 4), (10, 0, 2, 2), (2, 0, 2, 2), (2, 1, 4, 3), DIGIT=1),
            *sets_of(ROOT, (33, 29, 32, 17), (32, 30, 32, 31), (18, 17, 18, 30), DIGIT=1),
        ],
    ),
)
test_arithmetic, vectors = runs(CASES)

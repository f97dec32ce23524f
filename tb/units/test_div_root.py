# SPDX-License-Identifier: Apache-2.0
"""Test ``ik_div`` and ``ik_root``, behavioural and by digit recurrence, against exact floors, saturated."""

import math
import random
from fractions import Fraction

from model.dataflow.formats import GUARD, Latency
from tb.units.unit import BIT, Case, Tests, checks, corners, runs, sets_of, signed


def div(NW: int, DW: int, SH: int, QW: int, LAT: int, DIGIT: int = 0, **delays: int) -> Tests:
    """Check that q is the floor of n 2^SH / d, saturated; for d <= 0, the least word if n < 0, else the greatest."""
    N, D, Q = signed(NW), signed(DW), signed(QW)

    def reference(n, d):
        if d > 0 and (floor := math.floor(Fraction(n << SH, d))) in Q:
            return floor, 0
        return Q[0] if n < 0 else Q[-1], 1

    def ends_of_the_range():
        """Return dividends at or next to a quotient's least dividend; quotients are near 0 or an end of q's range."""
        wanted = [q + e for q in (Q[0], Q[-1]) for e in (-1, 0, 1)] + [-2, -1, 0, 1]
        divisors = [d for d in corners(D) if d > 0] + [random.randint(1, D[-1]) for _ in range(20)]
        first = [(math.ceil(Fraction(q * d, 1 << SH)), d) for d in divisors for q in wanted]
        return [(n + e, d) for n, d in first for e in (-1, 0, 1) if n + e in N]

    def quotients_that_fit():
        """Return random divisors, each with a dividend at or next to the least one that gives some quotient. The
        quotients span twice q's range."""
        vectors = []
        while len(vectors) < 2000:
            d = random.randint(1, (1 << random.randint(1, DW - 1)) - 1)
            q = random.choice((random.randint(2 * Q[0], 2 * Q[-1]), random.choice((Q[0], Q[-1], 0, -1))))
            n = math.ceil(Fraction(q * d, 1 << SH)) + random.choice((-1, 0, 0, 1))
            if n in N:
                vectors.append((n, d))
        return vectors

    return checks(
        {"n": N, "d": D},
        {"q": Q, "ovf": BIT},
        reference,
        ends_of_the_range,
        quotients_that_fit,
        latency=LAT,
        delays=delays,
        corners=[((0, 0), (Q[-1], 1)), ((-1, 0), (Q[0], 1)), ((1, -1), (Q[-1], 1))],
        good=(min(3, N[-1]), D[-1] // 2 + 1),
    )


def root(NW: int, SH: int, QW: int, LAT: int, DIGIT: int = 0) -> Tests:
    """Check that q is the floor of sqrt(n 2^SH), saturated; for n < 0 it is 0, and neg is 1."""
    N, Q = signed(NW), signed(QW)

    def near_squares():
        """Return, for each of many roots, the least radicand that has this root, and the radicand one below it, because
        a wrong floor shows first at these."""
        last = math.isqrt(N[-1] << SH)
        roots = [random.randint(0, last) for _ in range(500)] + [Q[-1], Q[-1] + 1]
        roots += [random.getrandbits(random.randint(1, max(QW - 2, 1))) for _ in range(500)]
        first = [-(-(r * r) >> SH) for r in roots if r <= last]
        return [n + e for n in first for e in (0, -1) if n + e in N]

    def reference(n):
        return (min(math.isqrt(n << SH), Q[-1]), 0) if n >= 0 else (0, 1)

    return checks({"n": N}, {"q": Q, "neg": BIT}, reference, near_squares, latency=LAT)


DIV, ROOT = "NW DW SH QW LAT", "NW SH QW LAT"
CASES = (
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
test_div_root, vectors = runs(CASES)

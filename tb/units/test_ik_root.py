# SPDX-License-Identifier: Apache-2.0
"""``ik_root`` against ``math.isqrt``, saturated; 0 and a flag for negative arguments."""

import math
import random

from model.dataflow.nodes import Latency
from tb.units.unit import BIT, Tests, built, checks, each, instances, runs, sets_of, signed, some, stops


def bench(NW: int, SH: int, QW: int, LAT: int, DIGIT: int = 0) -> Tests:
    N, Q = signed(NW), signed(QW)

    def reference(n):
        return (min(math.isqrt(n << SH), Q[-1]), 0) if n >= 0 else (0, 1)

    square = 9 << SH % 2
    cases = {
        "zero": (0, (0, 0)),
        "one": (1, (math.isqrt(1 << SH), 0)),
        "minus_one": (-1, (0, 1)),
        "least": (N[0], (0, 1)),
        "least_but_one": (N[0] + 1, (0, 1)),
        "largest": (N[-1], (min(math.isqrt(N[-1] << SH), Q[-1]), 0)),
        "a_square": (square, (3 << (SH + 1) // 2, 0)),
        "below_a_square": (square - 1, (math.isqrt((square - 1) << SH), 0)),
    }
    # Ends of the range, unless arguments are further apart than the last two squares.
    cases |= {"largest_root": (((1 << 2 * (QW - 1)) - 1) >> SH, (Q[-1], 0))} if SH < QW else {}
    cases |= {"just_too_large": ((1 << 2 * (QW - 1)) >> SH, (Q[-1], 0))} if SH <= 2 * (QW - 1) else {}

    def near_squares():
        """The first argument with root r and the one before it, where a floor error shows first."""
        last = math.isqrt(N[-1] << SH)
        roots = [random.randint(0, last) for _ in range(500)]
        roots += [random.getrandbits(random.randint(1, max(QW - 2, 1))) for _ in range(500)]
        first = [-(-(r * r) >> SH) for r in roots if r <= last]
        return [n + e for n in first for e in (0, -1) if n + e in N]

    def good_after_bad():
        """Valid roots between negative arguments."""
        good = [abs(n) if -n in N else 0 for (n,) in some(300, N)]
        return [n for g in good for n in (random.choice([-1, N[0], N[0] // 3]), g)]

    return checks(
        {"n": N},
        {"q": Q, "neg": BIT},
        each(reference),
        near_squares,
        good_after_bad,
        latency=LAT,
        latencies=[(min(4, N[-1]), -1), (N[0], N[-1])],
        corners=cases,
        good=min(5, N[-1]),
    ) | {"recurrence": built("g_digit", DIGIT != 0)}


root = sets_of("NW SH QW LAT")


def of_paper(width, n, q) -> dict[str, int]:
    return root(n.width + (not n.signed), 2 * q.frac - n.frac, q.width, Latency(width)["root"], DIGIT=1)


test_ik_root = runs(
    "ik_root",
    bench,
    root(10, 5, 8, 4),
    root(32, 30, 32, Latency(32)["root"]),
    root(10, 5, 8, 5, DIGIT=1),
    root(33, 29, 32, Latency(32)["root"], DIGIT=1),
    more=[
        root(10, 2, 7, 1),
        root(10, 0, 6, 0),
        root(10, 5, 5, 4),  # some roots do not fit
        root(33, 29, 32, Latency(32)["root"]),  # half angle, unsigned with W-1 fraction bits
        root(18, 17, 18, Latency(18)["root"]),
        # digit recurrence; the natural latency is one clock per result bit, plus the output
        root(10, 5, 8, 6, DIGIT=1),  # two bits per stage, register after the stage
        root(10, 5, 8, 8, DIGIT=1),  # natural
        root(10, 5, 8, 11, DIGIT=1),
        root(10, 2, 7, 7, DIGIT=1),
        root(10, 2, 7, 4, DIGIT=1),
        root(10, 0, 6, 6, DIGIT=1),  # all radicand bits are stored
        root(10, 1, 6, 4, DIGIT=1),
        root(10, 3, 12, 7, DIGIT=1),  # fewer rows than result bits
        root(10, 5, 5, 5, DIGIT=1),  # some roots do not fit
        root(10, 5, 5, 4, DIGIT=1),
        root(10, 8, 4, 4, DIGIT=1),  # no radicand bit is stored: every nonzero root is too large
        root(10, 0, 2, 2, DIGIT=1),  # one row
        root(2, 0, 2, 2, DIGIT=1),
        root(2, 1, 4, 3, DIGIT=1),
        *(one for one in instances("root", 3, of_paper) if one["SH"] != 29),
        root(33, 29, 32, 17, DIGIT=1),  # two bits per stage
        root(32, 30, 32, 31, DIGIT=1),
        root(18, 17, 18, 30, DIGIT=1),
    ],
)
test_too_short_a_latency_stops_the_build = stops(
    "ik_root",
    *(root(*values, DIGIT=1) for values in [(10, 5, 8, 4), (32, 30, 32, 16), (10, 0, 2, 1)]),
    says="ik_root_digit_needs_LAT_of_at_least_1_and_half_a_clock_a_result_bit",
)
test_widths_out_of_range_stop_the_build = stops(
    "ik_root",
    *(root(*values, DIGIT=1) for values in [(1, 5, 8, 9), (10, 5, 1, 9)]),
    says="ik_root_digit_needs_NW_QW_of_at_least_2_and_SH_of_at_least_0",
)

# SPDX-License-Identifier: Apache-2.0
"""``ik_div`` against fractions: floor of the quotient, saturated; by the sign of n if d <= 0."""

import math
import random
from fractions import Fraction

from model.dataflow.nodes import GUARD, Latency
from tb.sim.env import simulator
from tb.units.unit import BIT, Tests, built, checks, corners, each, instances, runs, sets_of, signed, some, stops


def bench(NW: int, DW: int, SH: int, QW: int, LAT: int, DIGIT: int = 0, **delays: int) -> Tests:
    N, D, Q = signed(NW), signed(DW), signed(QW)

    def reference(n, d):
        if d > 0 and (floor := math.floor(Fraction(n << SH, d))) in Q:
            return floor, 0
        return Q[0] if n < 0 else Q[-1], 1

    cases = {
        "positive_by_zero": ((1, 0), (Q[-1], 1)),
        "zero_by_zero": ((0, 0), (Q[-1], 1)),
        "negative_by_zero": ((-1, 0), (Q[0], 1)),
        "largest_by_zero": ((N[-1], 0), (Q[-1], 1)),
        "least_by_zero": ((N[0], 0), (Q[0], 1)),
        "positive_by_negative": ((1, -1), (Q[-1], 1)),
        "zero_by_negative": ((0, -1), (Q[-1], 1)),
        "negative_by_negative": ((-1, -1), (Q[0], 1)),
        "least_by_least": ((N[0], D[0]), (Q[0], 1)),
        "zero": ((0, 1), (0, 0)),
        "zero_by_largest": ((0, D[-1]), (0, 0)),
        "floor_of_a_little": ((1, D[-1]), ((1 << SH) // D[-1], 0)),
        "floor_of_minus_a_little": ((-1, D[-1]), ((-1 << SH) // D[-1], 0)),
        "one": ((1, 1), (1 << SH, 0)),
        "minus_one": ((-1, 1), (-1 << SH, 0)),
        # remainder 0, smallest and largest remainder
        "multiple": ((5, 5), (1 << SH, 0)),
        "minus_a_multiple": ((-5, 5), (-1 << SH, 0)),
        "below_a_multiple": ((4, 5), ((4 << SH) // 5, 0)),
        "below_minus_a_multiple": ((-6, 5), ((-6 << SH) // 5, 0)),
        "above_a_multiple": ((6, 5), ((6 << SH) // 5, 0)),
        "above_minus_a_multiple": ((-4, 5), ((-4 << SH) // 5, 0)),
        "least_by_largest": ((N[0], D[-1]), ((N[0] << SH) // D[-1], 0)),
        # exact ends of the range and their neighbours, with d = 2^SH
        "largest_quotient": ((Q[-1], 1 << SH), (Q[-1], 0)),
        "just_too_large": ((Q[-1] + 1, 1 << SH), (Q[-1], 1)),
        "least_quotient": ((Q[0], 1 << SH), (Q[0], 0)),
        "just_too_small": ((Q[0] - 1, 1 << SH), (Q[0], 1)),
    }
    # only if some quotient does not fit q
    cases |= {"overflow": ((N[-1], 1), (Q[-1], 1))} if N[-1] << SH > Q[-1] else {}
    cases |= {"negative_overflow": ((N[0], 1), (Q[0], 1))} if N[0] << SH < Q[0] else {}

    def ends_of_the_range():
        """Dividends around the first one of a quotient, for both ends of the range, their neighbours, and -2 to 1."""
        wanted = [q + e for q in (Q[0], Q[-1]) for e in (-1, 0, 1)] + [-2, -1, 0, 1]
        divisors = [d for d in corners(D) if d > 0] + [random.randint(1, D[-1]) for _ in range(40)]
        first = [(math.ceil(Fraction(q * d, 1 << SH)), d) for d in divisors for q in wanted]
        return [(n + e, d) for n, d in first for e in (-1, 0, 1) if n + e in N]

    def quotients_that_fit():
        """Quotients as in the equations: |n / d| up to twice q's range, any magnitude of d, exact or nearly so."""
        vectors = []
        while len(vectors) < 3000:
            d = random.randint(1, (1 << random.randint(1, DW - 1)) - 1)
            q = random.choice((random.randint(2 * Q[0], 2 * Q[-1]), random.choice((Q[0], Q[-1], 0, -1))))
            n = math.ceil(Fraction(q * d, 1 << SH)) + random.choice((-1, 0, 0, 1))
            if n in N:
                vectors.append((n, d))
        return vectors

    def good_after_bad():
        """Valid quotients between zero or negative divisors and overflows."""
        bad = [(n, d) for n in (N[0], -1, 0, 1, N[-1]) for d in (0, -1, D[0])] + [(N[0], 1), (N[-1], 1)]
        good = [(n, d) for n, d in some(400, N, D) if reference(n, d)[1] == 0]
        return [v for g in good for v in (random.choice(bad), g)]

    return checks(
        {"n": N, "d": D},
        {"q": Q, "ovf": BIT},
        each(reference),
        ends_of_the_range,
        quotients_that_fit,
        good_after_bad,
        latency=LAT,
        latencies=[((0, 1), (-1, 0)), ((-1, -1), (0, D[-1]))],
        delays=delays,
        corners=cases,
        good=(min(3, N[-1]), D[-1] // 2 + 1),
    ) | {"recurrence": built("g_digit", DIGIT != 0)}


div = sets_of("NW DW SH QW LAT")


def of_paper(width, n, d, q) -> dict[str, int]:
    return div(n.width, d.width, q.frac - n.frac + d.frac, q.width, Latency(width)["div"], DIGIT=1)


test_ik_div = runs(
    "ik_div",
    bench,
    div(6, 5, 2, 5, 7),
    div(32 + GUARD, 32, 22, 32, Latency(32)["div"]),  # p_e of (13)
    div(6, 5, 2, 5, 4, DIGIT=1),
    div(32 + GUARD, 32, 22, 32, Latency(32)["div"], DIGIT=1),
    more=[
        div(6, 5, 0, 5, 1),
        div(4, 7, 1, 9, 0),  # quotient wider than both operands
        div(4, 8, 1, 5, 3),  # divisor wider than the other words
        *(div(6, 5, 2, 5, lat) for lat in (4, 6, 9)),
        div(32, 32, 30, 32, Latency(32)["div"]),  # c4 of (14)
        div(18 + GUARD, 18, 8, 18, Latency(18)["div"]),
        div(6, 5, 2, 5, 7, DD=3),
        div(6, 5, 2, 5, 6, DIGIT=1, DD=2),
        # digit recurrence; the natural latency is one clock per quotient bit, plus magnitude and sign
        div(6, 5, 2, 5, 5, DIGIT=1),  # two bits per stage, register after the stage
        div(6, 5, 2, 5, 6, DIGIT=1),  # natural
        div(6, 5, 2, 5, 9, DIGIT=1),
        div(6, 5, 0, 5, 6, DIGIT=1),  # all dividend bits are stored
        div(6, 5, 0, 5, 4, DIGIT=1),
        div(4, 7, 1, 9, 6, DIGIT=1),  # fewer rows than quotient bits
        div(4, 7, 1, 9, 4, DIGIT=1),
        div(4, 8, 1, 5, 6, DIGIT=1),
        div(6, 6, 5, 4, 5, DIGIT=1),  # no dividend bit is stored
        div(6, 6, 5, 4, 4, DIGIT=1),  # odd number of rows, two bits per stage
        div(5, 5, 2, 4, 5, DIGIT=1),
        div(8, 2, 0, 3, 4, DIGIT=1),  # dividends far too large
        div(8, 3, 4, 4, 4, DIGIT=1),
        div(2, 8, 6, 8, 9, DIGIT=1),
        div(2, 2, 0, 2, 3, DIGIT=1),  # one row
        div(8, 4, 0, 12, 9, DIGIT=1),  # any quotient fits
        div(2, 8, 3, 8, 4, DIGIT=1),  # all words are as wide as the partial quotient
        # these take Verilator minutes to compile
        *(one for one in instances("div", 4, of_paper) if one["SH"] != 22 and simulator() == "icarus"),
        div(32 + GUARD, 32, 22, 32, 18, DIGIT=1),  # two bits per stage
        div(32, 32, 30, 32, 32, DIGIT=1),
        div(18, 18, 16, 18, 30, DIGIT=1),
    ],
)
test_too_short_a_latency_stops_the_build = stops(
    "ik_div",
    *(div(*values, DIGIT=1) for values in [(6, 5, 2, 5, 3), (32, 32, 30, 32, 17), (6, 6, 5, 4, 3), (2, 2, 0, 2, 2)]),
    says="ik_div_digit_needs_LAT_of_at_least_2_and_half_a_clock_a_quotient_bit",
)
test_widths_out_of_range_stop_the_build = stops(
    "ik_div",
    *(div(*values, DIGIT=1) for values in [(1, 5, 4, 5, 9), (5, 1, 4, 5, 9), (5, 5, 4, 1, 9)]),
    says="ik_div_digit_needs_NW_DW_QW_of_at_least_2_and_SH_of_at_least_0",
)

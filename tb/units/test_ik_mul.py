# SPDX-License-Identifier: Apache-2.0
"""``ik_mul`` against APyTypes: exact product, rounded half up; with SQUARE the square of a, whatever b is."""

from model.dataflow.nodes import GUARD, Latency
from tb.units.unit import Tests, checks, fixed_point, rounded, runs, sets_of, signed, some, stops


def bench(AW: int, BW: int, SH: int, OW: int, SQUARE: int = 0, **delays: int) -> Tests:
    A, B, Q = signed(AW), signed(BW), signed(OW)

    def reference(a, b):
        other = (a, AW) if SQUARE else (b, BW)
        words, saturated = rounded(fixed_point(a, AW, SH) * fixed_point(*other), OW)
        assert not any(saturated), "ik_mul does not saturate: the vector does not belong here"
        return (words,)

    def fits(a, b):
        """The format of q must hold the rounded product, as the datapath's formats guarantee."""
        return -(2 * Q[-1] + 2) << SH <= 2 * a * (a if SQUARE else b) < (2 * Q[-1] + 1) << SH

    def squares():
        return [(a, a) for (a,) in some(500, A) if a in B]

    # product in units of q's LSB and fractions of it, and q: half an LSB rounds up
    half = 1 << SH - 1 if SH else 0
    ties = {
        "zero": ((0, B[0]), 0),
        "one_place": ((1, 1 << SH), 1),
        "minus_one_place": ((-1, 1 << SH), -1),
        "tie": ((1, half), 1),
        "negative_tie": ((-1, half), 0),
        "below_tie": ((1, half - 1), 0),
        "below_negative_tie": ((-1, half + 1), -1),
        "odd_tie": ((3, half), 2),
        "odd_negative_tie": ((-3, half), -1),
    }
    return checks(
        {"a": A, "b": B},
        {"q": Q},
        reference,
        squares,
        latency=Latency(32)["mul"],
        latencies=[((1, 1 << SH if 1 << SH in B else 1), (A[-1], 1) if SQUARE else (-1, B[0]))],
        delays=delays,
        corners=ties if half > 1 and not SQUARE else {},
        good=(A[-1] // 2, 1 << SH // 2),
        fits=fits,
    )


mul = sets_of("AW BW SH OW")
test_ik_mul = runs(
    "ik_mul",
    bench,
    mul(5, 5, 3, 7),
    mul(32, 32, 24, 32 + GUARD),
    mul(33, 33, 0, 66),
    mul(32, 32, 24, 32 + GUARD, SQUARE=1),
    more=[
        mul(5, 5, 0, 10),
        mul(7, 4, 2, 9),
        mul(4, 7, 1, 11),
        mul(18, 18, 10, 18 + GUARD),  # longest words of one tile
        mul(19, 18, 10, 19 + GUARD),
        mul(6, 33, 5, 34),
        mul(35, 35, 30, 40),  # longest words
        mul(32, 32, 30, 32),
        mul(5, 5, 3, 7, SQUARE=1),
        mul(33, 33, 0, 66, SQUARE=1),
        mul(5, 5, 3, 7, DA=3, DB=1),
        mul(19, 18, 10, 19, DB=2),
        mul(5, 5, 3, 7, SQUARE=1, DA=2),
    ],
)
test_ik_mul_of_long_words_does_not_elaborate = stops(
    "ik_mul", mul(36, 32, 30, 32), says="ik_mul_needs_AW_BW_of_at_most_35"
)

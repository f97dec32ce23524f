# SPDX-License-Identifier: Apache-2.0
"""``ik_half`` against fractions: (1 +- c) / 2, clamped to [0, 1]."""

from fractions import Fraction

from model.dataflow.nodes import Latency
from tb.units.unit import Tests, checks, each, runs, sets_of, signed, unsigned


def bench(W: int, MINUS: int) -> Tests:
    words = signed(W)
    one, top = 1 << W - 2, 1 << W - 1  # the value 1 as c and as q
    sign = -1 if MINUS else 1

    def reference(c):
        q = min(max((1 + sign * Fraction(c, one)) / 2, Fraction(0)), Fraction(1)) * top
        assert q.denominator == 1, f"(1 +- {c}) / 2 is not exact"
        return int(q)

    def around_one():
        return [s * one + e for s in (-1, 1) for e in range(-20, 21)]

    return checks(
        {"c": words},
        {"q": unsigned(W)},
        each(reference),
        around_one,
        latency=Latency(32)["mux"],
        latencies=[(0, one)],
        corners={
            "right_angle": (0, top // 2),
            "one": (one * sign, top),
            "minus_one": (-one * sign, 0),
            "just_below_one": ((one - 1) * sign, top - 1),
            "just_above_minus_one": ((1 - one) * sign, 1),
            "above_one": ((one + 1) * sign, top),
            "below_minus_one": ((-one - 1) * sign, 0),
            "largest": (words[-1], 0 if MINUS else top),
            "least": (words[0], top if MINUS else 0),
        },
        good=one // 2 + 1,
    )


half = sets_of("W MINUS")
test_ik_half = runs("ik_half", bench, half(8, 0), half(32, 1), more=[half(8, 1), half(32, 0)])

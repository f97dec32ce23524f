# SPDX-License-Identifier: Apache-2.0
"""``ik_wide`` against Python integers: sum or difference modulo 2^W, with every carry between the halves."""

import itertools

from model.dataflow.nodes import Latency
from tb.units.unit import Tests, checks, corners, each, runs, sets_of, signed, some, unsigned


def bench(W: int, SUB: int, **delays: int) -> Tests:
    words = signed(W)
    least, largest = words[0], words[-1]
    H = W // 2  # width of the lower half
    half = 1 << H

    def wrapped(value):
        """Wrap to a signed word of W bits."""
        return (value - least) % (1 << W) + least

    difference = {
        "nothing_subtracted": ((half - 1, 0), half - 1),
        "from_nothing": ((0, half), -half),
        "borrow": ((half, 1), half - 1),
        "no_borrow": ((half - 1, half - 1), 0),
        "borrow_of_everything": ((0, 1), -1),
        "borrow_of_lower_halves": ((half, half - 1), 1),
        "borrow_below_zero": ((-half, 1), -half - 1),
        "minus_one_subtracted": ((half - 1, -1), half),
        "minus_one_from_itself": ((-1, -1), 0),
        "least_from_itself": ((least, least), 0),
        "least_from_zero": ((0, least), least),
        "least_from_minus_one": ((-1, least), largest),
        "below_the_least": ((least, 1), largest),
        "above_the_largest": ((largest, -1), least),
        "largest_from_least": ((least, largest), 1),
    }
    total = {
        "nothing_added": ((half - 1, 0), half - 1),
        "to_nothing": ((0, -half), -half),
        "carry": ((half - 1, 1), half),
        "carry_of_the_other": ((1, half - 1), half),
        "no_carry": ((half - 1, half), 2 * half - 1),
        "carry_through_everything": ((-1, 1), 0),
        "carry_of_lower_halves": ((half - 1, half - 1), 2 * half - 2),
        "carry_below_zero": ((-half - 1, 1), -half),
        "minus_one_added": ((half, -1), half - 1),
        "minus_one_added_to_itself": ((-1, -1), -2),
        "least_added_to_itself": ((least, least), 0),
        "least_and_minus_one": ((least, -1), largest),
        "above_the_largest": ((largest, 1), least),
        "largest_and_least": ((largest, least), -1),
    }

    def extreme_halves():
        """All pairs of words with extreme halves, for every carry across the middle."""
        halves = [high * half + low for high in corners(signed(W - H)) for low in corners(unsigned(H))]
        return itertools.product(halves, halves)

    def small_results():
        """Words that cancel exactly or almost, for the sign that comparisons use."""
        near = [0, 1, -1, half - 1, half, half + 1, -half + 1, -half, -half - 1]
        drawn = [a for (a,) in some(200, words)]
        return [(a, wrapped((a if SUB else -a) + little)) for a in drawn for little in near]

    return checks(
        {"a": words, "b": words},
        {"q": words},
        each(lambda a, b: wrapped(a - b if SUB else a + b)),
        extreme_halves,
        small_results,
        latency=Latency(32)["wide"],
        latencies=[
            # either half of either operand
            *(((0, 0), other) for other in [(1, 0), (half, 0), (0, 1), (0, half)]),
            # carry or borrow from the lower half to the upper
            ((half - 1, 0), (half - 1, -1 if SUB else 1)),
            ((half, 0), (half, 1 if SUB else -1)),
        ],
        delays=delays,
        corners={"zeros": ((0, 0), 0)} | (difference if SUB else total),
        good=(3, 1),
    )


wide = sets_of("W SUB")
test_ik_wide = runs(
    "ik_wide",
    bench,
    wide(6, 1),
    wide(66, 0),
    wide(66, 1),
    wide(6, 1, DA=1, DB=3),
    more=[wide(4, 0), wide(4, 1), wide(6, 0), *(wide(w, sub) for w in (34, 38) for sub in (0, 1))],
)

# SPDX-License-Identifier: Apache-2.0
"""``ik_exact`` against Python integers: exact products, or squares that ignore the second operand."""

import itertools

from model.dataflow.nodes import Latency
from tb.units.unit import Tests, checks, corners, each, runs, sets_of, signed, some, unsigned


def bench(W: int, SQUARE: int) -> Tests:
    words = signed(W)
    L = W // 2  # width of the low half
    low, least, largest = 1 << L, words[0], words[-1]

    squares = {
        "zero": (0, 0),
        "one": (1, 1),
        "minus_one": (-1, 1),  # every bit of the sum of tiles is involved, and a carry is left
        "low_half": (low - 1, (1 << 2 * L) - (2 << L) + 1),  # a low half has no sign
        "low_half_below_zero": (-low + 1, (1 << 2 * L) - (2 << L) + 1),
        "high_half": (low, 1 << 2 * L),
        "high_half_below_zero": (-low, 1 << 2 * L),
        "largest": (largest, (1 << 2 * W - 2) - (1 << W) + 1),
        "least": (least, 1 << 2 * W - 2),
        "least_but_one": (least + 1, (1 << 2 * W - 2) - (1 << W) + 1),
    }
    products = {
        "zero_by_least": ((0, least), 0),
        "one_by_minus_one": ((1, -1), -1),
        "minus_one_by_one": ((-1, 1), -1),
        "minus_one_by_least": ((-1, least), 1 << W - 1),
        "least_by_minus_one": ((least, -1), 1 << W - 1),
        "least_by_largest": ((least, largest), (1 << W - 1) - (1 << 2 * W - 2)),
        "largest_by_least": ((largest, least), (1 << W - 1) - (1 << 2 * W - 2)),
        "high_by_low": ((-low, low - 1), low - (1 << 2 * L)),
        "low_by_high": ((low - 1, -low), low - (1 << 2 * L)),
    }
    # with SQUARE the second operand is ignored: use another word
    squared = {f"{name}_squared": ((a, least + 5 if SQUARE else a), p) for name, (a, p) in squares.items()}

    def extreme_halves():
        """All pairs of words with extreme halves, which give the extremes of the tiles."""
        halves = [high * low + rest for high in corners(signed(W - L)) for rest in corners(unsigned(L))]
        return itertools.product(halves, halves)

    def equal_or_opposite():
        """Two equal operands, or one the negative of the other."""
        drawn = [a for (a,) in some(500, words)]
        return [(a, a) for a in drawn] + [(a, -a) for a in drawn if -a in words]

    others = (
        [(1, 0), (low, 0), (least, 0)]
        if SQUARE
        else [
            (low + 1, 2),
            (-1, 2),
            (least, 2),
            (1, low),
            (1, -1),
            (1, least),
        ]
    )
    return checks(
        {"a": words, "b": words},
        {"p": signed(2 * W)},
        each(lambda a, b: a * (a if SQUARE else b)),
        extreme_halves,
        equal_or_opposite,
        latency=Latency(32)["square" if SQUARE else "product"],
        latencies=[((0, 0) if SQUARE else (1, 2), other) for other in others],  # either half of either operand
        corners=squared if SQUARE else squared | products,
        good=(low + 1, largest - 1),
    )


exact = sets_of("W SQUARE")
test_ik_exact = runs(
    "ik_exact",
    bench,
    exact(5, 0),
    exact(33, 0),
    exact(33, 1),
    # W = 35 gives tiles of 18x18 bits
    more=[exact(5, 1), *(exact(w, square) for w in (6, 17, 19, 28, 35) for square in (0, 1))],
)

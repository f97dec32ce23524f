# SPDX-License-Identifier: Apache-2.0
"""``ik_mul3`` against exact partial products, truncated and rounded half up, and against its model."""

import numpy as np

from model.dataflow.cores import MUL3_CLOCKS, TILE, mul3, unseen
from tb.units.unit import Tests, built, checks, crossed, runs, sets_of, signed, stops


def bench(AW: int, BW: int, SH: int, OW: int, TILE: int = TILE, SQUARE: int = 0, **delays: int) -> Tests:
    A, B, Q = signed(AW), signed(BW), signed(OW)
    a_last, b_last = (1 << bits for bits in unseen(AW, BW, TILE))
    a_low, b_low = 1 << max(AW - TILE, 0), 1 << max(BW - min(TILE, 18), 0)

    def exact(a, b):
        b = a if SQUARE else b
        a, b = a - a % a_last, b - b % b_last
        a_lo, b_lo = a % a_low, b % b_low
        tiles = [(a - a_lo) * (b - b_lo), (a - a_lo) * b_lo, a_lo * (b - b_lo)]
        if 4 * a_low * b_low > 1 << SH:  # two bits of each
            tiles.append(4 * a_lo // a_low * (4 * b_lo // b_low) * a_low * b_low // 16)
        return (sum(4 * tile // (1 << SH) for tile in tiles) + 2) // 4

    def low(q):
        """Return the low OW bits as a signed word."""
        return (q + Q[-1] + 1) % len(Q) + Q[0]

    def reference(a, b):
        words, b = list(map(exact, a, b)), a if SQUARE else b
        assert mul3(np.array(a), np.array(b), SH, AW, BW, TILE).tolist() == words, "the model is no product of tiles"
        return (map(low, words),)

    def extreme_high_parts():
        return [(a // a_low * a_low, b // b_low * b_low) for a, b in crossed(A, B)]

    a_half, b_half = 1 << SH // 2, 1 << SH - 1 - SH // 2  # their product is half an LSB
    cases = {
        "zero": (0, B[0]),
        "half_a_place": (a_half, b_half),
        "minus_half_a_place": (-a_half, b_half),
        "below_half": (a_half - 1, b_half),
        "high_by_low": (a_low, b_low // 2),
        "minus_high_by_low": (-a_low, b_low // 2),
        "low_by_high": (a_low // 2, b_low),
        "low_by_minus_high": (a_low // 2, -b_low),
        "high_by_high": (a_low, b_low),
        "high_by_minus_high": (a_low, -b_low),
        "low_by_low": (a_low - 1, b_low - 1),  # omitted or estimated
        "minus_one_by_low": (-1, b_low - 1),  # the low part of -1 is all ones
        "minus_one_squared": (-1, -1),
    }
    return checks(
        {"a": A, "b": B},
        {"q": Q},
        reference,
        extreme_high_parts,
        latency=MUL3_CLOCKS,
        latencies=[((1, 0), (A[-1] // 2, B[-1] // 2))],
        delays=delays,
        corners={name: (vector, low(exact(*vector))) for name, vector in cases.items()},
        good=(A[-1] // 2, b_low + 1),
    ) | {"square": built("g_square", SQUARE != 0 and a_low == b_low)}


sets = sets_of("AW BW SH OW")
test_ik_mul3 = runs(
    "ik_mul3",
    bench,
    sets(5, 6, 5, 8, TILE=4),
    sets(35, 35, 33, 36),
    sets(6, 6, 6, 8, TILE=4, SQUARE=1),
    more=[
        sets(33, 33, 31, 33, SQUARE=1),
        sets(25, 25, 23, 25, TILE=25, SQUARE=1),  # a is not split
        sets(33, 33, 31, 35),
        sets(33, 35, 31, 35),
        sets(35, 35, 32, 35),
        sets(25, 25, 23, 25),
        sets(19, 23, 15, 23),
        sets(6, 5, 4, 4, TILE=4),  # low bits of the result
        sets(4, 6, 3, 12, TILE=5),  # more bits than the result has
        sets(5, 6, 7, 4, TILE=4),  # one bit of each mixed tile
        sets(33, 33, 30, 33),
        sets(33, 35, 33, 33),
        sets(32, 33, 29, 35),
        sets(35, 35, 34, 35),
        sets(23, 23, 21, 23),
        sets(21, 21, 18, 24),
        sets(5, 6, 5, 8, TILE=4, DA=1, DB=4),
        sets(25, 25, 23, 25, TILE=25),  # two tiles
        sets(19, 25, 17, 25, TILE=25),
        sets(31, 31, 29, 31, TILE=25),
        sets(4, 6, 4, 5, TILE=5),  # a is not split
        sets(6, 4, 4, 5, TILE=5),  # b is not split
        sets(17, 17, 15, 17),  # one tile
        sets(33, 31, 31, 31, TILE=16),  # the last bit of a is ignored
        sets(11, 10, 12, 10, TILE=4),
    ],
)
test_tiles_that_do_not_fit_stop_the_build = stops(
    "ik_mul3",
    sets(36, 33, 31, 33),
    sets(33, 36, 30, 33),
    sets(1, 9, 4, 9),
    sets(9, 9, 2, 9, TILE=8),
    sets(5, 5, 8, 3, TILE=4),
    sets(9, 9, 4, 9, TILE=1),
    says="ik_mul3_needs_words_of_2_to_35_bits_and_a_bit_of_each_tile_on_either_side_of_the_cut",
)

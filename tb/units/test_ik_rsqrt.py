# SPDX-License-Identifier: Apache-2.0
"""``ik_rsqrt`` against its model, bit by bit, and against the exact root in integers: faithful rounding."""

import random

import numpy as np

from model.dataflow.cores import TILE, places, rsqrt, rsqrt_clocks
from tb.units.unit import Tests, checks, runs, unsigned


def bench(F: int, TILE: int = TILE) -> Tests:
    MW = F + 3
    words, one, bit = unsigned(MW), 1 << MW, unsigned(1)
    mantissas = words[one // 4 :]

    def reference(m, twice):
        """Return the model's words. For mantissas they are within an LSB of 2^(F-1) / sqrt(V), V from m to m + 1,
        doubled modulo the word length if ``twice``."""
        y = rsqrt(np.array(m), F, TILE).tolist()
        square = 100 << 2 * F + MW - 2
        off = round(10 * places(F, TILE))
        for v, root in zip(m, y, strict=True):
            near = (10 * root - off) ** 2 * (v + 1) <= square < (10 * root + off) ** 2 * v
            assert near or v not in mantissas, f"the model is not faithful: {v} -> {root}"
        return ([(root << double) % (2 << F) for root, double in zip(y, twice, strict=True)],)

    def segments():
        """Ends, middle, where u changes its sign, and neighbours of many segments, in random order."""
        segment = one >> 11
        places = (0, 1, segment // 4, segment // 2 - 1, segment // 2, segment // 2 + 1, segment - 2, segment - 1)
        words = [start + place for start in range(0, one, 7 * segment) for place in places]
        return [(m, 0) for m in random.sample(words, len(words))]

    def random_mantissas():
        return [(random.choice(mantissas), random.choice(bit)) for _ in range(4000)]

    def any_words():
        """Words below 1/4 among mantissas."""
        some = [random.choice(words) >> random.choice((0, 0, 1, 2, 3, MW // 2)) for _ in range(1000)]
        return [(m, random.choice(bit)) for m in some]

    return checks(
        {"m_next": words, "twice": bit},
        {"y": unsigned(F + 1)},
        reference,
        segments,
        random_mantissas,
        any_words,
        latency=rsqrt_clocks(F, TILE),  # counted after the mantissa register, where `twice` enters
        delays={"DM": 1},
        latencies=[((one // 4, 0), (one - 1, 0)), ((one // 2, 0), (0, 0)), ((one - 1, 0), (one - 1, 1))],
        corners={
            "quarter": ((one // 4, 0), 1 << F),
            "largest": ((one - 1, 0), 1 << F - 1),
            "largest_doubled": ((one - 1, 1), 1 << F),
            "zero": ((0, 0), 1 << F),
            "below_a_quarter": ((one // 4 - 1, 0), int(rsqrt(one // 2 - 1, F, TILE))),
        },
        good=(one // 3, 0),
    )


test_ik_rsqrt = runs(
    "ik_rsqrt",
    bench,
    {"F": 31},
    {"F": 29, "TILE": 16},
    more=[{"F": 22, "TILE": 16}, *({"F": f} for f in (19, 20, 21, 22, 24, 27))],
)

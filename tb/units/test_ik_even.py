# SPDX-License-Identifier: Apache-2.0
"""``ik_even`` against its definition: the largest even left shift with which a word still fits."""

import random

import numpy as np

from model.dataflow.cores import EVEN_CLOCKS, even
from tb.units.unit import Tests, checks, each, runs, sets_of, stops, unsigned


def bench(VW: int, MW: int) -> Tests:
    V = unsigned(VW)

    def normalized(v):
        k = max(k for k in range(VW // 2) if v << 2 * k in V)
        return k, v << 2 * k + MW >> VW

    def reference(v):
        k, m = map(list, each(normalized)(v))
        of_model = even(np.array(v, dtype=object), VW, MW)
        assert [k, m] == [column.tolist() for column in of_model], "the model is not the definition"
        return k, m

    def powers_of_two():
        """Each power of two and its neighbours, for every count."""
        near = {(1 << n) + e for n in range(VW) for e in (-1, 0, 1)}
        return random.sample(sorted(near), len(near))

    def any_length():
        """Words of random length, so that every shift sees all bits."""
        return [random.getrandbits(random.randint(1, VW)) for _ in range(3000)]

    quarter = 1 << MW - 2
    return checks(
        {"v": V},
        {"k": unsigned(6), "m": unsigned(MW)},
        reference,
        powers_of_two,
        any_length,
        latency=EVEN_CLOCKS,
        latencies=[(V[-1], 1)],
        corners={
            "zero": (0, (VW // 2 - 1, 0)),
            "one": (1, (VW // 2 - 1, quarter)),
            "two": (2, (VW // 2 - 1, 2 * quarter)),
            "three": (3, (VW // 2 - 1, 3 * quarter)),
            "four": (4, (VW // 2 - 2, quarter)),
            "largest": (V[-1], (0, min(V[-1] << MW >> VW, (1 << MW) - 1))),
            "quarter": (1 << VW - 2, (0, quarter)),
            "half": (1 << VW - 1, (0, 2 * quarter)),
            "below_quarter": ((1 << VW - 2) - 1, (1, ((1 << VW) - 4) << MW >> VW)),
        },
        good=V[-1] // 9,
    )


sets = sets_of("VW MW")
test_ik_even = runs(
    "ik_even",
    bench,
    sets(32, 34),
    sets(64, 34),
    more=list(map(sets, (16, 16, 18, 34, 36, 48, 50, 54, 62), (22, 5, 24, 23, 24, 30, 31, 33, 50))),
)
test_widths_out_of_range_stop_the_build = stops(
    "ik_even",
    *map(sets, (2, 33, 66, 64), (20, 20, 34, 51)),
    says="ik_even_needs_VW_even_from_4_to_64_and_MW_to_50",
)

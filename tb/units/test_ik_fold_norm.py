# SPDX-License-Identifier: Apache-2.0
"""``ik_fold_norm`` against its definition: the largest even left shift, or a given count; it holds while stalled."""

import random

from model.dataflow.fold.steps import NORMS
from tb.units.standing import Given, Standing
from tb.units.unit import Tests, runs, sets_of

KINDS = ("", *NORMS)


def bench(W: int, D: int, XW: int, LAST: int, DROP: int) -> Tests:
    words = (1 << XW) - 1

    def expected(taken: list[Given], now: Given) -> Given:
        t, kind = taken[-2]["t"], KINDS[taken[-2]["kind"]]
        if kind == "count":  # each bit of the count is sampled with its shift stage
            n = taken[-2]["n"] & 0b100001 | taken[-1]["n"] & 0b011000 | now["n"] & 0b000110
            return {"word": (t << n & words) >> XW - D >> DROP << DROP}
        if kind == "inverse":
            t ^= words
        if kind == "unit":
            t = t >> LAST << LAST
        t = t % (1 << (2 * W - 2 if kind == "arm" else 2 * W)) << 2
        pairs = (XW - t.bit_length()) // 2 if t else W // 2 if kind == "arm" else W - 1
        limited = kind == "unit" and taken[-2]["t"] >> 2 * W - 2 & 1
        mantissa = (1 << D - 1) - 1 if limited else (t << 2 * pairs & words) >> XW - D + 1
        return {"word": mantissa, "zero": int(t == 0), "pairs": pairs}

    def sums() -> Given:
        """Return a sum of random length, or 0; inverted for the kind that inverts."""
        kind = random.randrange(len(KINDS))
        t = random.getrandbits(random.randint(0, XW))
        t ^= words * (KINDS[kind] == "inverse" and random.random() < 0.9)
        return {"t": t, "kind": kind, "n": random.getrandbits(6)}

    async def normals(dut) -> None:
        await Standing(dut, expected, 2).check(sums() for _ in range(2000))

    return {"normals": normals}


norm = sets_of("W D XW LAST DROP")
few = norm(18, 26, 38, 11, 1), norm(24, 33, 50, 17, 2), norm(32, 35, 66, 29, 0)
test_ik_fold_norm = runs("ik_fold_norm", bench, *few)

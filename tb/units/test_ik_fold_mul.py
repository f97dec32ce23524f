# SPDX-License-Identifier: Apache-2.0
"""``ik_fold_mul`` against its definition: the exact product, or a sum of truncated tiles; it holds while stalled."""

import random

from model.dataflow.fold.steps import CUTS
from tb.units.standing import Given, Standing
from tb.units.unit import Tests, runs, sets_of


def signed(word: int, bits: int) -> int:
    return word - (word >> bits - 1 << bits)


def product(D: int, TILE: int, WORD: int, ROOT: int, SINE: int, a: int, b: int, cut: str) -> int:
    """Return the product of two words as 2 D bits; each tile is truncated separately."""
    if cut in ("exact", "power"):
        return signed(a, D) * signed(b, D) % (1 << 2 * D)
    low = D - TILE
    a_low, b_low = a % (1 << low), b % (1 << low)
    a_high, b_high = signed(a >> low, TILE), signed(b >> low, TILE)
    last = {"plain": WORD - 2, "double": WORD - 3, "word": WORD, "root": 2 * low + ROOT, "sine": 2 * low + SINE}[cut]
    outer = a_high * b_high << 2 * low
    if cut in ("plain", "double") and 2 * low > WORD - 3:  # kept part of the product of the low halves
        outer += (a_low >> low - 2) * (b_low >> low - 2) << 2 * low - 4
    tiles = outer, a_high * b_low << low, a_low * b_high << low
    return sum(tile >> last << last for tile in tiles) % (1 << 2 * D)


def bench(D: int, TILE: int, WORD: int, ROOT: int, SINE: int) -> Tests:
    def expected(taken: list[Given], now: Given) -> Given:
        a, b, cut = taken[-3]["a"], taken[-3]["b"], CUTS[taken[-1]["cut"]]
        return {"p": product(D, TILE, WORD, ROOT, SINE, a, b, cut)}

    def word() -> int:
        """Return a random word, or one close to 0 or to either end."""
        near = random.choice((0, 0, 1 << D - 1)) + random.choice((-2, -1, 0, 1, 2))
        return random.choice((random.getrandbits(D), random.getrandbits(D), near % (1 << D)))

    async def products(dut) -> None:
        vectors = ({"a": word(), "b": word(), "cut": random.randrange(len(CUTS))} for _ in range(2000))
        await Standing(dut, expected, 3).check(vectors)

    return {"products": products}


mul = sets_of("D TILE WORD ROOT SINE")
test_ik_fold_mul = runs("ik_fold_mul", bench, mul(26, 16, 25, 5, 4), mul(29, 18, 29, 8, 7), mul(35, 18, 33, 8, 7))

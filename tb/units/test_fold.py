# SPDX-License-Identifier: Apache-2.0
"""Test modules of the folded core against their definitions. They hold their state while ``go`` is 0."""

import random
from collections.abc import Iterable

from model.dataflow.fold.steps import CUTS, NORMS
from tb.units.unit import Case, Ports, Tests, runs, sets_of, with_go


def memory(D: int, AD: int, DOWN: int, RW: int) -> Tests:
    """Check 64 read/write words, initially 0, followed by constant powers of two."""
    written, powers = 64, 64

    def vectors() -> Iterable[Ports]:
        """Yield reads of all addresses and writes to all words, both twice, then random accesses.

        No clock reads the address that it writes, because the result is undefined.
        """

        def access(a: int, b: int, r: int, w: int | None = None) -> Ports:
            ports = {"a_at": a, "b_at": b, "r_at": r, "w_en": int(w is not None), "w_at": w or 0}
            return ports | {"w": random.getrandbits(D)}

        for _ in range(2):
            yield from (access(at, at ^ 1, at % written) for at in range(written + powers))
            yield from (access(at ^ 1, at ^ 2, at ^ 4, at) for at in range(written))
        for _ in range(2000):
            at = random.randrange(written)
            read = [random.randrange(last) for last in (written + powers, written + powers, written)]
            yield access(*read, None if at in read else at)

    async def words(dut) -> None:
        content = [0] * written + [1 << D - 1 >> (n if n < AD else n - DOWN) for n in range(powers)]
        reads: list[Ports] = []

        def expected(taken: list[Ports], now: Ports) -> Ports:
            for at in taken[len(reads) :]:
                row = content[at["r_at"]] >> D - 1 - RW & (1 << RW) - 1
                reads.append({"a": content[at["a_at"]] >> D - AD, "b": content[at["b_at"]], "r": row})
                if at["w_en"]:
                    content[at["w_at"]] = at["w"]
            return reads[-1]

        await with_go(dut, vectors(), 1, expected)

    return {"words": words}


def mul(D: int, TILE: int, WORD: int, ROOT: int, SINE: int) -> Tests:
    """Check the exact product, or for most values of `cut` the sum of tiles, each truncated separately."""
    low = D - TILE
    last = {"plain": WORD - 2, "double": WORD - 3, "word": WORD, "root": 2 * low + ROOT, "sine": 2 * low + SINE}

    def signed(word: int, bits: int) -> int:
        return word - (word >> bits - 1 << bits)

    def expected(taken: list[Ports], now: Ports) -> Ports:
        a, b, cut = taken[-3]["a"], taken[-3]["b"], CUTS[taken[-1]["cut"]]
        if cut in ("exact", "power"):
            return {"p": signed(a, D) * signed(b, D) % (1 << 2 * D)}
        a_low, b_low = a % (1 << low), b % (1 << low)
        a_high, b_high = signed(a >> low, TILE), signed(b >> low, TILE)
        outer = a_high * b_high << 2 * low
        if cut in ("plain", "double") and 2 * low > WORD - 3:  # kept part of the product of the low halves
            outer += (a_low >> low - 2) * (b_low >> low - 2) << 2 * low - 4
        tiles = outer, a_high * b_low << low, a_low * b_high << low
        return {"p": sum(tile >> last[cut] << last[cut] for tile in tiles) % (1 << 2 * D)}

    def word() -> int:
        """Return a random word, or one close to 0 or to either end."""
        near = random.choice((0, 0, 1 << D - 1)) + random.choice((-2, -1, 0, 1, 2))
        return random.choice((random.getrandbits(D), random.getrandbits(D), near % (1 << D)))

    async def products(dut) -> None:
        vectors = ({"a": word(), "b": word(), "cut": random.randrange(len(CUTS))} for _ in range(2000))
        await with_go(dut, vectors, 3, expected)

    return {"products": products}


def norm(W: int, D: int, XW: int, LAST: int, DROP: int) -> Tests:
    """Check left shifts: by the largest even count that fits, or by the count n."""
    kinds, words = ("", *NORMS), (1 << XW) - 1

    def expected(taken: list[Ports], now: Ports) -> Ports:
        t, kind = taken[-2]["t"], kinds[taken[-2]["kind"]]
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

    def sums() -> Ports:
        """Return the ports for a random sum.  Its number of bits is random as well.  For the kind "inverse" its bits
        are inverted in nine of ten calls."""
        kind = random.randrange(len(kinds))
        t = random.getrandbits(random.randint(0, XW))
        t ^= words * (kinds[kind] == "inverse" and random.random() < 0.9)
        return {"t": t, "kind": kind, "n": random.getrandbits(6)}

    async def normals(dut) -> None:
        await with_go(dut, (sums() for _ in range(2000)), 2, expected)

    return {"normals": normals}


CASES = (
    Case("ik_fold_memory", memory, sets_of("D AD DOWN RW", (26, 26, 11, 11), (33, 31, 11, 11))),
    Case(
        "ik_fold_mul", mul, sets_of("D TILE WORD ROOT SINE", (26, 16, 25, 5, 4), (29, 18, 29, 8, 7), (35, 18, 33, 8, 7))
    ),
    Case(
        "ik_fold_norm", norm, sets_of("W D XW LAST DROP", (18, 26, 38, 11, 1), (24, 33, 50, 17, 2), (32, 35, 66, 29, 0))
    ),
)
test_fold, vectors = runs(CASES)

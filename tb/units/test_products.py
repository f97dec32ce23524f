# SPDX-License-Identifier: Apache-2.0
"""Test products against Python integers. With SQUARE the product is the square of a, and b has no effect."""

import itertools

import numpy as np

from model.dataflow.formats import GUARD, Latency
from model.dataflow.mul3 import TILE, mul3, unseen
from tb.units.unit import Case, Tests, checks, crossed, halves, rounded, runs, sets_of, signed, unsigned, wrapped


def exact(W: int, SQUARE: int) -> Tests:
    words = signed(W)

    def extreme_halves():
        """Return all pairs of words with extreme halves, which give the extremes of the tiles."""
        return itertools.product(halves(W), halves(W))

    def reference(a, b):
        return a * (a if SQUARE else b)

    latency = Latency(32)["square" if SQUARE else "product"]
    return checks({"a": words, "b": words}, {"p": signed(2 * W)}, reference, extreme_halves, latency=latency)


def mul(AW: int, BW: int, SH: int, OW: int, SQUARE: int = 0, **delays: int) -> Tests:
    A, B, Q = signed(AW), signed(BW), signed(OW)

    def reference(a, b):
        return rounded(a * (a if SQUARE else b), SH)

    def fits(a, b):
        """Accept operands whose rounded product fits q, as the datapath's formats guarantee."""
        return reference(a, b) in Q

    half = 1 << SH - 1 if SH else 0
    ties = [((1, half), 1), ((-1, half), 0), ((1, half - 1), 0), ((-1, half + 1), -1), ((3, half), 2), ((-3, half), -1)]
    return checks(
        {"a": A, "b": B},
        {"q": Q},
        reference,
        latency=Latency(32)["mul"],
        delays=delays,
        corners=ties if half > 1 and not SQUARE else (),
        good=(A[-1] // 2, 1 << SH // 2),
        fits=fits,
    )


def of_tiles(AW: int, BW: int, SH: int, OW: int, TILE: int = TILE, SQUARE: int = 0, **delays: int) -> Tests:
    """Check a product that is a sum of tiles.  Each tile is truncated two bits below q's LSB.  The sum is rounded half
    up and taken modulo 2^OW."""
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

    def reference(a, b):
        words, b = list(map(exact, a, b)), a if SQUARE else b
        assert mul3(np.array(a), np.array(b), SH, AW, BW, TILE).tolist() == words, "the model is no product of tiles"
        return ([wrapped(word, Q) for word in words],)

    def extreme_high_parts():
        return [(a // a_low * a_low, b // b_low * b_low) for a, b in crossed(A, B)]

    def halves_of_a_place():
        """Return operands with a product of half an LSB, or of the low parts, which is omitted or estimated."""
        a, b = 1 << SH // 2, 1 << SH - 1 - SH // 2
        pairs = [(a, b), (-a, b), (a - 1, b), (a_low, b_low // 2), (a_low // 2, -b_low), (a_low - 1, b_low - 1)]
        return [(a, b) for a, b in [*pairs, (-1, b_low - 1)] if a in A and b in B]

    options = {"latency": Latency(32)["mul3"], "columns": True, "delays": delays}
    return checks({"a": A, "b": B}, {"q": Q}, reference, extreme_high_parts, halves_of_a_place, **options)


def scale(COUNT: int, AW: int, BW: int, SH: int, OW: int, **delays: int) -> Tests:
    """Check the product of b and each word of a against the model, which :func:`of_tiles` checks."""

    def reference(a, b):
        words = [(np.array(a) >> AW * k) % (1 << AW) for k in range(COUNT)]
        words = [word - (word >> AW - 1 << AW) for word in words]
        products = [mul3(word, np.array(b), SH, AW, BW, TILE) % (1 << OW) for word in words]
        return (sum(product << OW * k for k, product in enumerate(products)).tolist(),)

    ports = {"a": unsigned(COUNT * AW), "b": signed(BW)}
    outputs = {"q": unsigned(COUNT * OW)}
    return checks(ports, outputs, reference, columns=True, latency=Latency(32)["mul3"], delays=delays)


names = "AW BW SH OW"
CASES = (
    Case(
        "ik_exact",
        exact,
        sets_of("W SQUARE", (5, 0), (33, 0), (33, 1)),
        sets_of("W SQUARE", (5, 1), (6, 0), (35, 0), (35, 1)),  # W = 35 gives tiles of 18x18 bits
    ),
    Case(
        "ik_mul",
        mul,
        [
            *sets_of(names, (5, 5, 3, 7), (32, 32, 24, 32 + GUARD), (33, 33, 0, 66)),
            *sets_of(names, (32, 32, 24, 32 + GUARD), SQUARE=1),
        ],
        [
            # the longest words of one tile and of all; a product of 32-bit words with 30 fraction bits
            *sets_of(names, (18, 18, 10, 18 + GUARD), (6, 33, 5, 34), (35, 35, 30, 40), (32, 32, 30, 32)),
            *sets_of(names, (5, 5, 3, 7), (33, 33, 0, 66), SQUARE=1),
            *sets_of(names, (5, 5, 3, 7), DA=3, DB=1),
            *sets_of(names, (5, 5, 3, 7), SQUARE=1, DA=2),
        ],
    ),
    Case(
        "ik_mul3",
        of_tiles,
        [
            *sets_of(names, (5, 6, 5, 8), TILE=4),
            *sets_of(names, (35, 35, 33, 36)),
            *sets_of(names, (6, 6, 6, 8), TILE=4, SQUARE=1),
        ],
        [
            *sets_of(names, (33, 33, 31, 33), SQUARE=1),
            *sets_of(names, (25, 25, 23, 25), TILE=25, SQUARE=1),  # a is not split
            *sets_of(names, (33, 35, 31, 35), (25, 25, 23, 25), (19, 23, 15, 23), (35, 35, 34, 35), (17, 17, 15, 17)),
            # low bits of the result; one bit of each mixed tile
            *sets_of(names, (6, 5, 4, 4), (5, 6, 7, 4), TILE=4),
            # more bits than the result has; a or b is not split
            *sets_of(names, (4, 6, 3, 12), (4, 6, 4, 5), (6, 4, 4, 5), TILE=5),
            *sets_of(names, (25, 25, 23, 25), (31, 31, 29, 31), TILE=25),
            *sets_of(names, (33, 31, 31, 31), TILE=16),  # the last bit of a is ignored
            *sets_of(names, (5, 6, 5, 8), TILE=4, DA=1, DB=4),
        ],
    ),
    Case(
        "ik_scale",
        scale,
        sets_of(names, (20, 20, 18, 20), COUNT=3),
        sets_of(names, (25, 25, 23, 25), COUNT=2, DA=2, DB=1),
    ),
)
test_products, vectors = runs(CASES)

# SPDX-License-Identifier: Apache-2.0
"""Test ``ik_shift``, ``ik_shift3``, ``ik_even``, ``ik_lzc`` and ``ik_norm`` against their definitions."""

import random

import numpy as np

from model.dataflow.formats import Latency, inner_frac
from model.dataflow.lean_operations import even
from tb.units.unit import Case, Tests, checks, corners, crossed, runs, sets_of, shuffled, signed, unsigned, wrapped

COUNTS = unsigned(6)


def shift(W: int, RIGHT: int, PRODUCT: int = 0, **delays: int) -> Tests:
    """Check d 2^count modulo 2^W, or the floor of d / 2^count, also for counts larger than W."""
    words = signed(W)

    def every_count():
        return [(d, count) for d in corners(words) for count in COUNTS]

    def reference(d, count):
        return d // 2**count if RIGHT else wrapped(d * 2**count, words)

    timing = {"latency": Latency(32)["shift"], "delays": delays}
    return checks({"d": words, "count": COUNTS}, {"q": words}, reference, every_count, **timing)


def shift3(IW: int, DROP: int, OW: int, **delays: int) -> Tests:
    """Check the low OW bits of the floor of d 2^count / 2^DROP, for any count."""
    words, Q, top = signed(IW), signed(OW), DROP + OW  # top: the bit above the result's MSB

    def every_count():
        return [(d, count) for d in corners(words) for count in COUNTS]

    def single_bits():
        """Return single bits that each count shifts to or next to an end of the result; also bit - 1, -bit, ~bit."""
        places = (0, DROP - 1, DROP, DROP + 1, top - 2, top - 1, top)
        bits = [(1 << place - count, count) for place in places for count in COUNTS if place >= count]
        return [(d, count) for bit, count in bits for d in (bit, bit - 1, -bit, -bit - 1) if d in words]

    def normalized_words():
        """Return short words of either sign. The count shifts their highest bit to just below q's sign, or one off."""
        short = [random.getrandbits(random.randint(1, IW - 1)) for _ in range(500)]
        near = [(d, top - 1 - d.bit_length() + random.choice((-1, 0, 0, 1))) for d in short]
        return [(random.choice((d, ~d)), min(max(count, 0), COUNTS[-1])) for d, count in near]

    def reference(d, count):
        return wrapped(d * 2**count // 2**DROP, Q)

    inputs = {"d": words, "count": COUNTS}
    timing = {"latency": Latency(32)["shift3"], "delays": delays}
    return checks(inputs, {"q": Q}, reference, every_count, single_bits, normalized_words, **timing)


def of_triangle(width: int) -> tuple[int, int, int]:
    """Return the parameters of ``ik_shift3`` in ``ik_lean_triangle``."""
    frac = inner_frac(width)
    return 2 * width + 2, 2 * width + width % 2 - frac, frac + 2


def evenly(VW: int, MW: int) -> Tests:
    """Check k, the largest with which v 4^k still fits VW bits, and m, the floor of v 4^k / 2^(VW-MW)."""
    V = unsigned(VW)

    def normalized(v):
        k = max(k for k in range(VW // 2) if v << 2 * k in V)
        return k, v << 2 * k + MW >> VW

    def reference(v):
        k, m = map(list, zip(*map(normalized, v), strict=True))
        of_model = even(np.array(v, dtype=object), VW, MW)
        assert [k, m] == [column.tolist() for column in of_model], "the model is not the definition"
        return k, m

    def powers_of_two():
        """Return each power of two and its neighbours, so that every count occurs."""
        return shuffled({(1 << n) + e for n in range(VW) for e in (-1, 0, 1)})

    quarter = 1 << MW - 2
    return checks(
        {"v": V},
        {"k": unsigned(6), "m": unsigned(MW)},
        reference,
        powers_of_two,
        columns=True,
        latency=Latency(32)["even"],
        corners=[(0, (VW // 2 - 1, 0)), (1, (VW // 2 - 1, quarter)), (4, (VW // 2 - 2, quarter))],
        good=V[-1] // 9,
    )


def zeros(W: int, N: int, norm: bool = False) -> Tests:
    """Check the largest left shift with which all words still fit, and with `norm` the shifted words. If all words are
    0, `norm` expects one half in word 0."""
    words = signed(W)

    def pack(vector):
        return sum(word % (1 << W) << W * k for k, word in enumerate(vector))

    def reference(d):
        vector = [wrapped(d >> W * k, words) for k in range(N)]
        count = max(s for s in range(W) if all(w << s in words for w in vector)) if any(vector) else 0
        return (pack([w << count for w in vector]) or 1 << W - 2, count) if norm else count

    def extreme_words():
        return [pack(vector) for vector in crossed(*[words] * N)]

    def powers_of_two():
        """Return vectors with a single nonzero word: a power of two or a neighbour, of either sign."""
        near = sorted({s * (1 << k) + e for k in range(W) for s in (1, -1) for e in (-1, 0, 1)})
        return [pack([0] * k + [v]) for k in range(N) for v in near if v in words]

    def common_magnitude():
        """Return vectors of words with a common random magnitude, so that every count occurs."""
        small = [signed(random.randint(1, W)) for _ in range(1000)]
        return [pack([random.randrange(s.start, s.stop) for _ in range(N)]) for s in small]

    return checks(
        {"d": unsigned(N * W)},
        {"q": unsigned(N * W), "count": unsigned(6)} if norm else {"count": unsigned(6)},
        reference,
        extreme_words,
        powers_of_two,
        common_magnitude,
        latency=Latency(32)["norm" if norm else "lzc"],
    )


def norm(W: int, N: int) -> Tests:
    return zeros(W, N, norm=True)


CASES = (
    Case(
        "ik_shift",
        shift,
        sets_of("W RIGHT", (19, 0), (32, 1)) + sets_of("W RIGHT", (33, 0), PRODUCT=1),
        [
            *sets_of("W RIGHT", (8, 0), (8, 1), (33, 0)),
            *sets_of("W RIGHT", (19, 0), PRODUCT=1, DC=2),
            *sets_of("W RIGHT", (8, 1), DD=3, DC=1),
        ],
    ),
    Case(
        "ik_shift3",
        shift3,
        sets_of("IW DROP OW", (7, 3, 4), of_triangle(32), of_triangle(17)),  # at 17 one bit longer than the word
        [
            # the word has bits above the result; in the second set it has fewer bits than the result
            *sets_of("IW DROP OW", (7, 2, 3), (5, 3, 6), (34, 24, 21), *map(of_triangle, (27, 18, 16))),
            *sets_of("IW DROP OW", (7, 3, 4), DD=2),
        ],
    ),
    Case(
        "ik_even",
        evenly,
        sets_of("VW MW", (32, 34), (64, 34)),
        sets_of("VW MW", (16, 22), (16, 5), (18, 24), (36, 24), (48, 30), (54, 33), (62, 50)),
    ),
    Case("ik_lzc", zeros, sets_of("W N", (5, 2), (32, 3)), sets_of("W N", (4, 3), (10, 1), (33, 1), (64, 2))),
    Case("ik_norm", norm, sets_of("W N", (5, 2), (32, 3)), sets_of("W N", (4, 3), (18, 3), (32, 2))),
)
test_shifts, vectors = runs(CASES)

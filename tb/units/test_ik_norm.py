# SPDX-License-Identifier: Apache-2.0
"""``ik_lzc`` and ``ik_norm`` against their definition: the largest left shift with which all words still fit.

``ik_norm`` also returns the shifted words; all zeros give a first word of one half.
"""

import random

from model.dataflow.nodes import Latency
from tb.units.unit import Tests, checks, crossed, each, pack, runs, sets_of, signed, some, unpack, unsigned


def bench(W: int, N: int, norm: bool) -> Tests:
    words = signed(W)
    least, largest = words[0], words[-1]

    def packed(vectors):
        return [pack(vector, W) for vector in vectors]

    def reference(d):
        given = unpack(d, W, N)
        if not any(given):
            return (pack([1 << W - 2], W), 0) if norm else 0
        count = max(s for s in range(W) if all(w << s in words for w in given))
        return (pack([w << count for w in given], W), count) if norm else count

    def full_size(vectors, got):
        """Results of ``ik_norm`` must have full size and the same direction."""
        for (d,), (q, count) in zip(vectors, got, strict=True) if norm else ():
            given, became = unpack(d, W, N), unpack(q, W, N)
            assert 1 << W - 2 <= max(map(abs, became)) <= 1 << W - 1, f"{given} became {became}: not of full size"
            assert not any(given) or became == [w * 2**count for w in given], f"{given} became {became}, {count}"

    def extreme_words():
        return packed(crossed(*[words] * N))

    def powers_of_two():
        """Each power of two, its neighbours and their negatives, in one word at a time."""
        near = sorted({s * (1 << k) + e for k in range(W) for s in (1, -1) for e in (-1, 0, 1)})
        return packed([0] * k + [v] for k in range(N) for v in near if v in words)

    def common_magnitude():
        """Words of any common magnitude, so that every count occurs."""
        small = [signed(random.randint(1, W)) for _ in range(1500)]
        vectors = [[random.randrange(s.start, s.stop) for _ in range(N)] for s in small]
        return packed(vectors + some(500, *[words] * N))

    zeros = [0] * (N - 1)
    cases = {  # words, count, shifted words
        "zeros": ([0] * N, 0, [1 << W - 2] + zeros),
        "minus_ones": ([-1] * N, W - 1, [least] * N),
        "one": ([1] + zeros, W - 2, [1 << W - 2] + zeros),
        "last_one": (zeros + [1], W - 2, zeros + [1 << W - 2]),
        "last_minus_one": (zeros + [-1], W - 1, zeros + [least]),
        "largest": ([largest] + zeros, 0, [largest] + zeros),
        "all_largest": ([largest] * N, 0, [largest] * N),
        "last_least": (zeros + [least], 0, zeros + [least]),
        "all_least": ([least] * N, 0, [least] * N),
        "large_and_minus_one": ([largest] + [-1] * (N - 1), 0, [largest] + [-1] * (N - 1)),
        "half_of_least": ([least // 2] + zeros, 1, [least] + zeros),
        "half_of_least_and_ones": ([least // 2] + [1] * (N - 1), 1, [least] + [2] * (N - 1)),
        "last_half_of_largest": (zeros + [largest // 2], 1, zeros + [largest // 2 * 2]),
    }
    return checks(
        {"d": unsigned(N * W)},
        {"q": unsigned(N * W), "count": unsigned(6)} if norm else {"count": unsigned(6)},
        each(reference),
        extreme_words,
        powers_of_two,
        common_magnitude,
        latency=Latency(32)["norm" if norm else "lzc"],
        latencies=[(pack([least] * N, W), pack([1] * N, W))],
        corners={
            name: (pack(given, W), (pack(q, W), count) if norm else count) for name, (given, count, q) in cases.items()
        },
        good=pack([largest // 4] * N, W),
        also=full_size,
    )


def lzc_bench(W: int, N: int) -> Tests:
    return bench(W, N, norm=False)


def norm_bench(W: int, N: int) -> Tests:
    return bench(W, N, norm=True)


of = sets_of("W N")
test_ik_lzc = runs("ik_lzc", lzc_bench, of(5, 2), of(32, 3), more=[of(4, 3), of(10, 1), of(33, 1), of(64, 2)])
test_ik_norm = runs("ik_norm", norm_bench, of(5, 2), of(32, 3), more=[of(4, 3), of(18, 3), of(32, 2)])

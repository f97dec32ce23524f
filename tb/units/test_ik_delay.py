# SPDX-License-Identifier: Apache-2.0
"""``ik_delay`` and ``ik_ring``: every word comes out N clocks later; for ``ik_delay`` also N = 0."""

from tb.units.unit import Tests, checks, each, places, runs, sets_of, stops, unsigned


def bench(W: int, N: int) -> Tests:
    words = unsigned(W)

    def single_bits():
        """Each bit alone, to detect lost or swapped bits."""
        return [1 << k for k in range(W)]

    def each_place():
        """Fill every ring location with zeros, then ones, then zeros, to toggle every bit."""
        lap = 1 << max(N, 1).bit_length()
        return [word for word in (0, words[-1], 0) for _ in range(lap)]

    return checks(
        {"d": words},
        {"q": words},
        each(lambda d: d),
        single_bits,
        each_place,
        latency=N,
        latencies=[(0, words[-1]), (words[-1], 0)],
    )


def bench_of_ring(W: int, N: int) -> Tests:
    return bench(W, N) | {"places": places("ring", 1 << (N - 2).bit_length(), W)}


delay = sets_of("W N")
test_ik_delay = runs("ik_delay", bench, delay(8, 0), delay(70, 5), more=[delay(8, 1), delay(32, 40)])
test_ik_ring = runs(
    "ik_ring", bench_of_ring, delay(40, 18), more=[delay(*of) for of in ((8, 3), (96, 65), (8, 18), (2, 100), (2, 300))]
)

test_ik_delay_of_negative_length_does_not_elaborate = stops(
    "ik_delay", delay(8, -1), says="ik_delay_needs_N_of_at_least_0"
)
test_ik_ring_that_is_too_short_does_not_elaborate = stops("ik_ring", delay(8, 2), says="ik_ring_needs_N_of_at_least_3")

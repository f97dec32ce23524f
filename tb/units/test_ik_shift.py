# SPDX-License-Identifier: Apache-2.0
"""``ik_shift``: times 2^count modulo 2^W, or floor of a division by 2^count; includes counts beyond the word."""

from model.dataflow.nodes import Latency
from tb.units.unit import Tests, checks, corners, each, runs, sets_of, signed, some, unsigned


def bench(W: int, RIGHT: int, PRODUCT: int = 0, **delays: int) -> Tests:
    words, counts = signed(W), unsigned(6)
    least, largest = words[0], words[-1]

    def reference(d, count):
        return d // 2**count if RIGHT else (d * 2**count - least) % (1 << W) + least

    def every_count():
        return [(d, count) for d in corners(words) for count in counts]

    def short_counts():
        return some(1500, words, unsigned(5))

    right = {
        "minus_one_right": ((-1, 63), -1),
        "one_right": ((1, 1), 0),
        "floor_of_minus_three_halves": ((-3, 1), -2),
        "least_right_to_the_end": ((least, W - 1), -1),
        "least_right_beyond": ((least, W), -1),
        "largest_right_beyond": ((largest, W), 0),
    }
    left = {
        "one_left_to_the_sign": ((1, W - 1), least),
        "one_left_out": ((1, W), 0),
        "minus_one_left": ((-1, W - 1), least),
        "minus_one_left_beyond": ((-1, 63), 0 if W <= 63 else least),
        "largest_left": ((largest, 1), -2),
    }
    return checks(
        {"d": words, "count": counts},
        {"q": words},
        each(reference),
        every_count,
        short_counts,
        latency=Latency(32)["shift"],
        latencies=[((0, 1), (least // 2 + 1, 1)), ((largest // 2, 0), (largest // 2, 9))],  # of the word, of the count
        delays=delays,
        corners={"by_nothing": ((least + 1, 0), least + 1)} | (right if RIGHT else left),
        good=(3, 0),
    )


shift = sets_of("W RIGHT")
test_ik_shift = runs(
    "ik_shift",
    bench,
    shift(19, 0),
    shift(32, 1),
    shift(33, 0, PRODUCT=1),
    more=[
        shift(8, 0),
        shift(8, 1),
        shift(33, 0),
        shift(18, 1),
        shift(8, 0, PRODUCT=1),
        shift(19, 0, PRODUCT=1),
        shift(8, 1, DD=3, DC=1),
        shift(19, 0, PRODUCT=1, DC=2),
    ],
)

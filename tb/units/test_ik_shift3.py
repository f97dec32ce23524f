# SPDX-License-Identifier: Apache-2.0
"""``ik_shift3``: the low bits of the floor of d 2^count / 2^DROP, for any count."""

import random

from model.dataflow.nodes import Latency, inner_frac
from tb.units.unit import Tests, checks, corners, each, runs, sets_of, signed, some, unsigned


def bench(IW: int, DROP: int, OW: int, **delays: int) -> Tests:
    words, counts, Q = signed(IW), unsigned(6), signed(OW)
    top = DROP + OW  # bit above the result's MSB
    place = 1 << DROP  # the result's LSB

    out = max(top - counts[-1], 0)  # lowest bit that a count can shift above the result
    cases = {
        "zero": (0, 63, 0),
        "one_place": (place, 0, 1),
        "below_one_place": (place - 1, 0, 0),
        "minus_one_place": (-place, 0, -1),
        "above_minus_one_place": (-place + 1, 0, -1),
        "below_minus_one_place": (-place - 1, 0, -2),
        "floor_of_almost_nothing": (1, 0, 0),
        "floor_of_almost_nothing_below_zero": (-1, 0, -1),
        "one_to_the_last_place": (1, DROP, 1),
        "minus_one_to_the_last_place": (-1, DROP, -1),
        "minus_one_below_the_last_place": (-1, DROP - 1, -1),
        "three_halves": (3, DROP - 1, 1),
        "minus_three_halves": (-3, DROP - 1, -2),
        "to_below_the_sign": (1 << out, top - 2 - out, Q[-1] // 2 + 1),
        "to_the_sign": (1 << out, top - 1 - out, Q[0]),
        "to_above_the_sign": (1 << out, top - out, 0),
        "minus_to_the_sign": (-1 << out, top - 1 - out, Q[0]),
        "minus_to_above_the_sign": (-1 << out, top - out, 0),
        "sign_changes": (3 << out, top - 2 - out, -Q[-1] // 2),
        "least_to_the_end": (words[0], top - IW, Q[0]),
        "least_beyond": (words[0], top - IW + 1, 0),
        "minus_one_by_the_largest_count": (-1, 63, -(1 << 63 - DROP) if 63 < top else 0),
    }
    cases |= {"largest_to_the_end": (words[-1], top - IW, Q[-1])} if OW <= IW else {}
    cases |= {"largest_beyond": (words[-1], top - IW + 1, -1)} if OW < IW else {}

    def every_count():
        return [(d, count) for d in corners(words) for count in counts]

    def single_bits():
        """Bits shifted to and next to either end of the result, and the words just below them, at every count."""
        places = (0, DROP - 1, DROP, DROP + 1, top - 2, top - 1, top)
        bits = [(1 << place - count, count) for place in places for count in counts if place >= count]
        return [(d, count) for bit, count in bits for d in (bit, bit - 1, -bit, -bit - 1) if d in words]

    def short_counts():
        return some(1500, words, unsigned(5))

    def normalized_words():
        """Short words at the count that aligns their MSB with the result's, and at one less and one more."""
        short = [random.getrandbits(random.randint(1, IW - 1)) for _ in range(500)]
        near = [(d, top - 1 - d.bit_length() + random.choice((-1, 0, 0, 1))) for d in short]
        return [(random.choice((d, ~d)), min(max(count, 0), counts[-1])) for d, count in near]

    return checks(
        {"d": words, "count": counts},
        {"q": Q},
        each(lambda d, count: (d * 2**count // place - Q[0]) % (1 << OW) + Q[0]),
        every_count,
        single_bits,
        short_counts,
        normalized_words,
        latency=Latency(32)["shift3"],
        # latencies of the word and of the count's three parts
        latencies=[((0, 0), (place, 0)), ((0, 1), (-1, 1)), *(((place, 0), (place, part)) for part in (16, 4, 1))],
        delays=delays,
        corners={name: ((d, count), q) for name, (d, count, q) in cases.items()},
        good=(place, 1),
    )


shift3 = sets_of("IW DROP OW")


def triangle(width: int) -> dict[str, int]:
    """Return the parameters used in ``ik_lean_triangle``."""
    frac = inner_frac(width)
    return shift3(2 * width + 2, 2 * width + width % 2 - frac, frac + 2)


test_ik_shift3 = runs(
    "ik_shift3",
    bench,
    shift3(7, 3, 4),
    triangle(32),
    triangle(17),  # one bit longer than the word
    more=[
        shift3(7, 2, 3),  # the word has bits above the result
        shift3(5, 3, 6),
        shift3(66, 20, 33),
        shift3(34, 24, 21),
        shift3(7, 3, 4, DD=2),
        *map(triangle, (31, 27, 18, 16)),
    ],
)


def test_triangle():
    """The parameter sets have the intended widths."""
    assert (triangle(32), triangle(18)) == (shift3(66, 31, 35), shift3(38, 13, 25))

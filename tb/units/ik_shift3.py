# SPDX-License-Identifier: Apache-2.0
"""``ik_shift3``: times 2^count, then the floor of a division by 2^DROP, of which the low bits; any count."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, corners, each, named, parameters, signed, some, unsigned

P = parameters()
IW, DROP, OW = (P[k] for k in ("IW", "DROP", "OW"))
WORDS, COUNTS, Q = signed(IW), unsigned(6), signed(OW)
TOP = DROP + OW  # the place above the result's
PLACE = 1 << DROP  # the result's last
EXHAUSTIVE = IW <= 8


def reference(d: int, count: int) -> tuple[int]:
    return ((d * 2**count // PLACE - Q[0]) % (1 << OW) + Q[0],)


def bench(dut) -> Unit:
    return Unit(dut, "d count", "q", each(reference), latency=Latency(32)["shift3"], signed="d q")


OUT = max(TOP - COUNTS[-1], 0)  # the lowest bit that a count can bring above the result
CASES = {
    "zero": (0, 63, 0),
    "one_place": (PLACE, 0, 1),
    "below_one_place": (PLACE - 1, 0, 0),
    "minus_one_place": (-PLACE, 0, -1),
    "above_minus_one_place": (-PLACE + 1, 0, -1),
    "below_minus_one_place": (-PLACE - 1, 0, -2),
    "floor_of_almost_nothing": (1, 0, 0),
    "floor_of_almost_nothing_below_zero": (-1, 0, -1),
    "one_to_the_last_place": (1, DROP, 1),
    "minus_one_to_the_last_place": (-1, DROP, -1),
    "minus_one_below_the_last_place": (-1, DROP - 1, -1),
    "three_halves": (3, DROP - 1, 1),
    "minus_three_halves": (-3, DROP - 1, -2),
    "to_below_the_sign": (1 << OUT, TOP - 2 - OUT, Q[-1] // 2 + 1),
    "to_the_sign": (1 << OUT, TOP - 1 - OUT, Q[0]),
    "to_above_the_sign": (1 << OUT, TOP - OUT, 0),
    "minus_to_the_sign": (-1 << OUT, TOP - 1 - OUT, Q[0]),
    "minus_to_above_the_sign": (-1 << OUT, TOP - OUT, 0),
    "sign_changes": (3 << OUT, TOP - 2 - OUT, -Q[-1] // 2),
    "largest_to_the_end": (WORDS[-1], TOP - IW, Q[-1] if OW <= IW else None),
    "least_to_the_end": (WORDS[0], TOP - IW, Q[0]),
    "largest_beyond": (WORDS[-1], TOP - IW + 1, -1 if OW < IW else None),
    "least_beyond": (WORDS[0], TOP - IW + 1, 0),
    "minus_one_by_the_largest_count": (-1, 63, -(1 << 63 - DROP) if 63 < TOP else 0),
}
CASES = {
    name: ((d, count), q) for name, (d, count, q) in CASES.items() if d in WORDS and count in COUNTS and q in Q
}  # what these widths can have


@cocotb.test()
async def latency(dut):
    """Of the word and of the count's three parts."""
    unit = bench(dut)
    await unit.check_latency((0, 0), (PLACE, 0))
    await unit.check_latency((0, 1), (-1, 1))
    for count in (16, 4, 1):
        await unit.check_latency((PLACE, 0), (PLACE, count))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    vector, q = CASES[case]
    await bench(dut).check_corner(vector, (q,), good=(PLACE, 1))


@cocotb.test()
async def every_count(dut):
    await bench(dut).check((d, count) for d in corners(WORDS) for count in COUNTS)


@cocotb.test()
async def single_bits(dut):
    """At every count, bits that land at and next to either end of the result, and what is just below them."""
    places = (0, DROP - 1, DROP, DROP + 1, TOP - 2, TOP - 1, TOP)
    bits = [(1 << place - count, count) for place in places for count in COUNTS if place >= count]
    vectors = [(d, count) for bit, count in bits for d in (bit, bit - 1, -bit, -bit - 1) if d in WORDS]
    await bench(dut).check(vectors)


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = list(itertools.product(WORDS, COUNTS))
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    await bench(dut).check(some(1500, WORDS, COUNTS) + some(1500, WORDS, unsigned(5)))


@cocotb.test(skip=EXHAUSTIVE)
async def normalized_words(dut):
    """Short words at the count that brings their upper end to the result's, one less and one more."""
    words = [random.getrandbits(random.randint(1, IW - 1)) for _ in range(500)]
    words = [d if random.random() < 0.5 else ~d for d in words]
    counts = [TOP - 1 - (d if d >= 0 else ~d).bit_length() + random.choice((-1, 0, 0, 1)) for d in words]
    await bench(dut).check((d, min(max(count, 0), COUNTS[-1])) for d, count in zip(words, counts, strict=True))

# SPDX-License-Identifier: Apache-2.0
"""``ik_shift``: times 2^count modulo 2^W, or the floor of a division by 2^count; counts beyond the word included."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, corners, each, named, parameters, signed, some, unsigned

P = parameters()
W, RIGHT = P["W"], P["RIGHT"]
WORDS, COUNTS = signed(W), unsigned(6)
EXHAUSTIVE = W <= 8


def reference(d: int, count: int) -> tuple[int]:
    if RIGHT:
        return (d // 2**count,)
    return ((d * 2**count + (1 << W - 1)) % (1 << W) - (1 << W - 1),)


def bench(dut) -> Unit:
    return Unit(dut, "d count", "q", each(reference), latency=Latency(32)["shift"], signed="d q")


CASES = {
    "by_nothing": ((WORDS[0] + 1, 0), WORDS[0] + 1),
    "minus_one_right": ((-1, 63), -1),
    "one_right": ((1, 1), 0),
    "floor_of_minus_three_halves": ((-3, 1), -2),
    "least_right_to_the_end": ((WORDS[0], W - 1), -1),
    "least_right_beyond": ((WORDS[0], W), -1),
    "largest_right_beyond": ((WORDS[-1], W), 0),
} if RIGHT else {
    "by_nothing": ((WORDS[0] + 1, 0), WORDS[0] + 1),
    "one_left_to_the_sign": ((1, W - 1), WORDS[0]),
    "one_left_out": ((1, W), 0),
    "minus_one_left": ((-1, W - 1), WORDS[0]),
    "minus_one_left_beyond": ((-1, 63), 0 if W <= 63 else WORDS[0]),
    "largest_left": ((WORDS[-1], 1), -2),
}  # fmt: skip


@cocotb.test()
async def latency(dut):
    """Of the word and of the count."""
    unit = bench(dut)
    await unit.check_latency((0, 1), (WORDS[0] // 2 + 1, 1))
    await unit.check_latency((WORDS[-1] // 2, 0), (WORDS[-1] // 2, 9))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    vector, q = CASES[case]
    await bench(dut).check_corner(vector, (q,), good=(3, 0))


@cocotb.test()
async def every_count(dut):
    await bench(dut).check((d, count) for d in corners(WORDS) for count in COUNTS)


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = list(itertools.product(WORDS, COUNTS))
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    await bench(dut).check(some(1500, WORDS, COUNTS) + some(1500, WORDS, unsigned(5)))

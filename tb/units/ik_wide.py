# SPDX-License-Identifier: Apache-2.0
"""``ik_wide`` against Python's integers: a sum or difference modulo 2^W, whatever goes from one half to the other."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, corners, crossed, each, named, parameters, signed, some, unsigned

P = parameters()
W, SUB = P["W"], P["SUB"]
WORDS = signed(W)
H = W // 2  # of the lower half
HALF = 1 << H
LEAST, LARGEST = WORDS[0], WORDS[-1]
EXHAUSTIVE = W <= 6


def wrapped(value: int) -> int:
    """What W bits hold of it."""
    return (value - LEAST) % (1 << W) + LEAST


def reference(a: int, b: int) -> tuple[int]:
    return (wrapped(a - b if SUB else a + b),)


def bench(dut) -> Unit:
    return Unit(dut, "a b", "q", each(reference), latency=Latency(32)["wide"], signed="a b q")


CASES = {
    "zeros": ((0, 0), 0),
    "nothing_subtracted": ((HALF - 1, 0), HALF - 1),
    "from_nothing": ((0, HALF), -HALF),
    "borrow": ((HALF, 1), HALF - 1),
    "no_borrow": ((HALF - 1, HALF - 1), 0),
    "borrow_of_everything": ((0, 1), -1),
    "borrow_of_lower_halves": ((HALF, HALF - 1), 1),
    "borrow_below_zero": ((-HALF, 1), -HALF - 1),
    "minus_one_subtracted": ((HALF - 1, -1), HALF),
    "minus_one_from_itself": ((-1, -1), 0),
    "least_from_itself": ((LEAST, LEAST), 0),
    "least_from_zero": ((0, LEAST), LEAST),
    "least_from_minus_one": ((-1, LEAST), LARGEST),
    "below_the_least": ((LEAST, 1), LARGEST),
    "above_the_largest": ((LARGEST, -1), LEAST),
    "largest_from_least": ((LEAST, LARGEST), 1),
} if SUB else {
    "zeros": ((0, 0), 0),
    "nothing_added": ((HALF - 1, 0), HALF - 1),
    "to_nothing": ((0, -HALF), -HALF),
    "carry": ((HALF - 1, 1), HALF),
    "carry_of_the_other": ((1, HALF - 1), HALF),
    "no_carry": ((HALF - 1, HALF), 2 * HALF - 1),
    "carry_through_everything": ((-1, 1), 0),
    "carry_of_lower_halves": ((HALF - 1, HALF - 1), 2 * HALF - 2),
    "carry_below_zero": ((-HALF - 1, 1), -HALF),
    "minus_one_added": ((HALF, -1), HALF - 1),
    "minus_one_added_to_itself": ((-1, -1), -2),
    "least_added_to_itself": ((LEAST, LEAST), 0),
    "least_and_minus_one": ((LEAST, -1), LARGEST),
    "above_the_largest": ((LARGEST, 1), LEAST),
    "largest_and_least": ((LARGEST, LEAST), -1),
}  # fmt: skip


@cocotb.test()
async def latency(dut):
    """Of either half of either operand, and of what goes from the lower half to the upper."""
    unit = bench(dut)
    for quiet, other in [
        ((0, 0), (1, 0)),
        ((0, 0), (HALF, 0)),
        ((0, 0), (0, 1)),
        ((0, 0), (0, HALF)),
        ((HALF - 1, 0), (HALF - 1, -1 if SUB else 1)),
        ((HALF, 0), (HALF, 1 if SUB else -1)),
    ]:
        await unit.check_latency(quiet, other)


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    vector, q = CASES[case]
    await bench(dut).check_corner(vector, (q,), good=(3, 1))


@cocotb.test()
async def extremes(dut):
    """Least and largest words, 0 and their neighbours, each with each."""
    await bench(dut).check(crossed(WORDS, WORDS))


@cocotb.test()
async def extreme_halves(dut):
    """Words of extreme halves, each with each: all that can go over the middle."""
    words = [high * HALF + low for high in corners(signed(W - H)) for low in corners(unsigned(H))]
    await bench(dut).check(itertools.product(words, words))


@cocotb.test(skip=not EXHAUSTIVE)
async def every_pair(dut):
    vectors = [(a, b) for a in WORDS for b in WORDS]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_pairs(dut):
    await bench(dut).check(some(3000, WORDS, WORDS))


@cocotb.test(skip=EXHAUSTIVE)
async def small_results(dut):
    """Words that cancel, and words that cancel but for little: the sign that comparisons look at."""
    near = [0, 1, -1, HALF - 1, HALF, HALF + 1, -HALF + 1, -HALF, -HALF - 1]
    words = [a for (a,) in some(200, WORDS)]
    await bench(dut).check((a, wrapped((a if SUB else -a) + little)) for a in words for little in near)

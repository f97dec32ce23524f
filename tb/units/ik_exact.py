# SPDX-License-Identifier: Apache-2.0
"""``ik_exact`` against Python's integers: exact products, or squares that do not look at the second operand."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, corners, crossed, each, named, parameters, signed, some, unsigned

P = parameters()
W, SQUARE = P["W"], P["SQUARE"]
WORDS = signed(W)
L = W // 2  # of the low half
LOW = 1 << L
EXHAUSTIVE = W <= 6


def reference(a: int, b: int) -> tuple[int]:
    return (a * (a if SQUARE else b),)


def bench(dut) -> Unit:
    return Unit(dut, "a b", "p", each(reference), latency=Latency(32)["square"], signed="a b p")


SQUARES = {
    "zero": (0, 0),
    "one": (1, 1),
    "minus_one": (-1, 1),  # every bit of the tiles' sum takes part, and leaves a carry
    "low_half": (LOW - 1, (1 << 2 * L) - (2 << L) + 1),  # a low half has no sign
    "low_half_below_zero": (-LOW + 1, (1 << 2 * L) - (2 << L) + 1),
    "high_half": (LOW, 1 << 2 * L),
    "high_half_below_zero": (-LOW, 1 << 2 * L),
    "largest": (WORDS[-1], (1 << 2 * W - 2) - (1 << W) + 1),
    "least": (WORDS[0], 1 << 2 * W - 2),
    "least_but_one": (WORDS[0] + 1, (1 << 2 * W - 2) - (1 << W) + 1),
}
PRODUCTS = {
    "zero_by_least": (0, WORDS[0], 0),
    "one_by_minus_one": (1, -1, -1),
    "minus_one_by_one": (-1, 1, -1),
    "minus_one_by_least": (-1, WORDS[0], 1 << W - 1),
    "least_by_minus_one": (WORDS[0], -1, 1 << W - 1),
    "least_by_largest": (WORDS[0], WORDS[-1], (1 << W - 1) - (1 << 2 * W - 2)),
    "largest_by_least": (WORDS[-1], WORDS[0], (1 << W - 1) - (1 << 2 * W - 2)),
    "high_by_low": (-LOW, LOW - 1, LOW - (1 << 2 * L)),
    "low_by_high": (LOW - 1, -LOW, LOW - (1 << 2 * L)),
}
# what SQUARE must not look at: any other word
CASES = {f"{name}_squared": ((a, WORDS[0] + 5 if SQUARE else a), p) for name, (a, p) in SQUARES.items()}
CASES |= {} if SQUARE else {name: ((a, b), p) for name, (a, b, p) in PRODUCTS.items()}
CASES = {name: (v, p) for name, (v, p) in CASES.items() if v[0] in WORDS and v[1] in WORDS}


@cocotb.test()
async def latency(dut):
    """Of either operand and of either half."""
    unit = bench(dut)
    if SQUARE:
        others = [(1, 0), (LOW, 0), (WORDS[0], 0)]
        quiet = (0, 0)
    else:
        others = [(LOW + 1, 2), (-1, 2), (WORDS[0], 2), (1, LOW), (1, -1), (1, WORDS[0])]
        quiet = (1, 2)
    for other in others:
        await unit.check_latency(quiet, other)


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    vector, p = CASES[case]
    await bench(dut).check_corner(vector, (p,), good=(LOW + 1, WORDS[-1] - 1))


@cocotb.test()
async def extremes(dut):
    """Least and largest words, 0 and their neighbours, each with each."""
    await bench(dut).check(crossed(WORDS, WORDS))


@cocotb.test()
async def extreme_halves(dut):
    """The same of the tiles: words of extreme halves, each with each."""
    words = [high * LOW + low for high in corners(signed(W - L)) for low in corners(unsigned(L))]
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
async def squares(dut):
    """Both operands the same word, or one the other's negative."""
    words = [a for (a,) in some(500, WORDS)]
    await bench(dut).check([(a, a) for a in words] + [(a, -a) for a in words if -a in WORDS])

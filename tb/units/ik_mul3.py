# SPDX-License-Identifier: Apache-2.0
"""``ik_mul3`` against exact products of parts, cut off and rounded half up, and against its model."""

import random

import cocotb
import numpy as np

from model.dataflow.cores import MUL3_CLOCKS, cuts, mul3
from tb.units.unit import Unit, crossed, named, parameters, signed, some

P = parameters()
AW, BW, SH, OW = (P[k] for k in ("AW", "BW", "SH", "OW"))
A, B, Q = signed(AW), signed(BW), signed(OW)
A_LOW, B_LOW = (1 << cut for cut in cuts(AW, BW))
EXHAUSTIVE = AW + BW <= 12


def exact(a: int, b: int) -> int:
    a_lo, b_lo = a % A_LOW, b % B_LOW
    tiles = [(a - a_lo) * (b - b_lo), (a - a_lo) * b_lo, a_lo * (b - b_lo)]
    if 4 * A_LOW * B_LOW > 1 << SH:  # two bits of each
        tiles.append(4 * a_lo // A_LOW * (4 * b_lo // B_LOW) * A_LOW * B_LOW // 16)
    return (sum(4 * tile // (1 << SH) for tile in tiles) + 2) // 4


def low(q: int) -> int:
    """What OW bits hold of it."""
    return (q + Q[-1] + 1) % len(Q) + Q[0]


def reference(vectors):
    a, b = np.array(vectors).T
    words = [exact(*v) for v in vectors]
    assert mul3(a, b, SH, AW, BW).tolist() == words, "the model is not the product of three tiles"
    return [(low(q),) for q in words]


def bench(dut) -> Unit:
    return Unit(dut, "a b", "q", reference, latency=MUL3_CLOCKS, signed="a b q")


A_HALF = 1 << SH // 2  # times B_HALF it is half a place
B_HALF = 1 << SH - 1 - SH // 2
CASES = {
    "zero": (0, B[0]),
    "half_a_place": (A_HALF, B_HALF),
    "minus_half_a_place": (-A_HALF, B_HALF),
    "below_half": (A_HALF - 1, B_HALF),
    "high_by_low": (A_LOW, B_LOW // 2),
    "minus_high_by_low": (-A_LOW, B_LOW // 2),
    "low_by_high": (A_LOW // 2, B_LOW),
    "low_by_minus_high": (A_LOW // 2, -B_LOW),
    "high_by_high": (A_LOW, B_LOW),
    "high_by_minus_high": (A_LOW, -B_LOW),
    "low_by_low": (A_LOW - 1, B_LOW - 1),  # left out, or guessed
    "minus_one_by_low": (-1, B_LOW - 1),  # the low part of -1 is all ones
    "minus_one_squared": (-1, -1),
}
CASES = {name: (a, b) for name, (a, b) in CASES.items() if a in A and b in B}


@cocotb.test()
async def latency(dut):
    await bench(dut).check_latency((1, 0), (A[-1] // 2, B[-1] // 2))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    a, b = CASES[case]
    await bench(dut).check_corner((a, b), (low(exact(a, b)),), good=(A[-1] // 2, B_LOW + 1))


@cocotb.test()
async def extremes(dut):
    """Least and largest words, 0 and their neighbours, each with each; the same of the high parts."""
    high = [(a // A_LOW * A_LOW, b // B_LOW * B_LOW) for a, b in crossed(A, B)]
    await bench(dut).check(crossed(A, B) + high)


@cocotb.test(skip=not EXHAUSTIVE)
async def every_pair(dut):
    vectors = [(a, b) for a in A for b in B]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_pairs(dut):
    await bench(dut).check(some(3000, A, B))

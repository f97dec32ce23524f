# SPDX-License-Identifier: Apache-2.0
"""``ik_mul3`` against the exact product less that of the low parts, rounded half up, and against its model."""

import random

import cocotb
import numpy as np

from model.lean_cores import MUL3_CLOCKS, mul3
from tb.unit import Unit, crossed, named, parameters, signed, some

P = parameters()
AW, BW, SH, OW = (P[k] for k in ("AW", "BW", "SH", "OW"))
A, B, Q = signed(AW), signed(BW), signed(OW)
A_LOW, B_LOW = (1 << cut for cut in (max(SH // 2, AW - 18), max(SH - SH // 2, BW - 18)))
EXHAUSTIVE = AW + BW <= 12


def exact(a: int, b: int) -> int:
    kept = a * b - a % A_LOW * (b % B_LOW)
    return (2 * kept + (1 << SH)) // (2 << SH)


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


# a, b and the result, where the cuts add up to SH
CASES = {
    "zero": (0, B[0], 0),
    "high_by_low": (A_LOW, B_LOW // 2, 1),  # exactly half a place: up
    "minus_high_by_low": (-A_LOW, B_LOW // 2, 0),
    "low_by_high": (A_LOW // 2, B_LOW, 1),
    "low_by_minus_high": (A_LOW // 2, -B_LOW, 0),
    "high_by_below_half": (A_LOW, B_LOW // 2 - 1, 0),
    "high_by_high": (A_LOW, B_LOW, 1),
    "high_by_minus_high": (A_LOW, -B_LOW, -1),
    "low_by_low": (A_LOW - 1, B_LOW - 1, 0),  # nearly a place, left out
    "minus_one_by_low": (-1, B_LOW - 1, -1),  # the low part of -1 is all ones
    "minus_one_squared": (-1, -1, exact(-1, -1)),
}
EVEN = A_LOW * B_LOW == 1 << SH
CASES = {name: (a, b, q if EVEN else exact(a, b)) for name, (a, b, q) in CASES.items() if a in A and b in B}


@cocotb.test()
async def latency(dut):
    await bench(dut).check_latency((1, 0), (-A_LOW, B_LOW))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    a, b, q = CASES[case]
    await bench(dut).check_corner((a, b), (low(q),), good=(A[-1] // 2, B_LOW + 1))


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

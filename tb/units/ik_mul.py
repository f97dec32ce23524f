# SPDX-License-Identifier: Apache-2.0
"""``ik_mul`` against APyTypes: exact product, rounded half up; with SQUARE that of a with itself, whatever b is."""

import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, crossed, fixed_point, named, parameters, rounded, signed, some

P = parameters()
AW, BW, SH, OW = (P[k] for k in ("AW", "BW", "SH", "OW"))
SQUARE = P.get("SQUARE", 0)
A, B, Q = signed(AW), signed(BW), signed(OW)
EXHAUSTIVE = AW + BW <= 12


def reference(vectors):
    a, b = zip(*((a, a if SQUARE else b) for a, b in vectors), strict=True)
    words, saturated = rounded(fixed_point(a, AW, SH) * fixed_point(b, BW), OW)
    assert not any(saturated), "ik_mul does not saturate: the vector does not belong here"
    return [(q,) for q in words]


def fits(vector) -> bool:
    """The format of q must hold the rounded product: what the datapath's formats promise."""
    a, b = vector[0], vector[0 if SQUARE else 1]
    return -(2 * Q[-1] + 2) << SH <= 2 * a * b < (2 * Q[-1] + 1) << SH


def bench(dut) -> Unit:
    return Unit(dut, "a b", "q", reference, latency=Latency(32)["mul"], signed="a b q")


# product of the operands, in units of q's last place and fractions of it, and q
HALF = 1 << SH - 1 if SH else 0
TIES = {
    "zero": ((0, B[0]), 0),
    "one_place": ((1, 1 << SH), 1),
    "minus_one_place": ((-1, 1 << SH), -1),
    "tie": ((1, HALF), 1),
    "negative_tie": ((-1, HALF), 0),
    "below_tie": ((1, HALF - 1), 0),
    "below_negative_tie": ((-1, HALF + 1), -1),
    "odd_tie": ((3, HALF), 2),
    "odd_negative_tie": ((-3, HALF), -1),
}
CASES = {name: (v, q) for name, (v, q) in TIES.items() if HALF > 1 and v[1] in B and not SQUARE}


@cocotb.test()
async def latency(dut):
    quiet = (1, 1 << SH if 1 << SH in B else 1)
    await bench(dut).check_latency(quiet, (A[-1], 1) if SQUARE else (-1, B[0]))


@cocotb.test(skip=not CASES)
@cocotb.parametrize(case=named(CASES or ["none"]))
async def tie(dut, case):
    """Half a place goes up, on either side of 0."""
    vector, q = CASES[case]
    await bench(dut).check_corner(vector, (q,), good=(A[-1] // 2, 1 << SH // 2))


@cocotb.test()
async def extremes(dut):
    """Least and largest words, 0 and their neighbours, each with each."""
    await bench(dut).check(filter(fits, crossed(A, B)))


@cocotb.test(skip=not EXHAUSTIVE)
async def every_pair(dut):
    vectors = [v for v in ((a, b) for a in A for b in B) if fits(v)]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_pairs(dut):
    await bench(dut).check(filter(fits, some(3000, A, B)))


@cocotb.test(skip=EXHAUSTIVE)
async def squares(dut):
    await bench(dut).check(filter(fits, ((a, a) for (a,) in some(500, A) if a in B)))

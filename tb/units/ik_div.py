# SPDX-License-Identifier: Apache-2.0
"""``ik_div`` against fractions: the floor of the quotient, saturated; by the sign of n where d <= 0."""

import itertools
import math
import random
from fractions import Fraction

import cocotb

from tb.units.unit import Unit, corners, crossed, each, named, parameters, signed, some

P = parameters()
NW, DW, SH, QW, LAT = (P[k] for k in ("NW", "DW", "SH", "QW", "LAT"))
N, D, Q = signed(NW), signed(DW), signed(QW)
EXHAUSTIVE = NW + DW <= 12
GOOD = (min(3, N[-1]), D[-1] // 2 + 1)


def reference(n: int, d: int) -> tuple[int, int]:
    if d <= 0:
        return (Q[0] if n < 0 else Q[-1]), 1
    floor = math.floor(Fraction(n << SH, d))
    if floor in Q:
        return floor, 0
    return (Q[0] if floor < 0 else Q[-1]), 1


def bench(dut) -> Unit:
    return Unit(dut, "n d", "q ovf", each(reference), latency=LAT, signed="n d q")


CASES = {
    "positive_by_zero": ((1, 0), (Q[-1], 1)),
    "zero_by_zero": ((0, 0), (Q[-1], 1)),
    "negative_by_zero": ((-1, 0), (Q[0], 1)),
    "largest_by_zero": ((N[-1], 0), (Q[-1], 1)),
    "least_by_zero": ((N[0], 0), (Q[0], 1)),
    "positive_by_negative": ((1, -1), (Q[-1], 1)),
    "zero_by_negative": ((0, -1), (Q[-1], 1)),
    "negative_by_negative": ((-1, -1), (Q[0], 1)),
    "least_by_least": ((N[0], D[0]), (Q[0], 1)),
    "zero": ((0, 1), (0, 0)),
    "zero_by_largest": ((0, D[-1]), (0, 0)),
    "floor_of_a_little": ((1, D[-1]), ((1 << SH) // D[-1], 0)),
    "floor_of_minus_a_little": ((-1, D[-1]), ((-1 << SH) // D[-1], 0)),
    "one": ((1, 1), (1 << SH, 0)),
    "minus_one": ((-1, 1), (-1 << SH, 0)),
    # with remainder 0, and with the least and the largest one
    "multiple": ((5, 5), (1 << SH, 0)),
    "minus_a_multiple": ((-5, 5), (-1 << SH, 0)),
    "below_a_multiple": ((4, 5), ((4 << SH) // 5, 0)),
    "below_minus_a_multiple": ((-6, 5), ((-6 << SH) // 5, 0)),
    "above_a_multiple": ((6, 5), ((6 << SH) // 5, 0)),
    "above_minus_a_multiple": ((-4, 5), ((-4 << SH) // 5, 0)),
    "least_by_largest": ((N[0], D[-1]), ((N[0] << SH) // D[-1], 0)),
    "overflow": ((N[-1], 1), (Q[-1], 1)),
    "negative_overflow": ((N[0], 1), (Q[0], 1)),
    # q 2^-SH exactly and its neighbours, where d is a multiple of 2^SH: the ends of the range
    "largest_quotient": ((Q[-1], 1 << SH), (Q[-1], 0)),
    "just_too_large": ((Q[-1] + 1, 1 << SH), (Q[-1], 1)),
    "least_quotient": ((Q[0], 1 << SH), (Q[0], 0)),
    "just_too_small": ((Q[0] - 1, 1 << SH), (Q[0], 1)),
}
if (N[-1] << SH) <= Q[-1]:  # q holds any quotient
    del CASES["overflow"]
if (N[0] << SH) >= Q[0]:
    CASES.pop("negative_overflow", None)
CASES = {k: c for k, c in CASES.items() if c[0][0] in N and c[0][1] in D and c[1][0] in Q}


@cocotb.test()
async def latency(dut):
    """q and ovf leave together, LAT clocks after n and d."""
    unit = bench(dut)
    await unit.check_latency((0, 1), (-1, 0))
    await unit.check_latency((-1, -1), (0, D[-1]))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    """Named cases; the quotients right before and right after are good ones."""
    await bench(dut).check_corner(*CASES[case], good=GOOD)


@cocotb.test()
async def extremes(dut):
    await bench(dut).check(crossed(N, D))


@cocotb.test()
async def ends_of_the_range(dut):
    """Around the first dividend of a quotient: of both ends of the range and what is beside them, of 0 and of -1."""
    wanted = [q + e for q in (Q[0], Q[-1]) for e in (-1, 0, 1)] + [-2, -1, 0, 1]
    divisors = [d for d in corners(D) if d > 0] + [random.randint(1, D[-1]) for _ in range(40)]
    first = [(math.ceil(Fraction(q * d, 1 << SH)), d) for d in divisors for q in wanted]
    await bench(dut).check((n + e, d) for n, d in first for e in (-1, 0, 1) if n + e in N)


@cocotb.test(skip=not EXHAUSTIVE)
async def every_pair(dut):
    vectors = list(itertools.product(N, D))
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_pairs(dut):
    await bench(dut).check(some(2000, N, D))


@cocotb.test(skip=EXHAUSTIVE)
async def quotients_that_fit(dut):
    """As the equations have them: |n / d| up to twice q's range, d of any magnitude; exact quotients and beside."""
    vectors = []
    while len(vectors) < 3000:
        d = random.randint(1, (1 << random.randint(1, DW - 1)) - 1)
        q = random.choice((random.randint(2 * Q[0], 2 * Q[-1]), random.choice((Q[0], Q[-1], 0, -1))))
        n = math.ceil(Fraction(q * d, 1 << SH)) + random.choice((-1, 0, 0, 1))
        if n in N:
            vectors.append((n, d))
    await bench(dut).check(vectors)


@cocotb.test()
async def good_after_bad(dut):
    """Good quotients between divisors that are 0 or negative and quotients that overflow."""
    bad = [(n, d) for n in (N[0], -1, 0, 1, N[-1]) for d in (0, -1, D[0])] + [(N[0], 1), (N[-1], 1)]
    good = [(n, d) for n, d in some(400, N, D) if reference(n, d)[1] == 0]
    await bench(dut).check(v for g in good for v in (random.choice(bad), g))

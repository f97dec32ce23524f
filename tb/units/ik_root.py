# SPDX-License-Identifier: Apache-2.0
"""``ik_root`` against ``math.isqrt``, saturated; 0 and a flag where the argument is negative."""

import math
import random

import cocotb

from tb.units.unit import Unit, corners, each, named, parameters, signed, some

P = parameters()
NW, SH, QW, LAT = (P[k] for k in ("NW", "SH", "QW", "LAT"))
N, Q = signed(NW), signed(QW)
EXHAUSTIVE = NW <= 12


def reference(n: int) -> tuple[int, int]:
    return (min(math.isqrt(n << SH), Q[-1]), 0) if n >= 0 else (0, 1)


def bench(dut) -> Unit:
    return Unit(dut, "n", "q neg", each(reference), latency=LAT, signed="n q")


CASES = {
    "zero": (0, 0, 0),
    "one": (1, math.isqrt(1 << SH), 0),
    "minus_one": (-1, 0, 1),
    "least": (N[0], 0, 1),
    "least_but_one": (N[0] + 1, 0, 1),
    "largest": (N[-1], min(math.isqrt(N[-1] << SH), Q[-1]), 0),
    "a_square": (9 << SH % 2, 3 << (SH + 1) // 2, 0),
    "below_a_square": ((9 << SH % 2) - 1, math.isqrt(((9 << SH % 2) - 1) << SH), 0),
    # the ends of the range
    "largest_root": (((1 << 2 * (QW - 1)) - 1) >> SH, Q[-1], 0),
    "just_too_large": ((1 << 2 * (QW - 1)) >> SH, Q[-1], 0),
}
if SH >= QW:  # arguments lie further apart than the last two squares
    del CASES["largest_root"]
if SH > 2 * (QW - 1):
    del CASES["just_too_large"]
CASES = {k: c for k, c in CASES.items() if c[0] in N and c[1] in Q}


@cocotb.test()
async def latency(dut):
    """q and neg leave together, LAT clocks after n."""
    unit = bench(dut)
    await unit.check_latency((min(4, N[-1]),), (-1,))
    await unit.check_latency((N[0],), (N[-1],))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    """Named cases; the roots right before and right after are good ones."""
    n, q, neg = CASES[case]
    await bench(dut).check_corner((n,), (q, neg), good=(min(5, N[-1]),))


@cocotb.test(skip=not EXHAUSTIVE)
async def all_arguments(dut):
    vectors = [(n,) for n in N]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_arguments(dut):
    await bench(dut).check([(n,) for n in corners(N)] + some(1500, N))


@cocotb.test(skip=EXHAUSTIVE)
async def near_squares(dut):
    """The first argument whose root is r, and the one before it: where a floor goes wrong first."""
    last = math.isqrt(N[-1] << SH)
    roots = [random.randint(0, last) for _ in range(500)]
    roots += [random.getrandbits(random.randint(1, QW - 2)) for _ in range(500)]
    first = [-(-(r * r) >> SH) for r in roots if r <= last]
    await bench(dut).check((n + e,) for n in first for e in (0, -1) if n + e in N)


@cocotb.test()
async def good_after_bad(dut):
    """Good roots between roots of negative numbers."""
    good = [(abs(n) if -n in N else 0,) for (n,) in some(300, N)]
    await bench(dut).check(v for g in good for v in (random.choice([(-1,), (N[0],), (N[0] // 3,)]), g))

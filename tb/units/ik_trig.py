# SPDX-License-Identifier: Apache-2.0
"""``ik_trig`` against ``math.sin`` and ``math.cos`` within the proved bound, and against the model in every bit."""

import math
import random

import cocotb
import numpy as np

from model.dataflow.trig import POINTS, TRIG_CLOCKS, error_bound, half_sincos
from tb.units.unit import Unit, corners, named, parameters, signed, some

P = parameters()
W, F = P["W"], P["F"]
PHI = signed(W)
STEP = 1 << W - 10  # from one table point to the next
BOUND = error_bound(W, F)
EXHAUSTIVE = W <= 16


def model(vectors):
    sin, cos = half_sincos(np.array([phi for (phi,) in vectors], dtype=np.int64), W, F)
    return list(zip(sin.tolist(), cos.tolist(), strict=True))


def bench(dut) -> Unit:
    return Unit(dut, "phi", "sin_h cos_h", model, latency=TRIG_CLOCKS, signed="phi sin_h cos_h")


async def check(dut, vectors) -> None:
    """Equal to the model, and as near to the true values as :func:`model.dataflow.trig.error_bound` says."""
    worst, at = 0.0, 0
    vectors = list(vectors)
    for (phi,), (sin, cos) in zip(vectors, await bench(dut).check(vectors), strict=True):
        half = math.pi * phi / 2**W
        error = max(abs(sin - math.ldexp(math.sin(half), F)), abs(cos - math.ldexp(math.cos(half), F)))
        if error > worst:
            worst, at = error, phi
    said = f"W={W}: largest error of {len(vectors)} angles {worst:.3f} last places (phi={at}), bound {BOUND:.3f}"
    dut._log.info(said)
    assert worst <= BOUND, said


# phi -> sin, cos of phi/2 where they are known exactly or to a root
QUARTER = math.sqrt(0.5)
CASES = {
    "zero": (0, 0.0, 1.0),
    "smallest": (1, math.pi / 2**W, 1.0),
    "smallest_negative": (-1, -math.pi / 2**W, 1.0),
    "half_turn_backwards": (PHI[0], -1.0, 0.0),
    "nearly_half_turn": (PHI[-1], 1.0, math.pi / 2**W),
    "nearly_half_turn_backwards": (PHI[0] + 1, -1.0, math.pi / 2**W),
    "quarter_turn": (1 << W - 2, QUARTER, QUARTER),
    "quarter_turn_backwards": (-(1 << W - 2), -QUARTER, QUARTER),
    "last_before_a_table_point_takes_over": (STEP // 2 - 1, None, None),
    "first_of_the_next_table_point": (STEP // 2, None, None),
    "last_point_but_one": (PHI[-1] - STEP // 2, None, None),
}


@cocotb.test()
async def latency(dut):
    unit = bench(dut)
    await unit.check_latency((0,), (PHI[0],))
    await unit.check_latency((PHI[-1],), (-(1 << W - 2),))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    phi, sin, cos = CASES[case]
    if sin is not None:
        (got,) = model([(phi,)])
        # 1 stands for cos(pi/2^W), which is 1 - (pi/2^W)^2/2.
        near = BOUND + math.ldexp(math.pi**2, F - 2 * W - 1)
        assert max(abs(got[0] - math.ldexp(sin, F)), abs(got[1] - math.ldexp(cos, F))) <= near, f"model: {got}"
    await check(dut, [(5,), (phi,), (PHI[0] // 3,), (phi,), (5,)])


@cocotb.test(skip=not EXHAUSTIVE)
async def all_angles(dut):
    """In the order of a step that is coprime to their number, so that neighbours in time are far apart."""
    await check(dut, ((phi,) for phi in ((k * 24571 + 7) % 2**W + PHI[0] for k in range(2**W))))


@cocotb.test(skip=EXHAUSTIVE)
async def every_table_point(dut):
    """On it, and at the two ends of what belongs to it, for both signs."""
    ends = (-STEP // 2, -STEP // 2 + 1, -1, 0, 1, STEP // 2 - 1)
    near = [(k * STEP + e,) for k in range(-POINTS, POINTS + 1) for e in ends if k * STEP + e in PHI]
    random.shuffle(near)
    await check(dut, near)


@cocotb.test(skip=EXHAUSTIVE)
async def random_angles(dut):
    near = [(phi + e,) for phi in corners(PHI) for e in range(-20, 21) if phi + e in PHI]
    random.shuffle(near)
    await check(dut, near + some(3000, PHI))

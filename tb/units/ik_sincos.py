# SPDX-License-Identifier: Apache-2.0
"""``ik_sincos`` against ``math.sin`` and ``math.cos`` within a derived bound, and against the model in every bit."""

import math
import random

import cocotb
import numpy as np

from model.bounds.cordic import sincos_bound
from model.dataflow import fixed
from model.dataflow.nodes import Latency
from tb.units.unit import Unit, corners, named, parameters, signed, some

W = parameters()["W"]
PHI = signed(W)
ONE = 1 << W - 2
EXHAUSTIVE = W <= 16


def model(vectors):
    sin, cos = fixed.cordic(np.array([phi for (phi,) in vectors], dtype=np.int64), W)
    return list(zip(sin.tolist(), cos.tolist(), strict=True))


async def check(dut, vectors) -> None:
    """Equal to the model, and as near to the true values as :func:`model.bounds.cordic.sincos_bound` says."""
    unit = Unit(dut, "phi", "sin_h cos_h", model, latency=Latency(W)["sincos"], signed="phi sin_h cos_h")
    worst, at = 0.0, 0
    vectors = list(vectors)
    for (phi,), (sin, cos) in zip(vectors, await unit.check(vectors), strict=True):
        half = math.pi * phi / 2**W
        error = max(abs(sin - math.sin(half) * ONE), abs(cos - math.cos(half) * ONE))
        if error > worst:
            worst, at = error, phi
    bound = sincos_bound(W)
    said = f"W={W}: largest error of {len(vectors)} angles {worst:.3f} last places (phi={at}), bound {bound:.3f}"
    dut._log.info(said)
    assert worst <= bound, said


# phi -> sin, cos of phi/2 in units of 1
QUARTER = math.sqrt(0.5)
CASES = {
    "zero": (0, 0.0, 1.0),
    "smallest": (1, 0.0, 1.0),
    "smallest_negative": (-1, 0.0, 1.0),
    "half_turn_backwards": (PHI[0], -1.0, 0.0),
    "nearly_half_turn": (PHI[-1], 1.0, 0.0),
    "quarter_turn": (1 << W - 2, QUARTER, QUARTER),
    "quarter_turn_backwards": (-(1 << W - 2), -QUARTER, QUARTER),
    "third_of_a_turn_backwards": (-round(2**W / 3), -math.sqrt(0.75), 0.5),
}


@cocotb.test()
async def latency(dut):
    unit = Unit(dut, "phi", "sin_h cos_h", model, latency=Latency(W)["sincos"], signed="phi sin_h cos_h")
    await unit.check_latency((0,), (PHI[0],))
    await unit.check_latency((PHI[-1],), (-(1 << W - 2),))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    phi, sin, cos = CASES[case]
    (got,) = model([(phi,)])
    # phi is off by less than one place itself, an arc of pi/4 last places
    near = sincos_bound(W) + math.pi / 4
    assert max(abs(got[0] - sin * ONE), abs(got[1] - cos * ONE)) <= near, f"model: {got} for phi={phi}"
    await check(dut, [(5,), (phi,), (PHI[0] // 3,), (phi,), (5,)])


@cocotb.test(skip=not EXHAUSTIVE)
async def all_angles(dut):
    """In the order of a step that is coprime to their number, so that neighbours in time are far apart."""
    await check(dut, ((phi,) for phi in ((k * 24571 + 7) % 2**W + PHI[0] for k in range(2**W))))


@cocotb.test(skip=EXHAUSTIVE)
async def random_angles(dut):
    near = [(phi + e,) for phi in corners(PHI) for e in range(-20, 21) if phi + e in PHI]
    random.shuffle(near)
    await check(dut, near + some(3000, PHI))

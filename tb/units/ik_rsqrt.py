# SPDX-License-Identifier: Apache-2.0
"""``ik_rsqrt`` against its model, bit by bit, and against the exact root in integers: faithful."""

import random

import cocotb
import numpy as np

from model.dataflow.cores import rsqrt, rsqrt_clocks
from tb.units.unit import Unit, named, parameters, unsigned

F = parameters()["F"]
MW = F + 3
ONE = 1 << MW
MANTISSAS = range(ONE // 4, ONE)
SEGMENT = ONE >> 8


def reference(vectors):
    """The model's words; those of mantissas are less than a place from 2^(F-1) / sqrt(V), V from m to m + 1."""
    words = rsqrt(np.array([m for (m,) in vectors]), F).tolist()
    square = 1 << 2 * F + MW - 2
    for (m,), y in zip(vectors, words, strict=True):
        if m in MANTISSAS:
            assert (y - 1) ** 2 * (m + 1) <= square < (y + 1) ** 2 * m, f"the model is not faithful: {m} -> {y}"
    return [(y,) for y in words]


def bench(dut) -> Unit:
    return Unit(dut, "m_next", "y", reference, latency=1 + rsqrt_clocks(F))  # of the mantissa's register, and after it


CASES = {
    "quarter": (ONE // 4, 1 << F),
    "largest": (ONE - 1, 1 << F - 1),
    "zero": (0, 0),
    "below_a_quarter": (ONE // 4 - 1, 0),
}


@cocotb.test()
async def latency(dut):
    unit = bench(dut)
    await unit.check_latency((ONE // 4,), (ONE - 1,))
    await unit.check_latency((ONE // 2,), (0,))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    """Both ends of the range, and what is no mantissa; good ones right before and right after it."""
    m, y = CASES[case]
    await bench(dut).check_corner((m,), (y,), good=(ONE // 3,))


@cocotb.test()
async def segments(dut):
    """Both ends of each segment, its middle, where u changes its sign, and their neighbours; in any order."""
    places = (0, 1, SEGMENT // 2 - 1, SEGMENT // 2, SEGMENT // 2 + 1, SEGMENT - 2, SEGMENT - 1)
    vectors = [(start + place,) for start in range(0, ONE, SEGMENT) for place in places]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test()
async def random_mantissas(dut):
    await bench(dut).check([(random.randrange(ONE // 4, ONE),) for _ in range(4000)])


@cocotb.test()
async def any_words(dut):
    """Words below 1/4 among mantissas."""
    words = unsigned(MW)
    await bench(dut).check([(random.choice(words) >> random.choice((0, 0, 1, 2, 3, MW // 2)),) for _ in range(1000)])

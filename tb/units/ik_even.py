# SPDX-License-Identifier: Apache-2.0
"""``ik_even`` against its definition: the most pairs of places by which a word can go left and still fits."""

import random
from fractions import Fraction

import cocotb
import numpy as np

from model.dataflow.cores import EVEN_CLOCKS, even
from tb.units.unit import Unit, named, parameters, some, unsigned

P = parameters()
VW, MW = P["VW"], P["MW"]
V = unsigned(VW)
EXHAUSTIVE = VW <= 16


def normalized(v: int) -> tuple[int, int]:
    k = max(k for k in range(VW // 2) if v << 2 * k in V)
    return k, Fraction(v << 2 * k + MW, 1 << VW).__floor__()


def reference(vectors):
    results = [normalized(v) for (v,) in vectors]
    k, m = even(np.array([v for (v,) in vectors], dtype=object), VW, MW)
    assert list(zip(k.tolist(), m.tolist(), strict=True)) == results, "the model is not the definition"
    return results


def bench(dut) -> Unit:
    return Unit(dut, "v", "k m", reference, latency=EVEN_CLOCKS)


QUARTER = 1 << MW - 2
CASES = {
    "zero": (0, VW // 2 - 1, 0),
    "one": (1, VW // 2 - 1, QUARTER),
    "two": (2, VW // 2 - 1, 2 * QUARTER),
    "three": (3, VW // 2 - 1, 3 * QUARTER),
    "four": (4, VW // 2 - 2, QUARTER),
    "largest": (V[-1], 0, min(V[-1] << MW >> VW, (1 << MW) - 1)),
    "quarter": (1 << VW - 2, 0, QUARTER),
    "half": (1 << VW - 1, 0, 2 * QUARTER),
    "below_quarter": ((1 << VW - 2) - 1, 1, ((1 << VW) - 4) << MW >> VW),
}


@cocotb.test()
async def latency(dut):
    await bench(dut).check_latency((V[-1],), (1,))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    v, k, m = CASES[case]
    await bench(dut).check_corner((v,), (k, m), good=(V[-1] // 9,))


@cocotb.test()
async def powers_of_two(dut):
    """Each power of two and its neighbours: every count."""
    near = sorted({(1 << n) + e for n in range(VW) for e in (-1, 0, 1)})
    random.shuffle(near)
    await bench(dut).check((v,) for v in near)


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = [(v,) for v in V]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    """Of every length, so that every shift is met with all its bits."""
    vectors = [(random.getrandbits(random.randint(1, VW)),) for _ in range(3000)]
    await bench(dut).check(vectors + some(500, V))

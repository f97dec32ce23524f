# SPDX-License-Identifier: Apache-2.0
"""``ik_half`` against fractions: (1 +- c) / 2, held in [0, 1]."""

import random
from fractions import Fraction

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, corners, each, named, parameters, signed, some

P = parameters()
W, MINUS = P["W"], P["MINUS"]
WORDS = signed(W)
ONE = 1 << W - 2  # of c
TOP = 1 << W - 1  # 1 as q
EXHAUSTIVE = W <= 10


def reference(c: int) -> tuple[int]:
    cosine = Fraction(c, ONE)
    half = ((1 - cosine) if MINUS else (1 + cosine)) / 2
    q = min(max(half, Fraction(0)), Fraction(1)) * TOP
    assert q.denominator == 1, f"(1 +- {c}) / 2 is not exact"
    return (int(q),)


def bench(dut) -> Unit:
    return Unit(dut, "c", "q", each(reference), latency=Latency(32)["mux"], signed="c")


SIGN = -1 if MINUS else 1
CASES = {
    "right_angle": (0, TOP // 2),
    "one": (ONE * SIGN, TOP),
    "minus_one": (-ONE * SIGN, 0),
    "just_below_one": ((ONE - 1) * SIGN, TOP - 1),
    "just_above_minus_one": ((1 - ONE) * SIGN, 1),
    "above_one": ((ONE + 1) * SIGN, TOP),
    "below_minus_one": ((-ONE - 1) * SIGN, 0),
    "largest": (WORDS[-1], 0 if MINUS else TOP),
    "least": (WORDS[0], TOP if MINUS else 0),
}


@cocotb.test()
async def latency(dut):
    await bench(dut).check_latency((0,), (ONE,))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    c, q = CASES[case]
    await bench(dut).check_corner((c,), (q,), good=(ONE // 2 + 1,))


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = [(c,) for c in WORDS]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    near = [(s * ONE + e,) for s in (-1, 1) for e in range(-20, 21)]
    await bench(dut).check(near + [(c,) for c in corners(WORDS)] + some(2000, WORDS))

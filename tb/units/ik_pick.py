# SPDX-License-Identifier: Apache-2.0
"""``ik_pick``: a, or b with either sign, modulo 2^W."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, crossed, each, parameters, signed, some

W = parameters()["W"]
WORDS = signed(W)
BIT = range(2)
EXHAUSTIVE = W <= 5


def reference(a: int, b: int, use_b: int, minus: int) -> tuple[int]:
    if not use_b:
        return (a,)
    # the least word has no opposite and stays
    return (b if not minus or b == WORDS[0] else -b,)


def bench(dut) -> Unit:
    return Unit(dut, "a b use_b minus", "q", each(reference), latency=Latency(32)["mux"], signed="a b q")


@cocotb.test()
async def latency(dut):
    await bench(dut).check_latency((1, 2, 0, 0), (1, 2, 1, 1))


@cocotb.test()
async def extremes(dut):
    """Least and largest words, 0 and their neighbours, each with each and every choice."""
    await bench(dut).check(crossed(WORDS, WORDS, BIT, BIT))


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = list(itertools.product(WORDS, WORDS, BIT, BIT))
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    await bench(dut).check(some(2000, WORDS, WORDS, BIT, BIT))

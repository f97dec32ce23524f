# SPDX-License-Identifier: Apache-2.0
"""``ik_delay`` and ``ik_ring``: every word comes out N clocks later, of ``ik_delay`` N = 0 included."""

import random

import cocotb

from tb.units.unit import Unit, corners, each, parameters, some, unsigned

P = parameters()
WORDS = unsigned(P["W"])


def bench(dut) -> Unit:
    return Unit(dut, "d", "q", each(lambda d: (d,)), latency=P["N"])


@cocotb.test()
async def latency(dut):
    """One word among others comes out once, after N clocks."""
    unit = bench(dut)
    await unit.check_latency((0,), (WORDS[-1],))
    await unit.check_latency((WORDS[-1],), (0,))


@cocotb.test()
async def every_bit(dut):
    """All words where they are few, otherwise each bit alone, corners and random words: no bit is lost or swapped."""
    if P["W"] <= 10:
        words = [(d,) for d in WORDS]
    else:
        words = [(1 << k,) for k in range(P["W"])] + [(d,) for d in corners(WORDS)] + some(500, WORDS)
    random.shuffle(words)
    await bench(dut).check(words)

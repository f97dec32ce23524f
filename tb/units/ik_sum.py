# SPDX-License-Identifier: Apache-2.0
"""``ik_sum2`` and ``ik_sum3`` against APyTypes: exact sum, rounded half up, saturated where SAT is 1."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, crossed, fixed_point, named, parameters, rounded, signed, some

P = parameters()
PORTS = "a b c" if "SUB_C" in P else "a b"
IW, SH, OW, SUB = P["IW"], P["SH"], P["OW"], P.get("SUB_B", P.get("SUB_C"))
SAT = P.get("SAT", 1)
IN, Q = signed(IW), signed(OW)
OPERANDS = len(PORTS.split())
EXHAUSTIVE = OPERANDS * IW <= 12
LATENCY = Latency(32)[f"sum{OPERANDS}"]


def reference(vectors):
    *first, last = (fixed_point(words, IW, SH) for words in zip(*vectors, strict=True))
    total = first[0] if OPERANDS == 2 else first[0] + first[1]
    return list(zip(*rounded(total - last if SUB else total + last, OW), strict=True))


def fitting(vectors):
    """All vectors, or with SAT = 0 those whose sum is in q's range: what the datapath's formats promise."""
    vectors = list(vectors)
    return [v for v, (_, ovf) in zip(vectors, reference(vectors), strict=True) if SAT or not ovf]


def bench(dut) -> Unit:
    return Unit(dut, PORTS, "q ovf", reference, latency=LATENCY, signed=f"{PORTS} q")


def terms(total: int) -> tuple[int, ...] | None:
    """Operands with this sum, the last one subtracted where the module does; None where there are none."""
    rest, operands = total, []
    for k in range(OPERANDS - 1, -1, -1):
        # as much as this operand may be, and no more than is needed
        part = min(max(rest // (k + 1), IN[0]), IN[-1])
        operands.append(part)
        rest -= part
    if SUB:
        operands[-1] = -operands[-1]
    return tuple(operands) if rest == 0 and operands[-1] in IN else None


# sum before the rounding, q and ovf
HALF = 1 << SH - 1 if SH else 0
TOP, LOW = (Q[-1] << SH) + HALF, (Q[0] << SH) - HALF  # the first sum that overflows; the last that does not
SUMS = {
    "zero": (0, 0, 0),
    "tie": (HALF, int(SH > 0), 0),
    "negative_tie": (-HALF, 0, 0),
    "below_tie": (HALF - 1, 0, 0),
    "below_negative_tie": (-HALF - 1, -1, 0),
    "odd_tie": (3 * HALF, 2, 0),
    "odd_negative_tie": (-3 * HALF, -1, 0),
    "largest": (TOP - 1, Q[-1], 0),
    "rounds_to_overflow": (TOP, Q[-1], 1),
    "least": (LOW, Q[0], 0),
    "below_least": (LOW - 1, Q[0], 1),
    "overflow": (OPERANDS * IN[-1] - 2, Q[-1], 1),
    "negative_overflow": (OPERANDS * IN[0] + 2, Q[0], 1),
}
if SH == 0:
    TOP, LOW = Q[-1] + 1, Q[0]
    for name in ("below_tie", "tie", "negative_tie", "below_negative_tie", "odd_tie", "odd_negative_tie"):
        del SUMS[name]
    SUMS["largest"], SUMS["rounds_to_overflow"] = (Q[-1], Q[-1], 0), (Q[-1] + 1, Q[-1], 1)
CASES = {
    name: (terms(total), (q, ovf))
    for name, (total, q, ovf) in SUMS.items()
    # what these widths can have
    if terms(total) is not None and q in Q and ovf == (not LOW <= total < TOP) and ovf <= SAT
}


def single(value: int) -> tuple[int, ...]:
    return (value,) + (0,) * (OPERANDS - 1)


@cocotb.test()
async def latency(dut):
    """q and ovf leave together; ovf can change only where q does not hold every sum."""
    unit = bench(dut)
    if "overflow" in CASES:
        await unit.check_latency(single(0), CASES["overflow"][0])
    del unit.outputs["ovf"]
    unit.expected = lambda vectors: [row[:1] for row in reference(vectors)]
    await unit.check_latency(single(0), single(min(IN[-1], Q[-1] << SH)))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    """Ties and the ends of q's range, with a good sum right before and after."""
    await bench(dut).check_corner(*CASES[case], good=single(1 << SH))


@cocotb.test()
async def extremes(dut):
    """Least and largest words, 0 and their neighbours, each with each."""
    await bench(dut).check(fitting(crossed(*[IN] * OPERANDS)))


@cocotb.test(skip=not EXHAUSTIVE)
async def all_operands(dut):
    vectors = fitting(itertools.product(*[IN] * OPERANDS))
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_operands(dut):
    await bench(dut).check(fitting(some(3000, *[IN] * OPERANDS)))

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_div.py``."""

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.nodes import GUARD, Latency
from tb.units.unit import run_unit, title, with_sets


def div(nw, dw, sh, qw, lat, digit=0):
    return {"NW": nw, "DW": dw, "SH": sh, "QW": qw, "LAT": lat, "DIGIT": digit}


def instances(width, digit):
    """The dividers of the paper datapath, each kind once."""
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), width, "paper").bits.nodes.values()
    kinds = []
    for node in nodes:
        if node.op == "div":
            n, d = (operand.format for operand in node.operands)
            q = node.format
            kind = div(n.width, d.width, q.frac - n.frac + d.frac, q.width, Latency(width)["div"], digit)
            kinds += [kind] if kind not in kinds else []
    assert len(kinds) == 4, kinds
    return kinds


@with_sets(
    div(6, 5, 2, 5, 7),
    div(32 + GUARD, 32, 22, 32, Latency(32)["div"]),  # p_e of (13)
    div(6, 5, 2, 5, 4, digit=1),
    div(32 + GUARD, 32, 22, 32, Latency(32)["div"], digit=1),
    more=[
        div(6, 5, 0, 5, 1),
        div(4, 7, 1, 9, 0),  # the quotient is the widest
        div(4, 8, 1, 5, 3),  # the divisor is
        *(div(6, 5, 2, 5, lat) for lat in (4, 6, 9)),
        div(32, 32, 30, 32, Latency(32)["div"]),  # c4 of (14)
        div(18 + GUARD, 18, 8, 18, Latency(18)["div"]),
        div(6, 5, 2, 5, 7) | {"DD": 3},
        div(6, 5, 2, 5, 6, digit=1) | {"DD": 2},
        # digit recurrence; natural is a latency of one clock a quotient bit, and magnitude and sign
        div(6, 5, 2, 5, 5, digit=1),  # two bits a stage, a register behind
        div(6, 5, 2, 5, 6, digit=1),  # natural
        div(6, 5, 2, 5, 9, digit=1),
        div(6, 5, 0, 5, 6, digit=1),  # all bits of the dividend are stored
        div(6, 5, 0, 5, 4, digit=1),
        div(4, 7, 1, 9, 6, digit=1),  # fewer rows than quotient bits
        div(4, 7, 1, 9, 4, digit=1),
        div(4, 8, 1, 5, 6, digit=1),
        div(6, 6, 5, 4, 5, digit=1),  # no bit is
        div(6, 6, 5, 4, 4, digit=1),  # an odd number of rows, two bits a stage
        div(5, 5, 2, 4, 5, digit=1),
        div(8, 2, 0, 3, 4, digit=1),  # dividends far too large
        div(8, 3, 4, 4, 4, digit=1),
        div(2, 8, 6, 8, 9, digit=1),
        div(2, 2, 0, 2, 3, digit=1),  # one row
        div(8, 4, 0, 12, 9, digit=1),  # any quotient fits
        div(2, 8, 3, 8, 4, digit=1),  # all words are as wide as the quotient so far
        *(kind for width in (32, 18) for kind in instances(width, digit=1) if kind["SH"] != 22),
        div(32 + GUARD, 32, 22, 32, 18, digit=1),  # two bits a stage
        div(32, 32, 30, 32, 32, digit=1),
        div(18, 18, 16, 18, 30, digit=1),
    ],
)
def test_ik_div(sets):
    run_unit("ik_div", sets)


@pytest.mark.parametrize(
    "parameters",
    [div(6, 5, 2, 5, 3, 1), div(32, 32, 30, 32, 17, 1), div(6, 6, 5, 4, 3, 1), div(2, 2, 0, 2, 2, 1)],
    ids=title,
)
def test_too_short_a_latency_stops_the_build(parameters, caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_div", [parameters], sim="icarus")
    assert "ik_div_digit_needs_LAT_of_at_least_2_and_half_a_clock_a_quotient_bit" in caplog.text


@pytest.mark.parametrize("parameters", [div(1, 5, 4, 5, 9, 1), div(5, 1, 4, 5, 9, 1), div(5, 5, 4, 1, 9, 1)], ids=title)
def test_widths_out_of_range_stop_the_build(parameters, caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_div", [parameters], sim="icarus")
    assert "ik_div_digit_needs_NW_DW_QW_of_at_least_2_and_SH_of_at_least_0" in caplog.text

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_root.py``."""

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.nodes import Latency
from tb.units.unit import run_unit, title, with_sets


def root(nw, sh, qw, lat, digit=0):
    return {"NW": nw, "SH": sh, "QW": qw, "LAT": lat, "DIGIT": digit}


def instances(width, digit):
    """The roots of the paper datapath, each kind once."""
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), width, "paper").bits.nodes.values()
    kinds = []
    for node in nodes:
        if node.op == "root":
            (n,) = (operand.format for operand in node.operands)
            q = node.format
            kind = root(n.width + (not n.signed), 2 * q.frac - n.frac, q.width, Latency(width)["root"], digit)
            kinds += [kind] if kind not in kinds else []
    assert len(kinds) == 3, kinds
    return kinds


@with_sets(
    root(10, 5, 8, 4),
    root(32, 30, 32, Latency(32)["root"]),
    root(10, 5, 8, 5, digit=1),
    root(33, 29, 32, Latency(32)["root"], digit=1),
    more=[
        root(10, 2, 7, 1),
        root(10, 0, 6, 0),
        root(10, 5, 5, 4),  # not all roots fit
        root(33, 29, 32, Latency(32)["root"]),  # of a half angle, unsigned with W-1 fraction bits
        root(18, 17, 18, Latency(18)["root"]),
        # digit recurrence; natural is a latency of one clock a result bit, and the output
        root(10, 5, 8, 6, digit=1),  # two bits a stage, a register behind
        root(10, 5, 8, 8, digit=1),  # natural
        root(10, 5, 8, 11, digit=1),
        root(10, 2, 7, 7, digit=1),
        root(10, 2, 7, 4, digit=1),
        root(10, 0, 6, 6, digit=1),  # all bits of the radicand are stored
        root(10, 1, 6, 4, digit=1),
        root(10, 3, 12, 7, digit=1),  # fewer rows than result bits
        root(10, 5, 5, 5, digit=1),  # not all roots fit
        root(10, 5, 5, 4, digit=1),
        root(10, 8, 4, 4, digit=1),  # no bit is: all roots but that of 0 are too large
        root(10, 0, 2, 2, digit=1),  # one row
        root(2, 0, 2, 2, digit=1),
        root(2, 1, 4, 3, digit=1),
        *(kind for width in (32, 18) for kind in instances(width, digit=1) if kind["SH"] != 29),
        root(33, 29, 32, 17, digit=1),  # two bits a stage
        root(32, 30, 32, 31, digit=1),
        root(18, 17, 18, 30, digit=1),
    ],
)
def test_ik_root(sets):
    run_unit("ik_root", sets)


@pytest.mark.parametrize("parameters", [root(10, 5, 8, 4, 1), root(32, 30, 32, 16, 1), root(10, 0, 2, 1, 1)], ids=title)
def test_too_short_a_latency_stops_the_build(parameters, caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_root", [parameters], sim="icarus")
    assert "ik_root_digit_needs_LAT_of_at_least_1_and_half_a_clock_a_result_bit" in caplog.text


@pytest.mark.parametrize("parameters", [root(1, 5, 8, 9, 1), root(10, 5, 1, 9, 1)], ids=title)
def test_widths_out_of_range_stop_the_build(parameters, caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_root", [parameters], sim="icarus")
    assert "ik_root_digit_needs_NW_QW_of_at_least_2_and_SH_of_at_least_0" in caplog.text

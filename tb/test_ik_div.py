# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/ik_div.py``."""

import pytest

from model.dataflow import GUARD, Latency
from tb.unit import run_unit, sets, title


def div(nw, dw, sh, qw, lat):
    return {"NW": nw, "DW": dw, "SH": sh, "QW": qw, "LAT": lat}


SETS = sets(
    div(6, 5, 2, 5, 7),
    div(32 + GUARD, 32, 22, 32, Latency(32)["div"]),  # p_e of (13)
    icarus=[
        div(6, 5, 0, 5, 1),
        div(4, 7, 1, 9, 0),  # the quotient is the widest
        div(4, 8, 1, 5, 3),  # the divisor is
        div(32, 32, 30, 32, Latency(32)["div"]),  # c4 of (14)
        div(18 + GUARD, 18, 8, 18, Latency(18)["div"]),
    ],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_div(parameters):
    run_unit("ik_div", parameters)

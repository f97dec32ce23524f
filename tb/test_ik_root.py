# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/ik_root.py``."""

import pytest

from model.dataflow import Latency
from tb.unit import run_unit, sets, title


def root(nw, sh, qw, lat):
    return {"NW": nw, "SH": sh, "QW": qw, "LAT": lat}


SETS = sets(
    root(10, 5, 8, 4),
    root(32, 30, 32, Latency(32)["root"]),
    icarus=[
        root(10, 2, 7, 1),
        root(10, 0, 6, 0),
        root(33, 29, 32, Latency(32)["root"]),  # of a half angle, unsigned with W-1 fraction bits
        root(18, 17, 18, Latency(18)["root"]),
    ],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_root(parameters):
    run_unit("ik_root", parameters)

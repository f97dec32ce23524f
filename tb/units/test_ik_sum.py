# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_sum.py`` on ``ik_sum2`` and ``ik_sum3``."""

import pytest

from model.dataflow.nodes import GUARD
from tb.units.unit import run_unit, with_sets


def words(iw, sh, ow, sub):
    return {"IW": iw, "SH": sh, "OW": ow, "SUB": sub}


@pytest.mark.parametrize(("module", "last"), [("ik_sum2", "B"), ("ik_sum3", "C")])
@with_sets(
    words(4, 1, 3, 1),
    words(32 + GUARD, GUARD, 32, 0),
    more=[
        words(4, 1, 3, 0),
        words(4, 2, 2, 1),
        words(4, 0, 8, 1),  # q holds any sum
        words(32 + GUARD, 0, 32 + GUARD, 1),  # nothing to round
        words(18 + GUARD, GUARD + 1, 18, 1),
        words(4, 1, 3, 0) | {"SAT": 0},
        words(32 + GUARD, GUARD, 32, 1) | {"SAT": 0},
    ],
)
def test_ik_sum(module, last, sets):
    own = [{f"SUB_{last}" if name == "SUB" else name: value for name, value in one.items()} for one in sets]
    run_unit(module, own, tests="ik_sum")


@pytest.mark.sim
def test_ik_sum2_with_delays():
    sets = [{"IW": 4, "SH": 1, "OW": 3, "SUB_B": 1} | delays for delays in ({"DA": 2, "DB": 1}, {"DB": 3})]
    run_unit("ik_sum2", sets, tests="ik_sum")

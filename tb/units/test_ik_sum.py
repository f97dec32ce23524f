# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_sum.py`` on ``ik_sum2`` and ``ik_sum3``."""

import pytest

from model.dataflow.nodes import GUARD
from tb.units.unit import run_unit, sets, title


def words(iw, sh, ow, sub):
    return {"IW": iw, "SH": sh, "OW": ow, "SUB": sub}


PARAMETERS = sets(
    words(4, 1, 3, 1),
    words(32 + GUARD, GUARD, 32, 0),
    icarus=[
        words(4, 1, 3, 0),
        words(4, 2, 2, 1),
        words(4, 0, 8, 1),  # q holds any sum
        words(32 + GUARD, 0, 32 + GUARD, 1),  # nothing to round
        words(18 + GUARD, GUARD + 1, 18, 1),
        words(4, 1, 3, 0) | {"SAT": 0},
        words(32 + GUARD, GUARD, 32, 1) | {"SAT": 0},
    ],
)


@pytest.mark.parametrize(("module", "last"), [("ik_sum2", "B"), ("ik_sum3", "C")])
@pytest.mark.parametrize("parameters", PARAMETERS, ids=title)
def test_ik_sum(module, last, parameters):
    own = {f"SUB_{last}" if name == "SUB" else name: value for name, value in parameters.items()}
    run_unit(module, own, tests="ik_sum")


@pytest.mark.parametrize("delays", [{"DA": 2, "DB": 1}, {"DB": 3}], ids=title)
def test_ik_sum2_with_delays(delays):
    run_unit("ik_sum2", {"IW": 4, "SH": 1, "OW": 3, "SUB_B": 1} | delays, tests="ik_sum")

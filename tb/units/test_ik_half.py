# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_half.py``."""

import pytest

from tb.units.unit import run_unit, sets, title

SETS = sets(
    {"W": 8, "MINUS": 0},
    {"W": 32, "MINUS": 1},
    icarus=[{"W": 8, "MINUS": 1}, {"W": 32, "MINUS": 0}],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_half(parameters):
    run_unit("ik_half", parameters)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_shift.py``."""

import pytest

from tb.units.unit import run_unit, sets, title

SETS = sets(
    {"W": 8, "RIGHT": 0},
    {"W": 8, "RIGHT": 1},
    {"W": 33, "RIGHT": 0, "PRODUCT": 1},
    icarus=[
        {"W": 33, "RIGHT": 0},
        {"W": 32, "RIGHT": 1},
        {"W": 19, "RIGHT": 0},
        {"W": 18, "RIGHT": 1},
        {"W": 8, "RIGHT": 0, "PRODUCT": 1},
        {"W": 19, "RIGHT": 0, "PRODUCT": 1},
        {"W": 8, "RIGHT": 1, "DD": 3, "DC": 1},
        {"W": 19, "RIGHT": 0, "PRODUCT": 1, "DC": 2},
    ],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_shift(parameters):
    run_unit("ik_shift", parameters)

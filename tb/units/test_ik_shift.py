# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_shift.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets(
    {"W": 19, "RIGHT": 0},
    {"W": 32, "RIGHT": 1},
    {"W": 33, "RIGHT": 0, "PRODUCT": 1},
    more=[
        {"W": 8, "RIGHT": 0},
        {"W": 8, "RIGHT": 1},
        {"W": 33, "RIGHT": 0},
        {"W": 18, "RIGHT": 1},
        {"W": 8, "RIGHT": 0, "PRODUCT": 1},
        {"W": 19, "RIGHT": 0, "PRODUCT": 1},
        {"W": 8, "RIGHT": 1, "DD": 3, "DC": 1},
        {"W": 19, "RIGHT": 0, "PRODUCT": 1, "DC": 2},
    ],
)
def test_ik_shift(sets):
    run_unit("ik_shift", sets)

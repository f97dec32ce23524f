# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_half.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets(
    {"W": 8, "MINUS": 0},
    {"W": 32, "MINUS": 1},
    more=[{"W": 8, "MINUS": 1}, {"W": 32, "MINUS": 0}],
)
def test_ik_half(sets):
    run_unit("ik_half", sets)

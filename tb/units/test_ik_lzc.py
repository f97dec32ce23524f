# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_lzc.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets(
    {"W": 5, "N": 2},
    {"W": 32, "N": 3},
    more=[{"W": 4, "N": 3}, {"W": 10, "N": 1}, {"W": 33, "N": 1}, {"W": 64, "N": 2}],
)
def test_ik_lzc(sets):
    run_unit("ik_lzc", sets)

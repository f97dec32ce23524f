# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_wide.py``."""

from tb.units.unit import run_unit, with_sets


def wide(w, sub):
    return {"W": w, "SUB": sub}


@with_sets(
    wide(6, 1),
    wide(66, 0),
    wide(66, 1),
    wide(6, 1) | {"DA": 1, "DB": 3},
    more=[wide(4, 0), wide(4, 1), wide(6, 0), wide(34, 0), wide(34, 1), wide(38, 0), wide(38, 1)],
)
def test_ik_wide(sets):
    run_unit("ik_wide", sets)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_pick.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets({"W": 32}, more=[{"W": 4}])
def test_ik_pick(sets):
    run_unit("ik_pick", sets)

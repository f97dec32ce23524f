# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_norm.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets({"W": 5, "N": 2}, {"W": 32, "N": 3}, more=[{"W": 4, "N": 3}, {"W": 18, "N": 3}, {"W": 32, "N": 2}])
def test_ik_norm(sets):
    run_unit("ik_norm", sets)

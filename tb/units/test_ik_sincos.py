# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_sincos.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets({"W": 32}, more=[{"W": 16}, {"W": 27}])
def test_ik_sincos(sets):
    run_unit("ik_sincos", sets)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_rsqrt.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets({"F": 31}, more=[{"F": 19}, {"F": 20}, {"F": 21}, {"F": 22}, {"F": 24}, {"F": 27}])
def test_ik_rsqrt(sets):
    run_unit("ik_rsqrt", sets)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_fifo.py``."""

from tb.units.unit import run_unit, with_sets


@with_sets({"W": 16, "LOG2": 2}, more=[{"W": 8, "LOG2": 1}, {"W": 208, "LOG2": 9}])
def test_ik_fifo(sets):
    run_unit("ik_fifo", sets)

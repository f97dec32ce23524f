# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_trig.py``."""

from tb.units.unit import run_unit, with_sets


def trig(w):
    """F goes with W as in the datapath.  Up to F = 21 the core has fewer tiles."""
    return {"W": w, "F": min(w + 3, 31)}


@with_sets(trig(18), trig(32), more=[trig(16), trig(19), trig(24), trig(27)])
def test_ik_trig(sets):
    run_unit("ik_trig", sets)

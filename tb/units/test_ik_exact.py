# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_exact.py``."""

from tb.units.unit import run_unit, with_sets


def exact(w, square):
    return {"W": w, "SQUARE": square}


@with_sets(
    exact(5, 0),
    exact(33, 0),
    exact(33, 1),
    more=[
        exact(5, 1),
        exact(6, 0),
        exact(6, 1),
        exact(17, 0),
        exact(17, 1),
        exact(19, 0),
        exact(19, 1),
        exact(28, 0),
        exact(28, 1),
        exact(35, 0),  # tiles of 18x18 bits
        exact(35, 1),
    ],
)
def test_ik_exact(sets):
    run_unit("ik_exact", sets)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_shift3.py``."""

from model.dataflow.nodes import inner_frac
from tb.units.unit import run_unit, with_sets


def shift3(iw, drop, ow):
    return {"IW": iw, "DROP": drop, "OW": ow}


def triangle(width):
    """As ``ik_lean_triangle`` has it."""
    frac = inner_frac(width)
    return shift3(2 * width + 2, 2 * width + width % 2 - frac, frac + 2)


@with_sets(
    shift3(7, 3, 4),
    triangle(32),
    triangle(17),  # one place longer than the word
    more=[
        shift3(7, 2, 3),  # bits of the word above the result
        shift3(5, 3, 6),
        shift3(66, 20, 33),
        shift3(34, 24, 21),
        shift3(7, 3, 4) | {"DD": 2},
        *map(triangle, (31, 27, 18, 16)),
    ],
)
def test_ik_shift3(sets):
    run_unit("ik_shift3", sets)


def test_triangle():
    """The sets are the words that they are meant to be."""
    assert (triangle(32), triangle(18)) == (shift3(66, 31, 35), shift3(38, 13, 25))

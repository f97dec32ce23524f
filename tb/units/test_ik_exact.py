# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_exact.py``."""

import pytest

from tb.units.unit import run_unit, sets, title


def exact(w, square):
    return {"W": w, "SQUARE": square}


SETS = sets(
    exact(5, 0),
    exact(33, 0),
    exact(33, 1),
    icarus=[
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


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_exact(parameters):
    run_unit("ik_exact", parameters)

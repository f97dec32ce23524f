# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_wide.py``."""

import pytest

from tb.units.unit import run_unit, sets, title


def wide(w, sub):
    return {"W": w, "SUB": sub}


SETS = sets(
    wide(6, 1),
    wide(66, 0),
    wide(66, 1),
    icarus=[
        *(wide(w, sub) for w, sub in ((4, 0), (4, 1), (6, 0), (34, 0), (34, 1), (38, 0), (38, 1))),
        wide(6, 1) | {"DA": 1, "DB": 3},
    ],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_wide(parameters):
    run_unit("ik_wide", parameters)

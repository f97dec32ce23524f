# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_lzc.py``."""

import pytest

from tb.units.unit import run_unit, sets, title

SETS = sets(
    {"W": 5, "N": 2},
    {"W": 32, "N": 3},
    icarus=[{"W": 4, "N": 3}, {"W": 10, "N": 1}, {"W": 33, "N": 1}, {"W": 64, "N": 2}],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_lzc(parameters):
    run_unit("ik_lzc", parameters)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_norm.py``."""

import pytest

from tb.units.unit import run_unit, sets, title

SETS = sets({"W": 5, "N": 2}, {"W": 32, "N": 3}, icarus=[{"W": 4, "N": 3}, {"W": 18, "N": 3}, {"W": 32, "N": 2}])


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_norm(parameters):
    run_unit("ik_norm", parameters)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_rsqrt.py``."""

import pytest

from tb.units.unit import run_unit, sets, title

SETS = sets({"F": 19}, {"F": 31}, icarus=[{"F": 20}, {"F": 21}, {"F": 22}, {"F": 24}, {"F": 27}])


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_rsqrt(parameters):
    run_unit("ik_rsqrt", parameters)

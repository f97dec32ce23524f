# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_pick.py``."""

import pytest

from tb.units.unit import run_unit, sets, title


@pytest.mark.parametrize("parameters", sets({"W": 32}, icarus=[{"W": 4}]), ids=title)
def test_ik_pick(parameters):
    run_unit("ik_pick", parameters)

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_sincos.py``."""

import pytest

from tb.units.unit import run_unit, sets, title


@pytest.mark.parametrize("parameters", sets({"W": 16}, {"W": 32}, icarus=[{"W": 27}]), ids=title)
def test_ik_sincos(parameters):
    run_unit("ik_sincos", parameters)

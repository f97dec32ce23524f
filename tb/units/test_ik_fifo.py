# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_fifo.py``."""

import pytest

from tb.units.unit import run_unit, sets, title


@pytest.mark.parametrize(
    "parameters", sets({"W": 16, "LOG2": 2}, {"W": 208, "LOG2": 9}, icarus=[{"W": 8, "LOG2": 1}]), ids=title
)
def test_ik_fifo(parameters):
    run_unit("ik_fifo", parameters)

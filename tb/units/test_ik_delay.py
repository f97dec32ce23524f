# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_delay.py`` on ``ik_delay`` and ``ik_ring``."""

import pytest

from tb.units.unit import run_unit, sets, title

SETS = sets({"W": 8, "N": 0}, {"W": 70, "N": 5}, icarus=[{"W": 8, "N": 1}, {"W": 32, "N": 40}])


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_delay(parameters):
    run_unit("ik_delay", parameters)


RINGS = sets({"W": 40, "N": 18}, icarus=[{"W": 8, "N": 3}, {"W": 96, "N": 65}])


@pytest.mark.parametrize("parameters", RINGS, ids=title)
def test_ik_ring(parameters):
    run_unit("ik_ring", parameters, tests="ik_delay")


def test_ik_delay_of_negative_length_does_not_elaborate(caplog):
    """The message names what is wrong."""
    with pytest.raises(SystemExit):
        run_unit("ik_delay", {"W": 8, "N": -1})
    assert "ik_delay_needs_N_of_at_least_0" in caplog.text


def test_ik_ring_that_is_too_short_does_not_elaborate(caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_ring", {"W": 8, "N": 2}, tests="ik_delay")
    assert "ik_ring_needs_N_of_at_least_3" in caplog.text

# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_delay.py`` on ``ik_delay`` and ``ik_ring``."""

import pytest

from tb.units.unit import run_unit, with_sets


@with_sets({"W": 8, "N": 0}, {"W": 70, "N": 5}, more=[{"W": 8, "N": 1}, {"W": 32, "N": 40}])
def test_ik_delay(sets):
    run_unit("ik_delay", sets)


@with_sets({"W": 40, "N": 18}, more=[{"W": 8, "N": 3}, {"W": 96, "N": 65}])
def test_ik_ring(sets):
    run_unit("ik_ring", sets, tests="ik_delay")


def test_ik_delay_of_negative_length_does_not_elaborate(caplog):
    """The message names what is wrong."""
    with pytest.raises(SystemExit):
        run_unit("ik_delay", [{"W": 8, "N": -1}])
    assert "ik_delay_needs_N_of_at_least_0" in caplog.text


def test_ik_ring_that_is_too_short_does_not_elaborate(caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_ring", [{"W": 8, "N": 2}], tests="ik_delay")
    assert "ik_ring_needs_N_of_at_least_3" in caplog.text

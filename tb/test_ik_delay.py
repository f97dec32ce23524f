# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/ik_delay.py``."""

import pytest

from tb.unit import run_unit, sets, title

SETS = sets({"W": 8, "N": 0}, {"W": 70, "N": 5}, icarus=[{"W": 8, "N": 1}, {"W": 32, "N": 40}])


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_delay(parameters):
    run_unit("ik_delay", parameters)


def test_ik_delay_of_negative_length_does_not_elaborate(caplog):
    """The message names what is wrong."""
    with pytest.raises(SystemExit):
        run_unit("ik_delay", {"W": 8, "N": -1})
    assert "ik_delay_needs_N_of_at_least_0" in caplog.text

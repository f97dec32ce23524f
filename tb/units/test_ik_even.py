# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_even.py``."""

import pytest

from tb.units.unit import run_unit, title, with_sets


def even(vw, mw):
    return {"VW": vw, "MW": mw}


@with_sets(
    even(32, 34),
    even(64, 34),
    more=[
        even(16, 22),
        even(16, 5),
        even(18, 24),
        even(34, 23),
        even(36, 24),
        even(48, 30),
        even(50, 31),
        even(54, 33),
        even(62, 50),
    ],
)
def test_ik_even(sets):
    run_unit("ik_even", sets)


@pytest.mark.parametrize("parameters", [even(2, 20), even(33, 20), even(66, 34), even(64, 51)], ids=title)
def test_widths_out_of_range_stop_the_build(parameters, caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_even", [parameters], sim="icarus")
    assert "ik_even_needs_VW_even_from_4_to_64_and_MW_to_50" in caplog.text

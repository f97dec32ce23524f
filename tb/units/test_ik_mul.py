# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_mul.py``."""

import pytest

from model.dataflow.nodes import GUARD
from tb.units.unit import run_unit, with_sets


def mul(aw, bw, sh, ow):
    return {"AW": aw, "BW": bw, "SH": sh, "OW": ow}


@with_sets(
    mul(5, 5, 3, 7),
    mul(32, 32, 24, 32 + GUARD),
    mul(33, 33, 0, 66),
    mul(32, 32, 24, 32 + GUARD) | {"SQUARE": 1},
    more=[
        mul(5, 5, 0, 10),
        mul(7, 4, 2, 9),
        mul(4, 7, 1, 11),
        mul(18, 18, 10, 18 + GUARD),  # the longest words of one tile
        mul(19, 18, 10, 19 + GUARD),
        mul(6, 33, 5, 34),
        mul(35, 35, 30, 40),  # the longest words
        mul(32, 32, 30, 32),
        mul(5, 5, 3, 7) | {"SQUARE": 1},
        mul(33, 33, 0, 66) | {"SQUARE": 1},
        mul(5, 5, 3, 7) | {"DA": 3, "DB": 1},
        mul(19, 18, 10, 19) | {"DB": 2},
        mul(5, 5, 3, 7) | {"SQUARE": 1, "DA": 2},
    ],
)
def test_ik_mul(sets):
    run_unit("ik_mul", sets)


def test_ik_mul_of_long_words_does_not_elaborate(caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_mul", [mul(36, 32, 30, 32)])
    assert "ik_mul_needs_AW_BW_of_at_most_35" in caplog.text

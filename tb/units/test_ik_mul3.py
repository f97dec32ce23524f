# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_mul3.py``."""

import pytest

from tb.units.unit import run_unit, title, with_sets


def mul3(aw, bw, sh, ow):
    return {"AW": aw, "BW": bw, "SH": sh, "OW": ow}


@with_sets(
    mul3(5, 6, 5, 8),
    mul3(35, 35, 33, 36),
    more=[
        mul3(33, 33, 31, 35),
        mul3(33, 35, 31, 35),
        mul3(35, 35, 32, 35),
        mul3(25, 25, 23, 25),
        mul3(19, 23, 15, 23),
        mul3(6, 5, 4, 4),  # the low bits of the result
        mul3(4, 6, 3, 12),  # more bits than the result has
        mul3(5, 6, 7, 4),  # one bit of each mixed tile
        mul3(33, 33, 30, 33),
        mul3(33, 35, 33, 33),
        mul3(32, 33, 29, 35),
        mul3(35, 35, 34, 35),
        mul3(23, 23, 21, 23),
        mul3(21, 21, 18, 24),
        mul3(5, 6, 5, 8) | {"DA": 1, "DB": 4},
    ],
)
def test_ik_mul3(sets):
    run_unit("ik_mul3", sets)


ILLEGAL = mul3(36, 33, 31, 33), mul3(33, 36, 30, 33), mul3(1, 9, 4, 9), mul3(9, 9, 2, 9), mul3(5, 5, 8, 3)


@pytest.mark.parametrize("parameters", ILLEGAL, ids=title)
def test_tiles_that_do_not_fit_stop_the_build(parameters, caplog):
    with pytest.raises(SystemExit):
        run_unit("ik_mul3", [parameters], sim="icarus")
    assert "ik_mul3_needs_words_of_2_to_35_bits_and_a_bit_of_each_tile_on_either_side_of_the_cut" in caplog.text

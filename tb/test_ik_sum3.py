# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/ik_sum3.py``."""

import pytest

from model.dataflow import GUARD
from tb.unit import run_unit, sets, title


def sum3(iw, sh, ow, sub):
    return {"IW": iw, "SH": sh, "OW": ow, "SUB_C": sub}


SETS = sets(
    sum3(4, 1, 3, 1),
    sum3(32 + GUARD, GUARD, 32, 0),
    icarus=[
        sum3(4, 1, 3, 0),
        sum3(4, 2, 2, 1),
        sum3(4, 0, 8, 1),  # q holds any sum
        sum3(32 + GUARD, 0, 32 + GUARD, 1),  # nothing to round
        sum3(18 + GUARD, GUARD + 1, 18, 1),
    ],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_sum3(parameters):
    run_unit("ik_sum3", parameters)

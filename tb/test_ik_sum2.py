# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/ik_sum2.py``."""

import pytest

from model.dataflow import GUARD
from tb.unit import run_unit, sets, title


def sum2(iw, sh, ow, sub):
    return {"IW": iw, "SH": sh, "OW": ow, "SUB_B": sub}


SETS = sets(
    sum2(4, 1, 3, 1),
    sum2(32 + GUARD, GUARD, 32, 0),
    icarus=[
        sum2(4, 1, 3, 0),
        sum2(4, 2, 2, 1),
        sum2(4, 0, 8, 1),  # q holds any sum
        sum2(32 + GUARD, 0, 32 + GUARD, 1),  # nothing to round
        sum2(18 + GUARD, GUARD + 1, 18, 1),
    ],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_sum2(parameters):
    run_unit("ik_sum2", parameters)

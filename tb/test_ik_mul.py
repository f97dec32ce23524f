# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/ik_mul.py``."""

import pytest

from model.dataflow import GUARD
from tb.unit import run_unit, sets, title


def mul(aw, bw, sh, ow):
    return {"AW": aw, "BW": bw, "SH": sh, "OW": ow}


SETS = sets(
    mul(5, 5, 3, 7),
    mul(32, 32, 24, 32 + GUARD),
    mul(33, 33, 0, 66),
    icarus=[mul(5, 5, 0, 10), mul(7, 4, 2, 9), mul(4, 7, 1, 11), mul(18, 18, 10, 18 + GUARD), mul(32, 32, 30, 32)],
)


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_mul(parameters):
    run_unit("ik_mul", parameters)

# SPDX-License-Identifier: Apache-2.0
"""Simulation tests of examples/icebreaker at its pins."""

import pytest

from tb.icebreaker.example import run

FEW = "out_of_reset|skew=0.0|answer_at_once|noise|no_stop_bit|button"


@pytest.mark.sim
@pytest.mark.parametrize(
    ("tests", "targets"),
    [
        pytest.param(FEW, 10, marks=pytest.mark.cost(6)),
        pytest.param("", 40, marks=[pytest.mark.slow, pytest.mark.cost(40)]),
    ],
    ids=["few", "all"],
)
def test_at_the_pins(tests, targets):
    run("tb.icebreaker.bench", COCOTB_TEST_FILTER=tests, IK_TARGETS=str(targets))

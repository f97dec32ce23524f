# SPDX-License-Identifier: Apache-2.0
"""Simulation tests of examples/icebreaker at its pins."""

import pytest

from tb.icebreaker.bench import run

FEW = "out_of_reset|skew=0.0|answer_at_once|noise|no_stop_bit|button"


@pytest.mark.sim
@pytest.mark.parametrize(
    "tests",
    [
        pytest.param(FEW, marks=pytest.mark.cost(6)),
        pytest.param(f"^(?!.*({FEW}))", marks=[pytest.mark.slow, pytest.mark.cost(30)]),
    ],
    ids=["few", "more"],
)
def test_at_the_pins(tests):
    run("tb.icebreaker.bench", COCOTB_TEST_FILTER=tests)


@pytest.mark.sim
@pytest.mark.cost(15)
def test_hand_poses_at_the_pins():
    run("tb.icebreaker.bench", 1, COCOTB_TEST_FILTER="skew=0.0$|answer_at_once")

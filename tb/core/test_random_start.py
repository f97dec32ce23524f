# SPDX-License-Identifier: Apache-2.0
"""Outputs do not depend on the initial state: random registers, memories and X under Verilator, several seeds."""

from collections.abc import Iterator

import pytest

from tb.sim.env import simulator
from tb.sim.runner import simulate
from tb.sim.seeded_bugs import Bug, copy_rtl

SEEDS = range(3, 13)
"""Other simulations use 1. Of 40 seeds, three start at a step that overwrites a constant; 12 is the first of them."""

EVERY = "every_flag.*idle=False/stall=False"
STREAMS = f"power_up|one_result|ready_before|after=few|idle=bursts/stall=bursts|{EVERY}"
TOPS = [  # parameters of other tests, whose builds are reused
    pytest.param(
        "ik_axis", "tb.core.stream_tests", {"W": 32, "TAG_W": 8, "DATAPATH": 1, "TILE": 18}, STREAMS, id="lean"
    ),
    pytest.param(
        "ik_axis", "tb.core.stream_tests", {"W": 24, "TAG_W": 8, "DATAPATH": 2, "TILE": 18}, STREAMS, id="fold"
    ),
    pytest.param("ik_axi", "tb.axi.ik_axi,tb.axi.registers", {}, "power_up|one_record|after_a_reset", id="memory"),
]
BUG = Bug("no initial valid", "rtl/lib/ik_fifo.v", "  initial m_valid = 1'b0;\n", "", "power_up")

pytestmark = [
    pytest.mark.sim,
    pytest.mark.slow,
    pytest.mark.skipif(simulator() != "verilator", reason="Icarus has X, and one start"),
]


def failing(top: str, modules: str, parameters: dict[str, int], tests: str, **options) -> Iterator[int]:
    """Yield the seeds with which tests fail, from one build."""
    for seed in SEEDS:
        try:
            env = {"COCOTB_TEST_FILTER": tests, "IK_AXI_JOBS": "4"}
            simulate(
                top,
                f"tb.core.power_up,{modules}",
                parameters=parameters,
                env=env,
                start=seed,
                built=seed != SEEDS[0],
                **options,
            )
        except SystemExit as failed:
            assert str(failed).startswith("FAILED"), failed  # not a failed build
            yield seed


@pytest.mark.cost(60)
@pytest.mark.parametrize(("top", "modules", "parameters", "tests"), TOPS)
def test_nothing_depends_on_the_start(top, modules, parameters, tests):
    assert list(failing(top, modules, parameters, tests)) == []


@pytest.mark.cost(60)
def test_a_register_without_an_initial_value_is_detected(tmp_path):
    options = {"root": copy_rtl(tmp_path, BUG), "name": "start"}
    assert any(failing("ik_axis", "tb.core.stream_tests", {"W": 16}, BUG.fails, **options))

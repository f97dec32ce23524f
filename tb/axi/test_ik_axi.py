# SPDX-License-Identifier: Apache-2.0
"""Jobs, faults and registers of ``ik_axi`` at several parameter sets; `make soak-memory` runs more jobs."""

import pytest

from tb.axi.instances import CORE, ECHO, FOLDED, echoing, named
from tb.sim.env import simulator
from tb.sim.shared import passes

MODULES = "tb.axi.ik_axi,tb.axi.faults,tb.axi.registers"
FEW = "one_record|limits|stalled=(none|all)"
ICARUS = simulator() == "icarus"
LONG = "pages|rates|stalled=(ar|r|aw|w|b)$"
"""Tests with many records. Icarus leaves them out, as Verilator is ten times faster; in the others, Icarus covers X."""
SAME = "every_field|pulses|strobes|unmapped_address|rates/latency=(18|66|130)"
"""Tests that do not depend on parameters: only one instance for wrist targets and one for hand poses run them."""


def run(modules: str, parameters: dict[str, int], jobs: int, tests: str = "", **options) -> None:
    """Run cocotb tests on an instance, with ``jobs`` random jobs; Icarus, which is slow, runs at most 10."""
    jobs, faults = (min(jobs, 10), 3) if ICARUS else (jobs, max(8, jobs // 20))
    env = {"IK_AXI_JOBS": str(jobs), "IK_AXI_FAULTS": str(faults), **options.pop("env", {})}
    if tests:
        env["COCOTB_TEST_FILTER"] = tests
    label = f"ik_axi-{env.get('IK_AXI_CORE', 'core')}-{named(parameters)}"
    passes(label, toplevel="ik_axi", module=modules, parameters=parameters, env=env, **options)


@pytest.mark.sim
@pytest.mark.bench("ik_axi", without=("ik_axis", "ik_arm"))
@pytest.mark.cost(40)
@pytest.mark.parametrize(
    "parameters",
    ECHO[:1] if ICARUS else [*ECHO[:4], *(pytest.param(one, marks=pytest.mark.slow) for one in ECHO[4:])],
    ids=named,
)
def test_around_the_core(tmp_path, parameters):
    """Run tests with an echo in place of the datapath; Icarus runs only the short ones, on one instance."""
    left_out = LONG if ICARUS else SAME if parameters not in (ECHO[0], ECHO[3]) else ""
    tests = f"^(?!.*({left_out}))" if left_out else ""
    jobs = 80 if parameters == ECHO[0] else 30
    run(MODULES, parameters, jobs, tests, env={"IK_AXI_CORE": "echo"}, **echoing(tmp_path))


@pytest.mark.sim
@pytest.mark.cost(20)
@pytest.mark.parametrize(
    "parameters", [CORE[0], *(pytest.param(one, marks=pytest.mark.slow) for one in CORE[1:])], ids=named
)
def test_with_the_core(parameters):
    """Run a few tests with the real datapaths. Icarus runs fewer: it would take minutes for ARM = 1 at W = 32."""
    few = "one_record|limits" if parameters == CORE[-1] else FEW
    run("tb.axi.ik_axi", parameters, 20, few if ICARUS else f"{FEW}|latency=2$")


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(30)
@pytest.mark.parametrize("parameters", FOLDED, ids=named)
def test_with_a_folded_core(parameters):
    """Run also resets and errors on the real folded datapaths, in front of which targets wait."""
    tests = f"{FEW}|blocked_channel|latency=2$|soft_reset/|reset_during|bus_errors|after_a_reset"
    run(MODULES, parameters, 8, FEW if ICARUS else tests)

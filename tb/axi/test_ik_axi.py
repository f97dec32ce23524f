# SPDX-License-Identifier: Apache-2.0
"""Builds ``ik_axi`` with several parameters and runs jobs, faults and registers on it; `make soak-memory` runs more."""

import pytest

from tb.axi.instances import CORE, ECHO, echoing, named
from tb.sim.env import simulator
from tb.sim.runner import simulate

MODULES = "tb.axi.ik_axi,tb.axi.faults,tb.axi.registers,tb.axi.rates"
FEW = "one_record|many_jobs$|stalled=all|latency=2$"


def case(parameters: dict[str, int], jobs: int, cost: int, slow: bool = True):
    """Parameters, and how many random jobs with them."""
    marks = [pytest.mark.cost(cost), *([pytest.mark.slow] if slow else [])]
    return pytest.param(parameters, jobs, marks=marks, id=f"{named(parameters)}-{jobs}")


def run(modules: str, parameters: dict[str, int], jobs: int, **options) -> None:
    if simulator() == "icarus":  # which takes several times as long
        jobs = min(jobs, 40)
    env = {"IK_AXI_JOBS": str(jobs), "IK_AXI_FAULTS": str(max(8, jobs // 20)), **options.pop("env", {})}
    simulate("ik_axi", modules, parameters=parameters, env=env, seed=1, **options)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("parameters", "jobs"),
    [
        case(ECHO[0], 200, 60, slow=False),
        case(ECHO[1], 200, 60),
        case(ECHO[2], 80, 50),
        case(ECHO[3], 80, 50),
        case(ECHO[4], 80, 50),
    ],
)
def test_around_the_core(tmp_path, parameters, jobs):
    run(MODULES, parameters, jobs, env={"IK_AXI_CORE": "echo"}, **echoing(tmp_path))


@pytest.mark.sim
@pytest.mark.parametrize(
    ("parameters", "jobs"),
    [
        case(CORE[0], 20, 20, slow=False),
        case(CORE[1], 60, 60),
        case(CORE[2], 20, 60),
    ],
)
def test_with_the_core(parameters, jobs):
    """The datapaths themselves."""
    run("tb.axi.ik_axi,tb.axi.rates", parameters, jobs, env={"COCOTB_TEST_FILTER": FEW})

# SPDX-License-Identifier: Apache-2.0
"""Builds ``ik_axi`` with several parameters and runs jobs, faults and registers on it.

Most jobs have an echo in the place of the datapath (tb/axi/ik_lean.v): what is around it is the same, and a simulation
takes a quarter of the time.
"""

import shutil
from pathlib import Path

import pytest

from tb.sim.env import simulator
from tb.sim.mutants import copy_rtl
from tb.sim.runner import simulate

MODULES = "tb.axi.ik_axi,tb.axi.faults,tb.axi.registers,tb.axi.rates"
FEW = "one_record|many_jobs$|stalled=all|latency=0"
ECHO = Path(__file__).with_name("ik_lean.v")


def case(jobs: int, cost: int, slow: bool = True, **parameters: int):
    """Parameters, and how many random jobs with them."""
    marks = [pytest.mark.cost(cost), *([pytest.mark.slow] if slow else [])]
    name = "-".join(f"{k}{v}" for k, v in parameters.items()) or "defaults"
    return pytest.param(parameters, jobs, marks=marks, id=f"{name}-{jobs}")


def run(modules: str, parameters: dict[str, int], jobs: int, **options) -> None:
    if simulator() == "icarus":  # which takes several times as long
        jobs = min(jobs, 100)
    env = {"IK_AXI_JOBS": str(jobs), "IK_AXI_FAULTS": str(max(8, jobs // 20)), **options.pop("env", {})}
    simulate("ik_axi", modules, parameters=parameters, env=env, seed=1, **options)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("parameters", "jobs"),
    [
        case(200, 60, slow=False, W=18, ADDR_W=20),
        case(800, 160),
        case(200, 80, W=18, DATA_W=128, ADDR_W=64, LOG2_BURST=4),
        case(200, 80, W=18, DATA_W=32, ADDR_W=40, LOG2_BURST=5),
        case(150, 80, W=25, DATA_W=128, LOG2_BURST=1),
    ],
)
def test_around_the_core(tmp_path, parameters, jobs):
    root = copy_rtl(tmp_path)
    shutil.copy(ECHO, root / "rtl" / "lean" / "ik_lean.v")
    run(MODULES, parameters, jobs, env={"IK_AXI_CORE": "echo"}, root=root, name="echo")


@pytest.mark.sim
@pytest.mark.parametrize(
    ("parameters", "jobs"),
    [
        case(20, 20, slow=False),
        case(200, 150, W=18, DATA_W=128),
        case(60, 100, W=18, LEAN=0, DIGIT=1),
    ],
)
def test_with_the_core(parameters, jobs):
    """The datapaths themselves."""
    run("tb.axi.ik_axi,tb.axi.rates", parameters, jobs, env={"COCOTB_TEST_FILTER": FEW})

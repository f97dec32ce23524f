# SPDX-License-Identifier: Apache-2.0
"""Tests of the C driver on ``ik_axi``, most of them with an echo instead of the datapath."""

import shutil

import pytest

from tb.axi.binding import compiled
from tb.axi.instances import echoing
from tb.sim.env import simulator
from tb.sim.runner import simulate

MODULE = "tb.axi.driver"
FEW = "who_is_there|solves/interrupt=.*/arm=metres|error_on_the_bus/interrupt=True/.*=slverr|aborted/interrupt=False"

pytestmark = [pytest.mark.sim, pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")]


def run(folder, library, tests: str, echo: bool = True, **parameters: int) -> None:
    env = {"IK_DRIVER": str(library), "COCOTB_TEST_FILTER": tests}
    options = {}
    if echo:
        options = echoing(folder)
        env["IK_AXI_CORE"] = "echo"
    simulate("ik_axi", MODULE, parameters=parameters, env=env, seed=1, **options)


ICARUS = simulator() == "icarus"
SMALL = {"W": 18, "ADDR_W": 20}
SETS = (
    {"few": (FEW, SMALL)}
    if ICARUS
    else {
        "all": ("", SMALL),
        "long_addresses": ("", {"W": 18, "DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 4}),
    }
)


@pytest.mark.cost(20)
@pytest.mark.parametrize(("tests", "parameters"), SETS.values(), ids=list(SETS))
def test_around_the_core(tmp_path, tests, parameters):
    run(tmp_path, compiled(tmp_path), tests, **parameters)


@pytest.mark.cost(30)
@pytest.mark.skipif(ICARUS, reason="Verilator runs the same tests in a tenth of the time")
def test_with_the_core(tmp_path):
    run(tmp_path, compiled(tmp_path), "solves/interrupt=True/arm=(small|metres)", echo=False)

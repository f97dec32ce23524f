# SPDX-License-Identifier: Apache-2.0
"""The C driver against ``ik_axi``; most of it with an echo in the place of the datapath, as in test_ik_axi.py."""

import shutil

import pytest

from tb.axi.binding import compiled
from tb.axi.instances import echoing
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


def slow(cost: int, *values):
    return pytest.param(*values, marks=[pytest.mark.slow, pytest.mark.cost(cost)])


@pytest.mark.parametrize(
    ("tests", "parameters"),
    [
        pytest.param(FEW, {"W": 18, "ADDR_W": 20}, marks=pytest.mark.cost(10)),
        slow(25, "", {"W": 18, "ADDR_W": 20}),
        slow(25, "", {"W": 18, "DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 4}),
    ],
    ids=["few", "all", "long_addresses"],
)
def test_around_the_core(tmp_path, tests, parameters):
    run(tmp_path, compiled(tmp_path), tests, **parameters)


@pytest.mark.slow
@pytest.mark.cost(30)
def test_with_the_core(tmp_path):
    run(tmp_path, compiled(tmp_path), "solves/interrupt=True/arm=(small|metres)", echo=False)

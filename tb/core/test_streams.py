# SPDX-License-Identifier: Apache-2.0
"""Run each test of stream_tests.py as a pytest case. All cases of a parameter set share one build and simulation."""

import re
from collections.abc import Iterator

import pytest
from cocotb import regression

from model.dataflow.datapaths import MODELS
from tb.core import stream_tests
from tb.sim.env import simulator
from tb.sim.shared import Shared

# One set per datapath; tag widths 3 and 8. At W = 23 the paper datapath takes 255 clocks, for which a FIFO of 256 slots
# would be too short. Streams do not depend on the word length. So Icarus, which is slow, runs lean at W = 18; on the
# paper datapath and the whole arm it runs only the tests in FEW.
SETS = {
    "fold-24": ("fold", 24, 8),
    "paper-23": ("paper", 23, 3),
    "arm-18": ("arm", 18, 3),
    "choose-18": ("choose", 18, 3),
    "fold_arm-24": ("fold_arm", 24, 3),
    "fold_choose-24": ("fold_choose", 24, 3),
    "fold_arm16-18": ("fold_arm16", 18, 3),
}
SETS |= {"lean-18": ("lean", 18, 3)} if simulator() == "icarus" else {"lean-32": ("lean", 32, 8)}
BYTES = {"bytes-18": ("lean", 18, 3), "arm_bytes-18": ("arm", 18, 3)}
"""Sets of ``ik_axis_bytes`` and ``ik_arm_bytes``."""
GENERATORS = [value for value in vars(stream_tests).values() if isinstance(value, regression.TestGenerator)]
TESTS = [test.name for generator in GENERATORS for test in generator.generate_tests()]

pytestmark = [pytest.mark.sim, pytest.mark.cost(60)]


def shared(key: str) -> Shared:
    """Return the simulation of a parameter set."""
    datapath, width, tag_width = (SETS | BYTES)[key]
    options = {"toplevel": MODELS[datapath].top + "_bytes" * (key in BYTES), "module": stream_tests.__name__}
    options["parameters"] = {"W": width, "TAG_W": tag_width, **MODELS[datapath].parameters}

    def chosen(names: list[str]) -> dict:
        wanted = "|".join(re.escape(f"stream_tests.{name}") + "$" for name in names)
        return options | {"env": {"COCOTB_TEST_FILTER": wanted}}

    return Shared(f"streams-{key}", chosen)


LARGE = ("paper-23", "arm-18", "choose-18", "fold_arm-24", "fold_choose-24") if simulator() == "icarus" else ()
FEW = ("one_result", "idle=bursts/stall=bursts", "full", "after=out", "results_wait")
PARTS = dict.fromkeys((*LARGE, "fold_arm16-18"), FEW) | dict.fromkeys(BYTES, ("idle=bursts/stall=bursts", "after=out"))
"""Set -> parts of the names of its tests; other sets run all. fold_arm16 differs from fold_arm only by its fetch of
steps, which test_power_up resets."""


def around(key: str) -> pytest.MarkDecorator:
    """Return the marker of the modules around the datapath, and of a folded datapath, which stalls, itself.

    test_every_node.py has the markers of the other datapaths.
    """
    path = MODELS[(SETS | BYTES)[key][0]]
    others = {other.entity for other in MODELS.values() if not path.times or other.entity != path.entity}
    return pytest.mark.bench(path.top + "_bytes" * (key in BYTES), without=others)


def cases() -> Iterator:
    """Yield a case for each parameter set and each of its tests."""
    for key in (*SETS, *BYTES):
        simulation, marks = shared(key), [around(key), *[pytest.mark.slow] * (key in BYTES)]
        for name in TESTS:
            if any(part in name for part in PARTS.get(key, [""])):
                yield pytest.param(simulation, name, id=f"{key}-{name}", marks=marks)


@pytest.mark.parametrize(("simulation", "name"), list(cases()))
def test_streams(request, simulation, name):
    """Run a test. With whole bytes, the padding of targets, which is random here, is ignored, and results are
    sign-extended."""
    simulation.check(request, name)

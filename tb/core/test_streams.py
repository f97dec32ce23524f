# SPDX-License-Identifier: Apache-2.0
"""Run each test of stream_tests.py as a pytest case. All cases of a parameter set share one build and simulation."""

import re
from collections.abc import Iterable

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
BYTES = {"bytes-18": ("lean", 18, 3)}
"""Set of ``ik_axis_bytes``."""
GENERATORS = [value for value in vars(stream_tests).values() if isinstance(value, regression.TestGenerator)]
TESTS = [test.name for generator in GENERATORS for test in generator.generate_tests()]

pytestmark = [pytest.mark.sim, pytest.mark.cost(60)]


def shared(key: str) -> Shared:
    """Return the simulation of a parameter set."""
    datapath, width, tag_width = (SETS | BYTES)[key]
    options = {"toplevel": "ik_axis_bytes" if key in BYTES else MODELS[datapath].top, "module": stream_tests.__name__}
    options["parameters"] = {"W": width, "TAG_W": tag_width, **MODELS[datapath].parameters}

    def chosen(names: list[str]) -> dict:
        wanted = "|".join(re.escape(f"stream_tests.{name}") + "$" for name in names)
        return options | {"env": {"COCOTB_TEST_FILTER": wanted}}

    return Shared(f"streams-{key}", chosen)


LARGE = ("paper-23", "arm-18", "choose-18", "fold_arm-24", "fold_choose-24") if simulator() == "icarus" else ()
SOME = (*LARGE, "fold_arm16-18")
"""Besides large sets, the one that differs from another only by its fetch of steps, which test_power_up resets."""
WHOLE = [key for key in SETS if key not in SOME]
FEW = ("one_result", "idle=bursts/stall=bursts", "full", "after=out")


def around(key: str) -> pytest.MarkDecorator:
    """Return the marker of the modules around the datapath, and of a folded datapath, which stalls, itself.

    test_every_node.py has the markers of the other datapaths.
    """
    path = MODELS[(SETS | BYTES)[key][0]]
    others = {other.entity for other in MODELS.values() if not path.times or other.entity != path.entity}
    return pytest.mark.bench("ik_axis_bytes" if key in BYTES else path.top, without=others)


def cases(keys: Iterable[str], parts: Iterable[str] = ("",)):
    """Return a decorator: a case for each parameter set and each test whose name contains one of ``parts``."""
    names = [name for name in TESTS if any(part in name for part in parts)]
    sets = {key: shared(key) for key in keys}
    rows = [pytest.param(sets[key], name, id=f"{key}-{name}", marks=around(key)) for key in sets for name in names]
    return pytest.mark.parametrize(("simulation", "name"), rows)


@cases(WHOLE)
def test_streams(request, simulation, name):
    simulation.check(request, name)


@cases(SOME, FEW)
def test_some_streams(request, simulation, name):
    simulation.check(request, name)


@pytest.mark.slow
@cases(BYTES, ["idle=bursts/stall=bursts", "after=out"])
def test_words_of_whole_bytes(request, simulation, name):
    """Check that ``ik_axis_bytes`` ignores the padding of targets, which is random here, and sign-extends results."""
    simulation.check(request, name)

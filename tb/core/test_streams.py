# SPDX-License-Identifier: Apache-2.0
"""Run each test of stream_tests.py as a pytest case. All cases of a parameter set share one build and simulation."""

import re
import xml.etree.ElementTree as ElementTree

import pytest

from model.dataflow.datapaths import MODELS
from tb.core import stream_tests
from tb.sim.env import simulator
from tb.sim.runner import simulate

# One set per datapath; tag widths 3 and 8. At W = 23 the paper datapath takes 255 clocks, for which a FIFO of 256 slots
# would be too short. Streams do not depend on the word length. So Icarus, which is slow, runs lean at W = 18; on the
# paper datapath and the whole arm it runs only the tests in FEW.
SETS = {
    "fold-24": ("fold", 24, 8),
    "paper-23": ("paper", 23, 3),
    "arm-18": ("arm", 18, 3),
    "fold_arm-24": ("fold_arm", 24, 3),
    "fold_arm16-18": ("fold_arm16", 18, 3),
}
SETS |= {"lean-18": ("lean", 18, 3)} if simulator() == "icarus" else {"lean-32": ("lean", 32, 8)}
BYTES = {"bytes-18": ("lean", 18, 3)}
"""Set of ``ik_axis_bytes``."""
GENERATORS = [value for value in vars(stream_tests).values() if hasattr(value, "generate_tests")]
TESTS = [test.name for generator in GENERATORS for test in generator.generate_tests()]

pytestmark = [pytest.mark.sim, pytest.mark.cost(60)]


@pytest.fixture(scope="module")
def failures(request, tmp_path_factory):
    """Run the selected tests of a parameter set; return the messages of those that failed."""
    datapath, width, tag_width = (SETS | BYTES)[request.param]
    top = "ik_axis_bytes" if request.param in BYTES else MODELS[datapath].top
    items = [item for item in request.session.items if item.path == request.path and hasattr(item, "callspec")]
    chosen = [item.callspec.params for item in items]
    names = [params["name"] for params in chosen if params["failures"] == request.param]
    results = tmp_path_factory.mktemp("streams") / "results.xml"
    parameters = {"W": width, "TAG_W": tag_width, **MODELS[datapath].parameters}
    wanted = "|".join(re.escape(f"stream_tests.{name}") + "$" for name in names)
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("COCOTB_RESULTS_FILE", str(results))
        env = {"COCOTB_TEST_FILTER": wanted}
        try:
            simulate(top, "tb.core.stream_tests", parameters=parameters, env=env, seed=1)
        except SystemExit as ended:
            if not str(ended).startswith("FAILED"):
                raise
    cases = list(ElementTree.parse(results).iter("testcase"))
    assert {case.get("name") for case in cases} >= set(names), "a test did not run"
    failed = {case.get("name"): case.find("failure") for case in cases}
    return {name: str(failure.attrib) for name, failure in failed.items() if failure is not None}


LARGE = ("paper-23", "arm-18", "fold_arm-24") if simulator() == "icarus" else ()
SOME = (*LARGE, "fold_arm16-18")  # only its fetch of steps differs from fold_arm-24's; test_power_up tests its reset
WHOLE = [key for key in SETS if key not in SOME]
FEW = ("one_result", "idle=bursts/stall=bursts", "full", "after=out")


# With one list of pairs instead of two decorators, pytest would simulate a set again for each of its cases.
@pytest.mark.parametrize("name", TESTS)
@pytest.mark.parametrize("failures", WHOLE, indirect=True)
def test_streams(failures, name):
    assert name not in failures, failures[name]


@pytest.mark.parametrize("name", [name for name in TESTS if any(part in name for part in FEW)])
@pytest.mark.parametrize("failures", SOME, indirect=True)
def test_some_streams(failures, name):
    assert name not in failures, failures[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in TESTS if "idle=bursts/stall=bursts" in name or "after=out" in name])
@pytest.mark.parametrize("failures", BYTES, indirect=True)
def test_words_of_whole_bytes(failures, name):
    """Check that ``ik_axis_bytes`` ignores the padding of targets, which is random here, and sign-extends results."""
    assert name not in failures, failures[name]

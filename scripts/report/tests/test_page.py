# SPDX-License-Identifier: Apache-2.0
"""The report without a browser: page contents, self-containedness, command line.

The simulator is the fake of test_run.py. browser_test_report.py tests the opened page.
"""

import html
import json
import os
import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from model.bounds import tolerances
from model.io import trajectories
from model.reference.kinematics import forward
from scripts import run
from scripts.report import page as report
from scripts.tests.test_run import FakeSimulator
from tb.sim.env import ROOT
from tb.sim.simulate import SimulationError

PAGE = Path("build/report/report.html")


@pytest.fixture
def simulator(monkeypatch):
    fake = FakeSimulator()
    prediction = lambda words, width, datapath: np.linspace(1.0, 2.0, len(words)) * 2.0 ** (8 - width)  # noqa: E731
    monkeypatch.setattr(run, "simulate", fake.simulate)
    monkeypatch.setattr(run, "hand_bar", prediction)
    return fake


@pytest.fixture
def cli(simulator, command):
    return partial(command, report.main)


def text(path=PAGE):
    return path.read_text(encoding="utf-8")


def data(path=PAGE):
    """Return the trajectories from the page's JSON script element, delimited as a browser does."""
    return whole(path)["trajectories"]


def whole(path=PAGE):
    (found,) = re.findall(r'<script type="application/json" id="data">(.*?)</script', text(path), re.S)
    return json.loads(found)


# -- contents --------------------------------------------------------------------------------------


def test_one_trajectory(cli, simulator, files):
    status, out, err = cli()
    assert (status, out, err) == (0, ["wrote build/report/report.html"], [])
    names = ["report.html", "results.csv", "results.npz", "score.json"]
    assert files() == [f"build/report/{name}" for name in names]
    assert len(simulator.calls) == 1
    (shown,) = data()
    assert (shown["name"], shown["about"]) == ("reach", trajectories.describe("reach"))
    assert "<title>CGA-IK: reach</title>" in text()
    assert "lean datapath, 32 bits, icarus" in text()
    assert shown["passed"] and shown["failures"] == []
    others = "figures", "failures", "beside"
    lists = [key for key, value in shown.items() if isinstance(value, list) and key not in others]
    assert len(lists) == 16 and {len(shown[key]) for key in lists} == {100}


def test_all_trajectories_are_in_one_file_of_one_run(cli, simulator, files):
    assert cli("--trajectory", "all", "--sim", "verilator", "--width", "24")[0] == 0
    assert len(files()) == 2 * len(trajectories.TRAJECTORIES) + 2
    assert [shown["name"] for shown in data()] == list(trajectories.TRAJECTORIES)
    (call,) = simulator.calls
    assert (call["simulator"], call["width"]) == ("verilator", 24)
    assert PAGE.stat().st_size < 2_000_000


@pytest.mark.parametrize(("datapath", "bar"), [("lean", tolerances.LEAN[32]), ("paper", tolerances.REGULAR)])
def test_figures_agree_with_the_score(cli, command, datapath, bar):
    """The plots have the maxima written by `make run`, and the table equals its table."""
    cli("--trajectory", "all", "--datapath", datapath)
    command(run.main, "--trajectory", "all", "--datapath", datapath)
    scores = json.loads(Path("build/run/score.json").read_text())
    for shown, score in zip(data(), scores, strict=True):
        clamped = np.array(shown["clamped"])

        def most(key, where, shown=shown):
            return np.array(shown[key])[where].max() if where.any() else None

        for key, where, figure in [
            ("hand", ~clamped, "hand_error_max"),
            ("predicted", ~clamped, "hand_error_predicted"),
            ("shoulderAngle", ~clamped, "shoulder_angle_error_max"),
            ("elbowAngle", ~clamped, "elbow_angle_error_max"),
            ("hand", clamped, "clamped_error_max"),
        ]:
            expected = score[figure]
            assert most(key, where) == (expected and pytest.approx(expected, rel=1e-6)), (score["trajectory"], figure)
        assert shown["bar"] == score["hand_error_bar"] and shown["bar"] in (bar, None)
        assert shown["outcome"] == score["outcome"]
        assert [shown["latency"], shown["cycles"]] == [score["latency_cycles"], score["total_cycles"]]
        measured = {row[0]: row[1] for row in shown["figures"]}
        assert measured["hand error / reach, largest"] == f"{score['hand_error_max']:.1e}"
        assert measured["latency (clocks)"] == str(score["latency_cycles"])


def test_the_arm_is_where_the_words_put_it(cli, simulator):
    """A wrong result word moves the drawn arm away from the target."""

    def spoil(runs):
        runs[0].results[30, 1] += 2**28  # 0.25 of qs_i

    simulator.spoil = spoil
    assert cli()[0] == 1
    (shown,) = data()
    wrist, target, lengths = (np.array(shown[key]) for key in ("wrist", "target", "lengths"))
    off = np.linalg.norm(wrist - target, axis=1)
    assert np.flatnonzero(off > 1e-5).tolist() == [30] and off[30] > 0.05
    elbow, hand = forward(shown["qs"], shown["qe"], *lengths.T)
    np.testing.assert_allclose(elbow, shown["elbow"], atol=1e-6)
    np.testing.assert_allclose(hand, wrist, atol=1e-6)
    assert not shown["passed"] and "at target 30" in shown["failures"][0]


def test_the_swivel_plane_holds_the_arm(cli):
    cli("--trajectory", "all")
    for shown in data():
        normal = np.array(shown["normal"])
        for point in ("elbow", "wrist"):
            height = (normal * shown[point]).sum(axis=1)
            assert np.abs(height).max() < 1e-5, (shown["name"], point)


def test_arms_of_a_file(cli):
    cli("--trajectory", "two_arms")
    assert data()[0]["arm"] == [1, 0] * 50
    rows = [f"0.2,0.1,0.1,{0.3 + k / 100}\n" for k in range(report.MOST_ARMS + 1)]
    Path("t.csv").write_text("x,y,z,d1\n" + "".join(rows[:-1]))
    cli("--trajectory", "t.csv")
    assert data()[0]["arm"] == [0, 1, 2, 3]
    Path("t.csv").write_text("x,y,z,d1\n" + "".join(rows))
    cli("--trajectory", "t.csv")
    assert data()[0]["arm"] == [0, 0, 0, 0, 0]


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e3, 1e150])
def test_lengths_are_in_the_unit_of_the_file(cli, unit):
    Path("t.csv").write_text(f"x,y,z,d1,d2\n{0.3 * unit},{0.1 * unit},{0.2 * unit},{0.33 * unit},{0.27 * unit}\n")
    assert cli("--trajectory", "t.csv")[0] == 0
    (shown,) = data()
    assert shown["about"] == "Targets of t.csv."
    np.testing.assert_allclose(shown["wrist"], np.array([[0.3, 0.1, 0.2]]) * unit, rtol=1e-5)


def test_clamped_targets_are_measured_against_the_clamped_pose(cli):
    cli("--trajectory", "out_of_reach")
    (shown,) = data()
    assert sum(shown["clamped"]) == 48
    assert max(shown["hand"]) < 1e-6, "15 cm out of reach is no error of the hand"
    assert {shown["flags"][n] for n in range(100) if shown["clamped"][n]} == {"too_far"}


def test_both_datapaths_on_the_same_targets(cli, simulator, command, files):
    """Each datapath has its own simulation, results and files, equal to those of `make run`."""

    def spoil(runs):
        if simulator.calls[-1]["datapath"] == "paper":
            runs[0].results[30, 1] += 2**10

    simulator.spoil = spoil
    assert cli("--datapath", "lean,paper")[0] == 1
    first, second = simulator.calls
    assert [call["datapath"] for call in simulator.calls] == ["lean", "paper"]
    assert (first["jobs"][0].words == second["jobs"][0].words).all()
    written = [f"build/report/{datapath}/results.{kind}" for datapath in ("lean", "paper") for kind in ("csv", "npz")]
    assert files() == [*written, "build/report/report.html", "build/report/score.json"]
    (shown,) = data()
    (beside,) = shown["beside"]
    assert (shown["datapath"], beside["datapath"]) == ("lean", "paper")
    assert set(beside) < set(shown) and "target" not in beside
    assert shown["bar"] == tolerances.LEAN[32] and beside["bar"] == tolerances.REGULAR
    off = np.abs(np.array(beside["wrist"]) - shown["wrist"]).max(axis=1)
    assert np.flatnonzero(off > 1e-7).tolist() == [30]
    assert "lean and paper datapaths, 32 bits, icarus" in text()
    for datapath in ("lean", "paper"):
        command(run.main, "--datapath", datapath, "--out", datapath)
        assert (PAGE.parent / datapath / "results.csv").read_bytes() == Path(datapath, "results.csv").read_bytes()
    listed = whole()["files"]
    assert listed == {
        "reach": [f"{d}/results.{kind}" for d in ("lean", "paper") for kind in ("csv", "npz")],
        "": ["score.json"],
    }


def test_one_of_both_that_fails_is_named(cli, simulator):
    def spoil(runs):
        if simulator.calls[-1]["datapath"] == "paper":
            runs[0].bit_mismatches, runs[0].first_mismatch = 5, "target 3, node c4"

    simulator.spoil = spoil
    status, out, err = cli("--datapath", "lean,paper")
    assert (status, out) == (1, ["wrote build/report/report.html"])
    assert err == [
        "report, paper datapath: reach fails: 5 bits differ from the bit-true model; target 3, node c4",
    ]
    (shown,) = data()
    assert shown["passed"] and [each["passed"] for each in shown["beside"]] == [False]


# -- self-containedness ----------------------------------------------------------------------------


def test_the_same_run_writes_the_same_bytes(cli):
    cli()
    first = PAGE.read_bytes()
    cli()
    assert PAGE.read_bytes() == first


def test_names_cannot_break_out(cli):
    name = """<!--<script>&"'{{links}}{{x}}\u2028.csv"""
    Path(name).write_text("x,y,z\n0.3,0.1,-0.2\n")
    assert cli("--trajectory", name)[0] == 0
    (shown,) = data()
    assert shown["name"] == name[:-4] and shown["about"] == f"Targets of {name}."
    assert f"<title>CGA-IK: {html.escape(name[:-4])}</title>" in text()
    assert text().count("<script") == 2 and text().count("</script>") == 2 and "<!--" not in text()


def test_no_path_of_this_machine_stands_in_the_page(cli, tmp_path):
    Path("t.csv").write_text("x,y,z\n0.3,0.1,-0.2\n")
    cli("--trajectory", str(tmp_path / "t.csv"), "--out", str(tmp_path / "o"))
    page = text(tmp_path / "o" / "report.html")
    assert str(ROOT) not in page and str(tmp_path) not in page and "docs/" not in page


# -- the command line ------------------------------------------------------------------------------


def test_a_trajectory_that_fails_is_shown_all_the_same(cli, simulator):
    def spoil(runs):
        runs[2].bit_mismatches, runs[2].first_mismatch = 5, "target 3, node c4"

    simulator.spoil = spoil
    status, out, err = cli("--trajectory", "all")
    assert (status, out) == (1, ["wrote build/report/report.html"])
    assert err == ["report: figure_eight fails: 5 bits differ from the bit-true model; target 3, node c4"]
    assert [shown["name"] for shown in data() if not shown["passed"]] == ["figure_eight"]


@pytest.mark.parametrize("what", ["simulation", "ctrl-c", "disk"])
def test_the_old_page_stays_when_no_new_one_comes(cli, simulator, monkeypatch, what, files):
    PAGE.parent.mkdir(parents=True)
    PAGE.write_text("old")

    def broken(runs):
        raise SimulationError("iverilog: not found")

    def interrupted(runs):
        raise KeyboardInterrupt

    def full(old, new):
        raise OSError(28, "No space left on device", os.fspath(new))

    if what == "simulation":
        simulator.spoil = broken
        expected = (1, "report: iverilog: not found")
    elif what == "ctrl-c":
        simulator.spoil = interrupted
        expected = (130, "report: interrupted")
    else:
        monkeypatch.setattr(os, "replace", full)
        expected = (2, f"report: cannot write '{PAGE}': No space left on device")
    status, out, err = cli()
    assert (status, out, err) == (expected[0], [], [expected[1]])
    assert files() == [str(PAGE)] and text() == "old"

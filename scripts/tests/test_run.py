# SPDX-License-Identifier: Apache-2.0
"""Tests of `make run` with the double-precision model as simulator: files, tables, failures, signals."""

import csv
import json
import os
import signal
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from model.io import trajectories
from model.io.flags import expected_flags
from model.io.words import FIELDS, RESULT_FIELDS, from_words
from model.motion.pose import solve
from model.reference.equations import solve_clamped
from scripts import results, run
from scripts.fpga.page import FIGURES, clock
from scripts.recording import WAVES
from tb.sim.simulate import Run, SimulationError


class FakeSimulator:
    """Replacement for `tb.sim.simulate`: `spoil` may change its runs, `calls` records its arguments."""

    def __init__(self):
        self.calls = []
        self.spoil = lambda runs: None

    def simulate(self, jobs, *, width, waves, **given):
        self.calls.append({"jobs": jobs, "width": width, **given})
        if waves:
            assert waves.is_absolute(), "the simulator runs in another folder"
            waves.touch()
        runs = []
        for job in jobs:
            targets = from_words(job.words, 0, width, job.name)
            pose = solve_clamped(*(getattr(targets, field) for field in FIELDS))
            exact = np.column_stack([pose[field] for field in RESULT_FIELDS])
            words = np.rint(np.ldexp(exact, width - 2)).astype(np.int64)
            runs.append(Run(words, expected_flags(job.words, width), 363, 363 + len(job.words), 0, None))
        self.spoil(runs)
        return runs


@pytest.fixture
def simulator(monkeypatch):
    fake = FakeSimulator()
    monkeypatch.setattr(run, "simulate", fake.simulate)
    monkeypatch.setattr(run, "write_save_file", lambda vcd, datapath, width, path: path.touch())
    monkeypatch.setattr(run, "align", lambda vcd, *_: [vcd.with_name(name.name).touch() for name in WAVES])
    monkeypatch.setattr(run, "hand_bar", lambda words, width, datapath: np.full(len(words), 2.0 ** (8 - width)))
    return fake


@pytest.fixture
def cli(simulator, command):
    return partial(command, run.main)


def scores(path="build/run/score.json"):
    return json.loads(Path(path).read_text(encoding="utf-8"))


def test_the_scenario_of_the_paper_runs_on_both_datapaths(cli, simulator, files):
    status, out, err = cli()
    assert (status, err) == (0, [])
    names = [f"build/run/{d}/results.{kind}" for d in ("lean", "paper") for kind in ("csv", "npz")]
    assert files() == [*names, "build/run/score.json"] and out[-5:] == [f"wrote {name}" for name in files()]
    assert [(call["datapath"], [job.name for job in call["jobs"]]) for call in simulator.calls] == [
        ("lean", ["reach"]),
        ("paper", ["reach"]),
    ]
    assert [(each["datapath"], each["targets"], each["passed"]) for each in scores()] == [
        ("lean", 100, True),
        ("paper", 100, True),
    ]
    table = {line[:41].strip(): line[41:].split() for line in out if line.startswith(" ")}
    mhz = [clock(json.loads(FIGURES.read_text()), datapath, 32) for datapath in ("lean", "paper")]
    assert table["latency (clocks)"] == ["~550", "363", "363"]
    assert table["until the last (us)"] == ["6", *(f"{463 / each:.2f}" for each in mhz)]


def test_options_reach_the_simulator(cli, simulator, files):
    words = "--sim verilator --width 24 --cores digit --out o --trajectory circle --waves"
    status, out, err = cli(*words.split())
    assert (status, err) == (0, [])
    (call,) = simulator.calls
    given = {name: call[name] for name in ("simulator", "datapath", "width", "cores")}
    assert given == {"simulator": "verilator", "datapath": "lean", "width": 24, "cores": "digit"}
    names = ["aligned.gtkw", "aligned.vcd", "results.csv", "results.npz", "score.json", "waves.gtkw", "waves.vcd"]
    assert files() == [f"o/{name}" for name in names]
    assert sorted(line for line in out if line.startswith("wrote ")) == [f"wrote {name}" for name in files()]


def test_all_trajectories_have_a_line_and_a_file_each(cli, simulator, files):
    status, out, err = cli("--trajectory", "all", "--waves")
    names = list(trajectories.TRAJECTORIES)
    assert (status, err, len(simulator.calls)) == (0, [], 1)
    written = [f"build/run/{name}/results.{kind}" for name in names for kind in ("csv", "npz")]
    assert files() == sorted([*written, "build/run/score.json", "build/run/waves.gtkw", "build/run/waves.vcd"])
    assert [each["trajectory"] for each in scores()] == names
    assert [line.split()[0] for line in out if line.split()[-1:] == ["pass"]][: len(names)] == names


def test_list(cli, simulator):
    status, out, err = cli("--list")
    assert (status, err, simulator.calls) == (0, [], [])
    assert [line.split()[0] for line in out] == list(trajectories.TRAJECTORIES)


def test_columns_axis_and_length_unit_of_a_file(cli):
    """Results are in the file's frame and unit, with the file's other columns."""
    text = "\ufefft;X;y;Z;d2;note\r\n0,5;0,3;0,1;0,2;0,4;first\r\n\r\n1,0;0,3;0,1;-0,2;0,4;\r\n"
    Path("t.CSV").write_text(text, encoding="utf-8", newline="")
    assert cli("--trajectory", "t.CSV", "--axis=0.3,1,0", "--phi=-1e-1", "--d1", "0.5", "--d2", "9")[::2] == (0, [])
    rows = list(csv.DictReader(Path("build/run/results.csv").open(encoding="utf-8")))
    assert [(row["t"], row["note"]) for row in rows] == [("0,5", "first"), ("1,0", "")]
    assert {(row["phi"], row["d1"], row["d2"]) for row in rows} == {("-0.1", "0.5", "0.4")}
    pose = solve([(0.3, 0.1, 0.2), (0.3, 0.1, -0.2)], -0.1, d1=0.5, d2=0.4, axis=(0.3, 1, 0), width=32)
    np.testing.assert_allclose([[float(row[f"elbow_{axis}"]) for axis in "xyz"] for row in rows], pose.elbow)
    np.testing.assert_allclose([[float(row[f"qs_{unit}"]) for unit in "wijk"] for row in rows], pose.qs)
    arrays = np.load("build/run/results.npz")
    np.testing.assert_allclose(arrays["wrist"], [(0.3, 0.1, 0.2), (0.3, 0.1, -0.2)], atol=1e-8)


@pytest.mark.parametrize(("axis", "phi"), [("z", np.pi), ("-z", 0.0), ("0,-1,1", 2.356194490192345)])
def test_rows_without_phi_have_the_elbow_of_a_hanging_arm(cli, axis, phi):
    Path("t.csv").write_text("x,y,z\n0.4,0,0\n", encoding="utf-8")
    assert cli("--trajectory", "t.csv", f"--axis={axis}")[::2] == (0, [])
    (row,) = csv.DictReader(Path("build/run/results.csv").open(encoding="utf-8"))
    assert float(row["phi"]) == pytest.approx(phi) and float(row["elbow_z"]) < -0.2


@pytest.mark.parametrize(
    ("content", "warning"),
    [
        ("x,y,z\n5,1,2\n0.1,0,0.3\n3,0,0\n", "2 of 3 targets are out of reach of an arm of 0.33 + 0.27 "),
        ("x,y,z,phi\n.3,.1,.2,90\n", "phi goes as far as 90; it is in radians"),
    ],
)
def test_other_units_give_a_warning(cli, content, warning):
    Path("t.csv").write_text(content, encoding="utf-8")
    status, _, err = cli("--trajectory", "t.csv")
    assert (status, len(err)) == (0, 1) and err[0].startswith(f"warning: t.csv: {warning}")


def test_failures_name_trajectory_bar_and_node(cli, simulator):
    def spoil(runs):
        runs[1].results[30, 0] += 2**20  # circle
        runs[2].bit_mismatches, runs[2].first_mismatch = 5, "target 3, node c4"

    simulator.spoil = spoil
    status, out, err = cli("--trajectory", "all")
    assert status == 1 and err[0].startswith("run: circle fails: hand error ")
    assert "at target 30 is " in err[0] and "times its bar 2e-08" in err[0]
    assert err[-1] == "run: figure_eight fails: 5 bits differ from the bit-true model; target 3, node c4"
    assert [each["trajectory"] for each in scores() if not each["passed"]] == ["circle", "figure_eight"]
    assert sum("FAIL" in line for line in out) == 2


def test_a_bar_is_applied(cli):
    status, _, err = cli("--bar", "1e-12")
    assert status == 1 and "times its bar 1e-12" in err[0]
    assert cli("--bar", "1e-4", "--datapath", "paper", "--trajectory", "punch")[0] == 0


def test_a_full_disk(cli, monkeypatch):
    def full(path, *args):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(results, "write_score_json", full)
    status, _, err = cli()
    assert (status, err) == (2, ["run: cannot read or write 'build/run/score.json': No space left on device"])


@pytest.mark.parametrize(
    ("end", "status", "message"),
    [
        (lambda: signal.raise_signal(signal.SIGINT), 130, "interrupted"),
        (lambda: signal.raise_signal(signal.SIGTERM), 143, "terminated"),
        (lambda: signal.raise_signal(signal.SIGHUP), 129, "hung up"),
        (SimulationError("vvp: killed"), 1, "vvp: killed"),
    ],
)
@pytest.mark.usefixtures("interruptible")
def test_a_run_that_ends_early_leaves_files_as_they_were(cli, simulator, files, end, status, message):
    Path("o").mkdir()
    Path("o/waves.vcd").write_text("old", encoding="utf-8")

    def spoil(runs):
        assert sorted(path.name for path in Path("o").iterdir()) == [f".{os.getpid()}.waves.vcd", "waves.vcd"]
        if isinstance(end, Exception):
            raise end
        end()

    simulator.spoil = spoil
    assert cli("--out", "o", "--waves", "--datapath", "lean") == (status, [], [f"run: {message}"])
    assert files() == ["o/waves.vcd"] and Path("o/waves.vcd").read_text(encoding="utf-8") == "old"


def test_an_ignored_signal_stays_ignored(cli, simulator):
    """Under nohup, SIGHUP is ignored."""
    simulator.spoil = lambda runs: signal.raise_signal(signal.SIGHUP)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert cli()[0] == 0
    finally:
        signal.signal(signal.SIGHUP, before)

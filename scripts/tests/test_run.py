# SPDX-License-Identifier: Apache-2.0
"""The command line: what it writes and prints, its exit status, and one clear line for every mistake.

The simulator is replaced by the double-precision model rounded to words, so that these tests take no build.
"""

import contextlib
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
from scripts.fpga.page import CHIPS, FIGURES, clock, fold_runs
from scripts.recording import WAVES
from tb.sim.simulate import Run, SimulationError


class FakeSimulator:
    """Stands in for `tb.sim.simulate`; `spoil` may change its runs, `calls` records what it was given."""

    def __init__(self):
        self.calls = []
        self.spoil = lambda runs: None

    def simulate(self, jobs, *, simulator, datapath, width, waves, progress=None, cores=None):
        given = {"simulator": simulator, "datapath": datapath, "width": width, "progress": progress, "cores": cores}
        self.calls.append({"jobs": jobs, **given})
        if waves:
            assert waves.is_absolute(), "the simulator runs in another folder"
            waves.touch()
        runs = []
        for job in jobs:
            asked = from_words(job.words, 0, width, job.name)
            pose = solve_clamped(*(getattr(asked, field) for field in FIELDS))
            exact = np.column_stack([pose[field] for field in RESULT_FIELDS])
            results = np.rint(np.ldexp(exact, width - 2)).astype(np.int64)
            runs.append(Run(results, expected_flags(job.words, width), 363, 363 + len(job.words), 0, None))
        self.spoil(runs)
        return runs


@pytest.fixture
def simulator(monkeypatch):
    """The fake simulator in the place of the real one, and a fixed prediction."""
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


# -- what it does ----------------------------------------------------------------------------------


def test_the_paper_scenario_by_both_datapaths(cli, simulator, files):
    """Plain `make run`: two simulations, results of each in a folder of its own, one score.json, the paper beside."""
    status, out, err = cli()
    assert (status, err) == (0, [])
    names = [f"build/run/{d}/results.{kind}" for d in ("lean", "paper") for kind in ("csv", "npz")]
    assert files() == [*names, "build/run/score.json"]
    assert out[-5:] == [f"wrote {name}" for name in files()]
    assert [call["datapath"] for call in simulator.calls] == ["lean", "paper"]
    assert all([job.name for job in call["jobs"]] == ["reach"] for call in simulator.calls)
    assert [(item["datapath"], item["targets"], item["passed"]) for item in scores()] == [
        ("lean", 100, True), ("paper", 100, True),
    ]  # fmt: skip
    table = {line[:41].strip(): line[41:].split() for line in out if line.startswith(" ")}
    assert table["figure"] == ["the", "paper", "lean", "paper"]
    assert table["latency (clocks)"] == ["~550", "363", "363"]
    runs = json.loads(FIGURES.read_text())["runs"]
    cells = [runs[f"{name}-xc2vp"]["cells"] for name in ("lean-W32", "paper-W32-DIGIT1")]
    assert table["LUT4"] == ["~30000", *(str(each["LUT"]) for each in cells)]
    assert table["of the 2VP70's"][::2] == ["45%", "45%"]
    assert table["18x18 multipliers"] == ["-", *(str(each["multipliers"]) for each in cells)]
    mhz = [clock(json.loads(FIGURES.read_text()), datapath, 32) for datapath in ("lean", "paper")]
    assert table["until the first result (us)"] == ["5", *(f"{363 / each:.2f}" for each in mhz)]
    assert table["until the last (us)"] == ["6", *(f"{463 / each:.2f}" for each in mhz)]
    assert table["times the paper's software"] == ["143", *(f"{860 * each / 463:.0f}" for each in mhz)]
    assert table["bits that differ from the bit-true model"] == ["-", "0", "0"]
    assert max(map(len, out)) <= 79


def test_what_fpga_has_not_measured_is_left_open(cli):
    """And times for another number of targets are those of as many in the paper."""
    Path("t.csv").write_text("x,y,z\n" + "0.3,0.1,-0.2\n" * 50, encoding="utf-8")
    _, out, _ = cli("--width", "20", "--datapath", "lean,paper", "--trajectory", "t.csv")
    table = {line[:41].strip(): line[41:].split() for line in out if line.startswith(" ")}
    for name in ("18x18 multipliers", "clock (MHz)", "until the last (us)", "times the paper's software"):
        assert table[name][1:] == ["-", "-"], name
    assert table["until the last (us)"][0] == "5.5" and table["times the paper's software"][0] == "78"


@pytest.mark.parametrize(("name", "width", "chip"), [("fold", 32, "ecp5-12k"), ("fold16", 24, "up5k")])
def test_a_folded_machine_is_beside_the_others(cli, name, width, chip):
    """With what it needs of the chip that it is placed on, and that chip's name below."""
    status, out, _ = cli("--datapath", f"lean,{name},paper", "--width", str(width))
    assert status == 0
    table = {line[:41].strip(): line[41:].split() for line in out if line.startswith(" ")}
    assert table["figure"] == ["the", "paper", "lean", name, "paper"]
    data = json.loads(FIGURES.read_text())
    run, placed = fold_runs(data, chip, name, width)
    assert [table[row][2] for row in ("LUT4", "18x18 multipliers")] == [str(run["cells"]["LUT"]), "4"]
    assert table["of the 2VP70's"][2] == "-"
    assert table["clock (MHz)"][2] == f"{placed['mhz']:.0f}"
    assert table["until the first result (us)"][2] == f"{363 / placed['mhz']:.2f}"
    assert f"clock of an {CHIPS[chip][0]}." in " ".join(out)


def test_one_of_both_that_fails_is_named(cli, simulator):
    def spoil(runs):
        if simulator.calls[-1]["datapath"] == "paper":
            runs[0].bit_mismatches, runs[0].first_mismatch = 5, "target 3, node c4"

    simulator.spoil = spoil
    status, out, err = cli()
    assert status == 1
    assert err == ["run, paper datapath: reach fails: 5 bits differ from the bit-true model; target 3, node c4"]
    assert any(line.startswith("paper: FAIL") for line in out) and any(line.startswith("lean: pass") for line in out)
    assert [item["passed"] for item in scores()] == [True, False]


def test_one_datapath(cli, simulator, files):
    status, out, err = cli("--datapath", "lean")
    assert (status, err) == (0, [])
    names = ["results.csv", "results.npz", "score.json"]
    assert files() == [f"build/run/{name}" for name in names]
    assert out[-3:] == [f"wrote build/run/{name}" for name in names]
    (call,) = simulator.calls
    assert (call["simulator"], call["datapath"], call["width"]) == ("icarus", "lean", 32)
    assert call["cores"] == "behavioural"
    (score,) = scores()
    assert score["trajectory"] == "reach" and score["targets"] == 100 and score["passed"]
    hand = next(line for line in out if "hand error / reach, largest" in line)
    assert hand.split()[-3:] == [f"{score['hand_error_max']:.1e}", "2e-08", "6.0e-08"]
    assert any(line.startswith("pass: within 2e-08 of the reach, as asked; ") for line in out)
    assert any(line.split()[-2:] == ["target", str(score["hand_error_target"])] for line in out)


def test_other_trajectories_run_on_the_lean_datapath(cli, simulator):
    assert cli("--trajectory", "circle")[0] == 0
    assert [call["datapath"] for call in simulator.calls] == ["lean"]


def test_options_reach_the_simulator(cli, simulator, files):
    words = "--sim verilator --width 24 --cores digit --out o --trajectory circle --waves"
    status, _, err = cli(*words.split())
    assert (status, err) == (0, [])
    (call,) = simulator.calls
    assert (call["simulator"], call["width"], call["cores"]) == ("verilator", 24, "digit")
    names = ["aligned.gtkw", "aligned.vcd", "results.csv", "results.npz", "score.json", "waves.gtkw", "waves.vcd"]
    assert files() == [f"o/{name}" for name in names]
    assert [(item["simulator"], item["width"]) for item in scores("o/score.json")] == [("verilator", 24)]


def test_the_paths_of_waves_are_printed(cli, files):
    _, out, _ = cli("--waves")
    names = [f"{name}.{kind}" for name in ("waves", "aligned") for kind in ("vcd", "gtkw")]
    paths = [f"build/run/{datapath}/{name}" for datapath in ("lean", "paper") for name in names]
    assert out[-8:] == [f"wrote {path}" for path in paths]
    assert set(paths) < set(files())


def test_of_many_trajectories_nothing_is_aligned(cli, files):
    _, out, _ = cli("--waves", "--trajectory", "all")
    assert out[-2:] == ["wrote build/run/waves.vcd", "wrote build/run/waves.gtkw"]
    assert not any("aligned" in name for name in files())


def test_all_trajectories_get_a_line_and_a_file_each(cli, simulator, files):
    status, out, err = cli("--trajectory", "all")
    names = list(trajectories.TRAJECTORIES)
    assert (status, err) == (0, [])
    assert len(simulator.calls) == 1, "one build and one simulation for all"
    results = [f"build/run/{name}/results.{kind}" for name in names for kind in ("csv", "npz")]
    assert files() == sorted([*results, "build/run/score.json"])
    wrote = [f"wrote build/run/*/results.{kind} (14 files)" for kind in ("csv", "npz")]
    assert out[-3:] == [*wrote, "wrote build/run/score.json"]
    assert [item["trajectory"] for item in scores()] == names
    for name in names:
        (line,) = [line for line in out if line.split()[:1] == [name]]
        assert line.split()[-1] == "pass"
        assert len(line.rstrip()) <= 79
    flagged = {item["trajectory"]: item["flagged"] for item in scores()}
    assert flagged.pop("out_of_reach") > 10
    assert set(flagged.values()) == {0}


def test_list(cli, simulator):
    status, out, err = cli("--list")
    assert (status, err) == (0, [])
    assert out == [f"{name:14} {trajectories.describe(name)}" for name in trajectories.TRAJECTORIES]
    assert simulator.calls == []


@pytest.mark.parametrize("count", [1, 7, 10_000])
def test_a_file_with_any_number_of_targets(cli, count):
    Path("t.csv").write_text("x,y,z\n" + "0.3,0.1,-0.2\n" * count, encoding="utf-8")
    status, _, err = cli("--trajectory", "t.csv")
    assert (status, err) == (0, [])
    assert [item["targets"] for item in scores()] == [count]
    assert scores()[0]["trajectory"] == "t"
    assert len(Path("build/run/results.csv").read_text(encoding="utf-8").splitlines()) == count + 1


@pytest.mark.parametrize("name", ["t.CSV", "targets", "sub/t.csv"])
def test_files_of_other_names(cli, name):
    Path("sub").mkdir()
    Path(name).write_text("x,y,z\n0.3,0.1,-0.2\n", encoding="utf-8")
    assert cli("--trajectory", name)[0] == 0


def test_bom_and_crlf(cli):
    Path("t.csv").write_bytes(b"\xef\xbb\xbfx,y,z,d1,d2\r\n300,100,-200,330,270\r\n\r\n")
    assert cli("--trajectory", "t.csv")[::2] == (0, [])
    row = Path("build/run/results.csv").read_text(encoding="utf-8").splitlines()[1]
    assert row.startswith("0,300.0,100.0,-200.0,3.141592653589793,330.0,270.0,"), "in the user's own unit"


def test_arm_and_swivel_for_files_without_them(cli):
    Path("t.csv").write_text("x,y,z,d2\n0.3,0.1,-0.2,0.4\n", encoding="utf-8")
    assert cli("--trajectory", "t.csv", "--d1", "0.5", "--d2", "9", "--phi=-1e-1")[0] == 0
    row = Path("build/run/results.csv").read_text(encoding="utf-8").splitlines()[1]
    assert row.startswith("0,0.3,0.1,-0.2,-0.1,0.5,0.4,"), "a column in the file goes before the option"


@pytest.mark.parametrize(("axis", "phi"), [("z", np.pi), ("-z", 0.0), ("0,-1,1", 2.356194490192345)])
def test_rows_without_phi_have_the_elbow_of_a_hanging_arm(cli, axis, phi):
    Path("t.csv").write_text("x,y,z\n0.4,0,0\n", encoding="utf-8")
    assert cli("--trajectory", "t.csv", f"--axis={axis}")[::2] == (0, [])
    (row,) = csv.DictReader(Path("build/run/results.csv").open(encoding="utf-8"))
    assert float(row["phi"]) == pytest.approx(phi)
    assert float(row["elbow_z"]) < -0.2 and abs(float(row["elbow_y"])) < 1e-8


def test_axis_and_columns_of_the_file(cli):
    """Results are in the frame of the file: the hand is where the user wanted it, whatever the core was asked."""
    Path("t.csv").write_text("t;X;y;Z;note\n0,5;0,3;0,1;0,2;first\n\n1,0;0,3;0,1;-0,2;\n", encoding="utf-8")
    assert cli("--trajectory", "t.csv", "--axis=0.3,1,0", "--phi", "1")[::2] == (0, [])
    rows = list(csv.DictReader(Path("build/run/results.csv").open(encoding="utf-8")))
    assert [(row["t"], row["note"]) for row in rows] == [("0,5", "first"), ("1,0", "")]
    pose = solve([(0.3, 0.1, 0.2), (0.3, 0.1, -0.2)], 1.0, axis=(0.3, 1, 0), width=32)
    np.testing.assert_allclose([[float(row[f"elbow_{axis}"]) for axis in "xyz"] for row in rows], pose.elbow)
    np.testing.assert_allclose([[float(row[f"qs_{unit}"]) for unit in "wijk"] for row in rows], pose.qs)
    arrays = np.load("build/run/results.npz")
    np.testing.assert_allclose(arrays["wrist"], [(0.3, 0.1, 0.2), (0.3, 0.1, -0.2)], atol=1e-8)
    assert scores()[0]["hand_error_max"] < 1e-8


@pytest.mark.parametrize(
    ("content", "words", "warning"),
    [
        ("x,y,z\n5,1,2\n0.1,0,0.3\n3,0,0\n", [], "2 of 3 targets are out of reach of an arm of 0.33 + 0.27 (by def"),
        ("x,y,z\n5,1,2\n", ["--d1=0.4", "--d2=0.3"], "1 of 1 targets are out of reach of an arm of 0.4 + 0.3; are x"),
        ("x,y,z,phi\n.3,.1,.2,90\n", [], "phi goes as far as 90; it is in radians, are these degrees?"),
    ],
)
def test_other_units_are_asked_about(cli, content, words, warning):
    Path("t.csv").write_text(content, encoding="utf-8")
    status, _, err = cli("--trajectory", "t.csv", *words)
    assert (status, len(err)) == (0, 1) and err[0].startswith(f"warning: t.csv: {warning}")


def test_the_same_run_writes_the_same_bytes(cli):
    cli("--trajectory", "random_walk", "--out", "a")
    cli("--trajectory", "random_walk", "--out", "b", "--sim", "verilator")
    assert Path("a/results.csv").read_bytes() == Path("b/results.csv").read_bytes()
    a, b = (Path(folder, "score.json").read_text().splitlines() for folder in "ab")
    differing = [pair for pair in zip(a, b, strict=True) if pair[0] != pair[1]]
    assert differing == [('    "simulator": "icarus",', '    "simulator": "verilator",')]


def test_progress_on_a_terminal_goes_to_stderr(cli, simulator, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich takes stderr for a terminal then
    monkeypatch.setenv("TERM", "xterm")
    seen = []

    def spoil(runs):
        progress = simulator.calls[-1]["progress"]
        seen.append(progress)
        progress(50, 100)

    simulator.spoil = spoil
    status, _, err = cli()
    assert status == 0 and callable(seen[0])
    assert "icarus, lean datapath, 100 targets" in "".join(err)


# -- trajectories that fail ------------------------------------------------------------------------


def test_a_failure_names_the_bar_and_by_how_much(cli, simulator):
    def spoil(runs):
        runs[1].results[30, 0] += 2**20  # of circle
        runs[2].bit_mismatches, runs[2].first_mismatch = 5, "target 3, node c4"

    simulator.spoil = spoil
    status, out, err = cli("--trajectory", "all")
    assert status == 1
    assert err[0].startswith("run: circle fails: hand error ")
    assert "at target 30 is " in err[0] and "times its bar 2e-08" in err[0]
    assert err[-1] == ("run: figure_eight fails: 5 bits differ from the bit-true model; target 3, node c4")
    verdicts = {item["trajectory"]: item["passed"] for item in scores()}
    assert [name for name, passed in verdicts.items() if not passed] == ["circle", "figure_eight"]
    assert sum("FAIL" in line for line in out) == 2


def test_an_accuracy_of_ones_own_fails_honestly(cli):
    status, out, err = cli("--bar", "1e-12")
    assert status == 1 and "times its bar 1e-12" in err[0]
    assert sum(": FAIL: 1e-12 of the reach was asked for, " in line for line in out) == 2
    assert cli("--bar", "1e-4", "--datapath", "paper", "--trajectory", "punch")[0] == 0


def test_where_nothing_is_asked_the_table_says_so(cli):
    status, out, _ = cli("--datapath", "paper", "--width", "18")
    assert status == 0
    assert any("hand error / reach, largest" in line and "not asked" in line for line in out)
    assert any(line.startswith("pass: bits, flags and norms are right; accuracy was not asked for") for line in out)
    _, out, _ = cli("--datapath", "paper", "--trajectory", "all")
    unasked = sum(item["hand_error_bar"] is None for item in scores())
    said = f"14 of 14 pass, {unasked} of them by bits, flags and norms: accuracy was not asked for (-)"
    assert unasked > 3 and said in " ".join(line.strip() for line in out)


def test_a_simulation_that_breaks_off(cli, simulator, files):
    def spoil(runs):
        raise SimulationError("iverilog: not found")

    simulator.spoil = spoil
    status, out, err = cli()
    assert (status, out, err) == (1, [], ["run: iverilog: not found"])
    assert files() == []


# -- bad input -------------------------------------------------------------------------------------


def assert_refused(result, simulator, *parts):
    """Exit status 2, one line on stderr that holds all `parts`, nothing simulated, nothing written."""
    status, out, err = result
    assert (status, out, len(err)) == (2, [], 1), err
    for part in ("run: ", *parts):
        assert part in err[0]
    assert simulator.calls == []
    assert not Path("build").exists()


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        (b"", ["empty"]),
        (b"x,y,z\n", ["row 1", "no targets"]),
        (b"x,y\n1,2\n", ["row 1", "column z", "missing"]),
        (b"p,q,r\n1,2,3\n", ["row 1", "column p", "'p,q,r'", "no header"]),
        (b"x,y,z\n.1,.2,.3\n.1,two,.3\n", ["row 3", "column y", "'two'", "not a number"]),
        (b"x,y,z\n.1,.2,nan\n", ["row 2", "column z", "'nan'", "finite"]),
        (b"x,y,z\n.1,.2,.3\n\xef\xbc\x91,.2,.3\n", ["row 3", "column x"]),
        (b"x,y,z\ninf,.2,.3\n", ["row 2", "column x", "'inf'", "finite"]),
        (b"x,y,z\n.1,.2\n", ["row 2", "column z", "missing"]),
        (b"x,y,z\n.1,.2,.3,.4\n", ["row 2", "column 4", "'.4'", "too many"]),
        (b"x,y,z,d1\n.1,.2,.3,0\n", ["row 2", "column d1", "'0'", "positive"]),
        (b"x,y,z,d1,d2\r\n.1,.2,.3,1,-2\r\n", ["row 2", "column d2", "'-2'", "positive"]),
        (b"x,y,z\n.1,.2,.3\n.1,1e3,.3\n", ["row 3", "column y", "'1000.0'", "too far out", "(by default d1 and d2)"]),
        (b"x,y,z,d1\n.1,.2,.3,1\n.1,.2,.3,1e-12\n", ["row 3", "column d1", "'1e-12'", "too short"]),
        (b"x,y,z\n.1,.2,\xff\n", ["row 2", "not UTF-8"]),
    ],
)
def test_bad_files(cli, simulator, content, parts):
    Path("t.csv").write_bytes(content)
    assert_refused(cli("--trajectory", "t.csv"), simulator, "t.csv: ", *parts)


@contextlib.contextmanager
def not_root():
    """Root may write anywhere, and becomes somebody who may not."""
    user = os.geteuid()
    os.seteuid(user or 65534)
    try:
        yield
    finally:
        os.seteuid(user)


def test_out_without_permission(cli, simulator):
    Path.cwd().chmod(0o755)
    Path("locked").mkdir(mode=0o500)
    with not_root():
        outcome = cli("--out", "locked")
    assert_refused(outcome, simulator, "--out", "'locked'", "Permission denied")


@pytest.mark.parametrize("name", ["t.csv", "t.bvh"])
def test_a_file_that_may_not_be_read(cli, simulator, name):
    Path.cwd().chmod(0o755)
    Path(name).touch(mode=0o200)
    with not_root():
        outcome = cli("--trajectory", name)
    assert_refused(outcome, simulator, f"{name}: cannot be read: Permission denied")


def test_out_where_a_folder_has_the_name_of_a_result(cli, simulator, files):
    Path("o", "score.json").mkdir(parents=True)
    assert_refused(cli("--out", "o"), simulator, "--out", "'o/score.json' is a folder")
    assert files() == []


def test_out_that_fills_up(cli, monkeypatch):
    def full(path, *args):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(results, "write_score_json", full)
    status, _, err = cli()
    assert (status, err) == (2, ["run: cannot write 'build/run/score.json': No space left on device"])


def ctrl_c(runs):
    """What a terminal's Ctrl-C does, also where the tests run in the background and a shell has SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)


def test_ctrl_c(cli, simulator, files):
    Path("build/run").mkdir(parents=True)
    Path("build/run/score.json").write_text("old", encoding="utf-8")
    simulator.spoil = ctrl_c
    status, out, err = cli()
    assert (status, out, err) == (130, [], ["run: interrupted"])
    assert files() == ["build/run/score.json"]
    assert Path("build/run/score.json").read_text(encoding="utf-8") == "old"


@pytest.mark.parametrize(
    ("number", "status", "said"), [(signal.SIGTERM, 143, "terminated"), (signal.SIGHUP, 129, "hung up")]
)
def test_other_signals_end_it_in_the_same_way(cli, simulator, files, number, status, said):
    simulator.spoil = lambda runs: signal.raise_signal(number)
    before = signal.getsignal(number)
    assert cli("--out", "a/b", "--waves") == (status, [], [f"run: {said}"])
    assert signal.getsignal(number) is before
    assert files() == [] and not Path("a").exists(), "no folder that was made for nothing, no half a waveform"


def test_a_signal_that_is_ignored_stays_ignored(cli, simulator):
    """As under nohup."""
    simulator.spoil = lambda runs: signal.raise_signal(signal.SIGHUP)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert cli()[0] == 0
    finally:
        signal.signal(signal.SIGHUP, before)


def test_what_was_there_stays_when_a_run_breaks_off(cli, simulator, files):
    Path("o").mkdir()
    Path("o/waves.vcd").write_text("old", encoding="utf-8")

    def spoil(runs):
        assert sorted(path.name for path in Path("o").iterdir()) == [f".{os.getpid()}.waves.vcd", "waves.vcd"]
        raise SimulationError("vvp: killed")

    simulator.spoil = spoil
    assert cli("--out", "o", "--waves", "--datapath", "lean")[::2] == (1, ["run: vvp: killed"])
    assert files() == ["o/waves.vcd"] and Path("o/waves.vcd").read_text(encoding="utf-8") == "old"

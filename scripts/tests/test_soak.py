# SPDX-License-Identifier: Apache-2.0
"""Test the soaks: counts, stops, files of kept targets. The bit-true model replaces the simulator."""

import signal
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.io import stimuli
from model.io.flags import ARM_FLAGS, CORE_FLAGS, UNREACHABLE, expected_flags
from model.io.words import FIELDS
from scripts import check_proofs, soak, soak_memory
from tb.axi.instances import CORE, FOLDED, named
from tb.core import worst_targets
from tb.core.worst_targets import chunk
from tb.sim.job import answer
from tb.sim.simulate import SimulationError

HEAD = ",".join(worst_targets.COLUMNS)


@pytest.fixture
def cli(simulator, command, monkeypatch, tmp_path):
    """Return a function that runs the soak with chunks of 400 targets and a temporary regression list and page."""
    monkeypatch.setattr(soak, "CHUNK", 400)
    monkeypatch.setattr(chunk, "__defaults__", (400,))
    monkeypatch.setattr(worst_targets, "LIST", tmp_path / "kept.csv")
    monkeypatch.setattr(soak, "PAGE", tmp_path / "soak.md")
    return partial(command, soak.main, "--jobs", "1")


def test_targets_depend_on_seed_and_number_alone(cli, simulator):
    """A short run has the first targets of a long run; --from resumes with the same targets and target numbers."""
    whole = []
    for words in (["1200"], ["500"], ["700", "--from", "1", "--out", "later"]):
        assert cli("--targets", *words)[0] == 0
        whole.append(np.concatenate(simulator.words))
        simulator.calls.clear()
    assert np.array_equal(whole[1], whole[0][:500]) and np.array_equal(whole[2], whole[0][400:1100])
    numbers = [int(row.found.split()[-1]) for row in worst_targets.read(Path("later/hardest.csv"))]
    assert 400 <= min(numbers) and max(numbers) < 1100


def test_special_words(cli, simulator):
    last = stimuli.SPECIAL // 400
    status, out, err = cli("--special", "--from", str(last), "--width", "18")
    (words,) = simulator.words
    assert status == 0, err
    assert words.tolist() == stimuli.of_special(last * 400, 400, 18).tolist() and len(words) == 384
    assert "all targets of special words" in out[0]


def test_the_hardest_targets_are_written(cli, simulator, files):
    assert cli("--targets", "900")[::2] == (0, []) and files() == ["build/soak/hardest.csv"]
    words = np.unique(np.concatenate(simulator.words), axis=0)
    hand, norm = worst_targets.errors(words, fixed.run(words, 32, "lean").results, 32)
    reachable = np.flatnonzero(~np.isnan(hand))
    rows = {row.words for row in worst_targets.read(Path("build/soak/hardest.csv"))}
    for error in (hand, norm):
        worst = reachable[np.argsort(-error[reachable], kind="stable")[:5]]
        assert {tuple(target) for target in words[worst].tolist()} <= rows


def test_a_stopped_soak_reports_where_to_resume(cli, simulator, files):
    simulator.spoil = lambda run: len(simulator.calls) == 3 and signal.raise_signal(signal.SIGTERM)
    status, out, err = cli("--targets", "2000")
    assert (status, len(out), files()) == (143, 1, [])
    assert "800 targets" in err[0] and "--from 2" in err[0]


def test_poses_of_the_whole_arm(cli, simulator, files):
    """Chunks contain all branches, and poses with and without each flag. A wrong over-limit flag is a failure."""
    words = ["--datapath", "fold_arm", "--width", "20", "--targets", "800"]
    assert cli(*words)[::2] == (0, []) and files() == ["build/soak/hardest.csv"]
    poses = np.concatenate(simulator.words)
    flags = answer(poses, 20, "fold_arm").flags
    assert poses.shape == (800, 12) and set(poses[:, 11]) == {*range(8)}
    assert all(((flags & flag) != 0).any() and (flags & flag == 0).any() for flag in ARM_FLAGS.values())
    simulator.calls.clear()

    def spoil(run):
        if len(simulator.calls) == 2:
            run.flags[5] ^= ARM_FLAGS["over_6"]

    simulator.spoil = spoil
    status, _, err = cli(*words)
    assert status == 1 and "over_6" in "".join(err) and "hand_x=" in err[1]


def test_a_node_that_differs(cli, simulator):
    """A soak with a wrong node but correct results fails; --from repeats the chunk."""

    def spoil(run):
        if np.array_equal(simulator.words[-1], failing):
            first = "first difference: turn.c_plus of target 7 at clock 40: RTL 1 (1), model 0 (0)"
            run.bit_mismatches, run.first_mismatch = 2, first

    failing = chunk(1, 32, 1)
    simulator.spoil = spoil
    named = " ".join(f"{name}={word}" for name, word in zip(FIELDS, failing[7], strict=True))
    for options, calls in (("--targets", "800"), 2), (("--targets", "800", "--from", "1"), 3):
        status, _, err = cli(*options)
        assert (status, len(simulator.calls)) == (1, calls)
        assert err == [
            "soak: target 407: 2 bits differ from the bit-true model, results of 0 targets",
            f"soak: its words: {named}",
            "soak: first difference: turn.c_plus of target 407 at clock 40: RTL 1 (1), model 0 (0)",
            "soak: in chunk 1 of seed 1; the same options with --from 1 repeat it",
        ]


def test_results_are_compared_apart_from_the_scoreboard(cli, simulator):
    """A wrong result fails even if the scoreboard reports no difference; a lost result is an error."""
    simulator.spoil = lambda run: np.add.at(run.results, ([5, 9], 0), 1)
    status, _, err = cli("--targets", "400", "--sim", "icarus")
    assert status == 1 and err[0].startswith("soak: target 5: ") and err[0].endswith(" results of 2 targets")
    simulator.spoil = lambda run: setattr(run, "results", run.results[:-1])
    status, _, (err,) = cli("--targets", "400")
    assert status == 1 and "400 targets were sent, 399 results came back" in err


def turned(answer, words, width):
    """Change Qs, and thus the hand, of three reachable targets."""
    answer.results[np.flatnonzero(expected_flags(words, width) & UNREACHABLE == 0)[:3], 3] += 1 << 10


def stretched(answer, words, width):
    """Change Qe of a clamped target: the norm becomes wrong; hand errors of clamped targets are not judged."""
    answer.results[np.flatnonzero(expected_flags(words, width) & UNREACHABLE)[2], [4, 5]] += 60


FAULTS = [(turned, "hand error / reach "), (stretched, "abs(norm^2 - 1)")]
FAULTS += [(lambda answer, *_: np.bitwise_xor.at(answer.flags, 3, 4), "soak: target 3: flags ")]


@pytest.mark.parametrize(("change", "message"), FAULTS)
def test_rtl_and_model_that_are_wrong_alike(cli, monkeypatch, change, message):
    right = fixed.run

    def wrong(words, width, *others):
        answer = right(words, width, *others)
        change(answer, words, width)
        return answer

    monkeypatch.setattr(fixed, "run", wrong)
    status, _, err = cli("--targets", "400")
    assert status == 1 and message in err[0] and err[1].startswith("soak: its words: x="), err


def test_the_paper_datapath_has_no_tolerance_and_its_excess_is_reported(cli, simulator, monkeypatch):
    monkeypatch.setattr(tolerances, "predicted_error", lambda words, width, datapath: np.full(len(words), 1e-9))
    status, out, _ = cli("--targets", "400", "--datapath", "paper")
    (above,) = [line for line in out if "targets seen above their prediction" in line]
    assert status == 0 and int(above.split()[-1]) > 100


def test_keep(cli, simulator):
    """The page keeps the last run of each datapath, word length and seed; flag counts are those of `expected_flags`."""
    for words in (["800", "18"], ["400", "24"], ["400", "18", "--seed", "2"], ["400", "18"]):
        assert cli("--keep", "--targets", words[0], "--width", *words[1:])[0] == 0
    assert worst_targets.LIST.read_bytes() == Path("build/soak/hardest.csv").read_bytes()
    for group in worst_targets.groups(worst_targets.read(worst_targets.LIST)).values():
        errors = [row.hand_error for row in group]
        assert 5 < len(group) <= 20 and errors == sorted(errors, reverse=True)
    rows = soak.read_table(soak.PAGE, "datapath")
    assert [row[:3] for row in rows] == [["lean", "18", "seed 1"], ["lean", "18", "seed 2"], ["lean", "24", "seed 1"]]
    expected = expected_flags(simulator.words[-1], 18)
    assert int(rows[0][4]) == 400 == len(expected)
    assert [*map(int, rows[0][9:-1])] == [(expected & flag > 0).sum() for flag in CORE_FLAGS.values()]
    before = worst_targets.LIST.read_bytes()
    assert cli("--targets", "800")[0] == 0 and worst_targets.LIST.read_bytes() == before, "not kept"
    assert check_proofs.stale("soak.md") == []
    soak.PAGE.write_text(soak.PAGE.read_text().replace(rows[0][-1], "0" * 16, 1))
    assert len(check_proofs.stale("soak.md")) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{HEAD}\nlean,18,1,2,131072,4,5,6,,,,,,,,here\n", "18 bits"),
        (f"{HEAD}\narm,32,1,2,3,4,5,6,,,,,,,,here\n", "row 2: column tool: ''"),
        ("\xff", "CSV"),
    ],
)
def test_an_unusable_list_is_not_overwritten(cli, simulator, text, message):
    worst_targets.LIST.write_text(text, encoding="latin1")
    status, out, (err,) = cli("--targets", "400", "--keep")
    assert (status, out, simulator.calls) == (2, [], []) and message in err
    assert worst_targets.LIST.read_text(encoding="latin1") == text


@pytest.mark.parametrize("datapath", soak.SEARCHED)
def test_later_rounds_find_worse_targets(cli, monkeypatch, datapath):
    for name, value in {"KEPT": 100, "REGIONS": (), "RESTART": 2, "FRESH": 2000, "GENERATIONS": 2}.items():
        monkeypatch.setattr(soak, name, value)
    worst_targets.LIST.write_text(worst_targets.text([]))
    first, out, _ = cli("--worst", "1", "--width", "16", "--datapath", datapath)
    monkeypatch.setattr(tolerances, "sought", lambda width: 1e-5)
    monkeypatch.setattr(tolerances, "ARM_ULPS", (10.0, 1.0))
    later, more, _ = cli("--worst", "4", "--width", "16", "--datapath", datapath, "--keep")
    errors, worse = ([float(line.split(": ")[1].split()[0]) for line in lines] for lines in (out, more))
    assert (first, later) == (0, 1) and len(errors) == len(soak.SEARCHED[datapath])
    assert all(b > a for a, b in zip(errors, worse, strict=True))
    rows = worst_targets.read(worst_targets.LIST)
    last = tuple(map(int, more[-1].split(": ")[-1].split(", ")))
    assert (rows[0].datapath, rows[0].words[: len(last)]) == (datapath, last)


def test_jobs_of_memory_are_counted_and_a_failing_piece_is_replayed(command, monkeypatch, tmp_path):
    ran = []

    def run_in_process(modules, sim, env, **options):
        ran.append((env["IK_AXI_SEED"], options["parameters"], env.get("IK_AXI_CORE")))
        if env["IK_AXI_SEED"] == "7000003":
            raise SimulationError("result 3 of 5 differs")
        Path(env["IK_AXI_DONE"]).write_text("40 900\n60 1100\n")

    monkeypatch.setattr(soak_memory, "run_in_process", run_in_process)
    monkeypatch.setattr(soak_memory, "ECHO_PLACE", tmp_path)
    pieces = len(CORE + FOLDED) + 1
    status, out, _ = command(soak_memory.main, "--jobs", f"{100 * pieces - 99}", "--seed", "3", "--processes", "1")
    assert status == 0 and f"{pieces}00 jobs, {2000 * pieces} targets, seed 3" in out[-1]
    assert len({seed for seed, *_ in ran}) == pieces
    assert [instance for _, *instance in ran] == [*([p, None] for p in CORE + FOLDED), [ran[-1][1], "echo"]]
    ran.clear()
    status, out, err = command(soak_memory.main, "--jobs", "1000", "--seed", "7", "--processes", "1")
    assert (status, out, len(ran)) == (1, [], 3)
    assert f"seed 7, piece 2, core {named(CORE[2])}:" in err[0] and "result 3 of 5 differs" in err
    again = err[-1].partition("scripts.soak_memory ")[2].split()
    assert command(soak_memory.main, *again, "--processes", "1")[0] == 1
    assert [seed for seed, *_ in ran[3:]] == ["7000003"]

# SPDX-License-Identifier: Apache-2.0
"""Tests of the soak: its counts, stops, resumption and kept files.

The bit-true model replaces the simulator, so no build is needed.
"""

import signal
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.io import stimuli
from model.io.flags import FLAGS, UNREACHABLE, expected_flags
from scripts import check_proofs, soak
from tb.core import hardest, random_targets
from tb.sim import native_run
from tb.sim.simulate import Run, SimulationError

MISMATCH = (
    "first difference: turn.c_plus (L44) of target 7 at clock 40: RTL 1 (1), model 0 (0)\n"
    "            then: turn.s_plus of target 7 at clock 41: RTL 1 (1), model 0 (0)"
)


class FakeCore:
    """The bit-true model as simulation; `spoil` may change its run, `calls` records its words."""

    def __init__(self):
        self.calls = []
        self.spoil = lambda runs: None

    def run(self, core, words):
        self.calls.append({"words": words, "simulator": core.sim, "datapath": core.datapath, "width": core.width})
        answer = fixed.run(words, core.width, core.datapath)
        runs = [Run(answer.results.copy(), answer.flags.copy(), 80, 80 + len(words), 0, None)]
        self.spoil(runs)
        return runs[0], answer.results, answer.flags

    @property
    def targets(self):
        return [len(call["words"]) for call in self.calls]


@pytest.fixture
def simulator(monkeypatch, tmp_path):
    """Install the fake simulation, chunks of 400 targets and a private regression list."""
    fake = FakeCore()
    monkeypatch.setattr(random_targets.Core, "run", lambda core, words: fake.run(core, words))
    monkeypatch.setattr(native_run, "program", lambda datapath, width: None)
    monkeypatch.setattr(soak, "CHUNK", 400)
    monkeypatch.setattr(random_targets.chunk, "__defaults__", (400,))
    monkeypatch.setattr(hardest, "LIST", tmp_path / "kept.csv")
    monkeypatch.setattr(soak, "FIGURES", tmp_path / "soak.json")
    monkeypatch.setattr(soak, "PAGE", tmp_path / "soak.md")
    return fake


@pytest.fixture
def spoiled_model(monkeypatch):
    """Return a function that makes model and RTL wrong alike: change(answer, words, width)."""
    right = fixed.run

    def spoil(change):
        def wrong(words, width, datapath):
            answer = right(words, width, datapath)
            change(answer, words, width)
            return answer

        monkeypatch.setattr(fixed, "run", wrong)

    return spoil


@pytest.fixture
def cli(simulator, command):
    return partial(command, soak.main, "--jobs", "1")


# -- a soak that goes well ---------------------------------------------------------------------------------------------


def test_fewer_targets_are_the_first_of_more(cli, simulator):
    cli("--targets", "1000")
    whole = np.concatenate([call["words"] for call in simulator.calls])
    assert simulator.targets == [400, 400, 200]
    simulator.calls.clear()
    cli("--targets", "500")
    some = np.concatenate([call["words"] for call in simulator.calls])
    assert np.array_equal(whole[:500], some)


def test_special_words(cli, simulator):
    """--special runs all its targets, from any chunk on; it excludes a number of targets and a seed."""
    last = stimuli.SPECIAL // 400
    status, out, err = cli("--special", "--from", str(last), "--width", "18")
    (call,) = simulator.calls
    assert status == 0, err
    assert call["words"].tolist() == stimuli.of_special(last * 400, 400, 18).tolist() and len(call["words"]) == 384
    assert "all targets of special words" in out[0]
    for words in (("--seed", "1"), ("--targets", "5"), ("--from", str(last + 1)), ("--again", "x.csv")):
        status, _, err = cli("--special", *words)
        assert status == 2 and "--" in err[-1], words


def test_the_hardest_targets_are_written(cli, simulator, files):
    status, _, err = cli("--targets", "900")
    assert (status, err, files()) == (0, [], ["build/soak/hardest.csv"])
    words = np.unique(np.concatenate([call["words"] for call in simulator.calls]), axis=0)
    hand, norm = hardest.errors(words, fixed.run(words, 32, "lean").results, 32)
    reachable = np.flatnonzero(~np.isnan(hand))
    rows = {row.words for row in hardest.read(Path("build/soak/hardest.csv"))}
    for error in (hand, norm):
        worst = reachable[np.argsort(-error[reachable], kind="stable")[:5]]
        assert {tuple(target) for target in words[worst].tolist()} <= rows


# -- resuming ----------------------------------------------------------------------------------------------------------


def test_from_a_chunk(cli, simulator):
    """Targets and their numbers are the same as in one run."""
    cli("--targets", "1200")
    whole = simulator.calls[:]
    status, out, _ = cli("--targets", "700", "--from", "1", "--out", "later")
    assert status == 0 and "700 targets from chunk 1" in out[0]
    later = simulator.calls[len(whole) :]
    assert np.array_equal(later[0]["words"], whole[1]["words"])
    assert np.array_equal(later[1]["words"], whole[2]["words"][:300])
    numbers = [int(row.found.split()[-1]) for row in hardest.read(Path("later/hardest.csv"))]
    assert 400 <= min(numbers) and max(numbers) < 1100


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
@pytest.mark.usefixtures("interruptible")
def test_a_signal_stops_the_soak_and_it_can_be_resumed(cli, simulator, number, status, files):
    """A stopped soak reports where to resume and restores the handlers."""

    def spoil(runs):
        if len(simulator.calls) == 3:
            signal.raise_signal(number)

    simulator.spoil = spoil
    before = signal.getsignal(number)
    ended, out, err = cli("--targets", "2000")
    assert signal.getsignal(number) is before
    assert (ended, len(out)) == (status, 1)
    assert err == ["soak: stopped; 800 targets passed, those before chunk 2; --from 2 resumes"]
    assert files() == []


def test_hardest_targets_of_other_kinds_are_kept_apart(cli, files):
    for extra in ([], ["--width", "18"], ["--seed", "7"], ["--datapath", "paper"]):
        assert cli("--targets", "400", *extra)[0] == 0
    assert files() == ["build/soak/hardest.csv"]
    groups = hardest.groups(hardest.read(Path("build/soak/hardest.csv")))
    assert set(groups) == {("lean", 18), ("lean", 32), ("paper", 32)}
    assert {row.found.split()[1] for row in groups["lean", 32]} == {"1", "7"}, "of both seeds"


# -- checks that fail --------------------------------------------------------------------------------------------------


def fails(cli, simulator, spoil, *arguments, chunk=2):
    """Run with chunk `chunk` spoiled; return messages and the rows of failing.csv. The run must stop at the chunk."""
    simulator.spoil = lambda runs: spoil(runs[0]) if len(simulator.calls) == chunk else None
    status, out, err = cli("--targets", "1200", *arguments)
    messages = [line for line in err if "/s, " not in line]
    assert status == 1 and len(out) == 1
    assert len(simulator.calls) == chunk, "it went on"
    return messages, hardest.read(Path("build/soak/failing.csv"))


def test_a_node_that_differs(cli, simulator):
    """The scoreboard reports a difference although the results are correct."""

    def spoil(run):
        run.bit_mismatches, run.first_mismatch = 2, MISMATCH

    messages, rows = fails(cli, simulator, spoil)
    words = simulator.calls[1]["words"][7].tolist()
    assert messages == [
        "soak: target 407 in chunk 1 of seed 1: 2 bits differ from the bit-true model, results of 0 targets",
        "soak: its words: " + " ".join(f"{k}={v}" for k, v in zip("x y z phi d1 d2".split(), words, strict=True)),
        "soak: first difference: turn.c_plus (L44) of target 407 at clock 40: RTL 1 (1), model 0 (0)",
        "soak:             then: turn.s_plus of target 407 at clock 41: RTL 1 (1), model 0 (0)",
        "soak: 1 failing targets in build/soak/failing.csv; to rerun them: --again build/soak/failing.csv",
    ]
    assert [(row.words, row.found) for row in rows] == [(tuple(words), "seed 1 target 407")]


def test_a_result_that_differs_though_nobody_said_so(cli, simulator):
    """Results are compared again, to detect a scoreboard that compares nothing."""

    def spoil(run):
        run.results[[5, 9], 0] ^= 1

    messages, rows = fails(cli, simulator, spoil)
    assert messages[0].startswith(
        "soak: target 405 in chunk 1 of seed 1: 0 bits differ from the bit-true model, results"
    )
    assert [row.found for row in rows] == ["seed 1 target 405", "seed 1 target 409"]


def test_a_wrong_flag(cli, spoiled_model):
    """A flag that is wrong in RTL and model alike is found."""

    def change(answer, words, width):
        answer.flags[3] ^= 4

    spoiled_model(change)
    status, _, err = cli("--targets", "400")
    assert status == 1 and "soak: target 3 in chunk 0 of seed 1: flags " in err[0] and "(1 targets)" in err[0]


def turn(answer, rows, angle):
    """Rotate the shoulder quaternion of targets about the x axis."""
    qs = answer.results[rows, :4].astype(float)
    w, i, j, k = qs.T
    c, s = np.cos(angle / 2), np.sin(angle / 2)
    turned = np.stack([c * w - s * i, c * i + s * w, c * j - s * k, c * k + s * j], axis=1)
    answer.results[rows, :4] = np.rint(turned).astype(np.int64)


@pytest.mark.parametrize(("width", "angle"), [(32, 1e-6), (18, 1e-2), (20, 1e-2)])
def test_a_hand_that_is_too_far_off(cli, spoiled_model, width, angle):
    """The hand error itself is judged, although model and RTL agree."""

    def change(answer, words, width):
        turn(answer, np.flatnonzero(expected_flags(words, width) & UNREACHABLE == 0)[:3], angle)

    spoiled_model(change)
    status, _, err = cli("--targets", "400", "--width", str(width))
    assert status == 1, err
    assert "in chunk 0 of seed 1: hand error / reach " in err[0] and "is above its tolerance" in err[0]
    assert "targets)" in err[0] and err[1].startswith("soak: its words: x=")
    rows = hardest.read(Path("build/soak/failing.csv"))
    assert rows and all(row.hand_error > tolerances.lean(width) for row in rows)
    assert rows[0].hand_error == max(row.hand_error for row in rows)


def test_the_paper_is_held_to_no_tolerance_and_its_excess_is_said(cli, simulator, monkeypatch):
    monkeypatch.setattr(tolerances, "hand_bar", lambda words, width, datapath: np.full(len(words), 1e-9))
    status, out, _ = cli("--targets", "400", "--datapath", "paper")
    assert status == 0
    (above,) = [line for line in out if "targets seen above their prediction" in line]
    assert int(above.split()[-1]) > 100


def test_quaternions_that_are_not_of_unit_length(cli, spoiled_model):
    """The norm of Qe is checked, which the hand of a clamped target does not reveal."""

    def change(answer, words, width):
        clamped = np.flatnonzero(expected_flags(words, width) & UNREACHABLE)
        answer.results[clamped[2], [4, 5]] += 60

    spoiled_model(change)
    status, _, err = cli("--targets", "400")
    assert status == 1
    assert "abs(norm^2 - 1)" in err[0] and err[0].endswith("(1 targets)")
    (row,) = hardest.read(Path("build/soak/failing.csv"))
    assert row.hand_error is None


def test_results_that_are_lost(cli, simulator):
    def spoil(runs):
        runs[0].results = runs[0].results[:-1]

    simulator.spoil = spoil
    assert cli("--targets", "400")[::2] == (1, ["soak: 400 targets were sent, 399 results came back"])


def test_a_simulation_that_breaks_off(cli, simulator):
    def spoil(runs):
        if len(simulator.calls) == 2:
            raise SimulationError("verilator: not found")

    simulator.spoil = spoil
    status, out, err = cli("--targets", "1200")
    assert (status, err) == (1, ["soak: verilator: not found"])


# -- again -------------------------------------------------------------------------------------------------------------


def test_failing_targets_run_again(cli, simulator):
    def spoil(run):
        run.results[[5, 9], 0] ^= 1

    _, rows = fails(cli, simulator, spoil)
    status, out, err = cli("--again", "build/soak/failing.csv")
    assert (status, err) == (0, [])
    assert np.array_equal(simulator.calls[-1]["words"], [row.words for row in rows])
    words = hardest.array(rows)
    error = np.nanmax(hardest.errors(words, fixed.run(words, 32, "lean").results, 32)[0])
    assert out == [f"lean datapath, 32 bits, verilator: 2 targets, largest hand error / reach {error:.3e}: pass"]
    simulator.spoil = lambda runs: spoil_first(runs[0])
    status, out, err = cli("--again", "build/soak/failing.csv", "--sim", "icarus")
    assert status == 1 and out[0].endswith("FAIL") and err[0].startswith("soak: seed 1 target 405: ")
    assert simulator.calls[-1]["simulator"] == "icarus"


def spoil_first(run):
    run.results[0, 0] ^= 1


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (b"", "row 1"),
        (b"x,y,z\n", "row 1"),
        (b"HEAD\n", "no targets"),
        (b"HEAD\nlean,32,1,2,3,4,5,0.1,here\n", "row 2: 9 columns instead of 10"),
        (b"HEAD\nlean,32,1,2,3,4,5,6,0.1,here\nmean,32,1,2,3,4,5,6,0.1,here\n", "row 3: unknown datapath 'mean'"),
        (b"HEAD\nlean,33,1,2,3,4,5,6,,here\n", "row 2: unknown width 33"),
        (b"HEAD\nlean,18,1,2,131072,4,5,6,,here\n", "row 2: a word does not fit 18 bits"),
        (b"HEAD\nlean,18,1,2,1.5,4,5,6,,here\n", "row 2: "),
        (b"\xff", "not a CSV file"),
    ],
)
def test_lists_that_are_of_no_use(cli, simulator, content, part):
    Path("list.csv").write_bytes(content.replace(b"HEAD", ",".join(hardest.COLUMNS).encode()))
    status, out, err = cli("--again", "list.csv")
    assert (status, out, len(err), simulator.calls) == (2, [], 1, []), err
    assert err[0].startswith("soak: list.csv: ") and part in err[0]


# -- the regression list -----------------------------------------------------------------------------------------------


def test_keep(cli, simulator):
    status, out, _ = cli("--targets", "400", "--keep")
    assert status == 0 and out[-3:] == ["wrote build/soak/hardest.csv", f"wrote {hardest.LIST}", "wrote soak.md"]
    kept = hardest.read(hardest.LIST)
    assert hardest.LIST.read_bytes() == Path("build/soak/hardest.csv").read_bytes()
    assert 10 < len(kept) <= 20
    assert [row.hand_error for row in kept] == sorted((row.hand_error for row in kept), reverse=True)
    before = hardest.LIST.read_bytes()
    assert cli("--targets", "400", "--keep")[0] == 0
    assert hardest.LIST.read_bytes() == before, "the same once more changes nothing"
    cli("--targets", "800")
    assert hardest.LIST.read_bytes() == before, "nothing is kept unasked"


def test_keep_writes_a_row_of_what_was_found(cli, simulator):
    """The last run of each datapath, word length and kind of targets is kept; flag counts match exact integers."""
    assert cli("--targets", "800", "--width", "18", "--keep")[0] == 0
    assert cli("--targets", "400", "--width", "24", "--keep")[0] == 0
    assert cli("--targets", "400", "--width", "18", "--seed", "2", "--keep")[0] == 0
    assert cli("--targets", "400", "--width", "18", "--keep")[0] == 0
    rows = soak.recorded()
    assert [*rows] == ["lean, 18 bits, seed 1", "lean, 18 bits, seed 2", "lean, 24 bits, seed 1"]
    row, words = rows["lean, 18 bits, seed 1"], simulator.calls[-1]["words"]
    owed = expected_flags(words, 18)
    assert row["targets"] == 400 == len(words)
    assert row["flags"] == {flag.name: n for flag in FLAGS if (n := int((owed & flag.bit > 0).sum()))}
    assert sum(row["flags"].values()) > 100
    page = soak.PAGE.read_text()
    assert all(f" {count} |" in page for count in row["flags"].values())
    assert check_proofs.PAGES[-1].stale() == []
    soak.FIGURES.write_text(soak.FIGURES.read_text().replace(row["code"], "0" * 16, 1))
    assert len(check_proofs.PAGES[-1].stale()) == 1


@pytest.mark.parametrize("file", ["hardest", "figures"])
def test_keep_with_a_list_that_is_of_no_use(cli, simulator, file):
    kept = hardest.LIST if file == "hardest" else soak.FIGURES
    kept.write_text("old")
    status, out, err = cli("--targets", "400", "--keep")
    assert (status, out, len(err), simulator.calls) == (2, [], 1, [])
    assert kept.read_text() == "old"


def test_out_where_a_folder_has_the_name_of_a_list(cli, simulator):
    Path("o", "failing.csv").mkdir(parents=True)
    status, _, err = cli("--out", "o")
    assert (status, simulator.calls) == (2, []) and "'o/failing.csv' is a folder" in err[0]


def test_a_disk_that_fills_up(cli, monkeypatch):
    def full(path, text):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(soak, "write_atomically", full)
    status, _, err = cli("--targets", "400")
    assert (status, err) == (2, ["soak: cannot read or write 'build/soak/hardest.csv': No space left on device"])


# -- the worst targets -------------------------------------------------------------------------------------------------


def test_later_rounds_find_worse_targets(cli, monkeypatch):
    found = [cli("--worst", rounds, "--width", "16") for rounds in ("1", "30")]
    errors = [float(out[0].split(": ")[1].split()[0]) for _, out, _ in found]
    assert errors[1] > errors[0] and found[0][0] == 0
    monkeypatch.setattr(tolerances, "sought", lambda width: 1e-5)
    assert cli("--worst", "1", "--width", "16")[0] == 1

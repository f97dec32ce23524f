# SPDX-License-Identifier: Apache-2.0
"""scripts/exhaustive.py and its page without a simulator: the page, what it is of, the command line."""

import os
import re
import signal
import subprocess
import time

import pytest

from scripts import exhaustive
from scripts.console import Meter
from scripts.exhaustive import FULL, SMALL, Result, main
from scripts.pages.tables import table
from tb.sim.env import ROOT


@pytest.fixture(scope="module")
def text():
    return exhaustive.PAGE.read_text()


# -- the page --------------------------------------------------------------------------------------


def test_page_lists_every_case_and_no_failure(text):
    rows = [(row[0], row[2], row[5], row[6]) for row in table(text, "case")]
    assert rows == [(case.name, case.words, str(case.vectors), "0") for case in FULL], "run make exhaustive"


def test_page_names_command_tool_and_date(text):
    assert "`make exhaustive`" in text and re.search(r"on \d{4}-\d\d-\d\d, with Verilator [\d.]+; \d+ processes", text)


def test_page_has_the_present_words(text):
    """All but figures and digests is what the script would write now."""
    results = [Result(case, case.vectors) for case in FULL]
    now = exhaustive.page(results, 2, 1.0, exhaustive.digests())

    def plain(page):
        return re.sub(r"\n\| .*|\d{4}-\d\d-\d\d|\d+ processes,|\d+ s\.|Verilator [\d.]+", "", page)

    assert plain(text) == plain(now), "run make exhaustive"


# -- the cases -------------------------------------------------------------------------------------


@pytest.mark.parametrize("cases", [FULL, SMALL], ids=["full", "small"])
def test_cases(cases):
    assert len({case.name for case in cases}) == len(cases)
    assert {case.module for case in cases} == {"ik_div", "ik_root", "ik_rsqrt"}
    for case in cases:
        assert case.clocks == case.parameters.get("LAT", case.clocks) > 0
        assert {name for name in ("NW", "DW", "F") if name in case.parameters}


def test_full_cases_are_what_the_page_promises():
    """Rows for a chip, and all 2^32 of the longest words."""
    assert all(case.parameters.get("DIGIT", 1) == 1 for case in FULL)
    assert [case.bits for case in FULL if case.module != "ik_rsqrt"] == [32, 32, 32]


# -- the command line ------------------------------------------------------------------------------


@pytest.fixture
def pretend(monkeypatch, tmp_path):
    """No simulator: each piece is good, but for the cases in the list that is returned."""
    wrong = []

    def piece(case, path, first, end):
        bad = case.name in wrong
        return Result(case, end - first, int(bad), 0, first=f"{first} n=1: q=2 expected, q=3 seen" if bad else "")

    monkeypatch.setattr(exhaustive, "program", lambda case: tmp_path / case.name)
    monkeypatch.setattr(exhaustive, "piece", piece)
    monkeypatch.setattr(exhaustive, "ROOT", tmp_path)
    monkeypatch.setattr(exhaustive, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(exhaustive, "digests", lambda: {"rtl/a.v": "0123"})
    return wrong


def test_full_run_writes_the_page(pretend, capsys):
    assert main([]) == 0
    page = exhaustive.PAGE.read_text()
    assert [row[0] for row in table(page, "case")] == [case.name for case in FULL]
    assert table(page, "code") == [["rtl/a.v", "0123"]]
    said = capsys.readouterr().out
    assert f"{len(FULL)} of {len(FULL)} cases without a failure" in said and "wrote page.md" in said


@pytest.mark.parametrize(
    ("options", "names"),
    [
        (["--small"], [case.name for case in SMALL]),
        (["--only", "div", "--only", "root"], ["div_16_0", "div_16_14", "root_32"]),
        (["--small", "--only", "div_8_0"], ["div_8_0"]),
    ],
)
def test_other_runs_write_no_page(pretend, options, names, capsys):
    assert main(options) == 0
    assert not exhaustive.PAGE.exists()
    assert [line.split()[1] for line in capsys.readouterr().out.splitlines()[:-1]] == names


def test_a_failure_is_status_1_and_no_page(pretend, capsys):
    pretend.append("root_32")
    assert main([]) == 1
    assert not exhaustive.PAGE.exists()
    out, err = capsys.readouterr()
    assert "FAIL root_32 " in out and f"{len(FULL) - 1} of {len(FULL)} cases without a failure" in out
    assert "exhaustive: root_32: vector 0 n=1: q=2 expected, q=3 seen\n" in err


def test_sources_that_change_meanwhile_are_status_1_and_no_page(pretend, monkeypatch, capsys):
    changing = iter([{"rtl/a.v": "0123"}, {"rtl/a.v": "4567"}])
    monkeypatch.setattr(exhaustive, "digests", lambda: next(changing))
    assert main([]) == 1
    assert not exhaustive.PAGE.exists() and "sources were changed" in capsys.readouterr().err


def test_page_that_cannot_be_written_is_one_line_and_status_2(pretend, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(exhaustive, "PAGE", tmp_path / "no folder" / "page.md")
    assert main([]) == 2
    assert capsys.readouterr().err.splitlines()[-1] == (
        f"exhaustive: cannot write {str(exhaustive.PAGE)!r}: No such file or directory"
    )


def test_program_that_cannot_be_built_is_one_line_and_status_2(pretend, monkeypatch, capsys):
    def program(case):
        raise RuntimeError("ik_div: - something\n%Error: rtl/a.v:3: no such thing\nmore")

    monkeypatch.setattr(exhaustive, "program", program)
    assert main(["--small"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert said[-1] == "exhaustive: cannot build a program: %Error: rtl/a.v:3: no such thing"


def test_list(capsys):
    assert main(["--list", "--only", "root"]) == 0
    assert capsys.readouterr().out.startswith("root_32              ik_root    4294967296 vectors  NW=33 SH=29 ")


@pytest.mark.parametrize(
    ("rc", "out"),
    [(0, "10 1 0\nx"), (1, "10 0 0\n"), (0, "9 0 0\n"), (-9, ""), (0, "nonsense")],
    ids=["hidden", "no failure", "lost", "killed", "nonsense"],
)
def test_a_piece_that_breaks_off_is_no_success(monkeypatch, rc, out):
    done = subprocess.CompletedProcess([], rc, out, "")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: done)
    with pytest.raises(exhaustive.SimulationError, match="vectors 0 to 9 broke off"):
        exhaustive.piece(SMALL[0], ROOT / "x", 0, 10)


def test_interrupt_leaves_the_other_pieces(monkeypatch, pretend, interruptible):
    """Ctrl-C in the middle: status 130, and no piece is begun after it."""
    begun = []

    def piece(case, path, first, end):
        begun.append(first)
        if len(begun) == 2:
            os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.05)
        return Result(case, end - first)

    monkeypatch.setattr(exhaustive, "piece", piece)
    assert main(["--jobs", "1"]) == 130
    assert len(begun) < 10 and not exhaustive.PAGE.exists()


def test_progress_is_over_all_cases(pretend, capsys):
    """A case's first failure is told at once, and once."""
    seen = []

    class Seen(Meter):
        def __call__(self, *said):
            seen.append(said)

    watch = exhaustive.Watch(Seen("exhaustive", sum(case.vectors for case in FULL)))
    half, all_ = FULL[0].vectors // 2, FULL[0].vectors
    watch.so_far(Result(FULL[0], half, failures=1, first="7: 1 2"))
    watch.so_far(Result(FULL[0], all_, failures=2, first="7: 1 2"))
    watch.so_far(Result(FULL[1], 5))
    assert seen == [(half, FULL[0].name), (all_, FULL[0].name), (all_ + 5, FULL[1].name)]
    assert capsys.readouterr().err == f"exhaustive: {FULL[0].name}: vector 7: 1 2\n"

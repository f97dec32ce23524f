# SPDX-License-Identifier: Apache-2.0
"""What tries to notice mutants: it is content with the RTL, notices a bug, and says what it cannot build."""

import shutil

import pytest

from tb.mutation import killers, mutant
from tb.mutation.killers import BuildError, Killer, killers_of, linted, names, units
from tb.mutation.mutant import files
from tb.sim.env import ROOT, simulator
from tb.sim.mutants import Bug, copy_rtl

if simulator() != "icarus":
    pytest.skip("mutants are run by Icarus", allow_module_level=True)

BUGS = {
    "nodes lean 18 250": Bug("sign", "rtl/lean/ik_lean_turn.v", "c_plus <= cc - ss;", "c_plus <= ss;", "turn.c_plus"),
    "nodes fold 20 50": Bug("one", "rtl/fold/ik_fold_norm.v", "MOST = W - 1;", "MOST = W - 2;", "direction.e_rho"),
    "nodes paper 18 250": Bug("quarter", "rtl/paper/ik_guard.v", "QUARTER = {3'b001", "QUARTER = {3'b010", "guard.d_1"),
    "unit ik_lzc few": Bug("room", "rtl/lib/ik_lzc.v", "room = W - 1;", "room = W;", "minus_ones"),
    "unit ik_fifo few": Bug("load", "rtl/lib/ik_fifo.v", "!m_valid || m_ready", "m_ready", ""),
}  # fmt: skip
"""What notices a bug -> the bug, and what it says."""


@pytest.fixture
def right(monkeypatch, tmp_path):
    """Nothing is known of the RTL yet, and what is learned is not kept."""
    monkeypatch.setattr(killers, "BUILD", tmp_path / "kept")


def killer(name, file):
    return next(one for one in killers_of(file) if one.name == name)


@pytest.mark.sim
@pytest.mark.cost(40)
@pytest.mark.parametrize("name", BUGS)
def test_the_rtl_survives_and_a_bug_does_not(name, tmp_path, right):
    bug = BUGS[name]
    notices = killer(name, bug.file)
    place = copy_rtl(tmp_path)
    assert notices.judged(place) == (False, None)
    assert notices.ran(place, 600)[0] is None
    differs, why = notices.judged(copy_rtl(tmp_path, bug))
    assert differs and bug.fails in why


@pytest.mark.sim
@pytest.mark.slow
def test_lint_warns_of_a_bit_more_and_not_of_the_rtl(tmp_path):
    name = "rtl/axi/ik_axi_result.v"
    file = copy_rtl(tmp_path) / name
    assert linted(tmp_path, name) == ""
    file.write_text(file.read_text().replace("[      31:0] index", "[      32:0] index"))
    assert "WIDTHTRUNC" in linted(tmp_path, name)


def test_lint_sees_the_mutant_alone(monkeypatch):
    """Not what a bench has put in the place of a module."""

    def bench(place, seconds):
        (place / "rtl" / "ik_axis.v").unlink()
        return None, ""

    monkeypatch.setattr(Killer, "right", lambda self: {"program": "", "measured": "", "seconds": 0})
    notices = Killer("echo", lambda place: "another", bench)
    monkeypatch.setattr(mutant, "first_of", lambda file: [notices])
    monkeypatch.setattr(mutant, "killers_of", lambda file: [notices, notices])
    monkeypatch.setattr(mutant, "linted", lambda place, file: "warns" * (place / "rtl" / "ik_axis.v").exists())
    changed = next(mutant.order("rtl/lib/ik_lzc.v", 1))
    assert mutant.judge(changed).killer == killers.LINT


@pytest.mark.sim
def test_the_same_program_is_no_change(tmp_path, right):
    notices = killer("nodes lean 18 250", "rtl/lean/ik_lean_turn.v")
    file = copy_rtl(tmp_path) / "rtl" / "lean" / "ik_lean_turn.v"
    file.write_text(file.read_text().replace("cc - ss", "(cc) - (ss)"))
    assert notices.judged(tmp_path) == (False, None)
    file.write_text(file.read_text().replace("module ik_lean_turn", "modul ik_lean_turn"))
    with pytest.raises(BuildError):
        notices.judged(tmp_path)


def test_another_latency_is_noticed_and_a_wrong_rtl_is_said(right):
    notices = Killer("some", lambda place: place.name, lambda *_: (None, "latency 3"))
    assert notices.judged(ROOT / "other") == (True, None)
    late = Killer("some", notices.elaborated, lambda *_: (None, "latency 4"))
    assert late.judged(ROOT / "other")[1] == "latency or clocks: latency 4 instead of latency 3"
    with pytest.raises(AssertionError, match="the RTL itself is wrong: no"):
        Killer("wrong", notices.elaborated, lambda *_: ("no", "")).right()


def test_who_may_notice_what():
    """Every file has benches; those of a datapath are of the files that it is made of, its own bench is a module's."""
    assert all(killers_of(file) for file in files())
    of = {file: {one.name.split()[1] for one in killers_of(file)} for file in files()}
    assert of["rtl/lean/ik_lean_turn.v"] == {"lean", "lean25", "lean16"}
    assert of["rtl/cores/ik_div_row.v"] == {"paper", "short", "ik_div"}
    assert of["rtl/axi/ik_axi_job.v"] == {"3", "1"}
    assert {"lean", "fold", "paper"} < of["rtl/ik_axis.v"] and "lean" in of["rtl/fold/ik_fold.v"]
    with_bench = [file for file in files() if file.startswith(("rtl/lib/", "rtl/cores/"))]
    assert all(any(file in names(top) for top in units()) for file in with_bench)


def test_a_simulation_that_does_not_end_is_ended(tmp_path):
    shutil.copytree(ROOT / "rtl", tmp_path / "rtl")
    assert killers.finished(["sleep", "60"], tmp_path, 0.2) == (None, "")

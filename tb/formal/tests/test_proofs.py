# SPDX-License-Identifier: Apache-2.0
"""tb/formal/proofs.py and what runs it: the .sby files, the questions, and one proof of a few seconds."""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.nodes import Latency
from tb.formal import prove, steps
from tb.formal.proofs import AXIS, FIFO, PROOFS, Proof
from tb.formal.steps import Steps, no_circle
from tb.formal.tools import missing
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl

NAMES = [proof.name for proof in PROOFS]


@pytest.mark.parametrize("proof", PROOFS, ids=NAMES)
def test_definition(proof):
    """The sources are there, each bug can be seeded and breaks something that exists, and nothing goes in circles."""
    assert [path for path in proof.files if not path.exists()] == []
    assert proof.has("formula") or proof.engine == "gates"
    no_circle(proof.after)
    properties = "".join(path.read_text() for path in proof.files if "tb/formal" in str(path))
    labels = set(re.findall(r"(\w+) : (?:assert|assume)", properties))
    wanted = {*proof.says, *proof.uses, *proof.after, *(bug.fails for bug in proof.bugs)}
    wanted |= {n.rstrip("*$") for names in (*proof.uses.values(), *proof.after.values()) for n in names}
    assert proof.engine == "gates" or wanted - labels == set()
    assert proof.bugs, "a proof has to be seen failing"
    for bug in proof.bugs:
        text = (ROOT / bug.file).read_text()
        assert ROOT / bug.file in proof.files or bug.file.endswith(f"ik_{proof.variant}.v")
        assert bug.seeded(text) != text


def test_every_task_is_a_proof():
    """A .sby file has no task that nothing runs."""
    tasks = {(p.of, f"{task}_{p.variant}") for p in PROOFS for task in ("prove", "cover", "formula") if p.has(task)}
    there = set()
    for path in (ROOT / "tb" / "formal").glob("*.sby"):
        listed = path.read_text().split("[tasks]\n")[1].split("\n\n")[0]
        there |= {(path.stem, line.split()[0]) for line in listed.splitlines()}
    assert tasks == there and len(set(NAMES)) == len(NAMES) == 28


def test_properties_do_not_change_the_rtl():
    """A .sby file puts nothing but includes before the end of a module."""
    for proof in PROOFS:
        for code in re.findall(r"--pycode-begin--\n(.*?)--pycode-end--", proof.config, re.S):
            opened, written = code.splitlines()
            assert re.fullmatch(r"text = open\(.*\)\.read\(\)", opened), proof.of
            includes = r"""output\(text\.replace\("endmodule", '(`include "ik_\w+\.vh"\\n)+endmodule'\)\)"""
            assert re.fullmatch(includes, written), proof.of
            for name in re.findall(r'"(rtl/[^"]+)"', code):
                assert (ROOT / name).read_text().count("endmodule") == 1


def test_nothing_is_assumed_but_the_writers_contract():
    """Assumptions that are not of a cover's way through, all on inputs: of ik_fifo, ik_fold, ik_axi's engines."""
    found = []
    for path in sorted((ROOT / "tb" / "formal").glob("*.v*")):
        proved = re.sub(r"`ifdef IK_COVER.*?`(else|endif)", "", path.read_text(), flags=re.S)
        found += [(path.name, label) for label in re.findall(r"(\w+ : )?assume \(", proved)]
    read = ["f_go", "f_area", "f_leave", "f_data"]
    write = ["f_go", "f_area", "f_got_some", "f_ended", "f_leave", "f_answer"]
    assert found == [
        *(("ik_axi.vh", f"{name} : ") for name in ("f_answered", "f_length")),
        *(("ik_axi_read.vh", f"{name} : ") for name in read),
        *(("ik_axi_write.vh", f"{name} : ") for name in write),
        ("ik_fifo.vh", "f_contract : "),
        ("ik_fold.vh", "f_sender : "),
    ]
    for proof in PROOFS:
        lines = [line for line in proof.config.splitlines() if "IK_COVER" in line]
        assert all(line.startswith("cover: ") for line in lines)
        fewer = r"^formula: (chformal -assume2assert|select -assert-count \d+) .*"  # than the files have
        assert "assume" not in re.sub(fewer, "", proof.config, flags=re.M)


def kinds(op):
    """The parameters of each kind of divider ("div") or root in the paper's datapath, from the model."""
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), 32, "paper").bits.nodes.values()
    found = set()
    for node in nodes:
        if node.op == op:
            n, *d = (operand.format for operand in node.operands)
            q = node.format
            shift = q.frac - n.frac + d[0].frac if d else 2 * q.frac - n.frac
            divisor = {"DW": d[0].width} if d else {}
            kind = {"NW": n.width + (not n.signed), "SH": shift, "QW": q.width, "LAT": Latency(32)[op], **divisor}
            found.add(tuple(sorted(kind.items())))
    return found


@pytest.mark.parametrize("op", ["div", "root"])
def test_every_divider_and_root_of_the_model_is_proved(op):
    """What the .sby file sets, and what the list says of it, are the formats of the model."""
    proofs = [proof for proof in PROOFS if proof.of == op]
    assert {tuple(sorted((k, int(v)) for k, v in re.findall(r"(\w+)=(\d+)", p.width))) for p in proofs} == kinds(op)
    for proof in proofs:
        tags = re.search(rf"^formula_{proof.variant} formula (.*)$", proof.config, re.M)[1].split()
        lines = re.findall(r"^(?:(\w+): )?chparam (.*) \w+$", proof.config, re.M)
        sets = " ".join(said for tag, said in lines if not tag or tag in tags)
        assert sorted(re.findall(r"-set (\w+) (\d+)", sets)) == sorted(re.findall(r"(\w+)=(\d+)", proof.width))


def test_stages_and_places_are_those_of_the_rtl():
    latency = (ROOT / "rtl" / "include" / "ik_latency.vh").read_text()
    assert "clog2(datapath_latency(DATAPATH, W, TILE) + 3)" in (ROOT / AXIS).read_text()

    def of(lean, width):
        stages = int(re.search(rf"^\s*{100 * lean + width}: datapath_latency = (\d+);", latency, re.M)[1])
        return stages, 1 << (stages + 2).bit_length()

    stages, places = of(0, 22)
    (most,) = (proof for proof in PROOFS if proof.name == "axis_256")
    assert places == 256 and of(0, 23)[1] == 512 and most.width == f"W=22, paper: {stages} stages, 256 places"
    for lean, datapath in enumerate(("paper", "lean")):
        stages, places = of(lean, 32)
        axis, valid, fifo = (next(p for p in PROOFS if p.name == name) for name in (
            f"axis_{datapath}", f"valid_{datapath}", f"fifo_{places}"))  # fmt: skip
        assert axis.width == f"W=32, {datapath}: {stages} stages, {places} places"
        assert valid.width == f"W=32, {stages} stages" and f"{places} places" in fifo.width
        assert f"p{places}: chparam -set W 208 -set LOG2 {places.bit_length() - 1} ik_fifo" in fifo.config


def test_circle_of_properties_is_refused():
    no_circle({"a": ["b"], "b": ["c*"]})
    with pytest.raises(RuntimeError, match="follow from each other"):
        no_circle({"a": ["b$"], "b": ["a"]})


def test_bug_that_cannot_be_seeded_is_said(tmp_path):
    with pytest.raises(LookupError, match="not exactly one"):
        copy_rtl(tmp_path, Bug("x", FIFO, "not in the file", ""))
    with pytest.raises(LookupError, match="not exactly one"):
        copy_rtl(tmp_path, Bug("x", FIFO, "m_valid", ""))


def test_copy_has_the_bug_and_no_other_change(tmp_path):
    copy_rtl(tmp_path, PROOFS[0].bugs[1])
    changed = [p for p in (ROOT / "rtl").rglob("*.v*") if p.read_text() != (tmp_path / p.relative_to(ROOT)).read_text()]
    assert changed == [ROOT / FIFO]


def test_slices_that_a_property_rests_on(monkeypatch):
    monkeypatch.setattr(Steps, "__init__", lambda self: None)
    design = Steps()
    design.names = [f"g_slice[{k}].u.row" for k in (0, 16, 32, 48)] + ["alone"]
    assert design.named("row", "g_slice[32].u.row") == [f"g_slice[{k}].u.row" for k in (16, 32, 48)]
    assert design.named("row$", "g_slice[0].u.row") == ["g_slice[48].u.row"]
    assert len(design.named("row*", "g_slice[0].u.row")) == len(design.named("row", "alone")) == 4
    assert design.named("alone", "g_slice[0].u.row") == ["alone"]
    with pytest.raises(RuntimeError, match="no property other"):
        design.named("other")


@pytest.fixture
def versions(monkeypatch):
    """Of tools that need not be installed."""
    monkeypatch.setattr(prove, "versions", lambda: "1.2.3")


def test_result_is_kept(tmp_path):
    result = prove.Result("x", seconds=2.5, asserts=3, covers=[("full", 7)], seeded=[1.5], total=4.0)
    path = tmp_path / "done.json"
    assert prove.recall(path) is None
    path.write_text(json.dumps(asdict(result)))
    again = prove.recall(path)
    assert (again.seconds, again.asserts, again.total, again.seeded) == (2.5, 3, 4.0, [1.5]) and again.failed == []


def test_key_depends_on_sources_questions_and_tactic(versions, monkeypatch, tmp_path):
    first = prove.kept(PROOFS[0])
    assert first == prove.kept(PROOFS[0]) != prove.kept(PROOFS[1])
    path = tmp_path / "a.v"
    monkeypatch.setattr(Proof, "files", property(lambda self: [path]))
    path.write_text("a = 1;")
    base = prove.kept(PROOFS[0])
    path.write_text("// a comment\na = 1;")
    assert prove.kept(PROOFS[0]) == base
    path.write_text("a = 2;")
    assert prove.kept(PROOFS[0]) != base
    monkeypatch.setattr(steps, "TACTIC", "smt")
    path.write_text("a = 1;")
    assert prove.kept(PROOFS[0]) != base


tools = pytest.mark.skipif(
    bool(missing()), reason="the tools of requirements/fpga.lock are not installed: `make formal` does it"
)


def again(name, **changed):
    """A proof run again, what it said, with some of it changed."""
    proof = next(proof for proof in PROOFS if proof.name == name)
    said = []
    with ThreadPoolExecutor(2) as pool:
        values = {field: getattr(proof, field) for field in proof.__dataclass_fields__} | changed
        return prove.run(Proof(**values), pool, said.append, again=True), said


@tools
def test_smallest_proof_and_its_bugs():
    """One proof of a few seconds, by SymbiYosys."""
    result, said = again("root_row_15")
    assert result.failed == [] and len(result.seeded) == 3 and len(result.covers) == 4
    assert sum("fails as it should" in line for line in said) == 3


@tools
@pytest.mark.slow
@pytest.mark.parametrize("name", ["fifo_64", "axis_lean"])
def test_places_are_those_of_the_registers(name):
    """A word that keeps its place is noticed by what the registers hold, not by what is counted at the ports."""
    proof = next(proof for proof in PROOFS if proof.name == name)
    bug = next(bug for bug in proof.bugs if "keeps its place" in bug.what)
    for fails, said in (("within_places", ""), ("counted", "survives: counted is still proved")):
        seen = replace(proof, bugs=(replace(bug, fails=fails),))
        assert prove.survives(seen, 0) == said


@tools
def test_bug_that_is_none_survives():
    """A change that changes nothing is not taken for a bug that was noticed."""
    harmless = Bug("harmless", AXIS, "!rst && (credits != 0)", "(credits != 0) && !rst", "independent")
    assert "survives" in again("handshake_lean", bugs=(harmless,))[0].failed[0]
    harmless = Bug("harmless", "rtl/lib/ik_div_row.v", "endmodule", "\nendmodule", "identity")
    assert "survives" in again("div_row_31", bugs=(harmless,))[0].failed[0]

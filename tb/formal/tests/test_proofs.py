# SPDX-License-Identifier: Apache-2.0
"""Tests of the proofs by induction: the .sby files, the questions, and one proof of a few seconds."""

import re
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.nodes import Latency
from tb.formal import prove, steps
from tb.formal.bugs import AXIS
from tb.formal.proof import Proof
from tb.formal.proofs import PROOFS
from tb.formal.steps import Steps, no_circle
from tb.formal.tools import missing
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

NAMES = [proof.name for proof in PROOFS]


@pytest.mark.parametrize("proof", PROOFS, ids=NAMES)
def test_definition(proof):
    """Sources exist, the bug can be seeded and breaks an existing property, and no properties depend on each other."""
    assert [path for path in proof.files if not path.exists()] == []
    assert proof.has("formula") or proof.engine == "gates"
    no_circle(proof.after)
    properties = "".join(path.read_text() for path in proof.files if "tb/formal" in str(path))
    labels = set(re.findall(r"(\w+) : (?:assert|assume)", properties))
    wanted = {*proof.says, *proof.uses, *proof.after, proof.bug.fails}
    wanted |= {n.rstrip("*$") for names in (*proof.uses.values(), *proof.after.values()) for n in names}
    assert proof.engine == "gates" or wanted - labels == set()
    text = (ROOT / proof.bug.file).read_text()
    assert ROOT / proof.bug.file in proof.files or proof.bug.file.endswith(f"ik_{proof.variant}.v")
    assert proof.bug.seeded(text) != text


def test_every_task_is_a_proof():
    """Every task of a .sby file is run."""
    tasks = {(p.of, f"{task}_{p.variant}") for p in PROOFS for task in ("prove", "cover", "formula") if p.has(task)}
    there = set()
    for path in (ROOT / "tb" / "formal").glob("*.sby"):
        listed = path.read_text().split("[tasks]\n")[1].split("\n\n")[0]
        there |= {(path.stem, line.split()[0]) for line in listed.splitlines()}
    assert tasks == there


def test_properties_do_not_change_the_rtl():
    """A .sby file inserts only includes before the end of a module."""
    for proof in PROOFS:
        for code in re.findall(r"--pycode-begin--\n(.*?)--pycode-end--", proof.config, re.S):
            opened, written = code.splitlines()
            assert re.fullmatch(r"text = open\(.*\)\.read\(\)", opened), proof.of
            includes = r"""output\(text\.replace\("endmodule", '(`include "ik_\w+\.vh"\\n)+endmodule'\)\)"""
            assert re.fullmatch(includes, written), proof.of
            for name in re.findall(r'"(rtl/[^"]+)"', code):
                assert (ROOT / name).read_text().count("endmodule") == 1


def test_assumptions_are_on_inputs():
    """Proofs (not covers) have only these assumptions, all on inputs of ik_fifo, ik_fold and ik_axi's engines."""
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
        fewer = r"^formula: (chformal -assume2assert|select -assert-count \d+) .*"  # fewer assumptions
        assert "assume" not in re.sub(fewer, "", proof.config, flags=re.M)


def kinds(op):
    """Return the parameters of each kind of divider ("div") or root of the paper's datapath, from the model."""
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
    """The parameters in .sby file and list are the formats of the model."""
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
        axis, valid, fifo = (
            next(p for p in PROOFS if p.name == name)
            for name in (f"axis_{datapath}", f"valid_{datapath}", f"fifo_{places}")
        )
        assert axis.width == f"W=32, {datapath}: {stages} stages, {places} places"
        assert valid.width == f"W=32, {stages} stages" and f"{places} places" in fifo.width
        assert f"p{places}: chparam -set W 208 -set LOG2 {places.bit_length() - 1} ik_fifo" in fifo.config


def test_circle_of_properties_is_refused():
    no_circle({"a": ["b"], "b": ["c*"]})
    with pytest.raises(RuntimeError, match="follow from each other"):
        no_circle({"a": ["b$"], "b": ["a"]})


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


tools = pytest.mark.skipif(
    bool(missing()), reason="the tools of requirements/fpga.lock are not installed: `make formal` does it"
)


def by_name(name):
    """Return a proof of the list."""
    return next(proof for proof in PROOFS if proof.name == name)


@tools
def test_smallest_proof_and_its_bug():
    """Run one proof of a few seconds with SymbiYosys."""
    with ThreadPoolExecutor(2) as pool:
        outcome = prove.run(by_name("root_row_15"), pool, print)
    assert outcome.failed == [] and outcome.result == "4 assertions, 4 covers"


@tools
@pytest.mark.parametrize(
    ("name", "bug"),
    [
        ("handshake_lean", Bug("", AXIS, "!rst && (credits != 0)", "(credits != 0) && !rst", "independent")),
        ("div_row_31", Bug("", "rtl/lib/ik_div_row.v", "endmodule", "\nendmodule", "identity")),
    ],
)
def test_harmless_change_survives(name, bug):
    """A change without effect does not count as a bug found."""
    assert "survives" in prove.survives(by_name(name), bug)


def test_digest_depends_on_sources_and_questions(monkeypatch, tmp_path):
    path = tmp_path / "a.v"
    monkeypatch.setattr(Proof, "files", property(lambda self: [path]))

    def digest(text):
        path.write_text(text)
        return prove.digest(PROOFS[0])

    base = digest("a = 1;")
    assert digest("// a comment\na = 1;") == base != digest("a = 2;")
    monkeypatch.setattr(steps, "TACTIC", "smt")
    assert digest("a = 1;") != base

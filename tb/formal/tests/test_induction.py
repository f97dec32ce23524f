# SPDX-License-Identifier: Apache-2.0
"""Tests of the proofs by induction: their definitions, the questions, and one proof of a few seconds."""

import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from model.dataflow import fixed
from model.dataflow.formats import WIDTHS, Latency
from tb.formal import induction
from tb.formal.bugs import CREDITS
from tb.formal.induction import FORMAL, Proof, Steps
from tb.formal.proofs import PROOFS
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

PROOF = {proof.name: proof for proof in PROOFS}


def test_definitions():
    """Check that all properties exist that a proof or its bug names, and that the bug can be seeded."""
    for proof in PROOFS:
        labels = set(re.findall(r"(\w+) : (?:assert|assume)", "".join(path.read_text() for path in proof.files)))
        named = {name for names in (*proof.uses.values(), *proof.after.values()) for name in names.split()}
        named = {name.rstrip("*$") for name in named | proof.uses.keys() | proof.after.keys()}
        assert proof.gates or {*named, proof.bug.fails} <= labels, proof.name
        text = (ROOT / proof.bug.file).read_text()
        assert ROOT / proof.bug.file in proof.files and proof.bug.seeded(text) != text, proof.name


def test_assumptions_are_on_inputs():
    """Check that proofs, unlike covers, have only the assumptions listed here, which are about inputs."""
    labels = {}
    for path in FORMAL.glob("*.v*"):
        proved = re.sub(r"`ifdef IK_COVER.*?`(else|endif)", "", path.read_text(), flags=re.S)
        labels[path.name] = re.findall(r"(?:(\w+) : )?assume \(", proved)
    assert {name: named for name, named in labels.items() if named} == {
        "ik_axi.vh": ["f_answered", "f_length"],
        "ik_axi_read.vh": ["f_go", "f_area", "f_leave", "f_data"],
        "ik_axi_write.vh": ["f_go", "f_area", "f_got_some", "f_ended", "f_leave", "f_answer"],
        "ik_fifo.vh": ["f_contract"],
        "ik_fold.vh": ["f_sender"],
    }
    for proof in PROOFS:
        commands = " ".join((*proof.script, *proof.claims)).replace("chformal -assume2assert t:$assume", "")
        assert "assume" not in commands.replace("-assert-count 3 t:$assume", "") and "IK_COVER" not in proof.defines


@pytest.mark.parametrize("op", ["div", "root"])
def test_every_divider_and_root_of_the_model_is_proved(op):
    nodes = fixed.nodes("paper", 32).values()
    kinds = []
    for node in (node for node in nodes if node.kind == op):
        # A constant dividend has the divisor's format.
        n, d, q = node.operands[0].format, node.operands[-1].format, node.format
        shift = q.frac - n.frac + (d.frac if op == "div" else q.frac)
        kind = {"NW": n.width + (not n.signed), "SH": shift, "QW": q.width, "LAT": Latency(32)[op]}
        kinds.append(kind | ({"DW": d.width} if op == "div" else {}))
    proved = [proof.sets for proof in PROOFS if proof.top == f"ik_{op}_digit"]
    assert all(kind in proved for kind in kinds) and all(sets in kinds for sets in proved)


def test_every_number_of_places_is_proved():
    """Check that each FIFO depth has a proof. The depth follows from the latency, see tb/core/test_elaboration.py."""
    text = (ROOT / "rtl" / "include" / "ik_latency.vh").read_text()
    latencies = re.findall(r"(\d+): datapath_latency = (\d+);", text)
    places = {int(key): 1 << (int(clocks) + 2).bit_length() for key, clocks in latencies}
    proved = [proof.sets for proof in PROOFS if proof.name.startswith("axis_") and proof.top == "ik_axis"]
    arm = [max(node.time for node in fixed.nodes("arm", width).values()) for width in (WIDTHS[0], WIDTHS[-1])]
    assert {1 << (clocks + 2).bit_length() for clocks in arm} == {128}  # as in axis_arm
    assert {places[100 * sets["DATAPATH"] + sets["W"]] for sets in proved} == set(places.values())
    assert {1 << proof.sets["LOG2"] for proof in PROOFS if proof.top == "ik_fifo"} <= set(places.values())


def test_slices_that_a_property_rests_on(monkeypatch):
    monkeypatch.setattr(Steps, "__init__", lambda self: None)
    design = Steps()
    design.number = dict.fromkeys([*(f"g_slice[{k}].u.row" for k in (0, 16, 32, 48)), "alone"])
    assert design.named("row", "g_slice[32].u.row") == [f"g_slice[{k}].u.row" for k in (16, 32, 48)]
    assert design.named("row$", "g_slice[0].u.row") == ["g_slice[48].u.row"]
    assert len(design.named("row*", "g_slice[0].u.row")) == len(design.named("row", "alone")) == 4
    assert design.named("alone", "g_slice[0].u.row") == ["alone"]
    with pytest.raises(RuntimeError, match="no property other"):
        design.named("other")


tools = pytest.mark.needs("fpga")


@tools
def test_smallest_proof_and_its_bug():
    with ThreadPoolExecutor(2) as pool:
        outcome = induction.run(PROOF["root_row_15"], pool, print)
    assert outcome.failed == [] and outcome.result == "4 assertions, 4 covers"


@tools
@pytest.mark.parametrize(
    ("name", "bug"),
    [
        ("handshake_lean", Bug("", CREDITS, "!rst && (credits != 0)", "(credits != 0) && !rst", "independent")),
        ("div_row_31", Bug("", "rtl/lib/ik_div_row.v", "endmodule", "\nendmodule", "identity")),
    ],
)
def test_harmless_change_survives(name, bug):
    """Check that a change without effect does not count as a detected bug."""
    assert "survives" in induction.survives(replace(PROOF[name], name="harmless"), bug)


def test_digest_depends_on_sources_and_questions(monkeypatch, tmp_path):
    path = tmp_path / "a.v"
    monkeypatch.setattr(Proof, "files", property(lambda self: [path]))

    def digest(text):
        path.write_text(text)
        return induction.digest(PROOFS[0])

    base = digest("a = 1;")
    assert digest("// a comment\na = 1;") == base != digest("a = 2;")
    monkeypatch.setattr(induction, "TACTIC", "smt")
    assert digest("a = 1;") != base

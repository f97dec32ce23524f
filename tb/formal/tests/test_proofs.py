# SPDX-License-Identifier: Apache-2.0
"""Tests of the proofs. Proofs by induction: definitions, questions, and one proof of a few seconds. Proofs about
numbers: every range of the lean datapath has a question, and a wrong claim fails."""

import math
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from model.bounds.predict import Real
from model.bounds.tests.test_ranges import usual_targets
from model.dataflow import fixed, quadratic
from model.dataflow.formats import WIDTHS, Latency
from model.dataflow.quadratic import Form
from model.io.stimuli import REGIONS, hand_poses, region
from tb.formal import induction, lean_proofs, task
from tb.formal.bugs import CREDITS
from tb.formal.floors import ROOT_DIGIT, integer
from tb.formal.induction import FORMAL, Proof, Steps
from tb.formal.lean_proofs import BY_WORDS, CASES, Exact, Rounded, Rules
from tb.formal.proofs import PROOFS, TASKS
from tb.formal.rsqrt_stages import Stages, forms, model
from tb.formal.smt import smt
from tb.formal.task import Question
from tb.formal.tools import Answer
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

FULL = 32
tools = pytest.mark.needs("fpga")
PROOF = {proof.name: proof for proof in PROOFS}


def test_definitions():
    """Check that every property named by a proof or its bug exists, and that the bug can be seeded."""
    for proof in PROOFS:
        labels = set(re.findall(r"(\w+) : (?:assert|assume)", "".join(path.read_text() for path in proof.files)))
        named = {name for names in (*proof.uses.values(), *proof.after.values()) for name in names.split()}
        named = {name.rstrip("*$") for name in named | proof.uses.keys() | proof.after.keys()}
        assert proof.gates or {*named, proof.bug.fails} <= labels, proof.name
        text = (ROOT / proof.bug.file).read_text()
        assert ROOT / proof.bug.file in proof.files and proof.bug.seeded(text) != text, proof.name


def test_assumptions_are_on_inputs():
    """Check that proofs have only the assumptions listed here, all about inputs. Covers may have others."""
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


def test_slices_that_a_property_rests_on():
    design = Steps.__new__(Steps)
    design.number = dict.fromkeys([*(f"g_slice[{k}].u.row" for k in (0, 16, 32, 48)), "alone"])
    assert design.named("row", "g_slice[32].u.row") == [f"g_slice[{k}].u.row" for k in (16, 32, 48)]
    assert design.named("row$", "g_slice[0].u.row") == ["g_slice[48].u.row"]
    assert len(design.named("row*", "g_slice[0].u.row")) == len(design.named("row", "alone")) == 4
    assert design.named("alone", "g_slice[0].u.row") == ["alone"]
    with pytest.raises(RuntimeError, match="no property other"):
        design.named("other")


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


# ---- proofs about numbers --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [16, 17, 32])
def test_every_range_is_asked_for(width):
    """Check that z3 is asked for every range and every error, except those of CORDICs and unlimited words."""
    exact = Exact(width)
    asked, rounded, nodes = Rules(exact).names(), set(Rounded(exact).names()), exact.nodes
    fractions = {name for name, node in nodes.items() if node.frac and node.kind != "input"}
    joints = {n for n in fractions if nodes[n].section == "joints"}
    limitless = {"x", "y", "z", *(n for n in joints if nodes[n].format.signed)}
    assert fractions - limitless <= set(exact.claimed) <= {*asked, *BY_WORDS} and set(BY_WORDS) <= rounded
    assert {n for n in fractions - limitless - rounded if exact.errors[n]} == joints - limitless
    for case in CASES:
        assert set(Rules(exact, case).names()) > {"words of Qs", "words of Qe", "bend_c", "k_q", "qe_i"}


def test_questions_rest_on_what_is_asked():
    """Check that each fact that a question uses exists, and that a lemma does not share its name with a node."""
    asked = Rules(Exact(FULL))
    exact, lemmas, defined = asked.exact, asked.exact.lemmas, asked.exact.flow.definitions
    assert not set(lemmas) & set(exact.claimed) and not set(defined) & set(exact.nodes)
    for name in asked.names():
        for used in asked.uses(name):
            plain = used.lstrip("=#~")
            known = exact.equations if used != plain else {*lemmas, *exact.claimed} - set(BY_WORDS)
            assert plain in known or used == "case", (name, used)
    assert [name for name, (_, uses) in lemmas.items() if not uses] == ["good hand", "e_far of d1"]


def test_circle_is_named(monkeypatch):
    exact = Exact(FULL)
    monkeypatch.setattr(exact.nodes["u_x"], "proof", ("sin_el", "u_y"))
    monkeypatch.setattr(exact.nodes["u_y"], "proof", ("u_x",))
    with pytest.raises(RuntimeError, match="u_[xy] <- u_[xy]"):
        Rules(exact).names()


def test_power_of_two_and_word():
    """Check the only lemma about integers: if 1/e_far >= 1 ulp, 1/e_far is not between d1 and the next word."""
    (claim, _), ulp = Exact(FULL).flow.lemmas["e_far of d1"], 2.0**-6
    for e_far in (2.0**k for k in range(8)):
        for d1 in (j * ulp for j in range(1, 128)):
            assert eval(claim, {"ulp": ulp, "e_far": e_far, "d1": d1})


OPERATORS = {"+": lambda *v: sum(v), "*": lambda *v: math.prod(v), "-": lambda a, *b: a - b[0] if b else -a}
OPERATORS |= {"/": lambda a, b: a / b, "ite": np.where, "not": np.logical_not, "=>": lambda a, b: np.logical_not(a) | b}
OPERATORS["and"] = lambda *v: np.all(np.broadcast_arrays(*v), axis=0)
OPERATORS["or"] = lambda *v: np.any(np.broadcast_arrays(*v), axis=0)


def truth_of(formula: str, values: dict, close: float) -> np.ndarray:
    """Return where a formula holds for arrays of values, with the relative tolerance ``close``."""
    relations = {"<": lambda a, b: a < b, "<=": lambda a, b: a <= b + close}
    operators = OPERATORS | relations | {"=": lambda a, b: np.isclose(1.0 * a, 1.0 * b, rtol=close, atol=close * 1e-6)}
    calls = re.sub(r"\(([^\s()]+) ", r"operators['\1'](", formula).replace(" ", ", ")  # "(+ a b)": operators['+'](a, b)
    return np.asarray(eval(calls, {"operators": operators}, values))


def test_formulas_hold_for_real_numbers():
    """Check each node's formulas in double precision on reachable targets with valid hand quaternions."""
    exact, words = Exact(24), np.concatenate([region(name, 100, 24, 3) for name in REGIONS])
    nodes = fixed.run(hand_poses(words, 24, 3), 24, "arm").nodes
    real, usual = Real(nodes, {}), usual_targets(nodes)
    values = {"true": True, "false": False}
    for name, node in exact.nodes.items():
        value = np.broadcast_to(np.asarray(real.values[name]), usual.shape)[usual]
        is_count = node.format == node.flow.count
        values[name] = 2.0**value if is_count else value.astype(bool if node.format.width == 1 else float)
        values[f"{name}_w"] = np.broadcast_to(real.word(name) * 1.0, usual.shape)[usual]
        values[f"neg_{name}"] = value < 0
    formulas = [(node, formula) for name, node in exact.nodes.items() for formula in exact.equations[name]]
    for node, formula in formulas:
        assert truth_of(formula, values, 0 if node.format.width == 1 else 1e-9).all(), formula
    assert len(formulas) > 200


@pytest.mark.parametrize("width", [16, 24, 31, 32])
def test_rounding_is_within_its_bounds(width):
    """Check that words differ from exact results of their operations by at most the rounding that questions assume."""
    rounded, checked = Rounded(Exact(width)), set()
    words = np.concatenate([region(name, 1000, width, 3) for name in REGIONS])
    nodes = fixed.run(words, width, "lean").nodes
    usual = usual_targets(nodes)
    for name, node in nodes.items():
        if node.decision or node.kind != "choose":
            continue
        operands = (nodes[operand.name] for operand in node.operands)
        values = {o.name: np.asarray(o.value, dtype=np.float64) if o.frac else o.value for o in operands}
        exact = node.op.real_result(node, values)
        exact = np.minimum(exact, node.format.high) if node.limited else exact
        off = (np.asarray(node.value, dtype=np.float64) - exact)[usual]
        low, high = rounded.rounding(rounded.exact.nodes[name])
        assert low - 1e-3 <= off.min() and off.max() <= high + 1e-3, name
        checked.add(name)
    assert {"x_n", "k_scaled", "inv_12_far", "az_c", "bend_dif", "w_1", "m_q", "qe_i", "qs_k"} <= checked


@tools
@pytest.mark.parametrize("kind", [Rules, Rounded])
def test_rules_and_errors(kind):
    """Check that all claims at one word length are proved, and that a claim that is too narrow is not."""
    with ThreadPoolExecutor(2) as pool:
        asked = lean_proofs.questions(kind, (24,))
        assert task.run(asked, lean_proofs.too_narrow(kind), pool, print).failed == []


@tools
def test_floors_fail_on_a_bug():
    with ThreadPoolExecutor(2) as pool:
        assert next(task for task in TASKS if task.name == "floors").run(pool, print).failed == []


@tools
def test_reciprocal_root_of_short_words():
    """Prove the short form of the table, for which one tile computes the product."""
    for question in Stages(22).questions():
        assert task.answer(question)[1] == "", question.name


@pytest.mark.parametrize(("frac", "tile"), forms()[::3])
def test_terms_are_those_of_the_model(frac, tile):
    """Check that `model`, which the proof runs on terms, equals `quadratic.rsqrt`."""
    form, random = quadratic.INVERSE_ROOT.form(frac, tile), np.random.default_rng(1)
    rows, added = quadratic.table_rows(quadratic.INVERSE_ROOT, form), quadratic.rounding(form, frac)
    whole = Form(**{**form.__dict__, "c_frac": (form.sum_frac, *form.c_frac[1:])})
    ends = [1 << frac + 1, (1 << frac + 2) - 1, 1 << frac + 2, (1 << frac + 3) - 1]
    for m in [*ends, *map(int, random.integers(1 << frac + 1, 1 << frac + 3, 200))]:
        c0, *others = rows[int(quadratic.place(form, m, frac)[0])]
        y = model(whole, frac, ((c0 << form.sum_frac - form.c_frac[0]) + added, *others), m)[2]
        assert y == quadratic.rsqrt(m, frac, tile)


def test_problems_are_reported():
    def problem(answer, met="sat"):
        return task.answer(Question("q", "", lambda: Answer(answer, 0.1), lambda: Answer(met, 0.1)))[1]

    assert (problem("unsat"), problem("sat"), problem("timeout")) == ("", "counterexample", "timeout")
    assert problem("unsat", "unsat") == "its assumptions cannot be met: unsat"
    proved = Question("q", "", lambda: Answer("unsat", 0.1))
    with ThreadPoolExecutor(1) as pool:
        assert task.run([proved], [proved], pool, print).failed == ["seeded bug: no counterexample: unsat"]
        assert task.run([proved], [], pool, print).failed == ["seeded bug: no counterexample: no question"]


def test_expressions_are_read():
    """Translate Python (first list) and Verilog (second list) to SMT-LIB; refuse everything else."""
    for text, term in (
        ("2*a*b**2 + c <= 1/4", "(<= (+ (* 2.0 a (* b b)) c) (/ 1.0 4.0))"),
        ("implies(a == 0 and 0 < b, not c)", "(=> (and (= a 0.0) (< 0.0 b)) (not c))"),
        ("x == (a - b if c else 1.5)", "(= x (ite c (- a b) (/ 3.0 2.0)))"),
    ):
        assert smt(text) == term
    names = {"a": "a", "b": "b", "N": "B", "c": "(= c 1)", "x": "x", "q": "q"}
    for text, term in (
        ("a + (b << 2)", "(+ a (* b 4))"),
        ("a + b << N", "(* (+ a b) B)"),
        ("c ? a : b - 1", "(ite (= c 1) a (- b 1))"),
        ("~a", "(- (- 1) a)"),
        ("c || a >= b", "(or (= c 1) (>= a b))"),
        ("{(N - 1) {1'b0}}", "0"),
        ("{x[N-2:0], q}", "(+ (* 2 x) q)"),
        ("-1 - a", "(- (- 1) a)"),
    ):
        assert integer(text, names) == term
    for text in ("sqrt(a)", "a & b", "a b", "(a", "c ? a", "y", ""):
        with pytest.raises((SyntaxError, KeyError)):
            integer(text, names)


def test_words_are_as_long_as_the_floors_take_them_for():
    """Check widths that the floor proofs assume: XW >= DW in the divider, a radicand of 2 ROWS bits in the root."""
    div, root = ((ROOT / "rtl" / "lib" / f"ik_{kind}_digit.v").read_text() for kind in ("div", "root"))
    assert "((MB - ROWS > DW - 1) ? (MB - ROWS) : (DW - 1)) + 2;" in div and "XW = HW + ROWS;" in div
    assert "? ((VB + 1) / 2) : (QW - 1);" in root
    assert "localparam integer MW = 2 * ROWS;" in (ROOT / ROOT_DIGIT).read_text()

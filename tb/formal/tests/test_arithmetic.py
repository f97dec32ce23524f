# SPDX-License-Identifier: Apache-2.0
"""Tests of the proofs about numbers: every range of the lean datapath has a question, and a wrong claim fails."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from model.dataflow import fixed, quadratic
from model.dataflow.nodes import real_value
from model.dataflow.quadratic import Form
from model.io.stimuli import REGIONS, region
from tb.formal import arithmetic, lean_proofs
from tb.formal.arithmetic import Question
from tb.formal.bugs import BUGS
from tb.formal.floors import ROOT_DIGIT, FormulaError, floors, integer
from tb.formal.lean_exact import Exact
from tb.formal.lean_lemmas import BY_WORDS, CASES, GEOMETRY, SQUARES, USES
from tb.formal.lean_proofs import Rounded, Rules
from tb.formal.rsqrt_stages import Stages, forms, model
from tb.formal.unrolled import Answer
from tb.sim.env import ROOT

FULL = 32
tools = pytest.mark.needs("fpga")


@pytest.mark.parametrize("width", [16, 17, 32])
def test_every_range_is_asked_for(width):
    """Every claimed range and every error has a question, except those of CORDICs and of words without a limit."""
    exact = Exact(width)
    asked, rounded, nodes = Rules(exact).names(), set(Rounded(exact).names()), exact.nodes
    fractions = {name for name, node in nodes.items() if node.format.frac and node.op != "input"}
    joints = {n for n in fractions if nodes[n].section == "joints"}
    limitless = {"x", "y", "z", *(n for n in joints if nodes[n].format.signed)}
    assert fractions - limitless <= set(exact.claimed) <= {*asked, *BY_WORDS} and set(BY_WORDS) <= rounded
    assert {n for n in fractions - limitless - rounded if exact.errors[n]} == joints - limitless
    assert all(
        set(Rules(exact, case).names()) > {"words of Qs", "words of Qe", "arm_c", "k_q", "qe_i"} for case in CASES
    )


def test_questions_rest_on_what_is_asked():
    """Every name is a node, a lemma or a sum of squares; no lemma shares a node's name."""
    asked = Rules(Exact(FULL))
    nodes = asked.exact.nodes
    assert not set(GEOMETRY) & set(asked.exact.claimed) and not set(SQUARES) & set(nodes) and set(USES) <= set(nodes)
    for name in asked.names():
        for used in asked.uses(name):
            plain = used.lstrip("=#~")
            known = {*nodes, *SQUARES, "ulp"} if used != plain else {*GEOMETRY, *asked.exact.claimed} - set(BY_WORDS)
            assert plain in known, (name, used)
    assert [name for name, (_, uses) in GEOMETRY.items() if not uses] == ["case", "e_far of d1", "good hand"]


def test_circle_is_named(monkeypatch):
    monkeypatch.setitem(USES, "u_x", ["sin_el", "u_y"])
    monkeypatch.setitem(USES, "u_y", ["u_x"])
    with pytest.raises(RuntimeError, match="u_[xy] <- u_[xy]"):
        Rules(Exact(FULL)).names()


def test_power_of_two_and_word():
    """The only lemma about integers: 1/e_far, if at least one ulp, is not between d1 and the next word."""
    claim, ulp = GEOMETRY["e_far of d1"][0], 2.0**-6
    assert claim == "(or (< 1.0 (* ulp e_far)) (<= 1.0 (* e_far d1)) (<= (* e_far (+ d1 ulp)) 1.0))"
    for e_far in (2.0**k for k in range(8)):
        for d1 in (j * ulp for j in range(1, 128)):
            assert ulp * e_far > 1 or e_far * d1 >= 1 or e_far * (d1 + ulp) <= 1


def test_decision_that_is_not_of_signs_is_free():
    exact = Exact(FULL)
    assert exact.equations["low"] == [] and exact.equations["minus"] != []
    assert len(exact.signs) == 5 and {"u_y", "sin_el", "k_1", "length_sq"} < exact.signs.keys()


@pytest.mark.parametrize("width", [16, 24, 31, 32])
def test_rounding_is_within_its_bounds(width, monkeypatch):
    """Words minus the value of the operation, in ulps, stay within the rounding that the questions assume."""
    rounded, off, apply = Rounded(Exact(width)), {}, fixed.Bits.apply

    def watched(self, name, operands, fmt, function):
        words = apply(self, name, operands, fmt, function)
        node = rounded.exact.nodes[name]
        if not self.decides(fmt):
            values = [n.value * n.format.ulp if n.format.frac else n.value for n in operands]
            exact = real_value(function, operands, values, fmt)
            exact = np.minimum(exact, fmt.high * fmt.ulp) if node.facts.limited else exact
            off[name] = (np.asarray(words, dtype=np.float64) * fmt.ulp - exact) / fmt.ulp
        return words

    monkeypatch.setattr(fixed.Bits, "apply", watched)
    words = np.concatenate([region(name, 1000, width, 3) for name in REGIONS])
    clamp = fixed.run(words, width, "lean").bits.nodes["clamp"].value
    usual = ~np.asarray(clamp).astype(bool)
    for name, places in off.items():
        low, high = rounded.rounding(rounded.exact.nodes[name])
        assert low - 1e-3 <= places[usual].min() and places[usual].max() <= high + 1e-3, name
    assert {"x_n", "k_scaled", "inv_12_far", "az_c", "arm_dif", "w_1", "m_q", "qe_i", "qs_k"} <= set(off)


@tools
@pytest.mark.parametrize("kind", [Rules, Rounded])
def test_rules_and_errors(kind):
    """All questions at one width hold, and a claim that is too narrow does not."""
    with ThreadPoolExecutor(2) as pool:
        asked = lean_proofs.questions(kind, (24,))
        assert arithmetic.run(asked, lean_proofs.too_narrow(kind), pool, print).failed == []


@tools
def test_floors_fail_on_a_bug():
    bug = BUGS["floors"]
    with ThreadPoolExecutor(2) as pool:
        wrong = (question for question in floors(bug) if question.name == bug.fails)
        assert arithmetic.run(floors(), wrong, pool, print).failed == []


@tools
def test_reciprocal_root_of_short_words():
    """Check the form with one tile."""
    for question in Stages(22).questions():
        assert arithmetic.answer(question)[1] == "", question.name


@pytest.mark.parametrize(("frac", "tile"), forms())
def test_terms_are_those_of_the_model(frac, tile):
    """The function used on terms equals the model's root."""
    form, random = quadratic.INVERSE_ROOT.form(frac, tile), np.random.default_rng(1)
    rows, added = quadratic.table_rows(quadratic.INVERSE_ROOT, form), quadratic.rounding(form, frac)
    whole = Form(**{**form.__dict__, "c_frac": (form.sum_frac, *form.c_frac[1:])})
    ends = [1 << frac + 1, (1 << frac + 2) - 1, 1 << frac + 2, (1 << frac + 3) - 1]
    for m in [*ends, *map(int, random.integers(1 << frac + 1, 1 << frac + 3, 200))]:
        c0, *others = rows[int(quadratic.place(form, m, frac)[0])]
        y = model(whole, frac, ((c0 << form.sum_frac - form.c_frac[0]) + added, *others), m)[2]
        assert y == quadratic.rsqrt(m, frac, tile)


def test_problems_are_reported():
    """Reports: a counterexample, no answer, unsatisfiable assumptions, a bug without a counterexample."""

    def problem(answer, met="sat"):
        return arithmetic.answer(Question("q", "", lambda: Answer(answer, 0.1), lambda: Answer(met, 0.1)))[1]

    assert (problem("unsat"), problem("sat"), problem("timeout")) == ("", "counterexample", "timeout")
    assert problem("unsat", "unsat") == "its assumptions cannot be met: unsat"
    proved = Question("q", "", lambda: Answer("unsat", 0.1))
    with ThreadPoolExecutor(1) as pool:
        assert arithmetic.run([proved], [proved], pool, print).failed == ["seeded bug: no counterexample: unsat"]
        assert arithmetic.run([proved], [], pool, print).failed == ["seeded bug: no counterexample: no question"]


def test_expressions_are_read():
    """Cases: precedence, shifts by a number or a name, a conditional, a constant of zeros, an appended bit."""
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
    for text in ("a & b", "a b", "(a", "c ? a", "y", ""):
        with pytest.raises(FormulaError):
            integer(text, names)


@pytest.mark.parametrize(
    ("file", "line"),
    [
        ("ik_div_digit", "((MB - ROWS > DW - 1) ? (MB - ROWS) : (DW - 1)) + 2;"),
        ("ik_div_digit", "XW = HW + ROWS;"),
        ("ik_root_digit", "? ((VB + 1) / 2) : (QW - 1);"),
    ],
)
def test_words_are_as_long_as_the_floors_take_them_for(file, line):
    """X = 2^XW >= 2 D = 2^DW; the radicand has 2 ROWS bits."""
    assert line in (ROOT / "rtl" / "lib" / f"{file}.v").read_text()
    assert "localparam integer MW = 2 * ROWS;" in (ROOT / ROOT_DIGIT).read_text()

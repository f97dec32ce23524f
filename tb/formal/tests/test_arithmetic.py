# SPDX-License-Identifier: Apache-2.0
"""Proofs about numbers: every range of the lean datapath has one, and fails where its rule does not hold."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from model.bounds.ranges import Ranges
from model.dataflow import cores, fixed, lean
from model.dataflow.annotations import Rule
from model.dataflow.interval_cases import cases
from model.dataflow.nodes import WIDTHS
from model.dataflow.quadratic import Form
from model.io.stimuli import REGIONS, region
from tb.formal import arithmetic, lean_rules, paper_rules
from tb.formal.arithmetic import Part, Question
from tb.formal.arithmetic_parts import ARITHMETIC
from tb.formal.floors import ROOT_DIGIT, FormulaError, integer
from tb.formal.lean_exact import Exact
from tb.formal.lean_proofs import errors, rules, seeded
from tb.formal.lean_rounded import Rounded
from tb.formal.lean_rules import BY_WORDS, GEOMETRY, SQUARES, USES, Rules
from tb.formal.range_bugs import FULL
from tb.formal.rsqrt_stages import STAGES, Stages, forms, model
from tb.formal.tools import missing
from tb.formal.unrolled import Answer
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

tools = pytest.mark.skipif(
    bool(missing()), reason="the tools of requirements/fpga.lock are not installed: `make formal` does it"
)
HARMLESS = Bug("harmless", "model/dataflow/lean.py", "PAIR = Within(-1.5, 1.5,", "PAIR = Within(-1.6, 1.6,", "wi_0")


@pytest.mark.parametrize("width", [16, 17, 32])
def test_every_range_is_asked_for(width):
    """A range that the dataflow claims without a question about it would be a rule without a proof."""
    exact = Exact(width)
    fractions = {name for name, node in exact.nodes.items() if node.format.frac and node.op != "input"}
    assert fractions <= set(exact.claimed)
    assert set(exact.claimed) <= {*Rules(width).names(), *BY_WORDS} and set(BY_WORDS) <= set(Rounded(width).names())
    assert fractions - set(Rounded(width).names()) == {n for n in fractions if exact.nodes[n].section == "guard"}


def test_questions_rest_on_what_is_asked():
    """Every name is a node, a lemma or a sum of squares, no lemma has a node's name, and nothing goes in circles."""
    asked = Rules(FULL)
    nodes = asked.exact.nodes
    assert not set(GEOMETRY) & set(asked.exact.claimed) and not set(SQUARES) & set(nodes) and set(USES) <= set(nodes)
    for name in asked.names():
        for used in asked.uses(name):
            plain = used.lstrip("=#")
            known = {*nodes, *SQUARES, "ulp"} if used != plain else {*GEOMETRY, *asked.exact.claimed} - set(BY_WORDS)
            assert plain in known, (name, used)
    assert asked.circle() == ""
    assert [name for name, (_, uses) in GEOMETRY.items() if not uses] == ["reach", "e_far of d1"]


def test_circle_is_named(monkeypatch):
    monkeypatch.setitem(lean_rules.USES, "u_x", ["cos_a", "u_y"])
    monkeypatch.setitem(lean_rules.USES, "u_y", ["u_x"])
    assert set(Rules(FULL).circle().split(" <- ")) == {"u_x", "u_y"}
    with pytest.raises(RuntimeError, match="rest on each other"):
        next(rules((FULL,)))


def test_power_of_two_and_word():
    """The one lemma about integers: 1/e_far, where it is a place or more, is not between d1 and the next word."""
    claim, ulp = GEOMETRY["e_far of d1"][0], 2.0**-6
    assert claim == "(or (< 1.0 (* ulp e_far)) (<= 1.0 (* e_far d1)) (<= (* e_far (+ d1 ulp)) 1.0))"
    for e_far in (2.0**k for k in range(8)):
        for d1 in (j * ulp for j in range(1, 128)):
            assert ulp * e_far > 1 or e_far * d1 >= 1 or e_far * (d1 + ulp) <= 1


def test_decision_that_is_not_of_signs_is_free():
    exact = Exact(FULL)
    assert exact.equations["low"] == [] and exact.equations["minus"] != []
    assert exact.signs.keys() == {"u_y", "sin_el", "cos_a", "k_1", "length_sq"}


@pytest.mark.parametrize("bug", [bug for part in ARITHMETIC for bug in part.bugs], ids=lambda bug: bug.what)
def test_bug_can_be_seeded(bug):
    assert bug.seeded((ROOT / bug.file).read_text())
    if bug.file == "model/dataflow/lean.py":
        assert seeded(bug).lean is not lean.lean


@pytest.mark.parametrize("width", [16, 24, 31, 32])
def test_rounding_is_what_the_questions_take_it_for(width, monkeypatch):
    """Of operations on words: the words less the value of the operation, in places."""
    rounded, off, apply = Rounded(width), {}, fixed.Bits.apply

    def watched(self, name, operands, fmt, bits, real):
        words = apply(self, name, operands, fmt, bits, real)
        node = rounded.exact.nodes[name]
        if real is not None and node.section != "guard":
            exact = real(*(np.asarray(n.value, dtype=np.float64) * n.format.ulp for n in operands))
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
def test_rules_and_errors():
    """All questions of one width."""
    with ThreadPoolExecutor(2) as pool:
        for questions in (rules, errors):
            part = Part("part", "", "", lambda q=questions: q((24,)), lambda bug: (), ())
            assert arithmetic.run(part, pool, print).failed == []


@tools
@pytest.mark.slow
def test_reciprocal_root_of_short_words():
    """The form with one tile."""
    for question in Stages(22).questions():
        assert arithmetic.answer(question).problem == "", question.name


@pytest.mark.parametrize(("frac", "tile"), forms())
def test_terms_are_those_of_the_model(frac, tile):
    """What is asked of terms is the model's root, of numbers."""
    form, random = cores.form_of(frac, tile), np.random.default_rng(1)
    rows, added = cores.rsqrt_rows(form), cores.rounding(form, frac)
    whole = Form(**{**form.__dict__, "c_frac": (form.sum_frac, *form.c_frac[1:])})
    ends = [1 << frac + 1, (1 << frac + 2) - 1, 1 << frac + 2, (1 << frac + 3) - 1]
    for m in [*ends, *map(int, random.integers(1 << frac + 1, 1 << frac + 3, 200))]:
        c0, *others = rows[int(cores.place(form, m, frac)[0])]
        y = model(whole, frac, ((c0 << form.sum_frac - form.c_frac[0]) + added, *others), m)[2]
        assert y == cores.rsqrt(m, frac, tile)


@tools
@pytest.mark.parametrize(
    "part",
    [pytest.param(p, marks=pytest.mark.slow if p is STAGES else ()) for p in ARITHMETIC],
    ids=lambda part: part.name,
)
def test_every_bug_is_noticed(part):
    assert {bug.what: arithmetic.survives(part, bug) for bug in part.bugs} == dict.fromkeys(
        (bug.what for bug in part.bugs), ""
    )


@tools
def test_bug_that_is_none_survives():
    assert "survives" in arithmetic.survives(ARITHMETIC[0], HARMLESS)


def test_what_can_go_wrong_is_said():
    """A counterexample, no answer, an assumption that nothing meets, a bug without its question or its text."""

    def said(answer, met="sat"):
        question = Question("q", "", "", lambda: Answer(answer, 0.1), lambda: Answer(met, 0.1))
        return arithmetic.answer(question).problem

    assert (said("unsat"), said("sat"), said("timeout")) == ("", "counterexample", "timeout")
    assert said("unsat", "unsat") == "can what is assumed be met? unsat"
    part = Part("part", "", "", tuple, lambda bug: [bug.seeded("a b")], ())
    assert "cannot be seeded" in arithmetic.survives(part, Bug("x", "f", "c", "d", "q"))
    part = Part("part", "", "", tuple, lambda bug: (), ())
    assert "no question" in arithmetic.survives(part, Bug("x", "f", "a", "d", "q"))


def test_every_rule_of_the_papers_datapath_is_proved_or_named():
    """A rule without a formula is in the list of those that are open; the one without a name is the law of cosines."""
    rules = paper_rules.named()
    assert set(rules) == {*paper_rules.FORMULAS, *paper_rules.OPEN}
    assert not set(paper_rules.FORMULAS) & set(paper_rules.OPEN) and set(paper_rules.LONG_OPEN) <= set(rules)
    facts = Ranges(FULL, cases(FULL)[0]).run().facts.values()
    used = {id(fact.within): fact.within for fact in facts if isinstance(fact.within, Rule)}
    assert {r.name for r in used.values() if r not in rules.values()} == {"law of cosines"}
    assert {name for name, rule in rules.items() if id(rule) not in used} == set()


def test_expressions_are_read():
    """Verilog's order of operators, shifts by a number or a name, a choice, a constant of zeros, a bit more."""
    names = {"a": "a", "b": "b", "N": "B", "c": "(= c 1)", "x": "x", "q": "q"}
    for text, term in (
        ("a + (b << 2)", "(+ a (* b 4))"), ("a + b << N", "(* (+ a b) B)"),
        ("c ? a : b - 1", "(ite (= c 1) a (- b 1))"), ("~a", "(- (- 1) a)"),
        ("c || a >= b", "(or (= c 1) (>= a b))"), ("{(N - 1) {1'b0}}", "0"),
        ("{x[N-2:0], q}", "(+ (* 2 x) q)"), ("-1 - a", "(- (- 1) a)"),
    ):  # fmt: skip
        assert integer(text, names) == term
    for text in ("a & b", "a b", "(a", "c ? a", "y", ""):
        with pytest.raises(FormulaError):
            integer(text, names)


@pytest.mark.parametrize(("file", "line"), [
    ("ik_div_digit", "((MB - ROWS > DW - 1) ? (MB - ROWS) : (DW - 1)) + 2;"), ("ik_div_digit", "XW = HW + ROWS;"),
    ("ik_root_digit", "? ((VB + 1) / 2) : (QW - 1);"),
])  # fmt: skip
def test_words_are_as_long_as_the_floors_take_them_for(file, line):
    """X = 2^XW >= 2 D = 2^DW; the radicand has 2 ROWS bits."""
    assert line in (ROOT / "rtl" / "lib" / f"{file}.v").read_text()
    assert "localparam integer MW = 2 * ROWS;" in (ROOT / ROOT_DIGIT).read_text()


def test_widths():
    """Questions of every width, those that are the same once."""
    assert len({question.name for question in rules((32, 31))}) == len(list(rules((32, 31))))
    assert list(WIDTHS) == list(range(16, 33))

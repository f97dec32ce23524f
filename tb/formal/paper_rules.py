# SPDX-License-Identifier: Apache-2.0
"""Rules of the paper's datapath, in exact arithmetic, by z3 over the reals.

A rule (:class:`.annotations.Rule`) narrows a node's range case by case. Here its geometry is a formula, typed,
and the limits are those that the rule itself gives for each case of a run of :mod:`model.bounds.ranges`, with the box
of lengths and the tilt of that case. :data:`OPEN` names the rules that are not proved here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from types import ModuleType

from model.bounds.ranges import SLACK, Ranges
from model.dataflow import annotations, paper, paper_turns
from model.dataflow.annotations import Rule
from model.dataflow.interval_cases import SQRT3, Case, cases
from tb.formal.arithmetic import Part, Question
from tb.formal.lean_exact import between, number, real_formula
from tb.formal.range_bugs import FULL
from tb.formal.unrolled import Answer, ask
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

SOLVER = "(check-sat-using qfnra-nlsat)"
LIMIT = 60  # seconds for one question

MODULES = {"annotations": annotations, "paper": paper, "paper_turns": paper_turns}

OPEN = {
    "ARMS": "of words: halves are rounded",
    "NOT_NEAR": "of words: a difference shifted by a count of its own",
    "FOREARM": "with how far p_e is off, of rounded arms",
}
"""Rules without a proof here, and why; the law of cosines of t_e is a fourth, and LAW and HEIGHT_SQ of rounded arms."""

LONG_OPEN = ("LAW", "HEIGHT_SQ")


def norm(*parts: str) -> str:
    return f"(+ {' '.join(f'(* {part} {part})' for part in parts)})"


def box(length_sq: str, low: float, high: float) -> str:
    """The length lies between."""
    return f"(and (<= (* {number(low)} {number(low)}) {length_sq}) (<= {length_sq} (* {number(high)} {number(high)})))"


P, PI, Q = ("px", "py", "pz"), ("ix", "iy", "iz"), ("qi", "qj", "qk")
CROSS = [f"(* 2.0 (- (* {P[a]} {PI[b]}) (* {P[b]} {PI[a]})))" for a, b in ((2, 1), (0, 2), (1, 0))]
G = "(+ (* qj iy) (* qk iz))"
R = "(- (+ (* qk qk) (* qj qj)) (* qi qi))"
MANTISSA = ["(and (<= (- 1.0) mx) (<= mx 1.0))", "(and (<= (- 1.0) my) (<= my 1.0))", "(and (<= 0.5 mz) (<= mz 1.0))"]
UNIT = [f"(= {norm(*Q)} 1.0)"]


def _p(c: Case) -> list[str]:
    return [box(norm(*P), *c.p)]


def _pi(c: Case) -> list[str]:
    return [box(norm(*PI), *c.b)]


def _tilted(c: Case) -> list[str]:
    """o is the square of p_w pi_swivel."""
    tilt = f"(* {number(c.tilt)} {number(c.tilt)} ll ii)"
    return [box("ll", *c.p), box("ii", *c.b), "(<= 0.0 o)", f"(<= o {tilt})"]


def _pp(c: Case) -> list[str]:
    return [f"(<= pp (* {number(c.pp[1])} {number(c.pp[1])}))", "(<= 0.0 pp)"]


def _law(c: Case) -> list[str]:
    """k_e of an arm (d1, d2) whose target is a away, l = k a in its own unit."""
    arm = ["(= d1 0.25)", "(= d2 0.25)"] if c.clamped else [f"(<= d1 {number(c.d_high)})", "(<= (+ d1 d2) 1.0)"]
    reach = ["(<= (- d1 d2) a)", "(<= (- d2 d1) a)", "(<= a (+ d1 d2))", "(< 0.0 a)", "(< 0.0 d1)", "(< 0.0 d2)"]
    return [*arm, *reach, "(< 0.0 k)", "(= l (* k a))", f"(<= {number(c.p[0])} l)", f"(<= l {number(c.p[1])})",
            "(= k_e (* k (- (+ (* a a) (* d1 d1)) (* d2 d2))))"]  # fmt: skip


def _plane(c: Case) -> list[str]:
    return ["(= (+ (* nx nx) (* ny ny) (* nz nz)) (* l l bb))", "(< 0.0 l)", box("(* l l)", *c.p), box("bb", *c.b)]


def _elbow(c: Case) -> list[str]:
    """|num|^2 of (13) by |PP|^2, |pi|^2, k_e and t; |k_e| by the law of cosines."""
    small = number(1 - c.tilt**2)
    return [box("ll", *c.p), box("ii", *c.b), f"(<= (* 4.0 {small} ll ii) pp)", "(<= pp (* 4.0 ll ii))", "(<= 0.0 d1)",
            f"(<= d1 {number(c.d_high)})", f"(<= kk (* 2.0 {number(c.d_high)} l))", "(<= 0.0 kk)", "(= (* l l) ll)",
            "(< 0.0 l)", "(= h (- (* d1 d1 pp) (* kk kk ii)))", "(= tt (ite (< h 0.0) 0.0 h))",
            "(= nn (* pp (+ (* kk kk ii) tt)))", "(<= (* x x) nn)"]  # fmt: skip


def _u(c: Case) -> list[str]:
    size = SQRT3 / 2 if c.clamped else c.p_e
    return ["(< 0.0 k)", "(= ux (* k px))", "(= uy (* k py))", "(<= (* ux ux) 1.0)", "(<= (* uy uy) 1.0)",
            f"(<= {norm(*P)} (* {number(size)} {number(size)}))"]  # fmt: skip


@dataclass(frozen=True)
class Formula:
    """What a rule is about: facts of a case, and terms of which each lies in the rule's limits."""

    facts: Callable[[Case], list[str]]
    terms: tuple[str, ...]


def _side(c: Case) -> list[str]:
    return [*UNIT, box(norm(*PI), 0.0, SQRT3)]


def _g(size: Callable[[Case], list[str]]) -> Callable[[Case], list[str]]:
    """g = q_j v_y + q_k v_z, by Cauchy-Schwarz."""
    return lambda c: [*size(c), "(<= (* g g) (* (+ (* qj qj) (* qk qk)) (+ (* iy iy) (* iz iz))))"]


def _turned(low: Callable[[Case], float]) -> Callable[[Case], list[str]]:
    """A vector (ix, y) of at most that length, and a direction (r, u)."""
    return lambda c: ["(= (+ (* r r) (* u u)) 1.0)", box("(+ (* ix ix) (* y y))", 0.0, low(c))]


def _height(c: Case) -> list[str]:
    """hh = 4 d1^2 l^2 - k_e^2, m the shorter arm."""
    law = ["(<= 0.0 hh)", "(<= hh (* 4.0 l l m m))", "(<= 0.0 m)", f"(<= m {number(min(c.d_high, 0.5))})"]
    arm = ["(<= 0.0 d1)", f"(<= d1 {number(c.d_high)})", "(= ll (* l l))", "(< 0.0 l)"]
    return [*law, *arm, *_tilted(c)]


def _unit(c: Case) -> list[str]:
    return [*UNIT, *_pi(c)]


ROOT_OF = ["(<= 0.0 r)"]
FORMULAS: dict[str, Formula] = {
    "UNIT_SQ": Formula(_p, (norm(*P),)),
    "UNIT": Formula(lambda c: [*_p(c), *ROOT_OF, f"(= (* r r) {norm(*P)})"], ("r",)),
    "COSINE": Formula(
        lambda c: ["(= (+ (* s s) (* t t)) 1.0)", "(<= (* n n) ii)", "(< 0.0 l)", "(= (* l l) ii)", "(= (* v l) 1.0)"],
        ("s", "t", "(* 2.0 s t)", "(- (* 2.0 t t) 1.0)", "(* n v)"),
    ),
    "COSINE_SQ": Formula(lambda c: ["(= (+ (* s s) (* t t)) 1.0)"], ("(* 2.0 t t)",)),
    "SAME_DIRECTION": Formula(
        lambda c: [*_p(c), "(<= (* px px) 1.0)", "(<= (* py py) 1.0)", "(< 0.0 k)", "(= bx (* k px))",
                   "(= by (* k py))", box("(+ (* bx bx) (* by by))", *c.b)],
        ("(* px bx)", "(* py by)", "(+ (* px bx) (* py by))"),
    ),
    "PLANE_NUM": Formula(_plane, ("nx", "ny", "nz")),
    "PLANE": Formula(lambda c: [*_plane(c), "(= nx (* x l))"], ("x",)),
    "TARGET": Formula(
        lambda c: [f"(<= {number(2.0 ** c.j[0])} k)", "(= l (* k a))", "(<= a 1.0)", "(< 0.0 l)",
                   f"(<= l {number(c.p[1])})", "(= (* t k) (* l l))"],
        ("t",),
    ),
    "LAW": Formula(_law, ("k_e",)),
    "LAW_PLANE": Formula(lambda c: [*_pi(c), between(-c.k_e, "k_e", c.k_e)], ("(* ix k_e)",)),
    "LAW_PLANE_SQ": Formula(lambda c: [*_pi(c), between(-c.k_e, "k_e", c.k_e)], (f"(* k_e k_e {norm(*PI)})",)),
    "CROSS": Formula(lambda c: [*_p(c), *_pi(c)], tuple(CROSS)),
    "ORTHOGONAL": Formula(_tilted, ("(* 4.0 (- (* ll ii) o))",)),
    "ORTHOGONAL_ARM": Formula(lambda c: [*_pp(c), "(<= 0.0 d1)", f"(<= d1 {number(c.d_high)})"], ("(* d1 d1 pp)",)),
    "HEIGHT_SQ": Formula(_height, ("(- (* ii hh) (* 4.0 d1 d1 o))",)),
    "HEIGHT": Formula(lambda c: [*ROOT_OF, f"(<= (* r r) {number(c.tmp1[1])})"], ("r",)),
    "ELBOW_NUM": Formula(_elbow, ("x",)),
    "ELBOW": Formula(lambda c: [*_elbow(c), "(= x (* e pp))"], ("e",)),
    "ARMS_PRODUCT": Formula(lambda c: ["(<= 0.0 d1)", "(<= 0.0 d2)", "(<= (+ d1 d2) 1.0)"], ("(* d1 d2)",)),
    "ELBOW_SAME": Formula(_u, ("(* ux px)", "(* uy py)")),
    "ELBOW_UNIT": Formula(_u, ("(+ (* ux px) (* uy py))",)),
    "MIDDLE_SQ": Formula(lambda c: MANTISSA, (norm("mx", "my", "mz"),)),
    "MIDDLE": Formula(lambda c: [*MANTISSA, *ROOT_OF, f"(= (* r r) {norm('mx', 'my', 'mz')})"], ("r",)),
    "TURN": Formula(lambda c: ["(< 0.0 l)", f"(= (* l l) {norm('mx', 'my', 'mz')})", "(= mx (* q l))"], ("q",)),
    "PLANE_SQ": Formula(_pi, (norm(*PI),)),
    "PLANE_LENGTH": Formula(lambda c: [*_pi(c), *ROOT_OF, f"(= (* r r) {norm(*PI)})"], ("r",)),
    "PLANE_INVERSE": Formula(lambda c: [*_pi(c), "(< 0.0 r)", f"(= (* r r) {norm(*PI)})", "(= (* v r) 1.0)"], ("v",)),
    "TURNED": Formula(lambda c: UNIT, (R,)),
    "PART": Formula(_g(_unit), ("g",)),
    "PRODUCT": Formula(_g(_unit), ("(* 2.0 qi g)",)),
    "ROTATED": Formula(_turned(lambda c: c.b[1]), ("(- (* ix r) (* u y))",)),
    "SIDE_PART": Formula(_g(_side), ("g",)),
    "SIDE_PRODUCT": Formula(_g(_side), ("(* 2.0 qi g)",)),
    "SIDE": Formula(_turned(lambda c: SQRT3), ("(- (* ix r) (* u y))",)),
    "RESULT": Formula(
        lambda c: [*UNIT, "(= (+ (* s s) (* t t)) 1.0)"], ("(+ (* qi s) (* qj t))", "(- (* qj s) (* qi t))"),
    ),
}  # fmt: skip


DOT = f"(+ {' '.join(f'(* {a} {b})' for a, b in zip(P, PI, strict=True))})"
ALONG = [f"(- (* {PI[a]} {'xyz'[b]}) (* {PI[b]} {'xyz'[a]}))" for a, b in ((1, 2), (2, 0), (0, 1))]
LEMMAS: dict[str, tuple[list[str], str]] = {
    # what the formulas take for granted: facts, and what follows
    "Cauchy-Schwarz": ([f"(= g {G})"], "(<= (* g g) (* (+ (* qj qj) (* qk qk)) (+ (* iy iy) (* iz iz))))"),
    "Lagrange": ([], f"(= {norm(*CROSS)} (* 4.0 (- (* {norm(*P)} {norm(*PI)}) (* {DOT} {DOT}))))"),
    "half turn": ([*UNIT, "(= (* n n) (+ (* qj qj) (* qk qk)))"], f"(= (+ (* {R} {R}) (* 4.0 qi qi n n)) 1.0)"),
    "elbow": (  # (13) along pi x PP and PP, which are at right angles, PP being (x, y, z)
        ["(= (+ (* ix x) (* iy y) (* iz z)) 0.0)"],
        f"(= {norm(*(f'(+ (* k {a}) (* t {b}))' for a, b in zip(ALONG, 'xyz', strict=True)))}"
        f" (* {norm('x', 'y', 'z')} (+ (* k k {norm(*PI)}) (* t t))))",
    ),
    "plane": (  # (11): two terms at right angles
        ["(= (+ (* s s) (* t t)) 1.0)", f"(= (* l l) {norm(*P)})", "(= bx (* k px))", "(= by (* k py))"],
        f"(= {norm('(+ (* s pz bx) (* l t by))', '(- (* s pz by) (* l t bx))', '(* s (+ (* px bx) (* py by)))')}"
        f" (* l l (+ (* bx bx) (* by by))))",
    ),
    "shorter arm": (
        ["(= k_e (- (+ (* a a) (* d1 d1)) (* d2 d2)))", "(<= 0.0 d1)", "(<= 0.0 d2)", "(= m (ite (< d1 d2) d1 d2))"],
        "(<= (- (* 4.0 d1 d1 a a) (* k_e k_e)) (* 4.0 a a m m))",
    ),
    "reached": (
        ["(= k_e (- (+ (* a a) (* d1 d1)) (* d2 d2)))", "(<= (- d1 d2) a)", "(<= (- d2 d1) a)", "(<= a (+ d1 d2))",
         "(<= 0.0 d1)", "(<= 0.0 a)"],
        "(<= 0.0 (- (* 4.0 d1 d1 a a) (* k_e k_e)))",
    ),
    "shorter than 1/2": (["(<= (+ d1 d2) 1.0)", "(= m (ite (< d1 d2) d1 d2))"], "(<= m 0.5)"),
}  # fmt: skip

BEFORE = ("UNIT_SQ", "UNIT", "SAME_DIRECTION", "PLANE_NUM", "PLANE", "TARGET", "COSINE", "COSINE_SQ")
"""Rules of nodes before the words of the swivel plane stand for exact ones."""


def seeded(bug: Bug) -> dict[str, Rule]:
    """The rules with a bug in one."""
    of = MODULES[bug.file.split("/")[-1].removesuffix(".py")]
    module = ModuleType(of.__name__)
    module.__package__ = of.__package__
    exec(compile(bug.seeded((ROOT / bug.file).read_text()), bug.what, "exec"), module.__dict__)
    return {**named(), **{name: rule for name, rule in vars(module).items() if isinstance(rule, Rule)}}


def named() -> dict[str, Rule]:
    """The rules that have a name in the dataflow."""
    return {n: r for module in MODULES.values() for n, r in vars(module).items() if isinstance(r, Rule)}


@cache
def reached(width: int) -> tuple[Case, ...]:
    """The cases as they are behind the swivel plane: with the tilt of its words."""
    return tuple(Ranges(width, case).run().case for case in cases(width))


def questions(rules: dict[str, Rule] | None = None, width: int = FULL) -> Iterator[Question]:
    """A question a lemma, and a rule and a term of it, of all cases."""
    for name, (given, claim) in LEMMAS.items():
        yield Question(name, claim, "", partial(_all, (real_formula(given, claim),)))
    for name, formula in FORMULAS.items():
        rule = (rules or named())[name]
        texts: list[list[str]] = [[] for _ in formula.terms]
        met = []
        for case in cases(width) if name in BEFORE else reached(width):
            if case.long and name in LONG_OPEN:
                continue
            low, high = rule.limit(case)
            slack = SLACK * max(abs(low), abs(high))
            met.append(real_formula(formula.facts(case), "false"))
            for of, term in zip(texts, formula.terms, strict=True):
                of.append(real_formula(formula.facts(case), between(low - slack, term, high + slack)))
        for number_, of in enumerate(texts):
            label = f"{name}, {number_ + 1}" if len(texts) > 1 else name
            distinct = tuple(dict.fromkeys(of))
            meet = partial(_all, tuple(met), "sat")
            yield Question(label, rule.why, f"{len(distinct)} cases", partial(_all, distinct), meet)


def _all(texts: tuple[str, ...], wanted: str = "unsat") -> Answer:
    seconds = 0.0
    for text in dict.fromkeys(texts):
        answer = ask(text, SOLVER, LIMIT)
        seconds += answer.seconds
        if answer.said != wanted:
            return Answer(answer.said, seconds)
    return Answer(wanted, seconds)


PAPER, TURNS = "model/dataflow/paper.py", "model/dataflow/paper_turns.py"
BUGS = (
    Bug("half of Cauchy-Schwarz", PAPER,
        '<= 2 sqrt 6", upto(lambda c: c.pp[1])', '<= 2 sqrt 6", upto(lambda c: c.pp[1] / 2)', "CROSS, 1"),
    Bug("K of d1 |p_w|", PAPER,
        'by the law of cosines", upto(lambda c: c.k_e)', 'by the law of cosines", upto(lambda c: c.k_e / 2)', "LAW"),
    Bug("PP^- longer than it is", PAPER,
        "lambda c: (c.pp[0] ** 2, c.pp[1] ** 2),", "lambda c: (1.01 * c.pp[0] ** 2, c.pp[1] ** 2),", "ORTHOGONAL"),
    Bug("an elbow nearer than d1", PAPER, "upto(lambda c: c.p_e),\n", "upto(lambda c: 0.99 * c.p_e),\n", "ELBOW"),
    Bug("three components as two", TURNS,
        '"the same of L_m", lambda c: (0.25, 3.0)', '"the same of L_m", lambda c: (0.25, 2.0)', "MIDDLE_SQ"),
    Bug("a turn shortens", TURNS,
        '"pi_swivel times a unit vector", upto(lambda c: c.b[1])',
        '"pi_swivel times a unit vector", upto(lambda c: c.b[0])', "ROTATED"),
)  # fmt: skip

ABOUT = """\
A rule narrows a node's range in each case of `interval_cases.py`; the limits asked for are those that it gives
there, with the box of lengths and, behind the swivel plane, the tilt that its words have in the run of
`model/bounds/ranges.py` at W = 32. What a rule is about is a formula, typed, in exact arithmetic
(`tb/formal/paper_rules.py`); lemmas come first. Not proved here: `ARMS`, `NOT_NEAR`, `FOREARM`, the law of cosines of
`t_e`, and `LAW` and `HEIGHT_SQ` of arms that halving rounds; nor how errors grow."""

PAPER_RULES = Part(
    "paper rules", "Rules of the paper's datapath", ABOUT, questions, lambda bug: questions(seeded(bug)), BUGS,
)  # fmt: skip

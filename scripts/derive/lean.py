# SPDX-License-Identifier: Apache-2.0
"""Derives the lean dataflow from the paper's equations (10)-(18), with symbols, and writes docs/lean.md.

    python -m scripts.derive.lean [--check]     writes the page; with --check compares it, status 1 if it is stale

The paper's side of every comparison is the table of model/reference/printed.py with the one edit that
scripts/derive/paper.py proves
to be needed. The lean side is the table of model/reference/lean_table.py; a test holds
model/reference/lean_equations.py against it.
Either way the status is 1 when a statement does not hold, and the step is named.
"""

from __future__ import annotations

import argparse
import copy
import itertools
import sys
from collections.abc import Callable
from dataclasses import dataclass, field

import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

from model.reference import cga
from model.reference.lean_table import HALF, LEAN, NUMBER
from scripts.derive import paper
from scripts.derive.paper import cross, dot, evaluate
from tb.sim.env import ROOT

PAGE = ROOT / "docs" / "lean.md"

# -- the two dataflows -----------------------------------------------------------------------------------------------

HALVES = {
    "az": ("-u_y", "u_x", "az_sq"),
    "tilt": ("sin_el", "cos_el", "tilt_sq"),
    "arm": ("cos_a", "sin_a", "arm_sq"),
}
"""Half angle quaternion -> cosine and sine of the angle, and the line that is the squared length."""

MATRIX = {
    "Directions of the target": {
        "p_x": "cos_el*u_x",
        "p_y": "cos_el*u_y",
        "v_x": "sin_el*u_x",
        "v_y": "sin_el*u_y",
    },
    "Columns": {
        "n_x": "cos_phi*u_y + sin_phi*v_x",
        "n_y": "sin_phi*v_y - cos_phi*u_x",
        "n_z": "-sin_phi*cos_el",
        "m_x": "sin_phi*u_y - cos_phi*v_x",
        "m_y": "-cos_phi*v_y - sin_phi*u_x",
        "m_z": "cos_phi*cos_el",
        "e_x": "cos_a*p_x + sin_a*m_x",
        "e_y": "cos_a*p_y + sin_a*m_y",
        "e_z": "cos_a*sin_el + sin_a*m_z",
        "f_x": "e_z*n_y - e_y*n_z",
        "f_y": "e_x*n_z - e_z*n_x",
        "f_z": "e_y*n_x - e_x*n_y",
    },
    "Four sums and what goes with them": {
        "sum_w": "1 - n_x + f_y + e_z",
        "sum_i": "1 - n_x - f_y - e_z",
        "sum_j": "1 + n_x + f_y - e_z",
        "sum_k": "1 + n_x - f_y + e_z",
        "w_i": "f_z - e_y",
        "w_j": "e_x + n_z",
        "w_k": "-n_y - f_x",
        "i_j": "f_x - n_y",
        "i_k": "e_x - n_z",
        "j_k": "e_y + f_z",
    },
    "The row of the largest sum": {
        "g_q": "rsqrt(largest)",
        "q_0": "largest*g_q/2",
        "q_1": "other_1*g_q/2",
        "q_2": "other_2*g_q/2",
        "q_3": "other_3*g_q/2",
    },
}
"""The shoulder from the rotation matrix with the columns -n, f, e: in place of "Product" and "Root, second level"."""


@dataclass
class Tables:
    """What is compared. A test alters copies of it."""

    lean: dict = field(default_factory=lambda: copy.deepcopy(LEAN))
    half: dict = field(default_factory=lambda: copy.deepcopy(HALF))
    matrix: dict = field(default_factory=lambda: copy.deepcopy(MATRIX))
    printed: dict = field(default_factory=lambda: corrected())


def corrected() -> dict[str, dict[str, str]]:
    """The paper's equations as scripts/derive/paper.py has proved them: the print, its wrong rows mended."""
    table = copy.deepcopy(paper.PRINTED)
    for (equation, name), edit in paper.KNOWN_WRONG.items():
        assert table[equation][name].count(edit[0]) == 1
        table[equation][name] = table[equation][name].replace(*edit)
    return table


# -- symbols ---------------------------------------------------------------------------------------------------------

TEX = {
    "x": "x", "y": "y", "z": "z", "phi": r"\phi", "d1": "d_1", "d2": "d_2", "d_sum": "d_+", "d_dif": "d_-",
    "rho_sq": r"\rho^2", "s": "s", "a_far": "A", "b_near": "B", "k_law": "K",
    "inv_rho": r"\mathrm{inv}_\rho", "inv_s": r"\mathrm{inv}_s", "inv_far": r"\mathrm{inv}_{far}",
    "inv_near": r"\mathrm{inv}_{near}", "inv_1": r"\mathrm{inv}_1", "inv_2": r"\mathrm{inv}_2",
    "inv_12": r"\mathrm{inv}_{12}", "inv_11": r"\mathrm{inv}_{11}", "inv_law": r"\mathrm{inv}_{law}",
    "inv_q": r"\mathrm{inv}_q", "root_rho": r"\mathrm{root}_\rho", "root_far": r"\mathrm{root}_{far}",
    "root_near": r"\mathrm{root}_{near}", "root_ab": r"\mathrm{root}_{ab}",
    "u_x": "u_x", "u_y": "u_y", "sin_el": r"\sin_{el}", "cos_el": r"\cos_{el}",
    "qe_w": r"\langle Q_e\rangle", "qe_i": r"\langle Q_e\rangle_i", "cos_a": r"\cos_a", "sin_a": r"\sin_a",
    "sin_h": r"\sin_h", "cos_h": r"\cos_h",
    "cc": r"\mathrm{cc}", "ss": r"\mathrm{ss}", "sc": r"\mathrm{sc}", "cs": r"\mathrm{cs}",
    "c_plus": "c_+", "s_plus": "s_+", "c_minus": "c_-", "s_minus": "s_-", "length_sq": "|q|^2",
    "qs_w": r"\langle Q_s\rangle", "qs_i": r"\langle Q_s\rangle_i", "qs_j": r"\langle Q_s\rangle_j",
    "qs_k": r"\langle Q_s\rangle_k", "c": "c", "cos_phi": r"\cos_\phi", "sin_phi": r"\sin_\phi",
    "rho": r"\rho", "dist": "|p|", "sqrt_a": r"\sqrt{A}", "sqrt_b": r"\sqrt{B}", "sqrt_1": r"\sqrt{d_1}",
    "sqrt_2": r"\sqrt{d_2}", "length": "|q|", "sigma": r"\sigma", "gamma": r"\gamma", "delta": r"\delta",
    "a": "a", "b": "b", "largest": r"\Sigma", "g_q": r"g_\Sigma",
}  # fmt: skip
TEX |= {f"{name}_{part}": rf"\mathrm{{{name}}}_{part}" for name in HALVES for part in "cs"}
TEX |= {f"{name}_sq": rf"|\mathrm{{{name}}}|^2" for name in HALVES}
TEX |= {f"{unit}_{n}": f"{unit}_{n}" for unit in "wijk" for n in "01"}
TEX |= {f"r_{unit}": f"r_{unit}" for unit in "wijk"} | {f"q_{n}": f"q_{n}" for n in range(4)}
TEX |= {f"{v}_{axis}": f"{v}_{axis}" for v in "pvnmef" for axis in "xyz"}
TEX |= {f"sum_{unit}": rf"\Sigma_{unit}" for unit in "wijk"}
TEX |= {f"{pair}": rf"\Sigma_{{{pair.replace('_', '')}}}" for pair in ("w_i", "w_j", "w_k", "i_j", "i_k", "j_k")}
TEX |= {f"other_{n}": rf"\Sigma'_{n}" for n in (1, 2, 3)}
TEX |= {f"shift_{name}": f"k_{tail}" for name, tail in
        (("rho_sq", r"\rho"), ("s", "s"), ("a_far", "A"), ("b_near", "B"), ("d1", "1"), ("d2", "2"))}  # fmt: skip

SYMBOL = {name: sp.Symbol(name, real=True) for name in TEX}
_NAMES = {symbol: TEX[name] for name, symbol in SYMBOL.items()}
ROOT_OF = {"rho_sq": "rho", "s": "dist", "a_far": "sqrt_a", "b_near": "sqrt_b", "d1": "sqrt_1", "d2": "sqrt_2"}
"""A root's argument -> the symbol that is its square root."""


def symbols(names: str) -> list[sp.Symbol]:
    return [SYMBOL[name] for name in names.split()]


class rsqrt(sp.Function):  # noqa: N801 - the name in the tables
    """Reciprocal square root, as one operation."""

    def _latex(self, printer, exp=None):
        return rf"\frac{{1}}{{\sqrt{{{printer._print(self.args[0])}}}}}"


def latex(expression) -> str:
    return sp.latex(expression, symbol_names=_NAMES)


class half_c(sp.Function):  # noqa: N801 - the name in the table
    """A part of h(c, s)."""

    def _latex(self, printer, exp=None):
        return rf"h_{type(self).__name__[-1]}({', '.join(map(printer._print, self.args))})"


class half_s(half_c):  # noqa: N801
    """The other."""


FUNCTIONS = {"rsqrt": rsqrt, "Abs": sp.Abs, "half_c": half_c, "half_s": half_s, "cos": sp.cos, "sin": sp.sin}


def tree(text: str) -> sp.Expr:
    """A line as it is written: nothing is evaluated."""
    return parse_expr(text, local_dict=SYMBOL | FUNCTIONS, evaluate=False)


def line_tex(text: str) -> str:
    return sp.latex(tree(text), symbol_names=_NAMES, order="none")


def lines(table: dict) -> dict[str, str]:
    """All lines of all groups."""
    return {name: text for group in table.values() for name, text in group.items()}


# -- proofs ----------------------------------------------------------------------------------------------------------

Relations = dict[str, tuple[sp.Symbol, sp.Expr]]
"""LaTeX -> (v, expression without v that is v^2). An expression has no v of a relation above it."""


def reduced(expression, relations: Relations) -> tuple[sp.Expr, sp.Expr, list[str]]:
    """(n, d, used): the expression is n/d, and no symbol of a relation has a power above 1 in n or d.

    That form is unique: n is 0 exactly if the numerator is in the ideal of the relations.
    """
    expression = sp.sympify(expression)
    divides = any(power.exp.is_negative for power in expression.atoms(sp.Pow))
    used: dict[str, None] = {}
    parts = []
    for part in sp.fraction(sp.together(expression)) if divides else (expression, sp.Integer(1)):
        part = sp.expand(part)
        for label, (v, square) in relations.items():
            powers = sp.Poly(part, v)
            if powers.degree() > 1:
                used[label] = None
                part = sp.expand(sum(c * square ** (n // 2) * v ** (n % 2) for (n,), c in powers.terms()))
        parts.append(part)
    assert parts[1] != 0, "a denominator vanishes identically"
    return parts[0], parts[1], list(used)


def normal(expression, relations: Relations) -> sp.Expr:
    """A form to show: reduced, cancelled, factored."""
    numerator, denominator, _ = reduced(expression, relations)
    return sp.factor(sp.cancel(numerator / denominator))


@dataclass
class Check:
    """One statement and how it came out."""

    statement: str  # LaTeX
    holds: bool
    method: str
    rest: str = ""  # of a statement that does not hold


@dataclass
class Step:
    """A section of the page."""

    title: str
    text: list[str]
    shown: list[tuple[str, str]] = field(default_factory=list)  # LaTeX of both sides, as derived
    checks: list[Check] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    extra: list[str] = field(default_factory=list)  # lines of the page

    def equal(self, statement: str, left, right, relations=None, more: str = "", root=None) -> None:
        """Decides left = right by expansion modulo the relations; of lists, all components.

        root: the function that has recognized a root.
        """
        lefts, rights = (list(side) if isinstance(side, (list, sp.MatrixBase)) else [side] for side in (left, right))
        used, rests = dict.fromkeys(root.used if root else ()), []
        for one, other in zip(lefts, rights, strict=True):
            rest, _, of_this = reduced(sp.sympify(one) - other, relations or {})
            used |= dict.fromkeys(of_this)
            rests.append(rest)
        method = "expansion" + (f" of all {len(lefts)} components" if len(lefts) > 1 else "")
        method += f", modulo {', '.join(f'${_cell(u)}$' for u in used)}" if used else ""
        method += (", a root recognized by its square" if root else "") + more
        wrong = [latex(rest) for rest in rests if rest != 0]
        self.checks.append(Check(statement, not wrong, method, r",\ ".join(wrong)))

    def true(self, statement: str, holds: bool, method: str, rest: str = "") -> None:
        self.checks.append(Check(statement, bool(holds), method, "" if holds else rest or "false"))


def _cell(formula: str) -> str:
    return formula.replace("|", r"\vert ")


def known_root(candidates: list[sp.Expr], relations: Relations) -> Callable:
    """A sqrt() that answers with the candidate, not negative by what it stands for, whose square the argument is.

    Its `used` are the relations that took part.
    """

    def root(argument):
        for candidate in candidates:
            rest, _, used = reduced(argument - candidate**2, relations)
            if rest == 0:
                root.used |= dict.fromkeys(used)
                return candidate
        return sp.Symbol("unrecognized")

    root.used = {}
    return root


# -- what the steps share --------------------------------------------------------------------------------------------


def run_lines(table: dict, groups: list[str], values: dict[str, sp.Expr]) -> dict[str, sp.Expr]:
    """Works out the groups' lines from the values of other names. A root must be given its value by name."""
    values = dict(values)
    for group in groups:
        for name, text in table[group].items():
            if name not in values:
                # evaluate() takes `abs`, and knows the names that it is given
                values[name] = evaluate(text.replace("Abs(", "abs("), **values)
    return values


def first_half(tables: Tables) -> tuple[dict[str, sp.Expr], Relations]:
    """Lines down to the triangle in x, y, z, d1, d2 and six square roots, with what those are."""
    inputs = {name: SYMBOL[name] for name in ("x", "y", "z", "d1", "d2")}
    values = run_lines(tables.lean, ["Sums of the inputs"], inputs)
    relations: Relations = {}
    for name, text in tables.lean["Roots, first level"].items():
        argument = text.removeprefix("rsqrt(").removesuffix(")")
        root = SYMBOL[ROOT_OF[argument]]
        square = sp.expand(values[argument])
        right = latex(square) if argument in ("rho_sq", "s") else TEX[argument]
        left = TEX[str(root)]
        left = rf"\left({left}\right)" if left.startswith(r"\sqrt") else left
        relations[f"{left}^2 = {right}"] = (root, square)
        values[name] = 1 / root
    return run_lines(tables.lean, ["Directions", "Triangle"], values), relations


def sums_of_s(tables: Tables) -> dict[str, sp.Expr]:
    """The sums of the inputs with s as a symbol, to show."""
    return run_lines(tables.lean, ["Sums of the inputs"], {n: SYMBOL[n] for n in ("x", "y", "z", "s", "d1", "d2")})


U_X, U_Y, SE, CE, CA, SA, CP, SP = symbols("u_x u_y sin_el cos_el cos_a sin_a cos_phi sin_phi")
C2, S2 = symbols("cos_h sin_h")
D, RHO, D1, D2 = symbols("dist rho d1 d2")
CIRCLES: Relations = {
    "u_x^2 + u_y^2 = 1": (U_Y, 1 - U_X**2),
    r"\sin_{el}^2 + \cos_{el}^2 = 1": (CE, 1 - SE**2),
    r"\cos_a^2 + \sin_a^2 = 1": (SA, 1 - CA**2),
    r"\cos_\phi^2 + \sin_\phi^2 = 1": (SP, 1 - CP**2),
}
HALF_CIRCLE: Relations = {r"\cos_h^2 + \sin_h^2 = 1": (S2, 1 - C2**2)}
ANGLES = {name: SYMBOL[name] for name in ("u_x", "u_y", "sin_el", "cos_el", "cos_a", "sin_a", "cos_phi", "sin_phi")}
P_UNIT = [CE * U_X, CE * U_Y, SE]  # p/|p|


def target() -> dict[str, sp.Expr]:
    """p_w of the paper in the directions of step 1."""
    return dict(zip(("p_wx", "p_wy", "p_wz"), [D * v for v in P_UNIT], strict=True))


def frame(tables: Tables) -> dict[str, list[sp.Expr]]:
    """n, m, e, f of the matrix form, as vectors of the angles' sines and cosines."""
    values = run_lines(tables.matrix, ["Directions of the target", "Columns"], ANGLES)
    return {v: [values[f"{v}_{axis}"] for axis in "xyz"] for v in "nmef"}


def turn(axis: str, c, s) -> sp.Matrix:
    """Right-handed rotation about a coordinate axis by the angle with cosine c and sine s."""
    if axis == "z":
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return sp.Matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def rotation_matrix(quaternion) -> sp.Matrix:
    """Of Q v Q~ with a quaternion of any length, from the algebra."""
    columns = [paper.normal_vector(cga.rotate(cga.quaternion(*quaternion), e)) for e in (cga.e1, cga.e2, cga.e3)]
    return sp.Matrix([[sp.expand(sp.sympify(columns[n][m])) for n in range(3)] for m in range(3)])


# -- the steps -------------------------------------------------------------------------------------------------------


def _directions(tables: Tables) -> Step:
    values, relations = first_half(tables)
    x, y, z = symbols("x y z")
    step = Step(
        "1. The target's directions, (10)",
        [
            r"The lean lines down to $Q_e$, $\cos_a$ and $\sin_a$ are worked out with the roots of their arguments as "
            "symbols that are not negative; the relations say what their squares are. Off the z axis, inside the "
            "limits of reach, no root is 0. The three circles below are relations of the later steps, and so are the "
            "last five statements, which put the target in polar form."
        ],
    )
    step.shown = [(TEX[name], latex(sp.factor(values[name]))) for name in tables.lean["Directions"]]
    printed_length = evaluate(tables.printed["10"]["L_sw"], p_wx=x, p_wy=y, p_wz=z)
    step.equal("|L_{sw}|^2 = s", printed_length**2, values["s"], relations)
    step.equal("u_x^2 + u_y^2 = 1", values["u_x"] ** 2 + values["u_y"] ** 2, 1, relations)
    step.equal(r"\sin_{el}^2 + \cos_{el}^2 = 1", values["sin_el"] ** 2 + values["cos_el"] ** 2, 1, relations)
    step.equal(r"\cos_a^2 + \sin_a^2 = 1", values["cos_a"] ** 2 + values["sin_a"] ** 2, 1, relations)
    step.equal(r"x = |p|\,\cos_{el}\,u_x", x, D * values["cos_el"] * values["u_x"], relations)
    step.equal(r"y = |p|\,\cos_{el}\,u_y", y, D * values["cos_el"] * values["u_y"], relations)
    step.equal(r"z = |p|\,\sin_{el}", z, D * values["sin_el"], relations)
    step.equal(r"\rho = |p|\,\cos_{el}", RHO, D * values["cos_el"], relations)
    step.equal(r"K = 2 d_1 |p|\,\cos_a", values["k_law"], 2 * D1 * D * values["cos_a"], relations)
    return step


def _swivel(tables: Tables) -> Step:
    plane = _plane(tables)
    relations = CIRCLES | HALF_CIRCLE
    full = {CP: C2**2 - S2**2, SP: 2 * C2 * S2}
    step = Step(
        "2. The swivel plane, (11)",
        [
            "(11) with the square that the print lacks ([derivation.md](derivation.md)), the target in polar form, "
            r"$\cos\frac\phi2 = \cos_h$ and $\sin\frac\phi2 = \sin_h$. The plane comes out $\rho$ long, so "
            r"$n = \pi_{swivel}/\rho$ needs no root of its own; sine and cosine are those of the whole $\phi$."
        ],
    )
    n = frame(tables)["n"]
    step.shown = [
        (rf"\pi_{{swivel{axis}}}/\rho", latex(normal(derived / (D * CE), relations)))
        for axis, derived in zip("xyz", plane, strict=True)
    ]
    lean = r",\ ".join(latex(sp.expand(v)) for v in n)
    step.equal(rf"n = \left({lean}\right)", [v / (D * CE) for v in plane], [v.subs(full) for v in n], relations)
    step.equal(r"\cos_\phi^2 + \sin_\phi^2 = 1", (full[CP]) ** 2 + full[SP] ** 2, 1, relations)
    step.equal("|n|^2 = 1", dot(n, n), 1, CIRCLES)
    step.equal(r"n \cdot p = 0", dot(n, P_UNIT), 0, CIRCLES)
    return step


def _plane(tables: Tables) -> list[sp.Expr]:
    half = {sp.cos(paper.SYMBOL["phi"] / 2): C2, sp.sin(paper.SYMBOL["phi"] / 2): S2}
    return [evaluate(tables.printed["11"][f"pi_{a}"], **target(), L_sw=D).subs(half) for a in "xyz"]


def _elbow(tables: Tables) -> Step:
    vectors = frame(tables)
    n, m, e = vectors["n"], vectors["m"], vectors["e"]
    values, roots = first_half(tables)
    (K,) = symbols("k_law")
    law = {"d_2^2 = |p|^2 + d_1^2 - K": (D2, D**2 + D1**2 - K)}
    relations = {r"K = |p|^2 + d_1^2 - d_2^2 = 2 d_1 |p|\,\cos_a": (D2, D**2 + D1**2 - 2 * D1 * D * CA)} | CIRCLES
    step = Step(
        "3. The elbow, (12) and (13)",
        [
            r"(12) with $\pi_{swivel} = \rho\,n$, and (13) with that pair. The sum in $PP_i, PP_j, PP_k$ is $K$; "
            r"$\mathrm{tmp}_1$ factors into $A$ and $B$. $K$ is the cosine of the angle at the shoulder (law of "
            r"cosines), $\sqrt{A}\sqrt{B}$ its sine. So the elbow point is $d_1$ times a unit vector $e = "
            r"\cos_a\,p/|p| + \sin_a\,m$ with $m = n \times p/|p|$; $\rho$, $|p|$ and $\mathrm{inf}_{PP}$ cancel. "
            r"$\sin_a$ is a product of roots over lengths, so it is not negative."
        ],
    )
    given = target() | dict(zip(("pi_x", "pi_y", "pi_z"), [D * CE * v for v in n], strict=True)) | {"d1": D1, "d2": D2}
    pair = {name: evaluate(text, **given) for name, text in tables.printed["12"].items()}
    rows = tables.printed["13"]
    inf_PP, tmp1 = evaluate(rows["inf_PP"], **pair), evaluate(rows["tmp1"], **pair)
    step.equal("K = |p|^2 + d_1^2 - d_2^2", values["k_law"], values["s"] + D1**2 - D2**2)
    units = [pair[f"PP_{unit}"] for unit in "ijk"]
    step.equal(r"(PP_i, PP_j, PP_k) = \tfrac12 \rho K\,n", units, [D * CE * v * K / 2 for v in n], law | CIRCLES)
    step.equal(r"\mathrm{inf}_{PP} = \rho^2 |p|^2", inf_PP, D**4 * CE**2, CIRCLES)
    step.equal(
        r"\mathrm{tmp}_1 = \tfrac14 \rho^2 \left(4 d_1^2 s - K^2\right)",
        tmp1, (D * CE) ** 2 * (4 * D1**2 * D**2 - K**2) / 4, law | CIRCLES,
    )  # fmt: skip
    brief = sums_of_s(tables)
    factors = sp.factor(sp.expand(4 * D1**2 * brief["s"] - brief["k_law"] ** 2))
    step.shown.append(("4 d_1^2 s - K^2", latex(factors)))
    step.equal("4 d_1^2 s - K^2 = A B", 4 * D1**2 * values["s"] - values["k_law"] ** 2,
               values["a_far"] * values["b_near"])  # fmt: skip
    root = D * CE * D1 * D * SA
    sqrt = known_root([root], relations)
    tmp_sqr = evaluate("sqrt(tmp1)", tmp1=tmp1, sqrt=sqrt)
    step.equal(r"\mathrm{tmp}_{sqr} = \rho\,d_1 |p|\,\sin_a", tmp_sqr, root, root=sqrt)
    elbow = [evaluate(rows[f"p_e{axis}"], **pair, tmp_sqr=root, inf_PP=sp.Integer(1)) for axis in "xyz"]
    both = r", both sides times $\mathrm{inf}_{PP}$"
    step.equal("p_e = d_1 e", elbow, [D**4 * CE**2 * D1 * v for v in e], relations, both)
    lean = r",\ ".join(latex(v) for v in m)
    step.equal(rf"n \times p/|p| = m = \left({lean}\right)", cross(n, P_UNIT), m, CIRCLES)
    step.equal("|e|^2 = 1", dot(e, e), 1, CIRCLES)
    step.equal(r"n \cdot e = 0", dot(n, e), 0, CIRCLES)
    back = [CA * a - SA * b for a, b in zip(e, cross(n, e), strict=True)]
    step.equal(r"p/|p| = \cos_a e - \sin_a\,n \times e", P_UNIT, back, CIRCLES)
    step.notes.append(
        r"With a pair scaled by 2, as (19) has it, the factor $\tfrac14$ of $\mathrm{tmp}_1$ is 1; $p_e$ is the same."
    )
    return step


def _elbow_quaternion(tables: Tables) -> Step:
    values, roots = first_half(tables)
    e = frame(tables)["e"]
    step = Step(
        "4. The elbow quaternion, (14)",
        [
            r"(14) with $p_e = d_1 e$. What is left of $c_4$ is the law of cosines, and $1 \pm c_4$ are $A$ and $B$ "
            r"over $2 d_1 d_2$: $Q_e$ needs no elbow point, and $1 \pm c_4$ is never formed."
        ],
    )
    given = target() | {f"p_e{a}": D1 * v for a, v in zip("xyz", e, strict=True)} | {"d1": D1, "d2": D2}
    c4 = evaluate(tables.printed["14"]["c_4"], **given)
    step.equal(r"c_4 = (d_1 - |p|\,\cos_a)/d_2", c4, (D1 - D * CA) / D2, CIRCLES)
    law = (D1 - values["k_law"] / (2 * D1)) / D2  # |p| cos a = K/(2 d_1) by step 1
    shown = (D1 - sums_of_s(tables)["k_law"] / (2 * D1)) / D2
    for op, square, name in (("+", "a_far", "A"), ("-", "b_near", "B")):
        side = (1 + law if op == "+" else 1 - law) / 2
        brief = (1 + shown if op == "+" else 1 - shown) / 2
        step.shown.append((rf"\tfrac12 (1 {op} c_4)", latex(sp.factor(brief))))
        step.equal(rf"\tfrac12 (1 {op} c_4) = {name} / (4 d_1 d_2)", side, values[square] / (4 * D1 * D2))
    sqrt_a, sqrt_b, sqrt_1, sqrt_2 = symbols("sqrt_a sqrt_b sqrt_1 sqrt_2")
    sqrt = known_root([sqrt_a / (2 * sqrt_1 * sqrt_2), sqrt_b / (2 * sqrt_1 * sqrt_2)], roots)
    for name in ("qe_w", "qe_i"):
        printed = evaluate(tables.printed["14"][name], c_4=law, sqrt=sqrt)
        statement = f"{TEX[name]} = {line_tex(lines(tables.lean)[name])}"
        step.equal(statement, printed, values[name], roots, root=sqrt)
    step.equal(
        r"\langle Q_e\rangle^2 + \langle Q_e\rangle_i^2 = 1", values["qe_w"] ** 2 + values["qe_i"] ** 2, 1, roots
    )
    return step


def _shoulder(tables: Tables) -> Step:
    r = symbols("r_w r_i r_j r_k")
    g, sigma = symbols("gamma sigma")
    unit: Relations = {
        r"\gamma^2 = r_w^2 + r_k^2": (g, r[0] ** 2 + r[3] ** 2),
        "|r|^2 = 1": (r[0], 1 - r[1] ** 2 - r[2] ** 2 - r[3] ** 2),
        r"\sigma^2 = 1": (sigma, sp.Integer(1)),
    }
    turned = rotation_matrix(r)
    n, f, e = [-turned[m, 0] for m in range(3)], [turned[m, 1] for m in range(3)], [turned[m, 2] for m in range(3)]
    step = Step(
        "5. The shoulder quaternion, (15)-(18)",
        [
            r"$-n$, $e \times (-n)$ and $e$ are orthogonal unit vectors (steps 2 and 3), so there is one rotation $R$ "
            "that brings $e_1, e_2, e_3$ there: the matrix with these columns. It is the rotation of a unit "
            "quaternion $r = r_w + r_i i + r_j j + r_k k$, which is unique up to its sign. So this step puts $n = -r "
            r"e_1 \tilde r$ and $e = r e_3 \tilde r$ into (15)-(18), with the four components as symbols: that covers "
            r"every pose. Out comes $r$ itself, with the sign $\sigma$ of $r_k$. $\gamma = \sqrt{r_w^2 + r_k^2}$ is 0 "
            "for an elbow on the negative z axis, where the print is 0/0, as it is for an elbow on the positive one, "
            r"$e_z = 1$. $\mathrm{side}$ is what (17) calls sign at first."
        ],
    )
    rows = tables.printed["15"]
    p_e = {f"p_e{a}": D1 * v for a, v in zip("xyz", e, strict=True)} | {"d1": D1}
    length = 2 * D1**3 * (1 - e[2]) * g
    sqrt = known_root([length], unit)
    derived = evaluate(rows["L_m"], tmp2=evaluate(rows["tmp2"], **p_e), sqrt=sqrt)
    step.equal(r"|L_m| = 2 d_1^3 (1 - e_z)\,\gamma", derived, length, root=sqrt)
    q12 = {}
    for name, right in (("q12_i", e[0] / (2 * g)), ("q12_j", e[1] / (2 * g)), ("q12_k", g)):
        label = {"q12_i": r"e_x / (2 \gamma)", "q12_j": r"e_y / (2 \gamma)", "q12_k": r"\gamma"}[name]
        step.equal(f"{paper.TEX[name]} = {label}", evaluate(rows[name], **p_e, L_m=length), right, unit)
        q12[name] = right
    image = rotation_matrix([sp.Integer(0), *q12.values()])
    step.equal(r"Q_{12} e_3 \tilde Q_{12} = e", image[:, 2], e, unit)

    rows = tables.printed["17"]
    along = [CA * a - SA * b for a, b in zip(e, cross(n, e), strict=True)]
    given = q12 | {f"pi_{a}": RHO * v for a, v in zip("xyz", n, strict=True)}
    given |= {f"p_w{a}": D * v for a, v in zip("xyz", along, strict=True)}
    given |= {"sqrt": known_root([RHO], unit)}
    c3 = evaluate(rows["c_3"], **given)
    step.equal(r"c_3 = (r_k^2 - r_w^2)/\gamma^2", c3, (r[3] ** 2 - r[0] ** 2) / g**2, unit)
    side = evaluate(rows["side"], **given)
    step.equal(r"\mathrm{side} = -2 |p| \sin_a\,r_w r_k/\gamma^2", side, -2 * D * SA * r[0] * r[3] / g**2, unit)
    # sigma r_k = |r_k|; sign is that of side, so that of -r_w r_k
    absolute_w, sign = sp.Symbol("abs_w", real=True), sp.Symbol("sign", real=True)
    signs = {"|r_w|^2 = r_w^2": (absolute_w, r[0] ** 2)} | unit
    sqrt = known_root([sigma * r[3] / g, absolute_w / g], signs)
    given = {"c_3": c3, "sqrt": sqrt, "sign": sign}
    q3_s, q3_k = evaluate(rows["q3_s"], **given), evaluate(rows["q3_k"], **given)
    step.equal(r"q_{3,scalar} = \sigma\,r_k/\gamma = |r_k|/\gamma", q3_s, sigma * r[3] / g, root=sqrt)
    step.equal(r"q_{3k} = |r_w| \,\mathrm{sign}/\gamma", q3_k, absolute_w * sign / g, root=sqrt)
    sqrt = known_root([2 * D * SA * absolute_w * sigma * r[3] / g**2], signs)
    side = -2 * D * SA * r[0] * r[3] / g**2
    given = {"side": side, "abs": lambda value: sqrt(value**2)}
    quotient = evaluate(rows["sign"], **given)
    statement = r"\mathrm{sign} = -\sigma\,r_w/|r_w|"
    step.equal(statement, quotient, -sigma * r[0] / absolute_w, signs, r", for $\mathrm{side} \neq 0$", root=sqrt)
    q3_k = q3_k.subs(sign, -sigma * r[0] / absolute_w)
    step.equal(r"q_{3k} = -\sigma\,r_w/\gamma", q3_k, -sigma * r[0] / g, signs)
    values = q12 | {"q3_s": sigma * r[3] / g, "q3_k": -sigma * r[0] / g}
    for component, part in zip(r, "wijk", strict=True):
        printed = evaluate(tables.printed["18"][f"qs_{part}"], **values)
        step.equal(rf"{TEX[f'qs_{part}']} = \sigma\,r_{part}", printed, sigma * component, unit)
    step.equal(r"r e_2 \tilde r = e \times (-n)", f, cross(e, [-v for v in n]), unit)
    step.notes += [
        r"So (18) is $Q_s = \sigma r$: the quaternion of $R$ whose k part, $|r_k|$, is not negative. Where the print "
        r"is 0/0 (elbow on the z axis, $\mathrm{side} = 0$ of a straight or a folded arm) $R$ is still defined, and "
        r"the lean form takes it. For $r_w = 0$ or $r_k = 0$ both signs of (17) give $\pm r$."
    ]
    return step


def _factors(tables: Tables) -> Step:
    vectors = frame(tables)
    n, m, e, f = (vectors[v] for v in "nmef")
    step = Step(
        "6. Four turns",
        [
            r"$R$ is a product of four turns about coordinate axes. With $(\cos\alpha, \sin\alpha) = (u_x, u_y)$, the "
            r"azimuth, and $(\cos\theta, \sin\theta) = (\sin_{el}, \cos_{el})$, the angle from the zenith, "
            r"$R = R_z(\alpha + 90^\circ)\, R_x(\theta)\, R_z(\phi)\, R_x(-a)$: the first two bring the z axis to "
            r"the target, $\phi$ swivels about it, and $-a$ turns the upper arm off it, in the swivel plane."
        ],
    )
    product = turn("z", -U_Y, U_X) * turn("x", SE, CE)
    stages = [
        (r"R_z(\alpha + 90^\circ)\, R_x(\theta)", product, {2: (r"p/|p|", P_UNIT)}),
        (r"R_z(\alpha + 90^\circ)\, R_x(\theta)\, R_z(\phi)", product := product * turn("z", CP, SP),
         {0: ("-n", [-v for v in n]), 1: ("m", m), 2: (r"p/|p|", P_UNIT)}),
        ("R", product * turn("x", CA, -SA), {0: ("-n", [-v for v in n]), 1: (r"e \times (-n)", f), 2: ("e", e)}),
    ]  # fmt: skip
    for label, matrix, expected in stages:
        for column, (name, vector) in expected.items():
            step.equal(rf"{label}\,e_{column + 1} = {name}", matrix[:, column], vector, CIRCLES)
    step.equal(r"f = e \times (-n)", f, cross(e, [-v for v in n]), CIRCLES)
    return step


def _half(tables: Tables) -> Step:
    c, s = symbols("c s")
    circle: Relations = {"c^2 + s^2 = 1": (s, 1 - c**2)}
    step = Step(
        "7. Half an angle without a root",
        [
            "$(1 + c, s)/2$ is a vector along half the angle with cosine $c$ and sine $s$: half the sum of $(c, s)$ "
            "and $(1, 0)$. So is $(s, 1 - c)/2$, up to its sign. The first is short where $c$ is near $-1$, the "
            "second where $c$ is near 1; with the choice by the sign of $c$, $|c|$ is always added to 1, never "
            "subtracted. The squared length is known without a square, and is one of the two components. At $c = 0$, "
            "where the choice changes, both are the same vector up to its sign."
        ],
    )
    for branch, (text_c, text_s) in tables.half.items():
        h_c, h_s = evaluate(text_c, c=c, s=s), evaluate(text_s, c=c, s=s)
        size = (1 + c) / 2 if branch == "c >= 0" else (1 - c) / 2
        when = rf"\text{{ for }} {'c ge 0' if branch == 'c >= 0' else 'c < 0'}".replace(" ge ", r" \ge ")
        step.shown.append((rf"h(c, s){when}", rf"\left({line_tex(text_c)},\ {line_tex(text_s)}\right)"))
        step.equal(rf"|h|^2 = (1 + |c|)/2 {when}", h_c**2 + h_s**2, size, circle)
        step.equal(rf"h_c^2 - h_s^2 = |h|^2\,c {when}", h_c**2 - h_s**2, size * c, circle)
        step.equal(rf"2 h_c h_s = |h|^2\,s {when}", 2 * h_c * h_s, size * s, circle)
        large = ("h_c", h_c) if branch == "c >= 0" else ("h_s", h_s)
        step.equal(rf"{large[0]} = |h|^2 {when}", large[1], size)
    first, second = ([evaluate(v, c=sp.Integer(0), s=s) for v in pair] for pair in tables.half.values())
    at_0: Relations = {"s^2 = 1": (s, sp.Integer(1))}
    step.equal(r"\lim_{c \to -0} h = s\,h(0, s) \text{ with } s = \pm 1", second, [s * v for v in first], at_0)
    step.notes.append(
        "$h$ is proportional to the quaternion of half the angle, or to its opposite in the second branch when "
        "$s < 0$; the rotation is the same, and one comparison, $k < 0$, sets the sign of the whole product at the end."
    )
    return step


def product_lines(tables: Tables, values: dict[str, sp.Expr]) -> list[sp.Expr]:
    result = run_lines(tables.lean, ["Product"], values)
    return [result[f"{name}_1"] for name in "wijk"]


def _product(tables: Tables) -> Step:
    az_c, az_s, tilt_c, tilt_s, arm_c, arm_s = h = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")
    step = Step(
        "8. The product of the four quaternions",
        [
            r"One quaternion for each turn: $\mathrm{az} = h(-u_y, u_x)$ about z, $\mathrm{tilt} = h(\sin_{el}, "
            r"\cos_{el})$ about x, $h_\phi = \cos_h + \sin_h k$, and $\mathrm{arm} = h(\cos_a, \sin_a)$ about x, "
            "turned back. The right sides "
            "are the algebra's product, the left sides the lean lines, which take 16 multiplications. $M(v)$ is the "
            r"matrix of $x \mapsto v x \tilde v$. By the last statements $M(w_1, i_1, j_1, k_1) = |\mathrm{az}|^2 "
            r"|\mathrm{tilt}|^2 |\mathrm{arm}|^2 R$ "
            "in all eight combinations of the branches."
        ],
    )
    given = {str(symbol): symbol for symbol in (*h, C2, S2)}
    lean = product_lines(tables, given)
    algebra = (
        cga.quaternion(az_c, 0, 0, az_s) * cga.quaternion(tilt_c, tilt_s, 0, 0)
        * cga.quaternion(C2, 0, 0, S2) * cga.quaternion(arm_c, -arm_s, 0, 0)
    )  # fmt: skip
    for name, value, right in zip("wijk", lean, cga.quaternion_coefficients(algebra), strict=True):
        right = sp.expand(sp.sympify(right))
        step.shown.append((f"{name}_1", latex(right)))
        part = "" if name == "w" else f"_{name}"
        four = r"\mathrm{az}\,\mathrm{tilt}\,h_\phi\,\widetilde{\mathrm{arm}}"
        step.equal(rf"{name}_1 = \langle {four}\rangle{part}", value, right)
    c, s = symbols("c s")
    circle: Relations = {"c^2 + s^2 = 1": (s, 1 - c**2)}
    for axis, branch in itertools.product("zx", tables.half):
        h_c, h_s = (evaluate(text, c=c, s=s) for text in tables.half[branch])
        size = (1 + c) / 2 if branch == "c >= 0" else (1 - c) / 2
        when = r"c \ge 0" if branch == "c >= 0" else "c < 0"
        matrix = rotation_matrix((h_c, 0, 0, h_s) if axis == "z" else (h_c, h_s, 0, 0))
        unit = "k" if axis == "z" else "i"
        statement = rf"M(h_c + h_s {unit}) = |h|^2 R_{axis}(c, s) \text{{ for }} {when}"
        step.equal(statement, matrix, size * turn(axis, c, s), circle)
    back = rotation_matrix((arm_c, -arm_s, 0, 0)) - rotation_matrix((arm_c, arm_s, 0, 0)).T
    step.equal(r"M(\widetilde{\mathrm{arm}}) = M(\mathrm{arm})^T", back, sp.zeros(3, 3))
    phi = rotation_matrix((C2, 0, 0, S2)) - turn("z", C2**2 - S2**2, 2 * C2 * S2)
    step.equal(r"M(\cos_h + \sin_h k) = R_z(\phi)", phi, sp.zeros(3, 3), HALF_CIRCLE)
    a, b = symbols("r_w r_i r_j r_k"), symbols("q_0 q_1 q_2 q_3")
    both = [sp.expand(sp.sympify(v)) for v in cga.quaternion_coefficients(cga.quaternion(*a) * cga.quaternion(*b))]
    product = rotation_matrix(a) * rotation_matrix(b)
    step.equal(r"M(r q) = M(r) M(q) \text{ for any } r, q", rotation_matrix(both), product)
    return step


def _length(tables: Tables) -> Step:
    h = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")
    lengths = symbols("az_sq tilt_sq arm_sq")
    step = Step(
        "9. The one root at the end",
        [
            r"The length of a product is the product of the lengths, so that of $q = (w_1, i_1, j_1, k_1)$ is known "
            r"from $u_y$, $\sin_{el}$ and $\cos_a$, with two multiplications and beside the product, and $Q_s = q/|q|$."
        ],
    )
    quaternion = product_lines(tables, {str(symbol): symbol for symbol in (*h, C2, S2)})
    relations: Relations = {
        rf"{TEX[f'{name}_c']}^2 + {TEX[f'{name}_s']}^2 = {TEX[f'{name}_sq']}":
        (h[2 * n + 1], lengths[n] - h[2 * n] ** 2) for n, name in enumerate(HALVES)
    }
    name = "length_sq"
    t = run_lines({name: {name: lines(tables.lean)[name]}}, [name], {str(v): v for v in lengths})[name]
    step.equal("w_1^2 + i_1^2 + j_1^2 + k_1^2 = |q|^2", dot(quaternion, quaternion), t, relations | HALF_CIRCLE)
    for cosine, _, length in HALVES.values():
        c = evaluate(cosine, **ANGLES)
        derived = evaluate(lines(tables.lean)[length].replace("Abs(", "abs("), **ANGLES)
        step.equal(rf"{TEX[length]} = (1 + |{latex(c)}|)/2", derived, (1 + sp.Abs(c)) / 2)
    flat = [SYMBOL[cosine.removeprefix("-")] for cosine, _, _ in HALVES.values()]
    whole = run_lines(tables.lean, ["Lengths of the half angle quaternions, squared"], ANGLES)
    whole = t.subs({v: whole[str(v)] for v in lengths})
    corners = [whole.subs(dict(zip(flat, corner, strict=True))) for corner in itertools.product((0, 1), repeat=3)]
    straight = whole.subs({sp.Abs(v): v for v in flat})
    linear = all(sp.degree(straight, v) == 1 for v in flat)
    low, high = min(corners), max(corners)
    step.true(
        rf"{latex(low)} \le |q|^2 \le {latex(high)}", linear and (low, high) == (sp.Rational(1, 8), 1),
        f"$|q|^2$ is linear in each of {', '.join(f'${latex(sp.Abs(v))}$' for v in flat)}, so its extremes over "
        "$[0, 1]^3$ are among the 8 corners; evaluated there",
    )  # fmt: skip
    root, *q = symbols("length w_1 i_1 j_1 k_1")
    last = run_lines(tables.lean, ["Root, second level"], {str(v): v for v in (*lengths, *q)} | {"inv_q": 1 / root})
    step.equal("Q_s = q/|q|", [last[f"qs_{part}"] * root for part in "wijk"], q)
    return step


def _shifts(tables: Tables) -> Step:
    step = Step(
        "10. Roots of scaled arguments",
        [
            "A root core works on a mantissa in $[\\tfrac14, 1)$: the argument times $4^k$. An even shift, since the "
            "root of $4^k$ is a shift again; an odd one would leave $\\sqrt 2$. The first statement is for any integer "
            "$k$. The table has each result as its line worked out with mantissas, times the power of two shown, where "
            r"$k_v$ belongs to the root of $v$: every scale is taken back by one shift of a product. $|q|^2$ is at "
            r"least $\tfrac18$, so its $k$ is 0 or 1; $|q|^2 = 1$, the upper end, is the pose with all three cosines "
            r"$\pm 1$."
        ],
    )
    k, v = sp.Symbol("k", integer=True), sp.Symbol("v", positive=True)
    ratio = sp.powdenest(sp.powsimp(2**k / sp.sqrt(4**k * v) * sp.sqrt(v)), force=True)
    step.true(r"1/\sqrt{v} = 2^k / \sqrt{4^k v}", sp.simplify(ratio) == 1, "expansion of powers, for an integer $k$")
    table = lines(tables.lean)
    results = ("u_x", "u_y", "sin_el", "cos_el", "qe_w", "qe_i", "cos_a", "sin_a")
    inputs = [n for g in ("Sums of the inputs", "Roots, first level") for n in tables.lean[g]] + ["x", "y", "z"]
    plain = run_lines(tables.lean, ["Directions", "Triangle"], {n: SYMBOL[n] for n in inputs})
    powers = {}  # 2^k_v
    for name in tables.lean["Roots, first level"]:
        argument = table[name].removeprefix("rsqrt(").removesuffix(")")
        powers[SYMBOL[f"shift_{argument}"]] = (SYMBOL[name], SYMBOL[argument])
    step.extra += ["| result | from mantissas, times |", "| --- | --- |"]
    ratios = []
    for name in results:
        exponent = sp.Integer(0)
        for shift, (root, argument) in powers.items():
            # root -> 2^k root of the mantissa, argument -> 4^-k mantissa
            exponent += shift * (sp.degree(plain[name], root) - 2 * sp.degree(plain[name], argument))
        step.extra.append(f"| ${TEX[name]} = {line_tex(table[name])}$ | $2^{{{latex(exponent)}}}$ |")
        two = {shift: sp.Symbol(f"two_{shift.name}", positive=True) for shift in powers}  # 2^k_v
        scaled = {root: two[shift] * root for shift, (root, _) in powers.items()}
        scaled |= {argument: argument / two[shift] ** 2 for shift, (_, argument) in powers.items()}
        whole = sp.prod(two[shift] ** exponent.coeff(shift) for shift in powers)
        ratio = sp.cancel(plain[name].subs(scaled, simultaneous=True) / plain[name])
        ratios.append((ratio, whole))
    step.equal(r"\text{powers of two of the table}", *(list(side) for side in zip(*ratios, strict=True)),
               more=", the scaled roots and arguments put into the lines")  # fmt: skip
    return step


def _near_singular(tables: Tables) -> Step:
    step = Step(
        "11. Near the z axis, the stretched and the folded arm",
        [
            "A difference of rounded numbers that are nearly equal loses digits. Where the lean form subtracts, "
            "either the numbers are exact or only the absolute error of the difference counts. The sums of the inputs "
            "are integers when the inputs are; directions and triangle are products only, so each keeps the relative "
            "precision of its factors; $1 + |c|$ is at least 1; and $q$ is linear in each of its four "
            r"factors, of which none is shorter than $1/\sqrt2$ (step 9). So an error of length $\epsilon$ in one "
            r"factor moves $Q_s$, to first order, by at most $\sqrt2\,\epsilon$, and one in $q$ by at most "
            r"$\sqrt8\,\epsilon$, at every pose: a target near an axis or a limit is no worse than another."
        ],
    )
    inputs = {name: SYMBOL[name] for name in ("x", "y", "z", "d1", "d2")}
    sums = run_lines(tables.lean, ["Sums of the inputs"], inputs)
    group = list(tables.lean["Sums of the inputs"])
    whole = all(sp.Poly(sums[name]).domain == sp.ZZ for name in group)
    names = ", ".join(TEX[name] for name in group)
    step.true(rf"{names} \text{{ are integers}}", whole, "polynomials in the inputs with integer coefficients")
    for name in ("rho_sq", "s"):
        terms = sp.Poly(sums[name]).terms()
        good = all(c > 0 and all(n % 2 == 0 for n in powers) for powers, c in terms)
        step.true(rf"{TEX[name]} \text{{ has no negative term}}", good, "signs and powers of its terms")
    products = [n for g in ("Directions", "Triangle") for n in tables.lean[g]]
    none = all(not tree(lines(tables.lean)[n]).has(sp.Add) for n in products)
    names = ", ".join(TEX[n] for n in products)
    step.true(rf"{names} \text{{ are products}}", none, "no line has a sum")
    h = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")
    quaternion = product_lines(tables, {str(symbol): symbol for symbol in (*h, C2, S2)})
    pairs = [h[0:2], h[2:4], h[4:6], [C2, S2]]
    linear = all(
        sum(powers) == 1 for part in quaternion for pair in pairs for powers in sp.Poly(part, *pair).monoms()
    )
    step.true(r"q \text{ is linear in } \mathrm{az}, \mathrm{tilt}, \mathrm{arm}, (\cos_h, \sin_h) \text{ each}",
              linear, "degrees of the terms")  # fmt: skip

    delta = SYMBOL["delta"]
    d1, d2 = sp.symbols("d_1 d_2", positive=True)
    dist = sp.Symbol("dist", positive=True)
    law = {D1: d1, D2: d2}
    s_of, a_far, b_near = dist**2, *(sums[n].subs(inputs["x"], 0).subs(inputs["y"], 0).subs(inputs["z"], dist).subs(law)
                                     for n in ("a_far", "b_near"))  # fmt: skip
    sine = a_far * b_near / (4 * d1**2 * s_of)
    above, below = a_far / (2 * d1 * d2), b_near / (2 * d1 * d2)
    stretch, fold = {dist: (d1 + d2) * (1 - delta)}, {dist: (d1 - d2) * (1 + delta)}
    far, near = r"$|p| = (d_1 + d_2)(1 - \delta)$", r"$|p| = (d_1 - d_2)(1 + \delta)$"
    tmp1 = r"4\,\mathrm{tmp}_1 / (2 \rho d_1 |p|)^2"
    poses = [
        ("stretched", far, "1 + c_4", above.subs(stretch), "$A$, exact"),
        ("stretched", far, tmp1, sine.subs(stretch), "$A$ and $B$, exact"),
        ("folded", near, "1 - c_4", below.subs(fold), "$B$, exact"),
        ("folded", near, tmp1, sine.subs(fold), "$A$ and $B$, exact"),
        ("wrist near the z axis", r"$\delta$ from it", r"|\pi_{swivel}|/|p|", sp.sin(delta), r"$\rho^2$, exact"),
        ("elbow near the positive z axis", r"$\delta$ from it", "(d_1 - p_{ez})/d_1", 1 - sp.cos(delta), "not formed"),
        ("no turn about the upper arm", r"$\theta_3 = \delta$", "1 - c_3", 1 - sp.cos(delta), "not formed"),
    ]
    step.text.append(
        "In the paper's form, these are arguments of roots, or divisors, and vanish at a singular pose (table, leading "
        r"term in $\delta$), while the terms they are summed from do not. (Those of $\pi_{swivel}$ do; there it is the "
        r"absolute error of fixed point that counts.) Terms rounded to $\epsilon$ leave $\epsilon$ over the size shown "
        r"as relative error; where half an angle is a root of it, that is wrong by about $\epsilon$ over the root of "
        r"the size, and by $\sqrt\epsilon$ at the pose."
    )
    step.extra += ["| pose | | in the paper's form | size | in the lean form |", "| --- | --- | --- | --- | --- |"]
    for pose, where, name, value, lean in poses:
        value = sp.expand(sp.together(value))
        lead = sp.factor(value.as_leading_term(delta))
        coefficient, order = lead.as_coeff_exponent(delta)
        size = sp.latex(lead, symbol_names=_NAMES | {d1: "d_1", d2: "d_2"})
        step.extra.append(f"| {pose} | {_cell(where)} | ${_cell(name)}$ | ${size}$ | {lean} |")
        limit = sp.simplify(sp.limit(value / delta**order, delta, 0) - coefficient)
        statement = rf"{name} = O(\delta{f'^{order}' if order > 1 else ''}) \text{{, {pose}}}"
        step.true(statement, order > 0 and limit == 0, "limit of the quotient by the power")
    return step


@dataclass(frozen=True)
class Ops:
    """Numbers of operations. Signs, absolute values and factors of 2 and 1/2 are wiring."""

    mul: int = 0
    add: int = 0
    root: int = 0

    def __add__(self, other: Ops) -> Ops:
        return Ops(self.mul + other.mul, self.add + other.add, self.root + other.root)


def operations(expression: sp.Expr) -> Ops:
    """The operations of one expression tree."""
    if expression.is_Symbol or expression.is_Number:
        return Ops()
    inside = sum((operations(a) for a in expression.args), Ops())
    if expression.is_Add:
        return inside + Ops(add=len(expression.args) - 1)
    if expression.is_Mul:
        return inside + Ops(mul=max(sum(not a.is_number for a in expression.args) - 1, 0))
    if expression.is_Pow and expression.args[1] == 2:
        return inside + Ops(mul=1)
    if expression.is_Pow and expression.is_number:  # 1/2
        return Ops()
    if isinstance(expression, rsqrt):
        return inside + Ops(root=1)
    if isinstance(expression, sp.Abs):
        return inside
    raise ValueError(f"no rule for {expression}")


def _factors_flat(expression: sp.Expr) -> sp.Expr:
    """The tree with products of products as one product, as operations() wants them."""
    if not expression.args:
        return expression
    arguments = [_factors_flat(a) for a in expression.args]
    if expression.is_Mul:
        arguments = [f for a in arguments for f in (a.args if a.is_Mul else (a,))]
    return expression.func(*arguments, evaluate=False)


def count(table: dict[str, str]) -> Ops:
    """The lines as they are written."""
    return sum((operations(_factors_flat(tree(text))) for text in table.values()), Ops())


def count_shared(table: dict[str, str]) -> Ops:
    """The lines after sympy.cse over all of them at once."""
    common, rest = sp.cse([tree(text).doit() for text in table.values()], order="canonical")
    return sum((operations(e) for e in [e for _, e in common] + rest), Ops())


def _counts(tables: Tables) -> Step:
    r = symbols("r_w r_i r_j r_k")
    turned = rotation_matrix(r)
    step = Step(
        "12. Operations",
        [
            "The shoulder quaternion can also be read off the matrix $R$ of step 5: $n$, $m$, $e$ as in steps 2 and "
            r"3, $f = e \times (-n)$, and then the row of the largest of four sums, by one root. Both forms share the "
            r"lines down to the triangle; sine and cosine are those of $\phi$ in the matrix form, of $\phi/2$ in the "
            "lean one. The statements say that the matrix form is right, with $R$ from a unit quaternion $r$.",
            "Counted from the expression trees of the lines. Signs, absolute values, doubling and halving are wiring. "
            "A square is a multiplication; $\\sqrt v$ is $v$ times the reciprocal root of $v$ and counts as both. "
            "Choices are not counted: three times one of two pairs here, one of four rows there.",
        ],
    )
    values = {f"{v}_{axis}": (-1 if v == "n" else 1) * turned[m, column]
              for v, column in (("n", 0), ("f", 1), ("e", 2)) for m, axis in enumerate("xyz")}  # fmt: skip
    sums = run_lines(tables.matrix, ["Four sums and what goes with them"], values)
    unit: Relations = {"|r|^2 = 1": (r[0], 1 - r[1] ** 2 - r[2] ** 2 - r[3] ** 2)}
    parts = dict(zip("wijk", r, strict=True))
    for name in tables.matrix["Four sums and what goes with them"]:
        a, b = (name[-1], name[-1]) if name.startswith("sum_") else name.split("_")
        right = f"4 r_{a}^2" if a == b else f"4 r_{a} r_{b}"
        step.equal(f"{TEX[name]} = {line_tex(lines(tables.matrix)[name])} = {right}", sums[name],
                   4 * parts[a] * parts[b], unit)  # fmt: skip
    # The row of the largest sum 4 r_a^2 is (4 r_a^2, 4 r_a r_b, ...): over twice the sum's root, r but for its sign.
    row = dict(zip(("largest", "other_1", "other_2", "other_3"), [4 * r[0] * v for v in r], strict=True))
    result = run_lines(tables.matrix, ["The row of the largest sum"], row | {"g_q": 1 / (2 * r[0])})
    step.equal(r"(q_0, q_1, q_2, q_3) = (r_w, r_i, r_j, r_k) \text{ of the row of } \Sigma_w,\ g_\Sigma = 1/(2 r_w)",
               [result[f"q_{n}"] for n in range(4)], list(r))  # fmt: skip

    def rows(table: dict, groups: list[str], title: str) -> Ops:
        total = Ops()
        for group in groups:
            one = count(table[group])
            total += one
            step.extra.append(f"| {group} | {one.mul} | {one.add} | {one.root} |")
        step.extra.append(f"| **{title}** | {total.mul} | {total.add} | {total.root} |")
        return total

    step.extra += ["| lines | x | +, - | reciprocal roots |", "| --- | --: | --: | --: |"]
    own = ["Lengths of the half angle quaternions, squared", "Product", "Root, second level"]
    chosen = ["Half angle quaternions", "Half the swivel angle"]  # choices, and what both forms look up
    head = [group for group in tables.lean if group not in own + chosen]
    both = rows(tables.lean, head, "both forms, to the triangle")
    lean = rows(tables.lean, own, "shoulder, lean form")
    matrix = rows(tables.matrix, list(tables.matrix), "shoulder, matrix form")
    shared = []
    for name, table, groups, head, plain in (
        ("lean form", tables.lean, own, both, lean), ("matrix form", tables.matrix, list(tables.matrix), both, matrix)
    ):  # fmt: skip
        less = count_shared({n: text for group in groups for n, text in table[group].items()})
        shared.append(less)
        for label, ops in ((f"{name}, whole", head + plain), (f"{name}, whole, common subexpressions", head + less)):
            step.extra.append(f"| {label} | {ops.mul} | {ops.add} | {ops.root} |")
    step.true(
        rf"\text{{the lean form has }} {shared[1].mul - shared[0].mul} \text{{ multiplications and }} "
        rf"{shared[1].add - shared[0].add} \text{{ additions less}}",
        shared[0].mul < shared[1].mul and shared[0].add < shared[1].add and shared[0].root == shared[1].root,
        "counts with common subexpressions (`sympy.cse`), as many roots",
    )  # fmt: skip
    step.notes.append(
        "[operations.md](operations.md) counts the paper's own form, for its table 4, and the RTL of `ik_paper`. "
        "Flags, clamped poses and scaling come on top in each form."
    )
    return step


# -- the page --------------------------------------------------------------------------------------------------------

STEPS = (
    _directions, _swivel, _elbow, _elbow_quaternion, _shoulder, _factors, _half, _product, _length, _shifts,
    _near_singular, _counts,
)  # fmt: skip


def derive(tables: Tables | None = None) -> list[Step]:
    """All steps."""
    return [step(tables or Tables()) for step in STEPS]


def unexpected(steps: list[Step]) -> list[str]:
    """Statements that do not hold, with their step. Empty if all is well."""
    return [
        f"step {step.title}: {check.statement}: does not hold; left minus right: {check.rest}"
        for step in steps
        for check in step.checks
        if not check.holds
    ]


def page(steps: list[Step], tables: Tables | None = None) -> str:
    """docs/lean.md."""
    tables = tables or Tables()
    out = [
        "# The lean dataflow, derived from the paper's equations",
        "",
        "Written by `python -m scripts.derive.lean`; `make test` fails when it is out of date.",
        "",
        "The second datapath computes what (10)-(18) of the paper compute, without division, without the elbow point",
        "and without half angle roots: all its roots are reciprocal square roots, in two levels. This page goes from",
        "the paper's equations to that dataflow. The paper's side is the table `model/reference/printed.py`,",
        "with the square",
        "that (11) lacks in print; [derivation.md](derivation.md) proves that table from the geometry. The lean side",
        "is the table below; a test compares it with `model/reference/lean_equations.py`.",
        "In numbers, `model/reference/tests/test_lean_equations.py` compares the two.",
        "",
        "How a statement is checked:",
        "",
        "- *expansion*: the difference of both sides, over a common denominator, has a numerator that expands to the",
        "  zero polynomial;",
        "- *expansion, modulo ...*: it does so after every even power of a symbol has been replaced by what the named",
        "  relation says its square is. That form is unique (the relations are a Gröbner basis, their leading terms",
        "  being squares of different symbols), so it is 0 exactly if the difference follows from the relations;",
        "- *a root recognized by its square*: a square root of the paper is replaced by a quantity that is not",
        "  negative, after its square has been compared with the argument in the same way;",
        "- other methods are named in the line.",
        "",
        "All of these are exact, and hold wherever no denominator is 0. No statement rests on samples.",
        "",
        "## The dataflow",
        "",
        r"The target is $p = (x, y, z)$; $\sin_{el}$ and $\cos_{el}$ are those of its elevation, $\cos_a$ and $\sin_a$",
        r"those of the angle $a$ between target and upper arm, $\sin_h$ and $\cos_h$ those of $\phi/2$. A line has the",
        "same number and the same name in `model/reference/lean_table.py`, which this table shows, in",
        "`model/dataflow/lean.py` and in `rtl/lean`, where the number stands at the declaration of the node of that",
        "name. What has the number of a line and another name there is a step to it: $e_v$ and $m_v$ are shift and",
        "mantissa of a root's argument $v$, and a root or a product of mantissas comes to another's unit by $2^{-n}$.",
        "",
    ]
    for group, table in tables.lean.items():
        out += [f"{group}:", "", "| | name | equation |", "| --- | --- | --- |"]
        out += [f"| {NUMBER[n]} | `{n}` | ${_cell(f'{TEX[n]} = {line_tex(text)}')}$ |" for n, text in table.items()]
        out.append("")
    parts = [
        ("h(c, s) = (h_c(c, s), h_s(c, s))", rf"\left({line_tex(c)},\ {line_tex(s)}\right) \text{{ for }} {branch}")
        for branch, (c, s) in zip((r"c \ge 0", "c < 0"), tables.half.values(), strict=True)
    ]
    out += ["The half angle quaternions are", "", *paper._aligned(parts), ""]
    out += [
        "$Q_s$ is negated if $k_1 < 0$. Where a line has no meaning, a rule stands in for it:",
        "",
        "- on the z axis ($x = y = 0$): $u_x = 1$, $u_y = 0$;",
        r"- at the shoulder ($p = 0$): $\sin_{el} = 1$, $\cos_{el} = 0$, and the arm is folded as in the next",
        "  line;",
        r"- too near ($B < 0$): $Q_e = 1$, $\sin_a = 0$, $\cos_a = 1$, or $\cos_a = -1$ if $d_1 < d_2$;",
        r"- too far ($A < 0$): $Q_e = -i$, $\cos_a = 1$, $\sin_a = 0$; the same, wherever the target is, with a length",
        "  that is not positive.",
        "",
        "## Summary",
        "",
        "| step | statements | outcome |",
        "| --- | --: | --- |",
    ]
    for step in steps:
        failed = sum(not check.holds for check in step.checks)
        outcome = f"**{failed} do not hold**" if failed else "all hold"
        out.append(f"| {step.title} | {len(step.checks)} | {outcome} |")
    for step in steps:
        out += ["", *_section(step)]
    return "\n".join(out) + "\n"


def _section(step: Step) -> list[str]:
    out = [f"## {step.title}"]
    for text in step.text:
        out += ["", text]
    if step.shown:
        out += ["", "Derived:", "", *paper._aligned(step.shown)]
    if step.extra:
        out += ["", *step.extra]
    out += ["", "| statement | outcome | checked by |", "| --- | --- | --- |"]
    for check in step.checks:
        verdict = "holds" if check.holds else "**does not hold**"
        out.append(f"| ${_cell(check.statement)}$ | {verdict} | {_cell(check.method)} |")
    for note in step.notes:
        out += ["", note]
    return out


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.derive.lean", description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare the page, write nothing")
    check = parser.parse_args(arguments).check
    steps = derive()
    text = page(steps)
    wrong = unexpected(steps)
    for line in wrong:
        print(line, file=sys.stderr)
    name = PAGE.relative_to(ROOT)
    if check:
        stale = not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text
        if stale:
            print(f"{name} is out of date: run `python -m scripts.derive.lean`", file=sys.stderr)
        return int(stale or bool(wrong))
    if wrong:
        print(f"{name} not written", file=sys.stderr)
        return 1
    PAGE.write_text(text, encoding="utf-8")
    print(f"wrote {name}: {len(steps)} steps, {sum(len(step.checks) for step in steps)} statements")
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Derives equations (10)-(19) of the paper from its geometry, with symbols, and writes docs/derivation.md.

    python -m scripts.derive.paper [--check]     writes the page; with --check compares it, status 1 if it is stale

The left side of every comparison is what the functions of model/reference/geometry.py return for symbols; the right
side is
PRINTED, the paper's equations as they stand on paper, typed once. Either way the status is 1 when a verdict is not
the one expected: everything equal but the rows of KNOWN_WRONG.
"""

from __future__ import annotations

import argparse
import ast
import copy
import sys
from dataclasses import dataclass, field

import sympy as sp

from model.reference import cga, geometry
from model.reference.printed import C4, TEXT
from tb.sim.env import ROOT

PAGE = ROOT / "docs" / "derivation.md"

# -- the paper -------------------------------------------------------------------------------------------------------

_RENAMED = (
    ("p_w_", "p_w"),
    ("p_e_", "p_e"),
    ("pi_swivel_", "pi_"),
    ("l_sw", "L_sw"),
    ("l_m", "L_m"),
    ("inf_pp", "inf_PP"),
    ("pp_", "PP_"),
    ("_plus", "p"),
    ("_minus", "m"),
    ("c3", "c_3"),
    ("q3_scalar", "q3_s"),
    ("sign_raw", "side"),
    ("Abs", "abs"),
)
"""Names of :mod:`model.reference.printed` -> those of the page, which come close to the print."""


def _renamed(text: str) -> str:
    for name, page in _RENAMED:
        text = text.replace(name, page)
    return text


def _printed() -> dict[str, dict[str, str]]:
    """Equation -> row -> right side, in the print's order of terms, misprints included:
    :data:`model.reference.printed.TEXT`."""
    rows = {
        number.strip("()"): {_renamed(name): _renamed(text) for name, text in lines.items()}
        for number, lines in TEXT.items()
    }
    del rows["13"]["tmp_sqr"]  # a name for the root of tmp1
    # The print has the fraction inside both roots of (14); it is c_4 of the text before it.
    fraction = _renamed(C4)
    rows["14"] = {"c_4": fraction} | {name: text.replace(fraction, "c_4") for name, text in rows["14"].items()}
    return rows


PRINTED = _printed()

KNOWN_WRONG = {
    ("11", "pi_x"): ("L_sw*cos(phi/2))", "L_sw*cos(phi/2)**2)"),
    ("11", "pi_y"): ("L_sw*cos(phi/2))", "L_sw*cos(phi/2)**2)"),
}
"""Rows that are wrong in print -> the edit (found, replacement) that mends them, which is proved too."""

FACTOR = {"19": 2}
"""Equations whose rows all carry a common factor in print; 1 elsewhere."""

# -- symbols ---------------------------------------------------------------------------------------------------------

TEX = {
    "phi": r"\phi", "c": "c", "s": "s", "d1": "d_1", "d2": "d_2", "L_sw": r"|L_{sw}|",
    "pi_x": r"\pi_{swivelx}", "pi_y": r"\pi_{swively}", "pi_z": r"\pi_{swivelz}", "abs_pi": r"|\pi_{swivel}|",
    "inf_PP": r"\mathrm{inf}_{PP}", "tmp1": r"\mathrm{tmp}_1", "tmp2": r"\mathrm{tmp}_2",
    "tmp_sqr": r"\mathrm{tmp}_{sqr}", "c_3": "c_3", "c_4": "c_4", "L_m": "|L_m|",
    "side": r"\mathrm{side}", "abs_side": r"|\mathrm{side}|", "sign": r"\mathrm{sign}",
    "q3_s": r"q_{3,scalar}", "q3_k": "q_{3k}", "qe_w": r"\langle Q_e\rangle", "qe_i": r"\langle Q_e\rangle_i",
    "qs_w": r"\langle Q_s\rangle",
    "cos4": r"\cos\frac{\theta_4}{2}", "sin4": r"\sin\frac{\theta_4}{2}",
    "cos3": r"\cos\frac{\theta_3}{2}", "sin3": r"\sin\frac{\theta_3}{2}", "lam": r"\lambda",
}  # fmt: skip
TEX |= {f"p_{point}{axis}": f"p_{{{point}{axis}}}" for point in "we" for axis in "xyz"}
TEX |= {f"PP_{n}": f"PP_{{{n}}}" for n in ("i", "j", "k", "14", "15", "24", "25", "34", "35")}
TEX |= {f"PP_{m}{sign}": f"PP_{m}^{mark}" for m in "123" for sign, mark in (("p", "+"), ("m", "-"))}
TEX |= {f"q12_{unit}": f"q_{{12{unit}}}" for unit in "ijk"}
TEX |= {f"qs_{unit}": rf"\langle Q_s\rangle_{unit}" for unit in "ijk"}

SYMBOL = {name: sp.Symbol(name, real=True) for name in TEX}
_NAMES = {symbol: TEX[name] for name, symbol in SYMBOL.items()}
BIVECTOR = ("e23", "e13", "e12", "e14", "e15", "e24", "e25", "e34", "e35")


def symbols(names: str) -> list[sp.Symbol]:
    return [SYMBOL[name] for name in names.split()]


P_W, P_E, PI = symbols("p_wx p_wy p_wz"), symbols("p_ex p_ey p_ez"), symbols("pi_x pi_y pi_z")
PP_NAMES = tuple(PRINTED["12"])


def dot(a, b):
    return sum(m * n for m, n in zip(a, b, strict=True))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [m - n for m, n in zip(a, b, strict=True)]


def evaluate(text: str, **values) -> sp.Expr:
    """A printed expression as sympy's. `values` stand for names; the others stay symbols."""
    functions = {"sqrt": sp.sqrt, "cos": sp.cos, "sin": sp.sin, "abs": sp.Abs}
    tree = ast.parse(text, mode="eval")
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant):  # 1/2 is a rational
            node.value = int(node.value)
    exact = ast.unparse(_Exact().visit(tree))
    return eval(exact, {"__builtins__": {}}, SYMBOL | functions | {"Integer": sp.Integer} | values)  # noqa: S307


class _Exact(ast.NodeTransformer):
    def visit_Constant(self, node):
        return ast.Call(ast.Name("Integer", ast.Load()), [node], [])


# -- proofs ----------------------------------------------------------------------------------------------------------

EXPANSION = "expansion"


@dataclass
class Setting:
    """What a step takes as given: polynomials that vanish, roots that have a name, and a point to refute with."""

    relations: dict[str, sp.Expr] = field(default_factory=dict)  # LaTeX -> polynomial that is 0
    leading: str = ""  # names in order of elimination: makes the relations' leading terms coprime
    roots: dict[sp.Expr, sp.Expr] = field(default_factory=dict)  # a quantity >= 0 -> its square
    point: dict[str, object] = field(default_factory=dict)  # exact values for all symbols
    foreign: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)  # roots met that nobody expected
    plain: bool = False  # derived coefficients are shown factored but not reduced
    recognized: dict[str, None] = field(default_factory=dict)  # relations used to recognize roots, in order

    def remainder(self, expression) -> tuple[sp.Expr, sp.Expr, list[str]]:
        """(n, d, used): expression is n/d modulo the relations, which are a Groebner basis.

        n is 0 exactly if the expression's numerator lies in the ideal of the relations.
        """
        numerator, denominator = sp.fraction(sp.together(expression))
        numerator, used = self._reduce(numerator)
        denominator, _ = self._reduce(denominator)
        assert denominator != 0, "a denominator vanishes identically"
        return numerator, denominator, used

    def _reduce(self, polynomial):
        polynomial = sp.expand(polynomial)
        if not self.relations or not polynomial.free_symbols:
            return polynomial, []
        ahead = symbols(self.leading)
        free = polynomial.free_symbols | set().union(*(r.free_symbols for r in self.relations.values()))
        order = ahead + sorted(free - set(ahead), key=str)
        basis = list(self.relations.values())
        heads = [sp.Poly(r, *order).monoms(order="lex")[0] for r in basis]
        for n, head in enumerate(heads):  # Buchberger's first criterion
            assert all(not (a and b) for other in heads[:n] for a, b in zip(head, other, strict=True)), "not coprime"
        quotients, rest = sp.reduced(polynomial, basis, *order, order="lex")
        return rest, [name for name, q in zip(self.relations, quotients, strict=True) if q != 0]

    def normal(self, expression) -> sp.Expr:
        """A form to print: reduced, cancelled, factored."""
        expression = self.named(expression)
        if self.plain:
            return sp.factor(expression)
        numerator, denominator, _ = self.remainder(expression)
        return sp.factor(sp.cancel(numerator / denominator))

    def named(self, expression) -> sp.Expr:
        """The expression with every square root and absolute value replaced by the quantity >= 0 that it is."""
        expression = sp.sympify(expression)
        if isinstance(expression, sp.Float):  # kingdon's zeros
            return sp.nsimplify(expression, rational=True)
        if isinstance(expression, sp.Abs):
            return self._root(self.named(expression.args[0]) ** 2, expression)
        if expression.is_Pow and expression.exp.is_Rational and expression.exp.q == 2:
            absolute = isinstance(expression.base, sp.Abs)
            radicand = self.named(expression.base.args[0] if absolute else expression.base)
            return self._root(radicand, sp.sqrt(expression.base), absolute) ** (2 * expression.exp)
        return expression.func(*map(self.named, expression.args)) if expression.args else expression

    def _root(self, square, original, absolute=False):
        for name, known in self.roots.items():
            for signed in (known, -known)[: 1 + absolute]:
                rest, _, used = self.remainder(square - signed)
                if rest == 0:
                    self.recognized |= dict.fromkeys(used)
                    return name
        for symbol, other in self.foreign.items():
            if other == original:
                return symbol
        symbol = sp.Symbol(f"root{len(self.foreign)}", real=True)
        self.foreign[symbol] = original
        return symbol

    def at_point(self, expression):
        """The exact value at the point, which satisfies all relations."""
        values = {SYMBOL[name]: sp.sympify(value) for name, value in self.point.items()}
        for relation in self.relations.values():
            assert sp.simplify(relation.subs(values)) == 0, f"the point is not on {relation} = 0"
        for root, square in self.roots.items():
            if root.is_Symbol and root not in values:
                values[root] = sp.sqrt(square.subs(values))
        foreign = {symbol: original.subs(values) for symbol, original in self.foreign.items()}
        return sp.simplify(expression.subs(foreign).subs(values))


@dataclass
class Row:
    """One comparison: of a derived coefficient with a printed one, or of two sides of a statement."""

    equation: str
    name: str  # row of PRINTED, or LaTeX of a statement
    derived: sp.Expr
    verdict: str  # equal, factor, differs
    method: str
    factor: sp.Expr = sp.Integer(1)
    difference: sp.Expr | None = None
    witness: str = ""

    @property
    def holds(self) -> bool:
        return self.verdict == "equal"


def compare(setting: Setting, equation: str, name: str, derived, printed, factor=1) -> Row:
    """Decides derived * factor = printed by expansion, modulo the setting's relations. factor: in print."""
    setting.recognized = {}
    derived, printed = setting.named(derived), setting.named(printed)
    rest, _, used = setting.remainder(derived * factor - printed)
    if rest == 0:
        shape = derived if equation.startswith("fact") else setting.normal(derived)
        used = list(dict.fromkeys([*setting.recognized, *used]))
        method = EXPANSION + (f", modulo {', '.join(f'${_cell(u)}$' for u in used)}" if used else "")
        return Row(equation, name, shape, "equal" if factor == 1 else "factor", method, sp.Integer(factor))
    value = setting.at_point(derived * factor - printed)
    # Only a point can refute: a remainder alone could be a relation that the setting has not been told.
    shown = value if value.is_Rational else sp.N(value, 6)
    method = "a point where they differ" if value != 0 else "undecided: a remainder, but equal at the point"
    spot = ", ".join(f"{TEX[k]} = {sp.latex(sp.sympify(v))}" for k, v in setting.point.items())
    witness = f"At ${spot}$ it is ${sp.latex(shown)}$."
    difference = setting.normal(derived * factor - printed)
    return Row(equation, name, setting.normal(derived), "differs", method, sp.Integer(factor), difference, witness)


def _cell(formula: str) -> str:
    """LaTeX without the character that ends a cell of a table."""
    return formula.replace("|", r"\vert ")


def radicand(expression, setting: Setting) -> sp.Expr:
    """What stands under the one square root of the expression, without an absolute value, positive at the point."""
    found = {p.base for p in expression.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q == 2}
    (base,) = found
    base = base.args[0] if isinstance(base, sp.Abs) else base
    return base if setting.at_point(base) > 0 else -base


def normal_vector(plane):
    return [cga.coefficient(plane, blade) for blade in ("e1", "e2", "e3")]


# -- the derivation --------------------------------------------------------------------------------------------------


@dataclass
class Section:
    title: str
    construction: str  # what the text of the paper builds, and where
    settings: list[Setting]
    rows: list[Row] = field(default_factory=list)  # against the print
    facts: list[Row] = field(default_factory=list)  # statements that later sections use, or that explain
    notes: list[str] = field(default_factory=list)


def derive(printed: dict = PRINTED) -> list[Section]:
    """All sections. `printed` may be an altered copy of PRINTED."""
    return [
        _swivel_plane(printed),
        _point_pair(printed),
        _sums(printed),
        _elbow_point(printed),
        _elbow_quaternion(printed),
        _rotate_to_elbow(printed),
        _rotate_to_wrist(printed),
        _product(printed),
    ]


def _swivel_plane(printed) -> Section:
    c, s, L_sw, phi = symbols("c s L_sw phi")
    setting = Setting(
        relations={
            r"|L_{sw}|^2 = |p_w|^2": L_sw**2 - dot(P_W, P_W),
            r"c^2 + s^2 = 1": c**2 + s**2 - 1,
        },
        leading="L_sw s",
        roots={L_sw: L_sw**2},
        point={"p_wx": 1, "p_wy": 2, "p_wz": 2, "L_sw": 3, "c": "4/5", "s": "3/5"},
    )
    half = {sp.cos(phi / 2): c, sp.sin(phi / 2): s}
    _, length, plane = geometry.swivel_plane(cga.point(*P_W), phi)
    normal = [value.subs(half) for value in normal_vector(plane)]
    rows = printed["11"]
    section = Section(
        "(10), (11) The swivel plane",
        "The line $L_{sw} = (e_0 \\wedge P_w \\wedge e_\\infty)^*$ has the length (10). The plane through the z axis "
        "and $P_w$, $(e_0 \\wedge e_3 \\wedge P_w \\wedge e_\\infty)^*$, is turned about it by $\\phi$ with the "
        "quaternion (4): `swivel_plane`. Below, $c = \\cos\\frac{\\phi}{2}$ and $s = \\sin\\frac{\\phi}{2}$.",
        [setting],
    )
    squared = Setting(point=setting.point)
    radicand_10 = radicand(length, squared)
    row = compare(squared, "10", "L_sw", radicand_10, radicand(evaluate(printed["10"]["L_sw"]), squared))
    row.derived = sp.sqrt(row.derived)
    if row.holds:
        row.method += " of both squares; both roots are positive"
    section.rows.append(row)
    plane_printed = [evaluate(text).subs(half) for text in rows.values()]
    for name, derived, text in zip(rows, normal, plane_printed, strict=True):
        section.rows.append(compare(setting, "11", name, derived, text))
    for (equation, name), edit in KNOWN_WRONG.items():
        if equation == "11":
            mended = evaluate(rows[name].replace(*edit)).subs(half)
            derived = normal[list(rows).index(name)]
            statement = f"{TEX[name]} = {tex(rows[name].replace(*edit))}"
            section.facts.append(compare(setting, "11 mended", statement, derived, mended))

    def fact(statement, left, right=0):
        section.facts.append(compare(setting, "fact", statement, left, right))

    for blade, label in (("einf", r"e_\infty"), ("e0", "e_0")):
        fact(f"\\langle\\pi_{{swivel}}\\rangle_{{{label}}} = 0", sp.sympify(cga.coefficient(plane, blade)).subs(half))
    fact(r"\pi_{swivel} \cdot p_w = 0", dot(normal, P_W))
    fact(r"|\pi_{swivel}|^2 = p_{wx}^2 + p_{wy}^2", dot(normal, normal), P_W[0] ** 2 + P_W[1] ** 2)
    fact(r"\pi_{swivel} \cdot p_w = 0 \text{ for the plane as printed, too}", dot(plane_printed, P_W))
    section.notes += [
        "The print wants the square of the last cosine in the x and y rows. The z row is right. Because the printed "
        "plane still contains $L_{sw}$, an arm computed from it still reaches the target, with a wrong swivel angle; "
        "the two agree where $c = 0$ or $c = 1$.",
        "No free scale: the coefficients come out with the printed length, that of the vector "
        "$(p_{wx}, p_{wy})$. The plane vanishes for a target on the z axis.",
    ]
    return section


def _plane_through_line():
    """The swivel plane as symbols, with what section 3.1 proves of it."""
    return {r"\pi_{swivel} \cdot p_w = 0": dot(PI, P_W)}


def _pair():
    """The derived coefficients of PP*, by the names of (12)."""
    plane = cga.plane(*PI, 0)
    _, _, _, PP = geometry.elbow_point_pair(cga.point(*P_W), plane, *symbols("d1 d2"))
    return PP, pair_coefficients(cga.dual(PP))


def pair_coefficients(pair) -> dict[str, sp.Expr]:
    _, *ijk = cga.quaternion_coefficients(pair)
    values = ijk + [getattr(pair, blade) for blade in BIVECTOR[3:]]
    return {name: sp.expand(value) for name, value in zip(PP_NAMES, values, strict=True)}


POSE = {"p_wx": 1, "p_wy": 2, "p_wz": 2, "pi_x": 2, "pi_y": -1, "pi_z": 0, "d1": 3, "d2": 2}


def _point_pair(printed) -> Section:
    setting = Setting(point=POSE)
    PP, pair = _pair()
    section = Section(
        "(12) The point pair",
        "The spheres $S_1 = P_w - \\frac12 d_2^2 e_\\infty$ and $S_2 = e_0 - \\frac12 d_1^2 e_\\infty$ meet in the "
        "circle $Z_e = S_1 \\wedge S_2$, and that meets the swivel plane in $PP = Z_e \\wedge \\pi_{swivel}$: "
        "`elbow_point_pair`. The plane is three symbols, $\\pi_{swivel} = (\\pi_{swivelx}, \\pi_{swively}, "
        "\\pi_{swivelz})$ without $e_\\infty$, as proved above. $PP_i, PP_j, PP_k$ are read on the quaternion units "
        "(1)-(3), the others on $e_m \\wedge e_n$ with $e_4 = e_+$, $e_5 = e_-$.",
        [setting],
    )
    for name, text in printed["12"].items():
        section.rows.append(compare(setting, "12", name, pair[name], evaluate(text)))
    dual = cga.dual(PP)
    others = [blade for blade in ("e45",) if sp.expand(getattr(dual, blade)) != 0]
    grades = f"$PP$ of the text has grade {', '.join(map(str, PP.grades))}, and the nine of (12) have grade 2: they "
    section.notes.append(
        grades
        + "are the coefficients of the dual $PP^*$, with $X^* = X I^{-1}$. "
        + (f"Besides them there is {others}." if others else "The tenth bivector, $e_4 \\wedge e_5$, is 0.")
    )
    section.notes.append(
        "No free scale: the factor $\\frac12$ of the print comes out. $d_1$ is the radius of the sphere about the "
        "shoulder, so it is the upper arm, and $d_2$, about the wrist, the forearm. Table 3 of the paper has them "
        "the other way round; see (13)."
    )
    return section


def _sums(printed) -> Section:
    setting = Setting(point=POSE)
    _, pair = _pair()
    section = Section(
        "(19) Sums and differences of the point pair",
        "Section 4.2 replaces the last six coefficients of (12) by $PP_m^+ = PP_{m5} + PP_{m4}$ and "
        "$PP_m^- = PP_{m5} - PP_{m4}$. They are formed from the derived coefficients. The print leaves out the "
        "indices; they are read as those of $PP_{m5}$ in (12).",
        [setting],
    )
    for name, text in printed["19"].items():
        m, op = name[3], 1 if name.endswith("p") else -1
        derived = pair[f"PP_{m}5"] + op * pair[f"PP_{m}4"]
        section.rows.append(compare(setting, "19", name, derived, evaluate(text), FACTOR["19"]))
    free = _pair_setting()
    nine = dict(zip(PP_NAMES, symbols(" ".join(PP_NAMES)), strict=True))
    point = elbow_of(nine, free)
    (P_e, square) = point
    products = sum((nine[f"PP_{m}5"] + nine[f"PP_{m}4"]) * (nine[f"PP_{m}5"] - nine[f"PP_{m}4"]) for m in "123")
    sums = products - sum(nine[f"PP_{u}"] ** 2 for u in "ijk")
    section.facts.append(
        compare(free, "fact", r"\mathrm{tmp}_1 = -PP_i^2 - PP_j^2 - PP_k^2 + \sum_m PP_m^+ PP_m^-", square, sums)
    )
    # p_e of a pair scaled by lambda > 0; its root scales by lambda, which the first statement says.
    lam, tmp_sqr = symbols("lam tmp_sqr")
    scaled = {nine[name]: lam * nine[name] for name in PP_NAMES}
    section.facts.append(
        compare(
            free, "fact", r"\mathrm{tmp}_1(\lambda PP) = \lambda^2\,\mathrm{tmp}_1(PP)",
            square.subs(scaled, simultaneous=True), lam**2 * square,
        )
    )  # fmt: skip
    for axis, value in zip("xyz", P_e, strict=True):
        statement = rf"p_{{e{axis}}}(\lambda PP) = p_{{e{axis}}}(PP),\ \lambda > 0"
        bigger = value.subs(scaled | {tmp_sqr: lam * tmp_sqr}, simultaneous=True)
        section.facts.append(compare(free, "fact", statement, bigger, value))
    # Only the last six doubled, as a reader of (12) with (19) gets them.
    mixed = {nine[name]: 2 * nine[name] for name in PP_NAMES[3:]}
    partly = square.subs(mixed, simultaneous=True)
    section.facts.append(
        compare(free, "fact false", r"\mathrm{tmp}_1 \text{ of a pair with only the last six doubled is } "
                r"4\,\mathrm{tmp}_1", partly, 4 * square)
    )  # fmt: skip
    section.notes.append(
        "The print has a pair scaled by 2. That is allowed, a point pair is homogeneous: $p_e$ does not change, as "
        "the statements show (for $\\lambda < 0$ the root turns its sign, and the other elbow comes out). But "
        "$PP_i, PP_j, PP_k$ must then be doubled too, which section 4.2 does not say: with those of (12) as printed "
        "the elbow is wrong."
    )
    return section


def _pair_setting() -> Setting:
    """Nine free symbols for PP*."""
    (tmp_sqr,) = symbols("tmp_sqr")
    values = (1, 2, 3, 1, 7, 2, 6, 3, 8)
    square = evaluate(PRINTED["13"]["tmp1"])  # names the root only: that the derived radicand is it, is compared
    point = dict(zip(PP_NAMES, values, strict=True)) | {"tmp_sqr": 11, "lam": 2}
    return Setting(roots={tmp_sqr: square}, point=point)


def elbow_of(nine: dict[str, sp.Expr], setting: Setting):
    """((p_ex, p_ey, p_ez), radicand) that `geometry.elbow_point` makes of a pair PP* with these coefficients."""
    keys = tuple(cga.ALGEBRA.canon2bin[blade] for blade in BIVECTOR)
    # i = -e23, j = e13, k = -e12
    signs = (-1, 1, -1, 1, 1, 1, 1, 1, 1)
    pair = cga.ALGEBRA.multivector(keys=keys, values=[s * nine[n] for s, n in zip(signs, PP_NAMES, strict=True)])
    P_e = geometry.elbow_point(-cga.dual(pair))  # a second dual gives back -X
    coordinates = [sp.sympify(value) for value in cga.euclidean_coordinates(P_e)]
    named = [sp.factor(setting.named(value)) for value in coordinates]
    return named, radicand(coordinates[0], setting)


def _elbow_point(printed) -> Section:
    free = _pair_setting()
    nine = dict(zip(PP_NAMES, symbols(" ".join(PP_NAMES)), strict=True))
    P_e, square = elbow_of(nine, free)
    d1, d2, tmp_sqr = symbols("d1 d2 tmp_sqr")
    section = Section(
        "(13) The elbow point",
        "Of the two points of the pair, $(PP^* \\mp |PP^*|) / (e_\\infty \\cdot PP^*)$, the first, divided by its "
        "$e_0$ coefficient: `elbow_point`. The pair is nine symbols, with no relation between them.",
        [free],
    )
    rows = printed["13"]
    inf_PP = sp.fraction(P_e[0])[1]
    section.rows.append(compare(free, "13", "inf_PP", inf_PP, evaluate(rows["inf_PP"])))
    section.rows.append(compare(free, "13", "tmp1", square, evaluate(rows["tmp1"])))
    for name, derived in zip(("p_ex", "p_ey", "p_ez"), P_e, strict=True):
        text = evaluate(rows[name], inf_PP=evaluate(rows["inf_PP"]))
        section.rows.append(compare(free, "13", name, derived, text))

    # The same point with the pair of (12) put in.
    _, pair = _pair()
    put = {nine[name]: value for name, value in pair.items()}
    radicand_pose = sp.expand(square.subs(put))
    reached = Setting(
        relations=_plane_through_line() | {r"\mathrm{tmp}_{sqr}^2 = \mathrm{tmp}_1": tmp_sqr**2 - radicand_pose},
        leading="tmp_sqr pi_x p_wx",
        point=POSE | {"tmp_sqr": sp.sqrt(radicand_pose.subs({SYMBOL[k]: v for k, v in POSE.items()}))},
    )
    section.settings.append(reached)
    # Multiplied by inf_PP, the common denominator; cancelling such quotients would take minutes.
    elbow = [sp.expand((value * inf_PP).subs(put)) for value in P_e]
    weight = sp.expand(inf_PP.subs(put))

    def fact(statement, left, right):
        section.facts.append(compare(reached, "fact", statement, sp.expand(left), sp.expand(right)))
        section.facts[-1].method += r", both sides times a power of $\mathrm{inf}_{PP}$"

    p_w_sqr, normal_sqr = dot(P_W, P_W), dot(PI, PI)
    fact(r"|p_e|^2 = d_1^2", dot(elbow, elbow), d1**2 * weight**2)
    forearm = minus(elbow, [weight * p for p in P_W])
    fact(r"|p_e - p_w|^2 = d_2^2", dot(forearm, forearm), d2**2 * weight**2)
    fact(r"\pi_{swivel} \cdot p_e = 0", dot(PI, elbow), sp.Integer(0))
    fact(r"(\pi_{swivel} \times p_w) \cdot p_e = \mathrm{tmp}_{sqr}", dot(cross(PI, P_W), elbow), tmp_sqr * weight)
    product = ((d1 + d2) ** 2 - p_w_sqr) * (p_w_sqr - (d1 - d2) ** 2)
    statement = (
        r"\mathrm{tmp}_1 = \tfrac14 |\pi_{swivel}|^2 \left((d_1 + d_2)^2 - |p_w|^2\right)"
        r"\left(|p_w|^2 - (d_1 - d_2)^2\right)"
    )
    section.facts.append(compare(reached, "fact", statement, radicand_pose, sp.expand(normal_sqr * product) / 4))
    # The left side is d1^2 by the first statement.
    statement = r"|p_e|^2 = d_2^2 \text{, table 3's } d_2 \text{ as the upper arm}"
    section.facts.append(compare(Setting(point=POSE), "fact false", statement, d1**2, d2**2))
    section.notes += [
        "Scale: $\\mathrm{inf}_{PP}$ is the denominator of the derived coordinates in lowest terms. It is the "
        "square of the vector $e_\\infty \\cdot PP^*$ by which the pair is divided, and the factor that makes the "
        "$e_0$ coefficient of $P_e$ 1.",
        "The statements hold for the elbow with the derived (12) put in; (14) and (15) use the first two. So the "
        "upper arm is $d_1$ and the forearm $d_2$, against table 3. The sign of the root decides for the elbow on "
        "the side of $L_{sw}$ that $\\pi_{swivel} \\times p_w$ points to. The root is real exactly for targets in "
        "reach.",
    ]
    return section


def _elbow_quaternion(printed) -> Section:
    d1, d2, cos4, sin4 = symbols("d1 d2 cos4 sin4")
    forearm = minus(P_E, P_W)
    setting = Setting(
        relations={
            r"|p_e|^2 = d_1^2": d1**2 - dot(P_E, P_E),
            r"|p_e - p_w|^2 = d_2^2": d2**2 - dot(forearm, forearm),
        },
        leading="d1 d2",
        roots={d1: d1**2, d2: d2**2},
        point={"p_ex": 1, "p_ey": 2, "p_ez": 2, "d1": 3, "p_wx": 3, "p_wy": 5, "p_wz": 8, "d2": 7},
    )
    L_se, _, c4, Q_e = geometry.elbow_quaternion(cga.point(*P_E), cga.point(*P_W))
    section = Section(
        "(14) The elbow cosine and $Q_e$",
        "The lines $L_{se} = (e_0 \\wedge P_e \\wedge e_\\infty)^*$ and $L_{ew} = (P_e \\wedge P_w \\wedge "
        "e_\\infty)^*$, the cosine (5) between them, and the quaternion of half that angle, (8) and (9): "
        "`elbow_quaternion`. $P_e$ and $P_w$ are points with symbols for coordinates.",
        [setting],
    )
    derived = setting.named(c4)
    rows = printed["14"]
    section.rows.append(compare(setting, "14", "c_4", c4, evaluate(rows["c_4"])))
    halves = copy.copy(setting)
    halves.roots = setting.roots | {cos4: (1 + derived) / 2, sin4: (1 - derived) / 2}
    w, i, j, k = cga.quaternion_coefficients(Q_e)
    for name, value in (("qe_w", w), ("qe_i", i)):
        section.rows.append(compare(halves, "14", name, value, evaluate(rows[name], c_4=evaluate(rows["c_4"]))))
    for unit, value in (("j", j), ("k", k)):
        section.facts.append(compare(halves, "fact", rf"\langle Q_e\rangle_{unit} = 0", value, sp.Integer(0)))
    away, on = [-p for p in P_E], minus(P_W, P_E)
    section.facts += [
        compare(setting, "fact", r"c_4\,d_1 d_2 = (-p_e) \cdot (p_w - p_e)", c4 * d1 * d2, dot(away, on)),
        compare(
            setting, "fact", r"c_4 = (d_1^2 + d_2^2 - |p_w|^2) / (2 d_1 d_2)",
            c4, (d1**2 + d2**2 - dot(P_W, P_W)) / (2 * d1 * d2),
        ),
    ]  # fmt: skip
    text_line = copy.copy(setting)
    (L_sw,) = symbols("L_sw")
    text_line.relations = setting.relations | {r"|L_{sw}|^2 = |p_w|^2": L_sw**2 - dot(P_W, P_W)}
    text_line.leading = "L_sw d1 d2"
    text_line.roots = setting.roots | {L_sw: L_sw**2}
    text_line.point = setting.point | {"L_sw": sp.sqrt(98)}
    other = cga.cos_angle(L_se, cga.dual(cga.line_direct(cga.e_0, cga.point(*P_W))))
    statement = r"c_4 = \cos(L_{se}, L_{sw}) \text{, section 3.3's line through shoulder and wrist}"
    section.facts.append(compare(text_line, "fact false", statement, c4, other))
    plus = sin4
    statement = r"\langle Q_e\rangle_i = +\sin\frac{\theta_4}{2} \text{, section 3.3 before (14)}"
    halves.point = setting.point
    section.facts.append(compare(halves, "fact false", statement, i, plus))
    section.notes += [
        "$c_4$ is the cosine of the interior angle at the elbow, between the directions to the shoulder and to the "
        "wrist. Standard lines square to -1, which turns the cosine between the lines' directions into that.",
        "The text calls $L_{ew}$ the line through shoulder and wrist, which gives another angle; its formula "
        "$(P_e \\wedge P_w \\wedge e_\\infty)^*$ and (14) have elbow and wrist. It also has $Q_e = "
        "\\cos\\frac{\\theta_4}{2} + \\sin\\frac{\\theta_4}{2} i$ first and a minus in (14), as has the geometry.",
    ]
    return section


def _rotate_to_elbow(printed) -> Section:
    d1, L_m_length = symbols("d1 L_m")
    point = {"p_ex": 72, "p_ey": 96, "p_ez": -35, "d1": 125}
    on_sphere = {r"|p_e|^2 = d_1^2": dot(P_E, P_E) - d1**2}
    setting = Setting(relations=on_sphere, leading="p_ez", point=point)
    _, _, _, L_m, Q_12 = geometry.elbow_rotation(cga.point(*P_E), d1)
    _, *middle = cga.quaternion_coefficients(L_m)
    w, *q12 = cga.quaternion_coefficients(Q_12)
    section = Section(
        "(15) The middle line and $Q_{12}$",
        "The middle plane $\\pi_m = P_{ze} - P_e$ and the plane $\\pi_e^* = e_0 \\wedge P_{ze} \\wedge P_e \\wedge "
        "e_\\infty$ meet in $L_m = \\pi_e \\wedge \\pi_m$, and $Q_{12} = L_m / |L_m|$: `elbow_rotation`. $P_e$ is a "
        "point with symbols for coordinates, $P_{ze}$ lies $d_1$ up the z axis.",
        [setting],
    )
    rows = printed["15"]
    square = radicand(sp.sympify(q12[0]), setting)
    section.rows.append(compare(setting, "15", "tmp2", square, evaluate(rows["tmp2"])))
    known = Setting(
        relations=on_sphere | {r"|L_m|^2 = \mathrm{tmp}_2": L_m_length**2 - setting.remainder(square)[0]},
        leading="L_m p_ez",
        roots={L_m_length: square},
        point=point | {"L_m": sp.sqrt(square.subs({SYMBOL[k]: v for k, v in point.items()}))},
    )
    section.settings.append(known)
    length = evaluate(rows["L_m"], tmp2=evaluate(rows["tmp2"]))
    row = compare(known, "15", "L_m", sp.sqrt(square), length)
    row.derived = sp.sqrt(setting.normal(square)) if row.holds else row.derived
    section.rows.append(row)
    for unit, derived in zip("ijk", q12, strict=True):
        section.rows.append(compare(known, "15", f"q12_{unit}", derived, evaluate(rows[f"q12_{unit}"])))
    named = [known.named(value) for value in q12]
    for unit, value, top in zip("ijk", middle, named, strict=True):
        statement = rf"\langle L_m\rangle_{unit} = {latex(known.normal(value))} = q_{{12{unit}}} |L_m|"
        section.facts.append(compare(known, "fact", statement, value, top * L_m_length))
    section.facts.append(compare(known, "fact", r"\langle Q_{12}\rangle = 0", w, sp.Integer(0)))
    for n in "123":
        blade = f"e{n}^einf"
        label = rf"\langle L_m\rangle_{{e_{n} \wedge e_\infty}} = 0"
        section.facts.append(compare(setting, "fact", label, cga.coefficient(L_m, blade), sp.Integer(0)))
    section.facts.append(compare(known, "fact", r"|Q_{12}|^2 = 1", dot(named, named), sp.Integer(1)))
    turned = cga.rotate(cga.quaternion(0, *named), cga.e3)
    for axis, value, target in zip("xyz", normal_vector(turned), P_E, strict=True):
        statement = rf"\langle Q_{{12}}\,e_3\,\tilde Q_{{12}}\rangle_{axis} = p_{{e{axis}}} / d_1"
        section.facts.append(compare(known, "fact", statement, value, target / d1))
    section.notes += [
        "Scale: none is free in $L_m$ as built, and $Q_{12}$ is divided by it. The $e_\\infty$ parts of $\\pi_m$ "
        "and $L_m$ vanish because $|p_e| = d_1$, proved under (13): then the middle plane goes through the origin. "
        "$L_m$ vanishes for an elbow on the z axis.",
        "The last statements say that the half turn about $L_m$ brings the z axis to the elbow.",
    ]
    return section


def _rotate_to_wrist(printed) -> Section:
    q12 = symbols("q12_i q12_j q12_k")
    abs_pi, abs_side, cos3, sin3 = symbols("abs_pi abs_side cos3 sin3")
    base = {
        r"|Q_{12}|^2 = 1": dot(q12, q12) - 1,
        r"|\pi_{swivel}|^2 = \pi_{swivelx}^2 + \pi_{swively}^2 + \pi_{swivelz}^2": abs_pi**2 - dot(PI, PI),
    }
    third = sp.Rational(1, 3)
    point = {"q12_i": third, "q12_j": 2 * third, "q12_k": 2 * third, "pi_x": 2, "pi_y": 3, "pi_z": 6, "abs_pi": 7}
    point |= {"p_wx": 3, "p_wy": -2, "p_wz": 1}
    setting = Setting(base, "q12_k abs_pi", {sp.Integer(1): sp.Integer(1), abs_pi: abs_pi**2}, point, plain=True)
    _, c3, sign, Q_3 = geometry.wrist_rotation(cga.quaternion(0, *q12), cga.plane(*PI, 0), cga.point(*P_W))
    section = Section(
        "(17) The rotation about the upper arm",
        "The plane $\\pi_{yz} = e_1$, turned by $Q_{12}$, gives $\\pi_{yz2}$. The angle between it and the swivel "
        "plane, both in direct representation, is (5); the quaternion of half of it is (8) and (9), and the side of "
        "$\\pi_{yz2}$ on which $P_w$ lies, $\\pi_{yz2} \\cdot P_w$, gives the sign: `wrist_rotation`. $Q_{12}$, the "
        "plane and $P_w$ are symbols.",
        [setting],
    )
    rows = printed["17"]
    # sign = side / |side|: the side is what the absolute value is of
    inside = [a.args[0] for a in sp.sympify(sign).atoms(sp.Abs)]
    side = sp.expand(sign * sp.Abs(inside[0])) if len(inside) == 1 else sp.sympify(sign)
    section.rows.append(compare(setting, "17", "c_3", c3, evaluate(rows["c_3"])))
    section.rows.append(compare(setting, "17", "side", side, evaluate(rows["side"])))
    full = copy.copy(setting)
    derived_c3 = setting.named(c3)
    full.roots = setting.roots | {
        abs_side: sp.expand(side) ** 2,
        cos3: (1 + derived_c3) / 2,
        sin3: (1 - derived_c3) / 2,
    }
    values = {"c_3": evaluate(rows["c_3"]), "side": evaluate(rows["side"])}
    values["sign"] = evaluate(rows["sign"], **values)
    w, i, j, k = cga.quaternion_coefficients(Q_3)
    for name, derived in (("sign", sign), ("q3_s", w), ("q3_k", k)):
        section.rows.append(compare(full, "17", name, derived, evaluate(rows[name], **values)))
    for unit, value in (("i", i), ("j", j)):
        section.facts.append(compare(full, "fact", rf"\langle Q_3\rangle_{unit} = 0", value, sp.Integer(0)))
    ruled = Setting({r"|\mathrm{side}|^2 = \mathrm{side}^2": abs_side**2 - side**2}, "abs_side")
    at_sign, scalar, k_part = full.named(sign), full.named(w), full.named(k)
    statement = r"\mathrm{sign} \cdot \left(\mathrm{sign}\,\cos\frac{\theta_3}{2}\right) = q_{3,scalar}"
    section.facts.append(compare(ruled, "fact", statement, at_sign * at_sign * cos3, scalar))
    statement = r"\mathrm{sign} \cdot \sin\frac{\theta_3}{2} = q_{3k}"
    section.facts.append(compare(ruled, "fact", statement, at_sign * sin3, k_part))
    section.notes += [
        "$\\cos\\frac{\\theta_3}{2}$ and $\\sin\\frac{\\theta_3}{2}$ stand for the two roots with the derived "
        "$c_3$ in them, and $\\mathrm{side}$ for what the print calls sign before it is divided by its absolute "
        "value. A positive factor of the plane $\\pi_{swivel}$ cancels in $c_3$; a negative one would turn it.",
        "(16) has the sign $\\pm$ at the scalar part, (17) has it at the k part. By the last two statements the two "
        "quaternions are $\\pm$ each other, the same rotation. Where $\\mathrm{side} = 0$ the print is 0/0.",
    ]
    return section


def _product(printed) -> Section:
    q12, (q3_s, q3_k) = symbols("q12_i q12_j q12_k"), symbols("q3_s q3_k")
    point = {"q12_i": 1, "q12_j": 2, "q12_k": 3, "q3_s": 5, "q3_k": 7}
    setting = Setting(point=point)
    Q_s = cga.quaternion(0, *q12) * cga.quaternion(q3_s, 0, 0, q3_k)  # as in geometry.solve
    section = Section(
        "(18) The shoulder quaternion",
        "The product $Q_s = Q_{12} Q_3$, as in `solve`, of quaternions with symbols.",
        [setting],
    )
    for (name, text), derived in zip(printed["18"].items(), cga.quaternion_coefficients(Q_s), strict=True):
        section.rows.append(compare(setting, "18", name, derived, evaluate(text)))
    return section


# -- LaTeX -----------------------------------------------------------------------------------------------------------


def latex(expression) -> str:
    return sp.latex(expression, symbol_names=_NAMES)


def tex(text: str) -> str:
    """A printed expression as LaTeX, in the print's order of terms."""
    return _tex(ast.parse(text, mode="eval").body)


def _tex(node, level=0) -> str:
    """level: 0 takes anything, 1 what may stand in a product, 2 what may be raised to a power."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.Name):
        return f"{{{TEX[node.id]}}}" if level == 2 and "^" in TEX[node.id] else TEX[node.id]
    if isinstance(node, ast.Call):
        argument, name = _tex(node.args[0]), node.func.id
        shapes = {"sqrt": rf"\sqrt{{{argument}}}", "abs": rf"\left|{argument}\right|"}
        return shapes.get(name, rf"\{name} {argument}")
    if isinstance(node, ast.UnaryOp):
        result, own = f"-{_tex(node.operand, 1)}", 0 if level == 2 else 1
    elif isinstance(node.op, (ast.Add, ast.Sub)):
        sign = "+" if isinstance(node.op, ast.Add) else "-"
        result, own = f"{_tex(node.left)} {sign} {_tex(node.right, int(sign == '-'))}", 0
    elif isinstance(node.op, ast.Mult):
        result, own = f"{_tex(node.left, 1)} {_tex(node.right, 1)}", 1
    elif isinstance(node.op, ast.Div):
        result, own = rf"\frac{{{_tex(node.left)}}}{{{_tex(node.right)}}}", 1
    else:
        exponent = _tex(node.right)
        if isinstance(node.left, ast.Call) and node.left.func.id in ("cos", "sin"):
            return rf"\{node.left.func.id}^{exponent} {_tex(node.left.args[0])}"
        result, own = f"{_tex(node.left, 2)}^{exponent}", 2
    return result if own >= level else rf"\left({result}\right)"


def _aligned(equations: list[tuple[str, str]]) -> list[str]:
    """A block of equations, aligned at the equals signs; long sums go over several lines."""
    lines = []
    for left, right in equations:
        terms = _terms(right)
        first, rest = terms[:TERMS], terms[TERMS:]
        lines.append(f"{left} &= {''.join(first)}")
        while rest:
            lines.append(rf"&\quad {''.join(rest[:TERMS])}")
            rest = rest[TERMS:]
    lines = [line.replace("  ", " ").rstrip() for line in lines]
    return ["$$", r"\begin{aligned}", *(f"{line} \\\\" for line in lines[:-1]), lines[-1], r"\end{aligned}", "$$"]


TERMS = 5


def _terms(right: str) -> list[str]:
    """The terms of a sum with their signs, cut outside all brackets; products are left whole."""
    terms, depth, start = [], 0, 0
    for n, letter in enumerate(right):
        depth += letter in "{(["
        depth -= letter in "})]"
        if depth == 0 and letter in "+-" and n and right[n - 1] == " " and right[n + 1] == " ":
            terms.append(right[start:n])
            start = n
    return [*terms, right[start:]]


# -- the page --------------------------------------------------------------------------------------------------------


def unexpected(sections: list[Section]) -> list[str]:
    """What came out otherwise than is known of the paper. Empty if all is well."""
    found = []
    for section in sections:
        for row in section.rows:
            wrong = (row.equation, row.name) in KNOWN_WRONG
            expected = "differs" if wrong else "factor" if FACTOR.get(row.equation, 1) != 1 else "equal"
            if row.verdict != expected or row.method.startswith("undecided"):
                found.append(f"({row.equation}) {row.name}: {row.verdict}, expected {expected}; {row.method}")
        for fact in section.facts:
            if fact.holds == (fact.equation == "fact false") or fact.method.startswith("undecided"):
                found.append(f"{section.title}: {fact.name}: {'holds' if fact.holds else 'does not hold'}")
    return found


def page(sections: list[Section]) -> str:
    """docs/derivation.md."""
    out = [
        "# The paper's equations, derived from its geometry",
        "",
        "Written by `make derive` (`python -m scripts.derive.paper`); `make test` fails when it is out of date.",
        "",
        "The functions of `model/reference/geometry.py` build planes, spheres, circles and lines in conformal",
        "algebra and",
        "intersect and turn them, as section 3 of the paper says in words. Here they run on symbols. What comes out",
        "is compared with the equations as the paper prints them, which `model/reference/printed.py` has in one",
        "table. No",
        "result is typed in: the derived coefficients below are the program's output, reduced and factored.",
        "",
        "How a line is proved:",
        "",
        "- *expansion*: the difference of both sides, over a common denominator, has a numerator that expands to the",
        "  zero polynomial;",
        "- *expansion, modulo ...*: the numerator leaves the remainder 0 when it is divided by the relations named.",
        "  The leading terms of a section's relations are coprime, so they are a Gröbner basis and the remainder is",
        "  0 exactly if the difference follows from them. A relation is used only below the line that proves it of",
        "  the derived quantities. A square root in the output is first recognized, by the same division, as the",
        "  quantity not less than 0 that it is the root of;",
        "- *a point where they differ*: an exact point that satisfies all relations refutes an equality. The",
        "  difference there is exact too; one that is not rational is shown to six digits.",
        "",
        "All of these are exact. No equality rests on samples: every one was decided by expansion. Both sides are",
        "rational functions there, so an equality holds wherever no denominator is 0.",
        "",
        "## Summary",
        "",
        "| equation | rows | verdict | method |",
        "| --- | --- | --- | --- |",
    ]
    groups: dict[str, list[Row]] = {}
    for section in sections:
        for row in section.rows:
            groups.setdefault(row.equation, []).append(row)
    for equation, rows in groups.items():
        for verdict in ("equal", "factor", "differs"):
            some = [row for row in rows if row.verdict == verdict]
            if some:
                names = ", ".join(f"${_cell(TEX[row.name])}$" for row in some)
                methods = list(dict.fromkeys(row.method for row in some))
                out.append(f"| ({equation}) | {names} | {_verdict(some[0])} | {'; '.join(methods)} |")
    refuted = [fact for section in sections for fact in section.facts if fact.equation == "fact false"]
    out += ["", "Readings of the paper's text that fail, shown below:", ""]
    out += [f"- ${fact.name}$: {'holds' if fact.holds else 'does not hold'}." for fact in refuted]
    for section in sections:
        out += ["", *_section(section)]
    return "\n".join(out) + "\n"


def _verdict(row: Row) -> str:
    if row.verdict == "factor":
        return f"equal up to the factor {row.factor}"
    return {"equal": "equal", "differs": "**print wrong**"}[row.verdict]


def _section(section: Section) -> list[str]:
    out = [f"## {section.title}", "", section.construction, "", "Derived:", ""]
    out += _aligned([(TEX[row.name], latex(row.derived)) for row in section.rows])
    out += ["", "Printed:", ""]
    out += _aligned([(TEX[row.name], tex(PRINTED[row.equation][row.name])) for row in section.rows])
    out += ["", "| row | verdict | method |", "| --- | --- | --- |"]
    out += [f"| ${_cell(TEX[row.name])}$ | {_verdict(row)} | {row.method} |" for row in section.rows]
    wrong = [row for row in section.rows if row.verdict == "differs"]
    if wrong:
        out += ["", "Derived minus printed:", ""]
        out += _aligned([(rf"\Delta {TEX[row.name]}", latex(row.difference)) for row in wrong])
        out += ["", *(f"- ${TEX[row.name]}$: {row.witness}" for row in wrong)]
    if section.facts:
        out += ["", "Statements:", "", "| statement | verdict | method |", "| --- | --- | --- |"]
        for fact in section.facts:
            verdict = "holds" if fact.holds else "**does not hold**"
            out.append(f"| ${_cell(fact.name)}$ | {verdict} | {fact.method} |")
        for fact in section.facts:
            if not fact.holds:
                out += ["", f"Left minus right of ${fact.name}$:", "", "$$", latex(fact.difference), "$$"]
                out += ["", fact.witness]
    for note in section.notes:
        out += ["", note]
    return out


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.derive.paper", description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare the page, write nothing")
    check = parser.parse_args(arguments).check
    sections = derive()
    text = page(sections)
    wrong = unexpected(sections)
    for line in wrong:
        print(f"unexpected: {line}", file=sys.stderr)
    name = PAGE.relative_to(ROOT)
    if check:
        stale = not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text
        if stale:
            print(f"{name} is out of date: run `make derive`", file=sys.stderr)
        return int(stale or bool(wrong))
    if wrong:
        print(f"{name} not written", file=sys.stderr)
        return 1
    PAGE.write_text(text, encoding="utf-8")
    rows = sum(len(section.rows) for section in sections)
    print(f"wrote {name}: {rows} printed rows, {sum(len(s.facts) for s in sections)} statements")
    return 0


if __name__ == "__main__":
    sys.exit(main())

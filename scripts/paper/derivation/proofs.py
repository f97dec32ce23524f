# SPDX-License-Identifier: Apache-2.0
"""Proof engine of both derivations. Statements are text; they are decided by expansion modulo given relations.

A statement is "left = right" in the names of the model. It is evaluated with sympy for the proof and written as LaTeX
for the page.
"""

import contextlib
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

from model.reference.cga import symbol
from model.reference.equations import C4, TEXT

PRINTED = {number: dict(lines) for number, lines in TEXT.items()}
"""Equation -> row -> right side as printed. In (14), c4 replaces the fraction in both roots, as in the paper's text."""
PRINTED["(14)"] = {"c4": C4} | {name: text.replace(C4, "c4") for name, text in TEXT["(14)"].items()}

SQUARE = ("l_sw*cos(phi/2))", "l_sw*cos(phi/2)**2)")
MISPRINTS = {("(11)", "pi_swivel_x"): SQUARE, ("(11)", "pi_swivel_y"): SQUARE}
"""(equation, row) -> (misprint, its correction). The proofs refute the misprint and prove the correction."""


def corrected(number: str, name: str) -> str:
    """Return the right side of row ``name`` of equation ``number`` in the paper, with any misprint corrected."""
    return PRINTED[number][name].replace(*MISPRINTS.get((number, name), ("", "")))


TEX = {
    "phi": r"\phi", "d1": "d_1", "d2": "d_2", "a_far": "A", "b_near": "B", "k_law": "K", "l_sw": "|L_{sw}|",
    "l_m": "|L_m|", "pi": r"\pi_{swivel}", "pi_abs": r"|\pi_{swivel}|", "inf_pp": r"\mathrm{inf}_{PP}",
    "tmp1": r"\mathrm{tmp}_1", "tmp2": r"\mathrm{tmp}_2", "tmp_sqr": r"\mathrm{tmp}_{sqr}", "c3": "c_3", "c4": "c_4",
    "sign_raw": r"\mathrm{side}", "abs_side": r"|\mathrm{side}|", "sign": r"\mathrm{sign}", "abs_w": "|r_w|",
    "q3_scalar": r"q_{3,scalar}", "q3_k": "q_{3k}", "rho": r"\rho", "dist": "|p|", "gamma": r"\gamma",
    "sigma": r"\sigma", "length_sq": "|q|^2", "sqrt_a": r"\sqrt A", "sqrt_b": r"\sqrt B",
}  # fmt: skip
PATTERNS = (
    (r"p_([we])_([xyz])", r"p_{\1\2}"),
    (r"pi_swivel_([xyz])", r"\\pi_{swivel\1}"),
    (r"pp_(\d)_plus", r"PP_\1^+"),
    (r"pp_(\d)_minus", r"PP_\1^-"),
    (r"pp_(\w+)", r"PP_{\1}"),
    (r"q12_(\w)", r"q_{12\1}"),
    (r"q([se])_w", r"\\langle Q_\1\\rangle"),
    (r"q([se])_([ijk])", r"\\langle Q_\1\\rangle_\2"),
    (r"(cos|sin)_a", r"\\\1 a"),
    (r"(cos|sin)_h", r"\\\1\\frac\\phi2"),
    (r"(cos|sin)_(\w\w)", r"\\\1_{\2}"),
    (r"(cos|sin)_phi", r"\\\1\\phi"),
    (r"(cos|sin)([34])", r"\\\1\\frac{\\theta_\2}{2}"),
    (r"sqrt_(\w)", r"\\sqrt{d_\1}"),
    (r"(az|tilt|bend)_([cs])", r"\\mathrm{\1}_\2"),
    (r"(az|tilt|bend)_sq", r"|\\mathrm{\1}|^2"),
)
"""Pattern of names -> LaTeX. A name in neither table is its own LaTeX."""


def name_tex(name: str) -> str:
    found = (re.sub(pattern, latex, name) for pattern, latex in PATTERNS if re.fullmatch(pattern, name))
    return TEX.get(name) or next(found, name)


def symbols(names: str) -> list[sp.Symbol]:
    return [symbol(name) for name in names.split()]


COS_H, SIN_H = symbols("cos_h sin_h")
HALF_PHI = {sp.cos(symbol("phi") / 2): COS_H, sp.sin(symbol("phi") / 2): SIN_H}
HALF_CIRCLE = "sin_h**2 = 1 - cos_h**2"

FUNCTIONS: dict[str, Any] = {
    "sqrt": sp.sqrt, "Abs": sp.Abs, "cos": sp.cos, "sin": sp.sin,
    "dot": lambda a, b: a.dot(b), "cross": lambda a, b: a.cross(b), "sq": lambda a: a.dot(a),
    "vec": lambda *parts: sp.Matrix(parts),
}  # fmt: skip


def parse(text: str, values: Mapping[str, Any] | None = None, evaluate: bool = True) -> Any:
    """Return a formula as a sympy object. `values` maps names to values and functions; other names are symbols."""
    names = {name: symbol(name) for name in re.findall(r"[A-Za-z_]\w*", text)} | FUNCTIONS | dict(values or {})
    return parse_expr(text, local_dict=names, evaluate=evaluate)


def latex(expression: sp.Expr, order: str | None = None) -> str:
    """Return the LaTeX of a sympy expression, with a power of a sine or cosine written before the angle."""
    text = sp.latex(expression, order=order, symbol_names={v: name_tex(v.name) for v in expression.free_symbols})
    return re.sub(r"\\(cos|sin)( a|\\phi|\\frac\\phi2)(\^\{\d\})", r"\\\1\3\2", text)


def _call(form: str) -> Callable[..., sp.Symbol]:
    return lambda *parts: sp.Symbol(form.format(", ".join(latex(part, "none") for part in parts)))


SHOWN = {
    "sq": _call("|{}|^2"),
    "vec": _call(r"\left({}\right)"),
    "dot": lambda a, b: sp.Mul(a, sp.Symbol(r"\cdot"), b),
    "cross": lambda a, b: sp.Mul(a, sp.Symbol(r"\times"), b),
}
"""Function in a formula -> function that returns a sympy object with the right LaTeX."""


def tex(text: str) -> str:
    """Return the LaTeX of a formula or statement, with terms in the order of the text."""
    with sp.evaluate(False):
        sides = [latex(parse(side, SHOWN, evaluate=False), "none") for side in text.split(" = ")]
    return " = ".join(sides).replace(r"1 \cdot \frac", r"\frac")


def aligned(equations: Mapping[str, str]) -> str:
    """Format equations (LaTeX of left side -> of right side) as a block aligned at the equals signs."""
    lines = " \\\\\n".join(f"{left} &= {right}" for left, right in equations.items())
    return f"$$\n\\begin{{aligned}}\n{lines}\n\\end{{aligned}}\n$$"


def parts(left: Any, right: Any) -> list[sp.Expr]:
    """Return the components of left - right."""
    sides = [list(side) if isinstance(side, sp.MatrixBase) else [side] for side in (left, right)]
    return [sp.sympify(a) - b for a, b in zip(*sides, strict=True)]


class ProofError(Exception):
    """A statement does not hold. The message has a line for each such statement."""


class Step:
    """Section of a derivation: values of names, relations, recognized roots, and checked statements.

    A relation is "a*v**k = expression". The factor a is nonzero. The symbol v does not occur in a, in the expression or
    in an earlier relation. `roots` maps a nonnegative quantity to its square.
    """

    def __init__(self) -> None:
        self.values: dict[str, Any] = {}
        self.relations: dict[str, tuple[sp.Symbol, int, sp.Expr, sp.Expr]] = {}
        self.roots: dict[sp.Expr, sp.Expr] = {}
        self.printed: dict[str, str] = {}
        self.statements: list[str] = []
        self.wrong: list[str] = []

    def suppose(self, *relations: str) -> None:
        for text in relations:
            left, right = text.split(" = ")
            v = symbol(re.findall(r"[A-Za-z_]\w*", left)[-1])
            k = sp.degree(parse(left), v)
            self.relations[text] = (v, k, parse(left) / v**k, sp.expand(parse(right, self.values)))

    def reduce(self, part: sp.Expr) -> sp.Expr:
        """Multiply a polynomial by powers of each relation's factor a, then eliminate v**k with that relation. The
        result is unique: it is 0 if and only if the polynomial is 0 by the relations."""
        part = sp.expand(part)
        for v, k, factor, right in reversed(self.relations.values()):
            with contextlib.suppress(sp.PolynomialError):  # v in an unrecognized root
                part = sp.expand(sp.prem(part, factor * v**k - right, v))
        return part

    def rest(self, expression: sp.Expr) -> sp.Expr:
        """Return the reduced numerator of an expression, which is 0 if and only if the expression is 0."""
        expression = sp.sympify(expression)
        if any(power.exp.is_negative for power in expression.atoms(sp.Pow)):
            expression, below = sp.fraction(sp.together(expression))
            assert self.reduce(below) != 0, "a denominator vanishes identically"
        return self.reduce(expression)

    def root(self, square: sp.Expr) -> sp.Expr:
        """Return the quantity in `roots` whose square is ``square``; if there is none, the sympy root."""
        for quantity, known in self.roots.items():
            if self.rest(square - known) == 0:
                return quantity
        return sp.sqrt(square)

    def named(self, expression: Any) -> Any:
        """Return an expression of the algebra with its roots and absolute values replaced by quantities in `roots`."""
        expression = sp.nsimplify(expression, rational=True).xreplace(HALF_PHI)
        for _ in range(2):  # replacing a root can leave another absolute value
            expression = expression.replace(sp.Abs, self.absolute)
        halves = lambda part: part.is_Pow and part.exp.is_Rational and part.exp.q == 2  # noqa: E731
        return expression.replace(halves, lambda part: self.root(part.base) ** (2 * part.exp))

    def absolute(self, v: sp.Expr) -> sp.Expr:
        """Return |v|: v or -v, if one of them is a square in `roots`; else the root of v**2."""
        for known in self.roots.values():
            if self.rest(v - known) == 0 or self.rest(v + known) == 0:
                return known
        return self.root(v**2)

    def value(self, text: str, **more: Any) -> Any:
        """Return a formula's value with roots replaced by quantities in `roots`. more: values of further names."""
        return parse(text, {"sqrt": self.root, "Abs": self.absolute} | self.values | more).xreplace(HALF_PHI)

    def prove(self, *statements: str, label: str = "", **values: Any) -> None:
        """Prove statements "left = right", or chains of equations, by expansion. label: LaTeX shown instead."""
        for text in statements:
            first, *others = [self.value(side, **values) for side in text.split(" = ")]
            rests = [rest for other in others for part in parts(first, other) if (rest := self.rest(part)) != 0]
            wrong = f"{text}: does not hold; left minus right: {rests}" if rests else ""
            self._add(f"${label or tex(text)}$", wrong)

    def refute(self, text: str, point: Mapping[str, Any], label: str = "", **values: Any) -> None:
        """Refute a statement by exact evaluation at ``point``. Relations determine coordinates missing in ``point``."""
        left, right = (self.value(side, **values) for side in text.split(" = "))
        at = {symbol(name): sp.sympify(value) for name, value in point.items()}
        for v, k, factor, power in self.relations.values():
            at.setdefault(v, sp.root((power / factor).subs(at), k))
            assert sp.simplify((factor * v**k - power).subs(at)) == 0, f"the point is not on a relation of {v}"
        for quantity, square in self.roots.items():
            at.setdefault(quantity, sp.sqrt(square.subs(at)))
        above, below = sp.fraction(sp.together(left - right))
        difference = sp.factor(sp.cancel(self.reduce(above) / below))
        number = sp.simplify(difference.subs(at))
        spot = ", ".join(f"{name_tex(name)}={sp.latex(sp.sympify(value))}" for name, value in point.items())
        shown = sp.latex(number if number.is_Rational else sp.N(number, 6))
        value = f"left minus right is ${latex(difference)}$, at ${spot}$ it is ${shown}$"
        statement = f"${label or tex(text)}$: **does not hold**; {value}"
        wrong = "" if number != 0 and not number.free_symbols else f"{text}: not refuted"
        self._add(statement, wrong)

    def rows(self, number: str, derived: Mapping[str, Any], factor: int = 1, point: Mapping[str, Any] = {}) -> None:
        """Prove that the rows of equation ``number``, with misprints corrected, equal the derived rows times
        ``factor``. Refute each misprint at ``point``."""
        wrong = []
        for name, text in PRINTED[number].items():
            value = self.value(corrected(number, name))
            if self.rest(derived[name] * factor - value) != 0:
                wrong.append(name)
            if (number, name) in MISPRINTS:
                values = {"derived": derived[name], name: self.value(text)}
                label = rf"\text{{derived }}{name_tex(name)} = \text{{printed }}{name_tex(name)}"
                self.refute(f"derived = {name}", point, label, **values)
            self.values[name] = value
        self.printed |= {name_tex(name): tex(text) for name, text in PRINTED[number].items()}
        which = ", corrected," if any(number == n for n, _ in MISPRINTS) else ""
        times = f" times {factor}" if factor != 1 else ""
        error = f"{number}: {', '.join(wrong)} differ from the derived rows" if wrong else ""
        self._add(f"all rows of {number}{which} equal the derived ones{times}", error)

    def _add(self, statement: str, wrong: str) -> None:
        self.statements.append(f"- {statement}")
        if wrong:
            self.wrong.append(wrong)

    def block(self) -> str:
        """Return the proofs as Markdown: printed rows, relations, statements."""
        parts = [f"Printed:\n\n{aligned(self.printed)}"] if self.printed else []
        if self.relations:
            parts.append(f"Modulo {', '.join(f'${tex(text)}$' for text in self.relations)}:")
        return "\n\n".join([*parts, "\n".join(self.statements)])


def derive(steps: Iterable[Callable[[Step], None]]) -> dict[str, Step]:
    """Run each function on a new step; return a dict: name of the function -> step."""
    found = {}
    for function in steps:
        function(step := Step())
        found[function.__name__] = step
    return found


def failures(steps: Mapping[str, Step]) -> list[str]:
    """Return the statements that do not hold, each with the name of its step."""
    return [f"step {name}: {wrong}" for name, step in steps.items() for wrong in step.wrong]

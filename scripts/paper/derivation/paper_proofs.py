# SPDX-License-Identifier: Apache-2.0
"""Proof or refutation of rows of the paper's equations."""

from __future__ import annotations

from dataclasses import dataclass, field

import sympy as sp

from model.reference import cga
from scripts.paper.derivation.markdown import cell
from scripts.paper.derivation.printed import SYMBOL, TEX, symbols

EXPANSION = "expansion"


@dataclass
class Setting:
    """Assumptions of a step: vanishing polynomials, named roots, and a point for refutations."""

    relations: dict[str, sp.Expr] = field(default_factory=dict)  # LaTeX -> polynomial that is 0
    leading: str = ""  # names in elimination order, which makes the relations' leading terms coprime
    roots: dict[sp.Expr, sp.Expr] = field(default_factory=dict)  # a quantity >= 0 -> its square
    point: dict[str, object] = field(default_factory=dict)  # exact values for all symbols
    foreign: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)  # unexpected roots
    plain: bool = False  # derived coefficients are shown factored but not reduced
    recognized: dict[str, None] = field(default_factory=dict)  # relations used to recognize roots, in order

    def remainder(self, expression) -> tuple[sp.Expr, sp.Expr, list[str]]:
        """Return (n, d, used) with expression = n/d modulo the relations, which form a Groebner basis.

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
        """Reduce, cancel and factor an expression for print."""
        expression = self.named(expression)
        if self.plain:
            return sp.factor(expression)
        numerator, denominator, _ = self.remainder(expression)
        return sp.factor(sp.cancel(numerator / denominator))

    def named(self, expression) -> sp.Expr:
        """Replace every square root and absolute value by the equal nonnegative quantity."""
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
        """Return the exact value at the point; assert that the point satisfies all relations."""
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
    """Comparison of a derived with a printed coefficient, or of the two sides of a statement."""

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
    """Decide derived * factor = printed by expansion modulo the setting's relations. factor: scale of the print."""
    setting.recognized = {}
    derived, printed = setting.named(derived), setting.named(printed)
    rest, _, used = setting.remainder(derived * factor - printed)
    if rest == 0:
        shape = derived if equation.startswith("fact") else setting.normal(derived)
        used = list(dict.fromkeys([*setting.recognized, *used]))
        method = EXPANSION + (f", modulo {', '.join(f'${cell(u)}$' for u in used)}" if used else "")
        return Row(equation, name, shape, "equal" if factor == 1 else "factor", method, sp.Integer(factor))
    value = setting.at_point(derived * factor - printed)
    # Only a point can refute: a nonzero remainder may merely mean that the setting lacks a relation.
    shown = value if value.is_Rational else sp.N(value, 6)
    method = "a point where they differ" if value != 0 else "undecided: a remainder, but equal at the point"
    spot = ", ".join(f"{TEX[k]} = {sp.latex(sp.sympify(v))}" for k, v in setting.point.items())
    witness = f"At ${spot}$ it is ${sp.latex(shown)}$."
    difference = setting.normal(derived * factor - printed)
    return Row(equation, name, setting.normal(derived), "differs", method, sp.Integer(factor), difference, witness)


def radicand(expression, setting: Setting) -> sp.Expr:
    """Return the radicand of the expression's only square root, without absolute value and positive at the point."""
    found = {p.base for p in expression.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q == 2}
    (base,) = found
    base = base.args[0] if isinstance(base, sp.Abs) else base
    return base if setting.at_point(base) > 0 else -base


def normal_vector(plane):
    return [cga.coefficient(plane, blade) for blade in ("e1", "e2", "e3")]


@dataclass
class Section:
    title: str
    rows: list[Row] = field(default_factory=list)  # comparisons with the print
    facts: list[Row] = field(default_factory=list)  # statements that later sections use or that explain

    def row(self, *compared) -> None:
        """Compare a printed row; arguments as for `compare`."""
        self.rows.append(compare(*compared))

    def fact(self, setting: Setting, statement: str, left, right=0, kind: str = "fact") -> None:
        """Check a statement; kind "fact false" marks one known to be false."""
        self.facts.append(compare(setting, kind, statement, left, sp.sympify(right)))

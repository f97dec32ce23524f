# SPDX-License-Identifier: Apache-2.0
"""Proofs for docs/generated/lean.md and helpers shared by its steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import sympy as sp

from model.reference import cga
from scripts.paper.derivation.lean_forms import ROOT_OF, SYMBOL, TEX, Tables, latex, symbols
from scripts.paper.derivation.markdown import cell
from scripts.paper.derivation.paper_proofs import normal_vector
from scripts.paper.derivation.printed import evaluate

Relations = dict[str, tuple[sp.Symbol, sp.Expr]]
"""LaTeX -> (v, expression equal to v^2 and free of v and of every v of an earlier relation)."""


def reduced(expression, relations: Relations) -> tuple[sp.Expr, sp.Expr, list[str]]:
    """Return (n, d, used) with expression = n/d, where no symbol of a relation has a power above 1 in n or d.

    This form is unique: n is 0 exactly if the numerator lies in the ideal of the relations.
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
    """Reduce, cancel and factor an expression for display."""
    numerator, denominator, _ = reduced(expression, relations)
    return sp.factor(sp.cancel(numerator / denominator))


@dataclass
class Check:
    """One statement and its verdict."""

    statement: str  # LaTeX
    holds: bool
    method: str
    rest: str = ""  # left minus right, if the statement does not hold


@dataclass
class Step:
    """Section of the page."""

    title: str
    shown: list[tuple[str, str]] = field(default_factory=list)  # LaTeX of both sides, as derived
    checks: list[Check] = field(default_factory=list)
    extra: list[str] = field(default_factory=list)  # lines of the page

    def equal(self, statement: str, left, right, relations=None, more: str = "", root=None) -> None:
        """Decide left = right by expansion modulo the relations; compare lists component by component.

        root: the function that has recognized a root.
        """
        lefts, rights = (list(side) if isinstance(side, (list, sp.MatrixBase)) else [side] for side in (left, right))
        used, rests = dict.fromkeys(root.used if root else ()), []
        for one, other in zip(lefts, rights, strict=True):
            rest, _, of_this = reduced(sp.sympify(one) - other, relations or {})
            used |= dict.fromkeys(of_this)
            rests.append(rest)
        method = "expansion" + (f" of all {len(lefts)} components" if len(lefts) > 1 else "")
        method += f", modulo {', '.join(f'${cell(u)}$' for u in used)}" if used else ""
        method += (", a root recognized by its square" if root else "") + more
        wrong = [latex(rest) for rest in rests if rest != 0]
        self.checks.append(Check(statement, not wrong, method, r",\ ".join(wrong)))

    def true(self, statement: str, holds: bool, method: str, rest: str = "") -> None:
        self.checks.append(Check(statement, bool(holds), method, "" if holds else rest or "false"))


def known_root(candidates: list[sp.Expr], relations: Relations) -> Callable:
    """Return a sqrt() that returns the candidate whose square equals its argument; candidates must be >= 0.

    Its attribute `used` holds the relations applied.
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


def run_lines(table: dict, groups: list[str], values: dict[str, sp.Expr]) -> dict[str, sp.Expr]:
    """Evaluate the groups' lines from the values of other names. Roots must be given as values."""
    values = dict(values)
    for group in groups:
        for name, text in table[group].items():
            if name not in values:
                # evaluate() accepts `abs` and the names passed to it
                values[name] = evaluate(text.replace("Abs(", "abs("), **values)
    return values


def first_half(tables: Tables) -> tuple[dict[str, sp.Expr], Relations]:
    """Return the lines up to the triangle in x, y, z, d1, d2 and six square roots, and the roots' relations."""
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
    """Return the sums of the inputs with s as a symbol, for display."""
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
    """Return the paper's p_w in the directions of step 1."""
    return dict(zip(("p_wx", "p_wy", "p_wz"), [D * v for v in P_UNIT], strict=True))


def frame(tables: Tables) -> dict[str, list[sp.Expr]]:
    """Return n, m, e, f of the matrix form as vectors of the angles' sines and cosines."""
    values = run_lines(tables.matrix, ["Directions of the target", "Columns"], ANGLES)
    return {v: [values[f"{v}_{axis}"] for axis in "xyz"] for v in "nmef"}


def turn(axis: str, c, s) -> sp.Matrix:
    """Return the right-handed rotation about axis x or z by the angle with cosine c and sine s."""
    if axis == "z":
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return sp.Matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def rotation_matrix(quaternion) -> sp.Matrix:
    """Return the matrix of v -> Q v Q~, computed in the algebra, for a quaternion of any length."""
    columns = [normal_vector(cga.rotate(cga.quaternion(*quaternion), e)) for e in (cga.e1, cga.e2, cga.e3)]
    return sp.Matrix([[sp.expand(sp.sympify(columns[n][m])) for n in range(3)] for m in range(3)])

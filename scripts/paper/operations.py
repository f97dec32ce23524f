# SPDX-License-Identifier: Apache-2.0
"""Table 4 of the paper: operation counts of equations (10)-(19) and of the datapaths; operations.md.

Expressions are parsed from model/reference/equations.py, the operations of a datapath come from its dataflow. Nothing
is simulated or compiled.
"""

import operator
import textwrap
from collections.abc import Iterable
from functools import partial
from typing import NamedTuple

import sympy

from model.dataflow.datapaths import DATAPATHS
from model.dataflow.paper import SECTIONS
from model.reference.cga import symbol
from model.reference.equations import TEXT
from scripts.generate.flow import WIDTH, operations
from scripts.generate.render import render
from scripts.paper.derivation.proofs import parse
from tb.sim.env import GENERATED

PAGE = GENERATED / "operations.md"


class Ops(NamedTuple):
    """Operation counts; ``scale`` counts multiplications by a constant, ``trig`` sines and cosines."""

    add: int = 0
    mul: int = 0
    root: int = 0
    div: int = 0
    scale: int = 0
    trig: int = 0

    def __add__(self, other: "Ops") -> "Ops":
        return Ops(*map(operator.add, self, other))


UNOPTIMIZED, OPTIMIZED = Ops(147, 87, 8, 16), Ops(69, 42, 8, 10)
"""Table 4 as printed."""


PRINTED = {n: {name: parse(text, evaluate=False) for name, text in lines.items()} for n, lines in TEXT.items()}
"""Equation -> line -> right side as printed, unevaluated, so that operations can be counted."""


def count(expression: sympy.Expr) -> Ops:
    """Count the operations of an expression tree, without sharing."""
    if expression.is_Symbol or expression.is_Number:
        return Ops()
    if expression.is_Mul:
        return _product(expression)
    if expression.is_Pow:
        return _power(*expression.args)
    if isinstance(expression, (sympy.cos, sympy.sin)):
        return Ops(trig=1)  # half an angle is wiring
    if not isinstance(expression, (sympy.Add, sympy.Abs)):
        raise ValueError(f"no rule for the operation {expression.func.__name__}")
    return Ops(add=len(expression.args) - 1) + total(expression.args)


def _factors(expression: sympy.Expr) -> list[sympy.Expr]:
    return [f for a in expression.args for f in (_factors(a) if a.is_Mul else [a])]


def _product(expression: sympy.Expr) -> Ops:
    above, below, inside = 0, 0, Ops()
    for f in _factors(expression):
        if f.is_number:  # 2, 1/2: wiring
            inside += Ops(scale=int(abs(f.doit()) != 1))
        elif f.is_Pow and f.args[1].is_number and f.args[1] < 0:
            below += 1
            inside += _power(f.args[0], -f.args[1])
        else:
            above += 1
            inside += count(f)
    return inside + Ops(mul=max(above - 1, 0) + max(below - 1, 0), div=int(below > 0))


def _power(base: sympy.Expr, exponent: sympy.Expr) -> Ops:
    if exponent < 0:
        return _power(base, -exponent) + Ops(div=0 if base.is_number else 1)
    if exponent == sympy.Rational(1, 2):
        return count(base) + Ops(root=1)
    if not exponent.is_Integer:
        raise ValueError(f"no rule for the power {exponent}")
    # by repeated squaring: x^2 is one multiplication, x^3 and x^4 are two
    n = int(exponent)
    return count(base) + Ops(mul=n.bit_length() - 1 + n.bit_count() - 1)


def total(expressions: Iterable[sympy.Expr]) -> Ops:
    """Count the operations of several expressions, without sharing."""
    return sum(map(count, expressions), Ops())


def shared(lines: dict[str, sympy.Expr]) -> Ops:
    """Count the operations after ``sympy.cse`` over all lines at once."""
    trees, names = [e.doit() for e in lines.values()], sympy.numbered_symbols("shared_")
    common, rest = sympy.cse(trees, symbols=names, optimizations="basic", order="canonical")
    return total([e for _, e in common] + rest)


def printed_lines() -> dict[str, sympy.Expr]:
    """Return the lines of (10)-(18) in order."""
    return {name: e for number, lines in PRINTED.items() if number != "(19)" for name, e in lines.items()}


def lines_with_19() -> dict[str, sympy.Expr]:
    """Return (10)-(18) with (19) replacing the last six lines of (12); (13) follows by substitution."""
    to_19 = {}
    for m in "123":
        plus, minus = symbol(f"pp_{m}_plus"), symbol(f"pp_{m}_minus")
        to_19 |= {symbol(f"pp_{m}5"): (plus + minus) / 2, symbol(f"pp_{m}4"): (plus - minus) / 2}
    result = {}
    for name, e in printed_lines().items():
        if name in PRINTED["(13)"]:
            e = e.doit().subs(to_19)
            result[name] = sympy.expand(e) if name == "tmp1" else e
        else:
            result |= PRINTED["(19)"] if symbol(name) in to_19 else {name: e}
    return result


def by_section(datapath: str) -> dict[str, Ops]:
    """Return the operations of each section of a datapath; its RTL has an instance or an operator for each."""
    return {
        section: Ops(
            add=units["additions"],
            mul=units["mul"] + units["mul3"] + units["square"] + units["product"],
            root=units["root"] + units["rsqrt"],
            div=units["div"],
            trig=2 * (units["sincos"] + units["trig"]),
        )
        for section, units in operations(DATAPATHS[datapath].flow).items()
    }


def page() -> str:
    """Return operations.md."""
    lines, lines_19, sections = printed_lines(), lines_with_19(), by_section("paper")
    everything = sum(sections.values(), Ops())
    counts = {"old": UNOPTIMIZED, "new": OPTIMIZED, "guard": sections["guard"], "everything": everything}
    counts |= {"print": total(lines.values()), "print_19": total(lines_19.values())}
    counts |= {"cse": shared(lines), "cse_19": shared(lines_19), "lean": sum(by_section("lean").values(), Ops())}
    counts["rtl"] = Ops(*map(operator.sub, everything, sections["guard"]))
    counts["equations"] = {number: total(rows.values()) for number, rows in PRINTED.items()}
    named = {SECTIONS[section]: ops for section, ops in sections.items()}
    indents = {"initial_indent": "- ", "subsequent_indent": "  "}
    bullet = partial(textwrap.fill, width=118, break_long_words=False, break_on_hyphens=False, **indents)
    return render("operations", sections=named, bullet=bullet, width=WIDTH, **counts)


def write() -> int:
    """Count, write operations.md and return 0."""
    PAGE.write_text(page())
    print(f"wrote {PAGE.name}")
    return 0

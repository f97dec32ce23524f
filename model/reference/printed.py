# SPDX-License-Identifier: Apache-2.0
"""Equations (10)-(19) as printed in the paper, as sympy expressions: `PRINTED["(11)"]["pi_swivel_x"]`.

The expressions are not evaluated: their trees match the print, so that operations can be counted
(``scripts/paper/operations.py``); ``expression.doit()`` gives the ordinary, evaluated form.

Symbols are real.  Inputs: ``p_w_x, p_w_y, p_w_z, phi, d1, d2``; every other symbol is a name of a line above.
"""

from __future__ import annotations

import re

import sympy
from sympy.parsing.sympy_parser import parse_expr

from .equations import TEXT

_FUNCTIONS = {"sqrt": sympy.sqrt, "cos": sympy.cos, "sin": sympy.sin, "Abs": sympy.Abs}


def symbol(name: str) -> sympy.Symbol:
    """Return the symbol for ``name`` in all expressions."""
    return sympy.Symbol(name, real=True)


def _parse(text: str) -> sympy.Expr:
    names = {name: symbol(name) for name in re.findall(r"[A-Za-z_]\w*", text)} | _FUNCTIONS
    return parse_expr(text, local_dict=names, evaluate=False)


PRINTED: dict[str, dict[str, sympy.Expr]] = {
    number: {name: _parse(text) for name, text in lines.items()} for number, lines in TEXT.items()
}
"""Equation -> line -> right-hand side, unevaluated."""

# SPDX-License-Identifier: Apache-2.0
"""The lean equations for any array library: on arrays in numpy and JAX, in a scalar loop in numba.

The function is made from the table of :mod:`model.reference.lean_equations` and, like equations.c, is for targets in
reach: each sum is rounded and there are no flags. The model's `solve_lean`, with exact sums and rules for targets out
of reach, has its own row.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import sympy
from sympy.printing.pycode import PythonCodePrinter

from model.io.words import FIELDS, RESULT_FIELDS
from model.reference.lean_equations import LEAN
from model.reference.printed import symbol
from scripts.paper.derivation.proofs import parse, rsqrt

CHEAPER = {
    "root_far": "sqrt(where(a_far > zero, a_far, zero))",
    "root_near": "sqrt(where(b_near > zero, b_near, zero))",
    "inv_12": "half/sqrt(d1*d2)",
    "inv_law": "half*inv_s/d1",
    "az_c": "where(u_y <= zero, az_sq, half*u_x)",
    "az_s": "where(u_y <= zero, half*u_x, az_sq)",
    "inv_q": "where(k_1 < zero, -one, one)/sqrt(length_sq)",
}
"""Lines with other arithmetic: a library has roots, and computes a reciprocal root as 1/sqrt. `az_sq` is a part of the
half angle quaternion, and the sign of Qs belongs to `inv_q`."""


def lines() -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """Return the lines that the results need. Numbers are symbols, so that they can have the arrays' type."""
    zero, half, one, where = *map(symbol, ("zero", "half", "one")), sympy.Function("where")
    found, needed = [], {*map(symbol, RESULT_FIELDS)}
    for name, text in reversed([line for group in LEAN.values() for line in group.items()]):
        if symbol(name) not in needed:
            continue
        length_sq = symbol(name[:-1] + "sq")  # of half an angle's quaternion: half_c, half_s
        halves = {part: partial(sympy.Function(part), length_sq) for part in ("half_c", "half_s")}
        value = parse(CHEAPER.get(name, text), halves | {"where": where})
        if name not in CHEAPER:
            value = value.xreplace({sympy.S.Half: half}).replace(rsqrt, lambda v: one / sympy.sqrt(v))
        value = value.replace(sympy.Function("half_c"), lambda large, c, s: where(c >= zero, large, half * s))
        value = value.replace(sympy.Function("half_s"), lambda large, c, s: where(c >= zero, half * s, large))
        found.append((symbol(name), value))
        needed |= value.free_symbols
    return found[::-1]


def lean(real: Any, **functions: Callable) -> Callable[..., tuple]:
    """Return a solver (x, y, z, phi, d1, d2) -> (qs_w, qs_i, qs_j, qs_k, qe_w, qe_i), all of type `real`.

    functions: sqrt, sin, cos, where. Functions and numbers are globals of the solver, which numba compiles. All numbers
    are of type `real`, because an integer among floats would promote them to double.
    """
    names = functions | {"zero": real(0), "half": real(0.5), "one": real(1)}
    results = tuple(map(symbol, RESULT_FIELDS))
    printer = PythonCodePrinter({"fully_qualified_modules": False, "allow_unknown_functions": True, "order": "none"})
    return sympy.lambdify([*map(symbol, FIELDS)], results, [names], printer, cse=lambda _: (lines(), results))


def lean_of(library: Any, real: Any) -> Callable[..., tuple]:
    """Return `lean` for a library with numpy's function names."""
    return lean(real, **{name: getattr(library, name) for name in ("sqrt", "sin", "cos", "where")})

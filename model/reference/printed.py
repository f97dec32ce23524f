# SPDX-License-Identifier: Apache-2.0
"""Equations (10)-(19) as printed in the paper, as sympy expressions, including errors of the print.

``PRINTED["(11)"]["pi_swivel_x"]`` is the right-hand side of that line.  The expressions are not evaluated: their trees
match the print, so that operations can be counted (``scripts/paper/operations.py``); ``expression.doit()``
gives the ordinary, evaluated form.  :mod:`model.reference.equations` has the equations with their corrections.

Symbols are real.  Inputs: ``p_w_x, p_w_y, p_w_z, phi, d1, d2``; every other symbol is a name of a line above.
``sign_raw`` is the quantity that (17) first calls sign.
"""

from __future__ import annotations

import re

import sympy
from sympy.parsing.sympy_parser import parse_expr

_REACH = "(p_w_x**2 + p_w_z**2 + p_w_y**2 + d1**2 - d2**2)"
C4 = "(p_e_x**2 - p_e_x*p_w_x + p_e_y**2 - p_e_y*p_w_y - p_e_z*p_w_z + p_e_z**2)/(d1*d2)"

TEXT: dict[str, dict[str, str]] = {
    "(10)": {"l_sw": "sqrt(p_w_x**2 + p_w_y**2 + p_w_z**2)"},
    "(11)": {
        "pi_swivel_x": "(2*cos(phi/2)*sin(phi/2)*p_w_z*p_w_x - p_w_y*l_sw + 2*p_w_y*l_sw*cos(phi/2))/l_sw",
        "pi_swivel_y": "(2*cos(phi/2)*sin(phi/2)*p_w_z*p_w_y + p_w_x*l_sw - 2*p_w_x*l_sw*cos(phi/2))/l_sw",
        "pi_swivel_z": "-2*sin(phi/2)*cos(phi/2)*(p_w_x**2 + p_w_y**2)/l_sw",
    },
    "(12)": {
        "pp_i": f"1/2*pi_swivel_x*{_REACH}",
        "pp_j": f"1/2*pi_swivel_y*{_REACH}",
        "pp_k": f"1/2*pi_swivel_z*{_REACH}",
        "pp_14": "1/2*(1 - d1**2)*(p_w_y*pi_swivel_z - p_w_z*pi_swivel_y)",
        "pp_15": "1/2*(1 + d1**2)*(p_w_z*pi_swivel_y - p_w_y*pi_swivel_z)",
        "pp_24": "1/2*(1 - d1**2)*(p_w_z*pi_swivel_x - p_w_x*pi_swivel_z)",
        "pp_25": "1/2*(1 + d1**2)*(p_w_x*pi_swivel_z - p_w_z*pi_swivel_x)",
        "pp_34": "1/2*(d1**2 - 1)*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
        "pp_35": "1/2*(1 + d1**2)*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
    },
    "(13)": {
        "inf_pp": "(pp_35 - pp_34)**2 + (pp_14 - pp_15)**2 + (pp_25 - pp_24)**2",
        "tmp1": "-pp_i**2 - pp_j**2 - pp_k**2 - pp_14**2 + pp_15**2 - pp_24**2 + pp_25**2 - pp_34**2 + pp_35**2",
        "tmp_sqr": "sqrt(tmp1)",
        "p_e_x": "(pp_j*(pp_34 - pp_35) + pp_k*(pp_25 - pp_24) + tmp_sqr*(pp_15 - pp_14))/inf_pp",
        "p_e_y": "(pp_i*(pp_35 - pp_34) + pp_k*(pp_14 - pp_15) + tmp_sqr*(pp_25 - pp_24))/inf_pp",
        "p_e_z": "(pp_j*(pp_15 - pp_14) + pp_i*(pp_24 - pp_25) + tmp_sqr*(pp_35 - pp_34))/inf_pp",
    },
    "(14)": {"qe_w": f"sqrt((1 + {C4})/2)", "qe_i": f"-sqrt((1 - {C4})/2)"},
    "(15)": {
        "tmp2": "d1**4*p_e_y**2 - 2*d1**3*p_e_y**2*p_e_z + d1**2*p_e_y**2*p_e_z**2"
        " + d1**4*p_e_x**2 - 2*d1**3*p_e_x**2*p_e_z + d1**2*p_e_x**2*p_e_z**2"
        " + d1**2*p_e_x**4 + 2*d1**2*p_e_x**2*p_e_y**2 + d1**2*p_e_y**4",
        "l_m": "sqrt(tmp2)",
        "q12_i": "d1*p_e_x*(d1 - p_e_z)/l_m",
        "q12_j": "d1*p_e_y*(d1 - p_e_z)/l_m",
        "q12_k": "d1*(p_e_x**2 + p_e_y**2)/l_m",
    },
    "(17)": {
        "c3": "(pi_swivel_x*(q12_k**2 + q12_j**2 - q12_i**2) - 2*q12_i*(q12_j*pi_swivel_y + q12_k*pi_swivel_z))"
        "/sqrt(pi_swivel_x**2 + pi_swivel_y**2 + pi_swivel_z**2)",
        "sign_raw": "p_w_x*(q12_i**2 - q12_k**2 - q12_j**2) + 2*q12_i*(q12_k*p_w_z + q12_j*p_w_y)",
        "sign": "sign_raw/Abs(sign_raw)",
        "q3_scalar": "sqrt((1 + c3)/2)",
        "q3_k": "sqrt((1 - c3)/2)*sign",
    },
    "(18)": {
        "qs_w": "-q12_k*q3_k",
        "qs_i": "q12_i*q3_scalar + q12_j*q3_k",
        "qs_j": "-(q12_i*q3_k - q12_j*q3_scalar)",
        "qs_k": "q12_k*q3_scalar",
    },
    "(19)": {
        "pp_1_plus": "2*d1**2*(p_w_z*pi_swivel_y - p_w_y*pi_swivel_z)",
        "pp_2_plus": "2*d1**2*(p_w_x*pi_swivel_z - p_w_z*pi_swivel_x)",
        "pp_3_plus": "2*d1**2*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
        "pp_1_minus": "2*(p_w_z*pi_swivel_y - p_w_y*pi_swivel_z)",
        "pp_2_minus": "2*(p_w_x*pi_swivel_z - p_w_z*pi_swivel_x)",
        "pp_3_minus": "2*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
    },
}

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
"""Equation -> line -> right-hand side, unevaluated.  (16) is omitted: (17) repeats it except for its sign."""

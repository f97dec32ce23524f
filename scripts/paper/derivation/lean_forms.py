# SPDX-License-Identifier: Apache-2.0
"""Symbols and LaTeX of the lean and matrix forms, which the derivation of the lean dataflow compares."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field

import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

from model.reference.lean_equations import HALF, LEAN
from scripts.paper.derivation import printed

HALVES = {
    "az": ("-u_y", "u_x", "az_sq"),
    "tilt": ("sin_el", "cos_el", "tilt_sq"),
    "arm": ("cos_a", "sin_a", "arm_sq"),
}
"""Half angle quaternion -> cosine and sine of the angle, and the line with the squared length."""

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
"""The shoulder from the rotation matrix with columns -n, f, e; replaces "Product" and "Root, second level"."""


@dataclass
class Tables:
    """Copies of the compared tables; tests alter them."""

    lean: dict = field(default_factory=lambda: copy.deepcopy(LEAN))
    half: dict = field(default_factory=lambda: copy.deepcopy(HALF))
    matrix: dict = field(default_factory=lambda: copy.deepcopy(MATRIX))
    printed: dict = field(default_factory=lambda: corrected())


def corrected() -> dict[str, dict[str, str]]:
    """Return the printed equations with the rows corrected that scripts/paper/derivation/paper.py refutes."""
    table = copy.deepcopy(printed.PRINTED)
    for (equation, name), edit in printed.KNOWN_WRONG.items():
        assert table[equation][name].count(edit[0]) == 1
        table[equation][name] = table[equation][name].replace(*edit)
    return table


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
TEX |= {
    f"shift_{name}": f"k_{tail}"
    for name, tail in (("rho_sq", r"\rho"), ("s", "s"), ("a_far", "A"), ("b_near", "B"), ("d1", "1"), ("d2", "2"))
}

SYMBOL = {name: sp.Symbol(name, real=True) for name in TEX}
NAMES = {symbol: TEX[name] for name, symbol in SYMBOL.items()}
ROOT_OF = {"rho_sq": "rho", "s": "dist", "a_far": "sqrt_a", "b_near": "sqrt_b", "d1": "sqrt_1", "d2": "sqrt_2"}
"""Argument of a root -> symbol for its square root."""


def symbols(names: str) -> list[sp.Symbol]:
    return [SYMBOL[name] for name in names.split()]


class rsqrt(sp.Function):  # noqa: N801 - the name in the tables
    """Reciprocal square root as one operation."""

    def _latex(self, printer, exp=None):
        return rf"\frac{{1}}{{\sqrt{{{printer._print(self.args[0])}}}}}"


def latex(expression) -> str:
    return sp.latex(expression, symbol_names=NAMES)


class half_c(sp.Function):  # noqa: N801 - the name in the table
    """Cosine part of h(c, s)."""

    def _latex(self, printer, exp=None):
        return rf"h_{type(self).__name__[-1]}({', '.join(map(printer._print, self.args))})"


class half_s(half_c):  # noqa: N801
    """Sine part of h(c, s)."""


FUNCTIONS = {"rsqrt": rsqrt, "Abs": sp.Abs, "half_c": half_c, "half_s": half_s, "cos": sp.cos, "sin": sp.sin}


def tree(text: str) -> sp.Expr:
    """Parse a line without evaluating it."""
    return parse_expr(text, local_dict=SYMBOL | FUNCTIONS, evaluate=False)


def line_tex(text: str) -> str:
    return sp.latex(tree(text), symbol_names=NAMES, order="none")


def lines(table: dict) -> dict[str, str]:
    """Return the lines of all groups in one dictionary."""
    return {name: text for group in table.values() for name, text in group.items()}

# SPDX-License-Identifier: Apache-2.0
"""The paper's equations for both derivations: names, symbols, LaTeX, known misprints."""

from __future__ import annotations

import ast

import sympy as sp

from model.reference.printed import C4, TEXT

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
"""Name in :mod:`model.reference.printed` -> name on the page, which follows the print."""


def _renamed(text: str) -> str:
    for name, page in _RENAMED:
        text = text.replace(name, page)
    return text


def _printed() -> dict[str, dict[str, str]]:
    """Return :data:`model.reference.printed.TEXT` with renamed symbols: equation -> row -> right side, terms in printed
    order, misprints included."""
    rows = {
        number.strip("()"): {_renamed(name): _renamed(text) for name, text in lines.items()}
        for number, lines in TEXT.items()
    }
    del rows["13"]["tmp_sqr"]  # a name for the root of tmp1
    # The fraction printed inside both roots of (14) is c_4 of the preceding text.
    fraction = _renamed(C4)
    rows["14"] = {"c_4": fraction} | {name: text.replace(fraction, "c_4") for name, text in rows["14"].items()}
    return rows


PRINTED = _printed()

KNOWN_WRONG = {
    ("11", "pi_x"): ("L_sw*cos(phi/2))", "L_sw*cos(phi/2)**2)"),
    ("11", "pi_y"): ("L_sw*cos(phi/2))", "L_sw*cos(phi/2)**2)"),
}
"""Misprinted row -> correction (found, replacement), which is also proved."""

FACTOR = {"19": 2}
"""Equations whose rows all carry a common factor in print; 1 elsewhere."""


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
    """Convert a printed expression to sympy. `values` replace names; the others stay symbols."""
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


def latex(expression) -> str:
    return sp.latex(expression, symbol_names=_NAMES)


def tex(text: str) -> str:
    """Convert a printed expression to LaTeX, keeping the order of terms."""
    return _tex(ast.parse(text, mode="eval").body)


def _tex(node, level=0) -> str:
    """Convert a syntax tree to LaTeX. level: 0 any expression, 1 factor of a product, 2 base of a power."""
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

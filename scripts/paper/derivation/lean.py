# SPDX-License-Identifier: Apache-2.0
"""Derivation of the lean dataflow from the paper's equations (10)-(18).

The dataflow in model/dataflow/lean.py is evaluated on symbols (:func:`evaluate`). The paper's equations are used as
printed, with misprints corrected. Steps and their statements appear in docs/generated/lean.md.
"""

import itertools
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import sympy as sp

from model.dataflow import fixed
from model.dataflow.expressions import Compared, Operation, Term
from model.dataflow.nodes import Node
from model.reference import cga
from model.reference.cga import symbol
from scripts.paper.derivation.paper import normal, of_axes
from scripts.paper.derivation.proofs import COS_H, HALF_CIRCLE, PRINTED, SIN_H, Step, corrected, parse, symbols

NORMAL = "vec(cos_phi*u_y + sin_phi*sin_el*u_x, sin_phi*sin_el*u_y - cos_phi*u_x, -sin_phi*cos_el)"
ACROSS = "vec(sin_phi*u_y - cos_phi*sin_el*u_x, -cos_phi*sin_el*u_y - sin_phi*u_x, cos_phi*cos_el)"
"""Unit vectors: n is normal to the swivel plane, m is perpendicular to n and to the target."""

CIRCLES = ("u_y**2 = 1 - u_x**2", "cos_el**2 = 1 - sin_el**2", "sin_a**2 = 1 - cos_a**2", "sin_phi**2 = 1 - cos_phi**2")
SQUARES = (
    "rho**2 = x**2 + y**2",
    "dist**2 = x**2 + y**2 + z**2",
    "sqrt_a**2 = a_far",
    "sqrt_b**2 = b_near",
    "sqrt_1**2 = d1",
    "sqrt_2**2 = d2",
)
ROOTS = {"rho": "rho", "s": "dist", "far": "sqrt_a", "near": "sqrt_b", "1": "sqrt_1", "2": "sqrt_2"}
"""Suffix in the names of a root's nodes -> symbol for the root's value."""

HALF = {r"c \ge 0": ("(1 + c)/2", "s/2"), "c < 0": ("s/2", "(1 - c)/2")}
"""Branch -> parts of the quaternion h(c, s), as in :func:`model.dataflow.lean_operations.half_part`."""

NODES = fixed.nodes("lean", 32)

REACHABLE = dict.fromkeys(("clamp", "closed", "away", "at_shoulder", "minus", "low"), False)
"""Mask -> value for a target in reach with k_1 >= 0. The sign of Qs does not matter."""


def symbolic(node: Node) -> bool:
    """Return True if a node is computed without roots, sines, comparisons or normalizations for roots."""
    return node.kind in ("choose", "mul3") and not _compares(node.op)


def _compares(term: Term) -> bool:
    parts = term.parts if isinstance(term, Operation) else ()
    return isinstance(term, Compared) or any(map(_compares, parts))


def evaluate(section: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` plus the values of those nodes in a section that can be computed from `values`.

    Operations are evaluated in real numbers, as in :class:`model.bounds.predict.Real`. Shift counts of roots are 0,
    because any count cancels.
    """
    values = {"e_rho": 0} | REACHABLE | dict(values)
    for name, node in NODES.items():
        known = values.keys() >= {operand.name for operand in node.operands}
        if node.section != section or name in values or not known or not symbolic(node):
            continue
        if node.format == node.flow.count:
            values[name] = node.op.words(values)
        elif node.frac:
            ulps = {operand.name: values[operand.name] * 2**operand.frac for operand in node.operands}
            value = node.op.words(ulps)
            value = value.item() if isinstance(value, np.ndarray) else value
            exact = sp.sympify(value).replace(lambda part: part.is_Float, sp.Rational)  # 2.0^n of a shift
            values[name] = exact / 2**node.op.frac
    return values


def sums() -> dict[str, sp.Expr]:
    """Return the symbols of the inputs, and the sums of section `guard`."""
    return evaluate("guard", {name: symbol(name) for name in ("x", "y", "z", "d1", "d2")})


def to_triangle(step: Step) -> None:
    """Set the values of all nodes up to section `triangle`, as expressions in x, y, z, d1, d2 and six roots."""
    step.values |= sums()
    step.suppose(*SQUARES)
    for name, root in ROOTS.items():
        even = NODES[f"m_{name}"].op
        unit = 2 ** (even.width - even.value.frac)
        mantissa = step.values[even.value.name] / unit
        inverse = sp.sqrt(unit) / (2 * symbol(root))  # 1/(2 sqrt m)
        step.values |= {f"e_{name}": 0, f"m_{name}": mantissa, f"inv_{name}": inverse}
    step.values = evaluate("triangle", evaluate("direction", step.values))


def frame(step: Step) -> None:
    """Set unit vectors n, m, e and `direction` (p/|p|). Also set the target p of (10)-(17), in polar form."""
    step.suppose(*CIRCLES)
    step.values |= {"n": parse(NORMAL), "m": parse(ACROSS), "direction": parse("vec(cos_el*u_x, cos_el*u_y, sin_el)")}
    step.values["e"] = step.value("cos_a*direction + sin_a*m")
    step.values["p"] = symbol("dist") * step.values["direction"]
    step.values |= of_axes("p_w", step.values["p"])


def rotation_matrix(quaternion: Iterable) -> sp.Matrix:
    """Return the matrix of v -> Q v Q~, computed in the algebra, for a quaternion Q of any length."""
    images = (normal(cga.rotate(cga.quaternion(*quaternion), e)) for e in (cga.e1, cga.e2, cga.e3))
    return sp.Matrix.hstack(*images)


def turn(axis: str, c: sp.Expr, s: sp.Expr) -> sp.Matrix:
    """Return the matrix of a right-handed rotation about axis x or z by the angle with cosine c and sine s."""
    if axis == "z":
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return sp.Matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def directions(step: Step) -> None:
    to_triangle(step)
    at = {f"p_w_{axis}": symbol(axis) for axis in "xyz"}
    step.prove("l_sw**2 = s", l_sw=parse(corrected("(10)", "l_sw"), at))
    step.prove(*(f"{a}**2 + {b}**2 = 1" for a, b in (("u_x", "u_y"), ("sin_el", "cos_el"), ("cos_a", "sin_a"))))
    step.prove("x = dist*cos_el*u_x", "y = dist*cos_el*u_y", "z = dist*sin_el", "rho = dist*cos_el")
    step.prove("k_law = 2*d1*dist*cos_a")


def swivel(step: Step) -> None:
    frame(step)
    step.suppose(HALF_CIRCLE)
    plane = [step.value(corrected("(11)", name), l_sw=symbol("dist")) for name in PRINTED["(11)"]]
    step.values |= {"pi": sp.Matrix(plane), "rho": symbol("dist") * symbol("cos_el")}
    whole = {symbol("cos_phi"): COS_H**2 - SIN_H**2, symbol("sin_phi"): 2 * COS_H * SIN_H}
    half = {"n": step.values["n"].subs(whole), "cos_phi": whole[symbol("cos_phi")], "sin_phi": whole[symbol("sin_phi")]}
    step.prove(f"pi/rho = n = {NORMAL}", **half)
    step.prove("cos_phi**2 + sin_phi**2 = 1", **half)
    step.prove("sq(n) = 1", "dot(n, p) = 0")


def elbow(step: Step) -> None:
    frame(step)
    step.prove("k_law = s + d1**2 - d2**2", "4*d1**2*s - k_law**2 = a_far*b_near", **sums())
    step.values["rho"] = symbol("dist") * symbol("cos_el")
    step.values |= of_axes("pi_swivel", step.values["rho"] * step.values["n"])
    for name in PRINTED["(12)"]:
        step.values[name] = step.value(corrected("(12)", name))
    rows = {name: step.value(corrected("(13)", name)) for name in ("inf_pp", "tmp1")}
    step.values |= rows | {"pair": sp.Matrix([step.values[f"pp_{unit}"] for unit in "ijk"])}
    step.suppose("k_law = 2*d1*dist*cos_a", "d2**2 = dist**2 + d1**2 - k_law")  # by step 1
    step.prove("pair = rho*k_law*n/2", label=r"(PP_i, PP_j, PP_k) = \tfrac12 \rho K\,n")
    step.prove("inf_pp = rho**2*dist**2", "tmp1 = rho**2*(4*d1**2*dist**2 - k_law**2)/4")
    root = step.value("rho*d1*dist*sin_a")
    step.roots = {root: root**2}
    step.prove("sqrt(tmp1) = rho*d1*dist*sin_a")
    given = {"tmp_sqr": root, "inf_pp": sp.Integer(1)}
    p_e = sp.Matrix([step.value(corrected("(13)", f"p_e_{axis}"), **given) for axis in "xyz"])
    step.prove("p_e = rho**2*dist**2*d1*e", label="p_e = d_1 e", p_e=p_e)
    step.prove("cross(n, direction) = m", label=r"n \times p/|p| = m")
    step.prove(f"m = {ACROSS}", "sq(e) = 1", "dot(n, e) = 0")
    step.prove("direction = cos_a*e - sin_a*cross(n, e)", label=r"p/|p| = \cos a\,e - \sin a\,n \times e")


def elbow_quaternion(step: Step) -> None:
    frame(step)
    given = of_axes("p_e", symbol("d1") * step.values["e"])
    step.prove("c4 = (d1 - dist*cos_a)/d2", c4=step.value(corrected("(14)", "c4"), **given))
    to_triangle(step)
    step.values |= {"c4": step.value("(d1 - k_law/(2*d1))/d2")}  # |p| cos a = K/(2 d1) by step 1
    step.prove("(1 + c4)/2 = a_far/(4*d1*d2)", "(1 - c4)/2 = b_near/(4*d1*d2)")
    step.roots = {root: root**2 for root in (step.value(f"sqrt_{x}/(2*sqrt_1*sqrt_2)") for x in "ab")}
    for name, text in (("qe_w", "elbow_w"), ("qe_i", "-elbow_i")):
        step.prove(f"{name} = {text}", **{name: step.value(corrected("(14)", name))})
    step.prove("qe_w**2 + qe_i**2 = 1")


def shoulder(step: Step) -> None:
    r_w, r_i, r_j, r_k = r = symbols("r_w r_i r_j r_k")
    gamma, sigma, d1 = symbols("gamma sigma d1")
    step.suppose("r_w**2 = 1 - r_i**2 - r_j**2 - r_k**2", "gamma**2 = r_w**2 + r_k**2", "sigma**2 = 1")
    turned = rotation_matrix(r)
    step.values = {"n": -turned[:, 0], "f": turned[:, 1], "e": (e := turned[:, 2])}
    length = 2 * d1**3 * (1 - e[2]) * gamma
    step.roots = {length: length**2}
    step.values |= of_axes("p_e", d1 * e) | of_axes("e", e)
    step.values["tmp2"] = step.value(corrected("(15)", "tmp2"))
    step.prove("l_m = 2*d1**3*(1 - e_z)*gamma", l_m=step.value(corrected("(15)", "l_m")))
    q12 = {name: step.value(corrected("(15)", name), l_m=length) for name in ("q12_i", "q12_j", "q12_k")}
    step.prove("q12_i = e_x/(2*gamma)", "q12_j = e_y/(2*gamma)", "q12_k = gamma", **q12)
    q12 = {"q12_i": e[0] / (2 * gamma), "q12_j": e[1] / (2 * gamma), "q12_k": gamma}
    image = rotation_matrix([sp.Integer(0), *q12.values()])[:, 2]
    step.prove("image = e", label=r"Q_{12} e_3 \tilde Q_{12} = e", image=image)
    # (17) with a plane vector of length rho and with the target in the form proved in step 3
    along = step.value("dist*(cos_a*e - sin_a*cross(n, e))")
    step.values |= q12 | of_axes("pi_swivel", symbol("rho") * step.values["n"]) | of_axes("p_w", along)
    step.roots = {symbol("rho"): symbol("rho") ** 2}
    for name, text in (("c3", "(r_k**2 - r_w**2)/gamma**2"), ("sign_raw", "-2*dist*sin_a*r_w*r_k/gamma**2")):
        step.prove(f"{name} = {text}", **{name: step.value(corrected("(17)", name))})
        step.values[name] = parse(text)
    # sigma r_k = |r_k|; `sign` is the sign of side, which equals the sign of -r_w r_k
    step.suppose("abs_w**2 = r_w**2")
    step.roots = {root: root**2 for root in map(parse, ("sigma*r_k/gamma", "abs_w/gamma"))}
    step.prove("q3_scalar = sigma*r_k/gamma", q3_scalar=step.value(corrected("(17)", "q3_scalar")))
    step.prove("q3_k = abs_w*sign/gamma", q3_k=step.value(corrected("(17)", "q3_k")))
    size = parse("2*dist*sin_a*abs_w*sigma*r_k/gamma**2")
    step.roots = {size: size**2}
    sign = step.value(corrected("(17)", "sign"), Abs=lambda v: step.root(v**2))
    step.prove("sign = -sigma*r_w/abs_w", sign=sign)
    step.prove("q3_k = -sigma*r_w/gamma", q3_k=parse("-sigma*r_w/abs_w*abs_w/gamma"))
    step.values |= {"q3_scalar": sigma * r_k / gamma, "q3_k": -sigma * r_w / gamma}
    for part in "wijk":
        step.prove(f"qs_{part} = sigma*r_{part}", **{f"qs_{part}": step.value(corrected("(18)", f"qs_{part}"))})
    step.prove("f = cross(e, -n)", label=r"r e_2 \tilde r = e \times (-n)")


def factors(step: Step) -> None:
    frame(step)
    u_x, u_y, sin_el, cos_el = symbols("u_x u_y sin_el cos_el")
    cos_phi, sin_phi, cos_a, sin_a = symbols("cos_phi sin_phi cos_a sin_a")
    target = turn("z", -u_y, u_x) * turn("x", sin_el, cos_el)
    swivelled = target * turn("z", cos_phi, sin_phi)
    whole = swivelled * turn("x", cos_a, -sin_a)
    step.prove("column = direction", label=r"R_z(\alpha + 90^\circ) R_x(\theta)\,e_3 = p/|p|", column=target[:, 2])
    label = r"R_z(\alpha + 90^\circ) R_x(\theta) R_z(\phi) = (-n, m, p/|p|)"
    columns = sp.Matrix.hstack(-step.values["n"], step.values["m"], step.values["direction"])
    step.prove("product = columns", label=label, product=swivelled, columns=columns)
    columns = sp.Matrix.hstack(-step.values["n"], step.value("cross(e, -n)"), step.values["e"])
    step.prove("product = columns", label=r"R = (-n, e \times (-n), e)", product=whole, columns=columns)


def half(step: Step) -> None:
    c, s = symbols("c s")
    step.suppose("s**2 = 1 - c**2")
    for branch, (text_c, text_s) in HALF.items():
        large, size = ("h_c", (1 + c) / 2) if "ge" in branch else ("h_s", (1 - c) / 2)
        step.values = {"h_c": parse(text_c), "h_s": parse(text_s), "length_sq": size}
        for text, label in (
            ("h_c**2 + h_s**2 = length_sq", "|h|^2 = (1 + |c|)/2"),
            ("h_c**2 - h_s**2 = length_sq*c", r"h_c^2 - h_s^2 = |h|^2\,c"),
            ("2*h_c*h_s = length_sq*s", r"2 h_c h_s = |h|^2\,s"),
            (f"{large} = length_sq", f"{large} = |h|^2"),
        ):
            step.prove(text, label=rf"{label}\text{{ for }}{branch}")
    at_0 = {"c": sp.Integer(0), "s": symbol("sigma")}
    first, second = (sp.Matrix([parse(text, at_0) for text in pair]) for pair in HALF.values())
    step.suppose("sigma**2 = 1")
    label = r"\lim_{c \to -0} h = \sigma\,h(0, \sigma) \text{ with } s = \sigma = \pm 1"
    step.prove("second = sigma*first", label=label, first=first, second=second)


def product_lines(swap: bool = False) -> list[sp.Expr]:
    """Return lean's undivided quaternion w_1, i_1, j_1, k_1 as expressions in the parts of the half-angle quaternions.
    ``swap``: bend_s, not bend_c, is the larger part of quaternion bend."""
    names = "az_c az_s tilt_c tilt_s bend_c bend_s"
    values = dict(zip(names.split(), symbols(names), strict=True)) | {"cos_h": COS_H, "sin_h": SIN_H}
    larger, smaller = ("bend_s", "bend_c") if swap else ("bend_c", "bend_s")
    values |= {"bend_sq": values[larger], "sin_a": 2 * values[smaller], "bend_swap": swap}
    values = evaluate("turn", evaluate("triangle", values))
    return [values[f"{name}_1"] for name in "wijk"]


def product(step: Step) -> None:
    az_c, az_s, tilt_c, tilt_s, bend_c, bend_s = symbols("az_c az_s tilt_c tilt_s bend_c bend_s")
    factors_ = (az_c, 0, 0, az_s), (tilt_c, tilt_s, 0, 0), (COS_H, 0, 0, SIN_H), (bend_c, -bend_s, 0, 0)
    whole = cga.scalar(1)
    for factor in factors_:
        whole *= cga.quaternion(*factor)
    algebra = sp.Matrix(cga.quaternion_coefficients(whole))
    for swap, branch in ((False, r"\ge"), (True, "<")):
        label = r"(w_1, i_1, j_1, k_1) = \mathrm{az}\,\mathrm{tilt}\,h_\phi\,\widetilde{\mathrm{bend}}"
        label += rf"\text{{ for }}\cos a {branch} 0"
        step.prove("lean = algebra", label=label, lean=sp.Matrix(product_lines(swap)), algebra=algebra)
    step.suppose("s**2 = 1 - c**2", HALF_CIRCLE)
    c, s = symbols("c s")
    for (axis, unit), branch in itertools.product((("z", "k"), ("x", "i")), HALF):
        h_c, h_s = map(parse, HALF[branch])
        size = (1 + c) / 2 if "ge" in branch else (1 - c) / 2
        matrix = rotation_matrix((h_c, 0, 0, h_s) if axis == "z" else (h_c, h_s, 0, 0))
        label = rf"M(h_c + h_s {unit}) = |h|^2 R_{axis}(c, s) \text{{ for }}{branch}"
        step.prove("matrix = expected", label=label, matrix=matrix, expected=size * turn(axis, c, s))
    back, forth = (rotation_matrix((bend_c, sign * bend_s, 0, 0)) for sign in (-1, 1))
    step.prove("back = forth", label=r"M(\widetilde{\mathrm{bend}}) = M(\mathrm{bend})^T", back=back, forth=forth.T)
    phi, whole = rotation_matrix((COS_H, 0, 0, SIN_H)), turn("z", COS_H**2 - SIN_H**2, 2 * COS_H * SIN_H)
    step.prove("matrix = expected", label=r"M(h_\phi) = R_z(\phi)", matrix=phi, expected=whole)
    a, b = symbols("r_w r_i r_j r_k"), symbols("q_0 q_1 q_2 q_3")
    both = rotation_matrix(cga.quaternion_coefficients(cga.quaternion(*a) * cga.quaternion(*b)))
    expected = rotation_matrix(a) * rotation_matrix(b)
    step.prove("both = expected", label=r"M(r q) = M(r) M(q) \text{ for any } r, q", both=both, expected=expected)


def length(step: Step) -> None:
    step.suppose(*(f"{name}_s**2 = {name}_sq - {name}_c**2" for name in ("az", "tilt", "bend")), HALF_CIRCLE)
    quaternion = product_lines()
    step.values |= dict(zip(("w_1", "i_1", "j_1", "k_1"), quaternion, strict=True))
    squares = {f"{name}_sq": symbol(f"{name}_sq") for name in ("az", "tilt", "bend")}
    step.values["length_sq"] = evaluate("turn", squares)["length_sq"]
    step.prove("w_1**2 + i_1**2 + j_1**2 + k_1**2 = length_sq")
    cosines = {name: symbol(name) for name in ("u_y", "sin_el", "cos_a")}
    squares = evaluate("triangle", evaluate("direction", cosines))
    values = evaluate("turn", squares)
    whole = values["length_sq"]
    step.prove("m_q = length_sq", m_q=values["m_q"], length_sq=whole)
    step.prove("length_sq = (1 + Abs(u_y))*(1 + Abs(sin_el))*(1 + Abs(cos_a))/8", length_sq=whole)
    unscaled = {f"{part}_1": symbol(f"{part}_1") for part in "wijk"} | {"inv_q": 1 / (2 * symbol("length"))}
    values = evaluate("turn", unscaled)
    q_s = sp.Matrix([values[f"qs_{part}"] for part in "wijk"])
    step.prove("q_s = q/length", label="Q_s = q/|q|", q_s=q_s, q=sp.Matrix(symbols("w_1 i_1 j_1 k_1")))


STEPS = (directions, swivel, elbow, elbow_quaternion, shoulder, factors, half, product, length)

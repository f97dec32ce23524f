# SPDX-License-Identifier: Apache-2.0
"""Derivation of the lean dataflow from the paper's equations (10)-(18).

The lean side is the table of model/reference/lean_equations.py, the paper's side is the corrected print. Steps and
their statements appear in docs/generated/lean.md.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping

import sympy as sp

from model.reference import cga
from model.reference.lean_equations import HALF, LEAN
from model.reference.printed import symbol
from scripts.generate.render import table
from scripts.paper.derivation.paper import normal
from scripts.paper.derivation.proofs import (
    COS_H,
    HALF_CIRCLE,
    PRINTED,
    SIN_H,
    Step,
    corrected,
    latex,
    name_tex,
    parse,
    symbols,
)
from scripts.paper.operations import Ops, shared, total

HALVES = {"az": ("-u_y", "u_x"), "tilt": ("sin_el", "cos_el"), "arm": ("cos_a", "sin_a")}
"""Half angle quaternion -> cosine and sine of its angle."""
PARTS = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")

MATRIX = {
    "Directions of the target": {
        "p_x": "cos_el*u_x",
        "p_y": "cos_el*u_y",
        "p_z": "sin_el",
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
        "e_z": "cos_a*p_z + sin_a*m_z",
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

CIRCLES = (
    "u_y**2 = 1 - u_x**2",
    "cos_el**2 = 1 - sin_el**2",
    "sin_a**2 = 1 - cos_a**2",
    "sin_phi**2 = 1 - cos_phi**2",
)
SQUARES = (
    "rho**2 = x**2 + y**2",
    "dist**2 = x**2 + y**2 + z**2",
    "sqrt_a**2 = a_far",
    "sqrt_b**2 = b_near",
    "sqrt_1**2 = d1",
    "sqrt_2**2 = d2",
)
ROOTS = {"rho_sq": "rho", "s": "dist", "a_far": "sqrt_a", "b_near": "sqrt_b", "d1": "sqrt_1", "d2": "sqrt_2"}
"""Argument of a root -> name of the root."""


def lines(table_: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """Return the lines of all groups in one dictionary."""
    return {name: text for group in table_.values() for name, text in group.items()}


def run(lines_: Mapping[str, str], values: Mapping[str, sp.Expr]) -> dict[str, sp.Expr]:
    """Return `values` and the lines evaluated in order; given names keep their value, others are symbols."""
    values = dict(values)
    for name, text in lines_.items():
        if name not in values:
            values[name] = parse(text, values)
    return values


def to_triangle(step: Step) -> None:
    """Set the lines down to the triangle in x, y, z, d1, d2 and six roots."""
    step.values |= run(LEAN["Sums of the inputs"], {})
    step.suppose(*SQUARES)
    rsqrt = {"rsqrt": lambda argument: 1 / symbol(ROOTS[str(argument)])}
    step.values |= {name: parse(text, rsqrt) for name, text in LEAN["Roots, first level"].items()}
    step.values = run(LEAN["Directions"] | LEAN["Triangle"], step.values)


def frame(step: Step) -> None:
    """Set n, m, e, f of the matrix form, p/|p| as `direction`, and the target (10)-(17) in polar form."""
    step.suppose(*CIRCLES)
    values = run(MATRIX["Directions of the target"] | MATRIX["Columns"], {})
    step.values |= {v: sp.Matrix([values[f"{v}_{axis}"] for axis in "xyz"]) for v in "pnmef"}
    step.values["direction"] = step.values.pop("p")
    for axis, part in zip("xyz", step.values["direction"], strict=True):
        step.values[f"p_w_{axis}"] = symbol("dist") * part
    step.values["p"] = symbol("dist") * step.values["direction"]


def rotation_matrix(quaternion: Iterable) -> sp.Matrix:
    """Return the matrix of v -> Q v Q~, computed in the algebra, for a quaternion of any length."""
    images = (normal(cga.rotate(cga.quaternion(*quaternion), e)) for e in (cga.e1, cga.e2, cga.e3))
    return sp.Matrix.hstack(*images)


def turn(axis: str, c: sp.Expr, s: sp.Expr) -> sp.Matrix:
    """Return the right-handed rotation about axis x or z by the angle with cosine c and sine s."""
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
    written = "vec(cos_phi*u_y + sin_phi*sin_el*u_x, sin_phi*sin_el*u_y - cos_phi*u_x, -sin_phi*cos_el)"
    step.prove(f"pi/rho = n = {written}", **half)
    step.prove("cos_phi**2 + sin_phi**2 = 1", **half)
    step.prove("sq(n) = 1", "dot(n, p) = 0")


def elbow(step: Step) -> None:
    frame(step)
    sums = run(LEAN["Sums of the inputs"], {})
    step.prove("k_law = s + d1**2 - d2**2", "4*d1**2*s - k_law**2 = a_far*b_near", **sums)
    for axis, part in zip("xyz", step.values["n"], strict=True):
        step.values[f"pi_swivel_{axis}"] = symbol("dist") * symbol("cos_el") * part
    step.values |= {"rho": symbol("dist") * symbol("cos_el")}
    for name in PRINTED["(12)"]:
        step.values[name] = step.value(corrected("(12)", name))
    rows = {name: step.value(corrected("(13)", name)) for name in ("inf_pp", "tmp1")}
    step.values |= rows | {"pair": sp.Matrix([step.values[f"pp_{unit}"] for unit in "ijk"])}
    step.suppose("d2**2 = dist**2 + d1**2 - k_law")
    step.prove("pair = rho*k_law*n/2", label=r"(PP_i, PP_j, PP_k) = \tfrac12 \rho K\,n")
    step.prove("inf_pp = rho**2*dist**2", "tmp1 = rho**2*(4*d1**2*dist**2 - k_law**2)/4")
    step.values["k_law"] = 2 * symbol("d1") * symbol("dist") * symbol("cos_a")
    step.suppose("d2**2 = dist**2 + d1**2 - 2*d1*dist*cos_a")
    del step.relations["d2**2 = dist**2 + d1**2 - k_law"]
    root = step.value("rho*d1*dist*sin_a")
    step.roots = {root: root**2}
    step.prove("sqrt(tmp1) = rho*d1*dist*sin_a")
    given = {"tmp_sqr": root, "inf_pp": sp.Integer(1)}
    p_e = sp.Matrix([step.value(corrected("(13)", f"p_e_{axis}"), **given) for axis in "xyz"])
    step.prove("p_e = rho**2*dist**2*d1*e", label="p_e = d_1 e", p_e=p_e)
    step.prove("cross(n, direction) = m", label=r"n \times p/|p| = m")
    written = "vec(sin_phi*u_y - cos_phi*sin_el*u_x, -cos_phi*sin_el*u_y - sin_phi*u_x, cos_phi*cos_el)"
    step.prove(f"m = {written}", "sq(e) = 1", "dot(n, e) = 0")
    step.prove("direction = cos_a*e - sin_a*cross(n, e)", label=r"p/|p| = \cos a\,e - \sin a\,n \times e")


def elbow_quaternion(step: Step) -> None:
    frame(step)
    given = {f"p_e_{axis}": symbol("d1") * part for axis, part in zip("xyz", step.values["e"], strict=True)}
    step.prove("c4 = (d1 - dist*cos_a)/d2", c4=step.value(corrected("(14)", "c4"), **given))
    to_triangle(step)
    step.values |= {"c4": step.value("(d1 - k_law/(2*d1))/d2")}  # |p| cos a = K/(2 d1) by step 1
    step.prove("(1 + c4)/2 = a_far/(4*d1*d2)", "(1 - c4)/2 = b_near/(4*d1*d2)")
    step.roots = {root: root**2 for root in (step.value(f"sqrt_{x}/(2*sqrt_1*sqrt_2)") for x in "ab")}
    for name in ("qe_w", "qe_i"):
        text = LEAN["Triangle"][name]
        step.prove(f"{name} = {text}", **{name: step.value(corrected("(14)", name))})
    step.prove("qe_w**2 + qe_i**2 = 1")


def shoulder(step: Step) -> None:
    r_w, r_i, r_j, r_k = r = symbols("r_w r_i r_j r_k")
    gamma, sigma, d1 = symbols("gamma sigma d1")
    step.suppose("r_w**2 = 1 - r_i**2 - r_j**2 - r_k**2", "gamma**2 = r_w**2 + r_k**2", "sigma**2 = 1")
    turned = rotation_matrix(r)
    step.values = {"n": -turned[:, 0], "f": turned[:, 1], "e": (e := turned[:, 2])}
    p_e = {f"p_e_{axis}": d1 * part for axis, part in zip("xyz", e, strict=True)}
    length = 2 * d1**3 * (1 - e[2]) * gamma
    step.roots = {length: length**2}
    step.values |= p_e | dict(zip(("e_x", "e_y", "e_z"), e, strict=True))
    step.values["tmp2"] = step.value(corrected("(15)", "tmp2"))
    step.prove("l_m = 2*d1**3*(1 - e_z)*gamma", l_m=step.value(corrected("(15)", "l_m")))
    q12 = {name: step.value(corrected("(15)", name), l_m=length) for name in ("q12_i", "q12_j", "q12_k")}
    step.prove("q12_i = e_x/(2*gamma)", "q12_j = e_y/(2*gamma)", "q12_k = gamma", **q12)
    q12 = {"q12_i": e[0] / (2 * gamma), "q12_j": e[1] / (2 * gamma), "q12_k": gamma}
    image = rotation_matrix([sp.Integer(0), *q12.values()])[:, 2]
    step.prove("image = e", label=r"Q_{12} e_3 \tilde Q_{12} = e", image=image)
    # (17) with the plane of length rho and the target as step 3 has it
    along = step.value("cos_a*e - sin_a*cross(n, e)")
    step.values |= q12
    for axis, n, p in zip("xyz", step.values["n"], along, strict=True):
        step.values |= {f"pi_swivel_{axis}": symbol("rho") * n, f"p_w_{axis}": symbol("dist") * p}
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
    step.prove("f = cross(e, -n)")


def half(step: Step) -> None:
    c, s = symbols("c s")
    step.suppose("s**2 = 1 - c**2")
    for branch, (text_c, text_s) in HALF.items():
        size = (1 + c) / 2 if ">" in branch else (1 - c) / 2
        step.values = {"h_c": parse(text_c), "h_s": parse(text_s), "length_sq": size}
        large = "h_c" if ">" in branch else "h_s"
        when = r"\text{ for }" + branch.replace(">=", r"\ge")
        for text, label in (
            ("h_c**2 + h_s**2 = length_sq", "|h|^2 = (1 + |c|)/2"),
            ("h_c**2 - h_s**2 = length_sq*c", r"h_c^2 - h_s^2 = |h|^2\,c"),
            ("2*h_c*h_s = length_sq*s", r"2 h_c h_s = |h|^2\,s"),
            (f"{large} = length_sq", f"{large} = |h|^2"),
        ):
            step.prove(text, label=label + when)
    at_0 = [sp.Matrix([parse(text, {"c": sp.Integer(0)}) for text in pair]) for pair in HALF.values()]
    step.suppose("s**2 = 1")
    del step.relations["s**2 = 1 - c**2"]
    label = r"\lim_{c \to -0} h = s\,h(0, s) \text{ with } s = \pm 1"
    step.prove("second = s*first", label=label, first=at_0[0], second=at_0[1])


def product_lines() -> list[sp.Expr]:
    """Return the lean quaternion before its division, in the half angle quaternions."""
    values = run(LEAN["Product"], {"cos_h": COS_H, "sin_h": SIN_H})
    return [values[f"{name}_1"] for name in "wijk"]


def product(step: Step) -> None:
    az_c, az_s, tilt_c, tilt_s, arm_c, arm_s = PARTS
    factors_ = (az_c, 0, 0, az_s), (tilt_c, tilt_s, 0, 0), (COS_H, 0, 0, SIN_H), (arm_c, -arm_s, 0, 0)
    whole = cga.scalar(1)
    for factor in factors_:
        whole *= cga.quaternion(*factor)
    quaternion, algebra = sp.Matrix(product_lines()), sp.Matrix(cga.quaternion_coefficients(whole))
    label = r"(w_1, i_1, j_1, k_1) = \mathrm{az}\,\mathrm{tilt}\,h_\phi\,\widetilde{\mathrm{arm}}"
    step.prove("lean = algebra", label=label, lean=quaternion, algebra=algebra)
    step.suppose("s**2 = 1 - c**2", HALF_CIRCLE)
    c, s = symbols("c s")
    for (axis, unit), branch in itertools.product((("z", "k"), ("x", "i")), HALF):
        h_c, h_s = map(parse, HALF[branch])
        size = (1 + c) / 2 if ">" in branch else (1 - c) / 2
        matrix = rotation_matrix((h_c, 0, 0, h_s) if axis == "z" else (h_c, h_s, 0, 0))
        label = rf"M(h_c + h_s {unit}) = |h|^2 R_{axis}(c, s) \text{{ for }}" + branch.replace(">=", r"\ge")
        step.prove("matrix = expected", label=label, matrix=matrix, expected=size * turn(axis, c, s))
    back, forth = (rotation_matrix((arm_c, sign * arm_s, 0, 0)) for sign in (-1, 1))
    step.prove("back = forth", label=r"M(\widetilde{\mathrm{arm}}) = M(\mathrm{arm})^T", back=back, forth=forth.T)
    phi, whole = rotation_matrix((COS_H, 0, 0, SIN_H)), turn("z", COS_H**2 - SIN_H**2, 2 * COS_H * SIN_H)
    step.prove("matrix = expected", label=r"M(h_\phi) = R_z(\phi)", matrix=phi, expected=whole)
    a, b = symbols("r_w r_i r_j r_k"), symbols("q_0 q_1 q_2 q_3")
    both = rotation_matrix(cga.quaternion_coefficients(cga.quaternion(*a) * cga.quaternion(*b)))
    expected = rotation_matrix(a) * rotation_matrix(b)
    step.prove("both = expected", label=r"M(r q) = M(r) M(q) \text{ for any } r, q", both=both, expected=expected)


def length(step: Step) -> None:
    step.suppose(*(f"{name}_s**2 = {name}_sq - {name}_c**2" for name in HALVES), HALF_CIRCLE)
    quaternion = product_lines()
    step.values |= dict(zip(("w_1", "i_1", "j_1", "k_1"), quaternion, strict=True))
    last = LEAN["Root, second level"]
    step.values["length_sq"] = parse(last["length_sq"])
    step.prove("w_1**2 + i_1**2 + j_1**2 + k_1**2 = length_sq")
    squares = LEAN["Lengths of the half angle quaternions, squared"]
    for name, (cosine, _) in HALVES.items():
        step.prove(f"{name}_sq = (1 + Abs({cosine}))/2", **{f"{name}_sq": parse(squares[f"{name}_sq"])})
    flat = symbols("u_y sin_el " + HALVES["arm"][0])
    whole = parse(last["length_sq"], {name: parse(text) for name, text in squares.items()})
    corners = [whole.subs(dict(zip(flat, corner, strict=True))) for corner in itertools.product((0, 1), repeat=3)]
    linear = all(sp.degree(whole.subs({sp.Abs(v): v for v in flat}), v) == 1 for v in flat)
    cosines = ", ".join(f"$|{name_tex(str(v))}|$" for v in flat)
    bounds = (
        rf"$\frac18 \le |q|^2 \le 1$: $|q|^2$ is linear in each of {cosines}, so its extremes are among the 8 corners"
    )
    step.true(f"{bounds} of $[0, 1]^3$", linear and (min(corners), max(corners)) == (sp.Rational(1, 8), 1))
    step.values = {name: parse(last[name]) for name in last if name.startswith("qs_")} | {
        "inv_q": parse(last["inv_q"], {"rsqrt": lambda argument: 1 / {symbol("length_sq"): symbol("length")}[argument]})
    }
    q_s = sp.Matrix([step.value(last[f"qs_{part}"]) for part in "wijk"])
    step.prove("q_s = q/length", label="Q_s = q/|q|", q_s=q_s, q=sp.Matrix(symbols("w_1 i_1 j_1 k_1")))


def shifts(step: Step) -> None:
    k, v = sp.Symbol("k", integer=True), sp.Symbol("v", positive=True)
    ratio = sp.powdenest(sp.powsimp(2**k / sp.sqrt(4**k * v) * sp.sqrt(v)), force=True)
    step.true(r"$1/\sqrt v = 2^k / \sqrt{4^k v}$ for any integer $k$", sp.simplify(ratio) == 1)
    given = {name: symbol(name) for group in ("Sums of the inputs", "Roots, first level") for name in LEAN[group]}
    plain = run(LEAN["Directions"] | LEAN["Triangle"], given)
    # root -> 2^k root of the mantissa, argument -> 4^-k mantissa
    arguments = {name: text[6:-1] for name, text in LEAN["Roots, first level"].items()}
    two = {name: sp.Symbol(f"two_{name}", positive=True) for name in arguments}
    scaled = {symbol(name): two[name] * symbol(name) for name in arguments}
    scaled |= {symbol(argument): symbol(argument) / two[name] ** 2 for name, argument in arguments.items()}
    for name in ("u_x", "u_y", "sin_el", "cos_el", "qe_w", "qe_i", HALVES["arm"][0], HALVES["arm"][1]):
        degree = {v: sp.degree(plain[name], symbol(v)) for pair in arguments.items() for v in pair}
        powers = {n: degree[n] - 2 * degree[a] for n, a in arguments.items()}
        ratio = sp.cancel(plain[name].subs(scaled, simultaneous=True) / plain[name])
        right = ratio == sp.prod(two[n] ** power for n, power in powers.items())
        tail = {n: sp.Symbol(f"k_{{{name_tex(a).removesuffix('^2')}}}") for n, a in arguments.items()}
        exponent = sp.latex(sum(power * tail[n] for n, power in powers.items()))
        step.true(f"${name_tex(name)}$: $2^{{{exponent}}}$", right)


def near_singular(step: Step) -> None:
    sums = run(LEAN["Sums of the inputs"], {})
    whole = all(sp.Poly(value).domain == sp.ZZ for value in sums.values())
    names = ", ".join(f"${name_tex(name)}$" for name in sums)
    step.true(f"{names} are polynomials in the inputs with integer coefficients", whole)
    terms = [term for name in ("rho_sq", "s") for term in sp.Poly(sums[name]).terms()]
    positive = all(c > 0 and all(n % 2 == 0 for n in powers) for powers, c in terms)
    step.true(r"$\rho^2$ and $s$ have no negative term", positive)
    products = LEAN["Directions"] | LEAN["Triangle"]
    none = not any(parse(text, evaluate=False).has(sp.Add) for text in products.values())
    step.true("no line of the directions and the triangle has a sum", none)
    pairs = [PARTS[0:2], PARTS[2:4], PARTS[4:6], (COS_H, SIN_H)]
    linear = all(sum(m) == 1 for part in product_lines() for pair in pairs for m in sp.Poly(part, *pair).monoms())
    step.true(r"$q$ is linear in each of $\mathrm{az}$, $\mathrm{tilt}$, $\mathrm{arm}$ and $h_\phi$", linear)

    d1, d2, dist = sp.symbols("d_1 d_2 |p|", positive=True)
    delta = symbol("delta")
    at = {symbol("x"): 0, symbol("y"): 0, symbol("z"): dist, symbol("d1"): d1, symbol("d2"): d2}
    a_far, b_near = (sums[name].subs(at) for name in ("a_far", "b_near"))
    stretched, folded = {dist: (d1 + d2) * (1 - delta)}, {dist: (d1 - d2) * (1 + delta)}
    sine = a_far * b_near / (4 * d1**2 * dist**2)
    far, near = r"$|p| = (d_1 + d_2)(1 - \delta)$", r"$|p| = (d_1 - d_2)(1 + \delta)$"
    tmp1 = r"4\,\mathrm{tmp}_1 / (2 \rho d_1 |p|)^2"
    rows = []
    for where, name, value, lean in (
        (far, "1 + c_4", (a_far / (2 * d1 * d2)).subs(stretched), "$A$, exact"),
        (far, tmp1, sine.subs(stretched), "$A$ and $B$, exact"),
        (near, "1 - c_4", (b_near / (2 * d1 * d2)).subs(folded), "$B$, exact"),
        (near, tmp1, sine.subs(folded), "$A$ and $B$, exact"),
        (r"wrist $\delta$ from the z axis", r"|\pi_{swivel}|/|p|", sp.sin(delta), r"$\rho^2$, exact"),
        (r"elbow $\delta$ from the positive z axis", "(d_1 - p_{ez})/d_1", 1 - sp.cos(delta), "not formed"),
        (r"$\theta_3 = \delta$, no turn about the upper arm", "1 - c_3", 1 - sp.cos(delta), "not formed"),
    ):
        value = sp.expand(sp.together(value))
        lead = sp.factor(value.as_leading_term(delta))
        coefficient, order = lead.as_coeff_exponent(delta)
        limit = sp.simplify(sp.limit(value / delta**order, delta, 0) - coefficient)
        if order <= 0 or limit != 0:
            step.true(f"{where}: ${name}$ vanishes", False)
        rows.append((where.replace("|", r"\vert "), f"${name}$".replace("|", r"\vert "), f"${latex(lead)}$", lean))
    step.extra.append(table(["pose", "in the paper's form", "size", "in the lean form"], rows, 4))


def count(table_: Mapping[str, str]) -> Ops:
    """Count the operations of lines as written."""
    return total(parse(text, evaluate=False) for text in table_.values())


def counts(step: Step) -> None:
    r = symbols("r_w r_i r_j r_k")
    step.suppose("r_w**2 = 1 - r_i**2 - r_j**2 - r_k**2")
    turned = rotation_matrix(r)
    for v, column, sign in (("n", 0, -1), ("f", 1, 1), ("e", 2, 1)):
        step.values |= {f"{v}_{axis}": sign * turned[m, column] for m, axis in enumerate("xyz")}
    for name, text in MATRIX["Four sums and what goes with them"].items():
        a, b = name.removeprefix("sum_")[0], name[-1]
        square = f"r_{a}**2" if a == b else f"r_{a}*r_{b}"
        step.prove(f"{name} = {text} = 4*{square}", **{name: step.value(text)})
    # The row of the largest sum 4 r_a^2 is (4 r_a^2, 4 r_a r_b, ...). Divided by twice the sum's root, it is +-r.
    row = dict(zip(("largest", "other_1", "other_2", "other_3"), [4 * r[0] * v for v in r], strict=True))
    result = run(MATRIX["The row of the largest sum"], row | {"g_q": 1 / (2 * r[0])})
    label = r"(q_0, q_1, q_2, q_3) = r \text{ from the row of } \Sigma_w,\ g_\Sigma = 1/(2 r_w)"
    step.prove("row = r", label=label, row=sp.Matrix([result[f"q_{n}"] for n in range(4)]), r=sp.Matrix(r))

    rows: list[tuple] = []

    def group(lines_: Mapping[str, Mapping[str, str]], title: str) -> Ops:
        whole = Ops()
        for name, table_ in lines_.items():
            one = count(table_)
            assert one == Ops(one.add, one.mul, one.root, 0, one.scale), f"{name}: what the table does not show"
            whole += one
            rows.append((name, one.mul, one.add, one.root))
        rows.append((f"**{title}**", whole.mul, whole.add, whole.root))
        return whole

    chosen = ("Half angle quaternions", "Half the swivel angle")  # choices; both forms look up sine and cosine
    own = ("Lengths of the half angle quaternions, squared", "Product", "Root, second level")
    lean = {name: LEAN[name] for name in own}
    both = group({n: t for n, t in LEAN.items() if n not in own + chosen}, "both forms, to the triangle")
    plain = group(lean, "shoulder, lean form"), group(MATRIX, "shoulder, matrix form")
    less = [shared({n: parse(t, evaluate=False) for n, t in lines(form).items()}) for form in (lean, MATRIX)]
    for form, one, other in zip(("lean", "matrix"), plain, less, strict=True):
        for label, ops in ((f"{form} form, whole", both + one), ("the same, common subexpressions", both + other)):
            rows.append((label, ops.mul, ops.add, ops.root))
    step.extra.append(table(["lines", "x", "+, -", "reciprocal roots"], rows))
    mul, add = less[1].mul - less[0].mul, less[1].add - less[0].add
    text = f"with common subexpressions (`sympy.cse`) the lean form has {mul} multiplications and {add} additions less"
    step.true(text, mul > 0 and add > 0 and less[0].root == less[1].root)


STEPS = (
    directions,
    swivel,
    elbow,
    elbow_quaternion,
    shoulder,
    factors,
    half,
    product,
    length,
    shifts,
    near_singular,
    counts,
)

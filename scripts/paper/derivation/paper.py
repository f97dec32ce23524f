# SPDX-License-Identifier: Apache-2.0
"""Derivation of equations (10)-(19): each step runs a function of model/reference/geometry.py on symbols.

Steps and their statements appear in docs/generated/derivation.md.
"""

import sympy as sp

from model.reference import cga, geometry
from model.reference.cga import symbol
from scripts.paper.derivation.proofs import HALF_CIRCLE, PRINTED, Step, symbols

P_W, P_E, PI = (sp.Matrix(symbols(f"{name}_x {name}_y {name}_z")) for name in ("p_w", "p_e", "pi_swivel"))
D1, D2 = symbols("d1 d2")
PAIR = [f"pp_{name}" for name in ("i", "j", "k", "14", "15", "24", "25", "34", "35")]
BLADES = ("e23", "e13", "e12", "e14", "e15", "e24", "e25", "e34", "e35")
SIGNS = (-1, 1, -1, 1, 1, 1, 1, 1, 1)
"""Names of the point pair's coefficients in (12), their blades, and their signs on these blades."""

POSE = {"p_w_x": 1, "p_w_y": 2, "p_w_z": 2, "pi_swivel_x": 2, "pi_swivel_y": -1, "pi_swivel_z": 0, "d1": 3, "d2": 2}
L_SW = "l_sw**2 = p_w_x**2 + p_w_y**2 + p_w_z**2"


def normal(plane) -> sp.Matrix:
    """Return the coefficients of e1, e2, e3 in a plane or vector."""
    return sp.Matrix([cga.coefficient(plane, blade) for blade in ("e1", "e2", "e3")])


def of_axes(name: str, values) -> dict[str, sp.Expr]:
    """Return a dict: name_x, name_y, name_z -> component of the vector ``values``."""
    return {f"{name}_{axis}": value for axis, value in zip("xyz", values, strict=True)}


def swivel_plane(step: Step) -> None:
    _, length, plane = geometry.swivel_plane(cga.point(*P_W), symbol("phi"))
    step.suppose(L_SW, HALF_CIRCLE)
    step.roots = {symbol("l_sw"): symbol("l_sw") ** 2}
    step.rows("(10)", {"l_sw": step.named(length)})
    pi = normal(plane).applyfunc(step.named)
    as_printed = sp.Matrix([step.value(text) for text in PRINTED["(11)"].values()])
    point = {"p_w_x": 1, "p_w_y": 2, "p_w_z": 2, "cos_h": "4/5"}
    step.rows("(11)", of_axes("pi_swivel", pi), point=point)
    step.values |= {"pi": pi, "p_w": P_W}
    step.prove("dot(pi, p_w) = 0", "sq(pi) = p_w_x**2 + p_w_y**2")
    step.prove("dot(pi, p_w) = 0", label=r"\pi_{swivel} \cdot p_w = 0 \text{ for the plane as printed}", pi=as_printed)
    for blade, label in (("einf", r"e_\infty"), ("e0", "e_0")):
        part = step.named(cga.coefficient(plane, blade))
        step.prove("part = 0", label=rf"\langle\pi_{{swivel}}\rangle_{{{label}}} = 0", part=part)


def derived_pair() -> dict[str, sp.Expr]:
    """Return a dict: coefficient's name in (12) -> that coefficient of PP*."""
    PP = geometry.elbow_point_pair(cga.point(*P_W), cga.plane(*PI, 0), D1, D2)[3]
    pair = cga.dual(PP)
    assert (PP.grades, sp.expand(pair.e45)) == ((3,), 0), "the text of the page"
    return {n: sp.expand(s * getattr(pair, b)) for n, b, s in zip(PAIR, BLADES, SIGNS, strict=True)}


def point_pair(step: Step) -> None:
    step.rows("(12)", derived_pair())


def elbow(step: Step) -> tuple[sp.Matrix, sp.Expr]:
    """Return the elbow point of a point pair whose nine coefficients are symbols, and the radicand of the point's only
    root. In ``step.roots``, that root is named tmp_sqr."""
    keys = tuple(cga.ALGEBRA.canon2bin[blade] for blade in BLADES)
    pair = cga.ALGEBRA.multivector(keys=keys, values=[s * symbol(n) for s, n in zip(SIGNS, PAIR, strict=True)])
    point = cga.euclidean_coordinates(geometry.elbow_point(-cga.dual(pair)))  # a second dual gives back -X
    square = radicand(point[0])
    step.roots = {symbol("tmp_sqr"): square}
    return sp.Matrix([sp.factor(step.named(value)) for value in point]), square


def radicand(expression) -> sp.Expr:
    """Return the radicand of the only square root in an expression."""
    roots = sp.sympify(expression).atoms(sp.Pow)
    (base,) = {power.base for power in roots if power.exp.is_Rational and power.exp.q == 2}
    return base.args[0] if isinstance(base, sp.Abs) else base


def sums(step: Step) -> None:
    pair = derived_pair()
    sums = {f"pp_{m}_plus": pair[f"pp_{m}5"] + pair[f"pp_{m}4"] for m in "123"}
    step.rows("(19)", sums | {f"pp_{m}_minus": pair[f"pp_{m}5"] - pair[f"pp_{m}4"] for m in "123"}, factor=2)
    p_e, square = elbow(step)
    for m in "123":
        for sign, name in ((1, "plus"), (-1, "minus")):
            step.values[f"pp_{m}_{name}"] = symbol(f"pp_{m}5") + sign * symbol(f"pp_{m}4")
    products = " + ".join(f"pp_{m}_plus*pp_{m}_minus" for m in "123")
    step.prove(f"tmp1 = -pp_i**2 - pp_j**2 - pp_k**2 + {products}", tmp1=square)
    # The next statement proves that scaling a pair by lam > 0 scales the root by lam.
    lam = symbol("lam")
    scaled = {symbol(name): lam * symbol(name) for name in [*PAIR, "tmp_sqr"]}
    larger = {"tmp1": square.subs(scaled, simultaneous=True), "p_e": p_e.subs(scaled, simultaneous=True)}
    label = r"\mathrm{tmp}_1(\lambda PP) = \lambda^2\,\mathrm{tmp}_1(PP)"
    step.prove("tmp1 = lam**2*square", label=label, square=square, **larger)
    step.prove("p_e = smaller", label=r"p_e(\lambda PP) = p_e(PP),\ \lambda > 0", smaller=p_e, **larger)
    partly = square.subs({symbol(name): 2 * symbol(name) for name in PAIR[3:]}, simultaneous=True)
    label = r"\mathrm{tmp}_1 \text{ of a pair with only the last six doubled is } 4\,\mathrm{tmp}_1"
    point = dict(zip(PAIR, (1, 2, 3, 1, 7, 2, 6, 3, 8), strict=True))
    step.refute("partly = 4*square", point, label, partly=partly, square=square)


def elbow_point(step: Step) -> None:
    p_e, square = elbow(step)
    denominator = sp.fraction(p_e[0])[1]
    rows = {"inf_pp": denominator, "tmp1": square, "tmp_sqr": symbol("tmp_sqr"), **of_axes("p_e", p_e)}
    step.rows("(13)", rows)
    # The elbow point of the pair (12) if the plane contains p_w, multiplied by inf_pp to avoid quotients.
    put = {symbol(name): value for name, value in derived_pair().items()}
    inf_pp, tmp1 = (sp.expand(value.subs(put)) for value in (denominator, square))
    forward = (p_e * denominator).applyfunc(lambda value: sp.expand(sp.cancel(value).subs(put)))
    step.values = {"p_e": forward, "p_w": P_W, "pi": PI, "inf_pp": inf_pp, "tmp1": tmp1}
    step.suppose("p_w_x*pi_swivel_x = -(p_w_y*pi_swivel_y + p_w_z*pi_swivel_z)", "tmp_sqr**2 = tmp1")
    for text, label in (
        ("sq(p_e) = d1**2*inf_pp**2", "|p_e|^2 = d_1^2"),
        ("sq(p_e - inf_pp*p_w) = d2**2*inf_pp**2", "|p_e - p_w|^2 = d_2^2"),
        ("dot(pi, p_e) = 0", r"\pi_{swivel} \cdot p_e = 0"),
        ("dot(cross(pi, p_w), p_e) = tmp_sqr*inf_pp", r"(\pi_{swivel} \times p_w) \cdot p_e = \mathrm{tmp}_{sqr}"),
    ):
        step.prove(text, label=label)
    step.prove("tmp1 = sq(pi)*((d1 + d2)**2 - sq(p_w))*(sq(p_w) - (d1 - d2)**2)/4")
    label = r"|p_e|^2 = d_2^2 \text{, with table 3's } d_2 \text{ as the upper arm}"
    step.refute("d1**2 = d2**2", POSE, label)


def elbow_quaternion(step: Step) -> None:
    L_se, _, c4, Q_e = geometry.elbow_quaternion(cga.point(*P_E), cga.point(*P_W))
    step.values = {"p_e": P_E, "p_w": P_W}
    step.suppose("d1**2 = sq(p_e)", "d2**2 = sq(p_e - p_w)")
    step.roots = {D1: D1**2, D2: D2**2}
    named = step.named(c4)
    step.roots |= {symbol("cos4"): (1 + named) / 2, symbol("sin4"): (1 - named) / 2}
    parts = dict(zip(("qe_w", "qe_i", "qe_j", "qe_k"), map(step.named, cga.quaternion_coefficients(Q_e)), strict=True))
    step.rows("(14)", {"c4": named, **parts})
    step.prove("qe_j = 0", "qe_k = 0", **parts)
    step.values["c4"] = named
    step.prove("c4*d1*d2 = dot(-p_e, p_w - p_e)", "c4 = (d1**2 + d2**2 - sq(p_w))/(2*d1*d2)")
    point = {"p_e_x": 1, "p_e_y": 2, "p_e_z": 2, "d1": 3, "p_w_x": 3, "p_w_y": 5, "p_w_z": 8, "d2": 7}
    label = r"\langle Q_e\rangle_i = +\sin\frac{\theta_4}{2} \text{, section 3.3 before (14)}"
    step.refute("qe_i = sin4", point, label, **parts)
    step.suppose(L_SW)
    step.roots[symbol("l_sw")] = symbol("l_sw") ** 2
    other = step.named(cga.cos_angle(L_se, cga.dual(cga.line_direct(cga.e_0, cga.point(*P_W)))))
    label = r"c_4 = \cos(L_{se}, L_{sw}) \text{, section 3.3's line through shoulder and wrist}"
    step.refute("c4 = other", point, label, other=other)


def rotate_to_elbow(step: Step) -> None:
    _, _, _, L_m, Q_12 = geometry.elbow_rotation(cga.point(*P_E), D1)
    step.suppose("p_e_z**2 = d1**2 - p_e_x**2 - p_e_y**2")
    w, *q12 = cga.quaternion_coefficients(Q_12)
    square = radicand(q12[0])
    step.values |= {"tmp2": square, "p_e": P_E}
    step.suppose("l_m**2 = tmp2")
    step.roots = {symbol("l_m"): square}
    q12 = {f"q12_{unit}": step.named(value) for unit, value in zip("ijk", q12, strict=True)}
    step.rows("(15)", {"tmp2": square, "l_m": symbol("l_m"), **q12})
    for unit, part in zip("ijk", cga.quaternion_coefficients(L_m)[1:], strict=True):
        step.prove(f"part = q12_{unit}*l_m", label=rf"\langle L_m\rangle_{unit} = q_{{12{unit}}} |L_m|", part=part)
    infinite = sp.Matrix([cga.coefficient(L_m, f"e{n}^einf") for n in "123"])
    label = r"\langle L_m\rangle_{e_n \wedge e_\infty} = 0,\ n = 1, 2, 3"
    step.prove("infinite = 0*infinite", label=label, infinite=infinite)
    step.prove("w = 0", label=r"\langle Q_{12}\rangle = 0", w=step.named(w))
    step.prove("q12_i**2 + q12_j**2 + q12_k**2 = 1", label="|Q_{12}|^2 = 1")
    turned = normal(cga.rotate(cga.quaternion(0, *q12.values()), cga.e3))
    step.prove("turned = p_e/d1", label=r"Q_{12}\,e_3\,\tilde Q_{12} = p_e / d_1", turned=turned)


def rotate_to_wrist(step: Step) -> None:
    q12 = symbols("q12_i q12_j q12_k")
    _, c3, sign, Q_3 = geometry.wrist_rotation(cga.quaternion(0, *q12), cga.plane(*PI, 0), cga.point(*P_W))
    length = "pi_abs**2 = pi_swivel_x**2 + pi_swivel_y**2 + pi_swivel_z**2"
    step.suppose("q12_k**2 = 1 - q12_i**2 - q12_j**2", length)
    step.roots = {sp.Integer(1): sp.Integer(1), symbol("pi_abs"): symbol("pi_abs") ** 2}
    named = step.named(c3)
    side = sp.sympify(sign).atoms(sp.Abs).pop().args[0]
    step.roots |= {symbol("abs_side"): side**2, symbol("cos3"): (1 + named) / 2, symbol("sin3"): (1 - named) / 2}
    w, i, j, k = map(step.named, cga.quaternion_coefficients(Q_3))
    sign = step.named(sign)
    sides = {"sign_raw": sp.expand(sign * symbol("abs_side")), "sign": sign}
    step.rows("(17)", {"c3": named, **sides, "q3_scalar": w, "q3_k": k})
    step.prove("i = 0", label=r"\langle Q_3\rangle_i = 0", i=i)
    step.prove("j = 0", label=r"\langle Q_3\rangle_j = 0", j=j)
    step.values |= {**sides, "q3_scalar": w, "q3_k": k}
    step.suppose("abs_side**2 = sign_raw**2")
    label = r"\mathrm{sign}^2 \cos\frac{\theta_3}{2} = q_{3,scalar}"
    step.prove("sign*(sign*cos3) = q3_scalar", label=label)
    step.prove("sign*sin3 = q3_k")


def product(step: Step) -> None:
    q12, (scalar, k) = symbols("q12_i q12_j q12_k"), symbols("q3_scalar q3_k")
    Q_s = cga.quaternion(0, *q12) * cga.quaternion(scalar, 0, 0, k)  # as in geometry.solve
    names = [f"qs_{unit}" for unit in "wijk"]
    step.rows("(18)", dict(zip(names, cga.quaternion_coefficients(Q_s), strict=True)))


STEPS = (swivel_plane, point_pair, sums, elbow_point, elbow_quaternion, rotate_to_elbow, rotate_to_wrist, product)

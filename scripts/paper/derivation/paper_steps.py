# SPDX-License-Identifier: Apache-2.0
"""Sections of docs/generated/derivation.md; each runs a step of model/reference/geometry.py on symbols."""

from __future__ import annotations

import copy

import sympy as sp

from model.reference import cga, geometry
from scripts.paper.derivation.paper_proofs import Section, Setting, compare, normal_vector, radicand
from scripts.paper.derivation.printed import (
    BIVECTOR,
    FACTOR,
    KNOWN_WRONG,
    P_E,
    P_W,
    PI,
    PP_NAMES,
    PRINTED,
    SYMBOL,
    TEX,
    cross,
    dot,
    evaluate,
    latex,
    minus,
    symbols,
    tex,
)


def swivel_plane(printed) -> Section:
    c, s, L_sw, phi = symbols("c s L_sw phi")
    setting = Setting(
        relations={
            r"|L_{sw}|^2 = |p_w|^2": L_sw**2 - dot(P_W, P_W),
            r"c^2 + s^2 = 1": c**2 + s**2 - 1,
        },
        leading="L_sw s",
        roots={L_sw: L_sw**2},
        point={"p_wx": 1, "p_wy": 2, "p_wz": 2, "L_sw": 3, "c": "4/5", "s": "3/5"},
    )
    half = {sp.cos(phi / 2): c, sp.sin(phi / 2): s}
    _, length, plane = geometry.swivel_plane(cga.point(*P_W), phi)
    normal = [value.subs(half) for value in normal_vector(plane)]
    rows = printed["11"]
    section = Section("(10), (11) The swivel plane")
    squared = Setting(point=setting.point)
    radicand_10 = radicand(length, squared)
    row = compare(squared, "10", "L_sw", radicand_10, radicand(evaluate(printed["10"]["L_sw"]), squared))
    row.derived = sp.sqrt(row.derived)
    if row.holds:
        row.method += " of both squares; both roots are positive"
    section.rows.append(row)
    plane_printed = [evaluate(text).subs(half) for text in rows.values()]
    for name, derived, text in zip(rows, normal, plane_printed, strict=True):
        section.row(setting, "11", name, derived, text)
    for (equation, name), edit in KNOWN_WRONG.items():
        if equation == "11":
            mended = evaluate(rows[name].replace(*edit)).subs(half)
            derived = normal[list(rows).index(name)]
            statement = f"{TEX[name]} = {tex(rows[name].replace(*edit))}"
            section.fact(setting, statement, derived, mended, "11 mended")

    def fact(statement, left, right=0):
        section.fact(setting, statement, left, right)

    for blade, label in (("einf", r"e_\infty"), ("e0", "e_0")):
        fact(f"\\langle\\pi_{{swivel}}\\rangle_{{{label}}} = 0", sp.sympify(cga.coefficient(plane, blade)).subs(half))
    fact(r"\pi_{swivel} \cdot p_w = 0", dot(normal, P_W))
    fact(r"|\pi_{swivel}|^2 = p_{wx}^2 + p_{wy}^2", dot(normal, normal), P_W[0] ** 2 + P_W[1] ** 2)
    fact(r"\pi_{swivel} \cdot p_w = 0 \text{ for the plane as printed, too}", dot(plane_printed, P_W))
    return section


def _plane_through_line():
    """Return the relation that section 3.1 proves for the swivel plane."""
    return {r"\pi_{swivel} \cdot p_w = 0": dot(PI, P_W)}


def _pair():
    """Return the point pair PP and the derived coefficients of PP*, named as in (12)."""
    plane = cga.plane(*PI, 0)
    _, _, _, PP = geometry.elbow_point_pair(cga.point(*P_W), plane, *symbols("d1 d2"))
    return PP, pair_coefficients(cga.dual(PP))


def pair_coefficients(pair) -> dict[str, sp.Expr]:
    _, *ijk = cga.quaternion_coefficients(pair)
    values = ijk + [getattr(pair, blade) for blade in BIVECTOR[3:]]
    return {name: sp.expand(value) for name, value in zip(PP_NAMES, values, strict=True)}


POSE = {"p_wx": 1, "p_wy": 2, "p_wz": 2, "pi_x": 2, "pi_y": -1, "pi_z": 0, "d1": 3, "d2": 2}


def point_pair(printed) -> Section:
    setting = Setting(point=POSE)
    PP, pair = _pair()
    section = Section("(12) The point pair")
    for name, text in printed["12"].items():
        section.row(setting, "12", name, pair[name], evaluate(text))
    assert (PP.grades, sp.expand(cga.dual(PP).e45)) == ((3,), 0), "what the page says of the pair"
    return section


def sums(printed) -> Section:
    setting = Setting(point=POSE)
    _, pair = _pair()
    section = Section("(19) Sums and differences of the point pair")
    for name, text in printed["19"].items():
        m, op = name[3], 1 if name.endswith("p") else -1
        derived = pair[f"PP_{m}5"] + op * pair[f"PP_{m}4"]
        section.row(setting, "19", name, derived, evaluate(text), FACTOR["19"])
    free = _pair_setting()
    nine = dict(zip(PP_NAMES, symbols(" ".join(PP_NAMES)), strict=True))
    point = elbow_of(nine, free)
    (P_e, square) = point
    products = sum((nine[f"PP_{m}5"] + nine[f"PP_{m}4"]) * (nine[f"PP_{m}5"] - nine[f"PP_{m}4"]) for m in "123")
    sums = products - sum(nine[f"PP_{u}"] ** 2 for u in "ijk")
    section.fact(free, r"\mathrm{tmp}_1 = -PP_i^2 - PP_j^2 - PP_k^2 + \sum_m PP_m^+ PP_m^-", square, sums)
    # p_e of a pair scaled by lambda > 0; by the first statement its root scales by lambda.
    lam, tmp_sqr = symbols("lam tmp_sqr")
    scaled = {nine[name]: lam * nine[name] for name in PP_NAMES}
    statement = r"\mathrm{tmp}_1(\lambda PP) = \lambda^2\,\mathrm{tmp}_1(PP)"
    section.fact(free, statement, square.subs(scaled, simultaneous=True), lam**2 * square)
    for axis, value in zip("xyz", P_e, strict=True):
        statement = rf"p_{{e{axis}}}(\lambda PP) = p_{{e{axis}}}(PP),\ \lambda > 0"
        bigger = value.subs(scaled | {tmp_sqr: lam * tmp_sqr}, simultaneous=True)
        section.fact(free, statement, bigger, value)
    # Only the last six coefficients doubled, as (12) and (19) taken literally give them.
    mixed = {nine[name]: 2 * nine[name] for name in PP_NAMES[3:]}
    partly = square.subs(mixed, simultaneous=True)
    statement = r"\mathrm{tmp}_1 \text{ of a pair with only the last six doubled is } 4\,\mathrm{tmp}_1"
    section.fact(free, statement, partly, 4 * square, "fact false")
    return section


def _pair_setting() -> Setting:
    """Return a setting in which the nine coefficients of PP* are free symbols."""
    (tmp_sqr,) = symbols("tmp_sqr")
    values = (1, 2, 3, 1, 7, 2, 6, 3, 8)
    square = evaluate(PRINTED["13"]["tmp1"])  # only names the root; a comparison checks the derived radicand
    point = dict(zip(PP_NAMES, values, strict=True)) | {"tmp_sqr": 11, "lam": 2}
    return Setting(roots={tmp_sqr: square}, point=point)


def elbow_of(nine: dict[str, sp.Expr], setting: Setting):
    """Return ((p_ex, p_ey, p_ez), radicand) of `geometry.elbow_point` for a pair PP* with these coefficients."""
    keys = tuple(cga.ALGEBRA.canon2bin[blade] for blade in BIVECTOR)
    # i = -e23, j = e13, k = -e12
    signs = (-1, 1, -1, 1, 1, 1, 1, 1, 1)
    pair = cga.ALGEBRA.multivector(keys=keys, values=[s * nine[n] for s, n in zip(signs, PP_NAMES, strict=True)])
    P_e = geometry.elbow_point(-cga.dual(pair))  # a second dual gives back -X
    coordinates = [sp.sympify(value) for value in cga.euclidean_coordinates(P_e)]
    named = [sp.factor(setting.named(value)) for value in coordinates]
    return named, radicand(coordinates[0], setting)


def elbow_point(printed) -> Section:
    free = _pair_setting()
    nine = dict(zip(PP_NAMES, symbols(" ".join(PP_NAMES)), strict=True))
    P_e, square = elbow_of(nine, free)
    d1, d2, tmp_sqr = symbols("d1 d2 tmp_sqr")
    section = Section("(13) The elbow point")
    rows = printed["13"]
    inf_PP = sp.fraction(P_e[0])[1]
    section.row(free, "13", "inf_PP", inf_PP, evaluate(rows["inf_PP"]))
    section.row(free, "13", "tmp1", square, evaluate(rows["tmp1"]))
    for name, derived in zip(("p_ex", "p_ey", "p_ez"), P_e, strict=True):
        text = evaluate(rows[name], inf_PP=evaluate(rows["inf_PP"]))
        section.row(free, "13", name, derived, text)

    # The same point with the pair of (12) substituted.
    _, pair = _pair()
    put = {nine[name]: value for name, value in pair.items()}
    radicand_pose = sp.expand(square.subs(put))
    reached = Setting(
        relations=_plane_through_line() | {r"\mathrm{tmp}_{sqr}^2 = \mathrm{tmp}_1": tmp_sqr**2 - radicand_pose},
        leading="tmp_sqr pi_x p_wx",
        point=POSE | {"tmp_sqr": sp.sqrt(radicand_pose.subs({SYMBOL[k]: v for k, v in POSE.items()}))},
    )
    # Multiply by inf_PP, the common denominator: cancelling such quotients would take minutes.
    elbow = [sp.expand((value * inf_PP).subs(put)) for value in P_e]
    weight = sp.expand(inf_PP.subs(put))

    def fact(statement, left, right=0):
        section.fact(reached, statement, sp.expand(left), sp.expand(right))
        section.facts[-1].method += r", both sides times a power of $\mathrm{inf}_{PP}$"

    p_w_sqr, normal_sqr = dot(P_W, P_W), dot(PI, PI)
    fact(r"|p_e|^2 = d_1^2", dot(elbow, elbow), d1**2 * weight**2)
    forearm = minus(elbow, [weight * p for p in P_W])
    fact(r"|p_e - p_w|^2 = d_2^2", dot(forearm, forearm), d2**2 * weight**2)
    fact(r"\pi_{swivel} \cdot p_e = 0", dot(PI, elbow))
    fact(r"(\pi_{swivel} \times p_w) \cdot p_e = \mathrm{tmp}_{sqr}", dot(cross(PI, P_W), elbow), tmp_sqr * weight)
    product = ((d1 + d2) ** 2 - p_w_sqr) * (p_w_sqr - (d1 - d2) ** 2)
    statement = (
        r"\mathrm{tmp}_1 = \tfrac14 |\pi_{swivel}|^2 \left((d_1 + d_2)^2 - |p_w|^2\right)"
        r"\left(|p_w|^2 - (d_1 - d_2)^2\right)"
    )
    section.fact(reached, statement, radicand_pose, sp.expand(normal_sqr * product) / 4)
    # The left side is d1^2 by the first statement.
    statement = r"|p_e|^2 = d_2^2 \text{, table 3's } d_2 \text{ as the upper arm}"
    section.fact(Setting(point=POSE), statement, d1**2, d2**2, "fact false")
    return section


def elbow_quaternion(printed) -> Section:
    d1, d2, cos4, sin4 = symbols("d1 d2 cos4 sin4")
    forearm = minus(P_E, P_W)
    setting = Setting(
        relations={
            r"|p_e|^2 = d_1^2": d1**2 - dot(P_E, P_E),
            r"|p_e - p_w|^2 = d_2^2": d2**2 - dot(forearm, forearm),
        },
        leading="d1 d2",
        roots={d1: d1**2, d2: d2**2},
        point={"p_ex": 1, "p_ey": 2, "p_ez": 2, "d1": 3, "p_wx": 3, "p_wy": 5, "p_wz": 8, "d2": 7},
    )
    L_se, _, c4, Q_e = geometry.elbow_quaternion(cga.point(*P_E), cga.point(*P_W))
    section = Section("(14) The elbow cosine and $Q_e$")
    derived = setting.named(c4)
    rows = printed["14"]
    section.row(setting, "14", "c_4", c4, evaluate(rows["c_4"]))
    halves = copy.copy(setting)
    halves.roots = setting.roots | {cos4: (1 + derived) / 2, sin4: (1 - derived) / 2}
    w, i, j, k = cga.quaternion_coefficients(Q_e)
    for name, value in (("qe_w", w), ("qe_i", i)):
        section.row(halves, "14", name, value, evaluate(rows[name], c_4=evaluate(rows["c_4"])))
    for unit, value in (("j", j), ("k", k)):
        section.fact(halves, rf"\langle Q_e\rangle_{unit} = 0", value)
    away, on = [-p for p in P_E], minus(P_W, P_E)
    section.fact(setting, r"c_4\,d_1 d_2 = (-p_e) \cdot (p_w - p_e)", c4 * d1 * d2, dot(away, on))
    law = (d1**2 + d2**2 - dot(P_W, P_W)) / (2 * d1 * d2)
    section.fact(setting, r"c_4 = (d_1^2 + d_2^2 - |p_w|^2) / (2 d_1 d_2)", c4, law)
    text_line = copy.copy(setting)
    (L_sw,) = symbols("L_sw")
    text_line.relations = setting.relations | {r"|L_{sw}|^2 = |p_w|^2": L_sw**2 - dot(P_W, P_W)}
    text_line.leading = "L_sw d1 d2"
    text_line.roots = setting.roots | {L_sw: L_sw**2}
    text_line.point = setting.point | {"L_sw": sp.sqrt(98)}
    other = cga.cos_angle(L_se, cga.dual(cga.line_direct(cga.e_0, cga.point(*P_W))))
    statement = r"c_4 = \cos(L_{se}, L_{sw}) \text{, section 3.3's line through shoulder and wrist}"
    section.fact(text_line, statement, c4, other, "fact false")
    statement = r"\langle Q_e\rangle_i = +\sin\frac{\theta_4}{2} \text{, section 3.3 before (14)}"
    halves.point = setting.point
    section.fact(halves, statement, i, sin4, "fact false")
    return section


def rotate_to_elbow(printed) -> Section:
    d1, L_m_length = symbols("d1 L_m")
    point = {"p_ex": 72, "p_ey": 96, "p_ez": -35, "d1": 125}
    on_sphere = {r"|p_e|^2 = d_1^2": dot(P_E, P_E) - d1**2}
    setting = Setting(relations=on_sphere, leading="p_ez", point=point)
    _, _, _, L_m, Q_12 = geometry.elbow_rotation(cga.point(*P_E), d1)
    _, *middle = cga.quaternion_coefficients(L_m)
    w, *q12 = cga.quaternion_coefficients(Q_12)
    section = Section("(15) The middle line and $Q_{12}$")
    rows = printed["15"]
    square = radicand(sp.sympify(q12[0]), setting)
    section.row(setting, "15", "tmp2", square, evaluate(rows["tmp2"]))
    known = Setting(
        relations=on_sphere | {r"|L_m|^2 = \mathrm{tmp}_2": L_m_length**2 - setting.remainder(square)[0]},
        leading="L_m p_ez",
        roots={L_m_length: square},
        point=point | {"L_m": sp.sqrt(square.subs({SYMBOL[k]: v for k, v in point.items()}))},
    )
    length = evaluate(rows["L_m"], tmp2=evaluate(rows["tmp2"]))
    row = compare(known, "15", "L_m", sp.sqrt(square), length)
    row.derived = sp.sqrt(setting.normal(square)) if row.holds else row.derived
    section.rows.append(row)
    for unit, derived in zip("ijk", q12, strict=True):
        section.row(known, "15", f"q12_{unit}", derived, evaluate(rows[f"q12_{unit}"]))
    named = [known.named(value) for value in q12]
    for unit, value, top in zip("ijk", middle, named, strict=True):
        statement = rf"\langle L_m\rangle_{unit} = {latex(known.normal(value))} = q_{{12{unit}}} |L_m|"
        section.fact(known, statement, value, top * L_m_length)
    section.fact(known, r"\langle Q_{12}\rangle = 0", w)
    for n in "123":
        blade = f"e{n}^einf"
        label = rf"\langle L_m\rangle_{{e_{n} \wedge e_\infty}} = 0"
        section.fact(setting, label, cga.coefficient(L_m, blade))
    section.fact(known, r"|Q_{12}|^2 = 1", dot(named, named), sp.Integer(1))
    turned = cga.rotate(cga.quaternion(0, *named), cga.e3)
    for axis, value, target in zip("xyz", normal_vector(turned), P_E, strict=True):
        statement = rf"\langle Q_{{12}}\,e_3\,\tilde Q_{{12}}\rangle_{axis} = p_{{e{axis}}} / d_1"
        section.fact(known, statement, value, target / d1)
    return section


def rotate_to_wrist(printed) -> Section:
    q12 = symbols("q12_i q12_j q12_k")
    abs_pi, abs_side, cos3, sin3 = symbols("abs_pi abs_side cos3 sin3")
    base = {
        r"|Q_{12}|^2 = 1": dot(q12, q12) - 1,
        r"|\pi_{swivel}|^2 = \pi_{swivelx}^2 + \pi_{swively}^2 + \pi_{swivelz}^2": abs_pi**2 - dot(PI, PI),
    }
    third = sp.Rational(1, 3)
    point = {"q12_i": third, "q12_j": 2 * third, "q12_k": 2 * third, "pi_x": 2, "pi_y": 3, "pi_z": 6, "abs_pi": 7}
    point |= {"p_wx": 3, "p_wy": -2, "p_wz": 1}
    setting = Setting(base, "q12_k abs_pi", {sp.Integer(1): sp.Integer(1), abs_pi: abs_pi**2}, point, plain=True)
    _, c3, sign, Q_3 = geometry.wrist_rotation(cga.quaternion(0, *q12), cga.plane(*PI, 0), cga.point(*P_W))
    section = Section("(17) The rotation about the upper arm")
    rows = printed["17"]
    # sign = side / |side|: side is the argument of the absolute value
    inside = [a.args[0] for a in sp.sympify(sign).atoms(sp.Abs)]
    side = sp.expand(sign * sp.Abs(inside[0])) if len(inside) == 1 else sp.sympify(sign)
    section.row(setting, "17", "c_3", c3, evaluate(rows["c_3"]))
    section.row(setting, "17", "side", side, evaluate(rows["side"]))
    full = copy.copy(setting)
    derived_c3 = setting.named(c3)
    full.roots = setting.roots | {
        abs_side: sp.expand(side) ** 2,
        cos3: (1 + derived_c3) / 2,
        sin3: (1 - derived_c3) / 2,
    }
    values = {"c_3": evaluate(rows["c_3"]), "side": evaluate(rows["side"])}
    values["sign"] = evaluate(rows["sign"], **values)
    w, i, j, k = cga.quaternion_coefficients(Q_3)
    for name, derived in (("sign", sign), ("q3_s", w), ("q3_k", k)):
        section.row(full, "17", name, derived, evaluate(rows[name], **values))
    for unit, value in (("i", i), ("j", j)):
        section.fact(full, rf"\langle Q_3\rangle_{unit} = 0", value)
    ruled = Setting({r"|\mathrm{side}|^2 = \mathrm{side}^2": abs_side**2 - side**2}, "abs_side")
    at_sign, scalar, k_part = full.named(sign), full.named(w), full.named(k)
    statement = r"\mathrm{sign} \cdot \left(\mathrm{sign}\,\cos\frac{\theta_3}{2}\right) = q_{3,scalar}"
    section.fact(ruled, statement, at_sign * at_sign * cos3, scalar)
    statement = r"\mathrm{sign} \cdot \sin\frac{\theta_3}{2} = q_{3k}"
    section.fact(ruled, statement, at_sign * sin3, k_part)
    return section


def product(printed) -> Section:
    q12, (q3_s, q3_k) = symbols("q12_i q12_j q12_k"), symbols("q3_s q3_k")
    point = {"q12_i": 1, "q12_j": 2, "q12_k": 3, "q3_s": 5, "q3_k": 7}
    setting = Setting(point=point)
    Q_s = cga.quaternion(0, *q12) * cga.quaternion(q3_s, 0, 0, q3_k)  # as in geometry.solve
    section = Section("(18) The shoulder quaternion")
    for (name, text), derived in zip(printed["18"].items(), cga.quaternion_coefficients(Q_s), strict=True):
        section.row(setting, "18", name, derived, evaluate(text))
    return section

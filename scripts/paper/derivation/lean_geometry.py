# SPDX-License-Identifier: Apache-2.0
"""Steps 1 to 6 of docs/generated/lean.md: reduction of the paper's equations to four rotations."""

from __future__ import annotations

import sympy as sp

from scripts.paper.derivation import printed as paper
from scripts.paper.derivation.lean_forms import TEX, Tables, latex, line_tex, lines, symbols
from scripts.paper.derivation.lean_proofs import (
    C2,
    CA,
    CE,
    CIRCLES,
    CP,
    D1,
    D2,
    HALF_CIRCLE,
    P_UNIT,
    RHO,
    S2,
    SA,
    SE,
    SP,
    U_X,
    U_Y,
    D,
    Relations,
    Step,
    first_half,
    frame,
    known_root,
    normal,
    rotation_matrix,
    sums_of_s,
    target,
    turn,
)
from scripts.paper.derivation.printed import cross, dot, evaluate


def directions(tables: Tables) -> Step:
    values, relations = first_half(tables)
    x, y, z = symbols("x y z")
    step = Step("1. The target's directions, (10)")
    step.shown = [(TEX[name], latex(sp.factor(values[name]))) for name in tables.lean["Directions"]]
    printed_length = evaluate(tables.printed["10"]["L_sw"], p_wx=x, p_wy=y, p_wz=z)
    step.equal("|L_{sw}|^2 = s", printed_length**2, values["s"], relations)
    step.equal("u_x^2 + u_y^2 = 1", values["u_x"] ** 2 + values["u_y"] ** 2, 1, relations)
    step.equal(r"\sin_{el}^2 + \cos_{el}^2 = 1", values["sin_el"] ** 2 + values["cos_el"] ** 2, 1, relations)
    step.equal(r"\cos_a^2 + \sin_a^2 = 1", values["cos_a"] ** 2 + values["sin_a"] ** 2, 1, relations)
    step.equal(r"x = |p|\,\cos_{el}\,u_x", x, D * values["cos_el"] * values["u_x"], relations)
    step.equal(r"y = |p|\,\cos_{el}\,u_y", y, D * values["cos_el"] * values["u_y"], relations)
    step.equal(r"z = |p|\,\sin_{el}", z, D * values["sin_el"], relations)
    step.equal(r"\rho = |p|\,\cos_{el}", RHO, D * values["cos_el"], relations)
    step.equal(r"K = 2 d_1 |p|\,\cos_a", values["k_law"], 2 * D1 * D * values["cos_a"], relations)
    return step


def swivel(tables: Tables) -> Step:
    plane = _plane(tables)
    relations = CIRCLES | HALF_CIRCLE
    full = {CP: C2**2 - S2**2, SP: 2 * C2 * S2}
    step = Step("2. The swivel plane, (11)")
    n = frame(tables)["n"]
    step.shown = [
        (rf"\pi_{{swivel{axis}}}/\rho", latex(normal(derived / (D * CE), relations)))
        for axis, derived in zip("xyz", plane, strict=True)
    ]
    lean = r",\ ".join(latex(sp.expand(v)) for v in n)
    step.equal(rf"n = \left({lean}\right)", [v / (D * CE) for v in plane], [v.subs(full) for v in n], relations)
    step.equal(r"\cos_\phi^2 + \sin_\phi^2 = 1", (full[CP]) ** 2 + full[SP] ** 2, 1, relations)
    step.equal("|n|^2 = 1", dot(n, n), 1, CIRCLES)
    step.equal(r"n \cdot p = 0", dot(n, P_UNIT), 0, CIRCLES)
    return step


def _plane(tables: Tables) -> list[sp.Expr]:
    half = {sp.cos(paper.SYMBOL["phi"] / 2): C2, sp.sin(paper.SYMBOL["phi"] / 2): S2}
    return [evaluate(tables.printed["11"][f"pi_{a}"], **target(), L_sw=D).subs(half) for a in "xyz"]


def elbow(tables: Tables) -> Step:
    vectors = frame(tables)
    n, m, e = vectors["n"], vectors["m"], vectors["e"]
    values, roots = first_half(tables)
    (K,) = symbols("k_law")
    law = {"d_2^2 = |p|^2 + d_1^2 - K": (D2, D**2 + D1**2 - K)}
    relations = {r"K = |p|^2 + d_1^2 - d_2^2 = 2 d_1 |p|\,\cos_a": (D2, D**2 + D1**2 - 2 * D1 * D * CA)} | CIRCLES
    step = Step("3. The elbow, (12) and (13)")
    given = target() | dict(zip(("pi_x", "pi_y", "pi_z"), [D * CE * v for v in n], strict=True)) | {"d1": D1, "d2": D2}
    pair = {name: evaluate(text, **given) for name, text in tables.printed["12"].items()}
    rows = tables.printed["13"]
    inf_PP, tmp1 = evaluate(rows["inf_PP"], **pair), evaluate(rows["tmp1"], **pair)
    step.equal("K = |p|^2 + d_1^2 - d_2^2", values["k_law"], values["s"] + D1**2 - D2**2)
    units = [pair[f"PP_{unit}"] for unit in "ijk"]
    step.equal(r"(PP_i, PP_j, PP_k) = \tfrac12 \rho K\,n", units, [D * CE * v * K / 2 for v in n], law | CIRCLES)
    step.equal(r"\mathrm{inf}_{PP} = \rho^2 |p|^2", inf_PP, D**4 * CE**2, CIRCLES)
    step.equal(
        r"\mathrm{tmp}_1 = \tfrac14 \rho^2 \left(4 d_1^2 s - K^2\right)",
        tmp1,
        (D * CE) ** 2 * (4 * D1**2 * D**2 - K**2) / 4,
        law | CIRCLES,
    )
    brief = sums_of_s(tables)
    factors = sp.factor(sp.expand(4 * D1**2 * brief["s"] - brief["k_law"] ** 2))
    step.shown.append(("4 d_1^2 s - K^2", latex(factors)))
    step.equal(
        "4 d_1^2 s - K^2 = A B", 4 * D1**2 * values["s"] - values["k_law"] ** 2, values["a_far"] * values["b_near"]
    )
    root = D * CE * D1 * D * SA
    sqrt = known_root([root], relations)
    tmp_sqr = evaluate("sqrt(tmp1)", tmp1=tmp1, sqrt=sqrt)
    step.equal(r"\mathrm{tmp}_{sqr} = \rho\,d_1 |p|\,\sin_a", tmp_sqr, root, root=sqrt)
    elbow = [evaluate(rows[f"p_e{axis}"], **pair, tmp_sqr=root, inf_PP=sp.Integer(1)) for axis in "xyz"]
    both = r", both sides times $\mathrm{inf}_{PP}$"
    step.equal("p_e = d_1 e", elbow, [D**4 * CE**2 * D1 * v for v in e], relations, both)
    lean = r",\ ".join(latex(v) for v in m)
    step.equal(rf"n \times p/|p| = m = \left({lean}\right)", cross(n, P_UNIT), m, CIRCLES)
    step.equal("|e|^2 = 1", dot(e, e), 1, CIRCLES)
    step.equal(r"n \cdot e = 0", dot(n, e), 0, CIRCLES)
    back = [CA * a - SA * b for a, b in zip(e, cross(n, e), strict=True)]
    step.equal(r"p/|p| = \cos_a e - \sin_a\,n \times e", P_UNIT, back, CIRCLES)
    return step


def elbow_quaternion(tables: Tables) -> Step:
    values, roots = first_half(tables)
    e = frame(tables)["e"]
    step = Step("4. The elbow quaternion, (14)")
    given = target() | {f"p_e{a}": D1 * v for a, v in zip("xyz", e, strict=True)} | {"d1": D1, "d2": D2}
    c4 = evaluate(tables.printed["14"]["c_4"], **given)
    step.equal(r"c_4 = (d_1 - |p|\,\cos_a)/d_2", c4, (D1 - D * CA) / D2, CIRCLES)
    law = (D1 - values["k_law"] / (2 * D1)) / D2  # |p| cos a = K/(2 d_1) by step 1
    shown = (D1 - sums_of_s(tables)["k_law"] / (2 * D1)) / D2
    for op, square, name in (("+", "a_far", "A"), ("-", "b_near", "B")):
        side = (1 + law if op == "+" else 1 - law) / 2
        brief = (1 + shown if op == "+" else 1 - shown) / 2
        step.shown.append((rf"\tfrac12 (1 {op} c_4)", latex(sp.factor(brief))))
        step.equal(rf"\tfrac12 (1 {op} c_4) = {name} / (4 d_1 d_2)", side, values[square] / (4 * D1 * D2))
    sqrt_a, sqrt_b, sqrt_1, sqrt_2 = symbols("sqrt_a sqrt_b sqrt_1 sqrt_2")
    sqrt = known_root([sqrt_a / (2 * sqrt_1 * sqrt_2), sqrt_b / (2 * sqrt_1 * sqrt_2)], roots)
    for name in ("qe_w", "qe_i"):
        printed = evaluate(tables.printed["14"][name], c_4=law, sqrt=sqrt)
        statement = f"{TEX[name]} = {line_tex(lines(tables.lean)[name])}"
        step.equal(statement, printed, values[name], roots, root=sqrt)
    step.equal(
        r"\langle Q_e\rangle^2 + \langle Q_e\rangle_i^2 = 1", values["qe_w"] ** 2 + values["qe_i"] ** 2, 1, roots
    )
    return step


def shoulder(tables: Tables) -> Step:
    r = symbols("r_w r_i r_j r_k")
    g, sigma = symbols("gamma sigma")
    unit: Relations = {
        r"\gamma^2 = r_w^2 + r_k^2": (g, r[0] ** 2 + r[3] ** 2),
        "|r|^2 = 1": (r[0], 1 - r[1] ** 2 - r[2] ** 2 - r[3] ** 2),
        r"\sigma^2 = 1": (sigma, sp.Integer(1)),
    }
    turned = rotation_matrix(r)
    n, f, e = [-turned[m, 0] for m in range(3)], [turned[m, 1] for m in range(3)], [turned[m, 2] for m in range(3)]
    step = Step("5. The shoulder quaternion, (15)-(18)")
    rows = tables.printed["15"]
    p_e = {f"p_e{a}": D1 * v for a, v in zip("xyz", e, strict=True)} | {"d1": D1}
    length = 2 * D1**3 * (1 - e[2]) * g
    sqrt = known_root([length], unit)
    derived = evaluate(rows["L_m"], tmp2=evaluate(rows["tmp2"], **p_e), sqrt=sqrt)
    step.equal(r"|L_m| = 2 d_1^3 (1 - e_z)\,\gamma", derived, length, root=sqrt)
    q12 = {}
    for name, right in (("q12_i", e[0] / (2 * g)), ("q12_j", e[1] / (2 * g)), ("q12_k", g)):
        label = {"q12_i": r"e_x / (2 \gamma)", "q12_j": r"e_y / (2 \gamma)", "q12_k": r"\gamma"}[name]
        step.equal(f"{paper.TEX[name]} = {label}", evaluate(rows[name], **p_e, L_m=length), right, unit)
        q12[name] = right
    image = rotation_matrix([sp.Integer(0), *q12.values()])
    step.equal(r"Q_{12} e_3 \tilde Q_{12} = e", image[:, 2], e, unit)

    rows = tables.printed["17"]
    along = [CA * a - SA * b for a, b in zip(e, cross(n, e), strict=True)]
    given = q12 | {f"pi_{a}": RHO * v for a, v in zip("xyz", n, strict=True)}
    given |= {f"p_w{a}": D * v for a, v in zip("xyz", along, strict=True)}
    given |= {"sqrt": known_root([RHO], unit)}
    c3 = evaluate(rows["c_3"], **given)
    step.equal(r"c_3 = (r_k^2 - r_w^2)/\gamma^2", c3, (r[3] ** 2 - r[0] ** 2) / g**2, unit)
    side = evaluate(rows["side"], **given)
    step.equal(r"\mathrm{side} = -2 |p| \sin_a\,r_w r_k/\gamma^2", side, -2 * D * SA * r[0] * r[3] / g**2, unit)
    # sigma r_k = |r_k|; `sign` is the sign of side, which equals the sign of -r_w r_k
    absolute_w, sign = sp.Symbol("abs_w", real=True), sp.Symbol("sign", real=True)
    signs = {"|r_w|^2 = r_w^2": (absolute_w, r[0] ** 2)} | unit
    sqrt = known_root([sigma * r[3] / g, absolute_w / g], signs)
    given = {"c_3": c3, "sqrt": sqrt, "sign": sign}
    q3_s, q3_k = evaluate(rows["q3_s"], **given), evaluate(rows["q3_k"], **given)
    step.equal(r"q_{3,scalar} = \sigma\,r_k/\gamma = |r_k|/\gamma", q3_s, sigma * r[3] / g, root=sqrt)
    step.equal(r"q_{3k} = |r_w| \,\mathrm{sign}/\gamma", q3_k, absolute_w * sign / g, root=sqrt)
    sqrt = known_root([2 * D * SA * absolute_w * sigma * r[3] / g**2], signs)
    side = -2 * D * SA * r[0] * r[3] / g**2
    given = {"side": side, "abs": lambda value: sqrt(value**2)}
    quotient = evaluate(rows["sign"], **given)
    statement = r"\mathrm{sign} = -\sigma\,r_w/|r_w|"
    step.equal(statement, quotient, -sigma * r[0] / absolute_w, signs, r", for $\mathrm{side} \neq 0$", root=sqrt)
    q3_k = q3_k.subs(sign, -sigma * r[0] / absolute_w)
    step.equal(r"q_{3k} = -\sigma\,r_w/\gamma", q3_k, -sigma * r[0] / g, signs)
    values = q12 | {"q3_s": sigma * r[3] / g, "q3_k": -sigma * r[0] / g}
    for component, part in zip(r, "wijk", strict=True):
        printed = evaluate(tables.printed["18"][f"qs_{part}"], **values)
        step.equal(rf"{TEX[f'qs_{part}']} = \sigma\,r_{part}", printed, sigma * component, unit)
    step.equal(r"r e_2 \tilde r = e \times (-n)", f, cross(e, [-v for v in n]), unit)
    return step


def factors(tables: Tables) -> Step:
    vectors = frame(tables)
    n, m, e, f = (vectors[v] for v in "nmef")
    step = Step("6. Four turns")
    product = turn("z", -U_Y, U_X) * turn("x", SE, CE)
    stages = [
        (r"R_z(\alpha + 90^\circ)\, R_x(\theta)", product, {2: (r"p/|p|", P_UNIT)}),
        (
            r"R_z(\alpha + 90^\circ)\, R_x(\theta)\, R_z(\phi)",
            product := product * turn("z", CP, SP),
            {0: ("-n", [-v for v in n]), 1: ("m", m), 2: (r"p/|p|", P_UNIT)},
        ),
        ("R", product * turn("x", CA, -SA), {0: ("-n", [-v for v in n]), 1: (r"e \times (-n)", f), 2: ("e", e)}),
    ]
    for label, matrix, expected in stages:
        for column, (name, vector) in expected.items():
            step.equal(rf"{label}\,e_{column + 1} = {name}", matrix[:, column], vector, CIRCLES)
    step.equal(r"f = e \times (-n)", f, cross(e, [-v for v in n]), CIRCLES)
    return step

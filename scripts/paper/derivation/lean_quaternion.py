# SPDX-License-Identifier: Apache-2.0
"""Steps 7 to 11 of docs/generated/lean.md: four rotations to one root, and its behaviour near singular poses."""

from __future__ import annotations

import itertools

import sympy as sp

from model.reference import cga
from scripts.paper.derivation.lean_forms import (
    HALVES,
    NAMES,
    SYMBOL,
    TEX,
    Tables,
    latex,
    line_tex,
    lines,
    symbols,
    tree,
)
from scripts.paper.derivation.lean_proofs import (
    ANGLES,
    C2,
    D1,
    D2,
    HALF_CIRCLE,
    S2,
    Relations,
    Step,
    rotation_matrix,
    run_lines,
    turn,
)
from scripts.paper.derivation.markdown import cell
from scripts.paper.derivation.printed import dot, evaluate


def half(tables: Tables) -> Step:
    c, s = symbols("c s")
    circle: Relations = {"c^2 + s^2 = 1": (s, 1 - c**2)}
    step = Step("7. Half an angle without a root")
    for branch, (text_c, text_s) in tables.half.items():
        h_c, h_s = evaluate(text_c, c=c, s=s), evaluate(text_s, c=c, s=s)
        size = (1 + c) / 2 if branch == "c >= 0" else (1 - c) / 2
        when = rf"\text{{ for }} {'c ge 0' if branch == 'c >= 0' else 'c < 0'}".replace(" ge ", r" \ge ")
        step.shown.append((rf"h(c, s){when}", rf"\left({line_tex(text_c)},\ {line_tex(text_s)}\right)"))
        step.equal(rf"|h|^2 = (1 + |c|)/2 {when}", h_c**2 + h_s**2, size, circle)
        step.equal(rf"h_c^2 - h_s^2 = |h|^2\,c {when}", h_c**2 - h_s**2, size * c, circle)
        step.equal(rf"2 h_c h_s = |h|^2\,s {when}", 2 * h_c * h_s, size * s, circle)
        large = ("h_c", h_c) if branch == "c >= 0" else ("h_s", h_s)
        step.equal(rf"{large[0]} = |h|^2 {when}", large[1], size)
    first, second = ([evaluate(v, c=sp.Integer(0), s=s) for v in pair] for pair in tables.half.values())
    at_0: Relations = {"s^2 = 1": (s, sp.Integer(1))}
    step.equal(r"\lim_{c \to -0} h = s\,h(0, s) \text{ with } s = \pm 1", second, [s * v for v in first], at_0)
    return step


def product_lines(tables: Tables, values: dict[str, sp.Expr]) -> list[sp.Expr]:
    result = run_lines(tables.lean, ["Product"], values)
    return [result[f"{name}_1"] for name in "wijk"]


def product(tables: Tables) -> Step:
    az_c, az_s, tilt_c, tilt_s, arm_c, arm_s = h = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")
    step = Step("8. The product of the four quaternions")
    given = {str(symbol): symbol for symbol in (*h, C2, S2)}
    lean = product_lines(tables, given)
    algebra = (
        cga.quaternion(az_c, 0, 0, az_s)
        * cga.quaternion(tilt_c, tilt_s, 0, 0)
        * cga.quaternion(C2, 0, 0, S2)
        * cga.quaternion(arm_c, -arm_s, 0, 0)
    )
    for name, value, right in zip("wijk", lean, cga.quaternion_coefficients(algebra), strict=True):
        right = sp.expand(sp.sympify(right))
        step.shown.append((f"{name}_1", latex(right)))
        part = "" if name == "w" else f"_{name}"
        four = r"\mathrm{az}\,\mathrm{tilt}\,h_\phi\,\widetilde{\mathrm{arm}}"
        step.equal(rf"{name}_1 = \langle {four}\rangle{part}", value, right)
    c, s = symbols("c s")
    circle: Relations = {"c^2 + s^2 = 1": (s, 1 - c**2)}
    for axis, branch in itertools.product("zx", tables.half):
        h_c, h_s = (evaluate(text, c=c, s=s) for text in tables.half[branch])
        size = (1 + c) / 2 if branch == "c >= 0" else (1 - c) / 2
        when = r"c \ge 0" if branch == "c >= 0" else "c < 0"
        matrix = rotation_matrix((h_c, 0, 0, h_s) if axis == "z" else (h_c, h_s, 0, 0))
        unit = "k" if axis == "z" else "i"
        statement = rf"M(h_c + h_s {unit}) = |h|^2 R_{axis}(c, s) \text{{ for }} {when}"
        step.equal(statement, matrix, size * turn(axis, c, s), circle)
    back = rotation_matrix((arm_c, -arm_s, 0, 0)) - rotation_matrix((arm_c, arm_s, 0, 0)).T
    step.equal(r"M(\widetilde{\mathrm{arm}}) = M(\mathrm{arm})^T", back, sp.zeros(3, 3))
    phi = rotation_matrix((C2, 0, 0, S2)) - turn("z", C2**2 - S2**2, 2 * C2 * S2)
    step.equal(r"M(\cos_h + \sin_h k) = R_z(\phi)", phi, sp.zeros(3, 3), HALF_CIRCLE)
    a, b = symbols("r_w r_i r_j r_k"), symbols("q_0 q_1 q_2 q_3")
    both = [sp.expand(sp.sympify(v)) for v in cga.quaternion_coefficients(cga.quaternion(*a) * cga.quaternion(*b))]
    product = rotation_matrix(a) * rotation_matrix(b)
    step.equal(r"M(r q) = M(r) M(q) \text{ for any } r, q", rotation_matrix(both), product)
    return step


def length(tables: Tables) -> Step:
    h = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")
    lengths = symbols("az_sq tilt_sq arm_sq")
    step = Step("9. The one root at the end")
    quaternion = product_lines(tables, {str(symbol): symbol for symbol in (*h, C2, S2)})
    relations: Relations = {
        rf"{TEX[f'{name}_c']}^2 + {TEX[f'{name}_s']}^2 = {TEX[f'{name}_sq']}": (
            h[2 * n + 1],
            lengths[n] - h[2 * n] ** 2,
        )
        for n, name in enumerate(HALVES)
    }
    name = "length_sq"
    t = run_lines({name: {name: lines(tables.lean)[name]}}, [name], {str(v): v for v in lengths})[name]
    step.equal("w_1^2 + i_1^2 + j_1^2 + k_1^2 = |q|^2", dot(quaternion, quaternion), t, relations | HALF_CIRCLE)
    for cosine, _, length in HALVES.values():
        c = evaluate(cosine, **ANGLES)
        derived = evaluate(lines(tables.lean)[length].replace("Abs(", "abs("), **ANGLES)
        step.equal(rf"{TEX[length]} = (1 + |{latex(c)}|)/2", derived, (1 + sp.Abs(c)) / 2)
    flat = [SYMBOL[cosine.removeprefix("-")] for cosine, _, _ in HALVES.values()]
    whole = run_lines(tables.lean, ["Lengths of the half angle quaternions, squared"], ANGLES)
    whole = t.subs({v: whole[str(v)] for v in lengths})
    corners = [whole.subs(dict(zip(flat, corner, strict=True))) for corner in itertools.product((0, 1), repeat=3)]
    straight = whole.subs({sp.Abs(v): v for v in flat})
    linear = all(sp.degree(straight, v) == 1 for v in flat)
    low, high = min(corners), max(corners)
    step.true(
        rf"{latex(low)} \le |q|^2 \le {latex(high)}",
        linear and (low, high) == (sp.Rational(1, 8), 1),
        f"$|q|^2$ is linear in each of {', '.join(f'${latex(sp.Abs(v))}$' for v in flat)}, so its extremes over "
        "$[0, 1]^3$ are among the 8 corners; evaluated there",
    )
    root, *q = symbols("length w_1 i_1 j_1 k_1")
    last = run_lines(tables.lean, ["Root, second level"], {str(v): v for v in (*lengths, *q)} | {"inv_q": 1 / root})
    step.equal("Q_s = q/|q|", [last[f"qs_{part}"] * root for part in "wijk"], q)
    return step


def shifts(tables: Tables) -> Step:
    step = Step("10. Roots of scaled arguments")
    k, v = sp.Symbol("k", integer=True), sp.Symbol("v", positive=True)
    ratio = sp.powdenest(sp.powsimp(2**k / sp.sqrt(4**k * v) * sp.sqrt(v)), force=True)
    step.true(r"1/\sqrt{v} = 2^k / \sqrt{4^k v}", sp.simplify(ratio) == 1, "expansion of powers, for an integer $k$")
    table = lines(tables.lean)
    results = ("u_x", "u_y", "sin_el", "cos_el", "qe_w", "qe_i", "cos_a", "sin_a")
    inputs = [n for g in ("Sums of the inputs", "Roots, first level") for n in tables.lean[g]] + ["x", "y", "z"]
    plain = run_lines(tables.lean, ["Directions", "Triangle"], {n: SYMBOL[n] for n in inputs})
    powers = {}  # 2^k_v
    for name in tables.lean["Roots, first level"]:
        argument = table[name].removeprefix("rsqrt(").removesuffix(")")
        powers[SYMBOL[f"shift_{argument}"]] = (SYMBOL[name], SYMBOL[argument])
    step.extra += ["| result | from mantissas, times |", "| --- | --- |"]
    ratios = []
    for name in results:
        exponent = sp.Integer(0)
        for shift, (root, argument) in powers.items():
            # root -> 2^k root of the mantissa, argument -> 4^-k mantissa
            exponent += shift * (sp.degree(plain[name], root) - 2 * sp.degree(plain[name], argument))
        step.extra.append(f"| ${TEX[name]} = {line_tex(table[name])}$ | $2^{{{latex(exponent)}}}$ |")
        two = {shift: sp.Symbol(f"two_{shift.name}", positive=True) for shift in powers}  # 2^k_v
        scaled = {root: two[shift] * root for shift, (root, _) in powers.items()}
        scaled |= {argument: argument / two[shift] ** 2 for shift, (_, argument) in powers.items()}
        whole = sp.prod(two[shift] ** exponent.coeff(shift) for shift in powers)
        ratio = sp.cancel(plain[name].subs(scaled, simultaneous=True) / plain[name])
        ratios.append((ratio, whole))
    step.equal(
        r"\text{powers of two of the table}",
        *(list(side) for side in zip(*ratios, strict=True)),
        more=", the scaled roots and arguments put into the lines",
    )
    return step


def near_singular(tables: Tables) -> Step:
    step = Step("11. Near the z axis, the stretched and the folded arm")
    inputs = {name: SYMBOL[name] for name in ("x", "y", "z", "d1", "d2")}
    sums = run_lines(tables.lean, ["Sums of the inputs"], inputs)
    group = list(tables.lean["Sums of the inputs"])
    whole = all(sp.Poly(sums[name]).domain == sp.ZZ for name in group)
    names = ", ".join(TEX[name] for name in group)
    step.true(rf"{names} \text{{ are integers}}", whole, "polynomials in the inputs with integer coefficients")
    for name in ("rho_sq", "s"):
        terms = sp.Poly(sums[name]).terms()
        good = all(c > 0 and all(n % 2 == 0 for n in powers) for powers, c in terms)
        step.true(rf"{TEX[name]} \text{{ has no negative term}}", good, "signs and powers of its terms")
    products = [n for g in ("Directions", "Triangle") for n in tables.lean[g]]
    none = all(not tree(lines(tables.lean)[n]).has(sp.Add) for n in products)
    names = ", ".join(TEX[n] for n in products)
    step.true(rf"{names} \text{{ are products}}", none, "no line has a sum")
    h = symbols("az_c az_s tilt_c tilt_s arm_c arm_s")
    quaternion = product_lines(tables, {str(symbol): symbol for symbol in (*h, C2, S2)})
    pairs = [h[0:2], h[2:4], h[4:6], [C2, S2]]
    linear = all(sum(powers) == 1 for part in quaternion for pair in pairs for powers in sp.Poly(part, *pair).monoms())
    step.true(
        r"q \text{ is linear in } \mathrm{az}, \mathrm{tilt}, \mathrm{arm}, (\cos_h, \sin_h) \text{ each}",
        linear,
        "degrees of the terms",
    )

    delta = SYMBOL["delta"]
    d1, d2 = sp.symbols("d_1 d_2", positive=True)
    dist = sp.Symbol("dist", positive=True)
    law = {D1: d1, D2: d2}
    s_of, a_far, b_near = (
        dist**2,
        *(
            sums[n].subs(inputs["x"], 0).subs(inputs["y"], 0).subs(inputs["z"], dist).subs(law)
            for n in ("a_far", "b_near")
        ),
    )
    sine = a_far * b_near / (4 * d1**2 * s_of)
    above, below = a_far / (2 * d1 * d2), b_near / (2 * d1 * d2)
    stretch, fold = {dist: (d1 + d2) * (1 - delta)}, {dist: (d1 - d2) * (1 + delta)}
    far, near = r"$|p| = (d_1 + d_2)(1 - \delta)$", r"$|p| = (d_1 - d_2)(1 + \delta)$"
    tmp1 = r"4\,\mathrm{tmp}_1 / (2 \rho d_1 |p|)^2"
    poses = [
        ("stretched", far, "1 + c_4", above.subs(stretch), "$A$, exact"),
        ("stretched", far, tmp1, sine.subs(stretch), "$A$ and $B$, exact"),
        ("folded", near, "1 - c_4", below.subs(fold), "$B$, exact"),
        ("folded", near, tmp1, sine.subs(fold), "$A$ and $B$, exact"),
        ("wrist near the z axis", r"$\delta$ from it", r"|\pi_{swivel}|/|p|", sp.sin(delta), r"$\rho^2$, exact"),
        ("elbow near the positive z axis", r"$\delta$ from it", "(d_1 - p_{ez})/d_1", 1 - sp.cos(delta), "not formed"),
        ("no turn about the upper arm", r"$\theta_3 = \delta$", "1 - c_3", 1 - sp.cos(delta), "not formed"),
    ]
    step.extra += ["| pose | | in the paper's form | size | in the lean form |", "| --- | --- | --- | --- | --- |"]
    for pose, where, name, value, lean in poses:
        value = sp.expand(sp.together(value))
        lead = sp.factor(value.as_leading_term(delta))
        coefficient, order = lead.as_coeff_exponent(delta)
        size = sp.latex(lead, symbol_names=NAMES | {d1: "d_1", d2: "d_2"})
        step.extra.append(f"| {pose} | {cell(where)} | ${cell(name)}$ | ${size}$ | {lean} |")
        limit = sp.simplify(sp.limit(value / delta**order, delta, 0) - coefficient)
        statement = rf"{name} = O(\delta{f'^{order}' if order > 1 else ''}) \text{{, {pose}}}"
        step.true(statement, order > 0 and limit == 0, "limit of the quotient by the power")
    return step

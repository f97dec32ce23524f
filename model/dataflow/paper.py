# SPDX-License-Identifier: Apache-2.0
"""The dataflow of ``rtl/paper``, written once: the paper's equations (10)-(19) as the RTL computes them.

Scale.  Four things are free in the equations and are used to keep words full, without touching a digit of the
result: the unit of length of the arms, the unit of length of the target in (11)-(13), the length of the swivel
plane's normal, and the length of L_m.  Each is chosen as a power of two by a count of leading sign bits
(:meth:`model.dataflow.nodes.Domain.normalize`), so small arms, targets near the shoulder, near the z axis and elbows
near the z axis lose no precision.
"""

from __future__ import annotations

import numpy as np

from model.dataflow.nodes import FLOOR, HALF_UP, JAM, Domain, Format, Node, room, wrap

SECTIONS = {
    "guard": "domain and scale",
    "swivel": "3.1 swivel plane",
    "elbow": "3.2 elbow point",
    "elbow_q": "3.3 elbow quaternion",
    "to_elbow": "3.4 rotate to the elbow position",
    "to_wrist": "3.5 rotate to the wrist location",
    "results": "what leaves the datapath",
}
"""Section name -> what it is; the RTL module is ``ik_<section>``, its instance in ``ik_paper`` is ``u_<section>``."""


def paper(d: Domain, target: dict[str, Node]) -> None:
    """The whole datapath: from the input words ``target`` (keys ``FIELDS`` of :mod:`model.targets.words`) to the
    results.

    Every node ends up in ``d.nodes`` under its name, which is also the name of its signal in the RTL.
    """
    guard(d, target)
    sections(d, target["phi"])


def sections(d: Domain, phi: Node) -> None:
    """Sections 3.1 to 3.5; ``d.nodes`` holds what :func:`guard` made."""
    swivel(d, phi)
    elbow(d)
    elbow_quaternion(d)
    rotate_to_elbow(d)
    rotate_to_wrist(d)
    results(d)


def half_of(words, clamp, clamped=0):
    """Without the last bit, which is or-ed into the place above it, so that a length never becomes 0; ``clamped`` of
    a clamped target."""
    return np.where(clamp, clamped, (words >> 1) | (words & 1))


def signed(magnitude, sign):
    """The magnitude with the sign of the other; 0 counts as positive."""
    return np.where(sign < 0, -magnitude, magnitude)


def guard(d: Domain, target: dict[str, Node]) -> None:
    """Decides exactly which targets lie outside the equations' domain, and scales what goes into them.

    The comparisons are exact: squares of input words, never rounded, therefore wider than ``W`` bits.
    """
    w = d.width
    x, y, z, d1, d2 = (target[k] for k in ("x", "y", "z", "d1", "d2"))
    d.at("guard")
    length = Format(w + 1, w - 2, "W - 2")
    exact = Format(2 * w + 2, 2 * w - 4, "2*W - 4")

    d.op("bad_length", (d1, d2), d.bit, "mux", lambda a, b: (a <= 0) | (b <= 0))
    d.op("on_axis", (x, y), d.bit, "mux", lambda a, b: (a == 0) & (b == 0))
    d.op("at_shoulder", (x, y, z), d.bit, "mux", lambda a, b, c: (a == 0) & (b == 0) & (c == 0))

    r_raw = d.op("r_raw", (d1, d2), length, "mux", lambda a, b: a + b)
    d_raw = d.op("d_raw", (d1, d2), length, "mux", lambda a, b: a - b)
    for name, word in (("x_sq", x), ("y_sq", y), ("z_sq", z), ("r_sq", r_raw), ("d_sq", d_raw)):
        d.op(name, (word,), exact, "mul", lambda a: a.astype(object) ** 2)
    d.op("xy_sq", ("x_sq", "y_sq"), exact, "mux", lambda a, b: a + b)
    d.op("s_raw", ("xy_sq", "z_sq"), exact, "mux", lambda a, b: a + b)
    d.op("too_far", ("s_raw", "r_sq", "bad_length"), d.bit, "mux", lambda s, r, bad: (s > r).astype(bool) & ~bad)
    d.op("too_near", ("s_raw", "d_sq", "bad_length"), d.bit, "mux", lambda s, q, bad: (s < q).astype(bool) & ~bad)

    # A clamped target has no elbow in the sense of (13): the arm is straight or folded along the line to the target.
    # It takes its way through all equations as the ordinary target of an arm with d1 = d2 = 1/4, and three things are
    # set from outside: p_e, c4 and the vector whose side decides the sign in (17).
    d.op("clamp", ("too_far", "too_near", "at_shoulder", "bad_length"), d.bit, "mux", lambda f, n, s, b: f | n | s | b)
    d.op("fold", ("too_near", "at_shoulder", "bad_length"), d.bit, "mux", lambda n, s, b: (n | s) & ~b)
    d.op("away", ("too_near", d_raw), d.bit, "mux", lambda n, q: n & (q < 0))

    # The target in a unit of length of its own; at the shoulder "straight up" is taken.
    lz_p = d.normalize(("p_w_z", "p_w_x", "p_w_y"), (z, x, y), "lz_p")
    # The horizontal direction of the target in a unit of its own; on the z axis azimuth 0 is taken.
    d.normalize(("b_x", "b_y"), (x, y), "lz_b")
    # The arms in a unit of length that brings d1 + d2 to [1/2, 1), and the target in the same unit.
    lz_r = d.op("lz_r", (r_raw,), d.unsigned(6, 0, "0"), "lzc", lambda r: np.where(r == 0, 0, room(r, w + 1)))
    mantissa = Format(w + 1, w, "W")
    quarter = 1 << (w - 3)
    for name, raw in (("d_1", d1), ("d_2", d2)):
        d.op(f"{name}_sh", (raw, lz_r), mantissa, "shift", lambda a, n: wrap(a << n, w + 1))
        d.op(name, (f"{name}_sh", "clamp"), d.word(0), "mux", lambda a, c: half_of(a, c, quarter), error=JAM)
    for axis, raw in (("x", x), ("y", y), ("z", z)):
        d.op(f"p_a_{axis}_sh", (raw, lz_r), mantissa, "shift", lambda a, n: wrap(a << n, w + 1))
        d.op(f"p_a_{axis}", (f"p_a_{axis}_sh", "clamp"), d.word(0), "mux", half_of, error=JAM)
    # d1 - d2 in the target's unit, from the exact difference: with rounded arms, a target close to the shoulder could
    # come to lie out of their reach.
    finer = Format(w + 1, w - 1, "W - 1")
    d.op("d_dif_sh", (d_raw, lz_p), finer, "shift", lambda a, n: wrap(a << n, w + 1))
    d.op("d_dif_j", ("d_dif_sh", "clamp"), d.word(1), "mux", lambda a, c: np.where(c, 0, a >> 1), error=FLOOR)
    # How much finer the target's own unit is than the arms': p_w = 2^j p_a.
    d.op("scale_j", (lz_p, lz_r, "clamp"), d.unsigned(6, 0, "0"), "mux", lambda p, r, c: np.where(c, 2, p - r + 1))


def swivel(d: Domain, phi: Node) -> None:
    """Section 3.1: |L_sw| (10) and the swivel plane (11).

    Every term of (11) has the target's horizontal direction (p_x, p_y) as a factor.  It is taken from
    (b_x, b_y) = 2^k (p_x, p_y), which gives the plane's normal another length and leaves the plane what it is.
    """
    n = d.nodes
    p_x, p_y, p_z, b_x, b_y = (n[k] for k in ("p_w_x", "p_w_y", "p_w_z", "b_x", "b_y"))
    d.at("swivel", "(10)")
    for axis, p in (("x", p_x), ("y", p_y), ("z", p_z)):
        d.mul(f"s_{axis}", p, p, d.wide(1))
    d.sum("s", n["s_x"], n["s_y"], n["s_z"], fmt=d.word(2))
    l_sw = d.root("l_sw", n["s"], d.word(1))

    d.at(equation="(11)")
    sin_h, cos_h = d.sincos("sin_h", "cos_h", phi)
    sin_phi = d.mul("sin_phi", sin_h, cos_h, d.word(1), scale=1)  # 2 cos(phi/2) sin(phi/2)
    d.mul("cos2_sq", cos_h, cos_h, d.wide(2), scale=1)  # 2 cos^2(phi/2): the square is missing in print
    cos_phi = d.sum("cos_phi", n["cos2_sq"], -d.constant(1.0, d.wide(2)), fmt=d.word(1))

    d.mul("a_x", p_z, b_x, d.word(1))
    d.mul("a_y", p_z, b_y, d.word(1))
    d.mul("rho_x", p_x, b_x, d.wide(2))
    d.mul("rho_y", p_y, b_y, d.wide(2))
    d.sum("rho", n["rho_x"], n["rho_y"], fmt=d.word(2))  # p_x^2 + p_y^2, with one factor each in b's scale
    d.mul("sa_x", sin_phi, n["a_x"], d.wide(2))
    d.mul("sa_y", sin_phi, n["a_y"], d.wide(2))
    d.mul("sa_z", sin_phi, n["rho"], d.wide(2))
    d.mul("cb_x", cos_phi, b_x, d.word(1))
    d.mul("cb_y", cos_phi, b_y, d.word(1))
    d.mul("lcb_x", l_sw, n["cb_x"], d.wide(2))
    d.mul("lcb_y", l_sw, n["cb_y"], d.wide(2))
    d.sum("pi_num_x", n["sa_x"], n["lcb_y"], fmt=d.wide(2))
    d.sum("pi_num_y", n["sa_y"], -n["lcb_x"], fmt=d.wide(2))
    d.sum("pi_num_z", d.constant(0.0, d.wide(2)), -n["sa_z"], fmt=d.wide(2), after=n["lcb_y"])
    for axis in "xyz":
        d.div(f"pi_swivel_{axis}", n[f"pi_num_{axis}"], l_sw, d.word(1))
    d.saturated("sat_swivel", "pi_swivel_x", "pi_swivel_y", "pi_swivel_z")


def elbow(d: Domain) -> None:
    """Section 3.2: the point pair (12), in the form (19), and the elbow point (13).

    PP is homogeneous.  As in (19) it is scaled by 2 throughout, and the target's own unit of length (2^j finer than
    the arms') is one more common factor; p_e comes out in the arms' unit.
    """
    n = d.nodes
    d.at("elbow", "(12)")
    # p_w^2 + d1^2 - d2^2 = p_w^2 + (d1 + d2)(d1 - d2), times 2^j
    d.op("d_sum", ("d_1", "d_2"), d.word(0), "mux", lambda a, b: a + b, lambda a, b: a + b)
    d.op("s_j", ("s", "scale_j"), d.word(2), "shift", lambda a, j: a >> j, lambda a, j: a * 2.0**-j, FLOOR)
    d.mul("dd_j", n["d_sum"], n["d_dif_j"], d.word(2))
    k_e = d.sum("k_e", n["s_j"], n["dd_j"], fmt=d.word(2))

    p = {a: n[f"p_w_{a}"] for a in "xyz"}
    pi = {a: n[f"pi_swivel_{a}"] for a in "xyz"}
    for unit, a in zip("ijk", "xyz", strict=True):
        d.mul(f"pp_{unit}", pi[a], k_e, d.word(3))
    d_1_sq = d.mul("d_1_sq", n["d_1"], n["d_1"], d.word(0))
    d.at(equation="(19)")
    for m, a, b in (("1", "z", "y"), ("2", "x", "z"), ("3", "y", "x")):
        d.mul(f"c_{m}_{a}{b}", p[a], pi[b], d.wide(2), scale=1)
        d.mul(f"c_{m}_{b}{a}", p[b], pi[a], d.wide(2), scale=1)
        d.sum(f"pp_{m}_m", n[f"c_{m}_{a}{b}"], -n[f"c_{m}_{b}{a}"], fmt=d.word(3))  # PP_m5 - PP_m4
        d.mul(f"pp_{m}_p", d_1_sq, n[f"pp_{m}_m"], d.word(3))  # PP_m5 + PP_m4
        d.mul(f"pp_{m}_pm", n[f"pp_{m}_p"], n[f"pp_{m}_m"], d.wide(5))

    d.at(equation="(13)")
    for m in "123":
        d.mul(f"pp_{m}_sq", n[f"pp_{m}_m"], n[f"pp_{m}_m"], d.wide(5))
    inf_pp = d.sum("inf_pp", n["pp_1_sq"], n["pp_2_sq"], n["pp_3_sq"], fmt=d.word(5))
    for unit in "ijk":
        d.mul(f"pp_{unit}_sq", n[f"pp_{unit}"], n[f"pp_{unit}"], d.wide(5))
    d.sum("pp_sq", n["pp_i_sq"], n["pp_j_sq"], n["pp_k_sq"], fmt=d.wide(5))
    d.sum("pp_pm", n["pp_1_pm"], n["pp_2_pm"], n["pp_3_pm"], fmt=d.wide(5))
    tmp1 = d.sum("tmp1", n["pp_pm"], -n["pp_sq"], fmt=d.word(3))
    tmp_sqr = d.root("tmp_sqr", tmp1, d.word(2))
    # Straight or folded to the last place: the target lies on the line of the arm and cannot tell a side in (17).
    d.op("flat", ("clamp", "tmp1"), d.bit, "mux", lambda c, t: c | (t <= 0))
    d.op("back", ("clamp", "away", "k_e"), d.bit, "mux", lambda c, a, k: np.where(c, a, k < 0))

    for axis, m, (u, mu), (v, mv) in (
        ("x", "1", ("k", "2"), ("j", "3")),
        ("y", "2", ("i", "3"), ("k", "1")),
        ("z", "3", ("j", "1"), ("i", "2")),
    ):
        d.mul(f"e_{axis}_{u}", n[f"pp_{u}"], n[f"pp_{mu}_m"], d.wide(5))
        d.mul(f"e_{axis}_{v}", n[f"pp_{v}"], n[f"pp_{mv}_m"], d.wide(5))
        d.sum(f"e_{axis}_pp", n[f"e_{axis}_{u}"], -n[f"e_{axis}_{v}"], fmt=d.wide(5))
        d.mul(f"e_{axis}_sqr", tmp_sqr, n[f"pp_{m}_m"], d.wide(5))
        d.sum(f"e_{axis}_num", n[f"e_{axis}_pp"], n[f"e_{axis}_sqr"], fmt=d.wide(5))
        d.div(f"e_{axis}_quo", n[f"e_{axis}_num"], inf_pp, d.word(1))
        # A clamped arm's elbow lies on the line to the target, at half its distance here.
        d.op(
            f"p_e_{axis}", (f"e_{axis}_quo", p[axis], "clamp", "away"), d.word(1), "mux",
            lambda q, t, c, a: np.where(c, np.where(a, -(t >> 2), t >> 2), q),
            lambda q, t, c, a: np.where(c, np.where(a, -t / 2, t / 2), q), JAM,
        )  # fmt: skip
    # (15) needs the length of the upper arm in the scale of p_e.
    d.op(
        "d_e", ("d_1", "l_sw", "clamp"), d.word(1), "mux",
        lambda a, b, c: np.where(c, b >> 1, a >> 1), lambda a, b, c: np.where(c, b / 2, a), FLOOR,
    )  # fmt: skip
    quotients = [f"e_{a}_{kind}" for kind in ("num", "quo") for a in "xyz"]
    d.saturated("sat_elbow", "k_e", "inf_pp", "pp_sq", "pp_pm", "tmp1", *quotients)


def elbow_quaternion(d: Domain) -> None:
    """Section 3.3: the elbow quaternion (14)."""
    n = d.nodes
    w = d.width
    d.at("elbow_q", "(14)")
    for a in "xyz":
        # p_e^2 - p_e p_w = p_e (p_e - p_w)
        d.op(
            f"f_{a}", (f"p_e_{a}", f"p_a_{a}"), d.word(1), "sum2",
            lambda e, p: np.clip(((e << 1) - p + 1) >> 1, -(1 << (w - 1)), (1 << (w - 1)) - 1), lambda e, p: e - p,
            HALF_UP,
        )  # fmt: skip
        d.mul(f"t_{a}", n[f"p_e_{a}"], n[f"f_{a}"], d.wide(1))
    t_e = d.sum("t_e", n["t_x"], n["t_y"], n["t_z"], fmt=d.word(-1))
    d_12 = d.mul("d_12", n["d_1"], n["d_2"], d.word(-1))
    d.div("c4_quo", t_e, d_12, d.word(1))
    one = 1 << (w - 2)
    d.op(
        "c4", ("c4_quo", "clamp", "fold"), d.word(1), "mux",
        lambda q, c, f: np.where(c, np.where(f, one, -one), q), lambda q, c, f: np.where(c, np.where(f, 1.0, -1.0), q),
    )  # fmt: skip
    _half(d, "h4_p", "c4", +1)
    _half(d, "h4_m", "c4", -1)
    d.root("qe_w", n["h4_p"], d.word(1))
    d.root("qe_abs", n["h4_m"], d.word(1))
    d.op("qe_i", ("qe_abs",), d.word(1), "mux", lambda a: -a, lambda a: -a)
    d.saturated("sat_elbow_q", "t_e", unless="clamp")


def _half(d: Domain, name: str, cosine: str, sign: int) -> None:
    """(1 + sign cosine) / 2 of (6) and (7), held in [0, 1]: an unsigned word, so that 1 fits."""
    w = d.width
    d.op(
        name, (cosine,), d.unsigned(w, w - 1, "W - 1"), "mux",
        lambda c: np.clip((1 << (w - 2)) + sign * c, 0, 1 << (w - 1)), lambda c: np.clip((1 + sign * c) / 2, 0, 1),
    )  # fmt: skip


def rotate_to_elbow(d: Domain) -> None:
    """Section 3.4: Q12 (15), the middle line L_m divided by its length.

    L_m = d1 (p_ex (d1 - p_ez), p_ey (d1 - p_ez), p_ex^2 + p_ey^2) may be scaled freely.  The factor d1 goes.  With the
    elbow above the shoulder, d1 - p_ez cancels; there p_ex^2 + p_ey^2 = (d1 - p_ez)(d1 + p_ez) allows to divide by
    d1 - p_ez: L_m ~ (p_ex, p_ey, d1 + p_ez).  With the elbow below, one factor (p_ex, p_ey) is scaled up to (u_x, u_y).
    On the z axis itself the first form is (0, 0, 2 d1) and the second (d1, 0, 0): never 0/0.
    """
    n = d.nodes
    d.at("to_elbow", "(15)")
    p_x, p_y = n["p_e_x"], n["p_e_y"]
    d.normalize(("u_x", "u_y"), (p_x, p_y), "lz_u")
    top = d.word(1).high  # of an arm that is all upper arm, h can be rounded to 2
    limited, free = lambda a, z: np.minimum(a + abs(z), top), lambda a, z: a + abs(z)
    h = d.op("h", ("d_e", "p_e_z"), d.word(1), "sum2", limited, free)
    d.mul("uh_x", n["u_x"], h, d.word(1))
    d.mul("uh_y", n["u_y"], h, d.word(1))
    d.mul("uu_x", n["u_x"], p_x, d.wide(1))
    d.mul("uu_y", n["u_y"], p_y, d.wide(1))
    d.sum("uu", n["uu_x"], n["uu_y"], fmt=d.word(1))
    for axis, low, high in (("x", "uh_x", p_x), ("y", "uh_y", p_y), ("z", "uu", h)):
        d.op(
            f"m_{axis}", ("p_e_z", low, high), d.word(1), "mux",
            lambda z, a, b: np.where(z < 0, a, b), lambda z, a, b: np.where(z < 0, a, b),
        )  # fmt: skip
    d.normalize(("l_m_z", "l_m_x", "l_m_y"), (n["m_z"], n["m_x"], n["m_y"]), "lz_m")
    for a in "xyz":
        d.mul(f"tmp2_{a}", n[f"l_m_{a}"], n[f"l_m_{a}"], d.wide(1))
    d.sum("tmp2", n["tmp2_x"], n["tmp2_y"], n["tmp2_z"], fmt=d.word(2))
    l_m = d.root("l_m", n["tmp2"], d.word(1))
    for unit, a in zip("ijk", "xyz", strict=True):
        d.div(f"q12_{unit}", n[f"l_m_{a}"], l_m, d.word(1))
    d.saturated("sat_to_elbow", "q12_i", "q12_j", "q12_k")


def rotate_to_wrist(d: Domain) -> None:
    """Section 3.5: theta_3 from the rotated y-z plane and the swivel plane (17), and Qs = Q12 Q3 (18)."""
    n = d.nodes
    pi_x, pi_y, pi_z = (n[f"pi_swivel_{a}"] for a in "xyz")
    q_i, q_j, q_k = (n[f"q12_{u}"] for u in "ijk")
    d.at("to_wrist", "(17)")
    # 1/|pi_swivel| is ready long before it is needed
    for a in "xyz":
        d.mul(f"pi_sq_{a}", n[f"pi_swivel_{a}"], n[f"pi_swivel_{a}"], d.wide(2))
    d.sum("pi_sq", n["pi_sq_x"], n["pi_sq_y"], n["pi_sq_z"], fmt=d.word(2))
    d.root("pi_abs", n["pi_sq"], d.word(1))
    pi_inv = d.div("pi_inv", d.constant(1.0, d.word(1)), n["pi_abs"], d.word(2))

    for u, q in (("i", q_i), ("j", q_j), ("k", q_k)):
        d.mul(f"q12_{u}_sq", q, q, d.wide(1))
    d.sum("r_x", n["q12_k_sq"], n["q12_j_sq"], -n["q12_i_sq"], fmt=d.word(1))
    d.mul("g_y", q_j, pi_y, d.wide(1))
    d.mul("g_z", q_k, pi_z, d.wide(1))
    d.sum("g", n["g_y"], n["g_z"], fmt=d.word(1))
    d.mul("c3_r", pi_x, n["r_x"], d.wide(1))
    d.mul("c3_g", q_i, n["g"], d.wide(1), scale=1)
    d.sum("c3_num", n["c3_r"], -n["c3_g"], fmt=d.word(1))
    d.mul("c3", n["c3_num"], pi_inv, d.word(1))

    # sign: on which side of the rotated plane the target lies.  A flat arm's target lies in the plane; there the
    # elbow's side of the line decides: -PP^- for a target in the direction of the elbow, +PP^- behind the shoulder.
    for a, m in (("x", "1"), ("y", "2"), ("z", "3")):
        d.op(
            f"side_{a}", (f"p_w_{a}", f"pp_{m}_m", "flat", "back"), d.word(0), "mux",
            lambda p, c, f, b: np.where(f, np.where(b, c, -c), p),
            lambda p, c, f, b: np.where(f, np.where(b, c, -c) / 8, p),
        )  # fmt: skip
    d.mul("sg_r", n["side_x"], n["r_x"], d.wide(1))
    d.mul("sg_y", q_j, n["side_y"], d.wide(1))
    d.mul("sg_z", q_k, n["side_z"], d.wide(1))
    d.sum("sg", n["sg_y"], n["sg_z"], fmt=d.word(1))
    d.mul("sg_g", q_i, n["sg"], d.wide(1), scale=1)
    d.sum("sign", n["sg_g"], -n["sg_r"], fmt=d.wide(1))

    _half(d, "h3_p", "c3", +1)
    _half(d, "h3_m", "c3", -1)
    q3_scalar = d.root("q3_scalar", n["h3_p"], d.word(1))
    d.root("q3_abs", n["h3_m"], d.word(1))
    # 0 counts as positive: both signs are right there.
    q3_k = d.op("q3_k", ("q3_abs", "sign"), d.word(1), "mux", signed, signed)

    d.at(equation="(18)")
    d.mul("w_kk", q_k, q3_k, d.wide(1))
    d.mul("i_is", q_i, q3_scalar, d.wide(1))
    d.mul("i_jk", q_j, q3_k, d.wide(1))
    d.mul("j_js", q_j, q3_scalar, d.wide(1))
    d.mul("j_ik", q_i, q3_k, d.wide(1))
    d.mul("k_ks", q_k, q3_scalar, d.wide(1))
    zero = d.constant(0.0, d.wide(1))
    d.sum("qs_w", zero, -n["w_kk"], fmt=d.word(1))
    d.sum("qs_i", n["i_is"], n["i_jk"], fmt=d.word(1))
    d.sum("qs_j", n["j_js"], -n["j_ik"], fmt=d.word(1))
    d.sum("qs_k", zero, n["k_ks"], fmt=d.word(1))
    d.saturated("sat_to_wrist", "c3_num")


def results(d: Domain) -> None:
    """The flag bits that leave with the quaternions; their order is in :mod:`model.targets.flags`."""
    d.at("results")
    names = [f"sat_{s}" for s in ("swivel", "elbow", "elbow_q", "to_elbow", "to_wrist")]
    d.op("saturated", names, d.bit, "mux", lambda *sats: np.logical_or.reduce(sats))

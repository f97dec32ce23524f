# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/paper`` after the elbow point, sections 3.3 to 3.5: the two quaternions (14)-(18)."""

import math

import numpy as np

from .annotations import COSINE, SAME, SQRT2, SQRT3, SUM, Case, Given, Growth, Limited, Rule, not_negative, upto, used
from .expressions import HALF_UP, Constant, Function, Select, Sum
from .formats import Format
from .nodes import SATURATE, Dataflow
from .paper_operations import Div, Mul, Root, Total, normalize


def forearm(c: Case) -> float:
    """Return an upper bound of |p_e - p_w|, which is d2 unless rounded lengths do not reach the target."""
    return math.sqrt((c.p_e + c.elbow) ** 2 + c.square) + 2 * c.ulp


FOREARM = Rule("|p_e - p_w| = d2 <= 1", used(upto(forearm)), used(upto(forearm)))
COSINE_LAW = (
    "|p_e (p_e - p_w)| = d1 d2 |cos| <= 1/4; rounded arms that do not reach lie on one line; clamped ones do not count"
)
SET_OUTSIDE = Limited("only of clamped targets, whose c4 is set from outside", clamped=True)
ULP = Limited("d1 d2 may be an ulp; the quotient saturates, and (14) limits it to [-1, 1]")
ARMS_PRODUCT = Rule("d1 d2 <= ((d1 + d2) / 2)^2", lambda c: (0.0, 0.25))


def elbow_quaternion(d: Dataflow) -> None:
    """Build section 3.3: the elbow quaternion (14)."""
    n = d.nodes
    rounded_sum = Growth(added=True)
    d.at("elbow_q", "(14)")

    for a in "xyz":
        # p_e^2 - p_e p_w = p_e (p_e - p_w)
        facts = {"rounding": HALF_UP, "ends": SATURATE, "within": FOREARM, "grows": rounded_sum}
        d.node(f"f_{a}", n[f"p_e_{a}"] - n[f"p_a_{a}"], d.word(1), "sum2", **facts)
        d.node(f"t_{a}", Mul(n[f"p_e_{a}"], n[f"f_{a}"]), d.wide(1))

    def rounding(c: Case) -> float:  # largest error of t_e = |p_e|^2 - p_e p_w
        own = 1.5 * d.wide(1).ulp + SQRT3 * d.word(1).ulp * c.p_e + 0.5 * d.word(-1).ulp
        return math.inf if c.clamped else c.square + c.straight + own

    law = Rule(COSINE_LAW, lambda c: c.t_e, error=rounding)
    t_e = d.node("t_e", Total(n["t_x"] + n["t_y"] + n["t_z"]), d.word(-1), within=law, limited=SET_OUTSIDE)
    d_12 = d.node("d_12", Mul(n["d_1"], n["d_2"]), d.word(-1), within=ARMS_PRODUCT)
    d.node("c4_quo", Div(t_e, d_12), d.word(1), limited=ULP)
    c4 = d.node("c4", Select(n["clamp"], Select(n["closed"], 1, -1), n["c4_quo"]), d.word(1), grows=SAME)
    _half(d, "h4_p", 1 + c4)
    _half(d, "h4_m", 1 - c4)
    d.node("qe_w", Root(n["h4_p"]), d.word(1))
    d.node("qe_abs", Root(n["h4_m"]), d.word(1))
    d.node("qe_i", -n["qe_abs"], d.word(1), grows=SAME)


def _half(d: Dataflow, name: str, twice: Sum) -> None:
    """Build (1 + c) / 2 or (1 - c) / 2 of (6) and (7), limited to [0, 1].  The word is unsigned, so that 1 fits."""
    fmt = Format(d.width, d.width - 1, "W - 1", signed=False)
    half = twice / 2
    limited = Function(lambda words: np.clip(words, 0, 1 << half.frac), "min(max({}, 0), 1)", half)
    d.node(name, limited, fmt, grows=Growth((0.5,), exact=True))


MANTISSA = Given("unit mantissa", upto(lambda c: 1.0))
ELBOW_SAME = Rule("u and p_e have the same direction", lambda c: (0.0, SQRT3 / 2 if c.clamped else c.p_e), not_negative)
ELBOW_UNIT = Rule(
    "|u| |p_xy| <= sqrt 2 |p_e|",
    lambda c: (0.0, SQRT2 * (SQRT3 / 2 if c.clamped else c.p_e)),
    used(lambda c: (-2 * c.ulp, SQRT2 * c.p_e_words + 4 * c.ulp)),
)
MIDDLE_SQ = Rule("squared length of a unit mantissa", lambda c: (0.25, 3.0))
MIDDLE = Rule("its root", lambda c: (0.5, SQRT3))
TURN = Rule("components of a vector of length 1", upto(lambda c: 1.0))
ALL_UPPER_ARM = Limited("d1 + |p_ez| of an arm that is all upper arm may be rounded to 2: the largest word")


def rotate_to_elbow(d: Dataflow) -> None:
    """Build section 3.4: Q12 (15), the middle line L_m divided by its length.

    L_m = d1 (p_ex (d1 - p_ez), p_ey (d1 - p_ez), p_ex^2 + p_ey^2) may be scaled freely, so the factor d1 is dropped.
    With the elbow above the shoulder, d1 - p_ez loses digits.  But p_ex^2 + p_ey^2 = (d1 - p_ez)(d1 + p_ez), so L_m is
    divided by d1 - p_ez: (p_ex, p_ey, d1 + p_ez).  With the elbow below, one factor (p_ex, p_ey) is scaled up to
    (u_x, u_y).  On the z axis the first form is (0, 0, 2 d1) and the second (d1, 0, 0), so 0/0 never occurs.
    """
    n = d.nodes
    d.at("to_elbow", "(15)")
    p_x, p_y = n["p_e_x"], n["p_e_y"]
    normalize(d, ("u_x", "u_y"), (p_x, p_y), "lz_u", MANTISSA)
    facts = {"ends": SATURATE, "grows": SUM, "limited": ALL_UPPER_ARM}
    h = d.node("h", n["d_e"] + Function(np.abs, "|{}|", n["p_e_z"]), d.word(1), "sum2", **facts)
    d.node("uh_x", Mul(n["u_x"], h), d.word(1))
    d.node("uh_y", Mul(n["u_y"], h), d.word(1))
    d.node("uu_x", Mul(n["u_x"], p_x), d.wide(1), within=ELBOW_SAME)
    d.node("uu_y", Mul(n["u_y"], p_y), d.wide(1), within=ELBOW_SAME)
    d.node("uu", Total(n["uu_x"] + n["uu_y"]), d.word(1), within=ELBOW_UNIT)
    for axis, low, high in (("x", n["uh_x"], p_x), ("y", n["uh_y"], p_y), ("z", n["uu"], h)):
        d.node(f"m_{axis}", Select(n["p_e_z"] < 0, low, high), d.word(1), grows=SAME)
    normalize(d, ("l_m_z", "l_m_x", "l_m_y"), (n["m_z"], n["m_x"], n["m_y"]), "lz_m", MANTISSA)
    for a in "xyz":
        d.node(f"tmp2_{a}", Mul(n[f"l_m_{a}"], n[f"l_m_{a}"]), d.wide(1))
    d.node("tmp2", Total(n["tmp2_x"] + n["tmp2_y"] + n["tmp2_z"]), d.word(2), within=MIDDLE_SQ)
    l_m = d.node("l_m", Root(n["tmp2"]), d.word(1), within=MIDDLE)
    for unit, a in zip("ijk", "xyz", strict=True):
        d.node(f"q12_{unit}", Div(n[f"l_m_{a}"], l_m), d.word(1), within=TURN)


PLANE_SQ = Rule("|pi_swivel| = |b|, squared, with |b| in [1/2, sqrt 2]", lambda c: (c.b[0] ** 2, c.b[1] ** 2))
PLANE_LENGTH = Rule("|pi_swivel| = |b|", lambda c: c.b)
PLANE_INVERSE = Rule("1/|pi_swivel| = 1/|b|", lambda c: (1 / c.b[1], 1 / c.b[0]))
TURNED = Rule("(q_k^2 + q_j^2) - q_i^2, and the three make 1", upto(lambda c: 1.0))
PART = Rule("|(q_j, q_k)| |pi_swivel| <= sqrt 2", upto(lambda c: c.b[1]))
PRODUCT = Rule(
    "2 |q_i| |(q_j, q_k)| <= 1, so the product is no longer than the vector: |pi_swivel| <= sqrt 2",
    upto(lambda c: c.b[1]),
)
ROTATED = Rule("pi_swivel times a unit vector", upto(lambda c: c.b[1]))
SIDE_PART = Rule("|(q_j, q_k)| |side| <= sqrt 3", upto(lambda c: SQRT3))
SIDE_PRODUCT = Rule("the same with |side| <= sqrt 3", upto(lambda c: SQRT3))
SIDE = Rule("the side vector times a unit vector", upto(lambda c: SQRT3))
RESULT = Rule("q_i c + q_j s, with c^2 + s^2 = 1", upto(lambda c: 1.0))


def rotate_to_wrist(d: Dataflow) -> None:
    """Build section 3.5: theta_3 from the rotated y-z plane and the swivel plane (17), and Qs = Q12 Q3 (18)."""
    n = d.nodes
    pi_x, pi_y, pi_z = (n[f"pi_swivel_{a}"] for a in "xyz")
    q_i, q_j, q_k = (n[f"q12_{u}"] for u in "ijk")
    d.at("to_wrist", "(17)")
    # 1/|pi_swivel| is ready long before its use
    for a in "xyz":
        d.node(f"pi_sq_{a}", Mul(n[f"pi_swivel_{a}"], n[f"pi_swivel_{a}"]), d.wide(2))
    d.node("pi_sq", Total(n["pi_sq_x"] + n["pi_sq_y"] + n["pi_sq_z"]), d.word(2), within=PLANE_SQ)
    d.node("pi_abs", Root(n["pi_sq"]), d.word(1), within=PLANE_LENGTH)
    pi_inv = d.node("pi_inv", Div(Constant(1), n["pi_abs"]), d.word(2), within=PLANE_INVERSE)

    for u, q in (("i", q_i), ("j", q_j), ("k", q_k)):
        d.node(f"q12_{u}_sq", Mul(q, q), d.wide(1))
    d.node("r_x", Total(n["q12_k_sq"] + n["q12_j_sq"] - n["q12_i_sq"]), d.word(1), within=TURNED)
    d.node("g_y", Mul(q_j, pi_y), d.wide(1))
    d.node("g_z", Mul(q_k, pi_z), d.wide(1))
    d.node("g", Total(n["g_y"] + n["g_z"]), d.word(1), within=PART)
    d.node("c3_r", Mul(pi_x, n["r_x"]), d.wide(1))
    d.node("c3_g", Mul(q_i, n["g"], scale=1), d.wide(1), within=PRODUCT)
    d.node("c3_num", Total(n["c3_r"] - n["c3_g"]), d.word(1), within=ROTATED)
    d.node("c3", Mul(n["c3_num"], pi_inv), d.word(1), within=COSINE)

    # sign: the side of the rotated plane on which the target lies.  The target of a flat arm lies in the plane.  Then
    # the vector -PP^- decides if the target is in the direction of the elbow, +PP^- if it is behind the shoulder.
    scaled = Growth((1 / 8, 1.0), exact=True)
    for a, m in (("x", "1"), ("y", "2"), ("z", "3")):
        line = n[f"pp_{m}_m"] / 8
        side = Select(n["flat"], Select(n["back"], line, -line), n[f"p_w_{a}"])
        d.node(f"side_{a}", side, d.word(0), grows=scaled)
    d.node("sg_r", Mul(n["side_x"], n["r_x"]), d.wide(1))
    d.node("sg_y", Mul(q_j, n["side_y"]), d.wide(1))
    d.node("sg_z", Mul(q_k, n["side_z"]), d.wide(1))
    d.node("sg", Total(n["sg_y"] + n["sg_z"]), d.word(1), within=SIDE_PART)
    d.node("sg_g", Mul(q_i, n["sg"], scale=1), d.wide(1), within=SIDE_PRODUCT)
    d.node("sign", Total(n["sg_g"] - n["sg_r"]), d.wide(1), within=SIDE)

    _half(d, "h3_p", 1 + n["c3"])
    _half(d, "h3_m", 1 - n["c3"])
    q3_scalar = d.node("q3_scalar", Root(n["h3_p"]), d.word(1))
    d.node("q3_abs", Root(n["h3_m"]), d.word(1))
    # 0 counts as positive: either sign is correct there.
    q3_k = d.node("q3_k", Select(n["sign"] < 0, -n["q3_abs"], n["q3_abs"]), d.word(1), grows=SAME)

    d.at(equation="(18)")
    d.node("w_kk", Mul(q_k, q3_k), d.wide(1))
    d.node("i_is", Mul(q_i, q3_scalar), d.wide(1))
    d.node("i_jk", Mul(q_j, q3_k), d.wide(1))
    d.node("j_js", Mul(q_j, q3_scalar), d.wide(1))
    d.node("j_ik", Mul(q_i, q3_k), d.wide(1))
    d.node("k_ks", Mul(q_k, q3_scalar), d.wide(1))
    zero = Constant(0)
    d.node("qs_w", Total(zero - n["w_kk"]), d.word(1))
    d.node("qs_i", Total(n["i_is"] + n["i_jk"]), d.word(1), within=RESULT)
    d.node("qs_j", Total(n["j_js"] - n["j_ik"]), d.word(1), within=RESULT)
    d.node("qs_k", Total(zero + n["k_ks"]), d.word(1))

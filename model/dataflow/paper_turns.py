# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/paper`` from the elbow point on, sections 3.3 to 3.5: the two quaternions (14)-(18)."""

import math

import numpy as np

from .annotations import COSINE, SAME, SQRT2, SQRT3, SUM, Case, Given, Growth, Limited, Rule, not_negative, upto, used
from .nodes import HALF_UP, Domain, Format
from .operations import round_shift, saturate


def signed(magnitude, sign):
    """Return the magnitude with the sign of the other operand; 0 counts as positive."""
    return np.where(sign < 0, -magnitude, magnitude)


def forearm(c: Case) -> float:
    """Return |p_e - p_w|^2 = d2^2, or d2^2 + |p_e|^2 - d1^2 where rounded arms do not reach."""
    return math.sqrt((c.p_e + c.elbow) ** 2 + c.square) + 2 * c.ulp


FOREARM = Rule("|p_e - p_w| = d2 <= 1", used(upto(forearm)), used(upto(forearm)))
COSINE_LAW = (
    "|p_e (p_e - p_w)| = d1 d2 |cos| <= 1/4; rounded arms that do not reach lie on one line; clamped ones do not count"
)
SET_OUTSIDE = Limited("only of clamped targets, whose c4 is set from outside", clamped=True)
ULP = Limited("d1 d2 may be an ulp; the quotient saturates, and (14) limits it to [-1, 1]")
ARMS_PRODUCT = Rule("d1 d2 <= ((d1 + d2) / 2)^2", lambda c: (0.0, 0.25))


def elbow_quaternion(d: Domain) -> None:
    """Section 3.3: the elbow quaternion (14)."""
    n = d.nodes
    top, one, rounded_sum = d.word(1).high, 1 << (d.width - 2), Growth(added=True)
    d.at("elbow_q", "(14)")

    def less(e, p):
        return saturate(round_shift((e << 1) - p, 1), top, ~top)

    for a in "xyz":
        # p_e^2 - p_e p_w = p_e (p_e - p_w)
        d.op(f"f_{a}", (f"p_e_{a}", f"p_a_{a}"), d.word(1), less, "sum2", HALF_UP, within=FOREARM, grows=rounded_sum)
        d.mul(f"t_{a}", n[f"p_e_{a}"], n[f"f_{a}"], d.wide(1))

    def rounding(c: Case) -> float:  # of |p_e|^2 - p_e p_w, whose error is the square's
        own = 1.5 * d.wide(1).ulp + SQRT3 * d.word(1).ulp * c.p_e + 0.5 * d.word(-1).ulp
        return math.inf if c.clamped else c.square + c.straight + own

    law = Rule(COSINE_LAW, lambda c: c.t_e, error=rounding)
    t_e = d.sum("t_e", n["t_x"], n["t_y"], n["t_z"], fmt=d.word(-1), within=law, limited=SET_OUTSIDE)
    d_12 = d.mul("d_12", n["d_1"], n["d_2"], d.word(-1), within=ARMS_PRODUCT)
    d.div("c4_quo", t_e, d_12, d.word(1), limited=ULP)
    given = ("c4_quo", "clamp", "fold")
    d.op("c4", given, d.word(1), lambda q, c, f: np.where(c, np.where(f, one, -one), q), grows=SAME)
    _half(d, "h4_p", "c4", +1)
    _half(d, "h4_m", "c4", -1)
    d.root("qe_w", n["h4_p"], d.word(1))
    d.root("qe_abs", n["h4_m"], d.word(1))
    d.op("qe_i", ("qe_abs",), d.word(1), lambda a: -a, grows=SAME)


def _half(d: Domain, name: str, cosine: str, sign: int) -> None:
    """Compute (1 + sign cosine) / 2 of (6) and (7), limited to [0, 1]: an unsigned word, so that 1 fits."""
    one, fmt = 1 << (d.width - 1), Format(d.width, d.width - 1, "W - 1", signed=False)
    grows = Growth((0.5,), exact=True)
    d.op(name, (cosine,), fmt, lambda c: np.clip(one // 2 + sign * c, 0, one), grows=grows)


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


def rotate_to_elbow(d: Domain) -> None:
    """Section 3.4: Q12 (15), the middle line L_m divided by its length.

    L_m = d1 (p_ex (d1 - p_ez), p_ey (d1 - p_ez), p_ex^2 + p_ey^2) may be scaled freely.  The factor d1 is dropped.
    With the elbow above the shoulder, d1 - p_ez cancels; there p_ex^2 + p_ey^2 = (d1 - p_ez)(d1 + p_ez) permits
    division by d1 - p_ez: L_m ~ (p_ex, p_ey, d1 + p_ez).  With the elbow below, one factor (p_ex, p_ey) is scaled up to
    (u_x, u_y). On the z axis itself the first form is (0, 0, 2 d1) and the second (d1, 0, 0): never 0/0.
    """
    n = d.nodes
    d.at("to_elbow", "(15)")
    p_x, p_y = n["p_e_x"], n["p_e_y"]
    d.normalize(("u_x", "u_y"), (p_x, p_y), "lz_u", within=MANTISSA)
    top = d.word(1).high
    both = ("d_e", "p_e_z")
    h = d.op("h", both, d.word(1), lambda a, z: saturate(a + abs(z), top), "sum2", grows=SUM, limited=ALL_UPPER_ARM)
    d.mul("uh_x", n["u_x"], h, d.word(1))
    d.mul("uh_y", n["u_y"], h, d.word(1))
    d.mul("uu_x", n["u_x"], p_x, d.wide(1), within=ELBOW_SAME)
    d.mul("uu_y", n["u_y"], p_y, d.wide(1), within=ELBOW_SAME)
    d.sum("uu", n["uu_x"], n["uu_y"], fmt=d.word(1), within=ELBOW_UNIT)
    for axis, low, high in (("x", "uh_x", p_x), ("y", "uh_y", p_y), ("z", "uu", h)):
        d.op(f"m_{axis}", ("p_e_z", low, high), d.word(1), lambda z, a, b: np.where(z < 0, a, b), grows=SAME)
    d.normalize(("l_m_z", "l_m_x", "l_m_y"), (n["m_z"], n["m_x"], n["m_y"]), "lz_m", within=MANTISSA)
    for a in "xyz":
        d.mul(f"tmp2_{a}", n[f"l_m_{a}"], n[f"l_m_{a}"], d.wide(1))
    d.sum("tmp2", n["tmp2_x"], n["tmp2_y"], n["tmp2_z"], fmt=d.word(2), within=MIDDLE_SQ)
    l_m = d.root("l_m", n["tmp2"], d.word(1), within=MIDDLE)
    for unit, a in zip("ijk", "xyz", strict=True):
        d.div(f"q12_{unit}", n[f"l_m_{a}"], l_m, d.word(1), within=TURN)


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


def rotate_to_wrist(d: Domain) -> None:
    """Section 3.5: theta_3 from the rotated y-z plane and the swivel plane (17), and Qs = Q12 Q3 (18)."""
    n = d.nodes
    pi_x, pi_y, pi_z = (n[f"pi_swivel_{a}"] for a in "xyz")
    q_i, q_j, q_k = (n[f"q12_{u}"] for u in "ijk")
    d.at("to_wrist", "(17)")
    # 1/|pi_swivel| is ready long before its use
    for a in "xyz":
        d.mul(f"pi_sq_{a}", n[f"pi_swivel_{a}"], n[f"pi_swivel_{a}"], d.wide(2))
    d.sum("pi_sq", n["pi_sq_x"], n["pi_sq_y"], n["pi_sq_z"], fmt=d.word(2), within=PLANE_SQ)
    d.root("pi_abs", n["pi_sq"], d.word(1), within=PLANE_LENGTH)
    pi_inv = d.div("pi_inv", d.constant(1.0, d.word(1)), n["pi_abs"], d.word(2), within=PLANE_INVERSE)

    for u, q in (("i", q_i), ("j", q_j), ("k", q_k)):
        d.mul(f"q12_{u}_sq", q, q, d.wide(1))
    d.sum("r_x", n["q12_k_sq"], n["q12_j_sq"], -n["q12_i_sq"], fmt=d.word(1), within=TURNED)
    d.mul("g_y", q_j, pi_y, d.wide(1))
    d.mul("g_z", q_k, pi_z, d.wide(1))
    d.sum("g", n["g_y"], n["g_z"], fmt=d.word(1), within=PART)
    d.mul("c3_r", pi_x, n["r_x"], d.wide(1))
    d.mul("c3_g", q_i, n["g"], d.wide(1), scale=1, within=PRODUCT)
    d.sum("c3_num", n["c3_r"], -n["c3_g"], fmt=d.word(1), within=ROTATED)
    d.mul("c3", n["c3_num"], pi_inv, d.word(1), within=COSINE)

    # sign: the side of the rotated plane on which the target lies.  A flat arm's target lies in the plane; there the
    # elbow's side of the line decides: -PP^- for a target in the direction of the elbow, +PP^- behind the shoulder.
    scaled = Growth((1.0, 1 / 8, 0.0, 0.0), exact=True)
    for a, m in (("x", "1"), ("y", "2"), ("z", "3")):
        either = (f"p_w_{a}", f"pp_{m}_m", "flat", "back")
        d.op(f"side_{a}", either, d.word(0), lambda p, c, f, b: np.where(f, np.where(b, c, -c), p), grows=scaled)
    d.mul("sg_r", n["side_x"], n["r_x"], d.wide(1))
    d.mul("sg_y", q_j, n["side_y"], d.wide(1))
    d.mul("sg_z", q_k, n["side_z"], d.wide(1))
    d.sum("sg", n["sg_y"], n["sg_z"], fmt=d.word(1), within=SIDE_PART)
    d.mul("sg_g", q_i, n["sg"], d.wide(1), scale=1, within=SIDE_PRODUCT)
    d.sum("sign", n["sg_g"], -n["sg_r"], fmt=d.wide(1), within=SIDE)

    _half(d, "h3_p", "c3", +1)
    _half(d, "h3_m", "c3", -1)
    q3_scalar = d.root("q3_scalar", n["h3_p"], d.word(1))
    d.root("q3_abs", n["h3_m"], d.word(1))
    # 0 counts as positive: either sign is correct there.
    q3_k = d.op("q3_k", ("q3_abs", "sign"), d.word(1), signed, grows=SAME)

    d.at(equation="(18)")
    d.mul("w_kk", q_k, q3_k, d.wide(1))
    d.mul("i_is", q_i, q3_scalar, d.wide(1))
    d.mul("i_jk", q_j, q3_k, d.wide(1))
    d.mul("j_js", q_j, q3_scalar, d.wide(1))
    d.mul("j_ik", q_i, q3_k, d.wide(1))
    d.mul("k_ks", q_k, q3_scalar, d.wide(1))
    zero = d.constant(0.0, d.wide(1))
    d.sum("qs_w", zero, -n["w_kk"], fmt=d.word(1))
    d.sum("qs_i", n["i_is"], n["i_jk"], fmt=d.word(1), within=RESULT)
    d.sum("qs_j", n["j_js"], -n["j_ik"], fmt=d.word(1), within=RESULT)
    d.sum("qs_k", zero, n["k_ks"], fmt=d.word(1))

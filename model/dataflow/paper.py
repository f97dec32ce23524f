# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/paper``: the paper's equations (10)-(19) as the RTL computes them.

Scale.  Four scales in the equations are free, because they do not change the result: the unit of length of d1 and d2,
the unit of length of the target in (11)-(13), the length of the swivel plane's normal, and the length of L_m.  Each is
a power of two, chosen by a count of leading sign bits so that the words are full.  Therefore no precision is
lost for short arms, for targets near the shoulder or the z axis, and for elbows near the z axis.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .expressions import FLOOR, HALF_UP, JAM, Constant, Floor, Function, Select, Sum, square, zero
from .formats import Format
from .lean_operations import ShiftDown, ShiftUp
from .nodes import ANYTHING, SAME, SATURATE, SUM, Dataflow, Given, Growth, Interval, Limited, Node, Rule
from .paper_operations import Div, Mul, Root, SineCosine, Total, leading_bits, normalize

SQRT3 = math.sqrt(3)

SECTIONS = {
    "guard": "domain and scale",
    "swivel": "3.1 swivel plane",
    "elbow": "3.2 elbow point",
    "elbow_q": "3.3 elbow quaternion",
    "to_elbow": "3.4 rotate to the elbow position",
    "to_wrist": "3.5 rotate to the wrist location",
}
"""Section name -> description; the RTL module is ``ik_<section>``, its instance in ``ik_paper`` is ``u_<section>``."""


def paper(d: Dataflow, target: dict[str, Node]) -> None:
    """Build all nodes of the datapath, from the input words ``target`` (keys ``FIELDS`` of :mod:`model.io.words`) to
    the results.  A node and its signal in the RTL have the same name."""
    guard(d, target)
    swivel(d, target["phi"])
    elbow(d)
    elbow_quaternion(d)
    rotate_to_elbow(d)
    rotate_to_wrist(d)


def upto(size: Callable[[Any], float]) -> Callable[[Any], Interval]:
    """Return the function case -> range [-size(case), size(case)]."""
    return lambda c: (-size(c), size(c))


def used(limit: Callable[[Any], Interval]) -> Callable[[Any], Interval]:
    """Return ``limit``, changed to permit any word for a clamped target, where the word is unused and may wrap."""
    return lambda c: ANYTHING if c.clamped else limit(c)


def not_negative(case) -> Interval:
    """Return the range of a word that rounding never makes negative."""
    return 0.0, math.inf


# The constants before a section are its nodes' ranges in exact arithmetic in each case, from geometry, with the reason.

CLAMPED = Given("", lambda c: (int(c.clamped), int(c.clamped)))
REACHABLE = Given("", lambda c: (0, int(c.clamped)))
TARGET_UNIT = Given("unit mantissa", upto(lambda c: c.p[1]))
DIRECTION_UNIT = Given("unit mantissa", upto(lambda c: c.b[1]))
IN_REACH_SH = Given("in reach: |p| <= d1 + d2", used(lambda c: (c.ulp / 2 - 1, 1)))
IN_REACH = Given("in reach: |p| <= d1 + d2", lambda c: (0, 0) if c.clamped else (-1, 1))
NOT_NEAR_SH = Given("not too near", used(upto(lambda c: c.p[1])))
NOT_NEAR = Rule(
    "|d1 - d2| <= |p|, in the target's unit <= |p_w| <= sqrt 3",
    lambda c: (0.0, 0.0) if c.clamped else (-c.p[1], c.p[1]),
)
UNITS = Given("target's unit", lambda c: c.j)
ARM_SH = Given("arms' unit", used(lambda c: (c.ulp, c.d_high)))
ARM = Given("arms' unit", lambda c: (0.25, 0.25) if c.clamped else (c.ulp, c.d_high - c.ulp * c.long))


def guard(d: Dataflow, target: dict[str, Node]) -> None:
    """Build the flags of targets outside the equations' domain, and the scaled operands of the equations.

    The flags are exact, because the compared squares are not rounded.
    """
    w, n = d.width, d.nodes
    x, y, z, d1, d2 = (target[k] for k in ("x", "y", "z", "d1", "d2"))
    d.at("guard")
    length = Format(w + 1, w - 2, "W - 2")
    exact = Format(2 * w + 2, 2 * w - 4, "2*W - 4")

    bad_length = d.mask("bad_length", (d1 <= 0) | (d2 <= 0), within=REACHABLE)
    d.mask("on_axis", zero(x) & zero(y))
    at_shoulder = d.mask("at_shoulder", zero(x) & zero(y) & zero(z), within=REACHABLE)

    r_raw = d.node("r_raw", d1 + d2, length)
    d_raw = d.node("d_raw", d1 - d2, length)
    for name, word in (("x_sq", x), ("y_sq", y), ("z_sq", z), ("r_sq", r_raw), ("d_sq", d_raw)):
        d.node(name, square(word), exact, "mul")
    d.node("xy_sq", n["x_sq"] + n["y_sq"], exact)
    s_raw = d.node("s_raw", n["xy_sq"] + n["z_sq"], exact)
    too_far = d.mask("too_far", (s_raw > n["r_sq"]) & ~bad_length, within=REACHABLE)
    too_near = d.mask("too_near", (s_raw < n["d_sq"]) & ~bad_length, within=REACHABLE)

    # A clamped target has no elbow in the sense of (13): the arm is straight or closed along the line to the target.
    # All equations treat it as an ordinary target of an arm with d1 = d2 = 1/4, and then these values are replaced:
    # p_e with its length d_e, c4, and the vector that decides the sign in (17).
    clamp = d.mask("clamp", too_far | too_near | at_shoulder | bad_length, within=CLAMPED)
    d.mask("closed", (too_near | at_shoulder) & ~bad_length, within=REACHABLE)
    d.mask("away", too_near & (d_raw < 0), within=REACHABLE)

    # The target in its own unit of length; a target at the shoulder becomes "straight up".
    lz_p = normalize(d, ("p_w_z", "p_w_x", "p_w_y"), (z, x, y), "lz_p", TARGET_UNIT)
    # The target's horizontal direction in its own unit; on the z axis the azimuth is 0.
    normalize(d, ("b_x", "b_y"), (x, y), "lz_b", DIRECTION_UNIT)
    # The lengths in a unit that brings d1 + d2 to [1/2, 1), and the target in the same unit.
    lz_r = d.node("lz_r", leading_bits(r_raw), d.count, "lzc", within=Given("leading sign bits", lambda c: (0, w)))
    mantissa = Format(w + 1, w, "W")
    for name, raw in (("d_1", d1), ("d_2", d2)):
        shifted = d.node(f"{name}_sh", ShiftUp(raw, lz_r, -2), mantissa, "shift", within=ARM_SH)
        d.node(name, Select(clamp, Constant(0.25), shifted), d.word(0), rounding=JAM, within=ARM)
    for axis, raw in (("x", x), ("y", y), ("z", z)):
        shifted = d.node(f"p_a_{axis}_sh", ShiftUp(raw, lz_r, -2), mantissa, "shift", within=IN_REACH_SH)
        d.node(f"p_a_{axis}", Select(clamp, 0, shifted), d.word(0), rounding=JAM, within=IN_REACH)
    # d1 - d2 in the target's unit, from the exact difference: rounded lengths could put a target close to the shoulder
    # out of reach.
    finer = Format(w + 1, w - 1, "W - 1")
    shifted = d.node("d_dif_sh", ShiftUp(d_raw, lz_p, -1), finer, "shift", within=NOT_NEAR_SH)
    d.node("d_dif_j", Select(clamp, 0, shifted), d.word(1), rounding=FLOOR, within=NOT_NEAR)
    # Ratio of the two units: p_w = 2^j p_a.
    d.node("scale_j", Select(clamp, 2, lz_p - lz_r + 1), d.count, within=UNITS)


COSINE = Rule("a sine or cosine", lambda c: (-1.0, 1.0))
UNIT_SQ = Rule(
    "a vector shifted until its largest component fills the word has that component in [1/2, 1], so its squared "
    "length is in [1/4, 3] (with two components: at most 2)",
    lambda c: (c.p[0] ** 2, c.p[1] ** 2),
)
UNIT = Rule("the root of the squared length: |p_w| and |L_m| are in [1/2, sqrt 3]", lambda c: c.p)
COSINE_SQ = Rule("a squared cosine, doubled", lambda c: (0.0, 2.0))
SAME_DIRECTION = Rule(
    "p_w and b are the same target in two units, so each p_x b_x >= 0 and the sum is |p_xy| |b| <= 2",
    lambda c: (0.0, min(2.0, c.p[1] * c.b[1])),
    not_negative,
)
PLANE_NUM = Rule("|pi_swivel| = |b|, before the division by |L_sw| <= sqrt 3", upto(lambda c: c.p[1] * c.b[1]))
PLANE = Rule(
    "the two terms of (11) are orthogonal and of length |b| |sin phi| and |b| |cos phi|, and |b| <= sqrt 2",
    upto(lambda c: c.b[1]),
)


def swivel(d: Dataflow, phi: Node) -> None:
    """Build section 3.1: |L_sw| (10) and the swivel plane (11).

    Every term of (11) has the target's horizontal direction (p_x, p_y) as a factor.  This factor is replaced by
    (b_x, b_y) = 2^k (p_x, p_y), which scales the plane's normal and leaves the plane unchanged.
    """
    n = d.nodes
    p_x, p_y, p_z, b_x, b_y = (n[k] for k in ("p_w_x", "p_w_y", "p_w_z", "b_x", "b_y"))
    d.at("swivel", "(10)")
    for axis, p in (("x", p_x), ("y", p_y), ("z", p_z)):
        d.node(f"s_{axis}", Mul(p, p), d.wide(1))
    d.node("s", Total(n["s_x"] + n["s_y"] + n["s_z"]), d.word(2), within=UNIT_SQ)
    l_sw = d.node("l_sw", Root(n["s"]), d.word(1), within=UNIT)

    d.at(equation="(11)")
    sin_h = d.node("sin_h", SineCosine(phi, "sin"), d.word(1), within=COSINE)
    cos_h = d.node("cos_h", SineCosine(phi, "cos"), d.word(1), within=COSINE)
    sin_phi = d.node("sin_phi", Mul(sin_h, cos_h, scale=1), d.word(1), within=COSINE)  # 2 cos(phi/2) sin(phi/2)
    # 2 cos^2(phi/2): the square is missing in print
    d.node("cos2_sq", Mul(cos_h, cos_h, scale=1), d.wide(2), within=COSINE_SQ)
    cos_phi = d.node("cos_phi", Total(n["cos2_sq"] - 1), d.word(1), within=COSINE)

    d.node("a_x", Mul(p_z, b_x), d.word(1))
    d.node("a_y", Mul(p_z, b_y), d.word(1))
    d.node("rho_x", Mul(p_x, b_x), d.wide(2), within=SAME_DIRECTION)
    d.node("rho_y", Mul(p_y, b_y), d.wide(2), within=SAME_DIRECTION)
    # p_x^2 + p_y^2, with one factor of each square in b's scale
    d.node("rho", Total(n["rho_x"] + n["rho_y"]), d.word(2), within=SAME_DIRECTION)
    for axis, factor in (("x", n["a_x"]), ("y", n["a_y"]), ("z", n["rho"])):
        d.node(f"sa_{axis}", Mul(sin_phi, factor), d.wide(2))
    d.node("cb_x", Mul(cos_phi, b_x), d.word(1))
    d.node("cb_y", Mul(cos_phi, b_y), d.word(1))
    d.node("lcb_x", Mul(l_sw, n["cb_x"]), d.wide(2))
    d.node("lcb_y", Mul(l_sw, n["cb_y"]), d.wide(2))
    d.node("pi_num_x", Total(n["sa_x"] + n["lcb_y"]), d.wide(2), within=PLANE_NUM)
    d.node("pi_num_y", Total(n["sa_y"] - n["lcb_x"]), d.wide(2), within=PLANE_NUM)
    d.node("pi_num_z", Total(0 - n["sa_z"]), d.wide(2), after=n["lcb_y"], within=PLANE_NUM)
    for axis in "xyz":
        d.node(f"pi_swivel_{axis}", Div(n[f"pi_num_{axis}"], l_sw), d.word(1), within=PLANE)
    # (12) and all later equations hold for any plane.  Exact arithmetic on the words gives k_e / 2 = p_e p_w and
    # |p_e| = d1 as before; the angle between p_w and the words' plane is the tilt, which enters squared.
    d.restarts[len(n)] = "pi_swivel_x", "pi_swivel_y", "pi_swivel_z"


ARMS = Rule(
    "d1 + d2 is shifted to [1/2, 1); halving never makes 1 of it, since the largest length, all ones, is rounded down",
    lambda c: (0.5, 0.5) if c.clamped else (0.5 - c.ulp, 1 - c.ulp),
)
TARGET = Rule(
    "2^j |p_a|^2 = |p_w| |p_a|, with |p_a| <= d1 + d2 <= 1", lambda c: (0.0, min(c.p[1] ** 2 * 2.0 ** -c.j[0], c.p[1]))
)
LAW = Rule("|p_w^2 + d1^2 - d2^2| = 2 d1 |p_w| |cos a| <= 2 d1 |p_w| by the law of cosines", upto(lambda c: c.k_e))
LAW_PLANE = Rule("k_e times |pi_swivel| <= sqrt 2", upto(lambda c: c.k_e * c.b[1]))
LAW_PLANE_SQ = Rule("(k_e |pi_swivel|)^2", lambda c: (0.0, (c.b[1] * c.k_e) ** 2))
CROSS = Rule("2 p_w x pi_swivel is no longer than 2 |p_w| |pi_swivel| <= 2 sqrt 6", upto(lambda c: c.pp[1]))
ORTHOGONAL = Rule(
    "p_w lies in the swivel plane, so |PP^-| = 2 |p_w| |pi_swivel| exactly; its square is in [1/4, 24]",
    lambda c: (c.pp[0] ** 2, c.pp[1] ** 2),
)
ORTHOGONAL_ARM = Rule("d1^2 |PP^-|^2", lambda c: (0.0, (c.d_high * c.pp[1]) ** 2))
HEIGHT_SQ = Rule(
    "tmp1 = (d1 sin a)^2 |PP^-|^2, and the triangle's height over p_w is no longer than the shorter arm <= 1/2",
    lambda c: c.tmp1,
)
HEIGHT = Rule("its root", lambda c: (0.0, math.sqrt(c.tmp1[1])))
ELBOW_NUM = Rule("numerators of (13): components of p_e times |PP^-|^2", upto(lambda c: c.p_e * c.pp[1] ** 2))
ELBOW = Rule(
    "the elbow is d1 away from the shoulder (with rounded lengths at most |k_e| / 2|p_w|)",
    upto(lambda c: c.p_e),
    upto(lambda c: c.p_e_words + c.elbow),
)


def elbow(d: Dataflow) -> None:
    """Build section 3.2: the point pair (12), in the form (19), and the elbow point (13).

    PP is homogeneous, so common factors do not matter.  The computed PP has the factor 2, as in (19), and a power of 2,
    because the target's unit of length is 2^j times finer than the unit of d1 and d2.  p_e is in the unit of d1 and d2.
    """
    n = d.nodes
    d.at("elbow", "(12)")
    # p_w^2 + d1^2 - d2^2 = p_w^2 + (d1 + d2)(d1 - d2), times 2^j
    d.node("d_sum", n["d_1"] + n["d_2"], d.word(0), within=ARMS, grows=SUM)
    d.node("s_j", ShiftDown(n["s"], n["scale_j"]), d.word(2), "shift", rounding=FLOOR, within=TARGET)
    d.node("dd_j", Mul(n["d_sum"], n["d_dif_j"]), d.word(2))
    k_e = d.node("k_e", Total(n["s_j"] + n["dd_j"]), d.word(2), within=LAW)

    p = {a: n[f"p_w_{a}"] for a in "xyz"}
    pi = {a: n[f"pi_swivel_{a}"] for a in "xyz"}
    for unit, a in zip("ijk", "xyz", strict=True):
        d.node(f"pp_{unit}", Mul(pi[a], k_e), d.word(3), within=LAW_PLANE)
    d_1_sq = d.node("d_1_sq", Mul(n["d_1"], n["d_1"]), d.word(0))
    d.at(equation="(19)")
    for m, a, b in (("1", "z", "y"), ("2", "x", "z"), ("3", "y", "x")):
        d.node(f"c_{m}_{a}{b}", Mul(p[a], pi[b], scale=1), d.wide(2))
        d.node(f"c_{m}_{b}{a}", Mul(p[b], pi[a], scale=1), d.wide(2))
        d.node(f"pp_{m}_m", Total(n[f"c_{m}_{a}{b}"] - n[f"c_{m}_{b}{a}"]), d.word(3), within=CROSS)  # PP_m5 - PP_m4
        d.node(f"pp_{m}_p", Mul(d_1_sq, n[f"pp_{m}_m"]), d.word(3))  # PP_m5 + PP_m4
        d.node(f"pp_{m}_pm", Mul(n[f"pp_{m}_p"], n[f"pp_{m}_m"]), d.wide(5))

    d.at(equation="(13)")
    for m in "123":
        d.node(f"pp_{m}_sq", Mul(n[f"pp_{m}_m"], n[f"pp_{m}_m"]), d.wide(5))
    inf_pp = d.node("inf_pp", Total(n["pp_1_sq"] + n["pp_2_sq"] + n["pp_3_sq"]), d.word(5), within=ORTHOGONAL)
    for unit in "ijk":
        d.node(f"pp_{unit}_sq", Mul(n[f"pp_{unit}"], n[f"pp_{unit}"]), d.wide(5))
    d.node("pp_sq", Total(n["pp_i_sq"] + n["pp_j_sq"] + n["pp_k_sq"]), d.wide(5), within=LAW_PLANE_SQ)
    d.node("pp_pm", Total(n["pp_1_pm"] + n["pp_2_pm"] + n["pp_3_pm"]), d.wide(5), within=ORTHOGONAL_ARM)
    tmp1 = d.node("tmp1", Total(n["pp_pm"] - n["pp_sq"]), d.word(3), within=HEIGHT_SQ)
    tmp_sqr = d.node("tmp_sqr", Root(tmp1), d.word(2), within=HEIGHT)
    # Straight or closed within an ulp: the target lies on the line of the arm and does not decide the sign in (17).
    d.mask("flat", n["clamp"] | (tmp1 <= 0))
    d.mask("back", Select(n["clamp"], n["away"], k_e < 0))

    for axis, m, u, mu, v, mv in ("x1k2j3", "y2i3k1", "z3j1i2"):  # x: pp_1_m, pp_k pp_2_m - pp_j pp_3_m
        d.node(f"e_{axis}_{u}", Mul(n[f"pp_{u}"], n[f"pp_{mu}_m"]), d.wide(5))
        d.node(f"e_{axis}_{v}", Mul(n[f"pp_{v}"], n[f"pp_{mv}_m"]), d.wide(5))
        d.node(f"e_{axis}_pp", Total(n[f"e_{axis}_{u}"] - n[f"e_{axis}_{v}"]), d.wide(5), within=ELBOW_NUM)
        d.node(f"e_{axis}_sqr", Mul(tmp_sqr, n[f"pp_{m}_m"]), d.wide(5))
        d.node(f"e_{axis}_num", Total(n[f"e_{axis}_pp"] + n[f"e_{axis}_sqr"]), d.wide(5), within=ELBOW_NUM)
        d.learned.add(len(n))
        d.node(f"e_{axis}_quo", Div(n[f"e_{axis}_num"], inf_pp), d.word(1), within=ELBOW)
        # The elbow of a clamped arm lies on the line to the target, here at half the target's distance.
        near = Floor(p[axis] / 2, d.word(1).frac)
        clamped = Select(n["clamp"], Select(n["away"], -near, near), n[f"e_{axis}_quo"])
        d.node(f"p_e_{axis}", clamped, d.word(1), rounding=JAM)
    # (15) needs the length of the upper arm in the scale of p_e.
    d.node("d_e", Select(n["clamp"], n["l_sw"] / 2, n["d_1"]), d.word(1), rounding=FLOOR)


FOREARM = Rule("|p_e - p_w| = d2 <= 1", used(upto(lambda c: c.forearm)), used(upto(lambda c: c.forearm)))
COSINE_LAW = (
    "|p_e (p_e - p_w)| = d1 d2 |cos| <= 1/4; rounded arms that do not reach lie on one line; clamped ones do not count"
)
SET_OUTSIDE = Limited("only of clamped targets, whose c4 is set from outside", clamped=True)
ULP = Limited("d1 d2 may be an ulp; the quotient saturates, and (14) limits it to [-1, 1]")
ARMS_PRODUCT = Rule("d1 d2 <= ((d1 + d2) / 2)^2", lambda c: (0.0, 0.25))


def elbow_quaternion(d: Dataflow) -> None:
    """Build section 3.3: the elbow quaternion (14)."""
    n = d.nodes
    d.at("elbow_q", "(14)")

    for a in "xyz":
        # p_e^2 - p_e p_w = p_e (p_e - p_w)
        facts = {"rounding": HALF_UP, "ends": SATURATE, "within": FOREARM, "grows": Growth(added=True)}
        d.node(f"f_{a}", n[f"p_e_{a}"] - n[f"p_a_{a}"], d.word(1), "sum2", **facts)
        d.node(f"t_{a}", Mul(n[f"p_e_{a}"], n[f"f_{a}"]), d.wide(1))

    def rounding(c):  # largest error of t_e = |p_e|^2 - p_e p_w
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
    """Build ``twice`` / 2, limited to [0, 1]; unsigned, so that 1 fits.  ``twice`` is 1 + c or 1 - c of (6) and (7)."""
    fmt = Format(d.width, d.width - 1, "W - 1", signed=False)
    half = twice / 2
    limited = Function(lambda words: np.clip(words, 0, 1 << half.frac), "min(max({}, 0), 1)", half)
    d.node(name, limited, fmt, grows=Growth((0.5,), exact=True))


MANTISSA = Given("unit mantissa", upto(lambda c: 1.0))
ELBOW_SAME = Rule("u and p_e have the same direction", lambda c: (0.0, SQRT3 / 2 if c.clamped else c.p_e), not_negative)
ELBOW_UNIT = Rule(
    "|u| |p_xy| <= sqrt 2 |p_e|",
    lambda c: (0.0, math.sqrt(2) * (SQRT3 / 2 if c.clamped else c.p_e)),
    used(lambda c: (-2 * c.ulp, math.sqrt(2) * c.p_e_words + 4 * c.ulp)),
)
MIDDLE_SQ = Rule("squared length of a unit mantissa", lambda c: (0.25, 3.0))
MIDDLE = Rule("its root", lambda c: (0.5, SQRT3))
TURN = Rule("components of a vector of length 1", upto(lambda c: 1.0))
ALL_UPPER_ARM = Limited("d1 + |p_ez| of an arm that is all upper arm may be rounded to 2: the largest word")


def rotate_to_elbow(d: Dataflow) -> None:
    """Build section 3.4: Q12 (15), the middle line L_m divided by its length.

    L_m = d1 (p_ex (d1 - p_ez), p_ey (d1 - p_ez), p_ex^2 + p_ey^2) may be scaled freely, so the factor d1 is dropped.
    If the elbow is above the shoulder, d1 - p_ez loses digits.  But p_ex^2 + p_ey^2 = (d1 - p_ez)(d1 + p_ez), so L_m is
    divided by d1 - p_ez: (p_ex, p_ey, d1 + p_ez).  If the elbow is below, (p_ex, p_ey) is scaled up to (u_x, u_y) once
    in each term: (u_x (d1 - p_ez), u_y (d1 - p_ez), u_x p_ex + u_y p_ey).  On the z axis the first form is (0, 0, 2 d1)
    and the second (d1, 0, 0), so 0/0 never occurs.
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
PRODUCT = Rule("2 |q_i| |(q_j, q_k)| <= 1, so at most |pi_swivel| <= sqrt 2", upto(lambda c: c.b[1]))
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
    # -PP^- sets the sign if the target is in the direction of the elbow, +PP^- if the target is behind the shoulder.
    for a, m in (("x", "1"), ("y", "2"), ("z", "3")):
        line = n[f"pp_{m}_m"] / 8
        side = Select(n["flat"], Select(n["back"], line, -line), n[f"p_w_{a}"])
        d.node(f"side_{a}", side, d.word(0), grows=Growth((1 / 8, 1.0), exact=True))
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
    products = {"w_kk": (q_k, q3_k), "i_is": (q_i, q3_scalar), "i_jk": (q_j, q3_k)}
    products |= {"j_js": (q_j, q3_scalar), "j_ik": (q_i, q3_k), "k_ks": (q_k, q3_scalar)}
    for name, factors in products.items():
        d.node(name, Mul(*factors), d.wide(1))
    d.node("qs_w", Total(0 - n["w_kk"]), d.word(1))
    d.node("qs_i", Total(n["i_is"] + n["i_jk"]), d.word(1), within=RESULT)
    d.node("qs_j", Total(n["j_js"] - n["j_ik"]), d.word(1), within=RESULT)
    d.node("qs_k", Total(0 + n["k_ks"]), d.word(1))

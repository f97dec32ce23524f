# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/paper``: the paper's equations (10)-(19) as the RTL computes them.

Sections 3.3 to 3.5 are in :mod:`model.dataflow.paper_turns`.

Scale.  Four scales in the equations are free, because they do not change the result: the unit of length of d1 and d2,
the unit of length of the target in (11)-(13), the length of the swivel plane's normal, and the length of L_m.  Each is
a power of two, chosen by a count of leading sign bits so that the words are full.  So short arms, targets near the
shoulder or the z axis, and elbows near the z axis lose no precision.
"""

import math
from dataclasses import replace

from .annotations import COSINE, SQRT3, SUM, Bound, Case, Given, Rule, leading, not_negative, upto, used
from .expressions import FLOOR, JAM, Constant, Floor, Select, square, zero
from .formats import Format
from .nodes import Dataflow, Node
from .paper_operations import Div, LeadingBits, Mul, Root, SineCosine, Total, normalize
from .paper_turns import elbow_quaternion, rotate_to_elbow, rotate_to_wrist
from .shifts import ShiftDown, ShiftUp

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


# Before each section stand its nodes' ranges in exact arithmetic, from geometry, for each case, with the reason.

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

    The flags are exact, because the squares that they compare are not rounded.
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
    # It passes through all equations as the ordinary target of an arm with d1 = d2 = 1/4, and these values are
    # overridden: p_e with its length d_e, c4, and the vector that decides the sign in (17).
    clamp = d.mask("clamp", too_far | too_near | at_shoulder | bad_length, within=CLAMPED)
    d.mask("closed", (too_near | at_shoulder) & ~bad_length, within=REACHABLE)
    d.mask("away", too_near & (d_raw < 0), within=REACHABLE)

    # The target in its own unit of length; a target at the shoulder becomes "straight up".
    lz_p = normalize(d, ("p_w_z", "p_w_x", "p_w_y"), (z, x, y), "lz_p", TARGET_UNIT)
    # The target's horizontal direction in its own unit; on the z axis the azimuth is 0.
    normalize(d, ("b_x", "b_y"), (x, y), "lz_b", DIRECTION_UNIT)
    # The lengths in a unit that brings d1 + d2 to [1/2, 1), and the target in the same unit.
    lz_r = d.node("lz_r", LeadingBits(r_raw), d.count, "lzc", within=leading(w))
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
    cos_phi = d.node("cos_phi", Total(n["cos2_sq"] - Constant(1)), d.word(1), within=COSINE)

    d.node("a_x", Mul(p_z, b_x), d.word(1))
    d.node("a_y", Mul(p_z, b_y), d.word(1))
    d.node("rho_x", Mul(p_x, b_x), d.wide(2), within=SAME_DIRECTION)
    d.node("rho_y", Mul(p_y, b_y), d.wide(2), within=SAME_DIRECTION)
    # p_x^2 + p_y^2, with one factor of each square in b's scale
    d.node("rho", Total(n["rho_x"] + n["rho_y"]), d.word(2), within=SAME_DIRECTION)
    d.node("sa_x", Mul(sin_phi, n["a_x"]), d.wide(2))
    d.node("sa_y", Mul(sin_phi, n["a_y"]), d.wide(2))
    d.node("sa_z", Mul(sin_phi, n["rho"]), d.wide(2))
    d.node("cb_x", Mul(cos_phi, b_x), d.word(1))
    d.node("cb_y", Mul(cos_phi, b_y), d.word(1))
    d.node("lcb_x", Mul(l_sw, n["cb_x"]), d.wide(2))
    d.node("lcb_y", Mul(l_sw, n["cb_y"]), d.wide(2))
    d.node("pi_num_x", Total(n["sa_x"] + n["lcb_y"]), d.wide(2), within=PLANE_NUM)
    d.node("pi_num_y", Total(n["sa_y"] - n["lcb_x"]), d.wide(2), within=PLANE_NUM)
    d.node("pi_num_z", Total(Constant(0) - n["sa_z"]), d.wide(2), after=n["lcb_y"], within=PLANE_NUM)
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
ELBOW_NUM = Rule(
    "the numerators of (13) are the components of p_e times |PP^-|^2", upto(lambda c: c.p_e * c.pp[1] ** 2)
)
ELBOW = Rule(
    "the elbow is d1 away from the shoulder (with rounded lengths at most |k_e| / 2|p_w|)",
    upto(lambda c: c.p_e),
    upto(lambda c: c.p_e_words + c.elbow),
)


def off_length(c: Case, nodes: dict[str, Node], bounds: dict[str, Bound]) -> Case:
    """Return the case with bounds of the errors of p_e (``straight``) and |p_e|^2 (``square``).

    The root t = tmp_sqr in (13) may lose half of its digits, and so may p_e.  But |p_e|^2 = |a|^2 + t^2 |m|^2 contains
    only t^2, which is precise; a is along p_w, and m = PP^- / |PP^-|^2 is perpendicular to p_w.
    """
    root, inf, worst = bounds["tmp_sqr"], bounds["inf_pp"], 0.0
    if min(inf.low, inf.word[0]) <= 0:
        return c  # the division then raises RangeError
    for axis, m in zip("xyz", "123", strict=True):
        if f"e_{axis}_pp" not in bounds:  # not yet evaluated: use the first axis's bound
            axis, m = "x", max("123", key=lambda k: bounds[f"pp_{k}_m"].error)
        along = bounds[f"e_{axis}_pp"].error + root.word[1] * bounds[f"pp_{m}_m"].error
        num = along + nodes[f"e_{axis}_pp"].format.ulp
        worst = max(worst, (num + c.p_e * 1.1 * inf.error) / inf.word[0] + c.elbow)
    straight = SQRT3 * worst
    square = bounds["tmp1"].error + 2 * root.word[1] * nodes["tmp_sqr"].format.ulp
    return replace(c, straight=straight, square=square / inf.low + 2 * straight * c.p_e * 1.1 + straight**2)


def elbow(d: Dataflow) -> None:
    """Build section 3.2: the point pair (12), in the form (19), and the elbow point (13).

    PP is homogeneous, so common factors do not matter.  It has the factor 2, as in (19), and a power of 2, because
    the target's unit of length is 2^j times finer than the unit of d1 and d2.  p_e is in the unit of d1 and d2.
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

    for axis, m, (u, mu), (v, mv) in (
        ("x", "1", ("k", "2"), ("j", "3")),
        ("y", "2", ("i", "3"), ("k", "1")),
        ("z", "3", ("j", "1"), ("i", "2")),
    ):
        d.node(f"e_{axis}_{u}", Mul(n[f"pp_{u}"], n[f"pp_{mu}_m"]), d.wide(5))
        d.node(f"e_{axis}_{v}", Mul(n[f"pp_{v}"], n[f"pp_{mv}_m"]), d.wide(5))
        d.node(f"e_{axis}_pp", Total(n[f"e_{axis}_{u}"] - n[f"e_{axis}_{v}"]), d.wide(5), within=ELBOW_NUM)
        d.node(f"e_{axis}_sqr", Mul(tmp_sqr, n[f"pp_{m}_m"]), d.wide(5))
        d.node(f"e_{axis}_num", Total(n[f"e_{axis}_pp"] + n[f"e_{axis}_sqr"]), d.wide(5), within=ELBOW_NUM)
        d.learned[len(n)] = off_length
        d.node(f"e_{axis}_quo", Div(n[f"e_{axis}_num"], inf_pp), d.word(1), within=ELBOW)
        # The elbow of a clamped arm lies on the line to the target, here at half the target's distance.
        near = Floor(p[axis] / 2, d.word(1).frac)
        clamped = Select(n["clamp"], Select(n["away"], -near, near), n[f"e_{axis}_quo"])
        d.node(f"p_e_{axis}", clamped, d.word(1), rounding=JAM)
    # (15) needs the length of the upper arm in the scale of p_e.
    d.node("d_e", Select(n["clamp"], n["l_sw"] / 2, n["d_1"]), d.word(1), rounding=FLOOR)

# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/paper``, written once: the paper's equations (10)-(19) as the RTL computes them.

Sections 3.3 to 3.5 are in :mod:`model.dataflow.paper_turns`.

Scale.  Four scales are free in the equations and keep words full without changing the result: the unit of length of
the arms, the unit of length of the target in (11)-(13), the length of the swivel plane's normal, and the length of
L_m.  Each is a power of two chosen by a count of leading sign bits
(:meth:`model.dataflow.nodes.Domain.normalize`), so small arms, targets near the shoulder or the z axis, and elbows
near the z axis lose no precision.
"""

import math
from dataclasses import replace

import numpy as np

from .annotations import COSINE, SQRT3, SUM, Case, Given, Rule, leading, not_negative, upto, used
from .nodes import FLOOR, JAM, Domain, Format, Node
from .operations import room, wrap
from .paper_turns import elbow_quaternion, rotate_to_elbow, rotate_to_wrist

SECTIONS = {
    "guard": "domain and scale",
    "swivel": "3.1 swivel plane",
    "elbow": "3.2 elbow point",
    "elbow_q": "3.3 elbow quaternion",
    "to_elbow": "3.4 rotate to the elbow position",
    "to_wrist": "3.5 rotate to the wrist location",
}
"""Section name -> description; the RTL module is ``ik_<section>``, its instance in ``ik_paper`` is ``u_<section>``."""


def paper(d: Domain, target: dict[str, Node]) -> None:
    """Build the whole datapath, from the input words ``target`` (keys ``FIELDS`` of :mod:`model.io.words`) to the
    results.

    Every node is stored in ``d.nodes`` under its name, which is also its signal name in the RTL.
    """
    guard(d, target)
    sections(d, target["phi"])


def sections(d: Domain, phi: Node) -> None:
    """Build sections 3.1 to 3.5; ``d.nodes`` holds the nodes of :func:`guard`."""
    swivel(d, phi)
    elbow(d)
    elbow_quaternion(d)
    rotate_to_elbow(d)
    rotate_to_wrist(d)


def half_of(words, clamp, clamped=0):
    """Halve, or-ing the last bit into the bit above so that a length never becomes 0; ``clamped`` replaces the result
    for a clamped target."""
    return np.where(clamp, clamped, (words >> 1) | (words & 1))


# Exact ranges from geometry are stated before each section, case by case, with their reason.

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


def guard(d: Domain, target: dict[str, Node]) -> None:
    """Classify targets outside the equations' domain exactly, and scale the operands of the equations.

    The comparisons are exact: squares of input words are not rounded, so they are wider than ``W`` bits.
    """
    w = d.width
    x, y, z, d1, d2 = (target[k] for k in ("x", "y", "z", "d1", "d2"))
    d.at("guard")
    length = Format(w + 1, w - 2, "W - 2")
    exact = Format(2 * w + 2, 2 * w - 4, "2*W - 4")

    d.mask("bad_length", (d1, d2), lambda a, b: (a <= 0) | (b <= 0), within=REACHABLE)
    d.mask("on_axis", (x, y), lambda a, b: (a == 0) & (b == 0))
    d.mask("at_shoulder", (x, y, z), lambda a, b, c: (a == 0) & (b == 0) & (c == 0), within=REACHABLE)

    r_raw = d.op("r_raw", (d1, d2), length, lambda a, b: a + b)
    d_raw = d.op("d_raw", (d1, d2), length, lambda a, b: a - b)
    for name, word in (("x_sq", x), ("y_sq", y), ("z_sq", z), ("r_sq", r_raw), ("d_sq", d_raw)):
        d.op(name, (word,), exact, lambda a: a.astype(object) ** 2, "mul")
    d.op("xy_sq", ("x_sq", "y_sq"), exact, lambda a, b: a + b)
    d.op("s_raw", ("xy_sq", "z_sq"), exact, lambda a, b: a + b)
    far, near = ("s_raw", "r_sq", "bad_length"), ("s_raw", "d_sq", "bad_length")
    d.mask("too_far", far, lambda s, r, bad: (s > r).astype(bool) & ~bad, within=REACHABLE)
    d.mask("too_near", near, lambda s, q, bad: (s < q).astype(bool) & ~bad, within=REACHABLE)

    # A clamped target has no elbow in the sense of (13): the arm is straight or folded along the line to the target.
    # It passes through all equations as the ordinary target of an arm with d1 = d2 = 1/4, and three values are
    # overridden: p_e, c4 and the vector whose side decides the sign in (17).
    no_fold = ("too_near", "at_shoulder", "bad_length")
    d.mask("clamp", ("too_far", *no_fold), lambda f, n, s, b: f | n | s | b, within=CLAMPED)
    d.mask("fold", no_fold, lambda n, s, b: (n | s) & ~b, within=REACHABLE)
    d.mask("away", ("too_near", d_raw), lambda n, q: n & (q < 0), within=REACHABLE)

    # The target in its own unit of length; a target at the shoulder becomes "straight up".
    lz_p = d.normalize(("p_w_z", "p_w_x", "p_w_y"), (z, x, y), "lz_p", within=TARGET_UNIT)
    # The target's horizontal direction in its own unit; on the z axis the azimuth is 0.
    d.normalize(("b_x", "b_y"), (x, y), "lz_b", within=DIRECTION_UNIT)
    # The arms in a unit of length that brings d1 + d2 to [1/2, 1), and the target in the same unit.
    lz_r = d.op("lz_r", (r_raw,), d.count, lambda r: np.where(r == 0, 0, room(r, w + 1)), "lzc", within=leading(w))
    mantissa = Format(w + 1, w, "W")
    quarter = 1 << (w - 3)
    for name, raw in (("d_1", d1), ("d_2", d2)):
        d.op(f"{name}_sh", (raw, lz_r), mantissa, lambda a, n: wrap(a << n, w + 1), "shift", within=ARM_SH)
        d.op(name, (f"{name}_sh", "clamp"), d.word(0), lambda a, c: half_of(a, c, quarter), error=JAM, within=ARM)
    for axis, raw in (("x", x), ("y", y), ("z", z)):
        d.op(f"p_a_{axis}_sh", (raw, lz_r), mantissa, lambda a, n: wrap(a << n, w + 1), "shift", within=IN_REACH_SH)
        d.op(f"p_a_{axis}", (f"p_a_{axis}_sh", "clamp"), d.word(0), half_of, error=JAM, within=IN_REACH)
    # d1 - d2 in the target's unit, from the exact difference: rounded arms could put a target close to the shoulder out
    # of reach.
    finer = Format(w + 1, w - 1, "W - 1")
    d.op("d_dif_sh", (d_raw, lz_p), finer, lambda a, n: wrap(a << n, w + 1), "shift", within=NOT_NEAR_SH)
    d.op("d_dif_j", ("d_dif_sh", "clamp"), d.word(1), lambda a, c: np.where(c, 0, a >> 1), error=FLOOR, within=NOT_NEAR)
    # Ratio of the two units: p_w = 2^j p_a.
    d.op("scale_j", (lz_p, lz_r, "clamp"), d.count, lambda p, r, c: np.where(c, 2, p - r + 1), within=UNITS)


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


def swivel(d: Domain, phi: Node) -> None:
    """Section 3.1: |L_sw| (10) and the swivel plane (11).

    Every term of (11) has the target's horizontal direction (p_x, p_y) as a factor.  It is replaced by
    (b_x, b_y) = 2^k (p_x, p_y), which scales the plane's normal and leaves the plane unchanged.
    """
    n = d.nodes
    p_x, p_y, p_z, b_x, b_y = (n[k] for k in ("p_w_x", "p_w_y", "p_w_z", "b_x", "b_y"))
    d.at("swivel", "(10)")
    for axis, p in (("x", p_x), ("y", p_y), ("z", p_z)):
        d.mul(f"s_{axis}", p, p, d.wide(1))
    d.sum("s", n["s_x"], n["s_y"], n["s_z"], fmt=d.word(2), within=UNIT_SQ)
    l_sw = d.root("l_sw", n["s"], d.word(1), within=UNIT)

    d.at(equation="(11)")
    sin_h, cos_h = d.sincos(("sin_h", "cos_h"), phi, within=COSINE)
    sin_phi = d.mul("sin_phi", sin_h, cos_h, d.word(1), scale=1, within=COSINE)  # 2 cos(phi/2) sin(phi/2)
    # 2 cos^2(phi/2): the square is missing in print
    d.mul("cos2_sq", cos_h, cos_h, d.wide(2), scale=1, within=COSINE_SQ)
    cos_phi = d.sum("cos_phi", n["cos2_sq"], -d.constant(1.0, d.wide(2)), fmt=d.word(1), within=COSINE)

    d.mul("a_x", p_z, b_x, d.word(1))
    d.mul("a_y", p_z, b_y, d.word(1))
    d.mul("rho_x", p_x, b_x, d.wide(2), within=SAME_DIRECTION)
    d.mul("rho_y", p_y, b_y, d.wide(2), within=SAME_DIRECTION)
    # p_x^2 + p_y^2, with one factor each in b's scale
    d.sum("rho", n["rho_x"], n["rho_y"], fmt=d.word(2), within=SAME_DIRECTION)
    d.mul("sa_x", sin_phi, n["a_x"], d.wide(2))
    d.mul("sa_y", sin_phi, n["a_y"], d.wide(2))
    d.mul("sa_z", sin_phi, n["rho"], d.wide(2))
    d.mul("cb_x", cos_phi, b_x, d.word(1))
    d.mul("cb_y", cos_phi, b_y, d.word(1))
    d.mul("lcb_x", l_sw, n["cb_x"], d.wide(2))
    d.mul("lcb_y", l_sw, n["cb_y"], d.wide(2))
    d.sum("pi_num_x", n["sa_x"], n["lcb_y"], fmt=d.wide(2), within=PLANE_NUM)
    d.sum("pi_num_y", n["sa_y"], -n["lcb_x"], fmt=d.wide(2), within=PLANE_NUM)
    d.sum("pi_num_z", d.constant(0.0, d.wide(2)), -n["sa_z"], fmt=d.wide(2), after=n["lcb_y"], within=PLANE_NUM)
    for axis in "xyz":
        d.div(f"pi_swivel_{axis}", n[f"pi_num_{axis}"], l_sw, d.word(1), within=PLANE)
    # (12) and everything after it hold for any plane.  Exact arithmetic on the words gives k_e / 2 = p_e p_w and
    # |p_e| = d1 as before; p_w is out of their plane by the tilt, which enters squared.
    d.restart("pi_swivel_x", "pi_swivel_y", "pi_swivel_z")


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
    "the elbow is d1 away from the shoulder (with rounded arms at most |k_e| / 2|p_w|)",
    upto(lambda c: c.p_e),
    upto(lambda c: c.p_e_words + c.elbow),
)


def off_length(c: Case, d: Domain) -> Case:
    """Bound the error of p_e.  The root of (13), and p_e with it, may lose half of its digits; the square in
    |p_e|^2 = |a|^2 + t^2 |m|^2 (a along p_w, t = tmp_sqr, m = PP^- / |PP^-|^2 perpendicular) undoes the root."""
    n = d.nodes
    t, inf, worst = n["tmp_sqr"], n["inf_pp"].value, 0.0
    if min(inf.low, inf.word[0]) <= 0:
        return c  # the division gives the bound
    for axis, m in zip("xyz", "123", strict=True):
        if f"e_{axis}_pp" not in n:  # at most the first axis's
            axis, m = "x", max("123", key=lambda k: n[f"pp_{k}_m"].value.error)
        pp = n[f"e_{axis}_pp"]
        num = pp.value.error + t.value.word[1] * n[f"pp_{m}_m"].value.error + pp.format.ulp
        worst = max(worst, (num + c.p_e * 1.1 * inf.error) / inf.word[0] + c.elbow)
    straight = SQRT3 * worst
    square = n["tmp1"].value.error + 2 * t.value.word[1] * t.format.ulp
    return replace(c, straight=straight, square=square / inf.low + 2 * straight * c.p_e * 1.1 + straight**2)


def elbow(d: Domain) -> None:
    """Section 3.2: the point pair (12), in the form (19), and the elbow point (13).

    PP is homogeneous.  As in (19) it is scaled by 2 throughout; the target's own unit of length (2^j finer than the
    arms') is another common factor; p_e is in the arms' unit.
    """
    n = d.nodes
    d.at("elbow", "(12)")
    # p_w^2 + d1^2 - d2^2 = p_w^2 + (d1 + d2)(d1 - d2), times 2^j
    d.op("d_sum", ("d_1", "d_2"), d.word(0), lambda a, b: a + b, within=ARMS, grows=SUM)
    d.op("s_j", ("s", "scale_j"), d.word(2), lambda a, j: a >> j, "shift", FLOOR, within=TARGET)
    d.mul("dd_j", n["d_sum"], n["d_dif_j"], d.word(2))
    k_e = d.sum("k_e", n["s_j"], n["dd_j"], fmt=d.word(2), within=LAW)

    p = {a: n[f"p_w_{a}"] for a in "xyz"}
    pi = {a: n[f"pi_swivel_{a}"] for a in "xyz"}
    for unit, a in zip("ijk", "xyz", strict=True):
        d.mul(f"pp_{unit}", pi[a], k_e, d.word(3), within=LAW_PLANE)
    d_1_sq = d.mul("d_1_sq", n["d_1"], n["d_1"], d.word(0))
    d.at(equation="(19)")
    for m, a, b in (("1", "z", "y"), ("2", "x", "z"), ("3", "y", "x")):
        d.mul(f"c_{m}_{a}{b}", p[a], pi[b], d.wide(2), scale=1)
        d.mul(f"c_{m}_{b}{a}", p[b], pi[a], d.wide(2), scale=1)
        d.sum(f"pp_{m}_m", n[f"c_{m}_{a}{b}"], -n[f"c_{m}_{b}{a}"], fmt=d.word(3), within=CROSS)  # PP_m5 - PP_m4
        d.mul(f"pp_{m}_p", d_1_sq, n[f"pp_{m}_m"], d.word(3))  # PP_m5 + PP_m4
        d.mul(f"pp_{m}_pm", n[f"pp_{m}_p"], n[f"pp_{m}_m"], d.wide(5))

    d.at(equation="(13)")
    for m in "123":
        d.mul(f"pp_{m}_sq", n[f"pp_{m}_m"], n[f"pp_{m}_m"], d.wide(5))
    inf_pp = d.sum("inf_pp", n["pp_1_sq"], n["pp_2_sq"], n["pp_3_sq"], fmt=d.word(5), within=ORTHOGONAL)
    for unit in "ijk":
        d.mul(f"pp_{unit}_sq", n[f"pp_{unit}"], n[f"pp_{unit}"], d.wide(5))
    d.sum("pp_sq", n["pp_i_sq"], n["pp_j_sq"], n["pp_k_sq"], fmt=d.wide(5), within=LAW_PLANE_SQ)
    d.sum("pp_pm", n["pp_1_pm"], n["pp_2_pm"], n["pp_3_pm"], fmt=d.wide(5), within=ORTHOGONAL_ARM)
    tmp1 = d.sum("tmp1", n["pp_pm"], -n["pp_sq"], fmt=d.word(3), within=HEIGHT_SQ)
    tmp_sqr = d.root("tmp_sqr", tmp1, d.word(2), within=HEIGHT)
    # Straight or folded within an ulp: the target lies on the line of the arm and gives no side in (17).
    d.mask("flat", ("clamp", "tmp1"), lambda c, t: c | (t <= 0))
    d.mask("back", ("clamp", "away", "k_e"), lambda c, a, k: np.where(c, a, k < 0))

    for axis, m, (u, mu), (v, mv) in (
        ("x", "1", ("k", "2"), ("j", "3")),
        ("y", "2", ("i", "3"), ("k", "1")),
        ("z", "3", ("j", "1"), ("i", "2")),
    ):
        d.mul(f"e_{axis}_{u}", n[f"pp_{u}"], n[f"pp_{mu}_m"], d.wide(5))
        d.mul(f"e_{axis}_{v}", n[f"pp_{v}"], n[f"pp_{mv}_m"], d.wide(5))
        d.sum(f"e_{axis}_pp", n[f"e_{axis}_{u}"], -n[f"e_{axis}_{v}"], fmt=d.wide(5), within=ELBOW_NUM)
        d.mul(f"e_{axis}_sqr", tmp_sqr, n[f"pp_{m}_m"], d.wide(5))
        d.sum(f"e_{axis}_num", n[f"e_{axis}_pp"], n[f"e_{axis}_sqr"], fmt=d.wide(5), within=ELBOW_NUM)
        d.learn(lambda c: off_length(c, d))
        d.div(f"e_{axis}_quo", n[f"e_{axis}_num"], inf_pp, d.word(1), within=ELBOW)
        # A clamped arm's elbow lies on the line to the target, at half its distance here.
        either = (f"e_{axis}_quo", p[axis], "clamp", "away")
        d.op(
            f"p_e_{axis}",
            either,
            d.word(1),
            lambda q, t, c, a: np.where(c, np.where(a, -1, 1) * (t >> 2), q),
            error=JAM,
        )
    # (15) needs the length of the upper arm in the scale of p_e.
    d.op("d_e", ("d_1", "l_sw", "clamp"), d.word(1), lambda a, b, c: np.where(c, b >> 1, a >> 1), error=FLOOR)

# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/lean``, written once: the paper's results from reciprocal square roots in two levels.

docs/generated/lean.md derives it from (10)-(18).  :func:`lean` uses the same operations as the paper's dataflow
(:class:`model.dataflow.nodes.Domain`) and runs in the same ways: in integers, in double precision, as a table of
formats and clocks.

Exact part.  Squares, their sums, A = (d1 + d2)^2 - s, B = s - (d1 - d2)^2 and K = s + d1^2 - d2^2 are integers of
2W + 2 bits; their signs are the flags.  Every root takes its argument normalized by an even shift, so its relative
precision does not depend on the size of the argument.

Formats.  An inner word has F = W + 5 fraction bits, but at least 22 and at most 33, and two integer bits: [-2, 2).  A
root has at most 31 fraction bits, and 22 up to W = 18; its argument, a mantissa, has 3 more.  The root's result is
1/(2 sqrt(m)), in (1/2, 1]; 1 where m = 0.

Rounding.  ``mul3`` omits the product of the two low parts and rounds half up.  Roots are faithful, shifts floor,
the results are rounded half up to W - 2 fraction bits.
"""

from functools import partial

import numpy as np

from ..io.words import LENGTHS
from . import operations as ops
from .annotations import SUM, Growth, Limited, Within
from .nodes import FLOOR, HALF_UP, Domain, Format, Node, effective_width, inner_frac, root_frac

SECTIONS = {
    "guard": "exact squares and flags",
    "direction": "azimuth and elevation",
    "triangle": "shoulder angle, elbow",
    "turn": "shoulder quaternion",
    "results": "what leaves the datapath",
}
"""Section name -> description; the RTL module is ``ik_lean_<section>``, its instance ``u_<section>``."""

# Exact ranges of the nodes from geometry, with the reason.

SQUARES = "squares of words in [-2, 2)"
MANTISSA = Within(0.0, 1.0, "mantissa", below=True)
INVERSE = Within(0.0, 1.0, "1/(2 sqrt m) with m >= 1/4")
LENGTH_INVERSE = Within(0.0, 1.5, "1/(2 sqrt L) with L >= 1/8")
INVERSES = Within(0.0, 1.0, "products of inverses")
COORDINATE = Within(-1.0, 1.0, "coordinates are no longer than the vector", below=True)
CIRCLE = Within(-1.0, 1.0, "a sine or cosine")
UPPER_HALF = Within(0.0, 1.0, "a sine or cosine")
ROOT = Within(0.0, 1.0, "the root of a mantissa")
HALF_LENGTH = Within(0.5, 1.0, "(1 + |c|)/2")
HALF_ANGLE = Within(-1.0, 1.0, "half angles: squared length (1 + |c|)/2")
PART = Within(-1.0, 1.0, "parts of quaternions no longer than 1")
PAIR = Within(-1.5, 1.5, "sums of two parts of such, at most the root of 2, and products of them")
ELBOW_W, ELBOW_I = Within(0.0, 1.0, "a component of Qe"), Within(-1.0, 0.0, "a component of Qe")
RISES = "e_rho >= e_s, because rho <= |p|"
RISEN = Within(0.0, 1.0, RISES)
ARMS_UNIT = Within(0.0, 2.0, "sqrt A <= 2 sqrt(d1 d2), and root_far >= 1/2")
LAW = Within(0.0, 2.0, "inv_law = 2 inv_11 inv_s")
LAW_UNIT = Within(0.0, 2.0, "sin a <= 1, and root_ab >= 1/4, or 0 and |d1 - d2| a place or more")
K_UNIT = Within(-2.0, 2.0, "|K| <= 2 d1 |p|, and inv_law > 1/4", below=True)

# Saturation that is intended.

TWO = Limited("2, which powers of two can give, becomes the largest word")
ONE = Limited("1, which powers of two can give, becomes the largest word")
MOST = Limited("1 and more becomes the largest mantissa")

FOURFOLD = Growth((4.0, 0.0))


def not_negative(why: str) -> Within:
    """Return the range of a 6-bit shift count."""
    return Within(0.0, 63.0, why)


WIDTHS = range(3, 33)
"""Word lengths supported by the lean datapath: below 16 only so that all inputs can be tested."""


class Lean:
    """Formats of the lean dataflow at one word length."""

    def __init__(self, width: int) -> None:
        frac = inner_frac(width)
        self.frac = frac
        self.even_width = width + width % 2  # width of an arm's length rounded up to even, as its shifts are even
        self.odd = width % 2
        self.inner = Format(frac + 2, frac, "FRAC")
        root = root_frac(width)
        self.mantissa = Format(root + 3, root + 3, "ROOT_FRAC + 3", signed=False)
        self.exact = Format(2 * width + 2, 2 * width - 4, "2*W - 4")
        self.length = Format(width + 1, width - 2, "W - 2")
        self.doubled = Format(frac + 3, frac, "FRAC")  # fits slightly more than 2
        self.raised = Format(frac + 5, frac, "FRAC")  # shifted left by 2
        effective = effective_width(width)
        self.pad = effective - width  # zeros below a coordinate
        self.shifted = Format(effective + 1, effective, "WX")
        self.result = Format(width, width - 2, "W - 2")
        self.drop = frac - self.result.frac  # bits of an inner word that a result's rounding drops


def lean(d: Domain, target: dict[str, Node]) -> None:
    """Build the whole datapath, from the input words ``target`` (keys ``FIELDS`` of :mod:`model.io.words`) to the
    results.

    Every node is stored in ``d.nodes`` under its name, which is also its signal name in the RTL.
    """
    guard(d, target)
    sections(d, target["phi"])


def sections(d: Domain, phi: Node) -> None:
    """Build everything after :func:`guard`, whose nodes are in ``d.nodes``."""
    formats = Lean(d.width)
    direction(d, formats)
    triangle(d, formats)
    turn(d, formats, phi)


def guard(d: Domain, target: dict[str, Node]) -> None:
    """Build the exact integers of the input words, and the flags decided by them."""
    f = Lean(d.width)
    x, y, z, d1, d2 = (target[k] for k in ("x", "y", "z", "d1", "d2"))
    d.at("guard")
    d.summed(LENGTHS, lambda x, y, z, d1, d2: np.maximum(x * x + y * y + z * z, (d1 + d2) ** 2))
    d.mask("bad_length", (d1, d2), lambda a, b: (a <= 0) | (b <= 0))
    d.mask("on_axis", (x, y), lambda a, b: (a == 0) & (b == 0))
    d.mask("at_shoulder", (x, y, z), lambda a, b, c: (a == 0) & (b == 0) & (c == 0))

    L = d.line
    d_sum = L(1).op("d_sum", (d1, d2), f.length, ops.plus, within=Within(0.0, 4.0, SQUARES, below=True))
    d_dif = L(2).op("d_dif", (d1, d2), f.length, ops.minus, within=Within(-2.0, 2.0, SQUARES))
    L(3).op("x_sq", (x,), f.exact, ops.square, "square", within=Within(0.0, 4.0, SQUARES))
    L(3).op("y_sq", (y,), f.exact, ops.square, "square", within=Within(0.0, 4.0, SQUARES))
    L(4).op("z_sq", (z,), f.exact, ops.square, "square", within=Within(0.0, 4.0, SQUARES))
    L(5).op("d_sum_sq", (d_sum,), f.exact, ops.square, "square", within=Within(0.0, 16.0, SQUARES, below=True))
    L(6).op("d_dif_sq", (d_dif,), f.exact, ops.square, "square", within=Within(0.0, 4.0, SQUARES))
    L(7).op("sum_dif", (d_sum, d_dif), f.exact, ops.times, "product", within=Within(-4.0, 4.0, SQUARES))  # d1^2 - d2^2
    L(3).op("rho_sq", ("x_sq", "y_sq"), f.exact, ops.plus, "wide", within=Within(0.0, 8.0, SQUARES))
    L(4).op("s", ("rho_sq", "z_sq"), f.exact, ops.plus, "wide", within=Within(0.0, 12.0, SQUARES))
    L(5).op("a_far", ("d_sum_sq", "s"), f.exact, ops.minus, "wide", within=Within(0.0, 16.0, SQUARES, below=True))
    L(6).op("b_near", ("s", "d_dif_sq"), f.exact, ops.minus, "wide", within=Within(0.0, 12.0, SQUARES))
    L(7).op("k_law", ("s", "sum_dif"), f.exact, ops.plus, "wide", within=Within(-4.0, 16.0, SQUARES))

    d.at()
    d.mask("too_far", ("a_far", "bad_length"), lambda a, bad: (a < 0).astype(bool) & ~bad)
    d.mask("too_near", ("b_near", "bad_length"), lambda b, bad: (b < 0).astype(bool) & ~bad)
    # No elbow: the arm is straight or folded along the line to the target.
    d.mask("clamp", ("too_far", "too_near", "at_shoulder", "bad_length"), lambda f, n, s, b: f | n | s | b)
    d.mask("fold", ("too_near", "at_shoulder", "bad_length"), lambda n, s, b: (n | s) & ~b)
    d.mask("away", ("too_near", d_dif), lambda n, q: n & (q < 0))


def direction(d: Domain, f: Lean) -> None:
    """Build (u_x, u_y) = (x, y)/rho, sin_el = z/|p|, cos_el = rho/|p|, and the half angles of azimuth and tilt."""
    n, L = d.nodes, d.line
    d.at("direction")
    root(L(8), f, "rho", n["rho_sq"], 2 * d.width)
    root(L(9), f, "s", n["s"], 2 * d.width)

    # in the root's own unit: |x| <= rho, so no high bit is lost
    unit = partial(ops.shift_up, left=f.pad, width=f.shifted.width)
    L(14).op("x_n", ("x", "e_rho"), f.shifted, unit, "shift", within=COORDINATE)
    L(15).op("y_n", ("y", "e_rho"), f.shifted, unit, "shift", within=COORDINATE)
    L(16).op("z_n", ("z", "e_s"), f.shifted, unit, "shift", within=COORDINATE)
    L(14).mul3("u_x", n["x_n"], n["inv_rho"], f.inner, scale=1, within=CIRCLE)
    L(15).mul3("u_y", n["y_n"], n["inv_rho"], f.inner, scale=1, within=CIRCLE)
    L(16).mul3("sin_el", n["z_n"], n["inv_s"], f.inner, scale=1, within=CIRCLE)
    L(17).mul3("root_rho", n["inv_rho"], n["m_rho"], f.inner, scale=1, within=ROOT)  # sqrt(m)
    L(18).op("n_el", ("e_rho", "e_s"), d.count, partial(ops.count, factors=(1, -1)), within=not_negative(RISES))
    L(18).op("inv_s_el", ("inv_s", "n_el"), f.inner, ops.shift_down, "shift", FLOOR, within=RISEN)
    L(18).mul3("cos_el", n["root_rho"], n["inv_s_el"], f.inner, scale=1, kind="mul3_far", within=UPPER_HALF)

    # The first rotation turns by the azimuth and 90 degrees: cosine -u_y, sine u_x.  On the z axis, where both are 0,
    # the azimuth is 0: (1, 1)/2.
    squared_length(L(29), f, "az_sq", ("u_y",))
    # Its parts do not wait for the squared length.
    az = "u_y", "u_y", "u_x", "on_axis"
    part(L(32), f, "az_c", az, large=lambda u_y, on_axis: (u_y < 0) | ops.truth(on_axis), frac=f.frac)
    part(L(33), f, "az_s", az, large=lambda u_y, on_axis: u_y >= 0, frac=f.frac)
    # The second turns by the angle between p and the z axis.  At the shoulder, where both are 0, the direction is +z:
    # (1, 0).
    squared_length(L(30), f, "tilt_sq", ("sin_el", "at_shoulder"))
    tilt = ("tilt_sq", "sin_el", "cos_el")
    part(L(34), f, "tilt_c", tilt, large=lambda c: c >= 0)
    part(L(35), f, "tilt_s", tilt, large=lambda c: c < 0)


def triangle(d: Domain, f: Lean) -> None:
    """Build Qe (14) and half the angle a at the shoulder: cos a = K/(2 d1 |p|), sin a = sqrt(A B)/(2 d1 |p|)."""
    n, L = d.nodes, d.line
    d.at("triangle")
    root(L(10), f, "far", n["a_far"], 2 * d.width)
    root(L(11), f, "near", n["b_near"], 2 * d.width)
    root(L(12), f, "1", n["d1"], f.even_width)
    root(L(13), f, "2", n["d2"], f.even_width)
    L(19).mul3("root_far", n["inv_far"], n["m_far"], f.inner, scale=1, within=ROOT)
    L(20).mul3("root_near", n["inv_near"], n["m_near"], f.inner, scale=1, within=ROOT)
    # 1/(4 sqrt(m_1 m_2)), shifted to the unit of sqrt A: their product is at most 1, and root_far >= 1/2
    fine = Format(f.frac + 2, f.frac + 1, "FRAC + 1")
    L(21).mul3("inv_12_raw", n["inv_1"], n["inv_2"], Format(f.frac + 3, f.frac + 1, "FRAC + 1"), within=INVERSES)
    limited(d, f, "inv_12", INVERSES, fine, ONE)

    arms, down = partial(ops.count, factors=(1, -1, -1), constant=2 + f.odd), partial(ops.shift_down, left=2)
    for line, side, root_of, half in ((22, "far", "A", "w"), (23, "near", "B", "i")):
        shorter = not_negative(f"sqrt {root_of} <= 2 sqrt(d1 d2)")
        L(line).op(f"n_{side}", (f"e_{side}", "e_1", "e_2"), d.count, arms, within=shorter)
        raw, shifted, eightfold = f"inv_12_{side}_raw", ("inv_12", f"n_{side}"), Growth((8.0, 0.0))
        L(line).op(raw, shifted, f.raised, down, "shift", FLOOR, within=ARMS_UNIT, grows=eightfold)
        limited(d, f, f"inv_12_{side}", ARMS_UNIT)
        L(line).mul3(f"elbow_{half}", n[f"root_{side}"], n[f"inv_12_{side}"], f.inner, kind="mul3_far", within=ELBOW_W)

    # The clamped elbow is folded (1, 0) or straight (0, -1).
    for line, half, sign, ends, within in ((22, "w", 1, (1, 0), ELBOW_W), (23, "i", -1, (0, -1), ELBOW_I)):  # (14)
        folded, straight = ends
        how = partial(ops.elbow, drop=f.drop, sign=sign, folded=folded, straight=straight, one=1 << (d.width - 2))
        L(line).op(f"qe_{half}", (f"elbow_{half}", "clamp", "fold"), f.result, how, error=HALF_UP, within=within)

    # 1/(4 d1 |p|) in the arms' and the target's own units, and twice that: inv_law = 1/(4 m_1 sqrt(m_s))
    L(24).mul3("inv_11", n["inv_1"], n["inv_1"], f.inner, within=INVERSES)
    L(25).mul3("inv_law_raw", n["inv_11"], n["inv_s"], f.doubled, scale=1, within=LAW)
    inv_law = limited(d, f, "inv_law", LAW)
    # K in the same units: at most 2, because |K| <= 2 d1 |p|
    L(26).op("n_law", ("e_1", "e_s"), d.count, partial(ops.count, factors=(2, 1)))
    raise_k, drop_k = max(f.frac - 2 * d.width - f.odd + 1, 0), max(2 * d.width + f.odd - f.frac, 1)
    law = partial(ops.shift_up, left=raise_k, right=drop_k, width=f.inner.width)
    L(26).op("k_scaled", ("k_law", "n_law"), f.inner, law, "shift3", FLOOR, within=K_UNIT)
    L(26).mul3("cos_a", n["k_scaled"], inv_law, f.inner, scale=1, within=CIRCLE)
    L(27).mul3("root_ab", n["root_far"], n["root_near"], f.inner, within=ROOT)

    ab = partial(ops.count, factors=(1, 1, -2, -1), constant=2 + f.odd)
    L(28).op("n_ab", ("e_far", "e_near", "e_1", "e_s"), d.count, ab, "sum2", within=not_negative("sin a <= 1"))
    L(28).op("inv_law_ab_raw", ("inv_law", "n_ab"), f.raised, down, "shift", FLOOR, within=LAW_UNIT, grows=FOURFOLD)
    inv_law_ab = limited(d, f, "inv_law_ab", LAW_UNIT)
    L(28).mul3("sin_a", n["root_ab"], inv_law_ab, f.inner, scale=1, kind="mul3_far", within=UPPER_HALF)
    # The last rotation turns by -a.  A clamped arm lies along the line to the target, (1, 0), or away from it, (0, 1).
    squared_length(L(31), f, "arm_sq", ("cos_a", "clamp"))

    def toward(c, clamp, away):
        return np.where(clamp, ~ops.truth(away), c >= 0)

    arm = ("arm_sq", "cos_a", "sin_a", "clamp", "away")

    def none(clamp, away):
        return clamp

    part(L(36), f, "arm_c", arm, large=toward, none=none)
    part(L(37), f, "arm_s", arm, large=lambda *c: ~toward(*c), none=none)
    # Operands for three products instead of four: c + s, and the larger part minus the smaller.
    d.at()
    d.mask("arm_swap", ("cos_a", "clamp", "away"), lambda *c: ~toward(*c))

    both = ("arm_sq", "sin_a", "clamp")
    for line, name, sign in ((52, "arm_dif", -1), (53, "arm_sum", 1)):
        L(line).op(name, both, f.inner, partial(ops.part_sum, sign=sign), error=FLOOR, within=PAIR, grows=SUM)


def turn(d: Domain, f: Lean, phi: Node) -> None:
    """Build Qs: the four rotations multiplied, by azimuth and 90 degrees, tilt, swivel and -a, and normalized."""
    n, L = d.nodes, d.line
    d.at("turn")
    d.trig(("sin_h", "cos_h"), phi, f.inner, lines=(38, 39), within=(CIRCLE, UPPER_HALF))
    L(40).mul3("cc", n["az_c"], n["cos_h"], f.inner, within=PART)
    L(41).mul3("ss", n["az_s"], n["sin_h"], f.inner, within=PART)
    L(42).mul3("sc", n["az_s"], n["cos_h"], f.inner, within=PART)
    L(43).mul3("cs", n["az_c"], n["sin_h"], f.inner, within=PART)
    # half the sum and half the difference of azimuth and swivel
    L(44).op("c_plus", ("cc", "ss"), f.inner, ops.minus, within=PART, grows=SUM)
    L(45).op("s_plus", ("sc", "cs"), f.inner, ops.plus, within=PART, grows=SUM)
    L(46).op("c_minus", ("cc", "ss"), f.inner, ops.plus, within=PART, grows=SUM)
    L(47).op("s_minus", ("sc", "cs"), f.inner, ops.minus, within=PART, grows=SUM)
    L(48).mul3("w_0", n["tilt_c"], n["c_plus"], f.inner, kind="mul3_far", within=PART)
    L(49).mul3("i_0", n["tilt_s"], n["c_minus"], f.inner, kind="mul3_far", within=PART)
    L(50).mul3("j_0", n["tilt_s"], n["s_minus"], f.inner, kind="mul3_far", within=PART)
    L(51).mul3("k_0", n["tilt_c"], n["s_plus"], f.inner, kind="mul3_far", within=PART)
    # Three products per pair: w c + i s = (w + i) c - i (c - s), and i c - w s = (w + i) c - w (c + s).
    for first, second, lines in (("w", "i", (52, 53)), ("k", "j", (55, 54))):
        both = first + second
        parts = f"{first}_0", f"{second}_0"
        L(min(lines)).op(f"{both}_0", parts, f.inner, ops.plus, within=PAIR, grows=SUM)
        L(min(lines)).mul3(f"{both}_c", n[f"{both}_0"], n["arm_c"], f.inner, kind="mul3_far", within=PAIR)
        terms_of = zip((first, second), (second, first), ("dif", "sum"), lines, strict=True)
        for unit, other, arm, line in terms_of:
            factors = n[f"{other}_0"], n[f"arm_{arm}"]
            L(line).mul3(f"{other}_{arm}", *factors, f.inner, kind="mul3_far", after=n[f"{both}_0"], within=PAIR)
            terms = f"{both}_c", f"{other}_{arm}"
            if arm == "sum":
                L(line).op(f"{unit}_1", terms, f.inner, ops.minus, within=PART, grows=SUM)
            else:  # the larger part minus the smaller is s - c where they are swapped
                L(line).op(f"{unit}_1", (*terms, "arm_swap"), f.inner, ops.turned, within=PART, grows=SUM)

    # The squared length lies in [1/8, 1]: the last root does not wait for the product.
    L(56).mul3("az_tilt_sq", n["az_sq"], n["tilt_sq"], f.inner, within=Within(0.25, 1.0, "a product of such"))
    L(56).mul3("length_sq", n["az_tilt_sq"], n["arm_sq"], f.inner, within=Within(0.125, 1.0, "a product of such"))
    quarter = 1 << (f.frac - 2)
    low = L(57).op("low", ("length_sq",), d.bit, lambda t: t < quarter, None)
    # The mantissa is of four times the length below 1/4; the root is doubled there.
    up = partial(ops.mantissa, up=f.mantissa.frac - f.frac, top=f.mantissa.high)
    within = Within(0.25, 1.0, "mantissa")
    L(57).op("m_q", ("length_sq", low), f.mantissa, up, within=within, grows=FOURFOLD, limited=MOST)
    inv_q = L(57).rsqrt("inv_q", n["m_q"], f.inner, twice=low, within=LENGTH_INVERSE)

    # The k part is nonnegative.
    rounded = partial(ops.result, drop=f.drop)
    d.at()
    d.op("minus", ("k_1",), d.bit, lambda k: k < 0, None)
    for line, unit in ((58, "w"), (59, "i"), (60, "j"), (61, "k")):
        L(line).mul3(f"{unit}_q", n[f"{unit}_1"], inv_q, f.inner, scale=1, kind="mul3_far", within=PART)
        # (18)
        L(line).op(f"qs_{unit}", (f"{unit}_q", "minus"), f.result, rounded, error=HALF_UP, within=PART)


# -- shared by the sections ------------------------------------------------------------------------------------------


def root(d: Domain, f: Lean, name: str, value: Node, width: int) -> None:
    """Build e_<name> (even shifts), m_<name> (mantissa) and inv_<name> = 1/(2 sqrt(m)) of the low ``width`` bits."""
    d.even(f"e_{name}", f"m_{name}", value, width, f.mantissa, within=MANTISSA)
    d.rsqrt(f"inv_{name}", d.nodes[f"m_{name}"], f.inner, far=True, within=INVERSE)


def limited(d: Domain, f: Lean, name: str, within: Within, fmt: Format | None = None, limited: Limited = TWO) -> Node:
    """Build ``name`` from ``name``_raw: 2, possible for powers of two, becomes the largest inner word, or 1 the largest
    of another format."""
    most = partial(ops.limit, top=f.inner.high)
    return d.op(name, (f"{name}_raw",), fmt or f.inner, most, within=within, limited=limited)


def squared_length(d: Domain, f: Lean, name: str, operands: tuple[str, ...]) -> None:
    """Build (1 + |c|)/2 of the first operand; 1 where the second, a mask, is set."""
    d.op(name, operands, f.inner, partial(ops.half_length, frac=f.frac), error=FLOOR, within=HALF_LENGTH)


def part(d: Domain, f: Lean, name: str, operands: tuple[str, ...], **how) -> None:
    """Build a part of h.  ``operands``: squared length, cosine, sine, masks; the first is the cosine again where the
    part does not wait for the squared length.  ``how``: parameters of :func:`.operations.half_part`."""
    d.op(name, operands, f.inner, partial(ops.half_part, **how), error=FLOOR, within=HALF_ANGLE)

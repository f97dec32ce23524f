# SPDX-License-Identifier: Apache-2.0
"""The dataflow of ``rtl/lean``, written once: the paper's answers from reciprocal square roots in two levels.

docs/lean.md derives it from (10)-(18).  :func:`lean` is written against the same operations as the paper's dataflow
(:class:`model.dataflow.nodes.Domain`) and runs in the same ways: in integers, in double precision, as a table of
formats and clocks.

Exact part.  Squares, their sums, A = (d1 + d2)^2 - s, B = s - (d1 - d2)^2 and K = s + d1^2 - d2^2 are integers of
2W + 2 bits; their signs are the flags.  Every root takes its argument normalized by an even shift, so its relative
precision does not depend on how small the argument is.

Formats.  An inner word has F = W + 5 fraction bits, but at least 21 and at most 33, and two integer bits: [-2, 2).  A
root has at most 31 fraction bits, and 21 up to W = 18; its argument, a mantissa, has 3 more.  The root's result is
1/(2 sqrt(m)), in (1/2, 1]; 0 where m = 0.

Rounding.  ``mul3`` leaves out the product of the two low parts and rounds half up.  Roots are faithful, shifts floor,
the results are rounded half up to W - 2 fraction bits.
"""

from __future__ import annotations

import numpy as np

from model.dataflow.nodes import FLOOR, HALF_UP, Domain, Format, Node, inner_frac, root_frac, wrap

SECTIONS = {
    "guard": "exact squares and flags",
    "direction": "azimuth and elevation",
    "triangle": "shoulder angle, elbow",
    "turn": "shoulder quaternion",
    "results": "what leaves the datapath",
}
"""Section name -> what it is; the RTL module is ``ik_lean_<section>``, its instance ``u_<section>``."""


WIDTHS = range(3, 33)
"""Word lengths that the lean datapath can be built with: below 16 only so that all inputs can be tried."""


class Lean:
    """The formats of the lean dataflow at one word length."""

    def __init__(self, width: int) -> None:
        frac = inner_frac(width)
        self.frac = frac
        self.even_width = width + width % 2  # container of an arm's length, whose shifts are even
        self.odd = width % 2
        self.inner = Format(frac + 2, frac, "FRAC")
        root = root_frac(width)
        self.mantissa = Format(root + 3, root + 3, "ROOT_FRAC + 3", signed=False)
        self.exact = Format(2 * width + 2, 2 * width - 4, "2*W - 4")
        self.length = Format(width + 1, width - 2, "W - 2")
        self.doubled = Format(frac + 3, frac, "FRAC")  # 2 and a little fits
        self.raised = Format(frac + 5, frac, "FRAC")  # shifted left by 2
        self.pad = max(16 - width, 0)  # zeros below a coordinate, for the tiles of its product
        self.shifted = Format(width + self.pad + 1, width + self.pad, "((W < 16) ? 16 : W)")
        self.count = Format(6, 0, "0", signed=False)
        self.result = Format(width, width - 2, "W - 2")


def lean(d: Domain, target: dict[str, Node]) -> None:
    """The whole datapath: from the input words ``target`` (keys ``FIELDS`` of :mod:`model.targets.words`) to the
    results.

    Every node ends up in ``d.nodes`` under its name, which is also the name of its signal in the RTL.
    """
    guard(d, target)
    sections(d, target["phi"])


def sections(d: Domain, phi: Node) -> None:
    """Everything after :func:`guard`, whose nodes ``d.nodes`` holds."""
    formats = Lean(d.width)
    direction(d, formats)
    triangle(d, formats)
    turn(d, formats, phi)


def guard(d: Domain, target: dict[str, Node]) -> None:
    """Exact integers of the input words, and the flags that they decide."""
    f = Lean(d.width)
    x, y, z, d1, d2 = (target[k] for k in ("x", "y", "z", "d1", "d2"))
    d.at("guard")
    d.op("bad_length", (d1, d2), d.bit, "mux", lambda a, b: (a <= 0) | (b <= 0))
    d.op("on_axis", (x, y), d.bit, "mux", lambda a, b: (a == 0) & (b == 0))
    d.op("at_shoulder", (x, y, z), d.bit, "mux", lambda a, b, c: (a == 0) & (b == 0) & (c == 0))

    r_raw = d.op("r_raw", (d1, d2), f.length, "mux", lambda a, b: a + b)
    d_raw = d.op("d_raw", (d1, d2), f.length, "mux", lambda a, b: a - b)
    for name, word in (("x_sq", x), ("y_sq", y), ("z_sq", z), ("r_sq", r_raw), ("d_sq", d_raw)):
        d.op(name, (word,), f.exact, "square", lambda a: a.astype(object) ** 2)
    d.op("rd", (r_raw, d_raw), f.exact, "square", lambda a, b: a.astype(object) * b)  # d1^2 - d2^2
    plus, minus = lambda a, b: a + b, lambda a, b: a - b
    d.op("rho_sq", ("x_sq", "y_sq"), f.exact, "wide", plus)
    d.op("s", ("rho_sq", "z_sq"), f.exact, "wide", plus)
    d.op("a_far", ("r_sq", "s"), f.exact, "wide", minus)
    d.op("b_near", ("s", "d_sq"), f.exact, "wide", minus)
    d.op("k_law", ("s", "rd"), f.exact, "wide", plus)

    d.op("too_far", ("a_far", "bad_length"), d.bit, "mux", lambda a, bad: (a < 0).astype(bool) & ~bad)
    d.op("too_near", ("b_near", "bad_length"), d.bit, "mux", lambda b, bad: (b < 0).astype(bool) & ~bad)
    # No elbow: the arm is straight or folded along the line to the target.
    d.op("clamp", ("too_far", "too_near", "at_shoulder", "bad_length"), d.bit, "mux", lambda f, n, s, b: f | n | s | b)
    d.op("fold", ("too_near", "at_shoulder", "bad_length"), d.bit, "mux", lambda n, s, b: (n | s) & ~b)
    d.op("away", ("too_near", d_raw), d.bit, "mux", lambda n, q: n & (q < 0))


def _root(d: Domain, f: Lean, name: str, value: Node, width: int) -> None:
    """e_<name> (even shifts), m_<name> (mantissa) and inv_<name> = 1/(2 sqrt(m)) of the low ``width`` bits."""
    d.even(f"e_{name}", f"m_{name}", value, width, f.count, f.mantissa)
    d.rsqrt(f"inv_{name}", d.nodes[f"m_{name}"], f.inner)


def _limited(d: Domain, f: Lean, name: str) -> Node:
    """Wiring: 2, which powers of two can give, becomes the largest inner word: ``name`` from ``name``_raw."""
    top = f.inner.high
    return d.op(name, (f"{name}_raw",), f.inner, None, lambda v: np.minimum(v, top), lambda v: v)


def _magnitude(words):
    """|c|, or one less: the one's complement of what is negative."""
    return np.where(words < 0, ~words, words)


def direction(d: Domain, f: Lean) -> None:
    """(u_x, u_y) = (x, y)/rho, sin_el = z/|p|, cos_el = rho/|p|, and the half angles h1 and ht of azimuth and tilt.

    h(c, s) is the quaternion of the rotation with cosine c and sine s, not of unit length: (1 + c, s)/2, or
    (s, 1 - c)/2 where c < 0.  Its squared length is g = (1 + |c|)/2.
    """
    n = d.nodes
    w = d.width
    d.at("direction", "(10)")
    _root(d, f, "rho", n["rho_sq"], 2 * w)
    _root(d, f, "s", n["s"], 2 * w)
    for name, word, count in (("x_n", "x", "e_rho"), ("y_n", "y", "e_rho"), ("z_n", "z", "e_s")):
        # In the root's own unit: |x| <= rho, so nothing is lost at the top.
        up, scaled = lambda a, e: wrap(a << (e + f.pad), f.shifted.width), lambda a, e: a * 2.0 ** (e - 2)
        d.op(name, (word, count), f.shifted, "shift", up, scaled)
    d.mul3("u_x", n["x_n"], n["inv_rho"], f.inner, scale=1)
    d.mul3("u_y", n["y_n"], n["inv_rho"], f.inner, scale=1)
    d.mul3("sin_el", n["z_n"], n["inv_s"], f.inner, scale=1)
    d.mul3("l_rho", n["inv_rho"], n["m_rho"], f.inner, scale=1)  # sqrt(m)
    d.op("n_el", ("e_rho", "e_s"), f.count, "mux", lambda a, b: a - b)
    down, scaled = lambda a, e: a >> e, lambda a, e: a * 2.0**-e
    d.op("inv_s_el", ("inv_s", "n_el"), f.inner, "shift", down, scaled, FLOOR)
    d.mul3("cos_el", n["l_rho"], n["inv_s_el"], f.inner, scale=1)

    d.at(equation="(11)")
    one = 1 << f.frac
    big, big_real = lambda c: (one + _magnitude(c)) >> 1, lambda c: (1 + abs(c)) / 2
    # The first rotation turns by the azimuth and 90 degrees: cosine -u_y, sine u_x.  On the z axis, where both are 0,
    # azimuth 0 is taken: (1, 1)/2.
    d.op("g_1", ("u_y",), f.inner, "mux", big, big_real, FLOOR)
    for name, small_first in (("h1_c", lambda c, m: (c >= 0) & ~m), ("h1_s", lambda c, m: c < 0)):
        halve = lambda g, c, s, m, k=small_first: np.where(k(c, m), s >> 1, g)  # noqa: E731
        real = lambda g, c, s, m, k=small_first: np.where(k(c, m.astype(bool)), s / 2, g)  # noqa: E731
        d.op(name, ("g_1", "u_y", "u_x", "on_axis"), f.inner, "mux", halve, real, FLOOR)
    # The second turns by the angle between p and the z axis.  At the shoulder, where both are 0, +z is taken: (1, 0).
    raised = lambda c, m: np.where(m, one, big(c))  # noqa: E731
    raised_real = lambda c, m: np.where(m, 1.0, big_real(c))  # noqa: E731
    d.op("g_t", ("sin_el", "at_shoulder"), f.inner, "mux", raised, raised_real, FLOOR)
    for name, small_first in (("ht_c", lambda c: c < 0), ("ht_s", lambda c: c >= 0)):
        halve = lambda g, c, s, k=small_first: np.where(k(c), s >> 1, g)  # noqa: E731
        real = lambda g, c, s, k=small_first: np.where(k(c), s / 2, g)  # noqa: E731
        d.op(name, ("g_t", "sin_el", "cos_el"), f.inner, "mux", halve, real, FLOOR)


def triangle(d: Domain, f: Lean) -> None:
    """Qe (14) and the angle a at the shoulder, cos a = K/(2 d1 |p|), sin a = sqrt(A B)/(2 d1 |p|), as half angle ha."""
    n = d.nodes
    w = d.width
    one, unit = 1 << f.frac, 1 << (w - 2)  # of an inner word, of a result
    d.at("triangle", "(14)")
    _root(d, f, "a", n["a_far"], 2 * w)
    _root(d, f, "b", n["b_near"], 2 * w)
    _root(d, f, "1", n["d1"], f.even_width)
    _root(d, f, "2", n["d2"], f.even_width)
    d.mul3("l_a", n["inv_a"], n["m_a"], f.inner, scale=1)
    d.mul3("l_b", n["inv_b"], n["m_b"], f.inner, scale=1)
    # 1/(4 sqrt(m_1 m_2)); sqrt(A)/(2 sqrt(d1 d2)) = l_a inv_12 2^(3 - n_a), a number up to 1, and l_a >= 1/2
    d.mul3("inv_12", n["inv_1"], n["inv_2"], Format(f.frac + 3, f.frac + 1, "FRAC + 1"))
    for k in "ab":
        count = lambda e, a, b: (e - a - b + 2 + f.odd) & 63  # noqa: E731
        d.op(f"n_{k}", (f"e_{k}", "e_1", "e_2"), f.count, "mux", count)
        down, scaled = lambda v, e: (v << 2) >> e, lambda v, e: v * 2.0 ** (3 - e)
        d.op(f"v_{k}_raw", ("inv_12", f"n_{k}"), f.raised, "shift", down, scaled, FLOOR)
        _limited(d, f, f"v_{k}")
        d.mul3(f"el_{k}", n[f"l_{k}"], n[f"v_{k}"], f.inner)
    # The clamped elbow is folded (1, 0) or straight (0, -1).
    drop = f.frac - (w - 2)
    for name, of, sign in (("qe_w", "el_a", 1), ("qe_i", "el_b", -1)):
        shut = unit if sign > 0 else 0
        straight = 0 if sign > 0 else -unit
        rounded = lambda v, c, o, s=sign, a=shut, b=straight: np.where(  # noqa: E731
            c, np.where(o, a, b), (s * v + (1 << (drop - 1))) >> drop
        )
        real = lambda v, c, o, s=sign, a=shut, b=straight: np.where(c, np.where(o, a, b) / unit, s * v)  # noqa: E731
        d.op(name, (of, "clamp", "fold"), f.result, "mux", rounded, real, HALF_UP)

    d.at(equation="(13)")
    # 1/(4 d1 |p|) in the arms' and the target's own units, and twice that: t_a = 1/(4 m_1 sqrt(m_s))
    d.mul3("inv_11", n["inv_1"], n["inv_1"], f.inner)
    d.mul3("t_a_raw", n["inv_11"], n["inv_s"], f.doubled, scale=1)
    t_a = _limited(d, f, "t_a")
    # K in the same units: at most 2, because |K| <= 2 d1 |p|
    d.op("n_k", ("e_1", "e_s"), f.count, "mux", lambda a, b: (2 * a + b) & 63)
    raised, low = max(f.frac - 2 * w - f.odd + 1, 0), max(2 * w + f.odd - f.frac, 1)
    up = lambda k, e: wrap((k.astype(object) << (e + raised)) >> low, f.inner.width)  # noqa: E731
    scaled = lambda k, e: k * 2.0 ** (2 * w - 4) * 2.0 ** (e - 2 * w - f.odd)  # noqa: E731
    d.op("k_t", ("k_law", "n_k"), f.inner, "shift3", lambda k, e: up(k, e).astype(np.int64), scaled, FLOOR)
    d.mul3("cos_a", n["k_t"], t_a, f.inner, scale=1)
    d.mul3("l_ab", n["l_a"], n["l_b"], f.inner)
    count = lambda a, b, c, e: (a + b - 2 * c - e + f.odd + 2) & 63  # noqa: E731
    d.op("n_ab", ("e_a", "e_b", "e_1", "e_s"), f.count, "sum2", count)
    down, scaled = lambda v, e: (v << 2) >> e, lambda v, e: v * 2.0 ** (2 - e)
    d.op("v_ab_raw", ("t_a", "n_ab"), f.raised, "shift", down, scaled, FLOOR)
    v_ab = _limited(d, f, "v_ab")
    d.mul3("sin_a", n["l_ab"], v_ab, f.inner, scale=1)
    # The last rotation turns by -a.  A clamped arm lies along the line to the target, (1, 0), or away from it, (0, 1).
    big = lambda c, m: np.where(m, one, (one + _magnitude(c)) >> 1)  # noqa: E731
    big_real = lambda c, m: np.where(m, 1.0, (1 + abs(c)) / 2)  # noqa: E731
    d.op("g_a", ("cos_a", "clamp"), f.inner, "mux", big, big_real, FLOOR)
    for name, flip in (("ha_c", False), ("ha_s", True)):
        big_first = lambda c, m, a, k=flip: np.where(m, ~a.astype(bool), c >= 0) ^ k  # noqa: E731
        halve = lambda g, c, s, m, a, k=big_first: np.where(k(c, m, a), g, np.where(m, 0, s >> 1))  # noqa: E731
        real = lambda g, c, s, m, a, k=big_first: np.where(k(c, m, a), g, np.where(m, 0.0, s / 2))  # noqa: E731
        d.op(name, ("g_a", "cos_a", "sin_a", "clamp", "away"), f.inner, "mux", halve, real, FLOOR)


def turn(d: Domain, f: Lean, phi: Node) -> None:
    """Qs: the four rotations multiplied, by azimuth and 90 degrees, tilt, swivel and -a, divided by their length."""
    n = d.nodes
    w = d.width
    d.at("turn", "(17)")
    d.trig("sin_h", "cos_h", phi, f.inner)
    # c+, s+ and c-, s-: half the sum and half the difference of azimuth and swivel
    for name, a, b in (
        ("cc", "h1_c", "cos_h"), ("ss", "h1_s", "sin_h"), ("sc", "h1_s", "cos_h"), ("cs", "h1_c", "sin_h"),
    ):  # fmt: skip
        d.mul3(name, n[a], n[b], f.inner)
    plus, minus = lambda a, b: a + b, lambda a, b: a - b
    for name, a, b, how in (
        ("c_p", "cc", "ss", minus), ("c_m", "cc", "ss", plus), ("s_p", "sc", "cs", plus), ("s_m", "sc", "cs", minus),
    ):  # fmt: skip
        d.op(name, (a, b), f.inner, "mux", how, how)
    for name, a, b in (("w_0", "ht_c", "c_p"), ("i_0", "ht_s", "c_m"), ("j_0", "ht_s", "s_m"), ("k_0", "ht_c", "s_p")):
        d.mul3(name, n[a], n[b], f.inner)

    d.at(equation="(18)")
    for unit in "wijk":
        d.mul3(f"{unit}_c", n[f"{unit}_0"], n["ha_c"], f.inner)
        d.mul3(f"{unit}_s", n[f"{unit}_0"], n["ha_s"], f.inner)
    for name, a, b, how in (
        ("w_1", "w_c", "i_s", plus), ("i_1", "i_c", "w_s", minus),
        ("j_1", "j_c", "k_s", minus), ("k_1", "k_c", "j_s", plus),
    ):  # fmt: skip
        d.op(name, (a, b), f.inner, "mux", how, how)

    # The squared length is g_1 g_t g_a, in [1/8, 1]: the last root does not wait for the product.
    d.mul3("g_1t", n["g_1"], n["g_t"], f.inner)
    d.mul3("length_sq", n["g_1t"], n["g_a"], f.inner)
    quarter, top, up = 1 << (f.frac - 2), f.mantissa.high, f.mantissa.frac - f.frac
    low = d.op("low", ("length_sq",), d.bit, None, lambda t: t < quarter)
    d.op(
        "m_q", ("length_sq", low), f.mantissa, "mux", lambda t, low: np.minimum(t << np.where(low, up + 2, up), top),
        lambda t, low: np.where(low, 4 * t, t),
    )  # fmt: skip
    inv_q = d.rsqrt("inv_q", n["m_q"], f.inner)
    drop = f.frac - (w - 2)
    d.op("minus", ("k_1",), d.bit, None, lambda k: k < 0)
    for unit in "wijk":
        # doubled where the mantissa was taken from four times the length; the k part is not negative
        signed = lambda q, m, t: np.where(m, -1, 1) * (q << np.where(t, 1, 0))  # noqa: E731
        real = lambda q, m, t: np.where(m, -q, q) * np.where(t, 2.0, 1.0)  # noqa: E731
        d.op(f"{unit}_n", (f"{unit}_1", "minus", "low"), f.inner, "mux", signed, real)
        d.mul3(f"{unit}_q", n[f"{unit}_n"], inv_q, f.inner, scale=1)
        rounded = lambda v: (v + (1 << (drop - 1))) >> drop  # noqa: E731
        d.op(f"qs_{unit}", (f"{unit}_q",), f.result, "mux", rounded, lambda v: v, HALF_UP)

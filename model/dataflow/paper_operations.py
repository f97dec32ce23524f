# SPDX-License-Identifier: Apache-2.0
"""Operations of the paper's dataflow: rounded products and sums, division, root, CORDIC, normalization.

Method ``interval(node, bounds)`` returns the fields of a :class:`model.bounds.ranges.Bound`: low, high, error and
(floor, ceiling).
"""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np

from .angles import TABLE_BITS, atan_table
from .expressions import EXACT, FLOOR, HALF_UP, SCALED, Function, Operation, Product, Sum, Term, Unary, round_shift
from .lean_operations import room
from .nodes import Dataflow, Given, Node, RangeError
from .quadratic import HalfAngle

SINCOS_GUARD = 6
"""Guard bits of the CORDIC below a result's LSB; each of its W iterations drops less than the last guard bit."""

CORDIC = (-2.0, 2.0)
"""Error range of the CORDIC in ulps: each of W iterations drops less than 2^-6 ulp of either coordinate, the residual
angle is below one ulp, and the result is rounded."""


@cache
def cordic_gain() -> int:
    """Return round(2^TABLE_BITS prod_i 1/sqrt(1 + 4^-i)), the start value that cancels the gain of the rotations."""
    with mpmath.workprec(200):
        gain = mpmath.fprod(1 / mpmath.sqrt(1 + mpmath.mpf(4) ** -i) for i in range(100))
        return int(mpmath.nint(gain * 2**TABLE_BITS))


def floor_root(n, shift: int):
    """Return floor(sqrt(n 2^shift)) as ``ik_root`` computes it, 0 where n < 0.  n 2^shift must be below 2^63."""
    v = np.maximum(n, 0) << shift
    r = np.sqrt(v.astype(np.float64)).astype(np.int64)
    # The float of v has a relative error of at most 2^-53, its root an error of at most half an ulp, so r is at most 1
    # too large, and never too small.
    return r - (r * r > v)


def cordic(phi, width: int):
    """Return (sin, cos) of phi/2 as ``ik_sincos`` computes them: words with one integer bit.  One turn is 2^width."""
    drop = TABLE_BITS - (width + SINCOS_GUARD)
    inner = width + SINCOS_GUARD - 2  # internal fraction bits
    angles = [round_shift(a, drop) for a in atan_table()]
    z = phi << SINCOS_GUARD
    x = np.full_like(z, round_shift(cordic_gain(), TABLE_BITS - inner))
    y = np.zeros_like(z)
    for i in range(width):
        left = z >= 0
        x, y = np.where(left, x - (y >> i), x + (y >> i)), np.where(left, y + (x >> i), y - (x >> i))
        z = np.where(left, z - angles[i], z + angles[i])
    return round_shift(y, SINCOS_GUARD), round_shift(x, SINCOS_GUARD)


def sincos_bound(width: int) -> float:
    """Return an upper bound of the error of ``ik_sincos`` in ulps of 2^-(width-2).

    The errors that add up, in units g = 2^-G ulp, with G guard bits:

    * Each iteration i >= 1 drops less than 1 g of x and of y, a vector shorter than sqrt(2) g.  Each later iteration j
      stretches this vector by sqrt(1 + 4^-j).  The shift of iteration 0 is exact.
    * The rounding error of the gain word is stretched by K = 1.6468.
    * One ulp of the angle z is pi/4 g as an arc.  After n = width iterations the residual angle is at most the last
      table angle, atan(2^-(n-1)).  The rounding of each table angle counts twice: once in the angle turned, and once in
      the residual angle, because the sum of the remaining rounded angles may be too small by the same amount.
    * Rounding the result adds half an ulp.
    """
    inner = width + SINCOS_GUARD
    stretch = [math.prod(math.sqrt(1 + 4.0**-j) for j in range(i + 1, width)) for i in range(width)]
    lost = math.sqrt(2) * sum(stretch[1:])
    with mpmath.workprec(200):
        exact = mpmath.fprod(1 / mpmath.sqrt(1 + mpmath.mpf(4) ** -i) for i in range(100))
        off = float(abs(round_shift(cordic_gain(), TABLE_BITS - inner + 2) - exact * 2 ** (inner - 2)))
        angles = (mpmath.atan(mpmath.mpf(2) ** -i) / mpmath.pi * 2**inner for i in range(width))
        words = (round_shift(word, TABLE_BITS - inner) for word in atan_table())
        table = float(sum(abs(word - angle) for word, angle in zip(words, angles, strict=False)))
    gain = off * stretch[0] * math.sqrt(2)
    angle = math.atan(2.0 ** (1 - width)) * 2.0 ** (inner - 2) + 2 * table * math.pi / 4
    return 0.5 + (lost + gain + angle) / 2**SINCOS_GUARD


class Saturating(Operation):
    """Operation that saturates the words ``unlimited(node, values)`` to the node's format."""

    unlimited: Callable[..., Any]

    def result(self, node, values):
        return np.clip(self.unlimited(node, values), node.format.low, node.format.high)


class Rounded(Saturating):
    """Operation that rounds half up and saturates."""

    def error(self, node):
        if self.frac < node.frac:
            raise RangeError(f"{node.name}: {node.frac} fraction bits, its operation has only {self.frac}")
        return HALF_UP if self.frac > node.frac else EXACT

    def unlimited(self, node, values):
        return round_shift(self.words(values), self.frac - node.frac)


class Mul(Rounded, Product):
    """Product a * b * 2^scale, rounded half up and saturated."""

    kind, latency = "mul", "mul"

    def interval(self, node, bounds):
        a, b = self.parts
        p, q, square = bounds(a), bounds(b), a is b
        ends = [u * v * 2.0**self.scale for u in (p.low, p.high) for v in (q.low, q.high)]
        low = 0.0 if square and p.low <= 0 <= p.high else min(p.low**2, p.high**2) if square else min(ends)
        error = (p.size * q.error + q.size * p.error + p.error * q.error) * 2.0**self.scale
        rounding = 0.5 * node.format.ulp if self.frac > node.frac else 0.0
        words = [u * v * 2.0**self.scale for u in p.word for v in q.word]
        least = 0.0 if square else min(words) - rounding  # rounding half up preserves the sign
        return low, max(ends), error + rounding, (least, max(words) + rounding)


class Total(Rounded, Sum):
    """Sum of two or three terms with equal fraction bits, rounded half up and saturated."""

    kind = "sum"

    def __init__(self, total: Sum) -> None:
        super().__init__(*total.terms)
        self.latency = f"sum{len(self.terms)}"

    def error(self, node):
        if len({term.frac for term in self.operands}) != 1:
            raise RangeError(f"{node.name}: terms are not aligned")
        return super().error(node)

    def interval(self, node, bounds):
        terms = [(sign, bounds(term)) for sign, term in self.terms]
        low = sum(bound.low if sign > 0 else -bound.high for sign, bound in terms)
        high = sum(bound.high if sign > 0 else -bound.low for sign, bound in terms)
        rounding = 0.5 * node.format.ulp if self.frac > node.frac else 0.0
        words = [bound.word if sign > 0 else (-bound.word[1], -bound.word[0]) for sign, bound in terms]
        least = sum(word[0] for word in words)
        word = least - (rounding if least < 0 else min(rounding, least)), sum(word[1] for word in words) + rounding
        return low, high, sum(bound.error for _, bound in terms) + rounding, word


class Div(Saturating):
    """Quotient floor(n / d), saturated.  Proved ranges exclude divisors <= 0 (:meth:`interval`)."""

    kind, latency, rounds = "div", "div", FLOOR
    pattern, inner = "{} / {}", SCALED

    def __init__(self, n: Term, d: Term) -> None:
        super().__init__(n, d)
        self.n, self.d = n, d

    def unlimited(self, node, values):
        return (self.n.words(values) << node.frac - self.n.frac + self.d.frac) // self.d.words(values)

    def real_result(self, node, values):
        n, d = self.n.words(values), self.d.words(values)
        quotient = n / np.where(d > 0, d, 2.0 ** (self.d.frac - node.frac))
        return np.clip(quotient * 2.0 ** (node.frac - self.n.frac + self.d.frac), node.format.low, node.format.high)

    def interval(self, node, bounds):
        p, q, fmt = bounds(self.n), bounds(self.d), node.format
        least = q.word[0]
        if q.low <= 0 or least <= 0:
            problem = f"[{q.low:.9g}, {q.high:.9g}] +- {q.error:.3g}"
            raise RangeError(f"{node.name}: its divisor {self.d.text()} may be 0: {problem}")
        ends = [u / v for u in (p.low, p.high) for v in (q.low, q.high)]
        size = min(max(map(abs, ends)), bounds.limit(node))
        words = [u / v for u in p.word for v in q.word]
        word = min(words) - fmt.ulp, max(words)
        return min(ends), max(ends), (p.error + size * q.error) / least + fmt.ulp, word


class Root(Unary):
    """Square root floor(sqrt(n)); 0 where n < 0."""

    kind, latency, rounds = "root", "root", FLOOR

    def result(self, node, values):
        return floor_root(self.term.words(values), 2 * node.frac - self.term.frac)

    def real_result(self, node, values):
        return np.sqrt(np.maximum(self.term.words(values), 0) * self.term.format.ulp) / node.format.ulp

    def interval(self, node, bounds):
        v, ulp = bounds(self.term), node.format.ulp
        low, high = math.sqrt(max(v.low, 0)), math.sqrt(max(v.high, 0))
        # |sqrt a - sqrt b| = |a - b| / (sqrt a + sqrt b), at most sqrt |a - b|; below 0 both roots are 0.
        ends = low + math.sqrt(max(v.word[0], 0))
        error = math.sqrt(v.error) if ends == 0 else min(v.error / ends, math.sqrt(v.error))
        word = tuple(math.sqrt(max(w, 0)) for w in v.word)
        return low, high, error + ulp, (max(word[0] - ulp, 0.0), word[1])

    def text(self, level=0):
        return f"sqrt {self.term.text(SCALED)}"


class SineCosine(HalfAngle):
    """Sine or cosine of phi/2 by the CORDIC."""

    kind, latency, rounds = "sincos", "sincos", CORDIC

    def pair(self, node, phi):
        return cordic(phi, node.flow.width)

    def interval(self, node, bounds):
        return -1.0, 1.0, CORDIC[1] * node.format.ulp, (-math.inf, math.inf)


def leading_bits(*vector: Node) -> Function:
    """Return the left shift by which a vector's largest word fills its format; 0 for the all-zero vector."""

    def count(*words):
        shifts = [room(word, vector[0].format.width) for word in words]
        return np.where(np.any(words, axis=0), np.minimum.reduce(shifts), 0)

    return Function(count, f"leading_sign_bits({', '.join(['{}'] * len(vector))})", *vector, frac=0)


class Normalized(Operation):
    """Word ``index`` of a vector, shifted left by ``count``; the all-zero vector becomes (1/2, 0, ..)."""

    kind, latency = "normalize", "norm"

    def __init__(self, count: Term, words: tuple[Term, ...], index: int) -> None:
        super().__init__(*words)
        self.count, self.index = count, index

    def result(self, node, values):
        words = [word.words(values) for word in self.operands]
        empty, half = np.logical_and.reduce([word == 0 for word in words]), 1 << node.format.width - 2
        return np.where(empty, 0 if self.index else half, words[self.index] << self.count.words(values))

    def real_result(self, node, values):
        word = self.operands[self.index]
        empty = np.logical_and.reduce([values.word(name.name) == 0 for name in self.operands])
        scaled = word.words(values) * 2.0 ** (self.count.words(values) + node.format.width - word.format.width)
        return np.where(empty, 0.0 if self.index else 0.5 / node.format.ulp, scaled)

    def text(self, level=0):
        return f"{self.operands[self.index].name} << {self.count.text()}"


def normalize(d: Dataflow, names: tuple[str, ...], words: tuple[Node, ...], count: str, within: Given) -> Node:
    """Shift a vector's ``words`` left together until the largest fills its format; return the node of the shift count.

    The nodes ``names`` of the shifted words are mantissas in [-1, 1) with the range ``within``.  They are exact: a
    shift changes the unit, not the vector.  The all-zero vector becomes (1/2, 0, ..).
    """
    bits = Given("leading sign bits", lambda case: (0, words[0].format.width - 1))
    counts = d.node(count, leading_bits(*words), d.count, "norm", within=bits)
    for index, name in enumerate(names):
        d.node(name, Normalized(counts, words, index), d.word(0), within=within)
    return counts

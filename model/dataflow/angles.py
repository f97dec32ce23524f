# SPDX-License-Identifier: Apache-2.0
"""Angle and length of a vector of two words: the vectoring CORDIC of ``ik_vector`` and ``ik_fold_angle``.

Words have W bits and W-2 fraction bits.  Internally, the components have ``GUARD`` more bits; an angle has W +
``ANGLE`` bits, one turn = 2^(W+ANGLE).  Iteration i turns by atan(2^-i); y is held as Y = 2^i y, so that it loses no
bit:

    X += |Y| / 4^i   (only for i < M: later changes are too small to matter)
    Y = 2 (Y - X) or, below the x axis, 2 (Y + X)

The computed length of every vector is K = 1.6468 times its true length.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import mpmath
import numpy as np
from mpmath.ctx_iv import MPIntervalContext

from .expressions import Operation, magnitude, number, round_shift, wrap

if TYPE_CHECKING:
    from .nodes import Node

iv = MPIntervalContext()
iv.prec = 200
Interval = Any  # of mpmath, whose ends are .a and .b

GUARD = 3  # bits of X and Y below a word's LSB
ANGLE = 4  # bits of an angle below the LSB of a word of one turn

LONGEST = 2.4
"""Longest vector for which X and Y fit.  A vector of two parts of a unit quaternion is at most 1 long; a vector of two
computed lengths, each K times the true one, at most K."""


TABLE_BITS = 48
"""Fraction bits of the CORDICs' tables, before they are rounded to the word length in use."""


@cache
def atan_table() -> tuple[int, ...]:
    """Return round(atan(2^-i) / pi * 2^TABLE_BITS), i = 0..31: the CORDICs' angles as fractions of half a turn."""
    with mpmath.workprec(200):
        angles = (mpmath.atan(mpmath.mpf(2) ** -i) / mpmath.pi for i in range(32))
        return tuple(int(mpmath.nint(a * 2**TABLE_BITS)) for a in angles)


def iterations(width: int) -> tuple[int, int]:
    """Return (M, N): the number of iterations that change X, and the number of all iterations."""
    head = (width + 1) // 2 - 1
    return head, min(width + 1, head + 16)


@cache
def table(width: int) -> tuple[int, ...]:
    """Return the angle words of the N iterations.  Word i is rounded for i <= M; later words are word M / 2^(i - M)."""
    head, last = iterations(width)
    words = [round_shift(atan, TABLE_BITS + 1 - width - ANGLE) for atan in atan_table()[: head + 1]]
    return (*words, *(words[head] >> i for i in range(1, last - head)))


def vector(x, y, width: int):
    """Return (length, angle) of vectors whose components are words.

    A length is K times the true length and has W+1 fraction bits.  An angle is signed and has W + ``ANGLE`` bits.
    """
    return iterate(x << GUARD, y << GUARD, width)


def iterate(x, y, width: int):
    """Return (length, angle) like :func:`vector`, for components with ``GUARD`` more bits, such as computed lengths.

    A vector to the left of the y axis is first turned by half a turn; its X is a one's complement.  The angle of a
    vector on an axis is exact: rounding changes neither half a turn nor twice a quarter of a turn.
    """
    head, _ = iterations(width)
    left, quarter = x < 0, 1 << width + ANGLE - 2
    start = np.where(left, 2 * quarter, 0)
    exact = np.where(y == 0, start, np.where(y < 0, -quarter, quarter))
    on_axis = (x == 0) | (y == 0)
    x, y, z = magnitude(x), np.where(left, -y, y), start
    for i, turn in enumerate(table(width)):
        below = y < 0
        step = magnitude(y) >> 2 * i if i < head else 0
        # Only vectors longer than LONGEST lose bits here.
        y = wrap(2 * np.where(below, y + x, y - x), width + GUARD + 2)
        x = (x + step) & (1 << width + GUARD) - 1
        z = np.where(below, z - turn, z + turn)
    return x, wrap(np.where(on_axis, exact, z), width + ANGLE)


def gain(width: int) -> float:
    """Return K, the factor by which :func:`vector` stretches lengths."""
    return math.prod(math.sqrt(1 + 4.0**-i) for i in range(iterations(width)[0]))


class Head(NamedTuple):
    """Error limits for vectors of at least a given length: the upper ends of intervals that are rounded outwards.

    * ``along``, ``across``: sum of the roundings of X, as components along and across the given vector, in LSBs of X
    * ``lost``: angle by which these roundings turn the vector; ``left``: angle left after the first M iterations (rad)
    * ``rest``: error of the computed angle apart from ``lost``
    * ``gain``: K
    """

    along: Interval
    across: Interval
    lost: Interval
    left: Interval
    rest: Interval
    gain: Interval


def upper(*limits: Interval) -> Interval:
    """Return the largest upper end of the intervals."""
    return iv.mpf(max(iv.mpf(limit).b for limit in limits))


def arc(sine: Interval) -> Interval:
    """Return an upper limit of the angle whose sine is ``sine``."""
    return sine / iv.sqrt(1 - sine**2)


@cache
def head(width: int, length: Interval) -> Head:
    """Return the errors for vectors of at least ``length``.

    * Each rounding shortens X by at most 1: the one's complement of X at the start, and each truncated |Y| / 4^i, where
      |Y| is the one's complement of a negative Y.  X never decreases; after iteration 0 it is at least |x| + |y| - 2.
    * By the law of sines, a rounding turns a vector at an angle psi from the x axis by at most asin(sin(psi) / l),
      where l is its rounded length.  The angle left after iteration i is at most this turn plus the larger of a_i =
      atan(2^-i) and the difference between the angle left before the iteration and a_i.
    * The error of a word of the table is its difference from a_i in the first M iterations, and from 2^-i later: X is
      then constant, so each iteration changes t, the tangent of the angle left, by 2^-i.  These later words add up to t
      instead of atan(t), a difference below t^3 / 3.  At the end, t is at most the larger of 2^-(N-1) and the previous
      t minus 2^-(N-1).
    """
    first, last = iterations(width)
    one, quarter, long = iv.mpf(1), iv.pi / 2, iv.mpf(length) * 2 ** (width - 2 + GUARD)
    gain, along, across, left, lost, short = one, one, one, quarter, arc(1 / (long - 1)), long - 1
    steps = [iv.atan2(one, iv.mpf(2**i)) if i < first else iv.mpf(2) ** -i for i in range(last)]
    for turn in steps[:first]:
        left = upper(turn, left - turn)
        if (left + lost).b >= quarter.a:  # roundings might lengthen the vector
            raise ValueError(f"length {length}: less than a word")
        stretch = 1 / iv.cos(turn)
        gain, short = gain * stretch, max(short * stretch - 1, long - 2, key=lambda size: size.a)
        along, across = along + 1 / gain, across + iv.sin(left + lost) / gain
        off = arc(iv.sin(left) / short)
        lost, left = lost + off, left + off
    words = sum(abs(word * iv.pi / 2 ** (width + 3) - step) for word, step in zip(table(width), steps, strict=True))
    tangent = iv.tan(left)
    cubed = tangent**3 / 3
    for step in steps[first:]:
        tangent = upper(step, tangent - step)
    return Head(upper(along), upper(across), upper(lost), left, upper(words + cubed + tangent), gain)


def length_bound(width: int, length: float = 1.0) -> float:
    """Return the largest error of the computed length of a vector no longer than ``length``, in ulps of 2^-(W+1).  A
    computed length is never too large.

    The computed length is at least K (l - ``along``) times the cosine of the angle left, l being the true length.  This
    angle depends on l, so the bound is the largest over all ranges of l from ``length`` / 2^(k+1) to ``length`` / 2^k.
    """
    word = 2.0 ** (2 - width)
    cells = [(length / 2**k, head(width, max(length / 2 ** (k + 1), word))) for k in range(width)]
    share = upper(*(iv.mpf(long) * 2 ** (width + 1) * (1 - iv.cos(part.left)) for long, part in cells))
    return float((cells[0][1].gain * (share + cells[0][1].along)).b)


class Angle(Operation):
    """Angle of a vector: atan2(+-y, x), a binary angle whose unit is half a turn."""

    kind, latency, free = "vector", "vector", True

    length: Node | None = None  # node of the vector's length times K, if there is one

    def __init__(self, x: Node, y: Node, sign: int = 1) -> None:
        super().__init__(x, y)
        self.x, self.y, self.sign = x, y, sign

    def pair(self, node, values):
        """Return two words: the vector's length times K, and its angle."""
        if self not in values:
            width = node.flow.width
            of = vector if self.x.frac == width - 2 else iterate  # words, or lengths
            values[self] = of(self.x.words(values), self.sign * self.y.words(values), width)
        return values[self]

    def result(self, node, values):
        return self.pair(node, values)[1]

    def real_result(self, node, values):
        return np.arctan2(self.sign * self.y.words(values), self.x.words(values)) / (np.pi * node.format.ulp)

    def growth(self, node, bounds):
        # The error grows as the vector gets shorter, up to half a turn: there is no useful bound.
        return 0.0

    def text(self, level=0):
        return f"atan2({'-' * (self.sign < 0)}{self.y.text()}, {self.x.text()})"

    def lower(self, to, node):
        to.vector(node, self.length and self.length.name, self.x, self.y, self.sign)


class Gained(Operation):
    """Length of an :class:`Angle`'s vector, multiplied by K."""

    kind, latency = "vector", "vector_x"

    def __init__(self, angle: Angle) -> None:
        super().__init__(angle.x, angle.y)
        self.angle = angle

    def result(self, node, values):
        return self.angle.pair(node, values)[0]

    def real_result(self, node, values):
        length = np.hypot(self.angle.x.words(values), self.angle.y.words(values)) * self.angle.x.format.ulp
        return gain(node.flow.width) * length / node.format.ulp

    def growth(self, node, bounds):
        width = node.flow.width
        return length_bound(width, node.within.high / gain(width)) * 2.0 ** -(width + 1)

    def facts(self, node, domain):
        x, y = (part.formula(domain) for part in self.parts)
        gained = number(Fraction(gain(node.flow.width)) ** 2)
        square = f"(+ (* {x} {x}) (* {y} {y}))"
        return [f"(<= 0.0 {node.name})", f"(= (* {node.name} {node.name}) (* {gained} {square}))"]

    def text(self, level=0):
        return f"K * |({self.angle.x.text()}, {self.angle.y.text()})|"

    def lower(self, to, node):
        pass  # made with its angle

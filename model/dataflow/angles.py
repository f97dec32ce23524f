# SPDX-License-Identifier: Apache-2.0
"""Angle and length of a vector of two words: the vectoring CORDIC of ``ik_vector`` and ``ik_fold_angle``.

Words have W bits and W-2 fraction bits.  Inside, the components have ``GUARD`` more bits; an angle has W + ``ANGLE``
bits, one turn = 2^(W+ANGLE).  Rotation i turns by atan(2^-i); y is held as Y = 2^i y, so that no bit of it is lost:

    X += |Y| / 4^i   (i < M: afterwards X changes by less than its last bits)
    Y = 2 (Y - X) or, below the x axis, 2 (Y + X)

The computed length is K = 1.6468 times the true one, for every vector.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from .expressions import Operation, magnitude, number, round_shift, wrap

if TYPE_CHECKING:
    from .nodes import Node

GUARD = 3  # bits of X and Y below a word's LSB
ANGLE = 4  # bits of an angle below the LSB of a word of one turn

LONGEST = 2.4
"""Length up to which X and Y fit; a unit quaternion's lengths are at most 1, and K in :func:`iterate`."""


TABLE_BITS = 48
"""Fraction bits of the CORDICs' tables, before they are rounded to the word length in use."""


@cache
def atan_table() -> tuple[int, ...]:
    """Return round(atan(2^-i) / pi * 2^TABLE_BITS), i = 0..31: the CORDICs' angles as fractions of half a turn."""
    with mpmath.workprec(200):
        angles = (mpmath.atan(mpmath.mpf(2) ** -i) / mpmath.pi for i in range(32))
        return tuple(int(mpmath.nint(a * 2**TABLE_BITS)) for a in angles)


def iterations(width: int) -> tuple[int, int]:
    """Return (M, N): iterations in which X changes, and all."""
    head = (width + 1) // 2 - 1
    return head, min(width + 1, head + 16)


@cache
def table(width: int) -> tuple[int, ...]:
    """Return the angle words of the N iterations: rounded up to the M-th, which each further iteration halves."""
    head, last = iterations(width)
    words = [round_shift(atan, TABLE_BITS + 1 - width - ANGLE) for atan in atan_table()[: head + 1]]
    return (*words, *(words[head] >> i for i in range(1, last - head)))


def vector(x, y, width: int):
    """Return (length, angle) of vectors of words: W+1 fraction bits; W + ``ANGLE`` bits, signed."""
    return iterate(x << GUARD, y << GUARD, width)


def iterate(x, y, width: int):
    """Return (length, angle) as :func:`vector`, of vectors that have ``GUARD`` more bits: two lengths, for example.

    A vector to the left of the y axis is first turned by half a turn; its X is a one's complement.  A vector on the
    x axis has exactly the angle 0 or half a turn: no angle of a quaternion is a last bit below 0.
    """
    head, _ = iterations(width)
    left, flat = x < 0, y == 0
    start = np.where(left, 1 << width + ANGLE - 1, 0)
    x, y, z = magnitude(x), np.where(left, -y, y), start
    for i, turn in enumerate(table(width)):
        below = y < 0
        step = magnitude(y) >> 2 * i if i < head else 0
        # Only vectors longer than LONGEST lose bits here.
        y = wrap(2 * np.where(below, y + x, y - x), width + GUARD + 2)
        x = (x + step) & (1 << width + GUARD) - 1
        z = np.where(below, z - turn, z + turn)
    return x, wrap(np.where(flat, start, z), width + ANGLE)


def gain(width: int) -> float:
    """Return K, by which :func:`vector` stretches a length."""
    return math.prod(math.sqrt(1 + 4.0**-i) for i in range(iterations(width)[0]))


def _head(width: int, length: float) -> tuple[float, float, float]:
    """Return bounds after the first M iterations: the angle lost to roundings, the angle left, the length lost.

    In units g of X's LSB.  A rounding shortens X by at most 1 g: the one's complement of X at the start, and each
    |Y| / 4^i, which is a one's complement where Y < 0 and loses the bits below.  By the law of sines, it turns a vector
    of length l that is psi from the x axis by at most asin(sin(psi) / l), where l is the shortened length.  The angle
    left after iteration i is at most a_i = atan(2^-i), or what was left before less a_i, plus this turn.
    """
    long = length * 2.0 ** (width - 2 + GUARD)
    short, left = long - 1, math.pi / 2
    lost = math.asin(min(1 / max(short, 1), 1))
    for i in range(iterations(width)[0]):
        turn = math.atan(2.0**-i)
        left = max(turn, left - turn)
        short = short * math.sqrt(1 + 4.0**-i) - 1
        long *= math.sqrt(1 + 4.0**-i)
        off = math.asin(min(math.sin(min(left, math.pi / 2)) / max(short, 1), 1))
        lost, left = lost + off, left + off
    return lost, left, long - short * math.cos(min(left, math.pi / 2))


def length_bound(width: int, length: float = 1.0) -> float:
    """Return the largest error of a length in its ulps, 2^-(W+1); it is never too long.

    X is K times the length, less the roundings of :func:`_head`, times the cosine of the angle left.
    """
    return _head(width, length)[2]


def error_bound(width: int, length: float = 1.0) -> float:
    """Return the largest error of the angle of a vector of at least ``length`` in radians.

    * lost and left: the roundings of the first M iterations and the angle left after them (:func:`_head`);
    * table: the rounding of each of these M angles, at most half an ulp;
    * in the other iterations X stays, so that they change the tangent t of the angle left by 2^-i each: the angle's
      words sum t instead of atan(t), a difference below t^3 / 3; each word differs from 2^-i;
    * the tangent left at last: at most 2^-(N-1), or what was left before less 2^-i.
    """
    head, last = iterations(width)
    radians = [word * 2 * math.pi / 2.0 ** (width + ANGLE) for word in table(width)]
    steps = [math.atan(2.0**-i) if i < head else 2.0**-i for i in range(last)]
    words = sum(abs(word - step) for word, step in zip(radians, steps, strict=True))
    lost, left, _ = _head(width, length)
    if left >= math.pi / 2:
        return math.pi
    tangent = math.tan(left)
    cubed = tangent**3 / 3
    for step in steps[head:]:
        tangent = max(step, tangent - step)
    return min(lost + words + cubed + tangent, math.pi)


class Angle(Operation):
    """Angle of a vector: atan2(+-y, x), a binary angle whose unit is half a turn."""

    kind, latency, free = "vector", "vector", True

    length: Node | None = None  # node of the gained length, if it has one

    def __init__(self, x: Node, y: Node, sign: int = 1) -> None:
        super().__init__(x, y)
        self.x, self.y, self.sign = x, y, sign

    def pair(self, node, values):
        """Return length and angle."""
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
        # The error has no bound but half a turn: it grows as the vector gets shorter.
        return 0.0

    def text(self, level=0):
        return f"atan2({'-' * (self.sign < 0)}{self.y.text()}, {self.x.text()})"

    def lower(self, to, node):
        to.vector(node, self.length and self.length.name, self.x, self.y, self.sign)


class Gained(Operation):
    """Length of an :class:`Angle`'s vector, times K."""

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

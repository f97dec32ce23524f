# SPDX-License-Identifier: Apache-2.0
"""A function from a table, as ``ik_quadratic`` computes it: c0 -+ u (c1 -+ c2 u) in each of many segments.

u is how far the argument is from the segment's middle.  Here are the words of the table, the bits of the result, and
the proof of its error; ``cores.py`` has the reciprocal square root, ``trig.py`` the sine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mpmath

PRECISION = 200
"""Bits that tables and proofs are computed with; 2^-190 changes nothing in either."""

Function = Callable[[mpmath.mpf], mpmath.mpf]
Segment = tuple[mpmath.mpf, mpmath.mpf]
"""Its left end and its width."""


@dataclass(frozen=True)
class Interval:
    """What an error is proved to lie in."""

    low: mpmath.mpf
    high: mpmath.mpf

    def __add__(self, other: Interval) -> Interval:
        return Interval(self.low + other.low, self.high + other.high)

    @property
    def size(self) -> mpmath.mpf:
        """The largest magnitude."""
        return max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class Form:
    """The words of ``ik_quadratic``.  Without a c2 the slope is c1, and the function is taken as straight."""

    rows: int
    u_frac: int  # fraction bits of u, u_low of them below its tile
    u_low: int
    c_frac: tuple[int, ...]  # of the table's words, all unsigned
    c_bits: tuple[int, ...]  # and their widths
    slope_frac: int  # of c1 -+ c2 u, slope_low of them below its tile
    slope_low: int
    sum_frac: int  # of what is added to c0

    @property
    def tiles(self) -> int:
        """Of slope times u: the tile of the low parts is left out."""
        return 3 if self.slope_low else 1

    @property
    def index_bits(self) -> int:
        """Of the number of a row."""
        return self.rows.bit_length() - 1

    @property
    def clocks(self) -> int:
        """Of ``ik_quadratic``: operands, slope times u, sum, result; before them operands, c2 u, slope."""
        return 4 + (len(self.c_frac) > 2) * 3


def interpolant(form: Form, function: Function, segment: Segment) -> list[mpmath.mpf]:
    """c0, c1, and c2 if the form has one, with their signs: the function is met at the Chebyshev nodes."""
    left, width = segment
    middle = left + width / 2
    a = mpmath.sqrt(len(form.c_frac)) / 4 * width
    low, high = function(middle - a), function(middle + a)
    if len(form.c_frac) < 3:
        return [(low + high) / 2, (high - low) / (2 * a)]
    return [function(middle), (high - low) / (2 * a), (low - 2 * function(middle) + high) / (2 * a * a)]


def words(form: Form, function: Function, segment: Segment) -> tuple[int, ...]:
    """A row of the table, magnitudes: each rounded to nearest, c0 after half of what the rounding of c2 does at the
    segment's ends has been taken off."""
    c0, *c = interpolant(form, function, segment)
    rounded = [mpmath.nint(abs(value) * 2**frac) for value, frac in zip(c, form.c_frac[1:], strict=True)]
    for word, value, frac in list(zip(rounded, c, form.c_frac[1:], strict=True))[1:]:
        c0 -= (mpmath.sign(value) * word / 2**frac - value) * segment[1] ** 2 / 8
    return tuple(int(word) for word in (mpmath.nint(c0 * 2 ** form.c_frac[0]), *rounded))


def polynomial(form: Form, row, u, rises: bool, bends_up: bool):
    """c0 + u slope, or c0 - u slope unless the function ``rises``; the slope is c1 + c2 u where it becomes steeper with
    u, ``bends_up``, else c1 - c2 u.  ``sum_frac`` fraction bits."""
    c0, c1, *c2 = row
    u_hi, u_lo = u >> form.u_low, u & (1 << form.u_low) - 1
    u_frac = form.u_frac - form.u_low
    slope = c1 << form.slope_frac - form.c_frac[1]
    for word in c2:
        bend = word * u_hi >> form.c_frac[2] + u_frac - form.slope_frac
        slope = slope + bend if bends_up else slope - bend
    slope_hi, slope_lo = slope >> form.slope_low, slope & (1 << form.slope_low) - 1
    drop = form.slope_frac - form.slope_low + u_frac - form.sum_frac
    change = slope_hi * u_hi >> drop
    if form.tiles > 1:
        change = change + (slope_hi * u_lo >> drop + form.u_low) + (slope_lo * u_hi >> drop + form.slope_low)
    return (c0 << form.sum_frac - form.c_frac[0]) + (change if rises else -change)


def interpolation_error(form: Form, segment: Segment, derivative: mpmath.mpf) -> mpmath.mpf:
    """Largest |c0 + c1 u + c2 u^2 - function| in a segment, before the coefficients' rounding.

    ``derivative`` is the largest magnitude in the segment of the derivative after the last that the form follows.  The
    error is the third derivative /6 times (u + a) u (u - a), at most 1/32 of the cube of the segment's width; of a
    straight form, the second one /2 times (u + a) (u - a), at most 1/8 of its square.
    """
    width = segment[1]
    return derivative * width**2 / 16 if len(form.c_frac) < 3 else derivative * width**3 / 192


def error(form: Form, function: Function, segment: Segment, row, derivative: mpmath.mpf, rises: bool) -> Interval:
    """:func:`polynomial` of a row of the table, as it is, less the function, for all u of its segment.

    * The interpolation (:func:`interpolation_error`).
    * The coefficients' rounding, as it is: r0 + r1 u + r2 u^2.
    * The slope is off by less than one of its places and c2 times a place of u's upper part; times u.
    * Each tile is too small by less than a place of the sum; and the tile left out.
    """
    width = segment[1]
    exact = interpolant(form, function, segment)
    rounded = (mpmath.sign(c) * word / 2**bits for c, word, bits in zip(exact, row, form.c_frac, strict=True))
    r0, r1, *r2 = (word - c for word, c in zip(rounded, exact, strict=True))
    one = mpmath.mpf(1)
    u_place = one / 2 ** (form.u_frac - form.u_low)
    slope = mpmath.mpf(0)
    bend = mpmath.mpf(0)
    if r2:
        slope = one / 2**form.slope_frac + (mpmath.mpf(row[2]) / 2 ** form.c_frac[2] * u_place if form.u_low else 0)
        bend = r2[0] * width**2 / 4
    aside = interpolation_error(form, segment, derivative) + (abs(r1) + slope) * width / 2
    left_out = u_place / 2 ** (form.slope_frac - form.slope_low) if form.u_low else 0
    tiles = form.tiles * one / 2**form.sum_frac + left_out
    low, high = (tiles, 0) if rises else (0, tiles)
    return Interval(r0 + min(bend, 0) - aside - low, r0 + max(bend, 0) + aside + high)

# SPDX-License-Identifier: Apache-2.0
"""Table-based function, as ``ik_quadratic`` computes it: c0 -+ u (c1 -+ c2 u) in each segment.

u is the distance of the argument from the segment's middle.  This module has the table's words, the result's bits and
the proof of its error; ``cores.py`` has the reciprocal square root, ``trig.py`` the sine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mpmath

PRECISION = 200
"""Precision of tables and proofs in bits; an error of 2^-190 changes neither."""

Function = Callable[[mpmath.mpf], mpmath.mpf]
Segment = tuple[mpmath.mpf, mpmath.mpf]
"""Left end and width of a segment."""


@dataclass(frozen=True)
class Interval:
    """Proved range of an error."""

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
    """Formats of ``ik_quadratic``.  Without c2 the slope is c1, and the function is treated as linear."""

    rows: int
    u_frac: int  # fraction bits of u, u_low of them below its tile
    u_low: int
    c_frac: tuple[int, ...]  # of the table's words, all unsigned
    c_bits: tuple[int, ...]  # widths of the table's words
    slope_frac: int  # of c1 -+ c2 u, slope_low of them below its tile
    slope_low: int
    sum_frac: int  # fraction bits of the term added to c0

    @property
    def tiles(self) -> int:
        """Number of tiles of slope times u; the product of the low parts is omitted."""
        return 3 if self.slope_low else 1

    @property
    def index_bits(self) -> int:
        """Bits of a row number."""
        return self.rows.bit_length() - 1

    @property
    def clocks(self) -> int:
        """Latency of ``ik_quadratic``: with c2, operands, c2 u, slope; then operands, slope times u, sum, result."""
        return 4 + (len(self.c_frac) > 2) * 3


def interpolant(form: Form, function: Function, segment: Segment) -> list[mpmath.mpf]:
    """Return signed c0, c1, and c2 if the form has it: the interpolant at the Chebyshev nodes."""
    left, width = segment
    middle = left + width / 2
    a = mpmath.sqrt(len(form.c_frac)) / 4 * width
    low, high = function(middle - a), function(middle + a)
    if len(form.c_frac) < 3:
        return [(low + high) / 2, (high - low) / (2 * a)]
    return [function(middle), (high - low) / (2 * a), (low - 2 * function(middle) + high) / (2 * a * a)]


def words(form: Form, function: Function, segment: Segment) -> tuple[int, ...]:
    """Return a row of the table as magnitudes, each rounded to nearest; c0 is first reduced by half the effect of the
    rounding of c2 at the segment's ends."""
    c0, *c = interpolant(form, function, segment)
    rounded = [mpmath.nint(abs(value) * 2**frac) for value, frac in zip(c, form.c_frac[1:], strict=True)]
    for word, value, frac in list(zip(rounded, c, form.c_frac[1:], strict=True))[1:]:
        c0 -= (mpmath.sign(value) * word / 2**frac - value) * segment[1] ** 2 / 8
    return tuple(int(word) for word in (mpmath.nint(c0 * 2 ** form.c_frac[0]), *rounded))


def polynomial(form: Form, row, u, rises: bool, bends_up: bool):
    """Return c0 + u slope, or c0 - u slope unless the function ``rises``; the slope is c1 + c2 u where it grows with u
    (``bends_up``), else c1 - c2 u.  ``sum_frac`` fraction bits."""
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
    """Return the largest |c0 + c1 u + c2 u^2 - function| in a segment, before the coefficients are rounded.

    ``derivative`` is the largest magnitude in the segment of the first derivative that the form does not follow.  The
    error is the third derivative /6 times (u + a) u (u - a), at most 1/32 of the cube of the segment's width; for a
    linear form, the second one /2 times (u + a) (u - a), at most 1/8 of its square.
    """
    width = segment[1]
    return derivative * width**2 / 16 if len(form.c_frac) < 3 else derivative * width**3 / 192


def error(form: Form, function: Function, segment: Segment, row, derivative: mpmath.mpf, rises: bool) -> Interval:
    """Return the range of :func:`polynomial` for a row of the table, minus the function, over its segment.

    * The interpolation (:func:`interpolation_error`).
    * The actual rounding of the coefficients: r0 + r1 u + r2 u^2.
    * The slope's error is less than one ulp of the slope plus c2 times an ulp of u's upper part; times u.
    * Each tile is truncated by less than an ulp of the sum; and the omitted tile.
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

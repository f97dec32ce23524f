# SPDX-License-Identifier: Apache-2.0
"""Bit-true models of the arithmetic cores of ``rtl/lean``: ``ik_mul3``, ``ik_even``, ``ik_rsqrt``.

Integers throughout: int64 arrays, object arrays of Python integers where 64 bits do not hold the word.  The reciprocal
square root's table is made here, from its defining formula; ``scripts/pages/gen_headers.py`` writes it for the RTL.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import mpmath
import numpy as np

MUL3_CLOCKS = 3
"""Tile products, middle sum, rounded sum."""

EVEN_CLOCKS = 3
"""Counts in groups of eight pairs, shift by groups, shift by pairs."""

SHORT_FRAC = 22
"""Up to here ``ik_rsqrt`` has the :data:`SHORT` form, with more fraction bits the :data:`LONG` one."""


def rsqrt_clocks(frac: int) -> int:
    """Clocks of ``ik_rsqrt`` after the mantissa: output register of the table, c2 u, slope, slope u, sum; in the long
    form the sum of the mixed tiles before it.  The table is read while the mantissa goes into its register."""
    return 5 if frac <= SHORT_FRAC else 6


# ---- product of three tiles ------------------------------------------------------------------------------------------


def cuts(a_width: int, b_width: int) -> tuple[int, int]:
    """Bits below the cut of either operand of :func:`mul3`, at least one: 18 are above it."""
    return max(a_width - 18, 1), max(b_width - 18, 1)


def mul3(a, b, shift: int, a_width: int, b_width: int):
    """``ik_mul3``: a b / 2^shift from three tiles, rounded half up; of the tile of the low parts only a guess is taken.

    Each tile is cut off two bits below the result's last place; the half place of the rounding is a carry into each of
    the two sums.  Where the highest tile ends above these two bits, the product of the highest two bits of both low
    parts is below it.  Errors: :func:`mul3_error`.
    """
    a_bits, b_bits = cuts(a_width, b_width)
    a_hi, a_lo = a >> a_bits, a & ((1 << a_bits) - 1)
    b_hi, b_lo = b >> b_bits, b & ((1 << b_bits) - 1)
    drop = shift - 2
    mid = (a_hi * b_lo >> drop - a_bits) + (a_lo * b_hi >> drop - b_bits) + 1
    up = a_bits + b_bits - drop
    if up > 0:
        guess = (4 * a_lo >> a_bits) * (4 * b_lo >> b_bits)
        outer = (a_hi * b_hi << up) + (guess << up >> 4)
    else:
        outer = a_hi * b_hi >> -up
    return outer + mid + 1 >> 2


def mul3_error(shift: int, a_width: int, b_width: int) -> tuple[float, float]:
    """Least and greatest error of :func:`mul3`, in places of the result.

    The tile left out is never negative and less than 2^(cuts - shift) places, of which the guess leaves 7/16; each of
    the mixed tiles loses less than a quarter.  What else is cut off is below all other words of the sum, and goes with
    the rounding, which is half up.
    """
    up = sum(cuts(a_width, b_width)) - shift + 2
    left_out = 2.0 ** (up - 2) * (7 / 16 if up > 0 else 1)
    return -left_out - 1, 0.5


# ---- normalization by an even shift ----------------------------------------------------------------------------------


def bit_length(words):
    """Bits of unsigned words of up to 64 bits, 0 for 0."""
    high = words >> np.uint64(32)
    # frexp of an integer below 2^53 is exact: its exponent is the number of bits.
    _, bits = np.frexp(np.where(high, high, words).astype(np.float64))
    return bits + 32 * (high > 0)


def even(value, width: int, mantissa_bits: int):
    """``ik_even``: (k, m), the leading zero pairs of an unsigned word and floor(value 4^k / 2^(width-mantissa_bits)).

    As a fraction, m lies in [1/4, 1); 0 gives k = width/2 - 1 and m = 0.  ``width`` is even, and at most 64.
    """
    value = np.asarray(value).astype(np.uint64)
    k = (width - np.maximum(bit_length(value), 1)).astype(np.int64) // 2
    right = width - mantissa_bits - 2 * k
    down, up = (np.maximum(n, 0).astype(np.uint64) for n in (right, -right))
    return k, ((value >> down) << up).astype(np.int64)


# ---- reciprocal square root ------------------------------------------------------------------------------------------

PRECISION = 200
"""Bits that the table and the proof are computed with; 2^-190 changes nothing in either."""


@dataclass(frozen=True)
class Form:
    """How ``ik_rsqrt`` computes 1/(2 sqrt m): in each of ``rows`` segments as a quadratic c0 - u (c1 - c2 u), where u
    is how far m is from the segment's middle.

    The segments are of equal width in [0, 1), and the table has rows of zeros below 1/4.  Or they are ``split``: one
    half of them lies in [1/4, 1/2), the other in [1/2, 1), so that they are half as wide where the root is steeper;
    then the table's c0 goes without its highest bit, a one.
    """

    rows: int
    split: bool
    u_frac: int  # fraction bits of u, u_low of them below its tile
    u_low: int
    c_frac: tuple[int, int, int]  # of the table's words, all unsigned
    c_bits: tuple[int, int, int]  # and their widths
    slope_frac: int  # of c1 - c2 u, slope_low of them below its tile
    slope_low: int
    sum_frac: int  # of what is subtracted from c0

    @property
    def tiles(self) -> int:
        """Of slope times u: the tile of the low parts is left out."""
        return 3 if self.slope_low else 1

    @property
    def first(self) -> int:
        """The row that begins at 1/4."""
        return 0 if self.split else self.rows // 4

    @property
    def index_bits(self) -> int:
        """Bits of m that number a segment of the wider ones."""
        return self.rows.bit_length() - 1

    def segment(self, row: int) -> tuple[mpmath.mpf, mpmath.mpf]:
        """Its left end and its width."""
        width = mpmath.mpf(1) / self.rows
        if not self.split:
            return row * width, width
        half = self.rows // 2
        return ((half + row) * width / 2, width / 2) if row < half else (row * width, width)

    def place(self, m, frac: int):
        """The row of a mantissa, and u."""
        below = frac + 3 - self.index_bits  # bits of m below the number of its segment
        row = m >> below
        if self.split:  # below 1/2 a segment's number has one bit more of m
            below = below - (row < self.rows // 2)
            row = np.where(row < self.rows // 2, (m >> below) - self.rows // 2, row)
        middle = m & (1 << below) - 1
        u = middle - (1 << below - 1)
        spare = self.u_frac - frac - 3
        return row, u << spare if spare >= 0 else u >> -spare


SHORT = Form(256, False, 25, 0, (30, 16, 11), (30, 17, 14), 16, 0, 30)
LONG = Form(1024, True, 34, 6, (34, 23, 12), (33, 24, 15), 25, 9, 36)


def form_of(frac: int) -> Form:
    """The form with ``frac`` fraction bits of the result."""
    return SHORT if frac <= SHORT_FRAC else LONG


def _interpolant(form: Form, row: int) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]:
    """c0, c1, c2 of a segment before their rounding: the quadratic meets 1/(2 sqrt m) at the three Chebyshev nodes."""
    left, width = form.segment(row)
    a = mpmath.sqrt(3) / 4 * width
    low, mid, high = (1 / mpmath.sqrt(left + width / 2 + u) / 2 for u in (-a, mpmath.mpf(0), a))
    return mid, (low - high) / (2 * a), (low - 2 * mid + high) / (2 * a * a)


@cache
def rsqrt_rows(form: Form) -> tuple[tuple[int, int, int], ...]:
    """The table: c0, c1, c2 of each segment, 0 where no mantissa lies.

    Each is rounded to nearest; c0 after half of what the rounding of c2 does at the segment's ends has been taken off.
    """
    with mpmath.workprec(PRECISION):
        rows = [(0, 0, 0)] * form.first
        for row in range(form.first, form.rows):
            c0, c1, c2 = _interpolant(form, row)
            _, width = form.segment(row)
            scales = [mpmath.mpf(2) ** frac for frac in form.c_frac]
            w2 = mpmath.nint(c2 * scales[2])
            rows.append(
                (int(mpmath.nint((c0 - (w2 / scales[2] - c2) * width**2 / 8) * scales[0])),
                 int(mpmath.nint(c1 * scales[1])), int(w2))
            )  # fmt: skip
        return tuple(rows)


def rounding(form: Form, frac: int) -> int:
    """What is added to c0, with ``sum_frac`` fraction bits: 3/8 of a place of the result, because a mantissa cut off
    makes the root too large by up to a quarter, less half of what the tiles lose by their cuts."""
    return (3 << form.sum_frac - frac - 3) - (form.tiles + 1) // 2


@cache
def _columns(form: Form) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The table as arrays."""
    c0, c1, c2 = np.array(rsqrt_rows(form), dtype=np.int64).T
    return c0, c1, c2


def quadratic(m, frac: int):
    """The quadratic at a mantissa, with what rounds it, ``sum_frac`` fraction bits."""
    form = form_of(frac)
    row, u = form.place(m, frac)
    c0, c1, c2 = (column[row] for column in _columns(form))
    u_hi, u_lo = u >> form.u_low, u & (1 << form.u_low) - 1
    u_frac = form.u_frac - form.u_low
    slope = (c1 << form.slope_frac - form.c_frac[1]) - (c2 * u_hi >> form.c_frac[2] + u_frac - form.slope_frac)
    slope_hi, slope_lo = slope >> form.slope_low, slope & (1 << form.slope_low) - 1
    drop = form.slope_frac - form.slope_low + u_frac - form.sum_frac
    mixed = (slope_hi * u_lo >> drop + form.u_low) + (slope_lo * u_hi >> drop + form.slope_low)
    fall = (slope_hi * u_hi >> drop) + mixed
    return (c0 << form.sum_frac - form.c_frac[0]) + rounding(form, frac) - fall


def rsqrt(m, frac: int):
    """``ik_rsqrt``: 1/(2 sqrt m) with ``frac`` fraction bits, m a mantissa of frac + 3 bits; 0 where m < 1/4.

    The error is less than one place also where m is a longer mantissa cut off (:func:`rsqrt_error`).
    """
    m = np.asarray(m, dtype=np.int64)
    mantissa = m >= 1 << frac + 1
    return np.where(mantissa, quadratic(np.where(mantissa, m, 1 << frac + 1), frac) >> form_of(frac).sum_frac - frac, 0)


# ---- proof of its error ----------------------------------------------------------------------------------------------


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


def _steepest(form: Form, row: int) -> mpmath.mpf:
    """|d/dm 1/(2 sqrt m)| at the left end of a segment, the largest in it."""
    return form.segment(row)[0] ** mpmath.mpf(-1.5) / 4


def _interpolation_error(form: Form, row: int) -> mpmath.mpf:
    """Largest |c0 - c1 u + c2 u^2 - 1/(2 sqrt m)| in a segment, before the coefficients' rounding.

    It is f3/6 (u + a) u (u - a).  The product is at most 1/32 of the cube of the segment's width; the third derivative
    f3, -15/16 m^(-7/2), is largest in magnitude at the left end.
    """
    left, width = form.segment(row)
    return mpmath.mpf(15) / 16 * left ** mpmath.mpf(-3.5) * width**3 / 6 / 32


def _quadratic_error(form: Form, row: int, frac: int) -> Interval:
    """The quadratic, without what rounds it, less 1/(2 sqrt m), for all m of a segment.

    * The interpolation (:func:`_interpolation_error`).
    * The coefficients' rounding, as it is: r0 - r1 u + r2 u^2.
    * The slope is too large by less than one of its places and c2 times a place of u's upper part; times u.
    * Each tile that is taken off c0 is too small by less than a place of the sum; and the tile left out.
    * The places of m that u does without make 1/(2 sqrt m) smaller.
    """
    _, width = form.segment(row)
    words = (mpmath.mpf(word) / 2**bits for word, bits in zip(rsqrt_rows(form)[row], form.c_frac, strict=True))
    r0, r1, r2 = (word - c for word, c in zip(words, _interpolant(form, row), strict=True))
    one = mpmath.mpf(1)
    u_place = one / 2 ** (form.u_frac - form.u_low)
    c2 = mpmath.mpf(rsqrt_rows(form)[row][2]) / 2 ** form.c_frac[2]
    slope = one / 2**form.slope_frac + (c2 * u_place if form.u_low else 0)
    aside = _interpolation_error(form, row) + (abs(r1) + slope) * width / 2
    left_out = u_place / 2 ** (form.slope_frac - form.slope_low) if form.u_low else 0
    tiles = form.tiles * one / 2**form.sum_frac + left_out
    without = max(one / 2**form.u_frac - one / 2 ** (frac + 3), 0) * _steepest(form, row)
    bend = r2 * width**2 / 4
    return Interval(r0 + min(bend, 0) - aside, r0 + max(bend, 0) + aside + tiles + without)


@cache
def rsqrt_error(frac: int) -> Interval:
    """What :func:`rsqrt` less 1/(2 sqrt V) is proved to lie in, in places of the result, for all V in [1/4, 1).

    V is any real number that cut off after frac + 3 bits is m.  Segment by segment: the error at m
    (:func:`_quadratic_error`), what is added to round the result and less than a place that is cut off it, and what
    1/(2 sqrt V) falls from m to V: the steepest slope times m's last place.
    """
    form = form_of(frac)
    with mpmath.workprec(PRECISION):
        place = mpmath.mpf(2) ** -frac
        added = mpmath.mpf(rounding(form, frac)) / 2**form.sum_frac
        parts = []
        for row in range(form.first, form.rows):
            cut = Interval(mpmath.mpf(0), _steepest(form, row) * place / 8)
            parts.append(_quadratic_error(form, row, frac) + Interval(added - place, added) + cut)
        return Interval(min(p.low for p in parts) / place, max(p.high for p in parts) / place)


def rsqrt_error_bound(frac: int) -> float:
    """The largest magnitude in :func:`rsqrt_error`: less than 1, so the result is faithful."""
    return float(rsqrt_error(frac).size)

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

MUL3_CLOCKS = 4
"""Operands, tile products, middle sum, rounded sum."""

EVEN_CLOCKS = 3
"""Counts in groups of eight pairs, shift by groups, shift by pairs."""

SEED_FRAC = 21
"""Up to here the quadratic is the result; with more fraction bits it is the seed of a Newton step."""


def rsqrt_clocks(frac: int) -> int:
    """Clocks of ``ik_rsqrt`` after the mantissa: output register of the table, c2 u, slope, slope u, sum; y0^2, tiles,
    middle sum, residual, product, sum.  The table is read while the mantissa goes into its register."""
    return 5 if frac <= SEED_FRAC else 11


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

SEGMENTS = 256
"""Of [0, 1); the mantissas, in [1/4, 1), use the upper three quarters."""

FIRST = SEGMENTS // 4

U_FRAC = 17
C0_FRAC, C1_FRAC, C2_FRAC = 28, 24, 27
C0_BITS, C1_BITS, C2_BITS = 28, 17, 14
"""The table's unsigned words and their fraction bits: a slope is a factor of 17 bits."""

SEED_BITS = 17
"""Fraction bits of the Newton step's seed y0, which is less than 1; m y0^2 is a product of words twice as long."""

RESIDUAL_FRAC, RESIDUAL_BITS, RESIDUAL_GUARD = 32, 18, 4
"""The residual 4 m y0^2 - 1, a signed factor, and the bits behind it that its sum is made with."""

PRECISION = 200
"""Bits that the table and the proof are computed with; 2^-190 changes nothing in either."""


def _interpolant(row: int) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]:
    """c0, c1, c2 of a segment before their rounding: c0 - c1 u + c2 u^2 meets 1/(2 sqrt m) at u = -a, 0, a."""
    a = mpmath.sqrt(3) / 4
    left, mid, right = (mpmath.sqrt(SEGMENTS / (row + 0.5 + u)) / 2 for u in (-a, mpmath.mpf(0), a))
    return mid, (left - right) / (2 * a), (left - 2 * mid + right) / (2 * a * a)


@cache
def rsqrt_rows() -> tuple[tuple[int, int, int], ...]:
    """The table: c0, c1, c2 of each segment, 0 where no mantissa lies.

    The quadratic in u, the place in the segment from -1/2 to 1/2, goes through the three Chebyshev nodes.  c0 and c1
    are rounded down: what is subtracted from them is rounded down as well.
    """
    with mpmath.workprec(PRECISION):
        rows = [(0, 0, 0)] * FIRST
        for row in range(FIRST, SEGMENTS):
            c0, c1, c2 = _interpolant(row)
            words = c0 * 2**C0_FRAC, c1 * 2**C1_FRAC, c2 * 2**C2_FRAC + 0.5
            w0, w1, w2 = (int(mpmath.floor(w)) for w in words)
            rows.append((w0, w1, w2))
        return tuple(rows)


@cache
def _columns(frac: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The table; c0 with half a place of the result, or of the seed, for its rounding.

    The seed of row FIRST is rounded down: it has no word for 1.
    """
    c0, c1, c2 = np.array(rsqrt_rows(), dtype=np.int64).T
    half = np.full(SEGMENTS, 1 << (C0_FRAC - (frac if frac <= SEED_FRAC else SEED_BITS) - 1))
    if frac > SEED_FRAC:
        half[FIRST] = 0
    return c0 + half, c1, c2


def quadratic(m, frac: int):
    """The quadratic's sum at a mantissa, C0_FRAC fraction bits, with what rounds it to the result or the seed."""
    rest_bits = frac + 3 - 8
    row, rest = m >> rest_bits, m & ((1 << rest_bits) - 1)
    u = (rest >> (rest_bits - U_FRAC) if rest_bits >= U_FRAC else rest << (U_FRAC - rest_bits)) - (1 << (U_FRAC - 1))
    c0, c1, c2 = (column[row] for column in _columns(frac))
    slope = c1 - ((c2 * u) >> (C2_FRAC + U_FRAC - C1_FRAC))
    return c0 - ((slope * u) >> (C1_FRAC + U_FRAC - C0_FRAC))


def newton(m, y0, frac: int):
    """y0 (1 - (4 m y0^2 - 1) / 2), the product rounded to nearest; y0 has SEED_BITS fraction bits."""
    mask = (1 << SEED_BITS) - 1
    m, q = m << (2 * SEED_BITS - frac - 3), y0 * y0
    m_hi, m_lo, q_hi, q_lo = m >> SEED_BITS, m & mask, q >> SEED_BITS, q & mask
    drop = 4 * SEED_BITS - 2 - RESIDUAL_FRAC - RESIDUAL_GUARD  # bits of the whole product, times 4, below the guard
    mid = m_hi * q_lo + m_lo * q_hi
    outer = ((m_hi * q_hi) << (2 * SEED_BITS - drop)) + ((m_lo * q_lo) >> drop) + (1 << (RESIDUAL_GUARD - 1))
    residual = (outer + (mid >> (drop - SEED_BITS))) >> RESIDUAL_GUARD
    # The integer part, which is near 1, goes: the rest is a signed word.
    top = 1 << (RESIDUAL_BITS - 1)
    residual = ((residual + top) & (2 * top - 1)) - top
    drop = RESIDUAL_FRAC + SEED_BITS + 1 - frac
    product = residual * y0
    return (y0 << (frac - SEED_BITS)) - (product >> drop) - ((product >> (drop - 1)) & 1)


def rsqrt(m, frac: int):
    """``ik_rsqrt``: 1/(2 sqrt m) with ``frac`` fraction bits, m a mantissa of frac + 3 bits; 0 where m < 1/4.

    The error is less than one place also where m is a longer mantissa cut off (:func:`rsqrt_error`).
    """
    m = np.asarray(m, dtype=np.int64)
    y = quadratic(m, frac)
    return y >> (C0_FRAC - frac) if frac <= SEED_FRAC else newton(m, y >> (C0_FRAC - SEED_BITS), frac)


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


def _steepest(row: int) -> mpmath.mpf:
    """|d/dm 1/(2 sqrt m)| at the left end of a segment, the largest in it."""
    return (mpmath.mpf(row) / SEGMENTS) ** mpmath.mpf(-1.5) / 4


def _least(row: int) -> mpmath.mpf:
    """1/(2 sqrt m) at the right end of a segment."""
    return mpmath.sqrt(mpmath.mpf(SEGMENTS) / (row + 1)) / 2


def _interpolation_error(row: int) -> mpmath.mpf:
    """Largest |c0 - c1 u + c2 u^2 - 1/(2 sqrt m)| in a segment, before the coefficients' rounding.

    It is f3/6 (u + a) u (u - a).  The product is at most 1/32 in magnitude; the third derivative f3, -15/16 m^(-7/2)
    times the cube of the segment's width, is largest at the left end.
    """
    width = mpmath.mpf(1) / SEGMENTS
    return mpmath.mpf(15) / 16 * width**3 * (row * width) ** mpmath.mpf(-3.5) / 6 / 32


def _quadratic_error(row: int, frac: int) -> Interval:
    """The quadratic before its rounding, less 1/(2 sqrt m), for all m of a segment.

    * The interpolation (:func:`_interpolation_error`).
    * The coefficients' rounding, as it is: r0 - r1 u + r2 u^2.
    * The slope is too large by less than one of its places; times u.
    * The product taken off c0 is too small by less than one place of c0.
    * The places of m that u does without make 1/(2 sqrt m) smaller.
    """
    fracs = (C0_FRAC, C1_FRAC, C2_FRAC)
    words = (mpmath.mpf(word) / 2**bits for word, bits in zip(rsqrt_rows()[row], fracs, strict=True))
    r0, r1, r2 = (word - c for word, c in zip(words, _interpolant(row), strict=True))
    aside = _interpolation_error(row) + abs(r1) / 2 + mpmath.mpf(2) ** -C1_FRAC / 2
    product = mpmath.mpf(2) ** -C0_FRAC
    without = max(mpmath.mpf(2) ** -(8 + U_FRAC) - mpmath.mpf(2) ** -(frac + 3), 0) * _steepest(row)
    return Interval(r0 + min(r2, 0) / 4 - aside, r0 + max(r2, 0) / 4 + aside + product + without)


def _seed_error(row: int, frac: int) -> Interval:
    """y0 - 1/(2 sqrt m) for all m of a segment: the quadratic's error, and half a place; one, down, in row FIRST."""
    half = mpmath.mpf(2) ** -SEED_BITS / 2
    return _quadratic_error(row, frac) + (Interval(-2 * half, mpmath.mpf(0)) if row == FIRST else Interval(-half, half))


def _residual_rounding() -> Interval:
    """The residual less 4 m y0^2 - 1: rounded half up, after two of the tile sums lost less than a guard bit each."""
    place = mpmath.mpf(2) ** -RESIDUAL_FRAC
    return Interval(-place / 2 - 2 * place / 2**RESIDUAL_GUARD, place / 2)


def _newton_error(row: int, frac: int) -> Interval:
    """The Newton step before its rounding, less 1/(2 sqrt m), for all m of a segment.

    With y = 1/(2 sqrt m) and y0 = y (1 + d), the exact step gives y (1 - 3/2 d^2 - 1/2 d^3), never too much; y d^2 is
    the square of the seed's error over y.  The residual's rounding is multiplied by y0 / 2.
    """
    seed, least = _seed_error(row, frac).size, _least(row)
    step = (mpmath.mpf(3) / 2 + seed / least / 2) * seed**2 / least
    y0 = min(_least(row - 1) + seed, 1)
    rounding = _residual_rounding()
    return Interval(-step - rounding.high * y0 / 2, -rounding.low * y0 / 2)


@cache
def rsqrt_error(frac: int) -> Interval:
    """What :func:`rsqrt` less 1/(2 sqrt V) is proved to lie in, in places of the result, for all V in [1/4, 1).

    V is any real number that cut off after frac + 3 bits is m.  Segment by segment: the error at m before the result's
    rounding (:func:`_quadratic_error` or :func:`_newton_error`), half a place for that rounding, and what
    1/(2 sqrt V) falls from m to V: the steepest slope times m's last place.
    """
    with mpmath.workprec(PRECISION):
        before = _quadratic_error if frac <= SEED_FRAC else _newton_error
        place = mpmath.mpf(2) ** -frac
        parts = []
        for row in range(FIRST, SEGMENTS):
            cut = Interval(mpmath.mpf(0), _steepest(row) * place / 8)
            parts.append(before(row, frac) + Interval(-place / 2, place / 2) + cut)
        return Interval(min(p.low for p in parts) / place, max(p.high for p in parts) / place)


def rsqrt_error_bound(frac: int) -> float:
    """The largest magnitude in :func:`rsqrt_error`: less than 1, so the result is faithful."""
    return float(rsqrt_error(frac).size)


def rsqrt_residual_bound(frac: int) -> float:
    """Largest magnitude of the Newton step's residual, 2 d + d^2 and its rounding, in its places."""
    with mpmath.workprec(PRECISION):
        largest = max(_seed_error(row, frac).size / _least(row) for row in range(FIRST, SEGMENTS))
        return float((2 * largest + largest**2 + _residual_rounding().size) * 2**RESIDUAL_FRAC)

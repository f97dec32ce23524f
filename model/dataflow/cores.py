# SPDX-License-Identifier: Apache-2.0
"""Bit-true models of the arithmetic cores of ``rtl/lean``: ``ik_mul3``, ``ik_even``, ``ik_rsqrt``.

Integers throughout: int64 arrays, object arrays of Python integers where 64 bits do not hold the word.  The reciprocal
square root's table is made here, from its defining formula; ``scripts/generate/headers.py`` writes it for the RTL.
"""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np

from .quadratic import PRECISION, Form, Interval, Segment, error, polynomial, words

MUL3_CLOCKS = 3
"""Tile products, middle sum, rounded sum."""

EVEN_CLOCKS = 3
"""Counts in groups of eight pairs, shift by groups, shift by pairs."""

TILE = 18
"""Bits of the longer operand of the multipliers that products are cut for, unless others are asked for."""

SHORT_FRAC = 22
"""Up to here ``ik_rsqrt`` has the :data:`SHORT` form, with more fraction bits the :data:`LONG` one, and with tiles of
less than 18 bits the :data:`SMALL` one."""


def rsqrt_clocks(frac: int, tile: int = TILE) -> int:
    """Clocks of ``ik_rsqrt`` after the mantissa: output register of the table, and ``ik_quadratic``.  The table is read
    while the mantissa goes into its register."""
    return 1 + form_of(frac, tile).clocks


# ---- product of three tiles ------------------------------------------------------------------------------------------


def cuts(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Bits below the cut of either operand of :func:`mul3`: ``tile`` of a are above it, and of b no more than 18."""
    return max(a_width - tile, 0), max(b_width - min(tile, 18), 0)


def unseen(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """The lowest bits of either operand, which two signed tiles do not hold: :func:`mul3` does not look at them."""
    return max(a_width - 2 * tile + 1, 0), max(b_width - 2 * min(tile, 18) + 1, 0)


def mul3(a, b, shift: int, a_width: int, b_width: int, tile: int = TILE):
    """``ik_mul3``: a b / 2^shift from three tiles, rounded half up; of the tile of the low parts only a guess is taken.

    Each tile is cut off two bits below the result's last place; the half place of the rounding is a carry into each of
    the two sums.  Where the highest tile ends above these two bits, the product of the highest two bits of both low
    parts is below it.  Errors: :func:`mul3_error`.
    """
    a_unseen, b_unseen = unseen(a_width, b_width, tile)
    a, b, shift = a >> a_unseen, b >> b_unseen, shift - a_unseen - b_unseen
    a_bits, b_bits = cuts(a_width - a_unseen, b_width - b_unseen, tile)
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


def mul3_error(shift: int, a_width: int, b_width: int, tile: int = TILE) -> tuple[float, float]:
    """Least and greatest error of :func:`mul3`, in places of the result.

    The tile left out is never negative and less than 2^(cuts - shift) places, of which the guess leaves 7/16; each of
    the mixed tiles loses less than a quarter.  What else is cut off is below all other words of the sum, and goes with
    the rounding, which is half up.  Bits that are not looked at are worth up to a place of theirs times the other word.
    """
    out = unseen(a_width, b_width, tile)
    aside = sum(2.0 ** (bits + other - 1 - shift) for bits, other in zip(out, (b_width, a_width), strict=True) if bits)
    low = cuts(a_width - out[0], b_width - out[1], tile)
    up = sum(low) - shift + sum(out) + 2
    left_out = 2.0 ** (up - 2) * (7 / 16 if up > 0 else 1) if all(low) else 0.0
    return -left_out - 1 - aside, 0.5 + aside


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

SHORT = Form(2048, 25, 0, (27, 14), (26, 15), 14, 0, 28)
LONG = Form(1024, 34, 6, (34, 23, 12), (33, 24, 15), 25, 9, 36)
SMALL = Form(512, 33, 8, (33, 22, 11), (32, 23, 14), 24, 10, 34)
"""c0 goes without its highest bit, a one."""

SMALL_FRAC = 29
"""Most fraction bits of a result of the :data:`SMALL` form."""


def places(frac: int, tile: int = TILE) -> float:
    """An upper bound of the error of :func:`rsqrt` in places of the result, without its proof (:func:`rsqrt_error`)."""
    return 1.1 if form_of(frac, tile) is SMALL and frac >= SMALL_FRAC else 1.0


def form_of(frac: int, tile: int = TILE) -> Form:
    """The form with ``frac`` fraction bits of the result and tiles of so many bits."""
    if tile < TILE:
        return SMALL
    return SHORT if frac <= SHORT_FRAC else LONG


def root(m: mpmath.mpf) -> mpmath.mpf:
    return 1 / (2 * mpmath.sqrt(m))


def segment(form: Form, row: int) -> Segment:
    """One half of the segments lie in [1/4, 1/2), the other in [1/2, 1): half as wide where the root is steeper."""
    half, width = form.rows // 2, mpmath.mpf(1) / form.rows
    return ((half + row) * width / 2, width / 2) if row < half else (row * width, width)


def place(form: Form, m, frac: int):
    """The row of a mantissa, and u."""
    lower = m < 1 << frac + 2
    below = frac + 3 - form.index_bits - lower  # bits of m below the number of its segment
    row = (m >> below) - np.where(lower, form.rows // 2, 0)
    u = (m & (1 << below) - 1) - (1 << below - 1)
    return row, u << form.u_frac - frac - 3


@cache
def rsqrt_rows(form: Form) -> tuple[tuple[int, ...], ...]:
    """The table."""
    with mpmath.workprec(PRECISION):
        return tuple(words(form, root, segment(form, row)) for row in range(form.rows))


def rounding(form: Form, frac: int) -> int:
    """What is added to c0, with ``sum_frac`` fraction bits: 3/8 of a place of the result, because a mantissa cut off
    makes the root too large by up to a quarter, less half of what the tiles lose by their cuts."""
    return (3 << form.sum_frac - frac - 3) - (form.tiles + 1) // 2


@cache
def _columns(form: Form) -> np.ndarray:
    """The table, an array a coefficient."""
    return np.array(rsqrt_rows(form), dtype=np.int64).T


def quadratic(form: Form, m, frac: int):
    """The polynomial at a mantissa, without what rounds it, ``sum_frac`` fraction bits."""
    row, u = place(form, m, frac)
    return polynomial(form, _columns(form)[:, row], u, rises=False, bends_up=False)


def rsqrt(m, frac: int, tile: int = TILE):
    """``ik_rsqrt``: 1/(2 sqrt m) with ``frac`` fraction bits, m a mantissa of frac + 3 bits; below 1/4 its second bit
    counts as if it were set, so that 0 gives 1.

    The error is less than one place, or what :func:`places` says, also where m is a longer mantissa cut off
    (:func:`rsqrt_error`).
    """
    m = np.asarray(m, dtype=np.int64)
    form = form_of(frac, tile)
    second = 1 << frac + 1
    y = quadratic(form, np.where(m < second, m | second, m), frac) + rounding(form, frac)
    return y >> form.sum_frac - frac


# ---- proof of its error ----------------------------------------------------------------------------------------------


def _steepest(form: Form, row: int) -> mpmath.mpf:
    """|d/dm 1/(2 sqrt m)| at the left end of a segment, the largest in it."""
    return segment(form, row)[0] ** mpmath.mpf(-1.5) / 4


def _derivative(form: Form, row: int) -> mpmath.mpf:
    """The largest magnitude of the derivative that decides how good the form is: also at the left end."""
    left, _ = segment(form, row)
    if len(form.c_frac) < 3:
        return mpmath.mpf(3) / 8 * left ** mpmath.mpf(-2.5)
    return mpmath.mpf(15) / 16 * left ** mpmath.mpf(-3.5)


@cache
def row_error(form: Form, row: int) -> Interval:
    """:func:`quadratic` less 1/(2 sqrt m) for all m of a segment."""
    with mpmath.workprec(PRECISION):
        return error(form, root, segment(form, row), rsqrt_rows(form)[row], _derivative(form, row), rises=False)


@cache
def rsqrt_error(frac: int, tile: int = TILE) -> Interval:
    """What :func:`rsqrt` less 1/(2 sqrt V) is proved to lie in, in places of the result, for all V in [1/4, 1).

    V is any real number that cut off after frac + 3 bits is m.  Segment by segment: the error at m (:func:`row_error`),
    what is added to round the result and less than a place that is cut off it, and what 1/(2 sqrt V) falls from m to V:
    the steepest slope times m's last place.
    """
    form = form_of(frac, tile)
    with mpmath.workprec(PRECISION):
        last = mpmath.mpf(2) ** -frac
        added = mpmath.mpf(rounding(form, frac)) / 2**form.sum_frac
        parts = []
        for row in range(form.rows):
            cut = Interval(mpmath.mpf(0), _steepest(form, row) * last / 8)
            parts.append(row_error(form, row) + Interval(added - last, added) + cut)
        return Interval(min(p.low for p in parts) / last, max(p.high for p in parts) / last)


def rsqrt_error_bound(frac: int, tile: int = TILE) -> float:
    """The largest magnitude in :func:`rsqrt_error`; where it is less than 1, the result is faithful."""
    return float(rsqrt_error(frac, tile).size)

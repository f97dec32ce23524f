# SPDX-License-Identifier: Apache-2.0
"""Bit-true models of the arithmetic modules of ``rtl/lean``: ``ik_mul3``, ``ik_even``, ``ik_rsqrt``.

Integers throughout: int64 arrays, or object arrays of Python integers where a word exceeds 64 bits.  The table of the
reciprocal square root is computed here from its definition; ``scripts/generate/headers.py`` writes it for the RTL.
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
"""Default tile: bits of the longer operand of the multipliers into which products are split."""

SHORT_FRAC = 22
"""Largest number of fraction bits for which ``ik_rsqrt`` uses the :data:`SHORT` form; above it, the :data:`LONG` one,
and with tiles of less than 18 bits the :data:`SMALL` one."""


def rsqrt_clocks(frac: int, tile: int = TILE) -> int:
    """Return the latency of ``ik_rsqrt`` after the mantissa: output register of the table, and ``ik_quadratic``.  The
    table is read while the mantissa is registered."""
    return 1 + form_of(frac, tile).clocks


# ---- product of three tiles ------------------------------------------------------------------------------------------


def cuts(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Return the bits below the cut of either operand of :func:`mul3`: ``tile`` bits of a lie above it, and
    at most 18 bits of b."""
    return max(a_width - tile, 0), max(b_width - min(tile, 18), 0)


def unseen(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Return the number of low bits of either operand beyond two signed tiles, which :func:`mul3` ignores."""
    return max(a_width - 2 * tile + 1, 0), max(b_width - 2 * min(tile, 18) + 1, 0)


def mul3(a, b, shift: int, a_width: int, b_width: int, tile: int = TILE):
    """Compute ``ik_mul3``: a b / 2^shift from three tiles, rounded half up; the tile of the low parts is only
    estimated.

    Each tile is truncated two bits below the result's ulp; the rounding constant enters as a carry into each of the two
    sums.  Where the LSB of the highest tile lies above these two bits, the product of the two highest bits of both low
    parts fills the gap.  Errors: :func:`mul3_error`.
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
    """Return the least and greatest error of :func:`mul3`, in ulps of the result.

    The omitted tile is nonnegative and less than 2^(cuts - shift) ulps, of which the estimate leaves 7/16; each mixed
    tile loses less than a quarter.  All other truncated bits lie below the words of the sum and belong to the rounding,
    which is half up.  Ignored bits contribute at most one of their places times the other word.
    """
    out = unseen(a_width, b_width, tile)
    aside = sum(2.0 ** (bits + other - 1 - shift) for bits, other in zip(out, (b_width, a_width), strict=True) if bits)
    low = cuts(a_width - out[0], b_width - out[1], tile)
    up = sum(low) - shift + sum(out) + 2
    left_out = 2.0 ** (up - 2) * (7 / 16 if up > 0 else 1) if all(low) else 0.0
    return -left_out - 1 - aside, 0.5 + aside


# ---- normalization by an even shift ----------------------------------------------------------------------------------


def bit_length(words):
    """Return the bits of unsigned words of up to 64 bits, 0 for 0."""
    high = words >> np.uint64(32)
    # frexp of an integer below 2^53 is exact: its exponent is the number of bits.
    _, bits = np.frexp(np.where(high, high, words).astype(np.float64))
    return bits + 32 * (high > 0)


def even(value, width: int, mantissa_bits: int):
    """Compute ``ik_even``: (k, m), leading zero pairs of a word and floor(value 4^k / 2^(width-mantissa_bits)).

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
"""c0 is stored without its MSB, which is 1."""

SMALL_FRAC = 29
"""Maximum fraction bits of a result of the :data:`SMALL` form."""


def places(frac: int, tile: int = TILE) -> float:
    """Return an upper bound of the error of :func:`rsqrt` in ulps, without its proof (:func:`rsqrt_error`)."""
    return 1.1 if form_of(frac, tile) is SMALL and frac >= SMALL_FRAC else 1.0


def form_of(frac: int, tile: int = TILE) -> Form:
    """Return the form for ``frac`` fraction bits of the result and tiles of ``tile`` bits."""
    if tile < TILE:
        return SMALL
    return SHORT if frac <= SHORT_FRAC else LONG


def root(m: mpmath.mpf) -> mpmath.mpf:
    return 1 / (2 * mpmath.sqrt(m))


def segment(form: Form, row: int) -> Segment:
    """Return a segment: half of them lie in [1/4, 1/2), the others in [1/2, 1); the former are half as wide, as the
    root is steeper there."""
    half, width = form.rows // 2, mpmath.mpf(1) / form.rows
    return ((half + row) * width / 2, width / 2) if row < half else (row * width, width)


def place(form: Form, m, frac: int):
    """Return the row of a mantissa, and u."""
    lower = m < 1 << frac + 2
    below = frac + 3 - form.index_bits - lower  # bits of m below its segment number
    row = (m >> below) - np.where(lower, form.rows // 2, 0)
    u = (m & (1 << below) - 1) - (1 << below - 1)
    return row, u << form.u_frac - frac - 3


@cache
def rsqrt_rows(form: Form) -> tuple[tuple[int, ...], ...]:
    """Return the table's rows."""
    with mpmath.workprec(PRECISION):
        return tuple(words(form, root, segment(form, row)) for row in range(form.rows))


def rounding(form: Form, frac: int) -> int:
    """Return the constant added to c0, with ``sum_frac`` fraction bits: 3/8 ulp of the result, because a truncated
    mantissa makes the root too large by up to a quarter, minus half of the tiles' truncation."""
    return (3 << form.sum_frac - frac - 3) - (form.tiles + 1) // 2


@cache
def _columns(form: Form) -> np.ndarray:
    """Return the table as one array per coefficient."""
    return np.array(rsqrt_rows(form), dtype=np.int64).T


def quadratic(form: Form, m, frac: int):
    """Return the polynomial at a mantissa, without the rounding constant, ``sum_frac`` fraction bits."""
    row, u = place(form, m, frac)
    return polynomial(form, _columns(form)[:, row], u, rises=False, bends_up=False)


def rsqrt(m, frac: int, tile: int = TILE):
    """Compute ``ik_rsqrt``: 1/(2 sqrt m) with ``frac`` fraction bits, m a mantissa of frac + 3 bits; below 1/4 its
    second bit is treated as set, so that 0 gives 1.

    The error is less than one ulp, or the bound of :func:`places`, also where m is a truncated longer mantissa
    (:func:`rsqrt_error`).
    """
    m = np.asarray(m, dtype=np.int64)
    form = form_of(frac, tile)
    second = 1 << frac + 1
    y = quadratic(form, np.where(m < second, m | second, m), frac) + rounding(form, frac)
    return y >> form.sum_frac - frac


# ---- proof of its error ----------------------------------------------------------------------------------------------


def _steepest(form: Form, row: int) -> mpmath.mpf:
    """Return |d/dm 1/(2 sqrt m)| at the left end of a segment, its maximum there."""
    return segment(form, row)[0] ** mpmath.mpf(-1.5) / 4


def _derivative(form: Form, row: int) -> mpmath.mpf:
    """Return the largest magnitude of the derivative that limits the form's accuracy, also at the left end."""
    left, _ = segment(form, row)
    if len(form.c_frac) < 3:
        return mpmath.mpf(3) / 8 * left ** mpmath.mpf(-2.5)
    return mpmath.mpf(15) / 16 * left ** mpmath.mpf(-3.5)


@cache
def row_error(form: Form, row: int) -> Interval:
    """Return the range of :func:`quadratic` minus 1/(2 sqrt m) over all m of a segment."""
    with mpmath.workprec(PRECISION):
        return error(form, root, segment(form, row), rsqrt_rows(form)[row], _derivative(form, row), rises=False)


@cache
def rsqrt_error(frac: int, tile: int = TILE) -> Interval:
    """Return the proved range of :func:`rsqrt` minus 1/(2 sqrt V), in ulps of the result, for all V in [1/4, 1).

    V is any real number whose truncation to frac + 3 bits is m.  Per segment: the error at m (:func:`row_error`), the
    rounding constant minus the truncation of less than an ulp, and the fall of 1/(2 sqrt V) from m to V: the steepest
    slope times an ulp of m.
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
    """Return the largest magnitude in :func:`rsqrt_error`; where it is less than 1, the result is faithful."""
    return float(rsqrt_error(frac, tile).size)

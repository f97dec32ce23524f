# SPDX-License-Identifier: Apache-2.0
"""``ik_trig`` in integers: sine and cosine of half the swivel angle, from a table of a quarter turn.

phi/2 lies within a quarter turn on either side of 0.  With t = |phi|/2 as a fraction of a quarter turn,

    sin |phi/2| = S(t)    cos |phi/2| = S(1 - t)    S(t) = sin(pi/2 t)

and the segments of S(1 - t) are the segments of S in reverse order, with u negated: a row gives both functions.
"""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np

from .cores import TILE
from .quadratic import PRECISION, Form, Interval, Segment, error, polynomial, words

FRACS = range(19, 32)
"""Fraction bits of a result that the core supports."""

SHORT_FRAC = 23
"""Largest number of fraction bits for which ``ik_trig`` uses the :data:`SHORT` form; above it, the :data:`LONG` one,
and with tiles of less than 18 bits the :data:`SMALL` one."""

SHORT = Form(2048, 25, 0, (27, 14), (28, 15), 14, 0, 28)
LONG = Form(1024, 31, 4, (34, 23, 12), (35, 24, 13), 25, 9, 36)
SMALL = Form(512, 31, 7, (33, 22, 11), (34, 23, 12), 24, 10, 34)
"""c0 plus the rounding constant can be 1."""


def form_of(frac: int, tile: int = TILE) -> Form:
    """Return the form for ``frac`` fraction bits of the result and tiles of ``tile`` bits."""
    if tile < TILE:
        return SMALL
    return SHORT if frac <= SHORT_FRAC else LONG


def trig_clocks(frac: int, tile: int = TILE) -> int:
    """Return the latency of ``ik_trig``: magnitude, table, its output register, ``ik_quadratic``, sign."""
    return 4 + form_of(frac, tile).clocks


def sine(t: mpmath.mpf) -> mpmath.mpf:
    return mpmath.sin(mpmath.pi / 2 * t)


def segment(form: Form, row: int) -> Segment:
    width = mpmath.mpf(1) / form.rows
    return row * width, width


@cache
def sine_rows(form: Form) -> tuple[tuple[int, ...], ...]:
    """Return the table's rows."""
    with mpmath.workprec(PRECISION):
        return tuple(words(form, sine, segment(form, row)) for row in range(form.rows))


@cache
def _columns(form: Form) -> np.ndarray:
    """Return the table as one array per coefficient."""
    return np.array(sine_rows(form), dtype=np.int64).T


def half_sincos(phi, width: int, frac: int, tile: int = TILE):
    """Compute ``ik_trig``: (sin, cos) of phi/2 with ``frac`` fraction bits; phi a binary angle, one turn = 2^width.

    ``phi`` is an int64 array, ``width`` 16 to 32, at most 26 with the short form, ``frac`` 19 to 31.
    """
    form = form_of(frac, tile)
    dropped = form.sum_frac - frac
    sin, cos = (y + (1 << dropped - 1) >> dropped for y in sums(np.abs(phi), width, form))
    return np.where(phi < 0, -sin, sin), cos


def sums(a, width: int, form: Form):
    """Return the unrounded sums of :func:`half_sincos`, for angles >= 0."""
    below = width - 1 - form.index_bits  # bits of a below its segment number
    row = np.minimum(a >> below, form.rows - 1)  # a quarter turn is the end of the last segment
    u = a - (row << below) - (1 << below - 1) << form.u_frac - width + 1
    columns = _columns(form)
    sin = polynomial(form, columns[:, row], u, rises=True, bends_up=False)
    return sin, polynomial(form, columns[:, form.rows - 1 - row], u, rises=False, bends_up=True)


@cache
def _row_error(form: Form, row: int, rises: bool) -> Interval:
    """Bound the error of a row as a sine, or with falling u as a cosine, over its segment, both ends included."""
    with mpmath.workprec(PRECISION):
        left, width = segment(form, row)
        quarter = mpmath.pi / 2
        steepest = quarter**3 * mpmath.cos(quarter * left), quarter**2 * sine(left + width)
        return error(form, sine, (left, width), sine_rows(form)[row], steepest[len(form.c_frac) < 3], rises)


@cache
def error_bound(frac: int, tile: int = TILE) -> float:
    """Return the largest error of :func:`half_sincos` in ulps, proved for every phi.

    It is the row's error (:func:`model.dataflow.quadratic.error`) plus half an ulp for rounding the result.
    """
    form = form_of(frac, tile)
    with mpmath.workprec(PRECISION):
        worst = max(_row_error(form, row, rises).size for row in range(form.rows) for rises in (True, False))
        return float(worst * 2**frac + mpmath.mpf(1) / 2)

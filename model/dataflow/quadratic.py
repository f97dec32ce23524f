# SPDX-License-Identifier: Apache-2.0
"""Table functions as ``ik_quadratic`` computes them: c0 -+ u (c1 -+ c2 u) in each segment of a table.

u is the distance of the argument from the segment's middle.  ``ik_rsqrt`` uses the table :data:`INVERSE_ROOT`,
``ik_trig`` the table :data:`SINE`.  This module computes the tables' words and the bit-true results, and proves bounds
of the errors; ``scripts/generate/headers.py`` writes the words for the RTL.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from .expressions import Operation, Unary
from .mul3 import TILE

if TYPE_CHECKING:
    from .nodes import Node

PRECISION = 200
"""Precision in bits with which tables and proofs are computed; an error of 2^-190 changes neither."""

Function = Callable[[mpmath.mpf], mpmath.mpf]
Segment = tuple[mpmath.mpf, mpmath.mpf]
"""Left end and width of a segment."""


@dataclass(frozen=True)
class Form:
    """Size of a table, and the formats of ``ik_quadratic``.  A table without c2 is linear: its slope is c1."""

    rows: int
    u_frac: int  # fraction bits of u
    u_low: int  # bits of u below its high part
    c_frac: tuple[int, ...]  # fraction bits of the table's words c0, c1, c2, all unsigned
    c_bits: tuple[int, ...]  # widths of the table's words
    slope_frac: int  # fraction bits of the slope, c1 -+ c2 u
    slope_low: int  # bits of the slope below its high part
    sum_frac: int  # fraction bits of the term added to c0

    @property
    def linear(self) -> bool:
        return len(self.c_frac) < 3

    @property
    def tiles(self) -> int:
        """Number of tile products of slope times u; the product of the low parts is omitted."""
        return 3 if self.slope_low else 1

    @property
    def index_bits(self) -> int:
        """Bits of a row number."""
        return self.rows.bit_length() - 1

    @property
    def clocks(self) -> int:
        """Clocks of ``ik_quadratic``: with c2, operands, c2 u, slope; then operands, slope times u, sum, result."""
        return 4 if self.linear else 7


@dataclass(frozen=True)
class Table:
    """Function with its segments and three forms; the word length and the multipliers select one form."""

    function: Function
    segment: Callable[[Form, int], Segment]  # form, row -> segment
    derivative: Callable[[bool, Segment], mpmath.mpf]  # largest magnitude of the 2nd derivative if linear, else the 3rd
    short_frac: int  # largest number of fraction bits of a result for which the short form is used
    short: Form
    long: Form
    small: Form  # for tiles of less than 18 bits
    besides: int  # clocks of the function's module in addition to ik_quadratic's

    def form(self, frac: int, tile: int = TILE) -> Form:
        """Return the form for ``frac`` fraction bits of the result and tiles of ``tile`` bits."""
        return self.small if tile < TILE else self.short if frac <= self.short_frac else self.long

    def clocks(self, frac: int, tile: int = TILE) -> int:
        """Return the latency of the function's module in clocks."""
        return self.besides + self.form(frac, tile).clocks


# ---- words -----------------------------------------------------------------------------------------------------------


def interpolant(form: Form, function: Function, segment: Segment) -> list[mpmath.mpf]:
    """Return the signed coefficients c0, c1 and, unless linear, c2: the interpolant at the Chebyshev nodes."""
    left, width = segment
    middle = left + width / 2
    a = mpmath.sqrt(len(form.c_frac)) / 4 * width
    low, high = function(middle - a), function(middle + a)
    if form.linear:
        return [(low + high) / 2, (high - low) / (2 * a)]
    return [function(middle), (high - low) / (2 * a), (low - 2 * function(middle) + high) / (2 * a * a)]


def _words(form: Form, function: Function, segment: Segment) -> tuple[int, ...]:
    """Return a row of the table: the coefficients' magnitudes, rounded to nearest.  The rounding of c2 causes an error
    at the segment's ends; half of it is subtracted from c0 before c0 is rounded."""
    c0, *c = interpolant(form, function, segment)
    rounded = [mpmath.nint(abs(value) * 2**frac) for value, frac in zip(c, form.c_frac[1:], strict=True)]
    for word, value, frac in list(zip(rounded, c, form.c_frac[1:], strict=True))[1:]:
        c0 -= (mpmath.sign(value) * word / 2**frac - value) * segment[1] ** 2 / 8
    return tuple(int(word) for word in (mpmath.nint(c0 * 2 ** form.c_frac[0]), *rounded))


@cache
def table_rows(table: Table, form: Form) -> tuple[tuple[int, ...], ...]:
    """Return the rows of a table."""
    with mpmath.workprec(PRECISION):
        return tuple(_words(form, table.function, table.segment(form, row)) for row in range(form.rows))


@cache
def columns(table: Table, form: Form) -> np.ndarray:
    """Return a table as an array (coefficient, row)."""
    return np.array(table_rows(table, form), dtype=np.int64).T


# ---- bits ------------------------------------------------------------------------------------------------------------


def polynomial(form: Form, row, u, rises: bool, bends_up: bool):
    """Return c0 + u slope if the function ``rises``, else c0 - u slope, with ``sum_frac`` fraction bits.  The slope is
    c1 + c2 u if ``bends_up``, else c1 - c2 u."""
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


# ---- proof -----------------------------------------------------------------------------------------------------------


@cache
def row_error(table: Table, form: Form, row: int, rises: bool) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Return the least and greatest error of :func:`polynomial` over the segment of a table row, both ends included.
    The cosine reads the sine's rows with ``rises`` False and u negated.  The errors that add up:

    * Interpolation with nodes at u = -a, 0 and a: 1/6 of the third derivative times (u + a) u (u - a), a product of at
      most width^3 / 32.  In a linear form, 1/2 of the second derivative times (u + a) (u - a), at most width^2 / 8.
    * Rounding of the coefficients: exactly r0 + r1 u + r2 u^2.
    * u times the error of the slope, which is less than one ulp of the slope plus c2 times an ulp of u's high part.
    * Tiles: each is truncated by less than an ulp of the sum, and the product of the low parts is omitted.
    """
    with mpmath.workprec(PRECISION):
        segment, words = table.segment(form, row), table_rows(table, form)[row]
        width = segment[1]
        exact = interpolant(form, table.function, segment)
        rounded = (mpmath.sign(c) * word / 2**bits for c, word, bits in zip(exact, words, form.c_frac, strict=True))
        r0, r1, *r2 = (word - c for word, c in zip(rounded, exact, strict=True))
        one = mpmath.mpf(1)
        u_place = one / 2 ** (form.u_frac - form.u_low)
        slope = bend = mpmath.mpf(0)
        if r2:
            slope = one / 2**form.slope_frac + (one * words[2] / 2 ** form.c_frac[2] * u_place if form.u_low else 0)
            bend = r2[0] * width**2 / 4
        interpolated = table.derivative(form.linear, segment) * (width**2 / 16 if form.linear else width**3 / 192)
        aside = interpolated + (abs(r1) + slope) * width / 2
        left_out = u_place / 2 ** (form.slope_frac - form.slope_low) if form.u_low else 0
        tiles = form.tiles * one / 2**form.sum_frac + left_out
        low, high = (tiles, 0) if rises else (0, tiles)
        return r0 + min(bend, 0) - aside - low, r0 + max(bend, 0) + aside + high


# ---- reciprocal square root ------------------------------------------------------------------------------------------


def _root_segment(form: Form, row: int) -> Segment:
    """Return the segment of a table row.  The first half of the rows covers [1/4, 1/2), where the function is steeper,
    the second half [1/2, 1) with segments twice as wide."""
    half, width = form.rows // 2, mpmath.mpf(1) / form.rows
    return ((half + row) * width / 2, width / 2) if row < half else (row * width, width)


def _root_derivative(linear: bool, segment: Segment) -> mpmath.mpf:
    """Return |f''| (if ``linear``) or |f'''| of f = 1/(2 sqrt m) at a segment's left end, where it is largest."""
    left = segment[0]
    return mpmath.mpf(3) / 8 * left ** mpmath.mpf(-2.5) if linear else mpmath.mpf(15) / 16 * left ** mpmath.mpf(-3.5)


INVERSE_ROOT = Table(
    function=lambda m: 1 / (2 * mpmath.sqrt(m)),
    segment=_root_segment,
    derivative=_root_derivative,
    short_frac=22,
    short=Form(2048, 25, 0, (27, 14), (26, 15), 14, 0, 28),
    long=Form(1024, 34, 6, (34, 23, 12), (33, 24, 15), 25, 9, 36),
    small=Form(512, 33, 8, (33, 22, 11), (32, 23, 14), 24, 10, 34),
    besides=1,  # output register of the table, which is read while the mantissa is registered
)
"""Table of ``ik_rsqrt``; c0 is stored without its MSB, which is 1."""

SMALL_FRAC = 29
"""Maximum number of fraction bits of a root in the small form."""


def rsqrt_places(frac: int, tile: int = TILE) -> float:
    """Return an upper bound of the error of :func:`rsqrt` in ulps; :func:`rsqrt_error` proves a tighter one."""
    return 1.1 if tile < TILE and frac >= SMALL_FRAC else 1.0


def place(form: Form, m, frac: int):
    """Return the table row of a mantissa, and its u in that row."""
    lower = m < 1 << frac + 2
    below = frac + 3 - form.index_bits - lower  # bits of m below its segment number
    row = (m >> below) - np.where(lower, form.rows // 2, 0)
    u = (m & (1 << below) - 1) - (1 << below - 1)
    return row, u << form.u_frac - frac - 3


def rounding(form: Form, frac: int) -> int:
    """Return the rounding constant, with ``sum_frac`` fraction bits, that is added to c0: 3/8 ulp of the result minus
    half of the largest loss by the tiles' truncation.  It is not half an ulp, because a truncated mantissa makes the
    root too large by up to a quarter ulp."""
    return (3 << form.sum_frac - frac - 3) - (form.tiles + 1) // 2


def root_sum(form: Form, m, frac: int):
    """Return the polynomial at a mantissa, with ``sum_frac`` fraction bits and without the rounding constant."""
    row, u = place(form, m, frac)
    return polynomial(form, columns(INVERSE_ROOT, form)[:, row], u, rises=False, bends_up=False)


def rsqrt(m, frac: int, tile: int = TILE):
    """Return 1/(2 sqrt m) as ``ik_rsqrt`` computes it, with ``frac`` fraction bits.  m is a mantissa of frac + 3 bits.

    If m < 1/4, its second bit is treated as set, so m = 0 gives 1.  The error is below :func:`rsqrt_places`, even if m
    is a truncated longer mantissa (:func:`rsqrt_error`).
    """
    m = np.asarray(m, dtype=np.int64)
    form = INVERSE_ROOT.form(frac, tile)
    second = 1 << frac + 1
    y = root_sum(form, np.where(m < second, m | second, m), frac) + rounding(form, frac)
    return y >> form.sum_frac - frac


@cache
def rsqrt_error(frac: int, tile: int = TILE) -> float:
    """Return the largest difference of :func:`rsqrt` from 1/(2 sqrt V) in ulps of the result, for all V in [1/4, 1).

    V is any real number whose truncation to frac + 3 bits is m.  Three errors add up in each segment: the error at m
    (:func:`row_error`); the rounding constant minus a truncation of less than an ulp; and the fall of 1/(2 sqrt V) from
    m to V.  This fall is at most an ulp of m times the slope at the segment's left end, where it is steepest.
    """
    form = INVERSE_ROOT.form(frac, tile)
    with mpmath.workprec(PRECISION):
        last = mpmath.mpf(2) ** -frac
        added = mpmath.mpf(rounding(form, frac)) / 2**form.sum_frac
        ends = []
        for row in range(form.rows):
            steepest = INVERSE_ROOT.segment(form, row)[0] ** mpmath.mpf(-1.5) / 4
            low, high = row_error(INVERSE_ROOT, form, row, rises=False)
            ends += [low + added - last, high + added + steepest * last / 8]
        return float(max(map(abs, ends)) / last)


# ---- sine and cosine of half an angle --------------------------------------------------------------------------------

# phi/2 lies within a quarter turn on either side of 0.  With t = |phi|/2 as a fraction of a quarter turn,
#
#     sin |phi/2| = S(t)    cos |phi/2| = S(1 - t)    S(t) = sin(pi/2 t)
#
# and the segments of S(1 - t) are the segments of S in reverse order, with u negated: a row gives both functions.


def _sine_derivative(linear: bool, segment: Segment) -> mpmath.mpf:
    """Return the largest |f''| (``linear``) or |f'''| of f = sin(pi/2 t) in a segment: |f''| at its right end,
    |f'''| at its left end."""
    (left, width), quarter = segment, mpmath.pi / 2
    return quarter**2 * mpmath.sin(quarter * (left + width)) if linear else quarter**3 * mpmath.cos(quarter * left)


SINE = Table(
    function=lambda t: mpmath.sin(mpmath.pi / 2 * t),
    segment=lambda form, row: (row * mpmath.mpf(1) / form.rows, mpmath.mpf(1) / form.rows),
    derivative=_sine_derivative,
    short_frac=23,
    short=Form(2048, 25, 0, (27, 14), (28, 15), 14, 0, 28),
    long=Form(1024, 31, 4, (34, 23, 12), (35, 24, 13), 25, 9, 36),
    small=Form(512, 31, 7, (33, 22, 11), (34, 23, 12), 24, 10, 34),
    besides=4,  # magnitude, table, its output register, sign
)
"""Table of ``ik_trig``; c0 plus the rounding constant can be 1."""

SINE_FRACS = range(19, 32)
"""Numbers of fraction bits that sines and cosines may have."""


def half_sincos(phi, width: int, frac: int, tile: int = TILE):
    """Return (sin, cos) of phi/2 as ``ik_trig`` computes them, with ``frac`` fraction bits, 19 to 31.

    ``phi`` is an int64 array of binary angles, one turn = 2^width; ``width`` is 16 to 32, up to 26 in the short form.
    """
    form = SINE.form(frac, tile)
    dropped = form.sum_frac - frac
    sin, cos = (y + (1 << dropped - 1) >> dropped for y in sine_sums(np.abs(phi), width, form))
    return np.where(phi < 0, -sin, sin), cos


def sine_sums(a, width: int, form: Form):
    """Return (sin, cos) of :func:`half_sincos` before rounding, with ``sum_frac`` fraction bits, for angles a >= 0."""
    below = width - 1 - form.index_bits  # bits of a below its segment number
    row = np.minimum(a >> below, form.rows - 1)  # a quarter turn is the end of the last segment
    u = a - (row << below) - (1 << below - 1) << form.u_frac - width + 1
    words = columns(SINE, form)
    sin = polynomial(form, words[:, row], u, rises=True, bends_up=False)
    return sin, polynomial(form, words[:, form.rows - 1 - row], u, rises=False, bends_up=True)


@cache
def half_sincos_error(frac: int, tile: int = TILE) -> float:
    """Return the largest error of :func:`half_sincos` in ulps, proved for every phi: the largest error of a row plus
    half an ulp for rounding the result."""
    form = SINE.form(frac, tile)
    with mpmath.workprec(PRECISION):
        rows = [row_error(SINE, form, row, rises) for row in range(form.rows) for rises in (True, False)]
        worst = max(abs(end) for ends in rows for end in ends)
        return float(worst * 2**frac + mpmath.mpf(1) / 2)


# ---- operations ------------------------------------------------------------------------------------------------------


def _faithful(node, frac: int, most: float = 1.0) -> tuple[float, float]:
    """Return the error range (low, high) of the node: -+``most`` ulps of a word with ``frac`` fraction bits, converted
    to ulps of the node, which may have more fraction bits."""
    bound = most * 2.0 ** max(node.format.frac - frac, 0)
    return -bound, bound


class Rsqrt(Operation):
    """1/(2 sqrt m) of a mantissa m in [1/4, 1); 1 where m = 0; doubled where the mask ``twice`` is set.

    The root has 3 fraction bits fewer than m.  The node may have more; its low bits are then 0.
    """

    kind, latency, adds_rounding = "rsqrt", "rsqrt", True

    def __init__(self, m: Node, twice: Node | None = None) -> None:
        super().__init__(m, *([twice] if twice else []))
        self.m, self.twice = m, twice
        self.root_frac = m.frac - 3

    def error(self, node):
        return _faithful(node, self.root_frac, rsqrt_places(self.root_frac, node.flow.tile) * (2 if self.twice else 1))

    def result(self, node, values):
        y = rsqrt(self.m.words(values), self.root_frac, node.flow.tile) << (node.format.frac - self.root_frac)
        return y << np.where(self.twice.words(values), 1, 0) if self.twice else y

    def real_result(self, node, values):
        m = self.m.words(values) * self.m.format.ulp
        inverse = 0.5 / np.sqrt(np.where(m > 0, m, 0.25)) / node.format.ulp
        return inverse * np.where(self.twice.words(values), 2.0, 1.0) if self.twice else inverse

    def growth(self, node, bounds):
        # The slope of 1/(2 sqrt m) is at most 2 (m >= 1/4); the operation's own error includes a truncated mantissa.
        return 0.0 if self.m.kind == "even" else (4 if self.twice else 2) * bounds[self.m.name].error

    def facts(self, node, domain):
        m, y = self.m.formula(domain), node.name
        one = f"(ite {self.twice.formula(domain)} 4.0 1.0)" if self.twice else "1.0"
        return [f"(ite (= {m} 0.0) (= {y} 1.0) (= (* 4.0 {m} {y} {y}) {one}))", f"(< 0.0 {y})"]

    def text(self, level=0):
        m = self.m.text()
        return f"{self.twice.text()} ? 1 / sqrt {m} : 1 / (2 * sqrt {m})" if self.twice else f"1 / (2 * sqrt {m})"

    def lower(self, to, node):
        to.rsqrt(node, self.m, self.twice)


class HalfAngle(Unary):
    """Sine or cosine of phi/2, where the binary angle phi is at most half a turn in either direction."""

    kind, latency, adds_rounding = "trig", "trig", True

    def __init__(self, phi: Node, function: str) -> None:
        super().__init__(phi)
        self.function = function

    def error(self, node):
        return self.rounds or _faithful(node, SINE_FRACS[-1])

    def pair(self, node, phi):
        """Return the words of sine and cosine."""
        width = max(node.flow.width, 16)  # a shorter angle is padded with zeros
        frac = min(node.format.frac, SINE_FRACS[-1])
        both = half_sincos(phi << width - node.flow.width, width, frac, node.flow.tile)
        return [words << node.format.frac - frac for words in both]

    def result(self, node, values):
        key = "half angle", self.term.name
        if key not in values:
            values[key] = self.pair(node, self.term.words(values))
        return values[key][self.function == "cos"]

    def real_result(self, node, values):
        half = self.term.words(values) * self.term.format.ulp * (np.pi / 2)  # half a turn is 1
        return (np.sin(half) if self.function == "sin" else np.cos(half)) / node.format.ulp

    def growth(self, node, bounds):
        return 0.0

    def facts(self, node, domain):
        sine, cosine = node.flow.half_angle
        return [f"(= 1.0 (+ (* {sine} {sine}) (* {cosine} {cosine})))", f"(<= 0.0 {cosine})"]

    def text(self, level=0):
        return f"{self.function}({self.term.text()} / 2)"

    def lower(self, to, node):
        if self.function == "cos":
            to.half_angle(*node.flow.half_angle, self.term)

# SPDX-License-Identifier: Apache-2.0
"""``ik_trig`` in integers: sine and cosine of half the swivel angle, from a table and one Taylor step.

theta = phi/2 lies in a quarter turn on either side of 0.  |theta| = theta_i + delta, where theta_i is the nearest of
512 table points a quarter turn and |delta| <= pi/2048; s_i, c_i are the table's sine and cosine, v = sin(delta):

    sin |theta| = s_i + v (c_i - s_i v/2)
    cos |theta| = c_i - v (s_i + c_i v/2)

which replaces cos(delta) by 1 - v^2/2, too small by (1 - cos(delta))^2/2 < 2^-40.  A quarter turn holds 2^(width-1)
steps of phi, so that delta is pi/2 times a binary fraction.  v is 2 - COMPLEMENT times this fraction by one multiplier
tile, and a small table gives the rest: what COMPLEMENT lacks, and the sine's cubic term.

Words inside carry ``GUARD`` more fraction bits than the results, the tables those of the largest result.
"""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np

FRACS = range(19, 32)
"""Fraction bits of a result that the core is built for."""

TRIG_CLOCKS = 10
"""Clocks of ``ik_trig``: magnitude; table point; fine product; v; slope product; slope; tiles; tile sums; sum; sign."""

GUARD = 5
"""Fraction bits that words inside have more than the result."""

TABLE_FRAC = FRACS[-1] + GUARD
POINTS = 512
FINE_BITS = 22
"""Of the signed word of delta, whose unit is pi/2 * 2^-31; a shorter phi leaves low bits 0."""

LOW_BITS = 4
"""Bits of the fine word below the 18 that fit a multiplier tile."""

COMPLEMENT_FRAC = 18
REST_INDEX = 7
"""Upper bits of the fine word that the table of the rest is indexed with."""

TILE_FRAC = 16
"""Fraction bits of a table value or slope in a signed tile of 18 bits: it can be 1."""

ONE_TILE = 21
"""Up to this many fraction bits of the result, v times slope is one tile."""


@cache
def sine_table() -> tuple[int, ...]:
    """round(2^TABLE_FRAC sin(i/512 quarter turns)), i = 0..511.  The cosine is read from 512 - i; 512 itself is 1."""
    with mpmath.workprec(200):
        sines = (mpmath.sin(mpmath.pi * i / (2 * POINTS)) for i in range(POINTS))
        return tuple(int(mpmath.nint(s * 2**TABLE_FRAC)) for s in sines)


@cache
def complement() -> int:
    """round(2^COMPLEMENT_FRAC (2 - pi/2)): 17 bits."""
    with mpmath.workprec(200):
        return int(mpmath.nint((2 - mpmath.pi / 2) * 2**COMPLEMENT_FRAC))


@cache
def low_table() -> tuple[int, ...]:
    """round(2^TABLE_FRAC pi/2 k 2^-31), k = 0..15: the arc of the fine word's bits below the tile."""
    with mpmath.workprec(200):
        return tuple(int(mpmath.nint(mpmath.pi * k * 2 ** (TABLE_FRAC - 32))) for k in range(1 << LOW_BITS))


@cache
def rest_table() -> tuple[int, ...]:
    """floor(2^TABLE_FRAC (sin(delta) - (2 - COMPLEMENT) fine)), by the fine word's upper bits as an unsigned index.

    The rest falls with delta: the mean of an interval's two ends is nowhere in it off by more than half of what it
    falls there.  The floor goes with the floor of the product that is subtracted.
    """
    half, step = 1 << (REST_INDEX - 1), 1 << (FINE_BITS - REST_INDEX)

    def rest(fine):
        near = (2 - mpmath.mpf(complement()) / 2**COMPLEMENT_FRAC) * fine / 2**31
        return (mpmath.sin(mpmath.pi * fine / 2**32) - near) * 2**TABLE_FRAC

    with mpmath.workprec(200):
        signed = [k - 2 * half if k >= half else k for k in range(2 * half)]
        return tuple(int(mpmath.floor((rest(k * step) + rest((k + 1) * step)) / 2)) for k in signed)


def fine_sine(fine, frac: int):
    """v: the sine of pi/2 * fine * 2^-31 with ``frac + GUARD`` fraction bits.  ``fine`` is an int64 array."""
    drop = FRACS[-1] - frac
    high, low = fine >> LOW_BITS, fine & ((1 << LOW_BITS) - 1)
    base = (high << (TABLE_FRAC - 30 + LOW_BITS)) + np.array(low_table())[low]
    index = (fine >> (FINE_BITS - REST_INDEX)) & ((1 << REST_INDEX) - 1)
    x = (base >> drop) + (np.array(rest_table())[index] >> drop)
    return x - ((high * complement()) >> (31 - LOW_BITS + COMPLEMENT_FRAC - frac - GUARD))


def half_sincos(phi, width: int, frac: int):
    """``ik_trig``: (sin, cos) of phi/2 with ``frac`` fraction bits; phi a binary angle, one turn = 2^width.

    ``phi`` is an int64 array, ``width`` 16 to 32, ``frac`` 19 to 31; the datapath's is min(width + 3, 31).
    """
    drop = FRACS[-1] - frac
    unit = frac + GUARD
    # nearest table point, and what is left as a fine word
    negative = phi < 0
    a = np.where(negative, -phi, phi)
    cut = width - 10
    point = (a + (1 << (cut - 1))) >> cut
    fine = (a - (point << cut)) << (32 - width)
    v = fine_sine(fine, frac)

    table = np.array((*sine_table(), 1 << TABLE_FRAC))
    s, c = table[point] >> drop, table[POINTS - point] >> drop

    # slopes
    one_tile = frac <= ONE_TILE
    low_v = 0 if one_tile else frac - ONE_TILE  # bits of v below its tile
    m_frac = TILE_FRAC if one_tile else frac - 4
    v_high, v_low = v >> low_v, v & ((1 << low_v) - 1)
    half_product = TILE_FRAC + unit - low_v - m_frac + 1  # the last bit halves
    p_s = ((s >> (unit - TILE_FRAC)) * v_high) >> half_product
    p_c = ((c >> (unit - TILE_FRAC)) * v_high) >> half_product
    m_c = (c >> (unit - m_frac)) - p_s
    m_s = (s >> (unit - m_frac)) + p_c + 1  # both terms are rounded down: half of it back

    # v times slope, without the product of the low parts
    low_m = m_frac - TILE_FRAC

    def tiles(m):
        m_high, m_low = m >> low_m, m & ((1 << low_m) - 1)
        high = (m_high * v_high) >> (TILE_FRAC - low_v)
        if one_tile:
            return high, 0
        return high, (m_low * v_high + ((m_high * v_low) << (low_m - low_v))) >> (low_m + TILE_FRAC - low_v)

    # Both parts are rounded down: the sums below take half of it back.
    high, middle = tiles(m_c)
    sin = s + high + 1 + middle
    high, middle = tiles(m_s)
    cos = c - high - 1 - middle

    # half up in magnitude, then the sign
    sin = (sin + (1 << (GUARD - 1))) >> GUARD
    cos = (cos + (1 << (GUARD - 1))) >> GUARD
    return np.where(negative, -sin, sin), cos


def error_bound(width: int, frac: int) -> float:
    """Largest error of :func:`half_sincos` in units of its last place: a proof for every phi.

    The error of v is taken from all fine words, the rest is counted, with s, c, v as the words hold them and |v| <= V:

    * s and c are off by the table's rounding and by what a shorter word drops, e; in the result e (1 + V);
    * v off by d: d (1 + V) in the result, once by the slope and once, V of it, by 1 - v^2/2;
    * 1 - sin(delta)^2/2 - cos(delta) = (1 - cos(delta))^2/2;
    * a slope: the product s v/2 of words rounded down to the tile, and two terms rounded down, less half of that, so
      that it is off by one last place on either side; in the result V times as much;
    * the product of low parts that is left out; two parts rounded down, off by one last place on either side;
    * half a last place for the rounding of the result.
    """
    step = 1 << (32 - width)
    fine = np.arange(-(1 << (FINE_BITS - 1)), 1 << (FINE_BITS - 1), step)
    exact = np.sin(np.pi * 2.0**-32 * fine)
    v = fine_sine(fine, frac) * 2.0 ** -(frac + GUARD)
    d = abs(v - exact).max() + 2.0**-60  # and what the floats are off
    top = max(abs(v).max(), abs(exact).max())

    one_tile = frac <= ONE_TILE
    drop = FRACS[-1] - frac
    unit = 2.0 ** -(frac + GUARD)
    e = 2.0 ** -(TABLE_FRAC + 1) + (2**drop - 1) * 2.0**-TABLE_FRAC
    v_tile = 0.0 if one_tile else unit * 2 ** (frac - ONE_TILE)
    m_unit = 2.0**-TILE_FRAC if one_tile else 2.0 ** -(frac - 4)
    slope = 2.0**-TILE_FRAC * top / 2 + v_tile / 2 + m_unit
    left_out = 2.0**-TILE_FRAC * v_tile
    taylor = (1 - np.cos(np.pi / 2048)) ** 2 / 2
    return float(0.5 + 2.0**frac * ((e + d) * (1 + top) + taylor + slope * top + left_out + unit))

# SPDX-License-Identifier: Apache-2.0
"""Error bound of the CORDIC, ``model.dataflow.fixed.cordic`` and ``ik_sincos``."""

import math

import mpmath

from ..dataflow.fixed import SINCOS_GUARD, TABLE_BITS, atan_table, cordic_gain, round_shift


def sincos_bound(width: int) -> float:
    """Return the largest error of ``ik_sincos`` in ulps, 2^-(width-2).

    With G guard bits, in units g = 2^-G ulp:

    * x and y lose less than 1 g in each iteration i >= 1 (the shift of iteration 0 is exact), a vector of less than
      sqrt(2) g; later iterations stretch it by the product of their sqrt(1 + 4^-j);
    * the error of the rounded gain word is stretched by K = 1.6468;
    * the angle: one ulp of z is pi/4 g as an arc.  After n = width iterations the residual is at most the last angle,
      atan(2^-(n-1)).  The rounding of each table angle counts twice: once in the angle turned, and once in the
      residual, because the remaining rounded angles may fall short by that much;
    * rounding the result: half an ulp.
    """
    inner = width + SINCOS_GUARD
    stretch = [math.prod(math.sqrt(1 + 4.0**-j) for j in range(i + 1, width)) for i in range(width)]
    lost = math.sqrt(2) * sum(stretch[1:])
    with mpmath.workprec(200):
        exact = mpmath.fprod(1 / mpmath.sqrt(1 + mpmath.mpf(4) ** -i) for i in range(100))
        off = float(abs(round_shift(cordic_gain(), TABLE_BITS - inner + 2) - exact * 2 ** (inner - 2)))
        angles = (mpmath.atan(mpmath.mpf(2) ** -i) / mpmath.pi * 2**inner for i in range(width))
        words = (round_shift(word, TABLE_BITS - inner) for word in atan_table())
        table = float(sum(abs(word - angle) for word, angle in zip(words, angles, strict=False)))
    gain = off * stretch[0] * math.sqrt(2)
    angle = math.atan(2.0 ** (1 - width)) * 2.0 ** (inner - 2) + 2 * table * math.pi / 4
    return 0.5 + (lost + gain + angle) / 2**SINCOS_GUARD

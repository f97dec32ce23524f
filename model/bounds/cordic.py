# SPDX-License-Identifier: Apache-2.0
"""A bound of the CORDIC's error, ``model.dataflow.fixed.cordic`` and ``ik_sincos``."""

import math


def sincos_bound(width: int) -> float:
    """Largest error of ``ik_sincos`` in units of its last place, 2^-(width-2).

    With G = 6 guard bits, in units g = 2^-G of the last place:

    * x and y lose less than 1 g in each iteration i >= 1 (the shift of iteration 0 is exact), a vector of less than
      sqrt(2) g, which the iterations after it stretch by the product of their sqrt(1 + 4^-j);
    * the rounded gain is off by 1/2 g, stretched by K = 1.6468;
    * the angle: one place of z is pi/4 g as an arc.  After n = width iterations at most the last angle,
      atan(2^-(n-1)) = 32 g, is left to turn.  Each table angle is off by half a place and half a bit of the 48-bit
      table; once in what has been turned, and once more in what is left, because the rounded angles after a step may
      be that much short of taking it back;
    * rounding the result: half a last place.
    """
    guard = 6
    stretch = [math.prod(math.sqrt(1 + 4.0**-j) for j in range(i + 1, width)) for i in range(width)]
    lost = math.sqrt(2) * sum(stretch[1:])
    gain = 0.5 * stretch[0] * math.sqrt(2)
    place = math.pi / 4
    table = 0.5 + 2.0 ** (width + guard - 49)
    angle = math.atan(2.0 ** (1 - width)) * 2.0 ** (width - 2 + guard) + 2 * width * table * place
    return 0.5 + (lost + gain + angle) / 2**guard

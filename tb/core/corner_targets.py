# SPDX-License-Identifier: Apache-2.0
"""Targets at the corners of the arithmetic: arms of all sizes, and angles close to a rounding boundary."""

import itertools

import numpy as np

from model.dataflow.nodes import inner_frac
from model.dataflow.quadratic import SINE, SINE_FRACS, sine_sums


def corner_targets(width: int, tile: int) -> np.ndarray:
    """Return targets and arms of all magnitudes, in words with few significant bits, and targets with angles whose sine
    or cosine sum is one unit below the rounding boundary."""
    sizes = itertools.product(range(0, width - 6, 3), range(width - 11))
    shifted = [(29 << j, -26 << j, -25 << j, -10647, 0, 999 << k) for j, k in sizes]
    frac = min(inner_frac(width), SINE_FRACS[-1])
    form = SINE.form(frac, tile)
    angles = np.random.default_rng(5).integers(0, 1 << width - 1, 100000)
    dropped = (1 << form.sum_frac - frac) - 1
    near = [angles[y & dropped == dropped >> 1][:10] for y in sine_sums(angles, width, form)]
    return np.array([*shifted, *((999, -700, 444, angle, 999, 999) for angle in np.concatenate(near))])

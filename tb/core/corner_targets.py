# SPDX-License-Identifier: Apache-2.0
"""Targets at the corners of the arithmetic: arms of all sizes, and angles close to a rounding boundary."""

from __future__ import annotations

import itertools

import numpy as np

from model.dataflow.quadratic import sine_sums


def shifted(width: int) -> np.ndarray:
    """Return targets and arms of all magnitudes, in words with few significant bits."""
    sizes = itertools.product(range(0, width - 6, 3), range(width - 11))
    return np.array([(29 << j, -26 << j, -25 << j, -10647, 0, 999 << k) for j, k in sizes])


def nearly_rounded_up(width: int, form, frac: int) -> np.ndarray:
    """Return targets with angles whose sine or cosine sum is one unit below the rounding boundary."""
    angles = np.random.default_rng(5).integers(0, 1 << width - 1, 100000)
    dropped = (1 << form.sum_frac - frac) - 1
    near = [angles[y & dropped == dropped >> 1][:10] for y in sine_sums(angles, width, form)]
    return np.array([(999, -700, 444, angle, 999, 999) for angle in np.concatenate(near)])

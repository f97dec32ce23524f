# SPDX-License-Identifier: Apache-2.0
"""Tests that the bit-true CORDIC stays within its derived bound."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from model.bounds.cordic import sincos_bound
from model.dataflow.fixed import cordic


def errors(phi, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors of sine and cosine in ulps; double precision is exact enough for an ulp of 2^-30."""
    sin, cos = cordic(phi, width)
    half = np.pi * phi.astype(np.float64) / 2**width
    one = 1 << width - 2
    return sin - np.sin(half) * one, cos - np.cos(half) * one


@pytest.mark.parametrize("width", [16, 18, 24, 27, 32])
def test_cordic_is_within_its_bound(width):
    """Every angle of 16 and 18 bits, 300000 of the others, including both ends and the quarter turns."""
    half = 1 << width - 1
    if width <= 18:
        phi = np.arange(-half, half)
    else:
        near = np.array([q + e for q in (-half, -half // 2, 0, half // 2, half) for e in range(-100, 101)])
        phi = np.concatenate(
            [np.random.default_rng(width).integers(-half, half, 300000), near[(near >= -half) & (near < half)]]
        )
    off = errors(phi, width)
    largest = np.maximum(*np.abs(off))
    worst = int(largest.argmax())
    bound = sincos_bound(width)
    print(f"cordic, {width} bits: largest error {largest[worst]:.3f} last places, bound {bound:.3f}")
    assert largest[worst] <= bound, f"{largest[worst]:.3f} last places at phi={phi[worst]}, bound {bound:.3f}"
    assert largest[worst] >= 0.5, f"largest error {largest[worst]:.3f}: the rounding alone costs half a place"
    # Rounding half up with 6 guard bits leaves 1/128 ulp, the iterations about as much; truncation leaves 1/2.
    means = [float(e.mean()) for e in off]
    assert max(map(abs, means)) < 1 / 16, f"mean errors of sine and cosine: {means} last places"


@given(st.integers(-(1 << 31), (1 << 31) - 1))
def test_cordic_of_any_angle(phi):
    assert np.max(np.abs(errors(np.array([phi]), 32))) <= sincos_bound(32), f"phi={phi}"

# SPDX-License-Identifier: Apache-2.0
"""Bit-true sine and cosine of half an angle against mpmath and long doubles, with its tables and bound."""

import mpmath
import numpy as np
import pytest

from model.dataflow import quadratic
from model.dataflow.cores import TILE
from model.dataflow.nodes import inner_frac
from model.dataflow.trig import (
    FRACS,
    LONG,
    SHORT,
    SMALL,
    error_bound,
    form_of,
    half_sincos,
    segment,
    sine,
    sine_rows,
)

WIDTHS = range(16, 33)
PI = np.longdouble("3.14159265358979323846264338")
TILES = [(width, TILE) for width in WIDTHS] + [(width, 16) for width in range(16, 25)]
AIM = 0.95
"""Upper limit of the proved bound, in ulps."""

RANDOM = 200_000


def frac(width: int) -> int:
    """Return the fraction bits of the datapath's sines and cosines."""
    return min(inner_frac(width), FRACS[-1])


def angles(width: int) -> np.ndarray:
    """Return all angles at short words; otherwise random ones, and those around ends and middles of segments."""
    low, high = -(1 << width - 1), (1 << width - 1) - 1
    if width <= 18:
        return np.arange(low, high + 1)
    step = 1 << width - 11
    points = np.arange(-LONG.rows, LONG.rows + 1)[:, None] * step
    near = (points + np.concatenate([np.arange(-9, 10), np.arange(-9, 10) + step // 2])).ravel()
    anywhere = np.random.default_rng(width).integers(low, high, RANDOM, endpoint=True)
    return np.concatenate([near[(near >= low) & (near <= high)], anywhere])


def errors(phi: np.ndarray, width: int, bits: int, tile: int = TILE) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors of sine and cosine in ulps of ``bits`` fraction bits, against long doubles."""
    sin, cos = half_sincos(phi, width, bits, tile)
    half = phi.astype(np.longdouble) * PI / 2**width
    one = np.longdouble(2) ** bits
    return sin - np.sin(half) * one, cos - np.cos(half) * one


@pytest.mark.parametrize(("width", "tile"), TILES)
def test_error_stays_below_the_bound(width, tile):
    bound = error_bound(frac(width), tile)
    assert bound < AIM, f"width {width}: {bound}"
    for name, error in zip(("sin", "cos"), errors(angles(width), width, frac(width), tile), strict=True):
        worst = float(abs(error).max())
        assert worst <= bound, f"width {width}: {name} is off by {worst} last places, bound {bound}"
        # a bound far above all measured errors would be wrong
        assert worst > 0.5, f"width {width}: {name} is off by only {worst} last places"


@pytest.mark.parametrize(("width", "tile"), TILES)
def test_exact_where_the_angle_is(width, tile):
    one = 1 << frac(width)
    phi = np.array([0, -(1 << width - 1)])
    sin, cos = half_sincos(phi, width, frac(width), tile)
    assert sin.tolist() == [0, -one]
    assert cos.tolist() == [one, 0]


@pytest.mark.parametrize(("width", "tile"), TILES)
def test_symmetry_and_range(width, tile):
    phi = angles(width)
    phi = phi[phi > -(1 << width - 1)]
    one = 1 << frac(width)
    sin, cos = half_sincos(phi, width, frac(width), tile)
    sin_back, cos_back = half_sincos(-phi, width, frac(width), tile)
    assert (sin_back == -sin).all(), "sine is not odd"
    assert (cos_back == cos).all(), "cosine is not even"
    assert abs(sin).max() <= one
    assert 0 < cos.min()
    assert cos.max() == one
    assert ((phi > 0) <= (sin > 0)).all()


@pytest.mark.parametrize("form", [SHORT, LONG, SMALL], ids=["short", "long", "small"])
def test_table_is_the_sine(form):
    """Each segment's middle matches floats; the words fit, including c0 plus the rounding constant."""
    rows = np.array(sine_rows(form), dtype=np.int64)
    middle = np.sin((np.arange(form.rows, dtype=np.longdouble) + 0.5) / form.rows * PI / 2)
    # at its middle, a linear form lies half of the bend above the chord through its nodes
    bend = (PI / 2 / form.rows) ** 2 / 16 if rows.shape[1] < 3 else 0
    # within half an ulp, plus the effect on c0 of rounding c2
    off = 2.0 ** -form.c_frac[0] / 2 + sum(2.0**-frac / 16 / form.rows**2 for frac in form.c_frac[2:])
    assert abs(rows[:, 0] / np.longdouble(2) ** form.c_frac[0] - middle * (1 - bend)).max() < 1.01 * off
    assert all((0 < column).all() for column in rows.T)
    assert all(column.max() < 1 << bits for column, bits in zip(rows.T, form.c_bits, strict=True))
    least = min(f for f in FRACS if form is SMALL or form_of(f) is form)
    assert rows[:, 0].max() + (1 << form.c_frac[0] - least - 1) < 1 << form.c_bits[0]


@pytest.mark.parametrize("form", [SHORT, LONG, SMALL], ids=["short", "long", "small"])
def test_parts_of_the_proof(form):
    """The largest interpolation error is close to its bound, in segments of nearly constant derivative."""
    with mpmath.workdps(60):
        for row in range(form.rows // 10, form.rows - form.rows // 10, 7):
            left, width = segment(form, row)
            c = quadratic.interpolant(form, sine, (left, width))
            straight = len(c) < 3
            end = left + width * straight
            quarter = mpmath.pi / 2
            derivative = quarter**2 * sine(end) if straight else quarter**3 * mpmath.cos(quarter * end)
            ends = [width * k / 4 for k in (-2, -1, 0, 1, 2)]
            off = [sum(c[k] * u**k for k in range(len(c))) - sine(left + width / 2 + u) for u in ends]
            assert 0.95 < max(map(abs, off)) / quadratic.interpolation_error(form, (left, width), derivative) <= 1, row

# SPDX-License-Identifier: Apache-2.0
"""The bit-true sine and cosine of half an angle against mpmath and long doubles, and its tables and bound."""

from pathlib import Path

import mpmath
import numpy as np
import pytest

from model.dataflow import trig as lean_trig
from model.dataflow.trig import POINTS, TABLE_FRAC, error_bound, fine_sine, half_sincos

WIDTHS = range(16, 33)
PI = np.longdouble("3.14159265358979323846264338")
AIM = 0.8
"""Last places that the proved bound has to stay below."""

RANDOM = 200_000


def frac(width: int) -> int:
    """Fraction bits of the datapath's inner words."""
    return min(width + 3, 31)


def angles(width: int) -> np.ndarray:
    """All of them where they are few; else random ones, and those around each table point and around each change."""
    low, high = -(1 << width - 1), (1 << width - 1) - 1
    if width <= 18:
        return np.arange(low, high + 1)
    step = 1 << width - 10
    points = np.arange(-POINTS, POINTS + 1)[:, None] * step
    near = (points + np.concatenate([np.arange(-9, 10), np.arange(-9, 10) + step // 2])).ravel()
    anywhere = np.random.default_rng(width).integers(low, high, RANDOM, endpoint=True)
    return np.concatenate([near[(near >= low) & (near <= high)], anywhere])


def errors(phi: np.ndarray, width: int, bits: int) -> tuple[np.ndarray, np.ndarray]:
    """Of sine and cosine in last places of ``bits`` fraction bits, against long doubles."""
    sin, cos = half_sincos(phi, width, bits)
    half = phi.astype(np.longdouble) * PI / 2**width
    one = np.longdouble(2) ** bits
    return sin - np.sin(half) * one, cos - np.cos(half) * one


def test_long_double_is_long():
    """What the errors are measured with has to be finer than what they are measured of."""
    assert np.finfo(np.longdouble).nmant >= 63


@pytest.mark.parametrize("width", WIDTHS)
def test_error_stays_below_the_bound(width):
    bound = error_bound(width, frac(width))
    assert bound < AIM, f"width {width}: {bound}"
    for name, error in zip(("sin", "cos"), errors(angles(width), width, frac(width)), strict=True):
        worst = float(abs(error).max())
        assert worst <= bound, f"width {width}: {name} is off by {worst} last places, bound {bound}"
        # a bound that is far from anything seen would be a bound of something else
        assert worst > 0.5, f"width {width}: {name} is off by only {worst} last places"


@pytest.mark.parametrize("width", [24, 32])
def test_error_against_mpmath(width):
    """A reference that shares nothing with numpy's, on fewer angles."""
    phi = angles(width)[:: 997 if width == 24 else 499]
    bound = error_bound(width, frac(width))
    with mpmath.workprec(120):
        for p, sin, cos in zip(phi.tolist(), *half_sincos(phi, width, frac(width)), strict=True):
            half = mpmath.pi * p / 2**width
            off = [abs(int(got) - f(half) * 2 ** frac(width)) for got, f in ((sin, mpmath.sin), (cos, mpmath.cos))]
            assert max(off) <= bound, f"phi {p}: off by {[float(o) for o in off]} last places"


@pytest.mark.parametrize("width", [16, 24, 32])
@pytest.mark.parametrize("result", lean_trig.FRACS)
def test_every_length_of_the_result_keeps_the_bound(width, result):
    """Also those that the datapath does not ask for at this width."""
    bound = error_bound(width, result)
    assert bound < AIM
    assert np.abs(errors(angles(width)[::7], width, result)).max() <= bound


@pytest.mark.parametrize("width", WIDTHS)
def test_exact_where_the_angle_is(width):
    one = 1 << frac(width)
    phi = np.array([0, -(1 << width - 1)])
    sin, cos = half_sincos(phi, width, frac(width))
    assert sin.tolist() == [0, -one]
    assert cos.tolist() == [one, 0]


@pytest.mark.parametrize("width", WIDTHS)
def test_symmetry_and_range(width):
    phi = angles(width)
    phi = phi[phi > -(1 << width - 1)]
    one = 1 << frac(width)
    sin, cos = half_sincos(phi, width, frac(width))
    sin_back, cos_back = half_sincos(-phi, width, frac(width))
    assert (sin_back == -sin).all(), "sine is not odd"
    assert (cos_back == cos).all(), "cosine is not even"
    assert abs(sin).max() <= one
    assert 0 < cos.min()
    assert cos.max() == one
    assert ((phi > 0) <= (sin > 0)).all()


@pytest.mark.parametrize("width", WIDTHS)
def test_sum_of_squares(width):
    """sin^2 + cos^2 = 1 within what errors e in both allow: 2 e (|sin| + |cos|) + 2 e^2 <= 2 sqrt(2) e + 2 e^2."""
    one = 1 << frac(width)
    e = error_bound(width, frac(width))
    sin, cos = half_sincos(angles(width), width, frac(width))
    off = abs(sin * sin + cos * cos - one * one).max()
    assert off <= 2 * np.sqrt(2.0) * e * one + 2 * e * e


@pytest.mark.parametrize("width", [16, 18])
def test_continuous(width):
    """From angle to angle no more than the arc between them and the errors of both; sine never falls."""
    phi = np.arange(-(1 << width - 1), 1 << width - 1)
    limit = np.pi * 2.0 ** (frac(width) - width) + 2 * error_bound(width, frac(width))
    for values in half_sincos(phi, width, frac(width)):
        assert abs(np.diff(values)).max() <= limit
    assert (np.diff(half_sincos(phi, width, frac(width))[0]) >= 0).all()


@pytest.mark.parametrize("width", WIDTHS)
def test_words_fit_the_rtl(width):
    """v fits its F - 3 bits, at both ends and where the tables and the rounding could lift it over."""
    cut = width - 10
    fine = np.arange(-(1 << cut - 1), 1 << cut - 1) << (32 - width)
    v = fine_sine(fine, frac(width))
    assert v.min() >= -(1 << frac(width) - 4)
    assert v.max() < 1 << frac(width) - 4


def test_table_is_the_sine():
    """The checked-in header holds the sine, by floats: within half of its last place."""
    text = (Path(__file__).parents[3] / "rtl" / "cores" / "ik_trig_table.vh").read_text()
    for i, value in enumerate(lean_trig.sine_table()):
        assert abs(value - np.sin(np.longdouble(i) * PI / (2 * POINTS)) * 2.0**TABLE_FRAC) <= 0.5 + 1e-6
        assert f"sine_table[{i}] = {TABLE_FRAC}'h{value:09x};" in text


def test_small_tables_fit_their_multiplier_and_words():
    assert 0 < lean_trig.complement() < 1 << 17
    assert lean_trig.sine_table()[-1] < 1 << TABLE_FRAC
    low = lean_trig.low_table()
    assert low[0] == 0 and low[-1] < 1 << TABLE_FRAC - 30 + lean_trig.LOW_BITS  # beside the tile's bits, not into them

# SPDX-License-Identifier: Apache-2.0
"""Lean arithmetic modules against their definitions; the proof for the reciprocal square root against measurements."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from model.dataflow import cores as lean_cores
from model.dataflow import quadratic as quadratic_of
from model.dataflow.cores import (
    LONG,
    SHORT,
    SHORT_FRAC,
    SMALL,
    SMALL_FRAC,
    TILE,
    cuts,
    even,
    form_of,
    mul3,
    mul3_error,
    place,
    places,
    quadratic,
    root,
    rounding,
    row_error,
    rsqrt,
    rsqrt_error,
    rsqrt_error_bound,
    rsqrt_rows,
    segment,
    unseen,
)

# ---- product of three tiles ------------------------------------------------------------------------------------------


def signed(width: int):
    return st.integers(-(1 << width - 1), (1 << width - 1) - 1)


@st.composite
def factors(draw):
    """Draw factors, their widths, and a shift that keeps both low parts below the two extra bits."""
    widths = draw(st.integers(3, 35)), draw(st.integers(3, 35))
    tile = draw(st.sampled_from([TILE, 25, 16, 5]))
    least = 2 + max(map(sum, zip(cuts(*widths, tile), reversed(unseen(*widths, tile)), strict=True)))
    shift = draw(st.integers(least, max(least, 36)))
    return *(draw(signed(width)) for width in widths), shift, *widths, tile


@given(factors())
@example((-1, -1, 31, 33, 35, TILE))
@example((-(1 << 32), -(1 << 32), 30, 33, 33, TILE))
@example(((1 << 33) - 1, -(1 << 34), 33, 34, 35, TILE))
@example(((1 << 32) - 1, (1 << 33) - 1, 31, 33, 34, TILE))
@example((-1, (1 << 21) - 1, 20, 22, 22, TILE))
@example((-(1 << 24), (1 << 24) - 1, 23, 25, 25, 25))
def test_mul3_is_three_tiles_cut_off_two_bits_below_the_last_place(case):
    """The fourth tile is estimated where there is room below the highest."""
    a, b, shift, *widths = case  # widths and tile
    (a_one, b_one), place = (1 << cut for cut in cuts(*widths)), 1 << shift
    exact = a * b
    a, b = (word >> bits << bits for word, bits in zip((a, b), unseen(*widths), strict=True))
    a_lo, b_lo = a % a_one, b % b_one
    a_hi, b_hi = a - a_lo, b - b_lo
    quarters = [4 * tile // place for tile in (a_hi * b_hi, a_hi * b_lo, a_lo * b_hi)]
    if 4 * a_one * b_one > place:
        quarters.append(4 * a_one * b_one * (4 * a_lo // a_one) * (4 * b_lo // b_one) // (16 * place))
    expected = (sum(quarters) + 2) // 4
    assert mul3(a, b, shift, *widths) == expected
    assert mul3(np.array([a]), np.array([b]), shift, *widths).tolist() == [expected]
    least, greatest = mul3_error(shift, *widths)
    assert Fraction(least) < expected - Fraction(exact, place) <= Fraction(greatest)


# ---- normalization by an even shift ----------------------------------------------------------------------------------


def normalized(v: int, width: int, bits: int) -> tuple[int, int]:
    """Return the number of pairs by which v can be shifted left and still fits, and the shifted v, truncated."""
    k = max(k for k in range(width // 2) if v << 2 * k < 1 << width)
    return k, (Fraction(v << 2 * k, 1 << width) * (1 << bits)).__floor__()


@given(st.integers(1, 32), st.integers(1, 50), st.data())
def test_even_is_its_definition(pairs, bits, data):
    width = 2 * pairs
    v = data.draw(st.integers(0, (1 << width) - 1))
    for kind in (object, np.int64) if width < 64 else (object,):
        k, m = even(np.array([v], dtype=kind), width, bits)
        assert (int(k[0]), int(m[0])) == normalized(v, width, bits)
        assert k.dtype == m.dtype == np.int64
    if v and bits >= 2:
        assert 1 << bits <= 4 * int(m[0]) < 4 << bits


# ---- reciprocal square root ------------------------------------------------------------------------------------------

FRACS = {SHORT: range(19, SHORT_FRAC + 1), LONG: range(SHORT_FRAC + 1, 32), SMALL: range(19, SMALL_FRAC + 1)}
FORMS = list(FRACS)
IDS = ["short", "long", "small"]
SMALL_TILE = 16
TILES = [(frac, TILE) for frac in range(19, 32)] + [(frac, SMALL_TILE) for frac in FRACS[SMALL]]


@pytest.mark.parametrize("frac", [19, 20, 21, pytest.param(22, marks=[pytest.mark.slow, pytest.mark.cost(8)])])
def test_rsqrt_of_every_mantissa_is_faithful(frac):
    """Check y - 1 < 1/(2 sqrt V) < y + 1 in ulps, for V from m to just below m + 1: squared, in integers.

    (y +- 1)^2 m is compared with 2^(3 frac + 1) by their difference modulo 2^64.  It equals the true difference,
    because double precision shows that to be small.
    """
    bits = frac + 3
    square = 2 ** (3 * frac + 1) % 2**64
    low, high = np.inf, -np.inf
    for start in range(1 << bits - 2, 1 << bits, 1 << bits - 2):
        m = np.arange(start, start + (1 << bits - 2))
        y = rsqrt(m, frac)
        assert y.min() >= 1 << frac - 1 and y.max() <= 1 << frac
        for side, at in ((1, m), (-1, m + 1)):
            near = (y + side).astype(np.float64) ** 2 * at / 2.0 ** (3 * frac + 1)
            assert np.abs(near - 1).max() < 2**-10
            beside = (y + side) ** 2 * at - square
            assert (beside > 0).all() if side > 0 else (beside <= 0).all()
        root = 2.0**frac / 2 / np.sqrt(np.stack([m, m + 1]) / 2.0**bits)
        low, high = min(low, (y - root[0]).min()), max(high, (y - root[1]).max())
    proved = rsqrt_error(frac)
    assert proved.low < low < -0.5 and 0.5 < high < proved.high


@pytest.mark.parametrize(("frac", "tile"), TILES)
def test_rsqrt_is_proved_faithful(frac, tile):
    """All results but the longest word of the small form are faithful."""
    assert (places(frac, tile) == 1) == ((frac, tile) != (SMALL_FRAC, SMALL_TILE))
    assert rsqrt_error_bound(frac, tile) < places(frac, tile)
    # Rounding costs 5/8 and 3/8 ulp, truncating m up to a quarter: a bound below that is wrong.
    assert rsqrt_error(frac, tile).low < -0.625 and rsqrt_error(frac, tile).high > 0.625


def mantissas(frac: int) -> np.ndarray:
    """Return a million mantissas: random, at and next to the segments' ends and middles, the first and the last."""
    bits = frac + 3
    first, last = 1 << bits - 2, 1 << bits
    rng = np.random.default_rng(frac)
    places = np.arange(first, last, 1 << bits - 12)  # ends and middles
    near = (places[:, None] + np.arange(-50, 50)).ravel()
    every = np.concatenate(
        [rng.integers(first, last, 900_000), near, np.arange(first, first + 50_000), np.arange(last - 50_000, last)]
    )
    return every[(every >= first) & (every < last)]


@pytest.mark.parametrize("form", FORMS, ids=IDS)
def test_table_fits_its_words(form):
    rows = rsqrt_rows(form)
    assert len(rows) == form.rows
    for c0, *rest in rows:
        # With the largest rounding constant, c0 stays below 1, and its MSB is 1.
        most = c0 + (rounding(form, min(FRACS[form])) >> form.sum_frac - form.c_frac[0])
        assert c0 >> form.c_frac[0] - 1 == most >> form.c_frac[0] - 1 == 1
        assert form.c_bits[0] == form.c_frac[0] - 1
        assert all(0 < word < 1 << bits for word, bits in zip(rest, form.c_bits[1:], strict=True))
    # No slope exceeds the first one at its left end.
    _, c1, *c2 = rows[0]
    _, width = segment(form, 0)
    bend = c2[0] * width / 2 / 2 ** form.c_frac[2] if c2 else 0
    assert c1 / 2 ** form.c_frac[1] + bend < 2 ** (form.c_bits[1] - form.c_frac[1])


@pytest.mark.parametrize(("frac", "tile"), [(21, TILE), (31, TILE), (29, SMALL_TILE)])
def test_place_is_the_distance_from_the_segments_middle(frac, tile):
    form = form_of(frac, tile)
    m = mantissas(frac)
    row, u = place(form, m, frac)
    left, width = np.array([tuple(map(float, segment(form, row))) for row in range(form.rows)]).T
    assert (left[row] + width[row] / 2 + u / 2.0**form.u_frac == m / 2.0 ** (frac + 3)).all()
    assert (np.abs(u + 0.5) / 2.0**form.u_frac < width[row] / 2).all()
    assert set(row.tolist()) == set(range(form.rows))


@pytest.mark.parametrize(("frac", "tile"), [(21, TILE), (31, TILE), (29, SMALL_TILE)])
def test_parts_of_the_proof(frac, tile):
    """Per segment: the largest interpolation error is close to its bound; the polynomial is within its own."""
    form = form_of(frac, tile)
    rng = np.random.default_rng(3)
    with mpmath.workdps(100):
        for row in range(form.rows):
            left, width = segment(form, row)
            c = quadratic_of.interpolant(form, root, (left, width))
            ends = [width * k / 4 for k in (-2, -1, 0, 1, 2)]
            off = [sum(c[k] * u**k for k in range(len(c))) - root(left + width / 2 + u) for u in ends]
            derivative = lean_cores._derivative(form, row)
            most = quadratic_of.interpolation_error(form, (left, width), derivative)
            assert 0.95 < max(map(abs, off)) / most <= 1, f"row {row}"
            bound = row_error(form, row)
            first, last = (int((left + part) * 2 ** (frac + 3)) for part in (0, width))
            inside = np.arange(64)
            m = np.concatenate([rng.integers(first, last, 1000), first + inside, last - 1 - inside])
            assert (place(form, m, frac)[0] == row).all()
            off = quadratic(form, m, frac) / 2.0**form.sum_frac - 0.5 / np.sqrt(m / 2.0 ** (frac + 3))
            assert bound.low < off.min() and off.max() < bound.high, f"row {row}: {off.min()} to {off.max()}"

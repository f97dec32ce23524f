# SPDX-License-Identifier: Apache-2.0
"""Reciprocal root, sine and cosine from tables: words, results against measurements, parts of the proved errors."""

import mpmath
import numpy as np
import pytest

from model.dataflow.nodes import inner_frac
from model.dataflow.operations import TILE
from model.dataflow.quadratic import (
    INVERSE_ROOT,
    SINE,
    SINE_FRACS,
    SMALL_FRAC,
    half_sincos,
    half_sincos_error,
    interpolant,
    interpolation_error,
    place,
    root_sum,
    rounding,
    row_error,
    rsqrt_error,
    rsqrt_places,
    table_rows,
)

SMALL_TILE = 16
PI = np.longdouble("3.14159265358979323846264338")

every_form = pytest.mark.parametrize("size", ["short", "long", "small"])
every_table = pytest.mark.parametrize("table", [INVERSE_ROOT, SINE], ids=["root", "sine"])

# ---- both tables -----------------------------------------------------------------------------------------------------


@every_form
@every_table
def test_largest_interpolation_error_is_close_to_its_bound(table, size):
    """In segments of nearly constant derivative."""
    form = getattr(table, size)
    some = range(form.rows) if table is INVERSE_ROOT else range(form.rows // 10, form.rows - form.rows // 10, 7)
    with mpmath.workdps(100):
        for row in some:
            left, width = table.segment(form, row)
            c = interpolant(form, table.function, (left, width))
            ends = [width * k / 4 for k in (-2, -1, 0, 1, 2)]
            off = [sum(c[k] * u**k for k in range(len(c))) - table.function(left + width / 2 + u) for u in ends]
            assert 0.95 < max(map(abs, off)) / interpolation_error(table, form, (left, width)) <= 1, f"row {row}"


@every_form
@every_table
def test_words_of_a_table_are_its_function_and_fit(table, size):
    """Each segment's middle matches floats; the words fit, c0 plus the largest rounding constant as well."""
    form = getattr(table, size)
    rows = np.array(table_rows(table, form), dtype=np.int64)
    assert len(rows) == form.rows
    if table is SINE:
        middle = np.sin((np.arange(form.rows, dtype=np.longdouble) + 0.5) / form.rows * PI / 2)
        # at its middle, a linear form lies half of the bend above the chord through its nodes
        bend = (PI / 2 / form.rows) ** 2 / 16 if form.linear else 0
        # within half an ulp, plus the effect on c0 of rounding c2
        off = 2.0 ** -form.c_frac[0] / 2 + sum(2.0**-frac / 16 / form.rows**2 for frac in form.c_frac[2:])
        assert abs(rows[:, 0] / np.longdouble(2) ** form.c_frac[0] - middle * (1 - bend)).max() < 1.01 * off
    frac = {"short": 19, "long": table.short_frac + 1, "small": 19}[size]  # the smallest has the largest constant
    spare = form.sum_frac - form.c_frac[0]
    added = (rounding(form, frac) if table is INVERSE_ROOT else 1 << form.sum_frac - frac - 1) >> spare
    c0, rest = rows[:, 0], rows[:, 1:].T
    assert all(
        (0 < column).all() and column.max() < 1 << bits for column, bits in zip(rest, form.c_bits[1:], strict=True)
    )
    if table is SINE:
        assert 0 < c0.min() and c0.max() + added < 1 << form.c_bits[0]
        return
    # c0 stays below 1, and its MSB, which is not stored, is 1
    assert form.c_bits[0] == form.c_frac[0] - 1
    assert set(c0 >> form.c_bits[0]) == set(c0 + added >> form.c_bits[0]) == {1}
    # No slope exceeds the first one at its left end.
    _, width = table.segment(form, 0)
    bend = rest[1][0] * width / 2 / 2 ** form.c_frac[2] if len(rest) > 1 else 0
    assert rest[0][0] / 2 ** form.c_frac[1] + bend < 2 ** (form.c_bits[1] - form.c_frac[1])


# ---- reciprocal square root ------------------------------------------------------------------------------------------

ROOTS = [(frac, TILE) for frac in range(19, 32)] + [(frac, SMALL_TILE) for frac in range(19, SMALL_FRAC + 1)]


@pytest.mark.parametrize(("frac", "tile"), ROOTS)
def test_rsqrt_is_proved_faithful(frac, tile):
    """All results but the longest word of the small form are; tb/units/exhaustive.cpp checks every mantissa."""
    assert (rsqrt_places(frac, tile) == 1) == ((frac, tile) != (SMALL_FRAC, SMALL_TILE))
    assert rsqrt_error(frac, tile).size < rsqrt_places(frac, tile)
    # Rounding costs 5/8 and 3/8 ulp, truncating m up to a quarter: a bound below that is wrong.
    assert rsqrt_error(frac, tile).low < -0.625 and rsqrt_error(frac, tile).high > 0.625


@pytest.mark.parametrize(("frac", "tile"), [(21, TILE), (31, TILE), (SMALL_FRAC, SMALL_TILE)])
def test_each_segment_of_the_root_keeps_its_bound(frac, tile):
    """u is the distance from the segment's middle; the polynomial is within the proved range of each row."""
    form, rng = INVERSE_ROOT.form(frac, tile), np.random.default_rng(3)
    inside = np.arange(64)
    for row in range(form.rows):
        left, width = INVERSE_ROOT.segment(form, row)
        first, last = (int((left + part) * 2 ** (frac + 3)) for part in (0, width))
        m = np.concatenate([rng.integers(first, last, 1000), first + inside, last - 1 - inside])
        found, u = place(form, m, frac)
        assert (found == row).all()
        assert (float(left + width / 2) + u / 2.0**form.u_frac == m / 2.0 ** (frac + 3)).all()
        assert (np.abs(u + 0.5) / 2.0**form.u_frac < float(width) / 2).all()
        off = root_sum(form, m, frac) / 2.0**form.sum_frac - 0.5 / np.sqrt(m / 2.0 ** (frac + 3))
        bound = row_error(INVERSE_ROOT, form, row, rises=False)
        assert bound.low < off.min() and off.max() < bound.high, f"row {row}: {off.min()} to {off.max()}"


# ---- sine and cosine -------------------------------------------------------------------------------------------------

AIM = 0.95
"""Upper limit of the proved bound, in ulps."""

RANDOM = 200_000


def angles(width: int) -> np.ndarray:
    """Return all angles at short words; otherwise random ones, and those around ends and middles of segments."""
    low, high = -(1 << width - 1), (1 << width - 1) - 1
    if width <= 18:
        return np.arange(low, high + 1)
    step = 1 << width - 11
    points = np.arange(-SINE.long.rows, SINE.long.rows + 1)[:, None] * step
    near = (points + np.concatenate([np.arange(-9, 10), np.arange(-9, 10) + step // 2])).ravel()
    anywhere = np.random.default_rng(width).integers(low, high, RANDOM, endpoint=True)
    return np.concatenate([near[(near >= low) & (near <= high)], anywhere])


@pytest.mark.parametrize(
    ("width", "tile"), [*((width, TILE) for width in (16, 18, 19, 27, 32)), (16, SMALL_TILE), (24, SMALL_TILE)]
)
def test_sine_and_cosine(width, tile):
    """Errors stay below the proved bound; symmetry, range, and the exact values at 0 and at half a turn."""
    frac = min(inner_frac(width), SINE_FRACS[-1])
    phi, one, bound = angles(width), 1 << frac, half_sincos_error(frac, tile)
    assert bound < AIM
    sin, cos = half_sincos(phi, width, frac, tile)
    half = phi.astype(np.longdouble) * PI / 2**width
    for name, word, true in (("sin", sin, np.sin(half)), ("cos", cos, np.cos(half))):
        worst = float(abs(word - true * one).max())
        # a bound far above all measured errors would be wrong
        assert 0.5 < worst <= bound, f"{name} is off by {worst} ulps, bound {bound}"
    assert [v.tolist() for v in half_sincos(np.array([0, -(1 << width - 1)]), width, frac, tile)] == [
        [0, -one],
        [one, 0],
    ]
    back = half_sincos(-phi, width, frac, tile)
    assert (back[0] == -sin).all() and (back[1] == cos).all(), "sine is not odd or cosine not even"
    assert abs(sin).max() <= one and cos.max() == one
    assert (cos[phi > -(1 << width - 1)] > 0).all() and ((phi > 0) <= (sin > 0)).all()

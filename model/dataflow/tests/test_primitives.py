# SPDX-License-Identifier: Apache-2.0
"""Test primitives of the bit-true model against fractions and unlimited integers, which model and RTL do not use. Test
words, error bounds and symmetry of the tables (reciprocal root, sine, cosine) and of the vectoring CORDIC.

model/bounds/tests/test_figures.py compares the tables' measured errors with proved bounds.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from model.dataflow import angles, quadratic
from model.dataflow.expressions import round_shift, wrap
from model.dataflow.formats import inner_frac
from model.dataflow.mul3 import TILE, cuts, mul3, mul3_error, unseen
from model.dataflow.paper_operations import floor_root
from model.dataflow.quadratic import INVERSE_ROOT, SINE, SINE_FRACS, SMALL_FRAC

ROOT_LIMIT = 1 << 63  # upper bound of floor_root's arguments; none in the datapath reaches 2^62


def signed(width: int):
    return st.integers(-(1 << width - 1), (1 << width - 1) - 1)


ROOTS = st.integers(1, math.isqrt(ROOT_LIMIT))
NEAR_SQUARES = st.builds(lambda root, off: (root**2 + off, 0), ROOTS, st.integers(-1, 1))
"""(n, 0) with n at most 1 from a square; the square may have more bits than the mantissa of a double."""


@given(st.one_of(st.tuples(signed(33), st.integers(0, 29)), NEAR_SQUARES))
@example((0, 0))
@example((-1, 29))
@example((-(1 << 32), 29))
@example(((1 << 32) - 1, 29))
@example((math.isqrt(ROOT_LIMIT) ** 2 + 1, 0))
@example(((1 << 62) - 1, 0))
@example((((1 << 31) - 1) ** 2 - 1, 0))
def test_floor_root_is_isqrt(operands):
    n, shift = operands
    assert int(floor_root(np.array([n]), shift)[0]) == (math.isqrt(n << shift) if n > 0 else 0)


@st.composite
def factors(draw):
    """Draw two factors, a shift so large that the mixed products reach the sum's LSB, both widths and a tile."""
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
def test_mul3_is_within_its_error(case):
    a, b, shift, *widths = case  # widths: of a, of b, of a tile
    least, greatest = mul3_error(shift, *widths)
    assert Fraction(least) < mul3(a, b, shift, *widths) - Fraction(a * b, 1 << shift) <= Fraction(greatest)


# ---- tables and vectoring CORDIC ------------------------------------------------------------------------------------

SMALL_TILE = 16


@pytest.mark.parametrize("size", ["short", "long", "small"])
@pytest.mark.parametrize("table", [INVERSE_ROOT, SINE], ids=["root", "sine"])
def test_words_of_a_table_fit(table, size):
    """Check that all coefficients fit their widths, c0 also after the largest rounding constant is added."""
    form = getattr(table, size)
    c0, *rest = quadratic.columns(table, form)
    frac = {"short": 19, "long": table.short_frac + 1, "small": 19}[size]  # the fewest bits have the largest constant
    constant = quadratic.rounding(form, frac) if table is INVERSE_ROOT else 1 << form.sum_frac - frac - 1
    added = constant >> form.sum_frac - form.c_frac[0]
    for column, bits in zip(rest, form.c_bits[1:], strict=True):
        assert (0 < column).all() and column.max() < 1 << bits
    if table is SINE:
        assert 0 < c0.min() and c0.max() + added < 1 << form.c_bits[0]
        return
    # c0 stays below 1, and its MSB, which is not stored, is 1
    assert form.c_bits[0] == form.c_frac[0] - 1
    assert set(c0 >> form.c_bits[0]) == set(c0 + added >> form.c_bits[0]) == {1}
    # The largest slope, at the left end of the first segment, fits.
    _, width = table.segment(form, 0)
    bend = rest[1][0] * width / 2 / 2 ** form.c_frac[2] if len(rest) > 1 else 0
    assert rest[0][0] / 2 ** form.c_frac[1] + bend < 2 ** (form.c_bits[1] - form.c_frac[1])


@pytest.mark.parametrize(("frac", "tile"), [(21, TILE), (31, TILE), (SMALL_FRAC, SMALL_TILE)])
def test_each_segment_of_the_root_keeps_its_bound(frac, tile):
    form, rng = INVERSE_ROOT.form(frac, tile), np.random.default_rng(3)
    inside = np.arange(64)
    for row in range(form.rows):
        left, width = INVERSE_ROOT.segment(form, row)
        first, last = (int((left + part) * 2 ** (frac + 3)) for part in (0, width))
        m = np.concatenate([rng.integers(first, last, 1000), first + inside, last - 1 - inside])
        off = quadratic.root_sum(form, m, frac) / 2.0**form.sum_frac - 0.5 / np.sqrt(m / 2.0 ** (frac + 3))
        low, high = quadratic.row_error(INVERSE_ROOT, form, row, rises=False)
        assert low < off.min() and off.max() < high, f"row {row}: {off.min()} to {off.max()}"


@pytest.mark.parametrize(
    ("width", "tile"), [*((width, TILE) for width in (16, 18, 19, 27, 32)), (16, SMALL_TILE), (24, SMALL_TILE)]
)
def test_sine_is_odd_and_cosine_even(width, tile):
    """Check the symmetry, that neither function exceeds 1, and that both are exact at 0 and at half a turn."""
    frac, half_turn = min(inner_frac(width), SINE_FRACS[-1]), 1 << width - 1
    phi, one = np.linspace(-half_turn, half_turn - 1, 1 << 18).astype(np.int64), 1 << frac
    sin, cos = quadratic.half_sincos(phi, width, frac, tile)
    back = quadratic.half_sincos(-phi, width, frac, tile)
    assert (back[0] == -sin).all() and (back[1] == cos).all()
    exact = quadratic.half_sincos(np.array([0, -half_turn]), width, frac, tile)
    assert [values.tolist() for values in exact] == [[0, -one], [one, 0]]
    assert abs(sin).max() <= one and cos.max() <= one
    assert (cos[phi > -half_turn] > 0).all() and ((phi > 0) <= (sin > 0)).all()


SHORT = (8, 9, 10)  # word lengths whose vectors are all tested


def vectors(width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vectors no longer than LONGEST: all such vectors for a word length in SHORT, else up to 400000 random ones
    of any length, often near an axis."""
    half = 1 << width - 1
    if width in SHORT:
        x, y = np.mgrid[-half:half, -half:half].reshape(2, -1)
    else:
        rng = np.random.default_rng(width)
        length = 2.0 ** rng.uniform(1 - width, 1.2, 400000)
        turn = rng.choice([1, 10 ** rng.uniform(-9, 0)], 400000) * rng.uniform(-1, 1, 400000) * np.pi / 4
        turn += rng.integers(0, 4, 400000) * np.pi / 2
        x, y = np.rint(length * (np.cos(turn), np.sin(turn)) * 2 ** (width - 2)).astype(np.int64)
    fits = (np.hypot(x, y) <= angles.LONGEST * 2 ** (width - 2)) & (np.maximum(np.abs(x), np.abs(y)) < half)
    return x[fits], y[fits]


def turned_exactly(x, y, width):
    """Return (1) the vectors as complex numbers in the right half plane, in LSBs of X; (2) nearby vectors for which M
    iterations without rounding (:mod:`model.dataflow.angles`) give their X and Y; (3) sums of the angle words (rad)."""
    x, y, real = x << angles.GUARD, y << angles.GUARD, np.longdouble
    given = np.where(x < 0, -1, 1) * (x.astype(real) + 1j * y.astype(real))
    x, y, head = np.where(x < 0, ~x, x), np.where(x < 0, -y, y), angles.iterations(width)[0]
    turned, words, near = np.zeros(x.shape, real), np.zeros(x.shape, real), 0
    for i, word in enumerate(angles.table(width)):
        sign, ratio = np.where(y < 0, -1, 1), real(2) ** -i
        x, y = x + (angles.magnitude(y) >> 2 * i if i < head else 0), 2 * (y - sign * x)
        turned, words = turned + sign * np.arctan2(ratio, real(1)), words + sign * word
        if i == head - 1:
            near = (x + 1j * y * ratio / 2) * np.exp(1j * turned) / angles.gain(width)
    return given, near, words * np.arctan2(real(0), -real(1)) / real(2) ** (width + 3)


@pytest.mark.parametrize("width", (*SHORT, 18, 24, 32))
def test_angle_and_length_are_within_their_bounds(width):
    x, y = vectors(width)
    given, near, words = turned_exactly(x, y, width)
    moved = (near - given) * given.conj() / np.maximum(np.abs(given), 1)
    errors = {"along": moved.real, "across": moved.imag, "lost": np.angle(near * given.conj())}
    errors["rest"] = np.angle(near * np.exp(-1j * words))
    assert moved.real.max() < 1e-4
    long, angle = angles.vector(x, y, width)
    length = np.hypot(x, y) / 2 ** (width - 2)
    turns = (angle / 2 ** (width + angles.ANGLE) - np.arctan2(y, x) / (2 * np.pi) + 0.5) % 1 - 0.5
    off = np.where(length > 0, np.abs(turns) * 2 * np.pi, 0)
    short = angles.gain(width) * length * 2 ** (width + 1) - long
    for least in (1, 2**-2, 2**-4, 2.0 ** -(width // 2), 2.0 ** (3 - width), 2.0 ** (2 - width)):
        part, limit = (length >= least) & (length <= 2 * least), angles.head(width, least)
        lengths = "length", short[part], angles.length_bound(width, 2 * least)
        for what, found, bound in (("angle", off[part], float((limit.lost + limit.rest).b)), lengths):
            text = f"{what}, W = {width}, length {least:.2g}: error {found.max():.3g}, bound {bound:.3g}"
            print(text)
            assert found.max() <= bound, text
            assert found.min() >= -1e-5, f"{what}, W = {width}: too long"
        for what, found in errors.items():
            most = np.abs(found[part & (x != 0) & (y != 0)]).max(initial=0)
            assert most <= float(getattr(limit, what).b) * (1 + 1e-6), f"{what}, length {least:.2g}"


@pytest.mark.parametrize("width", (*SHORT, 18, 24, 32))
def test_longest_vector_keeps_every_bit(width):
    """Check that vectors of length LONGEST lose no bit, although not all fit words, and that twice as long ones do."""
    turn = np.linspace(-np.pi, np.pi, 20001)

    def off(length):
        x, y = np.rint(length * 2 ** (width + 1) * np.array([np.cos(turn), np.sin(turn)])).astype(np.int64)
        _, angle = angles.iterate(x, y, width)
        return np.abs((angle / 2 ** (width + angles.ANGLE) - np.arctan2(y, x) / (2 * np.pi) + 0.5) % 1 - 0.5).max()

    limit = angles.head(width, 1)
    assert off(angles.LONGEST) * 2 * np.pi < float((limit.lost + limit.rest).b)
    assert off(2 * angles.LONGEST) > 0.01


def test_small_angles_keep_their_sign():
    """Check that no angle of a straight arm or of a hand along an axis is rounded to below 0: a limit may be 0."""
    for width in range(8, 33):
        one, what = 1 << width - 2, f"W = {width}"
        x, y = np.meshgrid([one - 1, one, one + 2], np.arange(min(400, one)))
        length, angle = angles.vector(x, y, width)
        assert round_shift(angle, angles.ANGLE).min() == 0 and not angle[0].any(), what
        assert set(angles.vector(-x, -y, width)[1][0].tolist()) == {-(1 << width + angles.ANGLE - 1)}, what
        twice = wrap(round_shift(2 * angle, angles.ANGLE), width)
        tilt = angles.iterate(length[0], angles.vector(0 * y, y, width)[0][:, :1], width)[1]
        assert twice.min() == round_shift(2 * tilt, angles.ANGLE).min() == 0 and not tilt[0].any(), what
        assert angles.vector(np.zeros(1, int), np.zeros(1, int), width)[1] == 0, what

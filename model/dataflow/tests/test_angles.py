# SPDX-License-Identifier: Apache-2.0
"""Angles and lengths of the vectoring CORDIC against their exact values and error bounds."""

import mpmath
import numpy as np
import pytest

from model.dataflow import angles
from model.dataflow.operations import round_shift, wrap

SHORT = (8, 9, 10)  # word lengths whose vectors are all tested


def vectors(width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vectors up to LONGEST: all of a short word length, else 400000 of any magnitude, many near an axis."""
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


@pytest.mark.parametrize("width", (*SHORT, 18, 24, 32))
def test_angle_and_length_are_within_their_bounds(width):
    x, y = vectors(width)
    long, angle = angles.vector(x, y, width)
    length = np.hypot(x, y) / 2 ** (width - 2)
    turns = (angle / 2 ** (width + angles.ANGLE) - np.arctan2(y, x) / (2 * np.pi) + 0.5) % 1 - 0.5
    off = np.where(length > 0, np.abs(turns) * 2 * np.pi, 0)
    short = angles.gain(width) * length * 2 ** (width + 1) - long
    for least in (1, 2**-2, 2**-4, 2.0 ** -(width // 2), 2.0 ** (3 - width), 2.0 ** (2 - width)):
        part = (length >= least) & (length <= 2 * least)
        for what, found, bound in (
            ("angle", off[part], angles.error_bound(width, least)),
            ("length", short[part], angles.length_bound(width, 2 * least)),
        ):
            text = f"{what}, W = {width}, length {least:.2g}: error {found.max():.3g}, bound {bound:.3g}"
            print(text)
            assert found.max() <= bound, text
            assert found.min() >= -1e-5, f"{what}, W = {width}: too long"


@pytest.mark.parametrize("width", (*SHORT, 18, 24, 32))
def test_longest_vector_keeps_every_bit(width):
    """Its length exceeds the words', so the guarded words are tested; the next bit of length is too much."""
    turn = np.linspace(-np.pi, np.pi, 20001)

    def off(length):
        x, y = np.rint(length * 2 ** (width + 1) * np.array([np.cos(turn), np.sin(turn)])).astype(np.int64)
        _, angle = angles.iterate(x, y, width)
        return np.abs((angle / 2 ** (width + angles.ANGLE) - np.arctan2(y, x) / (2 * np.pi) + 0.5) % 1 - 0.5).max()

    assert off(angles.LONGEST) * 2 * np.pi < angles.error_bound(width, 1)
    assert off(2 * angles.LONGEST) > 0.01


@pytest.mark.parametrize("width", range(8, 33))
def test_table_is_the_rounded_arc_tangent(width):
    head, last = angles.iterations(width)
    words = angles.table(width)
    assert len(words) == last
    with mpmath.workprec(200):
        exact = [mpmath.atan(mpmath.mpf(2) ** -i) / (2 * mpmath.pi) * 2 ** (width + angles.ANGLE) for i in range(last)]
    assert words[: head + 1] == tuple(int(mpmath.nint(v)) for v in exact[: head + 1])
    assert words[head:] == tuple(words[head] >> i for i in range(last - head))


@pytest.mark.parametrize("width", range(8, 33))
def test_small_angles_keep_their_sign(width):
    """Straight arms and hands along an axis: no rounded angle of theirs is below 0, so that limits hold at 0."""
    one = 1 << width - 2
    x, y = np.meshgrid([one - 1, one, one + 2], np.arange(min(400, one)))
    length, angle = angles.vector(x, y, width)
    assert round_shift(angle, angles.ANGLE).min() == 0 and not angle[0].any()
    assert np.array_equal(angles.vector(-x, -y, width)[1][0], [-(1 << width + angles.ANGLE - 1)] * 3)
    twice = wrap(round_shift(2 * angles.vector(x, y, width)[1], angles.ANGLE), width)
    assert twice.min() == 0
    tilt = angles.iterate(length[0], angles.vector(0 * y, y, width)[0][:, :1], width)[1]
    assert round_shift(2 * tilt, angles.ANGLE).min() == 0 and not tilt[0].any()
    assert angles.vector(np.zeros(1, int), np.zeros(1, int), width)[1] == 0

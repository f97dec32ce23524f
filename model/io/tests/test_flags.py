# SPDX-License-Identifier: Apache-2.0
"""Expected flags, from exact integers."""

import numpy as np
import pytest

from model.io.flags import (
    AT_SHOULDER,
    BAD_LENGTH,
    ON_AXIS,
    TOO_FAR,
    TOO_NEAR,
    expected_flags,
    names,
)
from model.io.stimuli import extremes, mixed

TOP = 2**31 - 1
LOW = -(2**31)


@pytest.mark.parametrize(
    ("target", "flags"),
    [
        ((3, 4, 0, 0, 3, 2), 0),  # |p| = d1 + d2 exactly: reached
        ((3, 4, 1, 0, 3, 2), TOO_FAR),
        ((3, 4, 0, 0, 6, 1), 0),  # |p| = d1 - d2 exactly: reached
        ((3, 4, 0, 0, 7, 1), TOO_NEAR),
        ((3, 4, 0, 0, 1, 7), TOO_NEAR),
        ((0, 0, 5, 77, 3, 3), ON_AXIS),
        ((0, 0, -7, 0, 3, 3), ON_AXIS | TOO_FAR),
        ((0, 1, 0, 0, 3, 3), 0),
        ((1, 0, 0, 0, 3, 3), 0),
        ((0, 0, 0, 0, 3, 3), ON_AXIS | AT_SHOULDER),  # folded fully: the hand is at the shoulder
        ((0, 0, 0, 0, 3, 2), ON_AXIS | AT_SHOULDER | TOO_NEAR),
        ((9, 9, 9, 0, 0, 3), BAD_LENGTH),
        ((9, 9, 9, 0, 3, 0), BAD_LENGTH),
        ((9, 9, 9, 0, -3, -3), BAD_LENGTH),
        ((0, 0, 0, 0, -1, 3), BAD_LENGTH | ON_AXIS | AT_SHOULDER),
        ((TOP, TOP, TOP, 0, TOP, TOP), 0),  # squares whose sum needs 64 bits or more
        ((LOW, LOW, LOW, LOW, TOP, TOP), 0),
        ((LOW, LOW, LOW, 0, TOP, 2**30), TOO_FAR),
    ],
)
def test_expected_flags(target, flags):
    assert names(int(expected_flags(np.array([target]), 32)[0])) == names(flags)


def in_python_integers(x, y, z, phi, d1, d2) -> int:
    """Return the flags of one target, independently of :mod:`model.io.flags`."""
    flags = ON_AXIS * (x == y == 0) | AT_SHOULDER * (x == y == z == 0)
    if d1 <= 0 or d2 <= 0:
        return flags | BAD_LENGTH
    squared = x * x + y * y + z * z
    return flags | TOO_FAR * (squared > (d1 + d2) ** 2) | TOO_NEAR * (squared < (d1 - d2) ** 2)


@pytest.mark.parametrize("width", [16, 31, 32])
def test_arrays_of_64_bits_decide_as_python_integers_do(width):
    words = np.concatenate([mixed(4000, width, seed=1), extremes(4000, width, seed=2)])
    assert expected_flags(words, width).tolist() == [in_python_integers(*row) for row in words.tolist()]


def test_one_ulp_decides_at_full_word_length():
    """The limits are exact: near 2^31, squares in double precision are equal."""
    d1, d2 = 2**30 + 1, 2**30 - 3
    words = np.array([[reach, 0, 0, 0, d1, d2] for reach in (d1 + d2, d1 + d2 + 1, d1 - d2, d1 - d2 - 1)])
    assert expected_flags(words, 32).tolist() == [0, TOO_FAR, 0, TOO_NEAR]
    slanted = np.array([[d1 + d2, 1, 0, 0, d1, d2]])  # further than d1 + d2 by a factor of 1 + 2^-33
    assert expected_flags(slanted, 32).tolist() == [TOO_FAR]


def test_word_length_is_checked():
    with pytest.raises(ValueError, match="16 bits"):
        expected_flags(np.array([[2**15, 0, 0, 0, 1, 1]]), 16)

# SPDX-License-Identifier: Apache-2.0
"""Comparison of the bit-true model with table 6's C program in long double, by both sets of equations."""

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.io.flags import expected_flags
from model.io.scoring import singular_distance
from model.io.words import from_words, result_values
from scripts.paper.table6.compiled import Solver
from tb.core.worst_targets import chunk

UNEQUAL = 2.0**-24
"""Ratio of the lengths below which the paper's equations, which add squares of lengths, lose too many of 64 bits."""


def answers(words: np.ndarray, width: int, equations: str) -> np.ndarray:
    """Solve input words (N, 6) in C; return the results (N, 6)."""
    unit = np.longdouble(2) ** (1 - width)
    scale = np.array([2, 2, 2, 4 * np.arctan(np.longdouble(1)), 2, 2]) * unit
    return Solver(list((words * scale).T), equations, "long double")().astype(float)


@pytest.mark.needs("cc")
@pytest.mark.parametrize("width", [16, 32])
@pytest.mark.parametrize("equations", ["lean", "paper"])
def test_the_model_agrees_with_c(width, equations):
    """Bound the largest difference. Either sign of Qs is accepted, because rounding decides it where k rounds to 0."""
    words = chunk(0, width, 3)
    words = words[expected_flags(words, width) == 0]
    if equations == "paper":
        shorter, longer = np.sort(words[:, 4:].astype(float)).T
        regular = singular_distance(from_words(words, 0, width, "words")) >= tolerances.REGULAR_DISTANCE
        words = words[regular & (shorter >= UNEQUAL * longer)]
    assert len(words) > 3000
    values, expected = result_values(fixed.run(words, width, "lean").results, width), answers(words, width, equations)
    expected[(values[:, :4] * expected[:, :4]).sum(axis=1) < 0, :4] *= -1
    ulp = 2.0 ** (2 - width)
    assert 0.45 * ulp < np.abs(values - expected).max() < min(tolerances.LEAN[width] / 3, 4 * ulp)


@pytest.mark.needs("cc")
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="long double is double here")
def test_a_difference_of_squares_that_needs_64_bits():
    words = np.array([[(1 << 30) - 1, 1, 1, 0, 1 << 29, 1 << 29]])
    x, y, z, _, d1, d2 = map(int, words[0])
    exact = np.sqrt((d1 + d2) ** 2 - (x * x + y * y + z * z)) / 2**30
    assert answers(words, 32, "lean")[0, 4] == pytest.approx(exact, rel=1e-15)

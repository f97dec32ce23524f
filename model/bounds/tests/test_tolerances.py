# SPDX-License-Identifier: Apache-2.0
"""Tolerance table: limits on widening it, and tests that the hardest kinds of targets meet it."""

import itertools

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.stimuli import REGIONS, random_reachable, region
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference.kinematics import forward
from model.reference.lean_equations import solve_lean


def exact(words: np.ndarray, width: int) -> np.ndarray:
    """Return results (N, 6) in double precision of input words (N, 6)."""
    at = from_words(words, 0, width, "words")
    pose = solve_lean(at.x, at.y, at.z, at.phi, at.d1, at.d2)
    return np.stack([pose[name] for name in RESULT_FIELDS], axis=1)


def test_a_shorter_word_never_has_the_smaller_tolerance():
    table = [tolerances.lean(width) for width in WIDTHS]
    assert table == sorted(table, reverse=True)


@pytest.mark.parametrize("width", WIDTHS)
def test_every_word_length_keeps_it(width):
    """The largest error also exceeds an eighth of the tolerance."""
    words = np.concatenate([region(name, 1000, width, 5) for name in REGIONS])
    q, at = result_values(fixed.run(words, width, "lean").results, width), result_values(words, width)
    wrist = forward(q[:, :4], q[:, 4:], at[:, 4], at[:, 5])[1]
    error = np.linalg.norm(wrist - at[:, :3], axis=1) / (at[:, 4] + at[:, 5])
    assert tolerances.lean(width) / 8 < error.max() <= tolerances.lean(width)


@pytest.mark.parametrize("width", WIDTHS)
def test_rounding_of_results_alone(width):
    """Half an ulp to either side of six results: the worst of 64 combinations in many poses, and in the worst pose."""
    words = random_reachable(1000, width, seed=8)
    q = exact(words, width)
    q = np.concatenate([q, [(0.5**0.5, 0, 0.5**0.5, 0, 0, -1)]])
    arms = np.concatenate([words[:, 4:], [(0, 1)]])
    wrist = forward(q[:, :4], q[:, 4:], *arms.T)[1]
    ulp = 2.0 ** (2 - width)
    worst = np.zeros(len(q))
    for signs in itertools.product((-0.5, 0.5), repeat=6):
        rounded = q + ulp * np.array(signs)
        off = np.linalg.norm(forward(rounded[:, :4], rounded[:, 4:], *arms.T)[1] - wrist, axis=1)
        worst = np.maximum(worst, off / arms.sum(axis=1) / ulp)
    assert worst.max() == worst[-1] == pytest.approx(tolerances.ROUNDED_ULPS, rel=8 * ulp + 1e-6)


def test_rounded_results_of_18_bits_miss_the_tolerance():
    """Even exact results, rounded, exceed the tolerance in some pose: :func:`tolerances.sought` allows for that."""
    words = np.array([(123447, 0, -594, -131072, 2008, 121725)])
    at, q = result_values(words, 18), np.rint(exact(words, 18) * 2**16) / 2**16
    error = np.linalg.norm(forward(q[:, :4], q[:, 4:], at[:, 4], at[:, 5])[1] - at[:, :3]) / at[0, 4:].sum()
    assert tolerances.lean(18) < error <= tolerances.sought(18)
    assert tolerances.sought(24) == tolerances.lean(24) and tolerances.sought(32) == tolerances.lean(32)

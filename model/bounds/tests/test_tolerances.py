# SPDX-License-Identifier: Apache-2.0
"""Tolerance table: limits on widening it, and tests that the hardest kinds of targets meet it."""

import itertools

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow.nodes import WIDTHS
from model.dataflow.tests.test_datapaths import Run, ulp
from model.io.stimuli import REGIONS, random_reachable, region
from model.reference.kinematics import forward


def test_a_shorter_word_never_has_the_smaller_tolerance():
    table = [tolerances.lean(width) for width in WIDTHS]
    assert table == sorted(table, reverse=True)


@pytest.mark.parametrize("width", WIDTHS)
def test_every_word_length_keeps_it(width):
    """The largest error also exceeds an eighth of the tolerance."""
    run = Run(np.concatenate([region(name, 1000, width, 5) for name in REGIONS]), width)
    assert tolerances.lean(width) / 8 < run.hand.max() <= tolerances.lean(width)


@pytest.mark.parametrize("width", (16, 24, 32))
def test_rounding_of_results_alone(width):
    """Half an ulp to either side of six results: the worst of 64 combinations in many poses, and in the worst pose."""
    words = random_reachable(1000, width, seed=8)
    q = np.concatenate([Run(words, width).exact, [(0.5**0.5, 0, 0.5**0.5, 0, 0, -1)]])
    arms = np.concatenate([words[:, 4:], [(0, 1)]])
    wrist = forward(q[:, :4], q[:, 4:], *arms.T)[1]
    worst = np.zeros(len(q))
    for signs in itertools.product((-0.5, 0.5), repeat=6):
        rounded = q + ulp(width) * np.array(signs)
        off = np.linalg.norm(forward(rounded[:, :4], rounded[:, 4:], *arms.T)[1] - wrist, axis=1)
        worst = np.maximum(worst, off / arms.sum(axis=1) / ulp(width))
    assert worst.max() == worst[-1] == pytest.approx(tolerances.ROUNDED_ULPS, rel=8 * ulp(width) + 1e-6)


def test_rounded_results_of_18_bits_miss_the_tolerance():
    """Even exact results, rounded, exceed the tolerance in some pose: :func:`tolerances.sought` allows for that."""
    run = Run(np.array([(123447, 0, -594, -131072, 2008, 121725)]), 18)
    (error,) = run.off(np.rint(run.exact * 2**16) / 2**16)[1]
    assert tolerances.lean(18) < error <= tolerances.sought(18)
    assert tolerances.sought(24) == tolerances.lean(24) and tolerances.sought(32) == tolerances.lean(32)

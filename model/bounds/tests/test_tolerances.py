# SPDX-License-Identifier: Apache-2.0
"""The table of tolerances: what it may not be widened to, and that the hardest kinds of targets keep it."""

import itertools

import numpy as np
import pytest

from model.bounds import predict, tolerances
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.stimuli import REGIONS, random_reachable, region
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference.kinematics import forward
from model.reference.lean_equations import solve_lean


def exact(words: np.ndarray, width: int) -> np.ndarray:
    """Results (N, 6) in double precision of input words (N, 6)."""
    at = from_words(words, 0, width, "words")
    pose = solve_lean(at.x, at.y, at.z, at.phi, at.d1, at.d2)
    return np.stack([pose[name] for name in RESULT_FIELDS], axis=1)


def test_the_lean_datapath():
    """A shorter word never has the smaller tolerance."""
    assert {w: tolerances.lean(w) for w in (16, 18, 24, 32)} == {16: 2.05e-4, 18: 5e-5, 24: 1e-6, 32: 2e-8}
    table = [tolerances.lean(width) for width in WIDTHS]
    assert table == sorted(table, reverse=True)
    assert all(tolerances.lean(w) <= max(4.2 * 2.0 ** (2 - w), 2e-8) for w in WIDTHS)
    assert list(tolerances.LEAN) == list(tolerances.LEAN_NORMS) == list(WIDTHS)
    assert all(max(norms) <= 16 for norms in tolerances.LEAN_NORMS.values())


@pytest.mark.parametrize("width", WIDTHS)
def test_every_word_length_keeps_it(width):
    """And uses an eighth of it at least: a tolerance that nothing comes near to says nothing."""
    words = np.concatenate([region(name, 1000, width, 5) for name in REGIONS])
    q, at = result_values(fixed.run(words, width, "lean").results, width), result_values(words, width)
    wrist = forward(q[:, :4], q[:, 4:], at[:, 4], at[:, 5])[1]
    error = np.linalg.norm(wrist - at[:, :3], axis=1) / (at[:, 4] + at[:, 5])
    assert tolerances.lean(width) / 8 < error.max() <= tolerances.lean(width)


@pytest.mark.parametrize("width", WIDTHS)
def test_what_rounding_alone_can_do(width):
    """Half an ulp to either side of six results: the worst of 64 choices in many poses, and in the worst pose."""
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
    """So no core of such results keeps it in every pose: what is sought for its error has a bar of its own."""
    words = np.array([(123447, 0, -594, -131072, 2008, 121725)])
    at, q = result_values(words, 18), np.rint(exact(words, 18) * 2**16) / 2**16
    error = np.linalg.norm(forward(q[:, :4], q[:, 4:], at[:, 4], at[:, 5])[1] - at[:, :3]) / at[0, 4:].sum()
    assert tolerances.lean(18) < error <= tolerances.sought(18)
    assert tolerances.sought(24) == tolerances.lean(24) and tolerances.sought(32) == tolerances.lean(32)


def test_the_paper():
    """A fixed figure for regular trajectories of 32 bits, and nothing elsewhere: a prediction is no tolerance."""
    assert tolerances.hand(32, "paper", regular=True) == 1e-4
    assert tolerances.hand(32, "paper") is None
    assert tolerances.hand(31, "paper", regular=True) is None
    assert tolerances.hand(32, "lean", regular=True) == tolerances.hand(32, "lean") == 2e-8
    assert tolerances.hand(18, "lean25") == tolerances.hand(18, "lean")
    assert tolerances.norm(18, "lean") == tolerances.norm(18, "fold16") == 2.43 / 2**16
    assert tolerances.norm(18, "paper") == 16 / 2**16
    assert tolerances.norm(32, "short") == 2**7 * tolerances.norm(32, "paper") == 2**7 * tolerances.norm(32, "lean")


def test_what_errors_are_ranked_by():
    words = random_reachable(20, 32, seed=3)
    assert (tolerances.yardstick(words, 32, "lean") == 2e-8).all()
    assert (tolerances.yardstick(words, 32, "paper") == predict.hand_bar(words, 32, "paper")).all()

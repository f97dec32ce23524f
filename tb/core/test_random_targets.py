# SPDX-License-Identifier: Apache-2.0
"""Tests of the soak's target chunks."""

import numpy as np
import pytest

from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import SPECIAL, corners, of_special, special
from model.io.words import from_words
from model.reference.equations import solve_clamped
from tb.core.random_targets import chunk


def test_a_chunk_depends_on_its_number_and_seed_only():
    first = chunk(3, 32, 1)
    assert (first == chunk(3, 32, 1)).all() and first.shape == (20000, 6)
    assert not np.array_equal(first, chunk(4, 32, 1)) and not np.array_equal(first, chunk(3, 32, 2))
    assert len(np.unique(first, axis=0)) > 19000


@pytest.mark.parametrize("width", [16, 17, 18, 24, 32])
def test_chunks_at_other_word_lengths(width):
    words = chunk(0, width, 1)
    assert words.shape == (20000, 6)
    assert (words >= -(1 << (width - 1))).all() and (words < 1 << (width - 1)).all()


@pytest.mark.parametrize("width", [16, 32])
def test_special_words_are_all_that_there_are(width):
    """Chunks cover each of the 12^6 combinations once, including the ends of the range, 0, 1 and their neighbours."""
    words = np.concatenate([chunk(n, width, None) for n in range(-(-SPECIAL // 20000))])
    assert len(words) == len(np.unique(words, axis=0)) == 12**6 and len(of_special(SPECIAL, 5, width)) == 0
    assert set(words.ravel().tolist()) == set(special(width)) and len(set(special(width))) == 12
    least, one = -(1 << width - 1), 1 << width - 2
    assert {least, -one, -1, 0, 1, one - 1, one, one + 1, -1 - least} < set(special(width))


def test_a_chunk_has_all_kinds():
    """The first tenth of a chunk, as in a short soak, already has clamped targets, unequal arms and every decade of
    distance to the singular poses; the whole chunk has every corner."""
    whole = chunk(0, 32, 1)
    assert set(corners(32).values()) <= set(map(tuple, whole.tolist()))
    words = whole[:2000]
    flags = expected_flags(words, 32)
    for bit in (1, 2, 4, 8, 16):
        assert (flags & bit).astype(bool).sum() >= 10, bit
    reach = flags & UNREACHABLE == 0
    assert 0.7 < reach.mean() < 0.9
    at = from_words(words[reach], 0, 32, "chunk")
    off_axis = np.arctan2(np.hypot(at.x, at.y), np.abs(at.z))
    distance = np.sqrt(at.x**2 + at.y**2 + at.z**2)
    near = {
        "z axis": off_axis,
        "full stretch": 1 - distance / at.reach,
        "full fold": (distance - np.abs(at.d1 - at.d2)) / at.reach,
        "shoulder": distance / at.reach,
        "arms": np.minimum(at.d1, at.d2) / np.maximum(at.d1, at.d2),
    }
    pose = solve_clamped(at.x, at.y, at.z, at.phi, at.d1, at.d2)
    near["elbow on the z axis"] = np.arctan2(np.hypot(pose["p_e_x"], pose["p_e_y"]), np.abs(pose["p_e_z"]))
    decades = {"z axis": 7, "full stretch": 8, "full fold": 8, "shoulder": 7, "arms": 1, "elbow on the z axis": 7}
    for name, value in near.items():
        for decade in range(1, decades[name] + 1):
            assert (value < 10.0**-decade).sum() >= 5, f"{name}: none below 1e-{decade}"

# SPDX-License-Identifier: Apache-2.0
"""Accuracy by region: errors match their definition, lean meets its tolerances, targets lie in their region."""

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, region
from model.io.words import result_values
from model.reference.kinematics import forward
from scripts.generate.accuracy import Errors

ANGLE = 1e-7
"""Bound of the lean datapath's joint angles at 32 bits (rad)."""


@pytest.mark.slow
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", REGIONS)
def test_lean_is_within_its_tolerances(name, width):
    errors = Errors.of(region(name, 4000, width, 1), width, "lean")
    assert errors.hand.max() <= tolerances.lean(width)
    assert width < 32 or errors.angle < ANGLE


@pytest.mark.parametrize("name", REGIONS)
def test_lean_is_more_accurate_than_paper(name):
    words = region(name, 4000, 32, 1)
    lean, paper = (Errors.of(words, 32, path).hand for path in ("lean", "paper"))
    assert np.median(lean) < np.median(paper) and lean.max() < paper.max()


def test_hand_error_by_its_definition():
    words = region("near the z axis", 5, 24, 3)
    errors = Errors.of(words, 24, "lean")
    value = result_values(fixed.run(words, 24, "lean").results, 24)
    for n, (x, y, z, _, d1, d2) in enumerate(words.tolist()):
        _, wrist = forward(value[n : n + 1, :4], value[n : n + 1, 4:], d1, d2)
        assert errors.hand[n] == pytest.approx(np.linalg.norm(wrist[0] - (x, y, z)) / (d1 + d2), rel=1e-9)


@pytest.mark.parametrize("width", (16, 32))
@pytest.mark.parametrize("name", REGIONS)
def test_regions_are_in_reach_and_where_they_claim(name, width):
    words = region(name, 1000, width, 2)
    assert words.shape == (1000, 6)
    assert not (expected_flags(words, width) & UNREACHABLE).any()
    assert (words == region(name, 1000, width, 2)).all() and (words != region(name, 1000, width, 3)).any()
    x, y, z, _, d1, d2 = words.T.astype(float)
    distance, ratio = np.sqrt(x**2 + y**2 + z**2), np.maximum(d1, d2) / np.minimum(d1, d2)
    lsb = 3 / np.maximum(distance, 1)
    if "the z axis" in name and "elbow" not in name:
        assert (np.hypot(x, y) <= (0.11 + lsb) * np.maximum(np.abs(z), 1) + 1).all()
        assert (z > 0).any() and (z < 0).any()
    if "stretch" in name:
        # Targets of short arms are at least an LSB away.
        assert ((d1 + d2 - distance) / (d1 + d2) <= 0.12 + 3 / (d1 + d2)).all()
    if "fold" in name:
        assert (distance - np.abs(d1 - d2) <= 0.12 * distance + 2).all()
    if name == "unequal arms":
        big = np.minimum(d1, d2) > 20
        assert (ratio[big] > 4.7).all() and (ratio[big] < 21).all()
    if name == "most unequal arms":
        assert ratio.max() > 2.0 ** (width - 5) and np.median(ratio) > 20
    if name == "short arms":
        assert (d1 + d2 <= 185).all()

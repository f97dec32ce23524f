# SPDX-License-Identifier: Apache-2.0
"""Test the choice of a branch against a search of all eight, written without the dataflow."""

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.choose import STEP_BITS, eps
from model.io.stimuli import arm_limits, arm_targets, referenced
from model.reference.joints import NEGATED_BY, TURNED_BY


def searched(joints, references, limits, width):
    """Return the steps of all branches (8, N), the joints of each (8, N, 7), and the mask (N,) of singular poses."""
    turn, half, joints = 1 << width, 1 << width - 1, joints.copy()
    singular = np.zeros(len(joints), dtype=bool)
    for first, middle, last in ((0, 1, 2), (4, 5, 6)):
        distance = np.abs((joints[:, middle] + half // 2) % half - half // 2)
        near = distance < eps(width)
        opposite = np.abs(joints[:, middle]) > turn // 4
        swing = joints[:, first] - references[:, first]
        joints[:, last] += np.where(near, np.where(opposite, -swing, swing), 0)
        joints[:, first] -= np.where(near, swing, 0)
        singular |= near
    low, high = np.transpose(limits)
    steps, all_joints = [], []
    for branch in range(8):
        bits = branch >> np.arange(3) & 1
        changed = np.where(NEGATED_BY @ bits & 1, -joints, joints) + half * (TURNED_BY @ bits & 1)
        at, span = (changed - low) % turn, (high - low) % turn
        gap = at - (references - low) % turn
        gap = np.where(span == turn - 1, (gap + half) % turn - half, gap)
        size = np.where(gap < 0, -gap - 1, gap) >> width - STEP_BITS
        steps.append(np.where(at > span, 2 * (1 << STEP_BITS) - 1, size).max(axis=1))
        all_joints.append((changed + half) % turn - half)
    return np.array(steps), np.array(all_joints), singular


@pytest.mark.parametrize("width", [16, 24, 32])
def test_no_branch_has_a_smaller_step(width):
    words, limits = referenced(arm_targets(3000, width, 1), width, 1), arm_limits(width, long=True)
    answer = fixed.run(words[:, :-1], width, "choose", words[:, -1], limits)
    given = fixed.run(words[:, :11], width, "arm", words[:, -1], limits)
    steps, joints, singular = searched(given.results[:, :7], words[:, 11:18], limits, width)
    flags, rows = answer.flags, np.arange(len(words))
    changed = (flags >> 16 & 7) ^ words[:, -1]
    assert (steps[changed, rows] == steps.min(axis=0)).all()
    assert (flags >> 19 & (2 << STEP_BITS) - 1 == steps.min(axis=0)).all()
    assert (answer.results[:, :7] == joints[changed, rows]).all()
    assert (answer.results[:, 7:] == given.results[:, 7:]).all()
    assert (flags >> 32 & 255 == (steps < 1 << STEP_BITS).T @ (1 << np.arange(8))).all()
    assert (flags >> 40 == singular).all()
    inside = (flags >> 31 & 1) == 0
    assert (flags[inside] >> 9 & 127 == 0).all() and (flags[~inside] >> 9 & 127 != 0).all()
    assert 0.1 < inside.mean() < 0.95 and 0.01 < singular.mean() < 0.5


@pytest.mark.parametrize("width", [20, 32])
def test_joints_that_are_the_reference_are_chosen(width):
    """A pose of any branch, with its own joints as reference, is answered with them, unless it is singular."""
    words = referenced(arm_targets(2000, width, 2), width, 2)
    branch = np.random.default_rng(width).integers(8, size=len(words))
    own = fixed.run(words[:, :11], width, "arm", branch)
    words[:, 11:18] = own.results[:, :7]
    answer = fixed.run(words[:, :-1], width, "choose", words[:, -1])
    regular = answer.flags >> 40 == 0
    # a negated angle is rounded the other way at half a word
    off = np.abs(answer.results[:, :7] - own.results[:, :7])
    assert off[regular].max() <= 1 and (answer.flags[regular] >> 16 & 7 == branch[regular]).mean() > 0.99

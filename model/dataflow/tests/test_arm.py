# SPDX-License-Identifier: Apache-2.0
"""Test the bit-true whole arm: accuracy by forward kinematics in double precision, poses with exact angles, arbitrary
words, branches and limits; and the choice of a branch against a search of all eight, written without the dataflow."""

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.angles import table
from model.dataflow.choose import STEP_BITS, eps
from model.dataflow.tests.test_datapaths import every_width
from model.io.flags import BAD_HAND, CORE_FLAGS, OVER_BIT, SATURATED, UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, any_hands, arm_limits, arm_targets, hand_poses, referenced, region
from model.reference.joints import NEGATED_BY, TURNED_BY
from model.reference.kinematics import rotate


@every_width
def test_the_arm_is_accurate_in_each_region(width):
    for name in REGIONS:
        words = hand_poses(region(name, 900, width, seed=1), width, 1)
        answer = fixed.run(words, width, "arm", np.arange(len(words)) % 8)
        flags, errors = answer.flags, tolerances.pose_errors(words, answer.results, answer.flags, width)
        assert not (flags & (SATURATED | BAD_HAND)).any() and (flags & UNREACHABLE == 0).mean() > 0.5, name
        for what, error in zip(("point", "orientation"), np.nan_to_num(errors), strict=True):
            n = int(error.argmax())
            assert error[n] <= 1, f"{what} is off by {error[n]:.3g} of the tolerance at {words[n].tolist()}"


@every_width
def test_every_input_has_an_answer(width):
    words = any_hands(3000, width, 1)
    ends = [(1 << width - 2) + side * (1 << width - 10) - less for side in (1, -1) for less in (0, 1)]
    words[:4, 7:] = [(0, end, 0, 0) for end in ends]  # just inside and outside both limits of a good hand's length
    answer = fixed.run(words, width, "arm")
    nodes = {name: node.value for name, node in answer.bits.nodes.items()}
    for name, node in answer.bits.nodes.items():
        value = np.asarray(node.value)
        assert ((value >= node.format.low) & (value <= node.format.high)).all(), f"{name} leaves its format"
    # flags, in Python's integers
    one, (low, high) = 1 << width - 2, (-(1 << width - 1), (1 << width - 1) - 1)
    square = (words[:, 7:].astype(object) ** 2).sum(axis=1)
    bad = (256**2 * square < (255 * one) ** 2) | (256**2 * square >= (257 * one) ** 2)
    assert (answer.flags & BAD_HAND > 0).tolist() == bad.tolist() and 0.5 < bad.mean() < 1
    core = np.column_stack([*(nodes[axis] for axis in "xyz"), words[:, 3:6]])
    assert (answer.flags & sum(CORE_FLAGS.values()) == expected_flags(core, width)).all()
    # the wrist: exact without a tool, at the edge of the format beyond it
    hand = np.where(bad[:, None], (1, 0, 0, 0), words[:, 7:] / one)
    offset = rotate(hand, (0.0, 0.0, 1.0)) * np.where(bad, 0, words[:, 6])[:, None]
    offset[:, 2] += (1 - (hand**2).sum(axis=1)) * np.where(bad, 0, words[:, 6])  # 1 - 2 ii - 2 jj
    wrist = words[:, :3] - offset
    assert np.abs(core[:, :3] - np.clip(wrist, low, high)).max() <= 1.5  # roundings of r, times a tool of 2
    beyond = ((wrist > high + 1.5) | (wrist < low - 1.5)).any(axis=1)
    inside = ((wrist < high - 1) & (wrist > low + 1)).all(axis=1)
    saturated = answer.flags & SATURATED > 0
    assert saturated[beyond].all() and not saturated[inside].any() and beyond.any()
    # |Qw| = |Qs| |Qe| |h|
    squares = [
        ((answer.results[:, part] / one) ** 2).sum(axis=1) for part in (slice(7, 11), slice(11, 13), slice(13, 17))
    ]
    assert np.abs(squares[2] - squares[0] * squares[1] * (hand**2).sum(axis=1)).max() <= 3 / one
    assert answer.flags.max() < 512


@every_width
def test_poses_with_exact_angles(width):
    """Check straight arms: th2, th4 and th6 are 0.  Half a turn: th4 of a closed arm, th6 of a reversed hand."""
    one, half = 1 << width - 2, 1 << width - 1
    arm = 0, one // 2, one // 2, 0  # phi, d1, d2, tool
    hands = np.array([(one, 0, 0, 0), (-one, 0, 0, 0), (0, 0, 0, one), (one, 0, 0, 0), (0, one, 0, 0)])
    heights = np.array([one, one, one, 0, one])[:, None]
    words = np.column_stack([0 * heights, 0 * heights, heights, np.tile(arm, (5, 1)), hands])
    th = fixed.run(words, width, "arm").results[:, :7]
    assert (th[:3, [1, 3, 5]] == 0).all() and th[3, 3] == th[4, 5] == -half
    sums = (th[:3, [0, 2, 4, 6]].sum(axis=1) + half) % (2 * half) - half
    assert (np.abs(sums[:2]) <= 2).all() and abs(abs(sums[2]) - half) <= 2


@every_width
def test_a_branch_turns_and_negates_words(width):
    words, half = any_hands(400, width, 2), 1 << width - 1
    own = fixed.run(words, width, "arm").results
    for branch in range(1, 8):
        found = fixed.run(words, width, "arm", branch).results
        bits = np.array([branch >> k & 1 for k in range(3)])
        moved = np.where(NEGATED_BY @ bits & 1, -own[:, :7], own[:, :7]) + half * (TURNED_BY @ bits & 1)
        off = (found[:, :7] - moved) % (2 * half)
        assert (found[:, 7:] == own[:, 7:]).all() and set(off.ravel().tolist()) <= {0, 1}  # 1: a negated tie
        ties = (NEGATED_BY @ bits & 1 > 0) & (sum(table(width)) % 2 == 0)  # no tie where an angle's words add up to odd
        assert off.any(axis=0).tolist() == ties.tolist()


@every_width
def test_over_limit_is_exact(width):
    half = 1 << width - 1
    words, random = any_hands(600, width, 3), np.random.default_rng(width)
    th = fixed.run(words, width, "arm").results[:, :7]
    for _ in range(12):
        limits = np.where(
            random.random((7, 2)) < 0.5, th[random.integers(len(th)), :, None], random.integers(-half, half, (7, 2))
        )
        limits += random.integers(-1, 2, limits.shape)
        limits[random.integers(7)] = -half, half - 1
        limits = (limits + half) % (2 * half) - half
        over = fixed.run(words, width, "arm", 0, limits.tolist()).flags >> OVER_BIT
        for k, (low, high) in enumerate(limits.tolist()):
            arc = [(low <= v <= high) if low <= high else (v >= low or v <= high) for v in th[:, k].tolist()]
            assert (over >> k & 1).tolist() == [not within for within in arc]


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

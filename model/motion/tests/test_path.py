# SPDX-License-Identifier: Apache-2.0
"""Test feasible swivel angles, and the branches and swivel angles that `Arm` chooses for poses and along paths."""

import itertools
import re

import numpy as np
import pytest

from model import continuous_core_angles, feasible_swivel, solve
from model.motion.arms import IIWA14, ROBOTS, Arm
from model.motion.swivels import Swivels
from model.motion.tests.test_pose import FREE, TOOL, apart, branches_of, chain, poses
from model.reference.joints import UNIT
from model.reference.kinematics import about, matrix

WIDE = np.array([(-3.0, 3.0)] * 6 + [(-6.2, 6.2)])
BENT = Arm(0.3, 0.25, (0.02, 0, 0.1), limits=WIDE, upper=about(0, 0.2), fore=about(2, 0.3), base=(0.1, 0.2, 0.3))
ARMS = ROBOTS | {"bent": BENT, "free": Arm(0.33, 0.27, 0.1)}


def curve(arm, kind, seed, rows=240, share=0.95):
    """Return joint positions (rows, 7) along a "line" or a "sine" over ``share`` of each joint's range."""
    random, (low, high) = np.random.default_rng(seed), np.clip(arm.limits.T, -np.pi, np.pi)
    middle, half, time = (low + high) / 2, share * (high - low) / 2, np.linspace(0, 1, rows)[:, None]
    one, other = random.uniform(-1, 1, (2, 7))
    if kind == "line":
        return middle + half * (one + (other - one) * time)
    return middle + half * np.sin(np.pi * random.integers(1, 4, 7) * time + np.pi * one)


def check(arm, joints, points, q, atol=1e-12):
    """Check that joints (N, 7) are within their limits and bring the tip to ``points`` and orientations ``q``."""
    reached, turned = arm.forward(joints)
    np.testing.assert_allclose(reached, points, rtol=0, atol=atol)
    np.testing.assert_allclose(matrix(turned), matrix(q), rtol=0, atol=atol)
    assert (joints >= arm.limits[:, 0]).all() and (joints <= arm.limits[:, 1]).all()


def followed(arm, joints, atol=1e-12, start=None):
    """Compute the tip's poses at joints (N, 7) and a path through these poses; check the path and return it."""
    points, q = arm.forward(joints)
    path = arm.path(points, q, start)
    check(arm, path.joints, points, q, atol)
    return path


@pytest.mark.parametrize(
    ("name", "seeds"),
    [
        *(pytest.param(name, range(2), id=name) for name in ROBOTS),
        *(pytest.param(name, range(2), id=name, marks=pytest.mark.slow) for name in ("bent", "free")),
        *(pytest.param(name, range(2, 60), id=f"{name}-all", marks=pytest.mark.release) for name in ROBOTS),
    ],
)
def test_lines_and_sines(name, seeds):
    """Follow lines between random joint positions, and sines over 95 % of the range; with seed 1, start at the first
    row's joints. At most one of 116 paths may jump, and by less than 0.22 rad."""
    arm, jumping = ARMS[name], 0
    for kind, seed in itertools.product(("line", "sine"), seeds):
        joints = curve(arm, kind, seed, 200, 1.0 if kind == "line" else 0.95)
        path = followed(arm, joints, 1e-9, joints[0] if seed == 1 else None)
        assert set(np.flatnonzero(path.step > 0.2).tolist()) == set(path.jumps) and path.largest < 0.22, (kind, seed)
        jumping += bool(path.jumps)
        moved = np.abs(np.diff(path.joints, axis=0)).max(axis=1)
        np.testing.assert_allclose(path.step[1:], moved, rtol=0, atol=1e-12)
        at = arm.solve(*arm.forward(joints), path.phi, path.branch).joints
        regular = np.abs(np.sin(arm.angles(path.joints)[:, [1, 5]])).min(axis=1) > 1e-5
        assert arm.chain or apart(at, path.joints)[regular].max() < 1e-9 and regular.mean() > 0.9
    assert jumping <= 0.01 * 2 * len(seeds)


@pytest.mark.parametrize("tilts", [(1,), (5,), (1, 5), (3,)], ids=str)
def test_through_singular_poses(tilts):
    """Follow lines on which joints pass exactly through 0 in row 100: th2, or th6, or th2 and th6, or th4."""
    for seed in range(2):
        joints = curve(IIWA14, "line", seed, 201)
        for tilt in tilts:
            joints[:, tilt] = np.linspace(-1.5, 1.5, 201) * (1 - 2 * (seed % 2))
            assert joints[100, tilt] == 0
        assert followed(IIWA14, joints, 3e-7, joints[0] if seed else None).largest <= 0.2


def test_windings():
    """Check that a joint with a range of more than a turn continues past half a turn, and jumps at its limit."""
    arm = Arm(0.4, 0.4, 0.1, limits=[(-2.9, 2.9)] * 6 + [(-6.0, 6.0)])
    joints = np.tile(np.array((0.3, 0.9, 0.2, 1.1, 0.4, 0.8, 0.0)), (120, 1))
    joints[:, 6] = np.linspace(-5.9, 5.9, 120)
    path = followed(arm, joints)
    assert path.largest < 0.2 and np.ptp(path.joints[:, 6]) > 11
    path = followed(arm, joints, start=joints[0] + (0, 0, 0, 0, 0, 0, 2 * np.pi))  # would end at 12.2
    assert path.largest > 1 and path.jumps
    path = followed(arm, joints + (0, 0, 0, 0, 0, 0, 2.0))  # would end at 7.9, or have begun at -10.2
    (jump,) = path.jumps.values()
    assert 1 < path.largest < 6.4 and f"moves by {path.largest:.3g} rad" in jump


def test_joints_of_exactly_a_turn():
    """Follow a path on which joint ranges of exactly a turn make swivel arcs narrower than the search's step."""
    limits = np.pi * np.array([(-1, 1), (0, 1), (-1, 1), (-0.83, 0), (-1, 1), (-0.5, 0.61), (-0.86, 0.86)])
    arm = Arm(0.28, 0.26, limits=limits)
    path = followed(arm, curve(arm, "sine", 56, 200))
    assert path.largest <= 0.2 and not path.jumps


def test_given_branch_and_swivel():
    """Check that a path keeps given branches and swivel angles, and that rows without a solution have a reason."""
    points, q = IIWA14.forward(curve(IIWA14, "sine", 4, 60))
    whole = IIWA14.path(points, q)
    some = IIWA14.path(points, q, phi=whole.phi)
    np.testing.assert_array_equal(some.branch, whole.branch)
    np.testing.assert_allclose(some.joints, whole.joints, atol=1e-6)
    for branch in range(8):
        path = IIWA14.path(points, q, phi=0.3, branch=branch)
        expected = IIWA14.solve(points, q, 0.3, branch)
        inside = ~expected.over_limit.any(axis=1)
        np.testing.assert_array_equal(np.isfinite(path.joints).all(axis=1), inside)
        np.testing.assert_allclose(path.joints[inside], expected.joints[inside], atol=1e-9)
        for n in np.flatnonzero(~inside):
            over = [f"joint {1 + joint} by" for joint in np.flatnonzero(expected.over_limit[n])]
            assert f"in branch {branch}: " in path.jumps[n] and all(text in path.jumps[n] for text in over)
    away = IIWA14.path([(3, 0, 0), points[0]], [UNIT, q[0]])
    assert away.jumps == {0: "wrist 3.03911 from the shoulder, where the arm reaches 0.02 to 0.82"}
    assert np.isnan(away.joints[0]).all() and np.isfinite(away.joints[1]).all()
    nothing = IIWA14.path(points[:0], q[:0])
    assert nothing.joints.shape == (0, 7) and nothing.largest == 0


@pytest.mark.parametrize("name", ARMS)
def test_poses_alone(name):
    """Check that joints are within their limits, and that ``near`` is returned if it reaches the pose."""
    arm, random = ARMS[name], np.random.default_rng(1)
    joints = random.uniform(*np.clip(arm.limits.T, -np.pi, np.pi), (300, 7))
    points, q = arm.forward(joints)
    for pose in (arm.solve(points, q), arm.solve(points, q, near=joints)):
        assert not pose.over_limit.any()
        check(arm, pose.joints, points, q, 1e-9)
    assert apart(pose.joints, joints).max() < (0.01 if arm.chain else 1e-8)
    one = arm.solve(points[0], q[0], near=joints[0])
    np.testing.assert_allclose(one.joints, pose.joints[:1], atol=1e-12)
    branch = arm.solve(points, q, phi=pose.phi, near=pose.joints).branch
    np.testing.assert_array_equal(branch, pose.branch)
    if np.isfinite(arm.limits).all():
        both = (arm.solve(points, q).joints, pose.joints)
        far, near = (np.minimum(at - arm.limits[:, 0], arm.limits[:, 1] - at).min(axis=1) for at in both)
        assert (far > near - 1e-3).mean() > 0.95
    assert np.isfinite(arm.velocities).all() or name in ("iiwa14", "human", "bent", "free")


def test_continuous_joints():
    """Check that rows in any branch give joints with the same hand poses, within limits and without jumps."""
    offset = Arm(0.33, 0.27, 0.1, offsets=(0, -np.pi / 2, 0, 0, 0, 0, 0))
    for arm in (offset, IIWA14):
        joints = curve(arm, "sine", 2, 50, 0.5)
        points, q = arm.forward(joints)
        phi = arm.path(points, q).phi
        mixed = np.concatenate([arm.solve(points[n], q[n], phi[n], n % 8).joints for n in range(50)])
        joined = arm.continuous_joints(mixed)
        check(arm, joined, points, q, 1e-9)
        assert np.abs(np.diff(joined, axis=0)).max() < 0.5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"goal": np.nan}, "goal nan is not an angle"),
        ({"start": [0.0] * 6}, r"start of the arm: shape \(6,\), not \(7,\)"),
        ({"start": [np.nan] * 7}, "start: not finite"),
        ({"start": [9.0] + [0.0] * 6}, "start: A1 is 6.03 rad outside its limits"),
        ({"phi": [0.0] * 3}, "numbers of rows do not broadcast: points has 2, hand has 2, phi has 3"),
        ({"branch": 8}, "branch 8 is not a combination"),
        ({"points": [(np.nan, 0, 0)] * 2}, "points: not finite in rows 0, 1"),
        ({"points": [(0, 0)]}, r"points: shape \(1, 2\), not \(N, 3\)"),
        ({"hand": [(np.nan, 0, 0, 1)] * 2}, "not finite in rows 0, 1"),
    ],
)
def test_bad_arguments(change, message):
    arguments = {"points": [(0.5, 0.1, 0.6)] * 2, "hand": [UNIT] * 2} | change
    with pytest.raises(ValueError, match=message):
        IIWA14.path(**arguments)


@pytest.mark.parametrize("name", ["iiwa14", "human", "bent"])
def test_track(name):
    """Check that each step reaches the pose within the limits, and that ``largest`` is the largest move of a joint."""
    arm = ARMS[name]
    joints = curve(arm, "line", 1, 100, 0.5)
    points, q = arm.forward(joints)
    at = joints[0].tolist()
    for point, hand in zip(points[1:].tolist(), q[1:].tolist(), strict=True):
        step = arm.track(point, hand, at)
        assert step.joints and not step.reason
        assert not arm._tracker or arm._tracker.step(point, hand, at) == step, "the slow path answers instead"
        assert np.isclose(step.largest, np.abs(np.subtract(step.joints, at)).max(), rtol=0, atol=1e-9)
        check(arm, np.array([step.joints]), [point], np.array([hand]), 1e-9)
        assert step.largest < 0.2
        at = list(step.joints)


@pytest.mark.parametrize("name", ["iiwa14", "human"])
def test_track_takes_the_nearest_branch(name):
    """Step from distant joints; check that, with this elbow, no branch within limits has a smaller maximum step."""
    arm, random, found = ARMS[name], np.random.default_rng(3), 0
    far, present = random.uniform(*arm.limits.T, (2, 200, 7))
    for point, hand, now in zip(*arm.forward(far), present, strict=True):
        step = arm._tracker.step(point.tolist(), hand.tolist(), now.tolist())
        phi = None if step.joints is None else arm._swivel(np.array([step.joints]), arm._asked(point, hand)[0])
        if phi is not None and step.largest > 0.5:
            others = [arm.solve(point, hand, phi, branch) for branch in range(8)]
            inside = [pose.joints[0] for pose in others if not pose.over_limit.any()]
            assert abs(min(np.abs(at - now).max() for at in inside) - step.largest) < 1e-6
            found += 1
    assert found > 20


@pytest.mark.parametrize(("tilt", "turned"), [(1, 2), (1, 6), (5, 6)])
def test_track_in_singular_poses(tilt, turned):
    """Check that with th2 or th6 at 0 no joint moves farther than joint ``turned``; turning th7 needs no search."""
    joints = np.array((0.4, 0.7, -0.3, 1.1, 0.2, 0.6, 0.5))
    joints[tilt] = 0
    (point,), (hand,) = IIWA14.forward(joints + 0.1 * (np.arange(7) == turned))
    pose = point.tolist(), hand.tolist(), joints.tolist()
    step = IIWA14.track(*pose)
    assert step.largest < 0.1 + 1e-6 and (turned == 2 or IIWA14._tracker.step(*pose) == step)
    np.testing.assert_allclose(IIWA14.forward(step.joints)[0][0], point, rtol=0, atol=2e-7)


def test_reasons():
    """Check that a pose has a reason if and only if it has no joints; widening the limits in the reason solves it."""
    arm = Arm(0.42, 0.4, 0.126, limits=[(-1.2, 1.2)] * 7)
    points, q = arm.forward(np.random.default_rng(2).uniform(-1.6, 1.6, (40, 7)))
    points[0] *= 3
    reasons, path = arm.reasons(points, q), [arm.path(*one) for one in zip(points, q, strict=True)]
    assert set(reasons) == {n for n in range(40) if np.isnan(path[n].joints).any()} and 5 < len(reasons) < 35
    assert reasons.pop(0).startswith("wrist ") and all(path[n].jumps[0] == text for n, text in reasons.items())
    for n, text in reasons.items():
        limits = arm.limits.copy()
        for joint, by in re.findall(r"joint (\d) by (\S+) rad", text):
            limits[int(joint) - 1] += np.array((-1.01, 1.01)) * float(by)
        assert not Arm(0.42, 0.4, 0.126, limits=limits).solve(points[n], q[n]).over_limit.any()


def test_dead_ends():
    point, hand = (0.5, 0.1, 0.6), (1.0, 0.0, 0.0, 0.0)
    away = IIWA14.track((3.0, 0.0, 0.0), hand, [0.0] * 7)
    assert away.joints is None and away.reason.startswith("wrist 3.")
    with pytest.raises(ValueError, match="hand: length 2, not 1"):
        IIWA14.track(point, (2.0, 0.0, 0.0, 0.0), [0.0] * 7)
    with pytest.raises(ValueError, match="limits of joint 3: only one of them is finite"):
        Arm(0.3, 0.3, limits=[(-1, 1)] * 2 + [(-np.inf, 1)] + [(-1, 1)] * 4)
    with pytest.raises(ValueError, match=r"signs of the arm: shape \(6,\)"):
        Arm(0.3, 0.3, signs=np.ones(6))
    stiff = Arm(0.42, 0.4, 0.126, limits=[(-0.1, 0.1)] * 7)
    dead = stiff.track(point, hand, [0.0] * 7)
    assert dead.joints is None and dead.reason.startswith("outside the limits, in branch ")


@pytest.mark.parametrize("axis", ["z", (0.3, 1.0, -0.2)])
@pytest.mark.parametrize("seed", [2, 3])
def test_feasible_swivels_are_those_of_a_grid(seed, axis):
    """Compare intervals in random branches with a grid of angles; check that a joint is at a limit at interval ends."""
    random, count, grid = np.random.default_rng(seed), 300, np.linspace(-np.pi, np.pi, 181)
    points, q, _ = poses(count, seed)
    branch, middle = random.integers(0, 8, count), random.uniform(-np.pi, np.pi, 7) * (1, 0.3, 1, 0, 1, 0.3, 1)
    limits = middle[:, None] + random.uniform(2.0, 3.1, (7, 1)) * (-1, 1)
    swivels = feasible_swivel(points, q, tool=TOOL, limits=limits, branch=branch, axis=axis)

    def over(n, phi):
        pose = solve(points[n], phi, axis=axis, hand=q[n], tool=TOOL, branch=branch[n], limits=limits)
        return pose.over_limit.any(axis=1), apart(pose.joints[..., None], limits).min(axis=(1, 2))

    truth = ~over(np.repeat(np.arange(count), len(grid)), np.tile(grid, count))[0].reshape(count, -1)
    first, last = np.moveaxis(swivels.intervals[..., None], 2, 0)
    inside = (np.mod(grid - first, 2 * np.pi) <= last - first).any(axis=1)
    close = (apart(swivels.intervals[..., None], grid) < 1e-6).any(axis=(1, 2))
    assert 0.1 < truth.mean() < 0.9 and close.mean() < 0.2
    np.testing.assert_array_equal(inside[~close], truth[~close])
    some = ~np.isnan(first[..., 0])
    assert swivels.feasible.tolist() == some.any(axis=1).tolist() == [swivels.reason(n) == "" for n in range(count)]
    np.testing.assert_array_equal(swivels.feasible, ~swivels.over_limit.any(axis=1))
    assert ((last >= first) & (np.abs(first) <= np.pi))[some].all() and (first[:, 1:] > last[:, :-1])[some[:, 1:]].all()
    n, k = np.nonzero(some & ~truth.all(axis=1)[:, None])
    for end in (first, last):
        assert over(n, np.angle(np.exp(1j * end[n, k, 0])))[1].max() < 1e-7


@pytest.mark.parametrize("joint", [0, 1, 2, 4, 5, 6])
def test_locked_joint_gives_isolated_angles(joint):
    points, q, phi = poses(50)
    for n in range(50):
        limits, th = FREE.copy(), solve(points[n], phi[n], hand=q[n], tool=TOOL, branch=n % 8).joints[0]
        limits[joint] = th[joint]
        intervals = feasible_swivel(points[n], q[n], tool=TOOL, limits=limits, branch=n % 8).intervals[0]
        assert np.ptp(intervals, axis=1).max() < 1e-7 and apart(intervals, phi[n]).min() < 1e-6
        at = solve(points[n], intervals[:, 0], hand=q[n], tool=TOOL, branch=n % 8).joints[:, joint]
        assert apart(at, th[joint]).max() < 1e-7


def test_nearest_feasible_angle():
    def nearest(intervals, near, margin=0.0):
        return Swivels(np.array(intervals), *[np.empty(0)] * 3, 3.0).nearest(near, margin)

    no, turn = (np.nan, np.nan), 2 * np.pi
    two, one, none, whole = [(-1, 0.5), (2, 4.5)], [(1.5, 1.6), no], [no, no], [(-np.pi, np.pi), no]
    for row, near, margin, expected in (
        (two, (0.2, 1.0, 1.8, -2.0, -1.5, 7.0), 0.0, (0.2, 0.5, 2.0, -2.0, 4.5 - turn, 0.5)),
        (two, (0.2, 1.0, 1.4, -2.0), 0.3, (0.2, 0.2, 2.3, 4.2 - turn)),
        (two, (0.4, 1.9), 1.0, (-0.25, 3.0)),  # the middle of the shorter interval
        (one, (-2.0, 1.5, 1.57, 7.0), 0.0, (1.6, 1.5, 1.57, 1.5)),
        (whole, (-3.0, 7.0), 0.5, (-3.0, 7.0 - turn)),
        (none, (0.1, np.pi), 0.5, (np.nan, np.nan)),
    ):
        np.testing.assert_allclose(nearest([row] * len(near), near, margin), expected, rtol=0, atol=1e-12)
    path = nearest([whole, two, none, one, whole], None)  # the first near 3, where the elbow hangs
    np.testing.assert_allclose(path, (3.0, 3.0, np.nan, 1.6, 1.6), rtol=0, atol=1e-12)
    assert feasible_swivel((0.3, 0.1, 0.2), (1, 0, 0, 0), axis="-z").nearest() == 0  # hangs at 0 there, pi for z


def turning():
    """Return joints (3000, 7) of a smooth path; some joints make several turns."""
    random, t = np.random.default_rng(5), np.linspace(0, 1, 3000)[:, None]
    return 1.2 * np.sin(4 * t * random.uniform(0.5, 2, 7) + random.uniform(0, 6, 7)) + t * (15, 0, 0, 0, -9, 0, 20)


def test_path_without_jumps():
    smooth, branch = turning(), np.random.default_rng(1).integers(0, 8, 3000)
    scrambled = np.angle(np.exp(1j * branches_of(smooth)[branch, np.arange(3000)]))
    scrambled[[7, 8, 1500], [0, 3, 6]] = np.nan
    joined, present = continuous_core_angles(scrambled), np.isfinite(scrambled).all(axis=1)
    np.testing.assert_array_equal(joined[~present], scrambled[~present])
    np.testing.assert_allclose(joined[0], scrambled[0], rtol=0, atol=1e-12)
    turns = (joined[present] - branches_of(smooth)[branch[0], present]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns[:1]).repeat(2997, axis=0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("first", "tilt"), [(4, 0.0), (4, np.pi), (0, 0.0), (0, np.pi)])
def test_singular_stretch_keeps_the_first_joint(first, tilt):
    """Check that only the third angle moves where the hand depends only on the first plus or minus the third angle."""
    smooth, rows = turning(), slice(1000, 2000)
    smooth[rows, first + 1], smooth[rows, first] = tilt, smooth[999, first]
    split, share = smooth.copy(), np.random.default_rng(1).uniform(-9, 9, 1000)
    split[rows, first] += share
    split[rows, first + 2] += share if tilt else -share
    np.testing.assert_allclose(chain(split)[1], chain(smooth)[1], atol=1e-13)
    joined = continuous_core_angles(np.angle(np.exp(1j * split)))[rows]
    np.testing.assert_allclose(joined[:, first], joined[0, first], rtol=0, atol=1e-12)
    off = (joined - smooth[rows])[:, first + 2] / (2 * np.pi)
    np.testing.assert_allclose(off, off[0].round(), rtol=0, atol=1e-12)

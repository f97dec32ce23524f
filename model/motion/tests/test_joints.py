# SPDX-License-Identifier: Apache-2.0
"""Test the seven joints of hand poses: forward kinematics by matrices, limits, feasible swivel angles, paths."""

import warnings
from functools import partial
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from model.io.flags import Flag
from model.motion.pose import solve, to_z
from model.motion.swivels import Swivels, continuous_core_angles, feasible_swivel
from model.reference.joints import outside, turned
from model.reference.kinematics import matrix, multiply

D1, D2, TOOL = 0.33, 0.27, 0.1
FREE = np.array([(-np.inf, np.inf)] * 7)
LIMITS = np.radians([(-150, 150), (-120, 120), (-170, 100), (-10, 140), (-120, 170), (-100, 120), (-170, 175)])


def chain(th, tool=TOOL):
    """Return points (N, 3) and orientations (N, 3, 3) of hands for joints (N, 7)."""
    upper, wrist = (Rotation.from_euler("ZXZ", th[:, three]) for three in (slice(3), slice(4, 7)))
    fore = upper * Rotation.from_euler("X", th[:, [3]])
    hand = fore * wrist
    return sum(turn.apply((0, 0, d)) for turn, d in ((upper, D1), (fore, D2), (hand, tool))), hand.as_matrix()


def branches_of(joints):
    """Return joints (N, 7) in each of the branches 0 .. 7, (8, N, 7)."""
    branches = joints[None]
    for n in (0, 2, 4):
        other = branches * np.where(np.arange(7) == n + 1, -1, 1) + np.pi * np.isin(np.arange(7), (n, n + 2))
        branches = np.concatenate((branches, other))
    return branches


def wrists(count, seed=1):
    """Return points (N, 3) and swivel angles (N,) of reachable wrist targets."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(count, 3))
    points *= (random.uniform(0.1, 0.59, count) / np.linalg.norm(points, axis=1))[:, None]
    return points, random.uniform(-np.pi, np.pi, count)


def poses(count, seed=1, tool=TOOL):
    """Return points (N, 3), hands (N, 4) and swivel angles (N,) of reachable poses."""
    wrist, phi = wrists(count, seed)
    q = Rotation.random(count, seed).as_quat(scalar_first=True)
    return wrist + tool * matrix(q)[..., 2], q, phi


def assert_reached(pose, points, hand, axis="z", tool=TOOL):
    """Check that the joints reach points within 1e-14 of the reach, and orientations within 1e-14 in each element."""
    to_core = matrix(to_z(axis))
    point, m = chain(pose.joints, tool)
    for reached in (point @ to_core, pose.hand):
        np.testing.assert_allclose(reached, points, rtol=0, atol=1e-14 * (D1 + D2 + tool))
    np.testing.assert_allclose(to_core.T @ m, matrix(hand), rtol=0, atol=1e-14)


def apart(a, b):
    """Return the absolute difference of angles, at most pi."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(a) - b))))


@pytest.mark.parametrize(
    ("axis", "tool"), [("z", TOOL), ("-z", 0.0), ("x", TOOL), ("-y", TOOL), ((0.3, 1.0, -0.2), 0.0)]
)
def test_joints_lead_to_the_hand(axis, tool):
    """Check that all branches reach the hand, with different joints but the same Qs."""
    points, q, phi = poses(1000, tool=tool)
    solutions = [solve(points, phi, axis=axis, hand=q, tool=tool, branch=branch) for branch in range(8)]
    for pose in solutions:
        assert not pose.flags.any() and not pose.over_limit.any() and np.abs(pose.joints).max() <= np.pi
        assert_reached(pose, points, q, axis, tool)
        np.testing.assert_array_equal(pose.qs, solutions[0].qs)
    joints, rows = np.array([pose.joints for pose in solutions]), np.arange(1000)
    assert (joints[0][:, [1, 3, 5]] >= 0).all() and apart(joints, branches_of(joints[0])).max() < 1e-14
    assert ((apart(joints[:, None], joints).max(axis=3) > 1e-3).sum(axis=1) == 7).all()
    mixed = solve(points, phi, axis=axis, hand=q, tool=tool, branch=rows % 8).joints
    np.testing.assert_array_equal(mixed, joints[rows % 8, rows])
    last = solve(points, phi, axis=axis, hand=np.roll(q, -1, axis=1), tool=tool, order="xyzw")
    np.testing.assert_array_equal(last.joints, joints[0])
    wrists = Rotation.from_euler("ZXZ", last.joints[:, 4:]).as_matrix()
    np.testing.assert_allclose(matrix(np.roll(last.qw, 1, axis=1)), wrists, rtol=0, atol=1e-14)


@pytest.mark.parametrize("shoulder", (0.0, np.pi, 0.7))
def test_singular_poses(shoulder):
    """Check the hands but no flags: rounding moves some targets of straight or closed arms out of reach."""
    elbow, wrist = np.array([*product((0.0, np.pi, 0.7), repeat=2)]).repeat(12, axis=0).T
    v = np.tile(np.linspace(-3, 3, 12), 9)
    th = np.array([v, 0 * v + shoulder, v[::-1], 0 * v + elbow, v**2, 0 * v + wrist, v]).T
    q = multiply(multiply(turned(*th.T[:3]).T, turned(0 * v, th[:, 3], 0 * v).T), turned(*th.T[4:]).T)
    (points, m), up = chain(th), (0, 0, D1 + D2 + TOOL)
    np.testing.assert_allclose(matrix(q), m, rtol=0, atol=1e-14)
    for branch in range(8):
        assert_reached(solve(points, 0.3, hand=q, tool=TOOL, branch=branch), points, q)
        assert_reached(solve(up, 0.3, hand=(1, 0, 0, 0), tool=TOOL, branch=branch), [up], [(1, 0, 0, 0)])
        bent = solve((0, 0, -0.4), 0.3, hand=q[::12], branch=branch)
        assert_reached(bent, [(0, 0, -0.4)] * 9, q[::12], tool=0.0)
        assert (bent.flags == Flag.ON_AXIS).all()


def test_limits_are_circular():
    assert not outside(np.radians([-170.0] * 7), np.radians([(170, 200)] * 7)).any()
    points, q, phi = poses(2)
    th, turns = solve(points, phi, hand=q, tool=TOOL).joints, (-2 * np.pi, 0.0, 2 * np.pi)
    inside = [(-0.1, 0.2), (0.0, 0.3), (-0.3, 0.0), (0.0, 0.0), (0.1, 2 * np.pi), (-9.0, 9.0), (0.1, np.inf)]
    beside = [(1e-8, 0.3), (-0.3, -1e-8), (0.1, 6.2)]
    for n, joint, add, limit in product(range(2), range(7), turns, inside + beside):
        limits = FREE.copy()
        limits[joint] = th[n, joint] + add + limit
        over = solve(points[n], phi[n], hand=q[n], tool=TOOL, limits=limits).over_limit[0]
        assert over.tolist() == [limit in beside and one == joint for one in range(7)]


def test_poses_without_an_answer():
    """Test targets too far, too near, for a limited elbow, out of reach by rounding, with a nan, and an empty array."""
    (points, q, _), phi, free = poses(6), [0.5] * 6, FREE.copy()
    points[0] *= 10
    points[1] = 0.02 * points[1] + TOOL * matrix(q[1])[:, 2]
    pose, swivels = (f(points, hand=q, tool=TOOL, limits=FREE) for f in (partial(solve, phi=phi), feasible_swivel))
    assert pose.flags.tolist() == [Flag.TOO_FAR, Flag.TOO_NEAR, 0, 0, 0, 0]
    assert_reached(pose, pose.hand, q)
    far = np.linalg.norm(points - TOOL * matrix(q)[..., 2], axis=1)
    expected = [f"wrist {d:.6g} from the shoulder, where the arm reaches 0.06 to 0.6" for d in far[:2]]
    assert [swivels.reason(n) for n in range(6)] == [*expected, "", "", "", ""]
    assert swivels.feasible.tolist() == [False] * 2 + [True] * 4
    assert swivels.intervals[2:].tolist() == [[[-np.pi, np.pi]]] * 4
    free[3] = 0, pose.joints[2, 3] - 1e-6
    stiff = feasible_swivel(points[2], q[2], tool=TOOL, limits=free)  # a single, infeasible pose
    assert not stiff.feasible[0] and stiff.reason(0) == "joint 4 outside the limits" and np.isnan(stiff.nearest(0.1))
    straight = np.array([(0.36, 0.48, 0.0), (0.48, 0.0, 0.36), (0.0, -0.36, 0.48)]) * (1 + 1e-12)
    assert feasible_swivel(straight, (1, 0, 0, 0)).feasible.all()
    points[2, 1] = phi[3] = q[4, 2] = np.nan
    missing = solve(points, phi, hand=q, tool=[TOOL] * 5 + [np.nan], limits=LIMITS, nan="pass")
    for name in ("joints", "qw", "hand", "qs"):
        assert np.isnan(getattr(missing, name)[2:]).all()
        np.testing.assert_array_equal(getattr(missing, name)[:2], getattr(pose, name)[:2])
    assert not missing.flags[2:].any() and not missing.over_limit[2:].any()
    nowhere = feasible_swivel(points[:0], q[:0], tool=TOOL, limits=LIMITS)
    assert nowhere.feasible.shape == nowhere.nearest().shape == nowhere.nearest(0.1).shape == (0,)
    none = solve(points[:0], 0.1, hand=q[:0], limits=LIMITS).joints
    assert none.shape == continuous_core_angles(none).shape == (0, 7)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"hand": [(1.0, 0, 0, 0), (0, 0.99, 0, 0)]}, "hand: length 0.99, not 1, in row 1"),
        ({"hand": (1.0, 0.0, 0.0)}, r"hand has the shape \(3,\)"),
        ({"branch": 8}, "branch 8 is not a combination of SHOULDER, ELBOW, WRIST"),
        ({"branch": 1.5}, "branch 1.5"),
        ({"limits": LIMITS[:6]}, r"limits have the shape \(6, 2\)"),
        ({"limits": [*LIMITS[:4], (1.0, 0.5), *LIMITS[5:]]}, "limits of joint 5: 1 to 0.5"),
        ({"tool": np.inf}, "tool: not finite"),
        ({"hand": (np.nan, 0.0, 0.0, 1.0)}, "hand and tool: not finite in row 0"),
        ({"width": 32, "datapath": "paper"}, "datapath 'paper': with hand and width it must be 'lean'"),
        ({"width": 32, "tool": 20.0}, "column tool: .20.0. is too long"),
        ({"order": "ijkw"}, "order 'ijkw'"),
    ],
)
def test_wrong_arguments_are_named(changes, message):
    arguments = {"points": (0.2, 0.2, 0.2), "hand": (1, 0, 0, 0)} | changes
    for function in (solve,) if "width" in changes else (solve, feasible_swivel):
        with pytest.raises(ValueError, match=message):
            function(**arguments)


@pytest.mark.parametrize(("axis", "order"), [("z", "xyzw"), ("-x", "wxyz"), ((0.3, 1.0, -0.2), "xyzw")])
@pytest.mark.parametrize(("width", "off"), [(18, 3e-4), (32, 3e-8)])
def test_words_are_near_the_pose_in_double(width, off, axis, order):
    """Compare flags, points, hands and limits in words and in double precision, for all branches and rows of nan."""
    points, q, phi = poses(300, 5)
    branch, hand = np.arange(300) % 8, q if order == "wxyz" else np.roll(q, -1, axis=1)
    points[7], tool = np.nan, np.where(np.arange(300) == 9, np.nan, TOOL)
    arguments = {"hand": hand, "tool": tool, "branch": branch, "axis": axis, "order": order, "nan": "pass"}
    double = solve(points, phi, limits=LIMITS, **arguments)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        words = solve(points, phi, limits=LIMITS, width=width, **arguments)
    np.testing.assert_array_equal(words.flags, double.flags)
    for name in ("hand", "wrist", "elbow"):
        np.testing.assert_allclose(getattr(words, name), getattr(double, name), rtol=0, atol=4 * off)
    # near a singular pose only the sums of angles are the same: compare hands
    keep = np.delete(np.arange(300), [7, 9])
    for pose in (words, double):
        reached, m = chain(pose.joints[keep])
        np.testing.assert_allclose(reached @ matrix(to_z(axis)), points[keep], rtol=0, atol=off)
        np.testing.assert_allclose(matrix(to_z(axis)).T @ m, matrix(q[keep]), rtol=0, atol=3 * off)
    clear = apart(words.joints[keep, :, None], LIMITS).min(axis=-1) > 100 * off
    assert (words.over_limit[keep] == double.over_limit[keep])[clear].all() and clear.mean() > 0.8
    assert np.isnan(words.joints[[7, 9]]).all() and not words.over_limit[[7, 9]].any()


@pytest.mark.parametrize("tool", [0.4, 2.5])
def test_a_tool_has_room_in_the_format(tool):
    """Test tools along a diagonal: the components of the vector from wrist to hand are shorter than the tool."""
    q = np.array((np.sqrt(3) + 1, -np.sqrt(2), np.sqrt(2), 0.0)) / np.sqrt(8 + 2 * np.sqrt(3))
    point = np.array((0.2, 0.1, 0.3)) + tool * matrix(q)[:, 2]
    pose = solve(point, 0.3, hand=q, tool=tool, width=32)
    assert pose.flags == 0 and np.abs(matrix(q)[:, 2]).max() < 0.8
    np.testing.assert_allclose(chain(pose.joints, tool)[0], [point], rtol=0, atol=1e-7)


@pytest.mark.parametrize("width", [16, 32])
def test_limits_in_words_are_rounded_inward(width):
    points, q, phi = poses(200, 6)
    th = solve(points, phi, hand=q, tool=TOOL, width=width).joints
    unit = 2 * np.pi / 2**width
    for joint in range(7):
        limits, at = FREE.copy(), th[joint, joint]
        a_turn_up = at + 2 * np.pi
        for low, high, over in (
            (at - 0.1 * unit, at + 0.1 * unit, False),
            (at + 0.1 * unit, at + 1.0, True),
            (at - 1.0, at - 0.1 * unit, True),
            (at + 0.1 * unit, at + 0.9 * unit, True),
            (a_turn_up - 0.9 * unit, a_turn_up + 0.1, False),
        ):
            limits[joint] = low, high
            pose = solve(points[joint], phi[joint], hand=q[joint], tool=TOOL, width=width, limits=limits)
            assert pose.over_limit[0].tolist() == [k == joint and over for k in range(7)]


@pytest.mark.parametrize("axis", ["z", (0.3, 1.0, -0.2)])
@pytest.mark.parametrize("seed", [2, 3])
def test_feasible_swivels_are_those_of_a_grid(seed, axis):
    """Compare intervals with a grid of angles in random branches; at each end of an interval a joint is at a limit."""
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


def path(count=3000):
    """Return joints (N, 7) of a smooth path; some joints make several turns."""
    random, t = np.random.default_rng(5), np.linspace(0, 1, count)[:, None]
    return 1.2 * np.sin(4 * t * random.uniform(0.5, 2, 7) + random.uniform(0, 6, 7)) + t * (15, 0, 0, 0, -9, 0, 20)


def test_path_without_jumps():
    smooth, branch = path(), np.random.default_rng(1).integers(0, 8, 3000)
    scrambled = np.angle(np.exp(1j * branches_of(smooth)[branch, np.arange(3000)]))
    scrambled[[7, 8, 1500], [0, 3, 6]] = np.nan
    joined, present = continuous_core_angles(scrambled), np.isfinite(scrambled).all(axis=1)
    np.testing.assert_array_equal(joined[~present], scrambled[~present])
    np.testing.assert_allclose(joined[0], scrambled[0], rtol=0, atol=1e-12)
    turns = (joined[present] - branches_of(smooth)[branch[0], present]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns[:1]).repeat(2997, axis=0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("first", "tilt"), [(4, 0.0), (4, np.pi), (0, 0.0), (0, np.pi)])
def test_singular_stretch_keeps_the_first_joint(first, tilt):
    """Check that only the third angle moves while only the sum of the first and third angle counts."""
    smooth, rows = path(), slice(1000, 2000)
    smooth[rows, first + 1], smooth[rows, first] = tilt, smooth[999, first]
    split, share = smooth.copy(), np.random.default_rng(1).uniform(-9, 9, 1000)
    split[rows, first] += share
    split[rows, first + 2] += share if tilt else -share
    np.testing.assert_allclose(chain(split)[1], chain(smooth)[1], atol=1e-13)
    joined = continuous_core_angles(np.angle(np.exp(1j * split)))[rows]
    np.testing.assert_allclose(joined[:, first], joined[0, first], rtol=0, atol=1e-12)
    off = (joined - smooth[rows])[:, first + 2] / (2 * np.pi)
    np.testing.assert_allclose(off, off[0].round(), rtol=0, atol=1e-12)

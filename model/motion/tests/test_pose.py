# SPDX-License-Identifier: Apache-2.0
"""Test solving wrist targets and hand poses from Python, in any frame, in double precision and in the core's words.
Test the reference axis. Forward kinematics of the seven joints is independent: it uses scipy's rotations."""

import re
import warnings
from functools import partial
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from model import continuous, feasible_swivel, forward, hanging, soft_reach, solve, swivel, swivel_toward
from model.bounds import tolerances
from model.dataflow import fixed
from model.io.flags import Flag
from model.io.words import Targets, result_values, to_words
from model.motion.swivels import continuous_core_angles, elbow_jumps
from model.reference.joints import UNIT, turned
from model.reference.kinematics import NAMED_AXES, direction, matrix, multiply, parse_axis, rotate, to_z

AXES = [*NAMED_AXES, (0.3, 1.0, 0.0), (0.0, -1.0, 1.0)]
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
    """Check the hands by forward kinematics: points to 1e-14 times the reach, orientations to 1e-14 in each element."""
    to_core = matrix(to_z(axis))
    point, m = chain(pose.joints, tool)
    for reached in (point @ to_core, pose.hand):
        np.testing.assert_allclose(reached, points, rtol=0, atol=1e-14 * (D1 + D2 + tool))
    np.testing.assert_allclose(to_core.T @ m, matrix(hand), rtol=0, atol=1e-14)


def apart(a, b):
    """Return the absolute difference of angles, at most pi."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(a) - b))))


POINTS, PHI = wrists(500)


@pytest.mark.parametrize(("axis", "datapath"), [*((axis, "lean") for axis in AXES), *((a, "paper") for a in AXES[-2:])])
def test_wrist_and_swivel_in_the_users_frame(axis, datapath):
    pose = solve(POINTS, PHI, axis=axis, datapath=datapath)
    assert (pose.flags == 0).all()
    np.testing.assert_allclose(pose.wrist, POINTS, atol=1e-9 if datapath == "paper" else 1e-14)
    np.testing.assert_allclose(np.linalg.norm(pose.elbow, axis=1), D1, atol=1e-14)
    accuracy = 1e-7 if datapath == "paper" else 1e-12
    assert apart(swivel((1, 2, 0), pose.elbow + (1, 2, 0), pose.wrist + (1, 2, 0), axis), PHI).max() <= accuracy
    # Definition of phi: a right-handed turn about the line to the wrist, from the half plane in which the axis points.
    unit = POINTS / np.linalg.norm(POINTS, axis=1)[:, None]
    zero = solve(POINTS, 0, axis=axis, datapath=datapath).elbow
    assert ((zero - (zero * unit).sum(axis=1)[:, None] * unit) @ direction(axis) > 0).all()
    about = np.column_stack((np.cos(PHI / 2), np.sin(PHI / 2)[:, None] * unit))
    np.testing.assert_allclose(rotate(about, zero), pose.elbow, atol=accuracy)


@pytest.mark.parametrize("datapath, width", [("lean", 18), ("lean", 32), ("lean25", 18), ("paper", 18), ("paper", 32)])
def test_a_width_gives_the_words_of_the_core(datapath, width):
    points = POINTS.copy()
    points[:50] *= 2
    points[50, :2] = 0
    words, _ = to_words(Targets("t", *points.T, PHI, D1, D2), width)
    run = fixed.run(words, width, datapath)
    results = result_values(run.results, width)
    pose = solve(points, PHI, width=width, datapath=datapath)
    assert (pose.flags == run.flags).all() and set(pose.flags) >= {0, Flag.TOO_FAR, Flag.ON_AXIS}
    assert (pose.qs == results[:, :4]).all()
    assert (pose.qe == np.pad(results[:, 4:], ((0, 0), (0, 2)))).all()


@pytest.mark.parametrize("axis", NAMED_AXES)
def test_a_named_axis_loses_no_bit(axis):
    """Check that words are only permuted, and that Qs, whose components are half sums of four words, is exact."""
    r = to_z(axis)
    ours, core = solve(POINTS, PHI, axis=axis, width=32), solve((matrix(r) @ POINTS.T).T, PHI, width=32)
    assert (multiply(r, ours.qs) == core.qs).all() and (ours.qe == core.qe).all()
    assert np.linalg.norm(ours.wrist - POINTS, axis=1).max() / (D1 + D2) <= tolerances.LEAN[32]


def test_without_phi_the_elbow_hangs():
    for axis, phi in (("z", np.pi), ("-z", 0), ("y", -np.pi / 2), ("-y", np.pi / 2)):
        assert hanging(axis) == pytest.approx(phi)
        elbow = solve((0.4, 0, 0), axis=axis).elbow[0]
        assert elbow[2] < -0.1 and abs(elbow[1]) < 1e-12


def test_order_and_scipy():
    first, last = solve(POINTS, PHI), solve(POINTS, PHI, order="xyzw")
    assert (np.roll(last.qs, 1, axis=1) == first.qs).all() and (np.roll(last.qe, 1, axis=1) == first.qe).all()
    for pose in (first, last):
        joints = forward(pose.qs, pose.qe, D1, D2, order=pose.order)
        np.testing.assert_allclose(joints, (pose.elbow, pose.wrist), atol=1e-15)
        shoulder, elbow = pose.to_scipy()
        assert isinstance(shoulder, Rotation)
        np.testing.assert_allclose(shoulder.apply((0, 0, D1)), pose.elbow, atol=1e-14)
        np.testing.assert_allclose(shoulder.apply((0, 0, D1) + elbow.apply((0, 0, -D2))), pose.wrist, atol=1e-14)


def test_continuous():
    """Check that ``continuous`` changes only signs, and that an arm's quaternions then do not jump from row to row,
    even if rows of two arms alternate."""
    t = np.linspace(0, 2 * np.pi, 400)
    circle = np.column_stack((0.1 * np.cos(t), 0.35 + 0.1 * np.sin(t), 0.2 * np.sin(t / 2)))
    other = np.random.default_rng(3).permutation(circle)
    points, arm = np.stack((circle, other), axis=1).reshape(-1, 3), np.tile(("left", "right"), 400)
    q = solve(points, t.repeat(2)).qs
    smooth = continuous(q, arm)
    assert (np.abs(smooth) == np.abs(q)).all() and (smooth[0] == q[0]).all()
    before, after = (np.linalg.norm(np.diff(of[arm == "left"], axis=0), axis=1).max() for of in (q, smooth))
    assert before > 1.9 and after < 0.2
    assert (smooth == np.roll(continuous(np.roll(q, -1, axis=1), arm), 1, axis=1)).all()
    assert continuous(np.zeros((0, 4))).shape == (0, 4) and (continuous(q[0]) == q[0]).all()
    gaps = np.insert(q, np.arange(1, 800, 2), np.nan, axis=0)
    np.testing.assert_array_equal(continuous(gaps)[~np.isnan(gaps[:, 0])], continuous(q))


@pytest.mark.parametrize("width", [None, 24])
def test_rows_of_nan_pass_and_none_is_solved(width, monkeypatch):
    """Check that rows of nan do not change a bit of the other rows, in chunks of any size."""
    points, phi = POINTS.copy(), PHI.copy()
    points[[3, 70]], phi[9], there = np.nan, np.nan, np.delete(np.arange(len(phi)), [3, 9, 70])
    settings = {"width": width, "order": "xyzw", "axis": (0, -1, 1)}
    alone = solve(points[there], phi[there], **settings)
    monkeypatch.setattr("model.motion.pose.CHUNK", 7)
    monkeypatch.setattr("model.motion.pose.LONG_CHUNK", 100)
    passed = solve(points, phi, nan="pass", **settings)
    for name in ("qs", "qe", "flags", "elbow", "wrist", "phi"):
        values = getattr(passed, name)
        np.testing.assert_array_equal(values[there], getattr(alone, name), err_msg=name)
        assert (np.isnan(values[[3, 9, 70]]) if name != "flags" else values[[3, 9, 70]] == 0).all()
    for empty in ([], np.zeros((0, 3))):
        assert solve(empty, width=width).wrist.shape == (0, 3)
    assert np.isnan(solve((np.nan, 0, 0), width=width, nan="pass").qs).all()


def test_angles_of_degrees_warn():
    with pytest.warns(UserWarning, match="phi reaches 90; its unit is the radian"):
        solve((0.3, 0, 0), 90)


def test_elbow_points_at_the_pole(axis=(0.3, 1.0, 0.0)):
    """Check that changing the angle from ``swivel_toward`` moves the elbow away from the pole."""
    pole = np.random.default_rng(4).normal(size=POINTS.shape)
    phi = swivel_toward(POINTS, pole, axis)
    best, *others = (np.linalg.norm(solve(POINTS, phi + by, axis=axis).elbow - pole, axis=1) for by in (0, 1e-3, -1e-3))
    assert (best < np.minimum(*others)).all()
    assert np.isfinite(swivel_toward((0, 0, 0), pole, axis)).all()


def test_soft_reach_is_smooth_and_stays_in_reach():
    distance = np.linspace(0.01, 1.5, 30000)
    points = np.outer(distance, (0.6, 0.0, 0.8))
    soft = np.linalg.norm(soft_reach(points, D1, D2, 0.05), axis=1)
    near = distance <= 0.95 * 0.6
    np.testing.assert_allclose(soft[near], distance[near], rtol=1e-15)
    assert (np.diff(soft) > -1e-15).all() and soft[-1] <= 0.6 and soft[distance.searchsorted(0.6)] < 0.595
    assert np.abs(np.diff(np.diff(soft) / np.diff(distance))).max() < 0.01, "no kink"
    np.testing.assert_allclose(np.cross(soft_reach(points), points), 0, atol=1e-12)
    assert (soft_reach(points, soft=0) == points).all()
    with pytest.raises(ValueError, match="soft 2 is not in 0 to 1"):
        soft_reach(points, soft=2)


@pytest.mark.parametrize(("aside", "rows"), [(0.001, [150, 151, 152]), (0.2, [])])
def test_elbow_jumps_are_found_with_a_better_axis(aside, rows):
    path = np.linspace(-0.3, 0.3, 302), aside, 0.4
    jumps, better = elbow_jumps(Targets("path", *path, np.pi, D1, D2))
    assert jumps.tolist() == rows
    assert not len(elbow_jumps(Targets("path", *path, hanging(better), D1, D2, frame=to_z(better)))[0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points": (1, 2)}, r"shape \(2,\)"),
        ({"points": np.full((9, 3), np.nan)}, "points: not finite in rows 0, 1, 2 and 6 more$"),
        ({"phi": np.inf, "nan": "pass"}, "phi: not finite"),
        ({"d1": [0.3, -1]}, "d1: not positive in row 1$"),
        ({"nan": "skip"}, "nan 'skip'"),
        ({"width": 33}, "width 33 must be None or one of 16, "),
        ({"datapath": "thin"}, "datapath 'thin' is none of"),
        ({"order": "wxzy"}, "order 'wxzy'"),
        ({"points": np.zeros((3, 3)), "phi": np.zeros(2)}, "points has 3, phi has 2, d1 has 1"),
        ({"points": (100, 0, 0), "width": 32}, "too far out"),
        ({"hand": UNIT, "width": 32, "datapath": "paper"}, "datapath 'paper': with hand and width it must be 'lean'"),
        ({"hand": UNIT, "width": 32, "tool": 20.0}, "column tool: .20.0. is too long"),
    ],
)
def test_refuses(arguments, message):
    with pytest.raises(ValueError, match=message):
        solve(**{"points": (0.1, 0.2, 0.3), **arguments})
    with pytest.raises(ValueError, match=r"shape \(1, 2\)"):
        forward(np.ones((1, 4)), np.ones((1, 2)))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"hand": [UNIT, (0, 0.99, 0, 0)]}, "hand: length 0.99, not 1, in row 1"),
        ({"hand": (1.0, 0.0, 0.0)}, r"hand has the shape \(3,\)"),
        ({"branch": 8}, "branch 8 is not a combination of SHOULDER, ELBOW, WRIST"),
        ({"branch": 1.5}, "branch 1.5"),
        ({"limits": LIMITS[:6]}, r"limits have the shape \(6, 2\)"),
        ({"limits": [*LIMITS[:4], (1.0, 0.5), *LIMITS[5:]]}, "limits of joint 5: 1 to 0.5"),
        ({"tool": np.inf}, "tool: not finite"),
        ({"hand": (np.nan, 0.0, 0.0, 1.0)}, "hand and tool: not finite in row 0"),
        ({"order": "ijkw"}, "order 'ijkw'"),
    ],
)
def test_refused_hands(changes, message):
    for function in (solve, feasible_swivel):
        with pytest.raises(ValueError, match=message):
            function(**{"points": (0.2, 0.2, 0.2), "hand": UNIT, **changes})


SLANTED = [(0.3, 1, 0), (0, -1, 1), (1e-9, 0, -1), (0, 1e-200, 1), (1e200, 1e200, 0), (5e-324, 0, 0), (-3, -2, -1)]


@pytest.mark.parametrize("axis", [*NAMED_AXES, *SLANTED])
def test_axis_becomes_z(axis):
    q, m = to_z(axis), matrix(to_z(axis))
    np.testing.assert_allclose(m @ m.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(m @ direction(axis), (0, 0, 1), atol=4e-16)
    assert np.linalg.det(m) == pytest.approx(1)
    if axis in NAMED_AXES:
        assert (np.sort(np.abs(m), axis=1) == (0, 0, 1)).all() and (m @ direction(axis) == (0, 0, 1)).all()
        assert set(np.abs(q) * 2) <= {0, 1, 2}


def test_parse_axis():
    assert parse_axis("-x") == "-x" and parse_axis(" 0, -1e3 ,2") == (0, -1e3, 2)
    for axis in ("", "+z", "1,2", "0,0,0", "1,nan,0", "a,b,c", None, ("a", 1, 2), [[1, 2, 3]]):
        with pytest.raises(ValueError, match=f"^axis {re.escape(repr(axis))} must be z, "):
            (parse_axis if isinstance(axis, str) else direction)(axis)


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
    """Check hands, but flags only of bent arms: rounding moves some targets of straight or closed arms out of reach."""
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
    """Test an empty array, and targets too far, too near, beyond an elbow limit, or out of reach by rounding."""
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
    nowhere = feasible_swivel(points[:0], q[:0], tool=TOOL, limits=LIMITS)
    assert nowhere.feasible.shape == nowhere.nearest().shape == nowhere.nearest(0.1).shape == (0,)
    none = solve(points[:0], 0.1, hand=q[:0], limits=LIMITS).joints
    assert none.shape == continuous_core_angles(none).shape == (0, 7)


@pytest.mark.parametrize(("axis", "order"), [("z", "xyzw"), ("-x", "wxyz"), ((0.3, 1.0, -0.2), "xyzw")])
@pytest.mark.parametrize(("width", "off"), [(18, 3e-4), (32, 3e-8)])
def test_words_are_near_the_pose_in_double(width, off, axis, order):
    """Compare flags, points, hands and limits in words and in double precision, for all branches and rows of nan."""
    points, q, phi = poses(300, 5)
    gone, tool, branch = [7, 9, 11, 13], np.full(300, TOOL), np.arange(300) % 8
    points[7] = tool[9] = phi[11] = q[13, 2] = np.nan
    hand = q if order == "wxyz" else np.roll(q, -1, axis=1)
    arguments = {"hand": hand, "tool": tool, "branch": branch, "axis": axis, "order": order, "nan": "pass"}
    double = solve(points, phi, limits=LIMITS, **arguments)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        words = solve(points, phi, limits=LIMITS, width=width, **arguments)
    np.testing.assert_array_equal(words.flags, double.flags)
    for name in ("hand", "wrist", "elbow"):
        np.testing.assert_allclose(getattr(words, name), getattr(double, name), rtol=0, atol=4 * off)
    # near a singular pose only the sums of angles are the same: compare hands
    keep = np.delete(np.arange(300), gone)
    for pose in (words, double):
        assert all(np.isnan(getattr(pose, name)[gone]).all() for name in ("joints", "qw", "hand", "qs"))
        assert not pose.flags[gone].any() and not pose.over_limit[gone].any()
        reached, m = chain(pose.joints[keep])
        np.testing.assert_allclose(reached @ matrix(to_z(axis)), points[keep], rtol=0, atol=off)
        np.testing.assert_allclose(matrix(to_z(axis)).T @ m, matrix(q[keep]), rtol=0, atol=3 * off)
    clear = apart(words.joints[keep, :, None], LIMITS).min(axis=-1) > 100 * off
    assert (words.over_limit[keep] == double.over_limit[keep])[clear].all() and clear.mean() > 0.8


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

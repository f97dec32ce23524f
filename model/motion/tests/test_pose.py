# SPDX-License-Identifier: Apache-2.0
"""Test poses from Python, in any frame, in double precision and in the core's words; test the reference axis."""

import re

import numpy as np
import pytest

from model import continuous, forward, hanging, soft_reach, solve, swivel, swivel_toward
from model.bounds import tolerances
from model.dataflow import fixed
from model.io.flags import Flag
from model.io.words import Targets, result_values, to_words
from model.motion.pose import NAMED_AXES, direction, elbow_jumps, parse_axis, to_z
from model.motion.tests.test_joints import apart, wrists
from model.reference.kinematics import matrix, multiply, rotate

AXES = [*NAMED_AXES, (0.3, 1.0, 0.0), (0.0, -1.0, 1.0)]
D1, D2 = 0.33, 0.27
COUNT = 500


@pytest.fixture(scope="module")
def reachable():
    """Return points (N, 3) and swivel angles (N,) of reachable wrist targets."""
    return wrists(COUNT)


@pytest.mark.parametrize(("axis", "datapath"), [*((axis, "lean") for axis in AXES), *((a, "paper") for a in AXES[-2:])])
def test_wrist_and_swivel_in_the_users_frame(reachable, axis, datapath):
    points, phi = reachable
    pose = solve(points, phi, axis=axis, datapath=datapath)
    assert (pose.flags == 0).all()
    np.testing.assert_allclose(pose.wrist, points, atol=1e-9 if datapath == "paper" else 1e-14)
    np.testing.assert_allclose(np.linalg.norm(pose.elbow, axis=1), D1, atol=1e-14)
    accuracy = 1e-7 if datapath == "paper" else 1e-12
    assert apart(swivel((1, 2, 0), pose.elbow + (1, 2, 0), pose.wrist + (1, 2, 0), axis), phi).max() <= accuracy
    # Definition of phi: a right-handed turn about the line to the wrist, from the half plane in which the axis points.
    unit = points / np.linalg.norm(points, axis=1)[:, None]
    zero = solve(points, 0, axis=axis, datapath=datapath).elbow
    assert ((zero - (zero * unit).sum(axis=1)[:, None] * unit) @ direction(axis) > 0).all()
    about = np.column_stack((np.cos(phi / 2), np.sin(phi / 2)[:, None] * unit))
    np.testing.assert_allclose(rotate(about, zero), pose.elbow, atol=accuracy)


@pytest.mark.parametrize("datapath, width", [("lean", 18), ("lean", 32), ("lean25", 18), ("paper", 18), ("paper", 32)])
def test_a_width_gives_the_words_of_the_core(reachable, datapath, width):
    points, phi = reachable[0].copy(), reachable[1]
    points[:50] *= 2
    points[50, :2] = 0
    words, _ = to_words(Targets("t", *points.T, phi, D1, D2), width)
    run = fixed.run(words, width, datapath)
    results = result_values(run.results, width)
    pose = solve(points, phi, width=width, datapath=datapath)
    assert (pose.flags == run.flags).all() and set(pose.flags) >= {0, Flag.TOO_FAR, Flag.ON_AXIS}
    assert (pose.qs == results[:, :4]).all()
    assert (pose.qe == np.pad(results[:, 4:], ((0, 0), (0, 2)))).all()


@pytest.mark.parametrize("axis", NAMED_AXES)
def test_a_named_axis_loses_no_bit(reachable, axis):
    """Check that words are only permuted; components of Qs are sums of four words over 2, exact in a double."""
    points, phi = reachable
    r = to_z(axis)
    there = (matrix(r) @ points.T).T
    assert (np.sort(np.abs(there)) == np.sort(np.abs(points))).all()
    ours, core = solve(points, phi, axis=axis, width=32), solve(there, phi, width=32)
    assert (multiply(r, ours.qs) == core.qs).all() and (ours.qe == core.qe).all()
    assert np.linalg.norm(ours.wrist - points, axis=1).max() / (D1 + D2) <= tolerances.LEAN[32]


def test_without_phi_the_elbow_hangs():
    for axis, phi in (("z", np.pi), ("-z", 0), ("y", -np.pi / 2), ("-y", np.pi / 2)):
        assert hanging(axis) == pytest.approx(phi)
        elbow = solve((0.4, 0, 0), axis=axis).elbow[0]
        assert elbow[2] < -0.1 and abs(elbow[1]) < 1e-12


def test_numbers_broadcast():
    random = np.random.default_rng(2)
    points, d1 = random.uniform(-0.2, 0.2, (7, 3)), random.uniform(0.3, 0.4, 7)
    many = solve(points, 1.0, d1, 0.3)
    for n in range(7):
        assert (solve(points[n], 1.0, d1[n], 0.3).qs == many.qs[n]).all()
    assert many.qs.shape == many.qe.shape == (7, 4) and many.flags.shape == (7,) and many.elbow.shape == (7, 3)
    assert solve(points[0], np.arange(3)).qs.shape == (3, 4)


def test_order_and_scipy(reachable):
    transform = pytest.importorskip("scipy.spatial.transform")
    points, phi = reachable
    first, last = solve(points, phi), solve(points, phi, order="xyzw")
    assert (np.roll(last.qs, 1, axis=1) == first.qs).all() and (np.roll(last.qe, 1, axis=1) == first.qe).all()
    for pose in (first, last):
        joints = forward(pose.qs, pose.qe, D1, D2, order=pose.order)
        np.testing.assert_allclose(joints, (pose.elbow, pose.wrist), atol=1e-15)
        shoulder, elbow = pose.to_scipy()
        assert isinstance(shoulder, transform.Rotation)
        np.testing.assert_allclose(shoulder.apply((0, 0, D1)), pose.elbow, atol=1e-14)
        np.testing.assert_allclose(shoulder.apply((0, 0, D1) + elbow.apply((0, 0, -D2))), pose.wrist, atol=1e-14)


def test_continuous():
    """Check that ``continuous`` changes only signs, and that the quaternions of an arm then do not jump from row to
    row, even if rows of two arms alternate."""
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
def test_rows_of_nan_pass_and_none_is_solved(reachable, width, monkeypatch):
    """Check that rows of nan do not change a bit of the other rows, in chunks of any size."""
    points, phi = reachable[0].copy(), reachable[1].copy()
    points[[3, 70]], phi[9], there = np.nan, np.nan, np.delete(np.arange(COUNT), [3, 9, 70])
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


def test_elbow_points_at_the_pole(reachable, axis=(0.3, 1.0, 0.0)):
    """Check that with other swivel angles the elbow is farther from the pole."""
    points, _ = reachable
    pole = np.random.default_rng(4).normal(size=(COUNT, 3))
    phi = swivel_toward(points, pole, axis)
    best, *others = (np.linalg.norm(solve(points, phi + by, axis=axis).elbow - pole, axis=1) for by in (0, 1e-3, -1e-3))
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
    ],
)
def test_refuses(arguments, message):
    with pytest.raises(ValueError, match=message):
        solve(**{"points": (0.1, 0.2, 0.3), **arguments})
    with pytest.raises(ValueError, match=r"shape \(1, 2\)"):
        forward(np.ones((1, 4)), np.ones((1, 2)))


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

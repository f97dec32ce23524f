# SPDX-License-Identifier: Apache-2.0
"""Test robots from URDF files and built-in robots against products of the joints' rotations along the chain; in release
tests, also against pinocchio's forward kinematics and the poses that ssik solves within the limits."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from model.motion.arms import HUMAN, IIWA14, ROBOTS, Arm
from model.motion.tests.test_path import check, curve, followed
from model.reference.kinematics import matrix

O, X, Y, Z = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
DOWN, RIGHT = (0, 0, -1), (0, -1, 0)
TIP = ((0.02, 0.03, 0.1), (0.1, 0.2, 0.3))


def bones(axes, shoulder=(0, 0, 0.3), elbow=(0, 0, 0.42), wrist=(0, 0, 0.4), rpy=O):
    """Return a chain: for each joint its position and rpy angles in the frame of the previous joint, and its axis."""
    places = [(shoulder, rpy), (O, O), (O, O), (elbow, O), (wrist, O), (O, O), (O, O)]
    return [(*place, axis) for place, axis in zip(places, axes, strict=True)]


SERIAL = (Z, Y, Z, RIGHT, Z, Y, Z)
IIWA = bones(SERIAL)
CHAINS = {
    "iiwa": IIWA,
    "human": bones((Y, X, Z, Y, Z, Y, X), (0.1, 0.2, 1.4), (0, 0, -0.3), (0, 0, -0.25), (0.3, -0.2, 0.5)),
    "reversed": bones((DOWN, RIGHT, DOWN, RIGHT, DOWN, Y, DOWN), rpy=(0.1, 0.2, 0.3)),
    "long axes": bones((Z, Y, (0, 0, 2.5), Y, Z, (-3, 0, 0), Z)),
    "bent": bones((Z, Y, Z, Y, Z, Y, Z), elbow=(0.045, 0, 0.55), wrist=(-0.045, 0, 0.3)),
    "across": bones((Z, X, Y, Z, Y, X, Z), elbow=(0.3, 0, 0), wrist=(0.25, 0, 0)),
}


def urdf(path, chain, tip=TIP, limits=((-2.9, 2.9),) * 7, kind="revolute"):
    """Write a URDF from link base through l1, l2, ... to tip; joints without limits are `continuous`."""
    text, links = '<robot name="r">', ["base", *(f"l{n}" for n in range(1, 8)), "tip"]
    for n, (xyz, rpy, axis) in enumerate([*chain, (*tip, Z)]):
        low, high = n < 7 and limits[n] or (None, None)
        bound = "" if low is None else f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/>'
        sort = "fixed" if n == 7 else kind if bound else "continuous"
        xyz, rpy, axis = (" ".join(map(str, v)) for v in (xyz, rpy, axis))
        text += f"""<joint name="j{n + 1}" type="{sort}"><parent link="{links[n]}"/><child link="{links[n + 1]}"/>
            <origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{bound}</joint>"""
    path.write_text(text + "".join(f'<link name="{link}"/>' for link in links) + "</robot>")
    return path


def tips(chain, th, tip=TIP):
    """Return points (N, 3) and orientations (N, 3, 3) of the tip for joints (N, 7)."""
    point, turn = np.zeros((len(th), 3)), Rotation.identity(len(th))
    for (xyz, rpy, axis), angle in zip([*chain, (*tip, Z)], [*th.T, 0 * th[:, 0]], strict=True):
        point = point + turn.apply(xyz)
        about = Rotation.from_rotvec(np.outer(angle, np.array(axis) / np.linalg.norm(axis)))
        turn = turn * Rotation.from_euler("xyz", rpy) * about
    return point, turn.as_matrix()


def assert_same(one, other, atol):
    """Compare two pairs (points, matrices), (N, 3) and (N, 3, 3). ``one`` may have quaternions (N, 4) instead."""
    np.testing.assert_allclose(one[0], other[0], rtol=0, atol=atol)
    np.testing.assert_allclose(matrix(one[1]) if one[1].shape[1] == 4 else one[1], other[1], rtol=0, atol=atol)


@pytest.mark.parametrize("name", CHAINS)
def test_urdf_and_back(name, tmp_path):
    chain, random = CHAINS[name], np.random.default_rng(4)
    limits = [(-0.35, 5.6), (-2.4, 2.4), (-2.6, 2.7), (-2.3, 2.3), None, (-2.2, 2.3), (-5.8, 0.35)]
    arm = Arm.from_urdf(urdf(tmp_path / "arm.urdf", chain, limits=limits))
    assert arm.names == tuple(f"j{n}" for n in range(1, 8))
    np.testing.assert_array_equal(arm.limits, [limit or (-np.inf, np.inf) for limit in limits])
    th, (low, high) = random.uniform(-2, 2, (300, 7)), arm.limits.T + [[-1e-8], [1e-8]]
    (points, m), (_, q) = tips(chain, th), arm.forward(th)
    assert_same(arm.forward(th), (points, m), 1e-14)
    for branch in range(8):
        pose = arm.solve(points, q, random.uniform(-3, 3, 300), branch)
        assert_same(tips(chain, pose.joints), (points, m), 1e-13)
        np.testing.assert_allclose(pose.hand, points, rtol=0, atol=1e-13)
        np.testing.assert_array_equal(pose.over_limit, (pose.joints < low) | (pose.joints > high))
        chosen = arm.feasible_swivel(points, q, branch).nearest(0.4)
        some = np.isfinite(chosen)
        safe = arm.solve(points[some], q[some], chosen[some], branch).joints
        assert some.mean() > 0.2 and ((safe >= low) & (safe <= high)).all()


def moved(joint, xyz=None, axis=None):
    chain = list(IIWA)
    chain[joint] = (xyz or chain[joint][0], O, axis or chain[joint][2])
    return chain


FLOATING = ('revolute"><parent link="base', 'floating"><parent link="base')  # an arm on a body that moves
TWO_ENDS = ("</robot>", '<joint name="j9" type="fixed"><parent link="l7"/><child link="end"/></joint></robot>')


@pytest.mark.parametrize(
    ("chain", "given", "message"),
    [
        (moved(6, (0.088, 0, 0)), {}, "axes 5 to 7, of the wrist, do not meet in one point: they miss it"),
        (moved(1, (0.03, 0, 0)), {}, "axes 1 to 3, of the shoulder, do not meet in one point: they miss it"),
        (moved(1, axis=(0, 1, 1)), {}, "axes 1 and 2 are 45 degrees apart, not 90"),
        (moved(3, O), {}, "axis 4 passes through the shoulder"),
        (moved(4, (0, 0.01, 0.4)), {}, "0.01 apart along axis 4"),
        (moved(2, axis=O), {}, "joint j3 has the axis 0 0 0"),
        (moved(2, axis=(1, 2)), {}, "joint j3: axis xyz '1 2'"),
        (IIWA, {"tip": "l6"}, "expected 7 moving joints between base and l6, got 6"),
        (IIWA, {"kind": "prismatic"}, "joint j1 is prismatic"),
        (IIWA, {"limits": [(1, 2), (3, 2), *[(1, 2)] * 5]}, "limits of joint 2: 3 to 2"),
        (IIWA, {"replaced": ("</robot>", "")}, "not a URDF"),
        (IIWA, {"replaced": (' type="fixed"', "")}, "not a URDF"),
        (IIWA, {"replaced": ('"l7"', '"tip"')}, "no chain of joints"),  # a joint is its own parent
        (IIWA, {"replaced": ("<axis", '<mimic joint="j2"/><axis')}, "joint j1 mimics j2"),
        (IIWA, {"replaced": ("0 0 0.42", "0 0 ${d1}")}, r"joint j4: origin xyz '0 0 \$\{d1\}' is not 3 numbers"),
        (IIWA, {"replaced": FLOATING, "base": None}, "expected 7 moving joints between l1 and tip, got 6"),
        (IIWA, {"replaced": TWO_ENDS, "tip": None}, "no unique link for tip: end, tip; choose with TIP="),
    ],
)
def test_refused_chains(chain, given, message, tmp_path):
    path = urdf(tmp_path / "arm.urdf", chain, **{k: v for k, v in given.items() if k in ("kind", "limits")})
    path.write_text(path.read_text().replace(*given.get("replaced", ("", ""))))
    with pytest.raises(ValueError, match=f"arm.urdf: .*{message}"):
        Arm.from_urdf(path, given.get("base", "base"), given.get("tip", "tip"))


def test_files_with_more_than_the_arm(tmp_path):
    """Check that a floating joint above the arm and joints inside a simulator's element are ignored."""
    path = urdf(tmp_path / "arm.urdf", IIWA)
    plain, text = Arm.from_urdf(path), path.read_text()
    loop = '<gazebo><joint name="x" type="revolute"><parent>l7</parent><child>l6</child></joint></gazebo>'
    world = '<link name="w"/><joint name="f" type="floating"><parent link="w"/><child link="base"/></joint>'
    path.write_text(text.replace("</robot>", f"{loop}{world}</robot>"))
    more = Arm.from_urdf(path)
    assert more.names == plain.names and more.velocities.tolist() == [1.0] * 7
    np.testing.assert_array_equal(more.forward(np.ones(7))[0], plain.forward(np.ones(7))[0])


def test_orientations_in_other_forms():
    """Check that Rotations and matrices (3, 3) or (4, 4) act like quaternions, and that other matrices are refused."""
    points, q = IIWA14.forward(np.random.default_rng(8).uniform(-1.5, 1.5, (20, 7)))
    whole = np.tile(np.eye(4), (20, 1, 1))
    whole[:, :3, :3] = matrix(q)
    expected = IIWA14.solve(points, q, 0.3, 0).joints
    for hand in (Rotation.from_quat(q, scalar_first=True), matrix(q), whole):
        np.testing.assert_allclose(IIWA14.solve(points, hand, 0.3, 0).joints, expected, atol=1e-12)
    for hand in (matrix(q)[0], q[0]):
        np.testing.assert_allclose(IIWA14.solve(points[0], hand, 0.3, 0).joints, expected[:1], atol=1e-12)
    for wrong in (matrix(q) * 1.1, -matrix(q), matrix(q) + np.nan):
        with pytest.raises(ValueError, match="hand: not a rotation matrix in rows 0, 1, 2 and 17 more"):
            IIWA14.solve(points, wrong)


OFFSET = moved(1, (0.00044, 0, 0))  # axes 1 and 2 miss each other by 0.44 mm
ANGLE = bones(SERIAL, rpy=(0.0002, 0, 0))[:1] + [(O, (0.00002, 0, 0), Y), *IIWA[2:]]  # 0.001 degrees off


@pytest.mark.parametrize(("chain", "warned"), [(OFFSET, True), (ANGLE, False)], ids=["offset", "angle"])
def test_nearly_exact_arms(chain, warned, tmp_path, recwarn):
    """Check that joints reach the pose on the file's chain, within the limits, also if the arm is almost straight."""
    arm, random = Arm.from_urdf(urdf(tmp_path / "arm.urdf", chain)), np.random.default_rng(1)
    assert 0 < max(arm.misfit) < 1e-3 and any("at the tip" in str(w.message) for w in recwarn) == warned
    th = random.uniform(-2.9, 2.9, (300, 7))
    th[:100, 3] *= 0.01
    points, m = tips(chain, th)
    assert_same(arm.forward(th), (points, m), 1e-12)
    q = arm.forward(th)[1]
    for pose in (arm.solve(points, q), arm.solve(points, q, near=th)):
        assert not pose.over_limit.any()
        check(arm, pose.joints, points, q, 1e-9)
    for kind, seed in (("line", 8), ("sine", 3)):  # almost straight rows that one branch of the shoulder does not reach
        path = followed(arm, curve(arm, kind, seed, 200), 1e-9)
        assert path.largest < 0.2 and not path.jumps


def test_corrections_at_limits(tmp_path):
    """Solve almost straight arms with the elbow at its limit; check that path rows reach their poses or are nan."""
    limits = [(-2.9, 2.9)] * 3 + [(0.0, 1.5)] + [(-0.8, 0.8)] * 3
    arm = Arm.from_urdf(urdf(tmp_path / "arm.urdf", ANGLE, limits=limits))
    th = np.random.default_rng(1).uniform(*arm.limits.T, (1000, 7)) * (1, 1, 1, 0.02, 1, 1, 1)
    assert not arm.solve(*arm.forward(th)).over_limit.any()
    with pytest.warns(UserWarning, match="at the tip"):
        arm = Arm.from_urdf(urdf(tmp_path / "arm.urdf", OFFSET, limits=limits))
    for seed in (7, 16):
        points, q = arm.forward(curve(arm, "sine", seed, 60, 1.0))
        joined = arm.path(points, q).joints
        some = np.isfinite(joined).all(axis=1)
        check(arm, joined[some], points[some], q[some], 1e-9)


IIWA14_CHAIN, FLANGE = bones(SERIAL, (0, 0, 0.36)), ((0, 0, 0.126), O)


def test_iiwa14():
    th = np.random.default_rng(2).uniform(*IIWA14.limits.T, (200, 7))
    assert_same(IIWA14.forward(th), tips(IIWA14_CHAIN, th, FLANGE), 1e-14)
    assert np.degrees(IIWA14.limits).round(12).tolist() == [[-d, d] for d in (170, 120) * 3 + (175,)]


def test_human():
    def palm(*degrees):
        point, q = HUMAN.forward(np.radians([degrees]))
        return np.concatenate((point, matrix(q)[0].T)).round(12).tolist()  # point, thumb, out of the palm, fingers

    assert palm(0, 0, 0, 0, 0, 0, 0) == [[0, 0, -0.68], [1, 0, 0], [0, -1, 0], [0, 0, -1]]
    assert palm(0, 0, 0, 90, 0, 0, 0)[0] == [0.35, 0, -0.33]
    assert palm(0, 90, 0, 0, 0, 0, 0)[0] == [0, 0.68, 0]
    assert palm(90, 90, 0, 0, 0, 0, 0)[0] == [0.68, 0, 0]
    assert palm(0, 0, 70, 90, 0, 0, 0)[0][1] < -0.3  # inward: to the right
    assert palm(0, 0, 0, 90, 80, 0, 0)[2][2] < -0.9  # pronated: the palm down
    assert palm(0, 0, 0, 0, 0, 80, 0)[0][1] < -0.07 and palm(0, 0, 0, 0, 0, 0, 20)[0][0] > 0.02
    assert ((HUMAN.limits[:, 0] <= 0) & (HUMAN.limits[:, 1] > 0)).all()


NARROW = np.radians([(-40, 60), (-9, 100), (-30, 20), (-9, 100), (-35, 30), (-9, 100), (-25, 45)])


@pytest.mark.parametrize("arm", [IIWA14, HUMAN, Arm(0.33, 0.27, 0.1, limits=NARROW)], ids=["iiwa14", "human", "narrow"])
def test_straight_arms(arm):
    """Test arms with th4 = th6 = 0, so only the sum of th5 and th7 counts; some have th2 = 0 and lie along axis 1."""
    th = np.random.default_rng(4).uniform(*arm.limits.T, (40, 7)) * (1, 1, 1, 0, 1, 0, 1)
    th[:, 1], th[0], th[1:10, 1] = np.abs(th[:, 1]), 0, 0
    points, q = arm.forward(th)
    swivels = arm.feasible_swivel(points, q)
    pose = arm.solve(points, q, swivels.nearest(near=0.5))
    assert swivels.feasible.all() and not pose.over_limit.any()
    assert_same(arm.forward(pose.joints), (points, matrix(q)), 3e-7)
    first, last = np.moveaxis(swivels.intervals, 2, 0)
    for phi in np.linspace(-3.1, 3.1, 60):
        within = (np.mod(phi - first, 2 * np.pi) <= last - first).any(axis=1)
        assert (within == ~arm.solve(points, q, phi, 0).over_limit.any(axis=1)).all()


@pytest.fixture(params=["iiwa14", *(path.stem for path in sorted(ROBOTS.folder.glob("*.urdf")))])
def robot(request, tmp_path):
    """Return a robot's file, its arm, and tip points (200, 3) and orientations (200, 4); the first 100 are feasible."""
    path = ROBOTS.folder / f"{request.param}.urdf"
    if request.param == "iiwa14":
        path = urdf(tmp_path / "iiwa14.urdf", IIWA14_CHAIN, FLANGE, IIWA14.limits.tolist())
    arm, random = Arm.from_urdf(path), np.random.default_rng(7)
    beyond = np.repeat([0.0, 0.3], 100)[:, None]  # rad beyond the limits, so that some poses cannot be solved
    low, high = np.clip(arm.limits.T, -np.pi, np.pi)
    th = random.uniform(low - beyond, high + beyond, (200, 7))
    th[::10, 3] *= 0.01  # almost straight
    return path, arm, *arm.forward(np.where(beyond > 0, th, np.clip(th, low, high)))


@pytest.mark.release
@pytest.mark.needs("arms")
def test_pinocchio_reaches_the_same_tips(robot):
    import pinocchio as pin

    path, arm, points, q = robot
    model = pin.buildModelFromUrdf(str(path))
    data, frame = model.createData(), model.getFrameId("tip")
    pose = arm.solve(points, q)
    solved = np.flatnonzero(~pose.over_limit.any(axis=1))
    assert set(range(100)) <= set(solved.tolist())
    for n in solved:
        pin.framesForwardKinematics(model, data, pose.joints[n])
        np.testing.assert_allclose(data.oMf[frame].translation, points[n], rtol=0, atol=1e-9)
        np.testing.assert_allclose(data.oMf[frame].rotation, matrix(q[n]), rtol=0, atol=1e-9)


@pytest.mark.release
@pytest.mark.needs("arms")
def test_what_ssik_solves_is_solved(robot):
    from ssik import Manipulator

    path, arm, points, q = robot
    other, pose, target, solved = Manipulator.from_urdf(path, base="base", ee="tip"), arm.solve(points, q), np.eye(4), 0
    for n, turn in enumerate(matrix(q)):
        target[:3, :3], target[:3, 3] = turn, points[n]
        answers = other.solve(target, max_solutions=1)
        solved += bool(answers)
        assert not answers or not pose.over_limit[n].any(), f"ssik solves pose {n}: {answers[0].q.tolist()}"
    assert solved > 80

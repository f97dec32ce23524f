# SPDX-License-Identifier: Apache-2.0
"""Compare robots with other solvers: pinocchio's forward kinematics, and which poses ssik solves within the limits."""

import numpy as np
import pytest

from model.motion.arms import IIWA14, ROBOTS, Arm
from model.motion.tests.test_arms import SERIAL, bones, urdf
from model.reference.kinematics import matrix

pytestmark = [pytest.mark.release, pytest.mark.needs("arms")]

BEYOND = 0.3  # rad beyond the limits of half of the poses, so that some cannot be solved


@pytest.fixture(params=["iiwa14", *(path.stem for path in sorted(ROBOTS.folder.glob("*.urdf")))])
def robot(request, tmp_path):
    """Return the file of a robot, its arm, and tips: points (N, 3), orientations (N, 4), 100 in its limits first."""
    path = ROBOTS.folder / f"{request.param}.urdf"
    if request.param == "iiwa14":
        chain, tip = bones(SERIAL, (0, 0, 0.36)), ((0, 0, 0.126), (0, 0, 0))
        path = urdf(tmp_path / "iiwa14.urdf", chain, tip, IIWA14.limits.tolist())
    arm, random = Arm.from_urdf(path), np.random.default_rng(7)
    beyond = np.repeat([0.0, BEYOND], 100)[:, None]
    low, high = np.clip(arm.limits.T, -np.pi, np.pi)
    th = random.uniform(low - beyond, high + beyond, (200, 7))
    th[::10, 3] *= 0.01  # almost straight
    return path, arm, *arm.forward(np.where(beyond > 0, th, np.clip(th, low, high)))


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

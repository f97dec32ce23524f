# SPDX-License-Identifier: Apache-2.0
"""Quaternion arrays and forward kinematics, against layer 1 and against hand-made poses."""

import numpy as np
import pytest

from model.reference import cga, kinematics

ONE, I, J, K = np.eye(4)


def random_quaternions(rng, size):
    q = rng.normal(size=(size, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def test_product_and_rotation_are_those_of_the_algebra():
    rng = np.random.default_rng(1)
    a, b, v = rng.normal(size=(40, 4)), rng.normal(size=(40, 4)), rng.normal(size=(40, 3))
    Q_a, Q_b = cga.quaternion(*a.T), cga.quaternion(*b.T)
    product = np.stack(cga.quaternion_coefficients(Q_a * Q_b), axis=-1)
    np.testing.assert_allclose(kinematics.multiply(a, b), product, atol=1e-13, err_msg="a b")
    turned = cga.rotate(Q_a, cga.vector(*v.T))
    expected = np.stack([cga.coefficient(turned, name) for name in ("e1", "e2", "e3")], axis=-1)
    np.testing.assert_allclose(kinematics.rotate(a, v), expected, atol=1e-12, err_msg="Q v Q~, Q of any length")


def test_one_quaternion_rotates_many_vectors_and_the_other_way_round():
    q = random_quaternions(np.random.default_rng(2), 5)
    v = np.arange(15.0).reshape(5, 3)
    each = np.concatenate([kinematics.rotate(q[n : n + 1], v[:1]) for n in range(5)])
    np.testing.assert_array_equal(kinematics.rotate(q, v[0]), each, err_msg="one vector")
    each = np.concatenate([kinematics.rotate(q[:1], v[n : n + 1]) for n in range(5)])
    np.testing.assert_array_equal(kinematics.rotate(q[0], v), each, err_msg="one quaternion")


@pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-9, 1e-4, 0.7, 3.0, np.pi])
def test_angle_between(angle):
    rng = np.random.default_rng(4)
    a, axis = random_quaternions(rng, 50), rng.normal(size=(50, 3))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    turn = np.concatenate((np.full((50, 1), np.cos(angle / 2)), np.sin(angle / 2) * axis), axis=1)
    b = kinematics.multiply(a, turn)
    tolerance = 1e-15 + 1e-14 * angle
    for what, other in (("b", b), ("-b", -b), ("3 b", 3 * b)):
        np.testing.assert_allclose(
            kinematics.angle_between(a, other), angle, rtol=0, atol=tolerance, err_msg=f"between a and {what}"
        )


def test_poses_made_by_hand():
    turn_x = (np.sqrt(0.5), np.sqrt(0.5), 0, 0)  # a quarter turn, right-handed: z to -y
    poses = {
        "rest: folded back": (ONE, (1, 0), (0, 0, 2), (0, 0, 2 - 0.5)),
        "straight: Qe = -i": (ONE, (0, -1), (0, 0, 2), (0, 0, 2 + 0.5)),
        "elbow at a right angle": (ONE, (np.sqrt(0.5), -np.sqrt(0.5)), (0, 0, 2), (0, -0.5, 2)),
        "straight, shoulder turned": (turn_x, (0, -1), (0, -2, 0), (0, -2.5, 0)),
    }
    for name, (qs, qe, elbow, wrist) in poses.items():
        found = kinematics.forward(qs, qe, 2.0, 0.5)
        np.testing.assert_allclose(found[0], [elbow], atol=1e-15, err_msg=f"{name}: elbow")
        np.testing.assert_allclose(found[1], [wrist], atol=1e-15, err_msg=f"{name}: wrist")

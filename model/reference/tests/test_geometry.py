# SPDX-License-Identifier: Apache-2.0
"""Test layers 1 and 2: blades, entities, quaternions and angles of section 2 of the paper; section 3 as geometry.

Largest measured differences between layers 2 and 3, over 10^4 targets with lengths of about 1: shoulder 3e-12 rad
(3e-14 rad if theta_3 is 0.05 rad or more from 0 and pi), elbow 8e-14 rad, elbow point 2e-14.
"""

import numpy as np
import pytest

from model.reference import cga, equations, geometry, kinematics
from model.reference.cga import e1, e2, e3, e_0, e_inf
from model.reference.tests.test_equations import directions, random_targets

RNG = np.random.default_rng(20080101)
BASIS = {"e1": e1, "e2": e2, "e3": e3, "einf": e_inf, "e0": e_0}


def coefficients(mv):
    return {blade: cga.coefficient(mv, blade) for blade in cga.BLADES}


def values(mv):
    """Return the 32 coefficients of a multivector as an array (32, N)."""
    return np.stack(np.broadcast_arrays(*coefficients(mv).values())).astype(float).reshape(32, -1)


def close(a, b, what="", atol=1e-12):
    np.testing.assert_allclose(a, b, rtol=0, atol=atol, err_msg=what)


def test_each_blade_reads_as_itself():
    for blade in cga.BLADES:
        mv = cga.scalar(1)
        for name in blade.split("^") if blade != "1" else ():
            mv = mv ^ BASIS[name]
        assert coefficients(mv) == {name: float(name == blade) for name in cga.BLADES}
    with pytest.raises(KeyError, match="e2\\^e1"):
        cga.coefficient(e1, "e2^e1")
    inner = {(a, a): 1 for a in ("e1", "e2", "e3")} | {("einf", "e0"): -1, ("e0", "einf"): -1}
    for a in BASIS:
        for b in BASIS:
            assert cga.inner(BASIS[a], BASIS[b]) == inner.get((a, b), 0), f"{a} . {b}"


def test_metric_of_points_and_parts_of_entities():
    p, q = RNG.normal(size=(2, 3, 20))
    close(cga.inner(cga.point(*p), cga.point(*q)), -((p - q) ** 2).sum(axis=0) / 2, "P . Q is -distance^2 / 2")
    close(cga.euclidean_coordinates(cga.point(*p) * cga.scalar(-3.0)), p, "a point is homogeneous")
    radius, normal = RNG.uniform(0.5, 2, 20), directions(RNG, 20)
    sphere = cga.sphere(cga.point(*p), radius)
    close(cga.radius(sphere), radius)
    close(cga.euclidean_coordinates(cga.centre(sphere)), p)
    plane = cga.plane(*normal, (normal * p).sum(axis=0) + radius / 2)
    close(cga.direction(plane), normal)
    close(cga.euclidean_coordinates(cga.centre(sphere ^ plane)), p + normal * radius / 2, atol=1e-10)
    close(cga.radius(sphere ^ plane), radius * np.sqrt(3) / 2, atol=1e-10)
    apart = cga.plane(*normal, (normal * p).sum(axis=0) + 2 * radius)
    assert np.isnan(cga.radius(sphere ^ apart)).all()
    close(cga.euclidean_coordinates(cga.centre(cga.dual(cga.point(*p) ^ cga.point(*q)))), (p + q) / 2, atol=1e-10)
    line = cga.dual(cga.line_direct(cga.point(*p), cga.point(*q)))
    close(cga.direction(line), (q - p) / np.linalg.norm(q - p, axis=0), atol=1e-10)


def test_angles_between_lines_and_planes():
    shared, a, b = RNG.normal(size=(3, 3, 50))
    cosine = (a * b).sum(axis=0) / np.linalg.norm(a, axis=0) / np.linalg.norm(b, axis=0)
    lines = [cga.line_direct(cga.point(*shared), cga.point(*(shared + d))) for d in (a, b)]
    planes = [cga.plane(*n, d) for n, d in zip((a, b), RNG.normal(size=(2, 50)), strict=True)]
    close(cga.cos_angle(*lines), cosine, "(5), direct lines", 1e-10)
    close(cga.cos_angle(*map(cga.dual, lines)), -cosine, "(5), standard lines", 1e-10)
    close(cga.cos_angle(*planes), cosine, "(5), standard planes", 1e-10)
    close(cga.cos_angle(*map(cga.dual, planes)), -cosine, "(5), direct planes", 1e-10)
    phi = np.linspace(0, np.pi, 101)
    close(cga.half_angle(np.cos(phi)), (np.cos(phi / 2), np.sin(phi / 2)), "(6), (7)", 1e-8)
    beyond = 1 + 1e-15
    assert cga.half_angle(beyond) == (1.0, 0.0) and cga.half_angle(-beyond) == (0.0, 1.0), "beyond 1 by roundoff"


def test_product_and_rotation_are_those_of_the_algebra():
    a, b, v = RNG.normal(size=(40, 4)), RNG.normal(size=(40, 4)), RNG.normal(size=(40, 3))
    Q_a, Q_b = cga.quaternion(*a.T), cga.quaternion(*b.T)
    close(kinematics.multiply(a, b).T, cga.quaternion_coefficients(Q_a * Q_b), "a b")
    turned = kinematics.rotate(a, v)
    close(turned.T, values(cga.rotate(Q_a, cga.vector(*v.T)))[1:4], "Q v Q~, Q of any length")
    np.testing.assert_array_equal(kinematics.rotate(a[0], v)[0], turned[0], err_msg="one quaternion")
    np.testing.assert_array_equal(kinematics.rotate(a, v[0])[0], turned[0], err_msg="one vector")


def test_angle_between():
    a = RNG.normal(size=(50, 4))
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    for angle in (0.0, 1e-15, 1e-9, 1e-4, 0.7, 3.0, np.pi):
        turn = np.column_stack((np.full(50, np.cos(angle / 2)), np.sin(angle / 2) * directions(RNG, 50).T))
        b = kinematics.multiply(a, turn)
        for other in (b, -b, 3 * b):
            close(kinematics.angle_between(a, other), angle, f"angle {angle}", atol=1e-15 + 1e-14 * angle)


def test_poses_made_by_hand():
    one, turn_x = (1, 0, 0, 0), (np.sqrt(0.5), np.sqrt(0.5), 0, 0)  # a quarter turn, right-handed: z to -y
    poses = {
        "rest: folded back": (one, (1, 0), (0, 0, 2), (0, 0, 2 - 0.5)),
        "straight: Qe = -i": (one, (0, -1), (0, 0, 2), (0, 0, 2 + 0.5)),
        "elbow at a right angle": (one, (np.sqrt(0.5), -np.sqrt(0.5)), (0, 0, 2), (0, -0.5, 2)),
        "straight, shoulder turned": (turn_x, (0, -1), (0, -2, 0), (0, -2.5, 0)),
    }
    for name, (qs, qe, *points) in poses.items():
        close(np.concatenate(kinematics.forward(qs, qe, 2.0, 0.5)), points, name, 1e-15)


TARGETS = random_targets(10_000, seed=2)  # reachable, any theta_3, 0.05 rad or more off all other singular poses
GEOMETRY = geometry.solve(*TARGETS)


def test_geometry_gives_the_equations():
    """Compare results with their signs, scalars, and the coefficients of (11), (12) and (15)."""
    printed = equations.solve(*TARGETS)
    for bound, names in ((1e-9, "qs_w qs_i qs_j qs_k qe_w qe_i"), (1e-11, "l_sw p_e_x p_e_y p_e_z c4 c3 sign")):
        for name in names.split():
            close(GEOMETRY[name], printed[name], name, bound)
    plane, pair = GEOMETRY["pi_swivel"], cga.dual(GEOMETRY["PP"])
    w, *q12 = cga.quaternion_coefficients(GEOMETRY["Q_12"])
    coefficients = {
        f"pi_swivel_{axis}": value for axis, value in zip("xyz", (plane.e1, plane.e2, plane.e3), strict=True)
    }
    coefficients |= {
        f"pp_{unit}": value for unit, value in zip("ijk", cga.quaternion_coefficients(pair)[1:], strict=True)
    }
    coefficients |= {f"pp_{blade}": getattr(pair, f"e{blade}") for blade in (14, 15, 24, 25, 34, 35)}
    for name, value in coefficients.items():
        close(value, printed[name], f"{name} of (11), (12)", 1e-13)
    close(q12, [printed[f"q12_{unit}"] for unit in "ijk"], "(15)", 1e-12)
    close(cga.coefficient(plane, "einf"), 0, "the swivel plane goes through the shoulder", 1e-13)
    close(pair.e45, 0, "(12) has no e45: so does the pair's plane", 1e-13)
    close(w, 0, "a half turn", 1e-14)

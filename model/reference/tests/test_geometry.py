# SPDX-License-Identifier: Apache-2.0
"""Layer 2, the inverse kinematics built as geometry, against layer 3, the equations.

Measured largest differences over 10^4 targets, arms of about 1: shoulder 3e-12 rad (3e-14 rad where theta_3
is 0.05 rad from 0 and pi), elbow 8e-14 rad, elbow point 2e-14.
"""

import numpy as np
import pytest
import sympy

from model.reference import cga, equations, geometry, kinematics
from model.reference.tests.test_equations import elbow, random_targets, shoulder, vector

TARGETS = random_targets(10_000, seed=2)  # reachable, any theta_3, 0.05 rad or more off all other singular poses
X, Y, Z, PHI, D1, D2 = TARGETS
GEOMETRY = geometry.solve(*TARGETS)
EQUATIONS = equations.solve(*TARGETS)


def normal(plane):
    """Return the (non-unit) normal of a plane in standard representation, (N, 3)."""
    return np.stack([cga.coefficient(plane, name) for name in ("e1", "e2", "e3")], axis=-1)


def assert_incident(entity, point, what):
    """Assert that the point lies on the entity, which is in standard representation."""
    product = np.stack([v for v in cga.coefficients(point | entity).values() if np.shape(v)])
    size = np.stack([v for v in cga.coefficients(entity).values() if np.shape(v)])
    assert (np.abs(product).max(axis=0) < 1e-11 * np.abs(size).max(axis=0)).all(), what


# -- against layer 3


def test_quaternions_are_those_of_the_equations():
    shoulder_angle = kinematics.angle_between(shoulder(GEOMETRY), shoulder(EQUATIONS))
    assert shoulder_angle.max() < 1e-9, "Qs"
    elbow_quaternions = [np.pad(elbow(result), ((0, 0), (0, 2))) for result in (GEOMETRY, EQUATIONS)]
    assert kinematics.angle_between(*elbow_quaternions).max() < 1e-9, "Qe"
    for name in ("qs_w", "qs_i", "qs_j", "qs_k", "qe_w", "qe_i"):
        np.testing.assert_allclose(GEOMETRY[name], EQUATIONS[name], rtol=0, atol=1e-9, err_msg=f"{name}, sign included")


@pytest.mark.parametrize("name", ["l_sw", "p_e_x", "p_e_y", "p_e_z", "c4", "c3", "sign"])
def test_scalars_are_those_of_the_equations(name):
    np.testing.assert_allclose(GEOMETRY[name], EQUATIONS[name], rtol=0, atol=1e-11, err_msg=name)


def test_swivel_plane_has_the_coefficients_of_11():
    found = normal(GEOMETRY["pi_swivel"])
    np.testing.assert_allclose(found, vector(EQUATIONS, "pi_swivel"), rtol=0, atol=1e-13, err_msg="(11)")
    assert np.abs(cga.coefficient(GEOMETRY["pi_swivel"], "einf")).max() < 1e-13, "it goes through the shoulder"


def test_point_pair_has_the_coefficients_of_12():
    pair = cga.dual(GEOMETRY["PP"])
    found = {"i": -pair.e23, "j": pair.e13, "k": -pair.e12}
    found |= {"14": pair.e14, "15": pair.e15, "24": pair.e24, "25": pair.e25, "34": pair.e34, "35": pair.e35}
    printed = np.stack([EQUATIONS[f"pp_{name}"] for name in found])
    np.testing.assert_allclose(np.stack(list(found.values())), printed, rtol=0, atol=1e-13, err_msg="(12)")
    assert np.abs(pair.e45).max() < 1e-13, "(12) has no e45: the pair's plane goes through the shoulder"


def test_rotation_to_the_elbow_has_the_coefficients_of_15():
    w, *q12 = cga.quaternion_coefficients(GEOMETRY["Q_12"])
    assert np.abs(w).max() < 1e-14, "a half turn"
    printed = [EQUATIONS[f"q12_{unit}"] for unit in "ijk"]
    np.testing.assert_allclose(q12, printed, rtol=0, atol=1e-12, err_msg="(15)")


# -- the geometry itself


def test_entities_meet_where_they_should():
    P_e, P_w, shoulder_point = GEOMETRY["P_e"], GEOMETRY["P_w"], cga.point(0 * X, 0 * X, 0 * X)
    on_them = {
        "S_1": [P_e],
        "S_2": [P_e],
        "Z_e": [P_e],
        "PP": [P_e],
        "pi_swivel": [shoulder_point, P_w, P_e],
        "L_sw": [shoulder_point, P_w],
        "L_se": [shoulder_point, P_e],
        "L_ew": [P_e, P_w],
        "pi_m": [shoulder_point],
        "pi_e": [shoulder_point, P_e, GEOMETRY["P_ze"]],
        "L_m": [shoulder_point],
    }
    for name, points in on_them.items():
        for point in points:
            assert_incident(GEOMETRY[name], point, f"{name} contains its points")


# -- inputs


def test_numbers_and_arrays_broadcast():
    found = geometry.solve(0.3, 0.2, 0.1, [0.4, 0.5], 0.3, 0.25)
    for name in ("qs_w", "qe_i", "l_sw", "c4"):
        assert found[name].shape == (2,), f"{name}: one value a target, even where it does not depend on phi"
    with pytest.raises(ValueError, match="broadcast"):
        geometry.solve([0.1, 0.2], [0.1, 0.2, 0.3], 0.1, 0.4, 0.3, 0.25)


def test_symbols_give_the_papers_swivel_plane():
    """The geometry yields (11), with the squared cosine that the print lacks."""
    x, y, z, phi = sympy.symbols("p_wx p_wy p_wz phi", real=True)
    _, length, pi_swivel = geometry.swivel_plane(cga.point(x, y, z), phi)
    assert sympy.simplify(length - sympy.sqrt(x**2 + y**2 + z**2)) == 0, "(10)"
    c, s = sympy.cos(phi / 2), sympy.sin(phi / 2)
    l_sw = sympy.sqrt(x**2 + y**2 + z**2)
    corrected = {
        "e1": (2 * c * s * z * x - y * l_sw + 2 * y * l_sw * c**2) / l_sw,
        "e2": (2 * c * s * z * y + x * l_sw - 2 * x * l_sw * c**2) / l_sw,
        "e3": -2 * s * c * (x**2 + y**2) / l_sw,
    }
    for blade, expected in corrected.items():
        assert sympy.simplify(cga.coefficient(pi_swivel, blade) - expected) == 0, f"(11), {blade}"

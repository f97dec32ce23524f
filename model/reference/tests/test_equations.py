# SPDX-License-Identifier: Apache-2.0
"""Layer 3, equations (10)-(18): against forward kinematics, the print, and at poses that the print omits.

Measured largest errors over 10^5 targets of the domain of `random_targets`: with theta_3 0.05 rad or more
from 0 and pi, hand 2e-14 of the reach and shoulder 3e-14 rad against the rotation matrix; with any theta_3,
1e-11 and 3e-11, at the pose nearest to 0 or pi. At such a pose itself both are about 1e-8.
"""

import numpy as np
import pytest

from model.io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, expected_flags
from model.reference import kinematics
from model.reference.equations import pose_flags, shoulder_quaternion, solve, solve_clamped, swivel_normal

PHIS = np.linspace(-np.pi, np.pi, 17)

HALF_OF_THE_DIGITS = 6e-8
"""Bound (rad, and relative to the reach) for the roots of (14) and (17) at a half angle of 0 or pi/2."""


def random_targets(size, seed):
    """Return x, y, z, phi, d1, d2 of reachable targets all over the workspace, off the singular poses.

    The elbow's interior angle is 0.05 rad or more from 0 and pi, wrist and elbow are 0.05 rad or more from
    the z axis. theta_3 is not restricted.
    """
    rng = np.random.default_rng(seed)
    d1, d2 = rng.uniform(0.2, 1, (2, 4 * size))
    interior = rng.uniform(0.05, np.pi - 0.05, 4 * size)
    p = rng.normal(size=(4 * size, 3))
    p *= (np.sqrt(d1**2 + d2**2 - 2 * d1 * d2 * np.cos(interior)) / np.linalg.norm(p, axis=1))[:, None]
    targets = (*p.T, rng.uniform(-np.pi, np.pi, 4 * size), d1, d2)
    e = elbow_direction(targets)
    off_axis = np.hypot(p[:, 0], p[:, 1]) > np.sin(0.05) * np.linalg.norm(p, axis=1)
    keep = np.flatnonzero(off_axis & (np.hypot(e[:, 0], e[:, 1]) > np.sin(0.05)))[:size]
    return tuple(column[keep] for column in targets)


def elbow_direction(targets):
    """Return p_e/d1 (N, 3) by the law of cosines, without the paper's equations."""
    x, y, z, phi, d1, d2 = (np.asarray(column, dtype=float) for column in targets)
    p = np.stack((x, y, z), axis=-1)
    distance = np.linalg.norm(p, axis=1)
    cos_a = np.clip((distance**2 + d1**2 - d2**2) / (2 * d1 * distance), -1, 1)
    m = np.cross(swivel_normal(x, y, z, phi), p / distance[:, None])
    return cos_a[:, None] * p / distance[:, None] + np.sqrt(1 - cos_a**2)[:, None] * m


def shoulder(result):
    return np.stack([result[f"qs_{part}"] for part in "wijk"], axis=-1)


def elbow(result):
    return np.stack([result["qe_w"], result["qe_i"]], axis=-1)


def vector(result, name):
    return np.stack([result[f"{name}_{axis}"] for axis in "xyz"], axis=-1)


def hand_error(result, targets):
    """Return the distance of the forward kinematics' wrist from the target, over the reach."""
    *p, _, d1, d2 = targets
    _, wrist = kinematics.forward(shoulder(result), elbow(result), d1, d2)
    return np.linalg.norm(wrist - np.stack(p, axis=-1), axis=1) / (np.asarray(d1) + d2)


def matrix_form(targets):
    """Return the shoulder from the directions of normal and elbow, a form without singular poses."""
    return shoulder_quaternion(swivel_normal(*targets[:4]), elbow_direction(targets))


def columns(*values):
    return tuple(np.array(column) for column in np.broadcast_arrays(*(np.atleast_1d(v) * 1.0 for v in values)))


def assert_unit(result):
    np.testing.assert_allclose((shoulder(result) ** 2).sum(axis=1), 1, rtol=0, atol=1e-14, err_msg="|Qs| = 1")
    np.testing.assert_allclose((elbow(result) ** 2).sum(axis=1), 1, rtol=0, atol=1e-14, err_msg="|Qe| = 1")
    assert (result["qs_k"] >= 0).all(), "the k part of Qs is never negative"


def assert_defined(result):
    for name, values in result.items():
        assert np.isfinite(values).all(), f"{name} is not finite"
    assert_unit(result)


def assert_pose(targets):
    """Assert a defined pose, with the hand at the target and the shoulder of the non-singular matrix form."""
    result = solve(*targets)
    assert_defined(result)
    assert hand_error(result, targets).max() < HALF_OF_THE_DIGITS, "hand"
    assert kinematics.angle_between(shoulder(result), matrix_form(targets)).max() < HALF_OF_THE_DIGITS, "shoulder"
    return result


# -- regular poses

TARGETS = random_targets(20_000, seed=1)
RESULT = solve(*TARGETS)
REGULAR = (RESULT["q3_scalar"] > np.sin(0.05 / 2)) & (np.abs(RESULT["q3_k"]) > np.sin(0.05 / 2))
"""theta_3 is 0.05 rad or more from 0 and pi, where (17) keeps its digits."""


def test_hand_is_at_the_target():
    error = hand_error(RESULT, TARGETS)
    assert error[REGULAR].max() < 1e-12, "forward kinematics of Qs, Qe"
    assert error.max() < HALF_OF_THE_DIGITS, "and for any theta_3"
    assert_defined(RESULT)


def test_elbow_of_forward_kinematics_is_the_elbow_point():
    found, _ = kinematics.forward(shoulder(RESULT), elbow(RESULT), *TARGETS[4:])
    np.testing.assert_allclose(vector(RESULT, "p_e"), found, rtol=0, atol=1e-13, err_msg="(13) against Qs")
    expected = TARGETS[4][:, None] * elbow_direction(TARGETS)
    np.testing.assert_allclose(vector(RESULT, "p_e"), expected, rtol=0, atol=1e-13, err_msg="(13) against trigonometry")


def test_shoulder_is_the_rotation_of_the_matrix_form():
    error = kinematics.angle_between(shoulder(RESULT), matrix_form(TARGETS))
    assert error.max() < 1e-9, "(15)-(18) against columns -n, e x (-n), e"
    assert error[REGULAR].max() < 1e-12, "theta_3 0.05 rad off 0 and pi"


def signed_swivel(targets, normal):
    """Return the angle (rad) of the plane with this normal from the vertical plane, about the wrist's direction."""
    p = np.stack(targets[:3], axis=-1)
    axis = p / np.linalg.norm(p, axis=1, keepdims=True)
    vertical = np.stack((p[:, 1], -p[:, 0], 0 * p[:, 0]), axis=-1)
    return np.arctan2((axis * np.cross(vertical, normal)).sum(axis=1), (vertical * normal).sum(axis=1))


def test_swivel_angle_is_phi():
    """Modulo a turn, with its sign, for the plane and the arm."""
    found, _ = kinematics.forward(shoulder(RESULT), elbow(RESULT), *TARGETS[4:])
    arm = np.cross(np.stack(TARGETS[:3], axis=-1), found)
    for what, normal in (("pi_swivel (11)", vector(RESULT, "pi_swivel")), ("the arm itself", arm)):
        error = np.angle(np.exp(1j * (signed_swivel(TARGETS, normal) - TARGETS[3])))
        assert np.abs(error).max() < 1e-11, f"swivel angle of {what}"


def test_elbow_angle_is_the_interior_one():
    x, y, z, _, d1, d2 = TARGETS
    cosine = (d1**2 + d2**2 - x**2 - y**2 - z**2) / (2 * d1 * d2)
    np.testing.assert_allclose(RESULT["c4"], cosine, rtol=0, atol=1e-13, err_msg="(14), law of cosines")
    assert (RESULT["qe_w"] > 0).all() and (RESULT["qe_i"] < 0).all(), "signs of (14)"


@pytest.mark.parametrize("exponent", [-40, -9, 9, 40])
def test_unit_of_length_does_not_matter(exponent):
    x, y, z, phi, d1, d2 = TARGETS
    scaled = solve(*(np.ldexp(v, exponent) for v in (x, y, z)), phi, *(np.ldexp(v, exponent) for v in (d1, d2)))
    for name in ("qs_w", "qs_i", "qs_j", "qs_k", "qe_w", "qe_i"):
        # Powers of two are exact, so even roundoff is the same.
        np.testing.assert_array_equal(scaled[name], RESULT[name], err_msg=f"{name} in a unit of 2^{-exponent}")


# -- poses at which the printed equations are 0/0


@pytest.mark.parametrize("z", [0.5, -0.5])
def test_target_on_the_z_axis_takes_azimuth_0(z):
    targets = columns(0, 0, z, PHIS, 0.3, 0.4)
    result = assert_pose(targets)
    # The limit of a target that approaches the axis along +x, as its azimuth is 0.
    limit = solve(*columns(1e-12, 0, z, PHIS, 0.3, 0.4))
    gap = kinematics.angle_between(shoulder(result), shoulder(limit))
    assert gap.max() < HALF_OF_THE_DIGITS, "shoulder against a target 1e-12 off the axis in the direction of x"


@pytest.mark.parametrize("up", [1, -1], ids=["elbow up", "elbow down"])
@pytest.mark.parametrize("bend", [0.3, 1.5, 2.8])
def test_elbow_on_the_z_axis(up, bend):
    """Exact for a wrist in the x-z or y-z plane, where roundoff permits; otherwise up to roundoff."""
    azimuth = np.linspace(0, 2 * np.pi, 33)
    direction = np.sin(bend) * np.cos(azimuth), np.sin(bend) * np.sin(azimuth), np.cos(bend) * up
    phi = 0 if up > 0 else np.pi
    targets = columns(0.25 * direction[0], 0.25 * direction[1], 0.5 * up + 0.25 * direction[2], phi, 0.5, 0.25)
    # For an elbow on the axis up to roundoff, Q_12 is meaningless; Q_3 must compensate for it.
    result = assert_pose(targets)
    assert np.hypot(result["p_e_x"], result["p_e_y"]).max() < 1e-14, "the pose that was meant"


def test_inner_product_of_0_gives_sign_plus():
    targets = columns(0, [0.5, -0.5, 0.5, -0.5], [0.2, 0.2, -0.3, -0.3], 0, 0.4, 0.3)
    assert (assert_pose(targets)["sign"] == 1).all(), "x = 0, phi = 0: P_w lies in pi_yz2"


@pytest.mark.parametrize("p", [(0.75, 0, 0), (0, -0.75, 0), (0.25, 0.5, 0.5), (-0.5, 0.25, -0.5), (0, 0, 0.75)])
@pytest.mark.parametrize("lengths", [(0.5, 0.25), (1.25, 0.5), (0.5, 1.25)], ids=["straight", "folded", "folded back"])
def test_straight_and_folded_arm_keep_their_swivel(p, lengths):
    """The target is reached exactly. P_w is then in pi_yz2 for every theta_3, and the printed sign is only roundoff."""
    targets = columns(*p, PHIS, *lengths)
    assert (pose_flags(*targets[:3], *lengths) & ~ON_AXIS == 0).all(), "these targets are in reach"
    assert_pose(targets)


@pytest.mark.parametrize("exponent", range(-1, -13, -1))
def test_near_singular_poses(exponent):
    """Poses 10^-1 .. 10^-12 from full stretch, full fold, wrist on the axis, elbow on the axis; otherwise random."""
    rng = np.random.default_rng(-exponent)
    off, size = 10.0**exponent, 300
    d1, d2, azimuth, phi = (
        rng.uniform(0.3, 1, size),
        rng.uniform(0.3, 1, size),
        *rng.uniform(-3, 3, (2, size)),
    )
    any_way = rng.normal(size=(3, size))
    any_way /= np.linalg.norm(any_way, axis=0)
    up = np.stack((off * np.cos(azimuth), off * np.sin(azimuth), np.sqrt(1 - off**2) * rng.choice((-1, 1), size)))
    middle = np.abs(d1 - d2) + rng.uniform(0.1, 0.9, size) * (d1 + d2 - np.abs(d1 - d2))
    bend = rng.uniform(0.2, 2.9, size) * np.array((np.cos(azimuth), np.sin(azimuth), 0 * azimuth))
    forearm = np.stack((np.sin(bend[0]) * np.sin(azimuth), np.sin(bend[0]) * np.cos(azimuth), np.cos(bend[0])))
    kinds = {
        "full stretch": ((d1 + d2) * (1 - off) * any_way, phi),
        "full fold": ((np.abs(d1 - d2) * (1 + off) + off * d1) * any_way, phi),
        "wrist near the z axis": (middle * up, phi),
        "elbow near the z axis": (d1 * up + d2 * forearm, off * phi),
    }
    for kind, (p, swivel) in kinds.items():
        targets = (*p, swivel, d1, d2)
        result = solve(*targets)
        assert_defined(result)
        assert hand_error(result, targets).max() < HALF_OF_THE_DIGITS, f"{kind}: hand"
        # At the fold the elbow's direction is as uncertain as roundoff over |p|: compare with the computed elbow.
        e = vector(result, "p_e")
        e /= np.linalg.norm(e, axis=1, keepdims=True)
        expected = shoulder_quaternion(swivel_normal(*targets[:4]), e)
        assert kinematics.angle_between(shoulder(result), expected).max() < HALF_OF_THE_DIGITS, f"{kind}: shoulder"


def test_never_nan():
    """Reachable targets at the ends of the number range: all lengths and offsets, on and near each axis."""
    lengths = [1e-15, 1e-6, 1.0, 1e15]
    offsets = [0.0, 5e-324, 1e-300, 1e-160, 1e-100, 1e-31, 1e-29, 1e-16, 1e-8, 0.5, 1.0]
    grid = np.array(np.meshgrid(lengths, offsets, offsets, offsets, [0.0, 1.0, np.pi])).reshape(5, -1)
    d, x, y, z, phi = grid
    targets = (d * x, -d * y, d * z, phi, d, d)
    result = solve(*targets)
    assert_defined(result)
    assert hand_error(result, targets).max() < HALF_OF_THE_DIGITS, "hand"


# -- clamped poses


def random_directions(size=50, seed=3):
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(3, size))
    return v / np.linalg.norm(v, axis=0), rng.uniform(-np.pi, np.pi, size)


ANYWHERE, UP = random_directions()[0], np.array([[0.0], [0.0], [1.0]])
CLAMPED = {
    "too far": (1.5 * ANYWHERE, (0.4, 0.3), TOO_FAR, 0.4, 0.7, False),
    "too near, long upper arm": (0.1 * ANYWHERE, (0.5, 0.2), TOO_NEAR, 0.5, 0.3, True),
    "too near, long forearm": (0.1 * ANYWHERE, (0.2, 0.5), TOO_NEAR, -0.2, 0.3, True),
    "too far on the z axis": (2 * UP, (0.4, 0.3), ON_AXIS | TOO_FAR, 0.4, 0.7, False),
    "at the shoulder": (0 * UP, (0.5, 0.5), ON_AXIS | AT_SHOULDER, 0.5, 0.0, True),
    "at the shoulder, long upper arm": (0 * UP, (0.5, 0.25), ON_AXIS | AT_SHOULDER | TOO_NEAR, 0.5, 0.25, True),
    "at the shoulder, long forearm": (0 * UP, (0.25, 0.5), ON_AXIS | AT_SHOULDER | TOO_NEAR, -0.25, 0.25, True),
    "bad lengths at the shoulder": (0 * UP, (0, 0.5), ON_AXIS | AT_SHOULDER | BAD_LENGTH, 0.0, 0.5, False),
    **{
        f"bad lengths {d1}, {d2}": (0.5 * ANYWHERE, (d1, d2), BAD_LENGTH, d1, d1 + d2, False)
        for d1, d2 in ((0, 0.3), (0.3, 0), (-0.1, 0.3), (0.3, -1), (0, 0), (-1, -1))
    },
}
"""Return case -> positions, lengths, flags, elbow and wrist along the direction of the target, folded or straight."""


@pytest.mark.parametrize("case", CLAMPED)
def test_clamped_arms_lie_along_the_target(case):
    p, lengths, flags, elbow_at, wrist_at, folded = CLAMPED[case]
    targets = columns(*p, random_directions()[1], *lengths)
    result = solve_clamped(*targets)
    assert_defined(result)
    assert (result["flags"] == flags).all(), f"flags {sorted(set(result['flags']))}"
    p = np.stack(targets[:3], axis=-1)
    size = np.linalg.norm(p, axis=1, keepdims=True)
    direction = np.where(size > 0, p / np.maximum(size, 1e-300), (0, 0, 1))
    found, wrist = kinematics.forward(shoulder(result), elbow(result), *targets[4:])
    np.testing.assert_allclose(found, elbow_at * direction, atol=1e-14, err_msg="elbow")
    np.testing.assert_allclose(wrist, wrist_at * direction, atol=1e-14, err_msg="wrist")
    assert (elbow(result) == ((1, 0) if folded else (0, -1))).all(), "Qe"
    local_x = kinematics.rotate(shoulder(result), np.array([(1.0, 0.0, 0.0)]))
    np.testing.assert_allclose(local_x, -swivel_normal(*targets[:4]), atol=1e-14, err_msg="swivel plane")


def test_flags_are_exact_at_the_limits():
    """3-4-5 triangles of 31-bit words and one ulp more, which squares in doubles cannot distinguish."""
    ulp = 2.0**-30
    x, y = 3 * (2**28 - 1) * ulp, 4 * (2**28 - 1) * ulp
    reach = 5 * (2**28 - 1) * ulp
    z = np.array([0, ulp])
    np.testing.assert_array_equal(pose_flags(x, y, z, reach - 0.5, 0.5), [0, TOO_FAR], err_msg="far limit")
    np.testing.assert_array_equal(pose_flags(x, y, z, reach + 0.5, 0.5), [0, 0], err_msg="near limit")
    np.testing.assert_array_equal(
        pose_flags(x, y, z, reach + 0.5 + ulp, 0.5),
        [TOO_NEAR, TOO_NEAR],
        err_msg="one unit inside the near limit",
    )
    inside = solve_clamped(x, y, z, 0.7, reach - 0.5, 0.5)
    assert_defined(inside)


def test_flags_are_those_of_the_integer_rule():
    rng = np.random.default_rng(6)
    words = rng.integers(-(2**31), 2**31, (3000, 6))
    words[::2] = rng.integers(-3, 4, (1500, 6))  # small words: ties, axis, shoulder, bad lengths
    found = pose_flags(*(words[:, [0, 1, 2, 4, 5]].T * 2.0**-30))
    np.testing.assert_array_equal(found, expected_flags(words, 32), err_msg="model.io.flags on the same words")


def test_mixed_stream_keeps_its_order():
    x = np.array([0.5, 2.0, 0.01, 0.5, 0.3])
    d1 = np.array([0.4, 0.4, 0.4, -1.0, 0.4])
    mixed = solve_clamped(x, 0.1, 0.2, 0.3, d1, 0.3)
    np.testing.assert_array_equal(mixed["flags"], [0, TOO_FAR, 0, BAD_LENGTH, 0], err_msg="flags")
    for n in range(5):
        alone = solve_clamped(x[n], 0.1, 0.2, 0.3, d1[n], 0.3)
        for name, value in alone.items():
            assert value[0] == mixed[name][n], f"{name} of target {n}"


def test_a_clamped_pose_continues_the_reachable_ones():
    v, phi = random_directions()
    for limit, sign in ((0.7, 1), (0.1, -1)):
        inside = solve_clamped(*((limit - sign * 1e-9) * v), phi, 0.4, 0.3)
        outside = solve_clamped(*((limit + sign * 1e-9) * v), phi, 0.4, 0.3)
        assert (inside["flags"] == 0).all() and (outside["flags"] != 0).all(), "the pair straddles the limit"
        gap = kinematics.angle_between(shoulder(inside), shoulder(outside))
        assert gap.max() < 1e-3, "shoulder: the root of 1e-9 is the natural step"


# -- rejected input


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((np.nan, 0, 0.5, 0, 0.4, 0.3), "x must be finite"),
        ((0.1, 0, 0.5, np.inf, 0.4, 0.3), "phi must be finite"),
        ((0.1, 0, 0.5, 0, 0.0, 0.3), "d1 must lie in"),
        ((0.1, 0, 0.5, 0, 0.4, -0.3), "d2 must lie in"),
        ((0.1, 0, 0.5, 0, 0.4, 1e16), "d2 must lie in"),
        ((0.1, 0, [0.5, 0.8], 0, 0.4, 0.3), "target 1 cannot be reached"),
        ((0.0, 0, 0.05, 0, 0.4, 0.3), "target 0 cannot be reached"),
        ((np.zeros((2, 2)), 0, 0.5, 0, 0.4, 0.3), r"of shape \(N,\), not \(2, 2\)"),
        ((np.zeros(2), np.zeros(3), 0.5, 0, 0.4, 0.3), "broadcast"),
    ],
)
def test_solve_refuses(arguments, message):
    with pytest.raises(ValueError, match=message):
        solve(*arguments)

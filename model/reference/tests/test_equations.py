# SPDX-License-Identifier: Apache-2.0
"""Test layer 3: compare (10)-(18) and the lean equations with forward kinematics, the printed text, and each other.

Largest errors of `solve`, measured over 10^5 targets of `random_targets`: hand 2e-14 of the reach and shoulder 3e-14
rad (against the rotation matrix) if theta_3 is 0.05 rad or more from 0 and pi; 1e-11 and 3e-11 for any theta_3; about
1e-8 for theta_3 = 0 or pi. The errors of `solve_lean` are 1.4e-15 over the whole workspace. Next to singular poses,
`solve_lean` is within 1e-15 rad of the printed equations evaluated with 80 digits, `solve` within 3e-8 rad.
"""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from model.io import stimuli
from model.io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, expected_flags
from model.io.stimuli import REGIONS
from model.io.words import FIELDS, RESULT_FIELDS, from_words
from model.reference import kinematics
from model.reference.equations import TEXT, pose_flags, shoulder_quaternion, solve, solve_clamped, swivel_normal
from model.reference.lean_equations import solve_direct, solve_lean

PHIS = np.linspace(-np.pi, np.pi, 17)

HALF_OF_THE_DIGITS = 6e-8
"""Bound of errors (rad, and relative to the reach) where a root of (14) or (17) is at a half angle of 0 or pi/2."""

ROUNDOFF = 5e-15  # bound of the lean equations' errors (rad, and relative to the reach)


def direct(*targets):
    results, flags = solve_direct(np.array(columns(*targets)))
    return dict(zip(RESULT_FIELDS, results, strict=True)) | {"flags": flags}


BOUNDS = {solve: HALF_OF_THE_DIGITS, solve_lean: ROUNDOFF, direct: ROUNDOFF}
both = pytest.mark.parametrize("solver", BOUNDS, ids=lambda solver: solver.__name__)


def shoulder(result):
    return np.stack([result[f"qs_{part}"] for part in "wijk"], axis=-1)


def elbow(result):
    return np.stack([result["qe_w"], result["qe_i"]], axis=-1)


def columns(*values):
    return tuple(np.array(column) for column in np.broadcast_arrays(*(np.atleast_1d(v) * 1.0 for v in values)))


def directions(rng, size):
    v = rng.normal(size=(3, size))
    return v / np.linalg.norm(v, axis=0)


def workspace(size, seed):
    """Return reachable targets at any direction, distance and swivel angle."""
    rng = np.random.default_rng(seed)
    d1, d2 = rng.uniform(0.2, 1, (2, size))
    distance = rng.uniform(np.abs(d1 - d2), d1 + d2)
    return *(directions(rng, size) * distance), rng.uniform(-np.pi, np.pi, size), d1, d2


def random_targets(size, seed):
    """Return targets of `workspace` off singular poses: the elbow's interior angle is 0.05 rad or more from 0 and pi,
    and wrist and elbow are 0.05 rad or more from the z axis. theta_3 is not restricted."""
    targets = workspace(4 * size, seed)
    x, y, z, _, d1, d2 = targets
    interior = np.arccos((d1**2 + d2**2 - x**2 - y**2 - z**2) / (2 * d1 * d2))
    e = elbow_direction(targets)
    off_axis = np.minimum(np.hypot(x, y) / np.hypot(np.hypot(x, y), z), np.hypot(e[:, 0], e[:, 1])) > np.sin(0.05)
    keep = np.flatnonzero(off_axis & (np.abs(interior - np.pi / 2) < np.pi / 2 - 0.05))[:size]
    return tuple(column[keep] for column in targets)


def elbow_direction(targets):
    """Return p_e/d1 (N, 3) by the law of cosines, without the paper's equations."""
    x, y, z, phi, d1, d2 = (np.asarray(column, dtype=float) for column in targets)
    p = np.stack((x, y, z), axis=-1)
    distance = np.linalg.norm(p, axis=1)
    cosine = np.clip((distance**2 + d1**2 - d2**2) / (2 * d1 * distance), -1, 1)
    m = np.cross(swivel_normal(x, y, z, phi), p / distance[:, None])
    return cosine[:, None] * p / distance[:, None] + np.sqrt(1 - cosine**2)[:, None] * m


def hand_error(result, targets):
    """Return the distance from the target to the wrist by forward kinematics, divided by the reach."""
    *p, _, d1, d2 = targets
    _, wrist = kinematics.forward(shoulder(result), elbow(result), d1, d2)
    return np.linalg.norm(wrist - np.stack(p, axis=-1), axis=1) / (np.asarray(d1) + d2)


def angle(a, b):
    return kinematics.angle_between(shoulder(a), shoulder(b))


def elbow_angle(result):
    return 2 * np.arctan2(result["qe_i"], result["qe_w"])


def assert_defined(result):
    for name, values in result.items():
        assert not np.isnan(values).any(), f"{name} is nan"
        assert np.isfinite(values).all() or name not in RESULT_FIELDS, f"{name} is not finite"
    for quaternion in (shoulder(result), elbow(result)):
        np.testing.assert_allclose((quaternion**2).sum(axis=1), 1, rtol=0, atol=1e-14)
    assert (result["qs_k"] >= 0).all() and (result["qe_w"] >= 0).all() and (result["qe_i"] <= 0).all()
    if "length_sq" in result:
        assert (result["length_sq"] >= 1 / 8).all() and (result["length_sq"] <= 1 + 1e-15).all()


def assert_pose(targets):
    """Assert that `solve` puts the hand at the target, with a defined pose and the shoulder of the matrix form, which
    has no singular poses. Return the result."""
    result = solve(*targets)
    assert_defined(result)
    assert hand_error(result, targets).max() < HALF_OF_THE_DIGITS, "hand"
    matrix_form = shoulder_quaternion(swivel_normal(*targets[:4]), elbow_direction(targets))
    assert kinematics.angle_between(shoulder(result), matrix_form).max() < HALF_OF_THE_DIGITS, "shoulder"
    return result


TARGETS = random_targets(20_000, seed=1)
RESULT = solve(*TARGETS)


def test_poses_agree_with_forward_kinematics():
    x, y, z, _, d1, d2 = TARGETS
    regular = (RESULT["q3_scalar"] > np.sin(0.05 / 2)) & (np.abs(RESULT["q3_k"]) > np.sin(0.05 / 2))  # theta_3
    assert_pose(TARGETS)
    assert hand_error(RESULT, TARGETS)[regular].max() < 1e-12
    e = elbow_direction(TARGETS)
    gap = kinematics.angle_between(shoulder(RESULT), shoulder_quaternion(swivel_normal(*TARGETS[:4]), e))
    assert gap.max() < 1e-9 and gap[regular].max() < 1e-12, "(15)-(18)"
    elbows, _ = kinematics.forward(shoulder(RESULT), elbow(RESULT), d1, d2)
    p_e = np.stack([RESULT[f"p_e_{axis}"] for axis in "xyz"], axis=-1)
    np.testing.assert_allclose(p_e, elbows, rtol=0, atol=1e-13, err_msg="(13) against Qs")
    np.testing.assert_allclose(p_e, d1[:, None] * e, rtol=0, atol=1e-13, err_msg="(13)")
    cosine = (d1**2 + d2**2 - x**2 - y**2 - z**2) / (2 * d1 * d2)
    np.testing.assert_allclose(RESULT["c4"], cosine, rtol=0, atol=1e-13, err_msg="(14)")


@both
@pytest.mark.parametrize("exponent", [-9, 40])
def test_unit_of_length_does_not_matter(solver, exponent):
    x, y, z, phi, d1, d2 = TARGETS
    scaled = solver(*(np.ldexp(v, exponent) for v in (x, y, z)), phi, *(np.ldexp(v, exponent) for v in (d1, d2)))
    one = solver(*TARGETS)
    for name in RESULT_FIELDS:  # powers of two are exact, so even roundoff is the same
        np.testing.assert_array_equal(scaled[name], one[name], err_msg=name)


def solve_print(*target):
    """Return the results of (10)-(18) for six numbers by mpmath, as printed but with the missing square in (11)."""
    functions = {"sqrt": mpmath.sqrt, "cos": mpmath.cos, "sin": mpmath.sin, "Abs": abs}
    values = dict(zip(("p_w_x", "p_w_y", "p_w_z", "phi", "d1", "d2"), map(mpmath.mpf, target), strict=True))
    for number, lines in TEXT.items():
        for name, text in lines.items() if number != "(19)" else ():
            misprint = "l_sw*cos(phi/2))" if name in ("pi_swivel_x", "pi_swivel_y") else "none"
            values[name] = eval(text.replace(misprint, "l_sw*cos(phi/2)**2)"), functions, values)
    return [float(values[name]) for name in RESULT_FIELDS]


@pytest.mark.parametrize("region", sorted(set(REGIONS) - {"most unequal lengths"}))
def test_agrees_with_the_print_next_to_singular_poses(region):
    """Evaluate the printed equations with 80 digits, since double precision is insufficient here. Where they are 0/0,
    on the z axis and at the limits of the reach, compare only flags."""
    words = stimuli.region(region, 150, 32, seed=2)
    asked = from_words(words, 0, 32, region)
    lean = solve_lean(*(getattr(asked, field) for field in FIELDS))
    np.testing.assert_array_equal(lean["flags"], expected_flags(words, 32))
    defined = (lean["flags"] == 0) & (lean["qe_w"] > 0) & (lean["qe_i"] < 0)
    targets = tuple(getattr(asked, field)[defined] for field in FIELDS)
    assert len(targets[0]) > 80
    with mpmath.workdps(80):
        paper = np.array([solve_print(*target) for target in zip(*targets, strict=True)])
    paper = dict(zip(RESULT_FIELDS, paper.T, strict=True))
    for solver, bound in BOUNDS.items():
        result = solver(*targets)
        assert_defined(result)
        assert angle(result, paper).max() < bound, f"{solver.__name__}: shoulder"
        assert np.abs(elbow_angle(result) - elbow_angle(paper)).max() < bound, f"{solver.__name__}: elbow"
        assert hand_error(result, targets).max() < bound, f"{solver.__name__}: hand"


@pytest.mark.parametrize("z", [0.5, -0.5])
def test_target_on_the_z_axis_takes_azimuth_0(z):
    """Check that `solve` and `solve_lean` return the limit of a target that approaches the axis along +x."""
    targets = columns(0, 0, z, PHIS, 0.4, 0.3)
    result, lean = assert_pose(targets), solve_lean(*targets)
    assert (lean["flags"] == ON_AXIS).all() and hand_error(lean, targets).max() < ROUNDOFF
    assert angle(lean, result).max() < HALF_OF_THE_DIGITS
    assert angle(result, solve(*columns(1e-12, 0, z, PHIS, 0.4, 0.3))).max() < HALF_OF_THE_DIGITS
    limit = solve_lean(*columns(1e-300, 0, z, PHIS, 0.4, 0.3))
    np.testing.assert_allclose(shoulder(lean), shoulder(limit), rtol=0, atol=1e-15)


def elbow_on_axis(up):
    bend, azimuth = np.array(np.meshgrid([0.3, 1.5, 2.8], np.linspace(0, 2 * np.pi, 33))).reshape(2, -1)
    forearm = 0.25 * np.stack((np.sin(bend) * np.cos(azimuth), np.sin(bend) * np.sin(azimuth), np.cos(bend) * up))
    return *(forearm + [[0], [0], [0.5 * up]]), 0 if up > 0 else np.pi, 0.5, 0.25


POINTS = np.repeat(
    [(0.75, 0, 0), (0, -0.75, 0), (0.25, 0.5, 0.5), (-0.5, 0.25, -0.5), (0, 0, 0.75)], len(PHIS), axis=0
).T
SINGULAR = {
    "elbow up": elbow_on_axis(1),
    "elbow down": elbow_on_axis(-1),
    "P_w in pi_yz2, inner product 0": (0, [0.5, -0.5, 0.5, -0.5], [0.2, 0.2, -0.3, -0.3], 0, 0.4, 0.3),
    # P_w is in pi_yz2 for every theta_3, and the printed sign is only roundoff.
    "straight": (*POINTS, np.tile(PHIS, 5), 0.5, 0.25),
    "closed": (*POINTS, np.tile(PHIS, 5), 1.25, 0.5),
    "closed back": (*POINTS, np.tile(PHIS, 5), 0.5, 1.25),
}


@pytest.mark.parametrize("kind", SINGULAR)
def test_exact_singular_poses(kind):
    assert_pose(columns(*SINGULAR[kind]))


@both
def test_defined_at_the_ends_of_the_number_range(solver):
    lengths = [1e-15, 1e-6, 1.0, 1e15]
    offsets = [0.0, 5e-324, 1e-300, 1e-160, 1e-100, 1e-31, 1e-29, 1e-16, 1e-8, 0.5, 1.0]
    d, x, y, z, phi = np.array(np.meshgrid(lengths, offsets, offsets, offsets, [0.0, 1.0, np.pi])).reshape(5, -1)
    targets = (d * x, -d * y, d * z, phi, d, d)
    result = solver(*targets)
    assert_defined(result)
    inside = pose_flags(*targets[:3], d, d) & ~ON_AXIS == 0
    assert hand_error(result, targets)[inside | (solver is solve)].max() < BOUNDS[solver]


def test_lean_equations_at_extreme_lengths():
    """Check that targets of extreme size are clamped, and that length ratios up to 10^30 cost no precision."""
    big = [-4e307, -1.0, 0.0, 5e-324, 1e-300, 4e307]
    x, y, z, d1, d2 = np.array(np.meshgrid(big, big, big, big, big)).reshape(5, -1)
    size, longer, shorter = np.max(np.abs((x, y, z)), axis=0), np.maximum(d1, d2), np.minimum(d1, d2)
    out_of_reach = (shorter <= 0) | (size > 2 * longer) | ((size < longer / 4) & (shorter < longer / 4))
    assert_defined(solve_lean(*(v[out_of_reach] for v in (x, y, z)), 0.3, d1[out_of_reach], d2[out_of_reach]))
    for d1, d2 in ((1e-15, 1.0), (1.0, 1e-15), (1e-15, 1e15), (1e15, 1e-15), (1e-3, 1e3), (1e-9, 1e6)):
        near = (1 + np.arange(-3, 4) * 2.0**-52) * max(d1, d2)
        targets = columns(np.append(near, 0.6 * max(d1, d2)), 0.0, np.append(0 * near, 0.8 * max(d1, d2)), 0.7, d1, d2)
        result = solve_lean(*targets)
        assert_defined(result)
        for pose in (result, direct(*targets)):
            assert hand_error(pose, targets)[result["flags"] == 0].max(initial=0) < ROUNDOFF
            assert angle(pose, result).max() < ROUNDOFF


def test_lean_roots_are_exact_next_to_the_limits():
    """Compare Qe with rational numbers, for length ratios up to 10^14 and targets within about an ulp of a limit."""
    rng = np.random.default_rng(10)
    d1 = rng.uniform(0.5, 1, 400)
    d2 = d1 * 10 ** rng.uniform(-14, 0, 400)
    limit = np.where(rng.random(400) < 0.5, d1 + d2, d1 - d2)
    x = limit * rng.choice([0.6, 1.0], 400)
    y = np.sqrt(np.maximum(limit * limit - x * x, 0))
    lean = solve_lean(x, y, 0.0, 0.3, d1, d2)
    assert np.abs(elbow_angle(direct(x, y, 0.0, 0.3, d1, d2)) - elbow_angle(lean)).max() < ROUNDOFF
    for n, row in enumerate(zip(x, y, 0 * x, d1, d2, strict=True)):
        for name, square in exact_squares(*row).items() if lean["flags"][n] == 0 else ():
            square = min(max(square, 0), 1)
            off = abs(Fraction(float(lean[name][n])) ** 2 - square)
            assert off <= square * Fraction(2) ** -50, f"{name} of {row}"


def test_flags_are_exact_at_the_limits():
    """Check targets exactly at a limit, 2^2 + 3^2 + 6^2 = 7^2, in units of 50 bits: their squares fill two doubles."""
    unit = np.random.default_rng(11).integers(2**49, 2**50, 500).astype(float)
    for d1, d2 in ((3, 4), (4, 3), (1, 8), (8, 1)):
        assert (direct(2 * unit, -3 * unit, 6 * unit, 0.3, d1 * unit, d2 * unit)["flags"] == 0).all()


def exact_squares(*lengths):
    """Return the squares of qe_w and qe_i as fractions."""
    x, y, z, d1, d2 = (Fraction(float(v)) for v in lengths)
    s = x * x + y * y + z * z
    return {"qe_w": ((d1 + d2) ** 2 - s) / (4 * d1 * d2), "qe_i": (s - (d1 - d2) ** 2) / (4 * d1 * d2)}


ANYWHERE, UP = directions(np.random.default_rng(3), 50), np.array([[0.0], [0.0], [1.0]])
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
"""Case -> positions, lengths, flags, distances of elbow and wrist along the target, True for a closed arm."""


@pytest.mark.parametrize("case", CLAMPED)
def test_clamped_arms_lie_along_the_target(case):
    p, lengths, flags, elbow_at, wrist_at, closed = CLAMPED[case]
    targets = columns(*p, np.linspace(-3, 3, 50), *lengths)
    p = np.stack(targets[:3], axis=-1)
    size = np.linalg.norm(p, axis=1, keepdims=True)
    direction = np.where(size > 0, p / np.maximum(size, 1e-300), (0, 0, 1))
    for solver in (solve_clamped, solve_lean, *([direct] if min(lengths) > 0 else [])):
        result = solver(*targets)
        assert_defined(result)
        assert (result["flags"] == flags).all(), f"flags {sorted(set(result['flags']))}"
        elbows, wrist = kinematics.forward(shoulder(result), elbow(result), *targets[4:])
        np.testing.assert_allclose(elbows, elbow_at * direction, atol=1e-14, err_msg="elbow")
        np.testing.assert_allclose(wrist, wrist_at * direction, atol=1e-14, err_msg="wrist")
        assert (elbow(result) == ((1, 0) if closed else (0, -1))).all(), "Qe"
        local_x = kinematics.rotate(shoulder(result), np.array([(1.0, 0.0, 0.0)]))
        np.testing.assert_allclose(local_x, -swivel_normal(*targets[:4]), atol=1e-14, err_msg="swivel plane")


def test_words_of_the_core():
    """Compare flags with the integer rule, and poses with each other, for random, small and extreme words."""
    rng = np.random.default_rng(5)
    words = rng.integers(-(2**31), 2**31, (3000, 6))
    words[:2000] = rng.integers(-3, 4, (2000, 6))
    words[2000:2200] = rng.choice([-(2**31), 2**31 - 1, 0, 1, -1], (200, 6))
    scaled = words * 2.0**-30
    targets = (*scaled.T[:3], words[:, 3] * (np.pi / 2**31), *scaled.T[4:])
    lean, paper = solve_lean(*targets), solve_clamped(*targets)
    for result in (lean, paper):
        assert_defined(result)
        np.testing.assert_array_equal(result["flags"], expected_flags(words, 32))
    positive = (words[:, 4:] > 0).all(axis=1)
    plain, same = direct(*(v[positive] for v in targets)), {name: v[positive] for name, v in lean.items()}
    np.testing.assert_array_equal(plain["flags"], same["flags"])
    assert angle(plain, same).max() < ROUNDOFF and np.abs(elbow_angle(plain) - elbow_angle(same)).max() < ROUNDOFF
    clamped = lean["flags"] & ~ON_AXIS != 0
    assert 0.1 < clamped.mean() < 0.95, "both kinds"
    assert angle(lean, paper)[clamped].max() < ROUNDOFF
    assert angle(lean, paper).max() < 1e-7, "small words hit singular poses, where the paper keeps half of the digits"


@pytest.mark.parametrize(
    "solver, arguments, message",
    [
        *(
            (solver, *row)
            for solver in (solve, solve_lean)
            for row in (
                ((np.nan, 0, 0.5, 0, 0.4, 0.3), "x must be finite"),
                ((0.1, 0, 0.5, np.inf, 0.4, 0.3), "phi must be finite"),
                ((np.zeros((2, 2)), 0, 0.5, 0, 0.4, 0.3), r"of shape \(N,\), not \(2, 2\)"),
                ((np.zeros(2), np.zeros(3), 0.5, 0, 0.4, 0.3), "broadcast"),
            )
        ),
        (solve, (0.1, 0, 0.5, 0, 0.0, 0.3), "d1 of a target in reach must lie in"),
        (solve, (0.1, 0, 0.5, 0, 0.4, 1e16), "d2 of a target in reach must lie in"),
        (solve, (0.1, 0, [0.5, 0.8], 0, 0.4, 0.3), "target 1 cannot be reached"),
        (solve, (0.0, 0, 0.05, 0, 0.4, 0.3), "target 0 cannot be reached"),
        (solve_lean, (0.1e16, 0, 0.5, 0, 1e16, 1e16), "d1 of a target in reach must lie in"),
    ],
)
def test_bad_input_is_refused(solver, arguments, message):
    with pytest.raises(ValueError, match=message):
        solver(*arguments)

# SPDX-License-Identifier: Apache-2.0
"""Test the reference: equations against forward kinematics, the printed text and each other; section 3 as geometry;
blades, quaternions and half angles of section 2.

Over 10^5 targets of `random_targets`, the errors of `solve` are at most 2e-14 of the reach (hand) and 3e-14 rad
(shoulder, against the rotation matrix) if theta_3 is 0.05 rad or more from 0 and pi, 1e-11 and 3e-11 for any theta_3,
and about 1e-8 at 0 or pi. The errors of `solve_lean` are 1.4e-15 over the whole workspace. Next to singular poses,
`solve_lean` is within 1e-15 rad of the printed equations in 80 digits, `solve` within 3e-8 rad. `solve` and geometry
differ by 3e-12 rad at the shoulder (3e-14 rad if theta_3 is not near 0 or pi), 8e-14 rad at the elbow, 2e-14 in p_e.
"""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from model.io import stimuli
from model.io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, expected_flags
from model.io.stimuli import REGIONS
from model.io.words import FIELDS, RESULT_FIELDS, from_words
from model.reference import cga, geometry, kinematics
from model.reference.equations import TEXT, pose_flags, solve, solve_clamped, swivel_normal
from model.reference.lean_equations import solve_direct, solve_lean

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


def random_targets(size, seed):
    """Return random reachable targets off singular poses: the elbow's interior angle is 0.05 rad or more from 0 and pi,
    and wrist and elbow are 0.05 rad or more from the z axis. theta_3 is not restricted."""
    rng = np.random.default_rng(seed)
    d1, d2 = rng.uniform(0.2, 1, (2, 4 * size))
    distance = rng.uniform(np.abs(d1 - d2), d1 + d2)
    targets = *(directions(rng, 4 * size) * distance), rng.uniform(-np.pi, np.pi, 4 * size), d1, d2
    result = direct(*targets)
    points = kinematics.forward(shoulder(result), elbow(result), *targets[4:])
    off_axis = np.min([np.hypot(*p[:, :2].T) / np.linalg.norm(p, axis=1) for p in points], axis=0) > np.sin(0.05)
    keep = np.flatnonzero(off_axis & (np.abs(elbow(result)).min(axis=1) > np.sin(0.05 / 2)))[:size]
    return tuple(column[keep] for column in targets)


def hand_error(result, targets):
    """Return the distance from the target to the wrist by forward kinematics, divided by the reach."""
    *p, _, d1, d2 = targets
    _, wrist = kinematics.forward(shoulder(result), elbow(result), d1, d2)
    return np.linalg.norm(wrist - np.stack(p, axis=-1), axis=1) / (d1 + d2)


def plane_error(result, targets):
    """Return the angle (rad) between the x axis of the upper arm and the negative normal of the swivel plane."""
    return np.linalg.norm(kinematics.rotate(shoulder(result), (1, 0, 0)) + swivel_normal(*targets[:4]), axis=1)


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


TARGETS = random_targets(20_000, seed=1)
RESULT = solve(*TARGETS)


def test_errors_of_the_papers_equations():
    """Check that the hand is at the target and the arm in the swivel plane, and that p_e is the elbow."""
    assert_defined(RESULT)
    regular = (RESULT["q3_scalar"] > np.sin(0.05 / 2)) & (np.abs(RESULT["q3_k"]) > np.sin(0.05 / 2))  # theta_3
    for error in (hand_error(RESULT, TARGETS), plane_error(RESULT, TARGETS)):
        assert error.max() < 1e-9 and error[regular].max() < 1e-12
    elbows, _ = kinematics.forward(shoulder(RESULT), elbow(RESULT), *TARGETS[4:])
    p_e = np.stack([RESULT[f"p_e_{axis}"] for axis in "xyz"], axis=-1)
    np.testing.assert_allclose(p_e, elbows, rtol=0, atol=1e-13, err_msg="(13) against Qs")


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
            values[name] = eval(text.replace("l_sw*cos(phi/2))", "l_sw*cos(phi/2)**2)"), functions, values)
    return [float(values[name]) for name in RESULT_FIELDS]


@pytest.mark.parametrize("region", sorted(set(REGIONS) - {"most unequal lengths"}))
def test_agrees_with_the_print_next_to_singular_poses(region):
    """Evaluate the printed equations with 80 digits, since double precision is insufficient here. Compare only flags
    where the equations are 0/0: on the z axis and at the limits of the reach."""
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


def test_every_target_of_small_integers():
    """Check all targets with coordinates -3 .. 3, lengths -1 .. 3 and swivel angles in eighths of a turn. They include
    both limits of the reach, the z axis, the shoulder, targets out of reach, and lengths that are not positive."""
    axes = *[range(-3, 4)] * 3, range(-4, 4), *[range(-1, 4)] * 2
    words = np.array(np.meshgrid(*axes)).reshape(6, -1)
    flags, (x, y, z, eighths, d1, d2) = expected_flags(words.T, 32), words
    targets = columns(x, y, z, eighths * (np.pi / 4), d1, d2)
    straight = flags & (TOO_FAR | BAD_LENGTH) != 0
    closed = (flags & (TOO_NEAR | AT_SHOULDER) != 0) & ~straight
    size = np.linalg.norm(words[:3], axis=0)
    direction = np.where(size > 0, words[:3] / np.maximum(size, 1), [[0], [0], [1]]).T
    wrist_at = np.select([straight, closed], [d1 + d2, np.abs(d1 - d2)], size)
    elbow_at = np.where(closed & (d1 < d2), -d1, d1)  # of a clamped arm
    for solver, bound in ((solve_clamped, HALF_OF_THE_DIGITS), (solve_lean, ROUNDOFF), (direct, ROUNDOFF)):
        rows = (d1 > 0) & (d2 > 0) if solver is direct else np.full(len(flags), True)
        clamped = (straight | closed)[rows]
        result = solver(*(column[rows] for column in targets))
        assert_defined(result)
        np.testing.assert_array_equal(result["flags"], flags[rows])
        elbows, wrists = kinematics.forward(shoulder(result), elbow(result), d1[rows], d2[rows])
        off = elbows - elbow_at[rows, None] * direction[rows], wrists - wrist_at[rows, None] * direction[rows]
        assert np.abs(off[0][clamped]).max() < 1e-14, "elbow"
        if solver is solve_clamped:
            p_e = np.stack([result[f"p_e_{axis}"] for axis in "xyz"], axis=-1)
            np.testing.assert_allclose(p_e, elbows, rtol=0, atol=6 * bound, err_msg="p_e")
        off = np.linalg.norm(off[1], axis=1) / 6, plane_error(result, [column[rows] for column in targets])
        assert (np.max(off, axis=0) < np.where(clamped, 1e-14, bound)).all(), "wrist or swivel plane"
        assert (elbow(result)[closed[rows]] == (1, 0)).all() and (elbow(result)[straight[rows]] == (0, -1)).all(), "Qe"
    on_axis = (flags & ON_AXIS != 0) & (z != 0)
    beside = swivel_normal(np.where(on_axis, 1e-300, x), *targets[1:4])  # azimuth 0 is the limit along +x
    np.testing.assert_allclose(swivel_normal(*targets[:4]), beside, rtol=0, atol=1e-15)


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
    for n in np.flatnonzero(lean["flags"] == 0):
        x_n, y_n, upper, fore = (Fraction(float(column[n])) for column in (x, y, d1, d2))
        s = x_n**2 + y_n**2
        for name, numerator in (("qe_w", (upper + fore) ** 2 - s), ("qe_i", s - (upper - fore) ** 2)):
            square = min(max(numerator / (4 * upper * fore), 0), 1)
            off = abs(Fraction(float(lean[name][n])) ** 2 - square)
            assert off <= square * Fraction(2) ** -50, f"{name} of target {n}"


def test_flags_are_exact_at_the_limits():
    """Check targets exactly at a limit: (2, 3, 6), of length 7, times 50-bit integers; their squares need two
    doubles."""
    unit = np.random.default_rng(11).integers(2**49, 2**50, 500).astype(float)
    for d1, d2 in ((3, 4), (4, 3), (1, 8), (8, 1)):
        assert (direct(2 * unit, -3 * unit, 6 * unit, 0.3, d1 * unit, d2 * unit)["flags"] == 0).all()


def test_words_of_the_core():
    """Compare flags with the integer rule, and both solvers with each other, for random words, extremes and corners."""
    words = np.concatenate([stimuli.mixed(2500, 32, seed=5), stimuli.extremes(500, 32, seed=5)])
    asked = from_words(words, 0, 32, "words")
    targets = [getattr(asked, field) for field in FIELDS]
    lean = solve_lean(*targets)
    assert_defined(lean)
    np.testing.assert_array_equal(lean["flags"], expected_flags(words, 32))
    positive = (words[:, 4:] > 0).all(axis=1)
    plain, same = direct(*(v[positive] for v in targets)), {name: v[positive] for name, v in lean.items()}
    np.testing.assert_array_equal(plain["flags"], same["flags"])
    assert angle(plain, same).max() < ROUNDOFF and np.abs(elbow_angle(plain) - elbow_angle(same)).max() < ROUNDOFF


@pytest.mark.parametrize(
    "solvers, arguments, message",
    [
        ((solve, solve_lean), (np.nan, 0, 0.5, 0, 0.4, 0.3), "x must be finite"),
        ((solve, solve_lean), (0.1, 0, 0.5, np.inf, 0.4, 0.3), "phi must be finite"),
        ((solve, solve_lean), (np.zeros((2, 2)), 0, 0.5, 0, 0.4, 0.3), r"of shape \(N,\), not \(2, 2\)"),
        ((solve, solve_lean), (np.zeros(2), np.zeros(3), 0.5, 0, 0.4, 0.3), "broadcast"),
        ((solve, solve_lean), (0.1e16, 0, 0.5, 0, 1e16, 1e16), "d1 of a target in reach must lie in"),
        ((solve,), (0.1, 0, 0.5, 0, 0.0, 0.3), "d1 of a target in reach must lie in"),
        ((solve,), (0.1, 0, 0.5, 0, 0.4, 1e16), "d2 of a target in reach must lie in"),
        ((solve,), (0.1, 0, [0.5, 0.8], 0, 0.4, 0.3), "target 1 cannot be reached"),
        ((solve,), (0.0, 0, 0.05, 0, 0.4, 0.3), "target 0 cannot be reached"),
    ],
)
def test_bad_input_is_refused(solvers, arguments, message):
    for solver in solvers:
        with pytest.raises(ValueError, match=message):
            solver(*arguments)


RNG = np.random.default_rng(20080101)


def close(a, b, what="", atol=1e-12):
    np.testing.assert_allclose(a, b, rtol=0, atol=atol, err_msg=what)


def test_each_blade_reads_as_itself():
    basis = {"e1": cga.e1, "e2": cga.e2, "e3": cga.e3, "einf": cga.e_inf, "e0": cga.e_0}
    for blade in cga.BLADES:
        mv = cga.scalar(1)
        for name in blade.split("^") if blade != "1" else ():
            mv = mv ^ basis[name]
        for name in cga.BLADES:
            assert cga.coefficient(mv, name) == (name == blade), f"{name} in {blade}"
    with pytest.raises(KeyError, match="e2\\^e1"):
        cga.coefficient(cga.e1, "e2^e1")


def test_product_and_rotation_are_those_of_the_algebra():
    a, b, v = RNG.normal(size=(40, 4)), RNG.normal(size=(40, 4)), RNG.normal(size=(40, 3))
    Q_a, Q_b = cga.quaternion(*a.T), cga.quaternion(*b.T)
    close(kinematics.multiply(a, b).T, cga.quaternion_coefficients(Q_a * Q_b), "a b")
    turned, of_algebra = kinematics.rotate(a, v), cga.rotate(Q_a, cga.vector(*v.T))
    close(turned.T, (of_algebra.e1, of_algebra.e2, of_algebra.e3), "Q v Q~, Q of any length")
    np.testing.assert_array_equal(kinematics.rotate(a[0], v)[0], turned[0], err_msg="one quaternion")
    np.testing.assert_array_equal(kinematics.rotate(a, v[0])[0], turned[0], err_msg="one vector")


def test_angles():
    a = RNG.normal(size=(50, 4))
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    for angle in (0.0, 1e-15, 1e-9, 1e-4, 0.7, 3.0, np.pi):
        turn = np.column_stack((np.full(50, np.cos(angle / 2)), np.sin(angle / 2) * directions(RNG, 50).T))
        b = kinematics.multiply(a, turn)
        for other in (b, -b, 3 * b):
            close(kinematics.angle_between(a, other), angle, f"angle {angle}", atol=1e-15 + 1e-14 * angle)
    beyond = 1 + 1e-15
    assert cga.half_angle(beyond) == (1.0, 0.0) and cga.half_angle(-beyond) == (0.0, 1.0), "beyond 1 by roundoff"


def test_geometry_gives_the_equations():
    """Compare results with their signs, and scalars. The derivation proves the coefficients of (11), (12) and (15)."""
    solved = geometry.solve(*TARGETS)
    for bound, names in ((1e-9, "qs_w qs_i qs_j qs_k qe_w qe_i"), (1e-11, "l_sw p_e_x p_e_y p_e_z c4 c3 sign")):
        for name in names.split():
            close(solved[name], RESULT[name], name, bound)

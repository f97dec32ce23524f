# SPDX-License-Identifier: Apache-2.0
"""Lean dataflow in double precision: against the paper's equations, forward kinematics and exact integers.

Measured largest differences: 10^5 targets of the whole workspace 3e-11 rad (shoulder) and 9e-14 rad (elbow) from
`equations.solve`, whose hand error there is 1e-11 of the reach; the lean form has 1.4e-15. Next to singular poses
(`singular`) the print evaluated with 80 digits is 1e-15 rad from the lean form and up to 3e-8 rad from `solve`.
"""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy

from model.io.flags import ON_AXIS, expected_flags
from model.reference import kinematics, printed
from model.reference.equations import solve, solve_clamped
from model.reference.lean_equations import solve_lean
from model.reference.tests.test_equations import assert_unit, columns, hand_error, shoulder

RESULTS = ("qs_w", "qs_i", "qs_j", "qs_k", "qe_w", "qe_i")
NODES = (
    "rho_sq", "s", "a_far", "b_near", "k_law", "u_x", "u_y", "sin_el", "cos_el", "cos_a", "sin_a",
    "az_c", "az_s", "tilt_c", "tilt_s", "arm_c", "arm_s", "cos_h", "sin_h", "length_sq",
)  # fmt: skip
ROUNDOFF = 5e-15
"""Bounds in rad, and relative to the reach."""

EDGES = np.array([0.0, 1e-3, 1e-7, 1e-12, 1e-15])


def join(*groups):
    return tuple(np.concatenate(columns) for columns in zip(*groups, strict=True))


def elbow_angle(result):
    return 2 * np.arctan2(result["qe_i"], result["qe_w"])


def assert_defined(result):
    for name in (*RESULTS, *NODES[5:]):
        assert np.isfinite(result[name]).all(), f"{name} is not finite"
    assert not any(np.isnan(result[name]).any() for name in NODES), "nan"
    assert_unit(result)
    assert (result["qe_w"] >= 0).all() and (result["qe_i"] <= 0).all(), "signs of (14)"
    assert (result["length_sq"] >= 1 / 8).all() and (result["length_sq"] <= 1 + 1e-15).all(), "in [1/8, 1]"


def workspace(size, seed):
    """Return reachable targets of all poses: any direction, any distance between fold and stretch, any swivel."""
    rng = np.random.default_rng(seed)
    d1, d2 = rng.uniform(0.2, 1, (2, size))
    near = np.abs(d1 - d2)
    p = rng.normal(size=(3, size))
    p *= (near + (d1 + d2 - near) * rng.random(size)) / np.linalg.norm(p, axis=0)
    return *p, rng.uniform(-np.pi, np.pi, size), d1, d2


def singular(size, seed):
    """Return reachable targets 1e-2 to 1e-12 (relative) from poses where a root of the paper loses digits, by kind."""
    rng = np.random.default_rng(seed)
    d1, d2 = rng.uniform(0.2, 1, (2, size))
    near, reach = np.abs(d1 - d2), d1 + d2
    off = 10 ** rng.uniform(-12, -2, size)
    azimuth, phi = rng.uniform(-np.pi, np.pi, (2, size))
    v = rng.normal(size=(3, size))
    v /= np.linalg.norm(v, axis=0)
    distance = near + (reach - near) * rng.uniform(0.1, 0.9, size)
    axis = np.stack((np.sin(off) * np.cos(azimuth), np.sin(off) * np.sin(azimuth), np.cos(off) * rng.choice([-1, 1])))
    up = np.array([0.0, 0.0, 1.0])[:, None]
    # the elbow near +z: the forearm points anywhere in the swivel plane phi = 0 of its target
    bend = rng.uniform(0.3, 2.8, size)
    wrist = d1 * up + d2 * np.stack((np.sin(bend) * np.cos(azimuth), np.sin(bend) * np.sin(azimuth), np.cos(bend)))
    kinds = {
        "wrist near the z axis": (axis * distance, phi),
        "stretched": (v * reach * (1 - off), phi),
        "folded": (v * (near + reach * off), phi),
        "stretched near the z axis": (axis * reach * (1 - off), phi),
        "elbow near the z axis": (wrist, off * rng.choice([-1, 1], size)),
        "theta_3 near 0 or pi": (v * distance, _swivel_of_theta_3(v, distance, d1, d2, off)),
    }
    kinds = {kind: (*p, swivel, d1, d2) for kind, (p, swivel) in kinds.items()}
    for kind, targets in kinds.items():
        inside = solve_lean(*targets)["flags"] == 0
        assert inside.mean() > 0.9, kind
        kinds[kind] = tuple(column[inside] for column in targets)
    return kinds


def _swivel_of_theta_3(v, distance, d1, d2, off):
    """Return phi at which qs_w is near 0, by bisection: theta_3 is 0 there."""
    low, high = np.zeros_like(off), np.full_like(off, 2 * np.pi)

    def signed(phi):
        result = solve_lean(*(v * distance), phi, d1, d2)
        return result["qs_w"] * np.sign(result["qs_k"])

    # Qs changes its sign over a full turn of phi, so w has a zero unless k, which is kept >= 0, has one first.
    first = signed(low)
    for _ in range(60):
        middle = (low + high) / 2
        same = signed(middle) * first > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return low + off


# -- the paper


def the_print():
    """Return (10)-(18) as printed, except for the square in (11): a function from six mpmath numbers to a dict."""
    lines = {}
    for number, rows in printed.TEXT.items():
        if number == "(19)":  # repeats the same sums
            continue
        for name, text in rows.items():
            if name in ("pi_swivel_x", "pi_swivel_y"):
                assert text.count("l_sw*cos(phi/2))") == 1, "the misprint"
                text = text.replace("l_sw*cos(phi/2))", "l_sw*cos(phi/2)**2)")
            lines[name] = printed._parse(text).doit()
    compiled = {
        name: (arguments := sorted(map(str, e.free_symbols)), sympy.lambdify(arguments, e, "mpmath"))
        for name, e in lines.items()
    }

    def evaluate(*target):
        names = ("p_w_x", "p_w_y", "p_w_z", "phi", "d1", "d2")
        values = dict(zip(names, (mpmath.mpf(float(v)) for v in target), strict=True))
        for name, (arguments, function) in compiled.items():
            values[name] = function(*(values[a] for a in arguments))
        return values

    return evaluate


def test_agrees_with_the_paper_on_100000_reachable_targets():
    targets = workspace(100_000, seed=1)
    lean, paper = solve_lean(*targets), solve(*targets)
    assert (lean["flags"] == 0).all(), "in reach"
    assert kinematics.angle_between(shoulder(lean), shoulder(paper)).max() < 1e-9, "shoulder"
    assert np.abs(elbow_angle(lean) - elbow_angle(paper)).max() < 1e-9, "elbow"
    assert hand_error(lean, targets).max() < ROUNDOFF, "forward kinematics reach the target"
    assert_defined(lean)


SINGULAR = singular(100, seed=2)


@pytest.mark.parametrize("kind", SINGULAR)
def test_agrees_with_the_print_next_to_singular_poses(kind):
    """Double precision is insufficient for the paper's equations there: they are evaluated with 80 digits."""
    targets = SINGULAR[kind]
    lean = solve_lean(*targets)
    with mpmath.workdps(80):
        paper = [the_print_at(*target) for target in zip(*targets, strict=True)]
    paper = {name: np.array([row[name] for row in paper]) for name in RESULTS}
    error = kinematics.angle_between(shoulder(lean), shoulder(paper))
    assert error.max() < ROUNDOFF, f"shoulder {error.max():.1e} rad"
    error = np.abs(elbow_angle(lean) - elbow_angle(paper))
    assert error.max() < ROUNDOFF, f"elbow {error.max():.1e} rad"
    same_sign = np.sign(lean["qs_k"]) == np.sign(paper["qs_k"])
    assert same_sign.all(), "k"
    assert hand_error(lean, targets).max() < ROUNDOFF, "hand"


EVALUATE = the_print()


def the_print_at(*target):
    return {name: float(value) for name, value in EVALUATE(*target).items() if name in RESULTS}


# -- clamped poses and poses by convention


def test_target_on_the_z_axis_takes_azimuth_0():
    for z, elevation in ((0.5, 1.0), (-0.5, -1.0)):
        targets = columns(0, 0, z, np.linspace(-np.pi, np.pi, 17), 0.4, 0.3)
        lean = solve_lean(*targets)
        assert (lean["flags"] == ON_AXIS).all() and (lean["u_x"] == 1).all() and (lean["u_y"] == 0).all()
        assert (lean["sin_el"] == elevation).all() and (lean["cos_el"] == 0).all()
        assert hand_error(lean, targets).max() < ROUNDOFF, "hand"
        assert kinematics.angle_between(shoulder(lean), shoulder(solve(*targets))).max() < 1e-7, "half of the digits"
        limit = solve_lean(*columns(1e-300, 0, z, targets[3], 0.4, 0.3))
        np.testing.assert_allclose(shoulder(lean), shoulder(limit), rtol=0, atol=1e-15, err_msg="the limit from +x")


def test_words_of_the_core():
    """Every kind of small word, all corners of large ones: flags and poses of `solve_clamped`, exact squares."""
    rng = np.random.default_rng(5)
    words = rng.integers(-(2**31), 2**31, (3000, 6))
    words[:2000] = rng.integers(-3, 4, (2000, 6))
    words[2000:2200] = rng.choice([-(2**31), 2**31 - 1, 0, 1, -1], (200, 6))
    scaled = words * 2.0**-30
    targets = (*scaled.T[:3], words[:, 3] * (np.pi / 2**31), *scaled.T[4:])
    lean, paper = solve_lean(*targets), solve_clamped(*targets)
    assert_defined(lean)
    np.testing.assert_array_equal(lean["flags"], expected_flags(words, 32), err_msg="flags")
    clamped = lean["flags"] & ~ON_AXIS != 0
    assert 0.1 < clamped.mean() < 0.95, "both kinds"
    gap = kinematics.angle_between(shoulder(lean), shoulder(paper))
    assert gap[clamped].max() < ROUNDOFF, "clamped"
    assert gap.max() < 1e-7, "small words hit singular poses exactly, where the paper keeps half of the digits"
    for row, n in zip(words.tolist(), range(len(words)), strict=True):
        x, y, z, _, d1, d2 = row
        s = x * x + y * y + z * z
        exact = {"a_far": (d1 + d2) ** 2 - s, "b_near": s - (d1 - d2) ** 2, "k_law": s + d1 * d1 - d2 * d2}
        for name, value in exact.items():
            assert lean[name][n] == float(value) * 2.0**-60, f"{name} of {row}, rounded once"


# -- the nodes


def test_sums_are_exact_next_to_the_limits():
    """A, B and K against rational numbers, with links up to 10^14 apart and targets within an ulp of the limits."""
    rng = np.random.default_rng(10)
    size = 400
    d1 = rng.uniform(0.5, 1, size)
    d2 = d1 * 10 ** rng.uniform(-14, 0, size)
    limit = np.where(rng.random(size) < 0.5, d1 + d2, d1 - d2)
    x = np.where(rng.random(size) < 0.5, limit, d1) * np.where(rng.random(size) < 0.2, 0.6, 1)
    y = np.sqrt(np.maximum(limit * limit - x * x, 0)) * rng.choice([1, 1 + 2e-16, 1 - 1e-16], size)
    y = np.where((x == d1) & (rng.random(size) < 0.5), np.sqrt(2 * d1 * d2), y)  # x^2 + y^2 = r^2 except for d2^2
    d1, d2 = (np.where(swap, b, a) for swap in (rng.random(size) < 0.5,) for a, b in ((d1, d2), (d2, d1)))
    lean = solve_lean(x, y, 0.0, 0.3, d1, d2)
    assert_defined(lean)
    for n, row in enumerate(zip(x, y, d1, d2, strict=True)):
        x_n, y_n, d1_n, d2_n = (Fraction(float(v)) for v in row)
        s = x_n**2 + y_n**2
        exact = {"a_far": (d1_n + d2_n) ** 2 - s, "b_near": s - (d1_n - d2_n) ** 2, "k_law": s + d1_n**2 - d2_n**2}
        for name, value in exact.items():
            assert abs(Fraction(float(lean[name][n])) - value) <= abs(value) * Fraction(2) ** -52, f"{name} of {row}"


def test_nodes_are_what_their_names_say():
    x, y, z, phi, d1, d2 = targets = workspace(2000, seed=6)
    lean = solve_lean(*targets)
    rho, distance = np.hypot(x, y), np.sqrt(x**2 + y**2 + z**2)
    expected = {
        "rho_sq": rho**2,
        "s": distance**2,
        "a_far": (d1 + d2) ** 2 - distance**2,
        "b_near": distance**2 - (d1 - d2) ** 2,
        "k_law": distance**2 + d1**2 - d2**2,
        "u_x": x / rho,
        "u_y": y / rho,
        "sin_el": z / distance,
        "cos_el": rho / distance,
        "cos_a": (distance**2 + d1**2 - d2**2) / (2 * d1 * distance),
        "cos_h": np.cos(phi / 2),
        "sin_h": np.sin(phi / 2),
    }
    for name, value in expected.items():
        np.testing.assert_allclose(lean[name], value, rtol=0, atol=1e-14, err_msg=name)
    np.testing.assert_allclose(lean["cos_a"] ** 2 + lean["sin_a"] ** 2, 1, rtol=0, atol=1e-14)
    assert (lean["sin_a"] >= 0).all()
    for c, s, name in (
        (-lean["u_y"], lean["u_x"], "az"),
        (lean["sin_el"], lean["cos_el"], "tilt"),
        (lean["cos_a"], lean["sin_a"], "arm"),
    ):
        h_c, h_s = lean[f"{name}_c"], lean[f"{name}_s"]
        length = h_c**2 + h_s**2
        np.testing.assert_allclose(length, (1 + np.abs(c)) / 2, rtol=1e-14, err_msg=f"|{name}|^2")
        np.testing.assert_allclose((h_c**2 - h_s**2) / length, c, rtol=0, atol=1e-14, err_msg=f"{name}: cosine")
        np.testing.assert_allclose(2 * h_c * h_s / length, s, rtol=0, atol=1e-14, err_msg=f"{name}: sine")
    lengths = [lean[f"{name}_c"] ** 2 + lean[f"{name}_s"] ** 2 for name in ("az", "tilt", "arm")]
    np.testing.assert_allclose(lean["length_sq"], np.prod(lengths, axis=0), rtol=1e-14, err_msg="length_sq")


@pytest.mark.parametrize("branch", ["u_y", "sin_el", "cos_a"])
def test_continuous_where_a_branch_changes(branch):
    phi = np.linspace(-np.pi, np.pi, 33)
    pairs = []
    for side in (1, -1):
        for edge in EDGES:
            p, lengths = {
                "u_y": ((0.4, side * edge, 0.2), (0.4, 0.3)),
                "sin_el": ((0.3, 0.4, side * edge), (0.4, 0.3)),
                # right angle at the shoulder: 3-4-5
                "cos_a": ((0.0, 0.75 * (1 + side * edge), 0.0), (1.0, 1.25)),
            }[branch]
            pairs.append(columns(*p, phi, *lengths))
    targets = join(*pairs)
    lean = solve_lean(*targets)
    values = lean[branch].reshape(2, len(EDGES), len(phi))
    assert (values[0, 1:] > 0).all() and (values[1, 1:] < 0).all() and (values[:, 0] == 0).all(), "both branches"
    above, below = shoulder(lean).reshape(2, len(EDGES), len(phi), 4)
    for n, edge in enumerate(EDGES):
        gap = kinematics.angle_between(above[n], below[n]).max()
        assert gap < 10 * edge + ROUNDOFF, f"step {gap:.1e} rad over {edge:g}"
    assert hand_error(lean, targets).max() < ROUNDOFF, "hand"


@pytest.mark.parametrize("exponent", [-40, -10, 9, 10, 40])
def test_unit_of_length_does_not_matter(exponent):
    x, y, z, phi, d1, d2 = workspace(1000, seed=9)
    scaled = solve_lean(*(np.ldexp(v, exponent) for v in (x, y, z)), phi, *(np.ldexp(v, exponent) for v in (d1, d2)))
    one = solve_lean(x, y, z, phi, d1, d2)
    for name in (*NODES, *RESULTS):
        power = 2 * exponent if name in NODES[:5] else 0
        # Even powers of two are exact, so even roundoff is the same; an odd one moves the mantissas of d1 and d2.
        tolerance = 2e-15 if exponent % 2 else 0
        np.testing.assert_allclose(np.ldexp(scaled[name], -power), one[name], rtol=0, atol=tolerance, err_msg=name)


def test_defined_at_the_ends_of_the_number_range():
    lengths = [1e-15, 1e-6, 1.0, 1e15]
    offsets = [0.0, 5e-324, 1e-300, 1e-160, 1e-100, 1e-31, 1e-16, 1e-8, 0.5, 1.0]
    d, x, y, z, phi = np.array(np.meshgrid(lengths, offsets, offsets, offsets, [0.0, 1.0, np.pi])).reshape(5, -1)
    targets = (d * x, -d * y, d * z, phi, d, d)
    result = solve_lean(*targets)
    assert_defined(result)
    assert hand_error(result, targets)[result["flags"] & ~ON_AXIS == 0].max() < ROUNDOFF, "hand"
    big = [-4e307, -1.0, 0.0, 5e-324, 1e-300, 4e307]
    x, y, z, d1, d2 = np.array(np.meshgrid(big, big, big, big, big)).reshape(5, -1)
    size, longer, shorter = np.max(np.abs((x, y, z)), axis=0), np.maximum(d1, d2), np.minimum(d1, d2)
    out_of_reach = (shorter <= 0) | (size > 2 * longer) | ((size < longer / 4) & (shorter < longer / 4))
    result = solve_lean(*(v[out_of_reach] for v in (x, y, z)), 0.3, d1[out_of_reach], d2[out_of_reach])
    assert_defined(result)


def test_arms_of_very_unequal_links():
    """Limits of LENGTH_RANGE: the elbow's angle at the shoulder keeps its digits."""
    for d1, d2 in ((1e-15, 1.0), (1.0, 1e-15), (1e-15, 1e15), (1e15, 1e-15), (1e-3, 1e3), (1e-9, 1e6)):
        near = (1 + np.arange(-3, 4) * 2.0**-52) * max(d1, d2)
        targets = columns(np.append(near, 0.6 * max(d1, d2)), 0.0, np.append(0 * near, 0.8 * max(d1, d2)), 0.7, d1, d2)
        result = solve_lean(*targets)
        reached = result["flags"] == 0
        assert_defined(result)
        assert hand_error(result, targets)[reached].max(initial=0) < ROUNDOFF, "hand"


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((np.nan, 0, 0.5, 0, 0.4, 0.3), "x must be finite"),
        ((0.1, 0, 0.5, np.inf, 0.4, 0.3), "phi must be finite"),
        ((0.1e16, 0, 0.5, 0, 1e16, 1e16), "d1 of a target in reach must lie in"),
        ((np.zeros((2, 2)), 0, 0.5, 0, 0.4, 0.3), r"of shape \(N,\), not \(2, 2\)"),
    ],
)
def test_refused_input(arguments, message):
    with pytest.raises(ValueError, match=message):
        solve_lean(*arguments)

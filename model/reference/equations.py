# SPDX-License-Identifier: Apache-2.0
"""Layer 3 of the reference: equations (10)-(18) of the paper in double precision, with their corrections.

Corrections of the print: the squared cosine in the x and y rows of (11); d1 is the upper arm and d2 the
forearm. Where the print is 0/0 (target or elbow on the z axis, P_w in the plane pi_yz2) a rule is given at the
line.

Three sums use a form that is equal to the print but does not cancel: tmp1 with the products PP_m^+
PP_m^- of (19), since the squares it replaces are nearly equal unless d1 is about 1; and in (15) d1 - p_e_z
and tmp2, factored, since both lose all digits for an elbow near the z axis. Results therefore do not depend on the
unit of length.

`solve` is for reachable targets. `solve_clamped` accepts any target and returns flags, as the core does.
Lengths have any one unit, angles are in radians, arrays are float64 of shape (N,).
"""

from fractions import Fraction

import numpy as np

from ..io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, UNREACHABLE

LENGTH_RANGE = (1e-15, 1e15)
"""Accepted arm lengths: outside this range, products of six lengths would exceed the range of doubles."""

REACH_TOLERANCE = 1e-9
"""Fraction of d1+d2 beyond the exact limits at which `solve` still accepts a target as reachable."""

_TINY = 1e-30  # ratio of lengths below which products of the printed equations could underflow
_SIDE_NOISE = 1e-13  # the inner product of (17), over |p_w|, is roundoff below this


def columns(**values):
    """Return the arguments as float64 arrays of one shape (N,). ValueError for other shapes, nan and inf."""
    arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in values.values()))
    if arrays[0].ndim != 1:
        raise ValueError(f"inputs must be numbers or of shape (N,), not {arrays[0].shape}")
    for name, array in zip(values, arrays, strict=True):
        if not np.isfinite(array).all():
            raise ValueError(f"{name} must be finite")
    return arrays


def _check_reachable(x, y, z, d1, d2):
    low, high = LENGTH_RANGE
    for name, d in (("d1", d1), ("d2", d2)):
        if not ((d >= low) & (d <= high)).all():
            raise ValueError(
                f"{name} must lie in [{low:g}, {high:g}]; solve_clamped takes lengths that are not positive"
            )
    distance, reach = np.hypot(np.hypot(x, y), z), d1 + d2
    tolerance = REACH_TOLERANCE * reach
    missed = (distance > reach + tolerance) | (distance < np.abs(d1 - d2) - tolerance)
    if missed.any():
        raise ValueError(f"target {int(np.argmax(missed))} cannot be reached; solve_clamped takes such targets")


def swivel_normal(x, y, z, phi):
    """Return n = pi_swivel/|pi_swivel|, the unit normal of the swivel plane, for every target; (N, 3).

    On the z axis, where (11) is 0, azimuth 0 is used: (u_x, u_y) = (1, 0). A target at the shoulder counts
    as one on the positive z axis. phi in radians. Raises ValueError for inputs that are not finite or do not
    broadcast.
    """
    x, y, z, phi = columns(x=x, y=y, z=z, phi=phi)
    rho = np.hypot(x, y)
    distance = np.hypot(rho, z)
    on_axis, at_shoulder = rho == 0, distance == 0
    u_x = np.where(on_axis, 1.0, x / np.where(on_axis, 1.0, rho))
    u_y = np.where(on_axis, 0.0, y / np.where(on_axis, 1.0, rho))
    safe = np.where(at_shoulder, 1.0, distance)
    sin_elevation, cos_elevation = np.where(at_shoulder, 1.0, z / safe), rho / safe
    cos_phi, sin_phi = np.cos(phi), np.sin(phi)
    return np.stack(  # (11) / |pi_swivel|
        (
            cos_phi * u_y + sin_phi * sin_elevation * u_x,
            -cos_phi * u_x + sin_phi * sin_elevation * u_y,
            -sin_phi * cos_elevation,
        ),
        axis=-1,
    )


def shoulder_quaternion(n, e):
    """Return Qs (N, 4: w, i, j, k; k >= 0) from the swivel plane's normal n and the elbow's direction e, (N, 3).

    It is the rotation with the columns -n, e x (-n), e, equivalent to (15)-(18). n and e are
    orthogonal unit vectors. This form has no singular pose, so it also serves the clamped ones.
    """
    x_axis = -n
    y_axis = np.cross(e, x_axis)
    r = np.stack((x_axis, y_axis, e), axis=-1)
    r00, r11, r22 = r[:, 0, 0], r[:, 1, 1], r[:, 2, 2]
    w_i, w_j, w_k = r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]
    i_j, i_k, j_k = r[:, 1, 0] + r[:, 0, 1], r[:, 0, 2] + r[:, 2, 0], r[:, 2, 1] + r[:, 1, 2]
    # Each row is the quaternion times four times one of its components; the largest diagonal is the safest divisor.
    rows = np.stack(
        (
            np.stack((1 + r00 + r11 + r22, w_i, w_j, w_k), axis=-1),
            np.stack((w_i, 1 + r00 - r11 - r22, i_j, i_k), axis=-1),
            np.stack((w_j, i_j, 1 - r00 + r11 - r22, j_k), axis=-1),
            np.stack((w_k, i_k, j_k, 1 - r00 - r11 + r22), axis=-1),
        ),
        axis=1,
    )
    largest = np.argmax(np.diagonal(rows, axis1=1, axis2=2), axis=-1)
    q = rows[np.arange(len(rows)), largest]
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(q[:, 3:] < 0, -q, q)


def _half_angle(c):
    """Return cosine and sine, both >= 0, of half the angle whose cosine is c."""
    return np.sqrt(np.clip(1 + c, 0, 2) / 2), np.sqrt(np.clip(1 - c, 0, 2) / 2)  # (6), (7)


def _swivel_plane(x, y, z, phi, at_shoulder):
    """Compute section 3.1."""
    rho = np.hypot(x, y)
    l_sw = np.hypot(rho, z)  # (10)
    length = np.where(at_shoulder, 1.0, l_sw)
    cos_half, sin_half = np.cos(phi / 2), np.sin(phi / 2)
    # Correction: the last factor of the first two rows is squared.
    pi_swivel_x = (2 * cos_half * sin_half * z * x - y * length + 2 * y * length * cos_half**2) / length  # (11)
    pi_swivel_y = (2 * cos_half * sin_half * z * y + x * length - 2 * x * length * cos_half**2) / length  # (11)
    pi_swivel_z = -2 * sin_half * cos_half * (x**2 + y**2) / length  # (11)
    # (11) has length rho and vanishes on the z axis. A plane is homogeneous, so the unit normal is used there.
    p_x, p_y, p_z = (np.where(at_shoulder, 0.0, p) for p in (x, y, z))
    n = swivel_normal(p_x, p_y, p_z, phi)
    on_axis = at_shoulder | (rho <= _TINY * l_sw)
    return {
        "l_sw": l_sw,
        "pi_swivel_x": np.where(on_axis, n[:, 0], pi_swivel_x),
        "pi_swivel_y": np.where(on_axis, n[:, 1], pi_swivel_y),
        "pi_swivel_z": np.where(on_axis, n[:, 2], pi_swivel_z),
    }


def _elbow_point(x, y, z, d1, d2, at_shoulder, pi_swivel_x, pi_swivel_y, pi_swivel_z):
    """Compute section 3.2."""
    pp_i = pi_swivel_x * (x**2 + z**2 + y**2 + d1**2 - d2**2) / 2  # (12)
    pp_j = pi_swivel_y * (x**2 + z**2 + y**2 + d1**2 - d2**2) / 2  # (12)
    pp_k = pi_swivel_z * (x**2 + z**2 + y**2 + d1**2 - d2**2) / 2  # (12)
    pp_14 = (1 - d1**2) * (y * pi_swivel_z - z * pi_swivel_y) / 2  # (12)
    pp_15 = (1 + d1**2) * (z * pi_swivel_y - y * pi_swivel_z) / 2  # (12)
    pp_24 = (1 - d1**2) * (z * pi_swivel_x - x * pi_swivel_z) / 2  # (12)
    pp_25 = (1 + d1**2) * (x * pi_swivel_z - z * pi_swivel_x) / 2  # (12)
    pp_34 = (d1**2 - 1) * (y * pi_swivel_x - x * pi_swivel_y) / 2  # (12)
    pp_35 = (1 + d1**2) * (y * pi_swivel_x - x * pi_swivel_y) / 2  # (12)
    # PP_m^- = PP_m5 - PP_m4 and PP_m^+ = PP_m5 + PP_m4; the printed (19) has them for a PP scaled by 2.
    pp_1_minus = z * pi_swivel_y - y * pi_swivel_z  # (19)
    pp_2_minus = x * pi_swivel_z - z * pi_swivel_x  # (19)
    pp_3_minus = y * pi_swivel_x - x * pi_swivel_y  # (19)
    pp_1_plus, pp_2_plus, pp_3_plus = d1**2 * pp_1_minus, d1**2 * pp_2_minus, d1**2 * pp_3_minus  # (19)

    inf_pp = pp_3_minus**2 + pp_1_minus**2 + pp_2_minus**2  # (13)
    tmp1 = (
        -(pp_i**2) - pp_j**2 - pp_k**2 + pp_1_plus * pp_1_minus + pp_2_plus * pp_2_minus + pp_3_plus * pp_3_minus
    )  # (13), section 4.2
    tmp_sqr = np.sqrt(np.maximum(tmp1, 0.0))  # (13); tmp1 is 0 for a straight and for a folded arm
    divisor = np.where(at_shoulder, 1.0, inf_pp)
    p_e_x = (-pp_j * pp_3_minus + pp_k * pp_2_minus + tmp_sqr * pp_1_minus) / divisor  # (13)
    p_e_y = (pp_i * pp_3_minus - pp_k * pp_1_minus + tmp_sqr * pp_2_minus) / divisor  # (13)
    p_e_z = (pp_j * pp_1_minus - pp_i * pp_2_minus + tmp_sqr * pp_3_minus) / divisor  # (13)
    # With the wrist at the shoulder any elbow is right; the arm is folded, and points up.
    return {
        "pp_i": pp_i, "pp_j": pp_j, "pp_k": pp_k,
        "pp_14": pp_14, "pp_15": pp_15, "pp_24": pp_24, "pp_25": pp_25, "pp_34": pp_34, "pp_35": pp_35,
        "pp_1_minus": pp_1_minus, "pp_2_minus": pp_2_minus, "pp_3_minus": pp_3_minus,
        "pp_1_plus": pp_1_plus, "pp_2_plus": pp_2_plus, "pp_3_plus": pp_3_plus,
        "inf_pp": inf_pp, "tmp1": tmp1, "tmp_sqr": tmp_sqr,
        "p_e_x": np.where(at_shoulder, 0.0, p_e_x),
        "p_e_y": np.where(at_shoulder, 0.0, p_e_y),
        "p_e_z": np.where(at_shoulder, d1, p_e_z),
    }  # fmt: skip


def _elbow_quaternion(x, y, z, d1, d2, p_e_x, p_e_y, p_e_z):
    """Compute section 3.3."""
    c4 = (p_e_x**2 - p_e_x * x + p_e_y**2 - p_e_y * y - p_e_z * z + p_e_z**2) / (d1 * d2)  # (14)
    qe_w, sin_half = _half_angle(c4)  # (14)
    return {"c4": c4, "qe_w": qe_w, "qe_i": -sin_half}  # (14)


def _rotate_to_elbow(d1, p_e_x, p_e_y, p_e_z):
    """Compute section 3.4."""
    rho_sqr = p_e_x**2 + p_e_y**2
    # d1 - p_e_z, which cancels for an elbow near +z; there it is rho^2 / (d1 + p_e_z), as |p_e| = d1.
    below = np.where(p_e_z > 0, rho_sqr / (d1 + np.abs(p_e_z)), d1 - p_e_z)
    tmp2 = d1**2 * rho_sqr * (below**2 + rho_sqr)  # (15), the printed polynomial factored
    l_m = np.sqrt(tmp2)  # (15)
    # L_m vanishes for an elbow on the z axis. Any half turn that takes e3 there will do: Q_3 compensates for it.
    on_axis = np.hypot(p_e_x, p_e_y) <= _TINY * d1
    up, down = on_axis & (p_e_z > 0), on_axis & (p_e_z <= 0)
    divisor = np.where(on_axis, 1.0, l_m)
    q12_i = np.where(on_axis, down, d1 * p_e_x * below / divisor)  # (15)
    q12_j = np.where(on_axis, 0.0, d1 * p_e_y * below / divisor)  # (15)
    q12_k = np.where(on_axis, up, d1 * rho_sqr / divisor)  # (15)
    return {"tmp2": tmp2, "l_m": l_m, "q12_i": q12_i, "q12_j": q12_j, "q12_k": q12_k}


def _rotate_to_wrist(x, y, z, p_e, l_sw, pi_swivel, q12_i, q12_j, q12_k):
    """Compute section 3.5. p_e and pi_swivel are triples of arrays (N,)."""
    pi_swivel_x, pi_swivel_y, pi_swivel_z = pi_swivel
    c3 = (
        pi_swivel_x * (q12_k**2 + q12_j**2 - q12_i**2) - 2 * q12_i * (q12_j * pi_swivel_y + q12_k * pi_swivel_z)
    ) / np.sqrt(pi_swivel_x**2 + pi_swivel_y**2 + pi_swivel_z**2)  # (17)
    # (17), the quantity first called sign
    side = x * (q12_i**2 - q12_k**2 - q12_j**2) + 2 * q12_i * (q12_k * z + q12_j * y)
    # A straight or folded arm has P_w in pi_yz2 for every theta_3. The side of P_w is then the side of
    # p_e x pi_swivel, by the same formula. Elsewhere an inner product of 0 means Q_3 = 1 or +-k: either sign is
    # right.
    b_x, b_y, b_z = np.cross(np.stack(p_e, axis=-1), np.stack(pi_swivel, axis=-1)).T
    limit = b_x * (q12_i**2 - q12_k**2 - q12_j**2) + 2 * q12_i * (q12_k * b_z + q12_j * b_y)
    side = np.where(np.abs(side) <= _SIDE_NOISE * l_sw, limit, side)
    sign = np.where(side < 0, -1.0, 1.0)  # (17); 0 counts as +
    q3_scalar, sin_half = _half_angle(c3)  # (17)
    q3_k = sin_half * sign  # (17)
    return {"c3": c3, "sign": sign, "q3_scalar": q3_scalar, "q3_k": q3_k}


def solve(x, y, z, phi, d1, d2):
    """Solve equations (10)-(18) for N reachable targets.

    x, y, z (wrist target), d1 (upper arm), d2 (forearm) in one unit of length, phi in radians; numbers or
    arrays that broadcast to (N,). Returns a dict of float64 arrays (N,), one for every quantity of the paper,
    in its order: l_sw, pi_swivel_x/y/z, pp_i/j/k, pp_14 .. pp_35, pp_1_minus .. pp_3_plus (19), inf_pp, tmp1,
    tmp_sqr, p_e_x/y/z, c4, qe_w, qe_i, tmp2, l_m, q12_i/j/k, c3, sign, q3_scalar, q3_k, qs_w, qs_i, qs_j,
    qs_k. qs_k is >= 0.

    Never nan. Near poses where a half angle is 0 or pi (arm straight or folded, theta_3 = 0 or pi) the roots
    of (14) and (17) lose digits as the printed equations do, down to half of them at the pose;
    tests/test_equations.py has the figures.

    Raises ValueError for inputs that are not finite or do not broadcast, for arm lengths outside
    LENGTH_RANGE, and for targets out of reach by more than REACH_TOLERANCE of d1+d2.
    """
    x, y, z, phi, d1, d2 = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    _check_reachable(x, y, z, d1, d2)
    at_shoulder = np.hypot(np.hypot(x, y), z) <= _TINY * (d1 + d2)

    nodes = _swivel_plane(x, y, z, phi, at_shoulder)
    pi_swivel = tuple(nodes[f"pi_swivel_{axis}"] for axis in "xyz")
    nodes |= _elbow_point(x, y, z, d1, d2, at_shoulder, *pi_swivel)
    p_e = tuple(nodes[f"p_e_{axis}"] for axis in "xyz")
    nodes |= _elbow_quaternion(x, y, z, d1, d2, *p_e)
    nodes |= _rotate_to_elbow(d1, *p_e)
    q12_i, q12_j, q12_k = (nodes[f"q12_{unit}"] for unit in "ijk")
    nodes |= _rotate_to_wrist(x, y, z, p_e, nodes["l_sw"], pi_swivel, q12_i, q12_j, q12_k)
    q3_scalar, q3_k = nodes["q3_scalar"], nodes["q3_k"]
    return nodes | {
        "qs_w": -q12_k * q3_k,  # (18)
        "qs_i": q12_i * q3_scalar + q12_j * q3_k,  # (18)
        "qs_j": -(q12_i * q3_k - q12_j * q3_scalar),  # (18)
        "qs_k": q12_k * q3_scalar,  # (18)
    }


def _compare(x, y, z, radius):
    """Return the sign (-1, 0, 1) of |p|^2 - radius^2, exact: cases that rounding could decide use rational numbers."""
    distance = np.hypot(np.hypot(x, y), z)
    sign = np.sign(distance - np.abs(radius))
    for n in np.flatnonzero(np.abs(distance - np.abs(radius)) <= 1e-14 * distance):
        squares = [Fraction(float(value[n])) ** 2 for value in (x, y, z, radius)]
        difference = squares[0] + squares[1] + squares[2] - squares[3]
        sign[n] = (difference > 0) - (difference < 0)
    return sign


def pose_flags(x, y, z, d1, d2):
    """Return the flags of `model.io.flags` for N targets in double precision, (N,) int64, exact for the given doubles.

    Lengths in one unit. With bad_length the arm has no reach, so too_far and too_near stay clear. The flags are exact
    only if d1 + d2 and d1 - d2 are exact in double precision, as they are for words of the core. Raises ValueError for
    inputs that are not finite or do not broadcast.
    """
    x, y, z, d1, d2 = columns(x=x, y=y, z=z, d1=d1, d2=d2)
    on_axis = (x == 0) & (y == 0)
    bad_length = (d1 <= 0) | (d2 <= 0)
    conditions = {
        TOO_FAR: ~bad_length & (_compare(x, y, z, d1 + d2) > 0),
        TOO_NEAR: ~bad_length & (_compare(x, y, z, d1 - d2) < 0),
        ON_AXIS: on_axis,
        AT_SHOULDER: on_axis & (z == 0),
        BAD_LENGTH: bad_length,
    }
    return np.sum([bit * condition.astype(np.int64) for bit, condition in conditions.items()], axis=0)


def clamp(x, y, z, d1, d2):
    """Return the nearest pose for targets without one: too far, too near, at the shoulder, bad lengths.

    Lengths in one unit, numbers or arrays that broadcast to (N,). Returns a dict of arrays (N,): flags
    (int64), clamped (bool), the elbow's direction e_x, e_y, e_z (unit vector), qe_w, qe_i; the last five are
    nan where a target is not clamped. Raises ValueError for inputs that are not finite or do not broadcast.

    The arm is straight toward a target too far, and with bad lengths; it is folded (Qe = 1) for one too near
    or at the shoulder, with the longer link toward the target. The shoulder itself counts as lying in the
    direction +z.
    """
    x, y, z, d1, d2 = columns(x=x, y=y, z=z, d1=d1, d2=d2)
    flags = pose_flags(x, y, z, d1, d2)
    clamped = flags & (UNREACHABLE | AT_SHOULDER) != 0
    straight = flags & (TOO_FAR | BAD_LENGTH) != 0
    away = ~straight & (d1 < d2)
    distance = np.hypot(np.hypot(x, y), z)
    at_shoulder = distance == 0
    divisor = np.where(at_shoulder, 1.0, distance) * np.where(away, -1.0, 1.0)
    values = {
        "e_x": x / divisor,
        "e_y": y / divisor,
        "e_z": np.where(at_shoulder, 1.0, z) / divisor,
        "qe_w": np.where(straight, 0.0, 1.0),
        "qe_i": np.where(straight, -1.0, 0.0),
    }
    return {"flags": flags, "clamped": clamped} | {k: np.where(clamped, v, np.nan) for k, v in values.items()}


def solve_clamped(x, y, z, phi, d1, d2):
    """Return a pose for any N targets, with flags: `solve` for reachable targets, `clamp` for the others.

    Arguments as for `solve`, but lengths need not be positive nor targets in reach. Returns a dict of arrays
    (N,): qs_w, qs_i, qs_j, qs_k (k >= 0), qe_w, qe_i, p_e_x, p_e_y, p_e_z (user's unit), flags (int64). A
    clamped pose keeps the swivel: its shoulder turns the arm's plane to the target's swivel plane. Raises
    ValueError for inputs that are not finite or do not broadcast, and for positive arm lengths outside
    LENGTH_RANGE.
    """
    x, y, z, phi, d1, d2 = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    pose = clamp(x, y, z, d1, d2)
    clamped = pose["clamped"]
    e = np.stack([pose[f"e_{axis}"] for axis in "xyz"], axis=-1)[clamped]
    n = swivel_normal(x[clamped], y[clamped], z[clamped], phi[clamped])
    answers = dict(zip(("qs_w", "qs_i", "qs_j", "qs_k"), shoulder_quaternion(n, e).T, strict=True))
    answers |= {name: pose[name][clamped] for name in ("qe_w", "qe_i")}
    answers |= dict(zip(("p_e_x", "p_e_y", "p_e_z"), d1[clamped] * e.T, strict=True))
    reached = solve(*(values[~clamped] for values in (x, y, z, phi, d1, d2)))
    result = {}
    for name, values in answers.items():
        result[name] = np.empty(len(x))
        result[name][clamped] = values
        result[name][~clamped] = reached[name]
    return result | {"flags": pose["flags"]}

# SPDX-License-Identifier: Apache-2.0
"""Layer 3 of the reference: equations (10)-(18) of the paper as printed, and in double precision with corrections.

`TEXT` has the equations as printed, misprints included. `solve` evaluates them with `CORRECTIONS`: the missing square
in the x and y rows of (11), and three sums, rewritten to avoid cancellation. Where a printed line is 0/0, `CONVENTIONS`
gives its value. d1 is the upper arm and d2 the forearm; table 3 of the paper swaps them.

`solve` is for reachable targets; `solve_clamped` accepts any target and returns flags, as the core does. All lengths
have the same unit, which may be any; angles are in radians, arrays are float64 of shape (N,).
"""

from fractions import Fraction

import numpy as np

from ..io.flags import AT_SHOULDER, BAD_LENGTH, TOO_FAR, UNREACHABLE, combine
from .kinematics import quaternion

_REACH = "(p_w_x**2 + p_w_z**2 + p_w_y**2 + d1**2 - d2**2)"
C4 = "(p_e_x**2 - p_e_x*p_w_x + p_e_y**2 - p_e_y*p_w_y - p_e_z*p_w_z + p_e_z**2)/(d1*d2)"

TEXT: dict[str, dict[str, str]] = {
    "(10)": {"l_sw": "sqrt(p_w_x**2 + p_w_y**2 + p_w_z**2)"},
    "(11)": {
        "pi_swivel_x": "(2*cos(phi/2)*sin(phi/2)*p_w_z*p_w_x - p_w_y*l_sw + 2*p_w_y*l_sw*cos(phi/2))/l_sw",
        "pi_swivel_y": "(2*cos(phi/2)*sin(phi/2)*p_w_z*p_w_y + p_w_x*l_sw - 2*p_w_x*l_sw*cos(phi/2))/l_sw",
        "pi_swivel_z": "-2*sin(phi/2)*cos(phi/2)*(p_w_x**2 + p_w_y**2)/l_sw",
    },
    "(12)": {
        "pp_i": f"1/2*pi_swivel_x*{_REACH}",
        "pp_j": f"1/2*pi_swivel_y*{_REACH}",
        "pp_k": f"1/2*pi_swivel_z*{_REACH}",
        "pp_14": "1/2*(1 - d1**2)*(p_w_y*pi_swivel_z - p_w_z*pi_swivel_y)",
        "pp_15": "1/2*(1 + d1**2)*(p_w_z*pi_swivel_y - p_w_y*pi_swivel_z)",
        "pp_24": "1/2*(1 - d1**2)*(p_w_z*pi_swivel_x - p_w_x*pi_swivel_z)",
        "pp_25": "1/2*(1 + d1**2)*(p_w_x*pi_swivel_z - p_w_z*pi_swivel_x)",
        "pp_34": "1/2*(d1**2 - 1)*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
        "pp_35": "1/2*(1 + d1**2)*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
    },
    "(13)": {
        "inf_pp": "(pp_35 - pp_34)**2 + (pp_14 - pp_15)**2 + (pp_25 - pp_24)**2",
        "tmp1": "-pp_i**2 - pp_j**2 - pp_k**2 - pp_14**2 + pp_15**2 - pp_24**2 + pp_25**2 - pp_34**2 + pp_35**2",
        "tmp_sqr": "sqrt(tmp1)",
        "p_e_x": "(pp_j*(pp_34 - pp_35) + pp_k*(pp_25 - pp_24) + tmp_sqr*(pp_15 - pp_14))/inf_pp",
        "p_e_y": "(pp_i*(pp_35 - pp_34) + pp_k*(pp_14 - pp_15) + tmp_sqr*(pp_25 - pp_24))/inf_pp",
        "p_e_z": "(pp_j*(pp_15 - pp_14) + pp_i*(pp_24 - pp_25) + tmp_sqr*(pp_35 - pp_34))/inf_pp",
    },
    "(14)": {"qe_w": f"sqrt((1 + {C4})/2)", "qe_i": f"-sqrt((1 - {C4})/2)"},
    "(15)": {
        "tmp2": "d1**4*p_e_y**2 - 2*d1**3*p_e_y**2*p_e_z + d1**2*p_e_y**2*p_e_z**2"
        " + d1**4*p_e_x**2 - 2*d1**3*p_e_x**2*p_e_z + d1**2*p_e_x**2*p_e_z**2"
        " + d1**2*p_e_x**4 + 2*d1**2*p_e_x**2*p_e_y**2 + d1**2*p_e_y**4",
        "l_m": "sqrt(tmp2)",
        "q12_i": "d1*p_e_x*(d1 - p_e_z)/l_m",
        "q12_j": "d1*p_e_y*(d1 - p_e_z)/l_m",
        "q12_k": "d1*(p_e_x**2 + p_e_y**2)/l_m",
    },
    "(17)": {
        "c3": "(pi_swivel_x*(q12_k**2 + q12_j**2 - q12_i**2) - 2*q12_i*(q12_j*pi_swivel_y + q12_k*pi_swivel_z))"
        "/sqrt(pi_swivel_x**2 + pi_swivel_y**2 + pi_swivel_z**2)",
        "sign_raw": "p_w_x*(q12_i**2 - q12_k**2 - q12_j**2) + 2*q12_i*(q12_k*p_w_z + q12_j*p_w_y)",
        "sign": "sign_raw/Abs(sign_raw)",
        "q3_scalar": "sqrt((1 + c3)/2)",
        "q3_k": "sqrt((1 - c3)/2)*sign",
    },
    "(18)": {
        "qs_w": "-q12_k*q3_k",
        "qs_i": "q12_i*q3_scalar + q12_j*q3_k",
        "qs_j": "-(q12_i*q3_k - q12_j*q3_scalar)",
        "qs_k": "q12_k*q3_scalar",
    },
    "(19)": {
        "pp_1_plus": "2*d1**2*(p_w_z*pi_swivel_y - p_w_y*pi_swivel_z)",
        "pp_2_plus": "2*d1**2*(p_w_x*pi_swivel_z - p_w_z*pi_swivel_x)",
        "pp_3_plus": "2*d1**2*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
        "pp_1_minus": "2*(p_w_z*pi_swivel_y - p_w_y*pi_swivel_z)",
        "pp_2_minus": "2*(p_w_x*pi_swivel_z - p_w_z*pi_swivel_x)",
        "pp_3_minus": "2*(p_w_y*pi_swivel_x - p_w_x*pi_swivel_y)",
    },
}
"""Equation -> line -> right-hand side as printed. (17) repeats (16); the first of its two lines sign is `sign_raw`."""

LENGTH_RANGE = (1e-15, 1e15)  # accepted arm lengths: products of six lengths stay within the range of doubles

REACH_TOLERANCE = 1e-9  # largest distance of a target out of reach that `solve` accepts, relative to d1+d2

_FUNCTIONS = {
    "sqrt": lambda v: np.sqrt(np.maximum(v, 0.0)),  # tmp1, 0 for a straight or closed arm, may round below 0
    "cos": np.cos,
    "sin": np.sin,
    "Abs": np.abs,
    "hypot": np.hypot,
    "clip": lambda v: np.clip(v, -1.0, 1.0),
    "where": np.where,
    "TINY": 1e-30,  # ratio of lengths below which products of the printed equations could underflow
    "NOISE": 1e-13,  # sign_raw / l_sw is roundoff below this
}

CORRECTIONS = {
    "(10)": {
        "l_sw": "hypot(hypot(p_w_x, p_w_y), p_w_z)",
        "at_shoulder": "l_sw <= TINY*(d1 + d2)",
        "on_axis": "at_shoulder | (hypot(p_w_x, p_w_y) <= TINY*l_sw)",
    },
    "(11)": {name: text.replace("l_sw*cos(phi/2))", "l_sw*cos(phi/2)**2)") for name, text in TEXT["(11)"].items()},
    "(12)": {},
    "(19)": {name: text.removeprefix("2*") for name, text in TEXT["(19)"].items()},  # printed for twice the PP of (12)
    # Section 4.2: the squares of PP_m4 and PP_m5 are nearly equal unless d1 is about 1.
    "(13)": {
        "tmp1": "-pp_i**2 - pp_j**2 - pp_k**2 + pp_1_plus*pp_1_minus + pp_2_plus*pp_2_minus + pp_3_plus*pp_3_minus"
    },
    "(14)": {"c4": f"clip({C4})"} | {name: text.replace(C4, "c4") for name, text in TEXT["(14)"].items()},
    "(15)": {
        "rho_sqr": "p_e_x**2 + p_e_y**2",
        # d1 - p_e_z cancels for an elbow near +z. Since |p_e| = d1, it equals rho^2 / (d1 + p_e_z).
        "below": "where(p_e_z > 0, rho_sqr/(d1 + Abs(p_e_z)), d1 - p_e_z)",
        "tmp2": "d1**2*rho_sqr*(below**2 + rho_sqr)",  # the printed polynomial, factored
        "elbow_on_axis": "hypot(p_e_x, p_e_y) <= TINY*d1",
    },
    "(17)": {
        "c3": f"clip({TEXT['(17)']['c3']})",
        # For a straight or closed arm, P_w lies in pi_yz2 at every theta_3: p_e x pi_swivel then replaces P_w in
        # the formula. In other poses an inner product of 0 means Q_3 = 1 or +-k: either sign is right.
        "side_x": "p_e_y*pi_swivel_z - p_e_z*pi_swivel_y",
        "side_y": "p_e_z*pi_swivel_x - p_e_x*pi_swivel_z",
        "side_z": "p_e_x*pi_swivel_y - p_e_y*pi_swivel_x",
        "limit": TEXT["(17)"]["sign_raw"].replace("p_w_", "side_"),
        "sign_raw": TEXT["(17)"]["sign_raw"],
        "sign": "where(where(Abs(sign_raw) <= NOISE*l_sw, limit, sign_raw) < 0, -1.0, 1.0)",
    },
    "(18)": {},
}
"""Equation, in the order of evaluation -> line -> replacement of the printed right-hand side, or auxiliary line."""

CONVENTIONS = {
    # (11) has length rho and vanishes on the z axis. A plane is homogeneous, so the unit normal is used there.
    **{f"pi_swivel_{axis}": f"on_axis, normal_{axis}" for axis in "xyz"},
    # With the wrist at the shoulder, every elbow point is right; by convention the closed arm points up.
    "p_e_x": "at_shoulder, 0.0",
    "p_e_y": "at_shoulder, 0.0",
    "p_e_z": "at_shoulder, d1",
    # L_m vanishes for an elbow on the z axis. Every half turn that takes e3 to the elbow is right: Q_3 compensates.
    "q12_i": "elbow_on_axis, p_e_z <= 0",
    "q12_j": "elbow_on_axis, 0.0",
    "q12_k": "elbow_on_axis, p_e_z > 0",
}
"""Line -> condition under which the printed line is 0/0, and the value used then."""


def _compile(name, text):
    for m in "123":  # PP_m5 - PP_m4 cancels
        text = text.replace(f"pp_{m}5 - pp_{m}4", f"pp_{m}_minus").replace(f"pp_{m}4 - pp_{m}5", f"-pp_{m}_minus")
    if name.startswith("q12"):
        text = text.replace("(d1 - p_e_z)", "below")
    return compile(f"where({CONVENTIONS[name]}, {text})" if name in CONVENTIONS else text, name, "eval")


_LINES = {
    name: _compile(name, text)
    for number, lines in CORRECTIONS.items()
    for name, text in (lines | TEXT[number] | lines).items()
}


def columns(**values):
    """Return the arguments broadcast to float64 arrays (N,). Raises ValueError for other shapes, nan and inf."""
    arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in values.values()))
    if arrays[0].ndim != 1:
        raise ValueError(f"inputs must be numbers or of shape (N,), not {arrays[0].shape}")
    for name, array in zip(values, arrays, strict=True):
        if not np.isfinite(array).all():
            raise ValueError(f"{name} must be finite")
    return arrays


def check_lengths(d1, d2, rows=slice(None)):
    """Raise ValueError if an arm length is outside LENGTH_RANGE in `rows`, which select the targets in reach."""
    low, high = LENGTH_RANGE
    for name, d in (("d1", d1[rows]), ("d2", d2[rows])):
        if not ((d >= low) & (d <= high)).all():
            raise ValueError(f"{name} of a target in reach must lie in [{low:g}, {high:g}]")


def swivel_normal(x, y, z, phi):
    """Return the unit normals (N, 3) of the swivel planes, pi_swivel/|pi_swivel|.

    On the z axis, where (11) is 0, azimuth 0 is taken. A target at the shoulder counts as a target on +z.
    Raises ValueError for inputs that are not finite or do not broadcast.
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
    n_x = cos_phi * u_y + sin_phi * sin_elevation * u_x  # (11) / |pi_swivel|
    n_y = -cos_phi * u_x + sin_phi * sin_elevation * u_y
    return np.stack((n_x, n_y, -sin_phi * cos_elevation), axis=-1)


def solve(x, y, z, phi, d1, d2):
    """Solve equations (10)-(18) for N reachable targets.

    Arguments are numbers or arrays that broadcast to (N,). Returns a dict of arrays (N,): every line of `TEXT` and
    `CORRECTIONS`, with qs_k >= 0 and no nan. Where the arm is almost straight or closed, or theta_3 almost 0 or pi,
    the roots of (14) and (17) lose digits, as in the printed equations; at such a pose they lose half of the digits.

    Raises ValueError for inputs that are not finite or do not broadcast, for arm lengths outside LENGTH_RANGE, and for
    targets out of reach by more than REACH_TOLERANCE.
    """
    x, y, z, phi, d1, d2 = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    check_lengths(d1, d2)
    distance, reach = np.hypot(np.hypot(x, y), z), d1 + d2
    tolerance = REACH_TOLERANCE * reach
    missed = (distance > reach + tolerance) | (distance < np.abs(d1 - d2) - tolerance)
    if missed.any():
        raise ValueError(f"target {int(np.argmax(missed))} cannot be reached; solve_clamped takes such targets")
    at_shoulder = distance <= _FUNCTIONS["TINY"] * reach
    p = np.where(at_shoulder, 0.0, (x, y, z))
    normal = swivel_normal(p[0], p[1], p[2], phi)
    values = {"p_w_x": x, "p_w_y": y, "p_w_z": z, "phi": phi, "d1": d1, "d2": d2}
    values |= {f"normal_{axis}": normal[:, n] for n, axis in enumerate("xyz")}
    with np.errstate(divide="ignore", invalid="ignore"):  # replaced by CONVENTIONS
        for name, code in _LINES.items():
            values[name] = eval(code, _FUNCTIONS, values)
    return {name: values[name] for name in _LINES}


def _compare(x, y, z, radius):
    """Return the exact sign (-1, 0, 1) of x^2 + y^2 + z^2 - radius^2; close cases use rational numbers."""
    distance = np.hypot(np.hypot(x, y), z)
    sign = np.sign(distance - np.abs(radius))
    for n in np.flatnonzero(np.abs(distance - np.abs(radius)) <= 1e-14 * distance):
        squares = [Fraction(float(value[n])) ** 2 for value in (x, y, z, radius)]
        difference = squares[0] + squares[1] + squares[2] - squares[3]
        sign[n] = (difference > 0) - (difference < 0)
    return sign


def pose_flags(x, y, z, d1, d2):
    """Return the flags (N,) of targets in double precision.

    The flags are exact if d1 + d2 and d1 - d2 are exact, which is always so for words of the core. Raises ValueError
    for inputs that are not finite or do not broadcast.
    """
    x, y, z, d1, d2 = columns(x=x, y=y, z=z, d1=d1, d2=d2)
    return combine(x, y, z, d1, d2, _compare(x, y, z, d1 + d2) > 0, _compare(x, y, z, d1 - d2) < 0)


def solve_clamped(x, y, z, phi, d1, d2):
    """Return poses and flags of any N targets: the pose of `solve` for a target in reach, else the nearest pose.

    Returns a dict of arrays (N,): qs_w, qs_i, qs_j, qs_k (k >= 0), qe_w, qe_i, p_e_x, p_e_y, p_e_z, flags. Raises
    ValueError for inputs that are not finite or do not broadcast, and for lengths that `solve` rejects.

    If the target is too far or a length is not positive, the arm is straight and points to the target. If the target is
    too near or at the shoulder, the arm is closed (Qe = 1) and the longer bone points to the target. A target at the
    shoulder counts as a target on +z. The swivel angle is kept.
    """
    targets = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    flags = pose_flags(*targets[:3], *targets[4:])
    clamped = flags & (UNREACHABLE | AT_SHOULDER) != 0
    reached = solve(*(values[~clamped] for values in targets))
    x, y, z, phi, d1, d2 = (values[clamped] for values in targets)
    straight = flags[clamped] & (TOO_FAR | BAD_LENGTH) != 0
    distance = np.hypot(np.hypot(x, y), z)
    at_shoulder = distance == 0
    divisor = np.where(at_shoulder, 1.0, distance) * np.where(~straight & (d1 < d2), -1.0, 1.0)
    e = np.stack((x / divisor, y / divisor, np.where(at_shoulder, 1.0, z) / divisor), axis=-1)
    n = swivel_normal(x, y, z, phi)
    qs = quaternion(np.stack((-n, np.cross(e, -n), e), axis=-1))  # equivalent to (15)-(18), but without singular poses
    qs = np.where(qs[:, 3:] < 0, -qs, qs)
    poses = np.column_stack((qs, np.where(straight, 0.0, 1.0), np.where(straight, -1.0, 0.0), d1[:, None] * e))
    names = ("qs_w", "qs_i", "qs_j", "qs_k", "qe_w", "qe_i", "p_e_x", "p_e_y", "p_e_z")
    results = np.empty((len(names), len(flags)))
    results[:, clamped], results[:, ~clamped] = poses.T, [reached[name] for name in names]
    return {"flags": flags} | dict(zip(names, results, strict=True))

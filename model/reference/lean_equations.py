# SPDX-License-Identifier: Apache-2.0
"""Lean dataflow in double precision: the results of (10)-(18) without division, elbow point or half-angle roots.

docs/generated/lean.md derives it from the paper's equations; the lines (L1), (L2), ... and their names are shared with
:mod:`model.reference.lean_table`, the dataflow and the RTL. For a target in reach:

    d_sum, d_dif = d1 + d2, d1 - d2    rho_sq = x^2 + y^2    s = |p|^2                (L1)-(L4)
    a_far = d_sum^2 - s    b_near = s - d_dif^2    k_law = s + d_sum d_dif           (L5)-(L7): A, B, K
    Qe = sqrt(A)/(2 sqrt(d1 d2)) - sqrt(B)/(2 sqrt(d1 d2)) i                         (L22) (L23), the paper's (14)
    (u_x, u_y) = (x, y)/rho    sin_el = z/|p|    cos_el = rho/|p|                    (L14)-(L18)
    cos_a = K/(2 d1 |p|)    sin_a = sqrt(A) sqrt(B)/(2 d1 |p|)                       (L26)-(L28)
    Qs = Rz(azimuth + 90 deg) Rx(90 deg - elevation) Rz(phi) Rx(-a)                  (L29)-(L61), the paper's (18)

Each factor of Qs is a quaternion along half its angle, but not of unit length (`half`), so a single reciprocal root at
the end normalizes the product. Every root takes an argument scaled by an even power of two, as in the core.

A, B and K are sums of exact products, rounded once: like the core, which has them as integers, this model keeps
its relative precision next to the z axis, the stretched and the folded arm, where `equations.solve` loses up to half
of its digits. Lengths have any one unit, angles are in radians, arrays are float64 of shape (N,).
"""

import numpy as np

from ..io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, UNREACHABLE
from .equations import LENGTH_RANGE, columns, pose_flags

_SPLIT = 2.0**27 + 1


def half(c, s):
    """Return a quaternion (c', s') along half the angle with cosine c and sine s, of squared length (1 + |c|)/2.

    ((1 + c)/2, s/2) for c >= 0, (s/2, (1 - c)/2) for c < 0: no root, and no difference of nearly equal numbers.
    The branch determines which of the two opposite quaternions it is.
    """
    large, small = (1 + np.abs(c)) / 2, s / 2
    return np.where(c >= 0, large, small), np.where(c >= 0, small, large)


def _scaled(*columns):
    """Return the columns times 2^-e, and e (N,): the largest magnitude of each row is then in [1/2, 1)."""
    _, e = np.frexp(np.max(np.abs(columns), axis=0))
    return *(np.ldexp(v, -e) for v in columns), e


def _even(v):
    """Return v 4^-k in [1/4, 1), and k; for v > 0."""
    _, e = np.frexp(v)
    k = (e + 1) // 2
    return np.ldexp(v, -2 * k), k


def _two_sum(a, b):
    """Return a + b rounded, and the rounding error: exact together."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _two_product(a, b):
    """Return a b rounded, and the rounding error: exact together for numbers of moderate size."""
    product = a * b
    a_high, b_high = (v * _SPLIT - (v * _SPLIT - v) for v in (a, b))
    a_low, b_low = a - a_high, b - b_high
    return product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)


def _sum_of_products(*pairs):
    """Return the sum of the products of the pairs, as if summed with 150 bits and rounded once."""
    terms = [part for pair in pairs for part in _two_product(*pair)]
    for _ in range(2):
        for n in range(1, len(terms)):
            terms[n], terms[n - 1] = _two_sum(terms[n], terms[n - 1])
    return sum(terms[:-1]) + terms[-1]


def _directions(x, y, z, on_axis, at_shoulder):
    """Compute azimuth and elevation of the target."""
    x_r, y_r, e_rho = _scaled(x, y)
    x_s, y_s, z_s, e_s = _scaled(x, y, z)
    rho_sq, s = x_r**2 + y_r**2, x_s**2 + y_s**2 + z_s**2
    inv_rho = 1 / np.sqrt(np.where(on_axis, 1.0, rho_sq))  # (L8)
    inv_s = 1 / np.sqrt(np.where(at_shoulder, 1.0, s))  # (L9)
    root_rho = rho_sq * inv_rho  # (L17)
    return {
        "rho_sq": np.ldexp(rho_sq, 2 * e_rho),  # (L3)
        "s": np.ldexp(s, 2 * e_s),  # (L4), (10) squared
        "u_x": np.where(on_axis, 1.0, x_r * inv_rho),  # (L14)
        "u_y": np.where(on_axis, 0.0, y_r * inv_rho),  # (L15)
        "sin_el": np.where(at_shoulder, 1.0, z_s * inv_s),  # (L16)
        "cos_el": np.ldexp(root_rho, e_rho - e_s) * inv_s,  # (L18)
    }, (inv_s, e_s)


def _triangle(x, y, z, d1, d2, inv_s, e_s):
    """Compute elbow quaternion and shoulder angle from the triangle shoulder, elbow, wrist of a reachable target."""
    d_sum, sum_low = _two_sum(d1, d2)  # (L1)
    d_dif, dif_low = _two_sum(d1, -d2)  # (L2)

    x_a, y_a, z_a, sum_a, low, e_a = _scaled(x, y, z, d_sum, sum_low)
    a_far = _sum_of_products((sum_a, sum_a), (2 * sum_a, low), (low, low), (-x_a, x_a), (-y_a, y_a), (-z_a, z_a))
    x_b, y_b, z_b, dif_b, low, e_b = _scaled(x, y, z, d_dif, dif_low)
    b_near = _sum_of_products((x_b, x_b), (y_b, y_b), (z_b, z_b), (-dif_b, dif_b), (-2 * dif_b, low), (-low, low))
    x_k, y_k, z_k, sum_k, sum_l, dif_k, dif_l, e_k = _scaled(x, y, z, d_sum, sum_low, d_dif, dif_low)
    k_law = _sum_of_products(
        (x_k, x_k), (y_k, y_k), (z_k, z_k), (sum_k, dif_k), (sum_k, dif_l), (sum_l, dif_k), (sum_l, dif_l)
    )

    root_far, root_near = (np.sqrt(np.maximum(v, 0.0)) for v in (a_far, b_near))  # (L19) (L20)
    d1, k1 = _even(np.where(d1 > 0, d1, 1.0))
    d2, k2 = _even(np.where(d2 > 0, d2, 1.0))
    inv_1, inv_2 = 1 / np.sqrt(d1), 1 / np.sqrt(d2)  # (L12) (L13)
    nodes = {
        "a_far": np.ldexp(a_far, 2 * e_a),  # (L5)
        "b_near": np.ldexp(b_near, 2 * e_b),  # (L6)
        "k_law": np.ldexp(k_law, 2 * e_k),  # (L7)
    }
    inv_12, inv_law = inv_1 * inv_2 / 2, inv_1**2 * inv_s / 2  # (L21) (L24) (L25)
    # Where d1 + d2 or d1 - d2 is not a double, a target may be out of reach by less than its rounding; then A or B is
    # negative and the other value of each pair above 1, and the target counts as at the limit.
    return nodes, {
        "qe_w": np.minimum(np.ldexp(root_far * inv_12, e_a - k1 - k2), 1.0),  # (L22), the paper's (14)
        "qe_i": -np.minimum(np.ldexp(root_near * inv_12, e_b - k1 - k2), 1.0),  # (L23), the paper's (14)
        "cos_a": np.clip(np.ldexp(k_law * inv_law, 2 * (e_k - k1) - e_s), -1.0, 1.0),  # (L26)
        "sin_a": np.ldexp(root_far * root_near * inv_law, e_a + e_b - 2 * k1 - e_s),  # (L27) (L28)
    }


def _shoulder(u_x, u_y, sin_el, cos_el, cos_a, sin_a, phi):
    """Return Qs, (15)-(18), as a product of four rotations about coordinate axes."""
    az_c, az_s = half(-u_y, u_x)  # (L32) (L33): z, azimuth + 90 deg
    tilt_c, tilt_s = half(sin_el, cos_el)  # (L34) (L35): x, 90 deg - elevation
    arm_c, arm_s = half(cos_a, sin_a)  # (L36) (L37): x, -a
    sin_h, cos_h = np.sin(phi / 2), np.cos(phi / 2)  # (L38) (L39): z, phi

    cc, ss, sc, cs = az_c * cos_h, az_s * sin_h, az_s * cos_h, az_c * sin_h  # (L40)-(L43)
    c_plus, s_plus, c_minus, s_minus = cc - ss, sc + cs, cc + ss, sc - cs  # (L44)-(L47)
    w_0, i_0, j_0, k_0 = tilt_c * c_plus, tilt_s * c_minus, tilt_s * s_minus, tilt_c * s_plus  # (L48)-(L51)
    w_1 = w_0 * arm_c + i_0 * arm_s  # (L52)
    i_1 = i_0 * arm_c - w_0 * arm_s  # (L53)
    j_1 = j_0 * arm_c - k_0 * arm_s  # (L54)
    k_1 = k_0 * arm_c + j_0 * arm_s  # (L55)
    az_sq, tilt_sq, arm_sq = ((1 + np.abs(c)) / 2 for c in (u_y, sin_el, cos_a))  # (L29)-(L31)
    length_sq = az_sq * tilt_sq * arm_sq  # (L56)
    inv_q = np.where(k_1 < 0, -1.0, 1.0) / np.sqrt(length_sq)  # (L57)
    return {
        "az_c": az_c,
        "az_s": az_s,
        "tilt_c": tilt_c,
        "tilt_s": tilt_s,
        "arm_c": arm_c,
        "arm_s": arm_s,
        "cos_h": cos_h,
        "sin_h": sin_h,
        "length_sq": length_sq,
        "qs_w": w_1 * inv_q,
        "qs_i": i_1 * inv_q,
        "qs_j": j_1 * inv_q,
        "qs_k": k_1 * inv_q,  # (L58)-(L61)
    }


def solve_lean(x, y, z, phi, d1, d2):
    """Return a pose for any N targets, with flags, by the lean dataflow.

    x, y, z (wrist target), d1 (upper arm), d2 (forearm) in one unit of length, phi in radians; numbers or arrays that
    broadcast to (N,). Targets need not be in reach nor lengths positive: such targets get the pose of
    `equations.solve_clamped`. Returns a dict of arrays (N,): rho_sq, s, a_far, b_near, k_law (squares of the user's
    unit; 0 or inf beyond the range of doubles, without effect on the others), u_x, u_y, sin_el, cos_el, cos_a, sin_a,
    az_c, az_s, tilt_c, tilt_s, arm_c, arm_s, cos_h, sin_h (of phi/2), length_sq, qs_w, qs_i, qs_j, qs_k (k >= 0), qe_w,
    qe_i, flags (int64). Never nan, provided that d1 + d2 and d1 - d2 are finite. Raises ValueError for inputs that are
    not finite or do not broadcast, and for arm lengths outside LENGTH_RANGE of a target in reach.
    """
    x, y, z, phi, d1, d2 = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    flags = pose_flags(x, y, z, d1, d2)
    on_axis, at_shoulder = flags & ON_AXIS != 0, flags & AT_SHOULDER != 0
    clamped = flags & (UNREACHABLE | AT_SHOULDER) != 0
    straight = flags & (TOO_FAR | BAD_LENGTH) != 0
    away = (flags & TOO_NEAR != 0) & (d1 < d2)  # folded, with the upper arm away from the target
    low, high = LENGTH_RANGE
    for name, d in (("d1", d1), ("d2", d2)):
        if (~clamped & ~((d >= low) & (d <= high))).any():
            raise ValueError(f"{name} of a target in reach must lie in [{low:g}, {high:g}]")

    with np.errstate(over="ignore", under="ignore", invalid="ignore"):  # squares; unused triangles
        directions, root = _directions(x, y, z, on_axis, at_shoulder)
        squares, triangle = _triangle(x, y, z, d1, d2, *root)
    rule = {
        "qe_w": np.where(straight, 0.0, 1.0),
        "qe_i": np.where(straight, -1.0, 0.0),
        "cos_a": np.where(away, -1.0, 1.0),
        "sin_a": np.zeros(len(x)),
    }
    triangle = {name: np.where(clamped, rule[name], value) for name, value in triangle.items()}
    elbow = {name: triangle.pop(name) for name in ("qe_w", "qe_i")}
    angles = {name: directions[name] for name in ("u_x", "u_y", "sin_el", "cos_el")} | triangle
    squares = {name: directions[name] for name in ("rho_sq", "s")} | squares
    return squares | angles | _shoulder(**angles, phi=phi) | elbow | {"flags": flags}

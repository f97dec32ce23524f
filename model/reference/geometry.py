# SPDX-License-Identifier: Apache-2.0
"""Layer 2 of the reference: section 3 of the paper as geometry in the conformal algebra.

Planes, spheres, circles and lines are constructed, intersected and rotated as in the text. The component equations
(11)-(18) are not used: they are in `model.reference.equations`, with which the results must agree.

The functions follow the subsections and accept any coefficients of `model.reference.cga`, including sympy symbols.
Names are the paper's: capital letters are multivectors, and `pi_...` are planes.
"""

import numpy as np
import sympy

from . import cga
from .cga import e1, e3, e_0, e_inf


def swivel_plane(P_w, phi):
    """Return the line L_sw from shoulder to wrist, |L_sw|, and the swivel plane, turned by phi (rad) about L_sw (3.1).

    At phi = 0 the plane contains the z axis and has the normal (p_wy, -p_wx, 0). It is undefined for P_w on the z axis.
    """
    L_sw = cga.dual(cga.line_direct(e_0, P_w))
    length = cga.norm(L_sw)  # (10)
    # The direction e3 represents a second point of the z axis; this order determines the normal's sign.
    pi_vertical = cga.dual(e_0 ^ e3 ^ P_w ^ e_inf)
    turn = cga.rotation(L_sw * cga.scalar(1 / length), phi)  # (4)
    return L_sw, length, cga.rotate(turn, pi_vertical)  # (11)


def elbow_point_pair(P_w, pi_swivel, d1, d2):
    """Return the spheres S_1 about the wrist, S_2 about the shoulder, their circle Z_e and the elbow pair PP (3.2)."""
    S_1 = cga.sphere(P_w, d2)
    S_2 = cga.sphere(e_0, d1)
    Z_e = S_1 ^ S_2
    PP = Z_e ^ pi_swivel  # (12), there as the coefficients of PP*
    return S_1, S_2, Z_e, PP


def elbow_point(PP):
    """Return the elbow P_e (3.2): the point of PP on the side of L_sw to which (normal of pi_swivel) x p_w points."""
    pair = cga.dual(PP)
    square = cga.inner(pair, pair)
    # Roundoff can make the square negative for a straight or closed arm, where the pair is one point.
    root = sympy.sqrt(square) if isinstance(square, sympy.Expr) else np.sqrt(np.maximum(square, 0.0))
    # The two points of a pair are (PP* -+ |PP*|) / (e_inf . PP*); the divisor is a vector.
    direction = e_inf | pair
    P_e = ((pair - cga.scalar(root)) * direction).grade(1)
    return P_e * cga.scalar(-1 / cga.inner(e_inf, P_e))  # (13)


def elbow_quaternion(P_e, P_w):
    """Return the bones' lines L_se, L_ew, the cosine c4, and the elbow's rotation Q_e about the local x axis (3.3)."""
    L_se = cga.dual(cga.line_direct(e_0, P_e))
    L_ew = cga.dual(cga.line_direct(P_e, P_w))
    # Lines in standard representation, hence the cosine of the interior angle.
    c4 = cga.cos_angle(L_se, L_ew)  # (5)
    cos_half, sin_half = cga.half_angle(c4)  # (8), (9)
    return L_se, L_ew, c4, cga.quaternion(cos_half, -sin_half, 0, 0)  # (14)


def elbow_rotation(P_e, d1):
    """Return P_ze, pi_m, pi_e, L_m, Q_12 (3.4). Q_12 is the half turn that takes the z axis to an elbow off it."""
    P_ze = cga.point(0, 0, d1)
    pi_m = P_ze - P_e
    pi_e = cga.dual(e_0 ^ P_ze ^ P_e ^ e_inf)
    L_m = pi_e ^ pi_m
    return P_ze, pi_m, pi_e, L_m, L_m * cga.scalar(1 / cga.norm(L_m))  # (15)


def wrist_rotation(Q_12, pi_swivel, P_w):
    """Return pi_yz2, c3, sign and Q_3, the rotation about the upper arm that takes the wrist to the target (3.5)."""
    pi_yz = e1
    pi_yz2 = cga.rotate(Q_12, pi_yz)
    c3 = cga.cos_angle(cga.dual(pi_yz2), cga.dual(pi_swivel))  # (5); planes in direct representation
    cos_half, sin_half = cga.half_angle(c3)  # (8), (9)
    side = cga.inner(pi_yz2, P_w)
    sign = side / sympy.Abs(side) if isinstance(side, sympy.Expr) else np.where(side < 0, -1.0, 1.0)  # 0 counts as +
    return pi_yz2, c3, sign, cga.quaternion(cos_half, 0, 0, sign * sin_half)  # (16), with the sign as in (17)


def solve(x, y, z, phi, d1, d2):
    """Return a dict, keyed by the paper's names: results, elbow and scalars as arrays (N,), and the main multivectors.

    Targets must be reachable, wrist and elbow off the z axis, and the arm neither straight nor closed. In other poses a
    plane or line of the construction vanishes, and results may be nan.
    """
    inputs = np.broadcast_arrays(*np.atleast_1d(x, y, z, phi, d1, d2))
    x, y, z, phi, d1, d2 = (np.asarray(values, dtype=np.float64) for values in inputs)
    with np.errstate(divide="ignore", invalid="ignore"):
        P_w = cga.point(x, y, z)
        L_sw, l_sw, pi_swivel = swivel_plane(P_w, phi)
        _, _, Z_e, PP = elbow_point_pair(P_w, pi_swivel, d1, d2)
        P_e = elbow_point(PP)
        _, _, c4, Q_e = elbow_quaternion(P_e, P_w)
        _, _, _, L_m, Q_12 = elbow_rotation(P_e, d1)
        pi_yz2, c3, sign, Q_3 = wrist_rotation(Q_12, pi_swivel, P_w)
        Q_s = Q_12 * Q_3  # (18)
    values = {"l_sw": l_sw, "c3": c3, "c4": c4, "sign": sign}
    values |= zip(("qs_w", "qs_i", "qs_j", "qs_k"), cga.quaternion_coefficients(Q_s), strict=True)
    values |= zip(("qe_w", "qe_i"), cga.quaternion_coefficients(Q_e)[:2], strict=True)
    values |= zip(("p_e_x", "p_e_y", "p_e_z"), cga.euclidean_coordinates(P_e), strict=True)
    values |= {"P_w": P_w, "L_sw": L_sw, "pi_swivel": pi_swivel, "Z_e": Z_e, "PP": PP, "P_e": P_e, "Q_e": Q_e}
    return values | {"L_m": L_m, "Q_12": Q_12, "pi_yz2": pi_yz2, "Q_3": Q_3, "Q_s": Q_s}

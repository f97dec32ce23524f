# SPDX-License-Identifier: Apache-2.0
"""The lean equations for any array library: on arrays in numpy and JAX, in a scalar loop in numba.

All share the lines of equations.c: (L1)-(L61) of :mod:`model.reference.lean_equations` for targets in reach, each sum
rounded, without flags. The model's `solve_lean`, with exact sums and rules for targets out of reach, has its own row.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def lean(real: Any, sqrt: Callable, sin: Callable, cos: Callable, where: Callable) -> Callable[..., tuple]:
    """Return a solver (x, y, z, phi, d1, d2) -> (qs_w, qs_i, qs_j, qs_k, qe_w, qe_i), all of type `real`.

    A closure rather than a namespace argument: numba compiles the functions and numbers that a closure captures. All
    constants are of type `real`, because an integer among floats would promote them to double.
    """
    zero, half, one = real(0), real(0.5), real(1)

    def solve(x: Any, y: Any, z: Any, phi: Any, d1: Any, d2: Any) -> tuple:
        d_sum, d_dif = d1 + d2, d1 - d2  # (L1) (L2)
        rho_sq = x * x + y * y  # (L3)
        s = rho_sq + z * z  # (L4)
        a_far, b_near = d_sum * d_sum - s, s - d_dif * d_dif  # (L5) (L6)
        k_law = s + d_sum * d_dif  # (L7)
        inv_rho, inv_s = one / sqrt(rho_sq), one / sqrt(s)  # (L8) (L9)
        root_far = sqrt(where(a_far > zero, a_far, zero))  # (L19)
        root_near = sqrt(where(b_near > zero, b_near, zero))  # (L20)
        u_x, u_y = x * inv_rho, y * inv_rho  # (L14) (L15)
        sin_el, cos_el = z * inv_s, rho_sq * inv_rho * inv_s  # (L16)-(L18)
        inv_12, inv_law = half / sqrt(d1 * d2), half * inv_s / d1  # (L21) (L25)
        qe_w, qe_i = root_far * inv_12, -root_near * inv_12  # (L22) (L23)
        cos_a, sin_a = k_law * inv_law, root_far * root_near * inv_law  # (L26)-(L28)

        # Quaternions along half an angle, of squared length (1 + |cosine|)/2.
        az, tilt = (one + abs(u_y)) * half, (one + abs(sin_el)) * half  # (L29) (L30)
        arm = (one + abs(cos_a)) * half  # (L31)
        az_c, az_s = where(u_y <= zero, az, u_x * half), where(u_y <= zero, u_x * half, az)  # (L32) (L33)
        tilt_c = where(sin_el >= zero, tilt, cos_el * half)  # (L34)
        tilt_s = where(sin_el >= zero, cos_el * half, tilt)  # (L35)
        arm_c, arm_s = where(cos_a >= zero, arm, sin_a * half), where(cos_a >= zero, sin_a * half, arm)  # (L36) (L37)
        sin_h, cos_h = sin(phi * half), cos(phi * half)  # (L38) (L39)
        cc, ss, sc, cs = az_c * cos_h, az_s * sin_h, az_s * cos_h, az_c * sin_h  # (L40)-(L43)
        w_0, i_0 = tilt_c * (cc - ss), tilt_s * (cc + ss)  # (L44) (L46) (L48) (L49)
        j_0, k_0 = tilt_s * (sc - cs), tilt_c * (sc + cs)  # (L45) (L47) (L50) (L51)
        w_1, i_1 = w_0 * arm_c + i_0 * arm_s, i_0 * arm_c - w_0 * arm_s  # (L52) (L53)
        j_1, k_1 = j_0 * arm_c - k_0 * arm_s, k_0 * arm_c + j_0 * arm_s  # (L54) (L55)
        inv_q = one / sqrt(az * tilt * arm)  # (L56) (L57)
        inv_q = where(k_1 < zero, -inv_q, inv_q)  # (L57)
        return w_1 * inv_q, i_1 * inv_q, j_1 * inv_q, k_1 * inv_q, qe_w, qe_i  # (L58)-(L61)

    return solve


def lean_of(library: Any, real: Any) -> Callable[..., tuple]:
    """Return `lean` for a library with numpy's function names."""
    return lean(real, library.sqrt, library.sin, library.cos, library.where)

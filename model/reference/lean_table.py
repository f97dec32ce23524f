# SPDX-License-Identifier: Apache-2.0
"""Lean equations, (L1), (L2), ...: derived in docs/generated/lean.md, with the names that model and RTL share.

A line has one number and one name.  The name is used everywhere: in ``scripts/paper/derivation``, in
:mod:`model.reference.lean_equations`, in :mod:`model.dataflow.lean`, in ``rtl/lean`` and in its page.  In the core
a root and its dependents hold the quantity in units of a power of two, from the normalization of its argument.

Right sides are text in the names above them and the inputs ``x, y, z, phi, d1, d2``.  ``rsqrt`` is the reciprocal
square root, ``half_c`` and ``half_s`` are the two parts of :data:`HALF`.
"""

LEAN = {
    "Sums of the inputs": {
        "d_sum": "d1 + d2",
        "d_dif": "d1 - d2",
        "rho_sq": "x**2 + y**2",
        "s": "rho_sq + z**2",
        "a_far": "d_sum**2 - s",
        "b_near": "s - d_dif**2",
        "k_law": "s + d_sum*d_dif",
    },
    "Roots, first level": {
        "inv_rho": "rsqrt(rho_sq)",
        "inv_s": "rsqrt(s)",
        "inv_far": "rsqrt(a_far)",
        "inv_near": "rsqrt(b_near)",
        "inv_1": "rsqrt(d1)",
        "inv_2": "rsqrt(d2)",
    },
    "Directions": {
        "u_x": "x*inv_rho",
        "u_y": "y*inv_rho",
        "sin_el": "z*inv_s",
        "root_rho": "rho_sq*inv_rho",
        "cos_el": "root_rho*inv_s",
    },
    "Triangle": {
        "root_far": "a_far*inv_far",
        "root_near": "b_near*inv_near",
        "inv_12": "inv_1*inv_2/2",
        "qe_w": "root_far*inv_12",
        "qe_i": "-root_near*inv_12",
        "inv_11": "inv_1**2",
        "inv_law": "inv_11*inv_s/2",
        "cos_a": "k_law*inv_law",
        "root_ab": "root_far*root_near",
        "sin_a": "root_ab*inv_law",
    },
    "Lengths of the half angle quaternions, squared": {
        "az_sq": "(1 + Abs(u_y))/2",
        "tilt_sq": "(1 + Abs(sin_el))/2",
        "arm_sq": "(1 + Abs(cos_a))/2",
    },
    "Half angle quaternions": {
        "az_c": "half_c(-u_y, u_x)",
        "az_s": "half_s(-u_y, u_x)",
        "tilt_c": "half_c(sin_el, cos_el)",
        "tilt_s": "half_s(sin_el, cos_el)",
        "arm_c": "half_c(cos_a, sin_a)",
        "arm_s": "half_s(cos_a, sin_a)",
    },
    "Half the swivel angle": {
        "sin_h": "sin(phi/2)",
        "cos_h": "cos(phi/2)",
    },
    "Product": {
        "cc": "az_c*cos_h",
        "ss": "az_s*sin_h",
        "sc": "az_s*cos_h",
        "cs": "az_c*sin_h",
        "c_plus": "cc - ss",
        "s_plus": "sc + cs",
        "c_minus": "cc + ss",
        "s_minus": "sc - cs",
        "w_0": "tilt_c*c_plus",
        "i_0": "tilt_s*c_minus",
        "j_0": "tilt_s*s_minus",
        "k_0": "tilt_c*s_plus",
        "w_1": "w_0*arm_c + i_0*arm_s",
        "i_1": "i_0*arm_c - w_0*arm_s",
        "j_1": "j_0*arm_c - k_0*arm_s",
        "k_1": "k_0*arm_c + j_0*arm_s",
    },
    "Root, second level": {
        "length_sq": "az_sq*tilt_sq*arm_sq",
        "inv_q": "rsqrt(length_sq)",
        "qs_w": "w_1*inv_q",
        "qs_i": "i_1*inv_q",
        "qs_j": "j_1*inv_q",
        "qs_k": "k_1*inv_q",
    },
}
"""Group -> name -> right side.  Qs is negated where k_1 < 0."""

HALF = {"c >= 0": ("(1 + c)/2", "s/2"), "c < 0": ("s/2", "(1 - c)/2")}
"""(half_c, half_s)(c, s), by branch: a quaternion along half the angle with cosine c and sine s."""

NUMBER = {name: f"(L{n})" for n, name in enumerate((name for group in LEAN.values() for name in group), 1)}
"""Name -> line number."""

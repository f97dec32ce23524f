# SPDX-License-Identifier: Apache-2.0
"""Layer 1 of the reference: 5D conformal geometric algebra, section 2 of the paper.

The algebra is kingdon's Cl(4,1) on the orthogonal basis e1, e2, e3, e4 = e+, e5 = e-. The paper's null vectors are
e_inf = e- + e+ and e_0 = (e- - e+)/2. PP_14 .. PP_35 of (12) are coefficients on the orthogonal basis, `mv.e14` ..
`mv.e35`.

Coefficients are numbers, numpy arrays (N,), or sympy expressions. Write the product with a coefficient c as
`mv * scalar(c)`: in `c * mv`, numpy would iterate over the multivector.
"""

from itertools import combinations

import numpy as np
import sympy
from kingdon import Algebra

BLADES = tuple("^".join(blade) or "1" for n in range(6) for blade in combinations(("e1", "e2", "e3", "einf", "e0"), n))
"""Table 2: the paper's 32 blades in the paper's order, index 1 first."""


def _expand(value):
    """Return a sympy expression expanded, with exact rationals, so that zeros vanish; return a number unchanged."""
    return sympy.expand(sympy.nsimplify(value, rational=True)) if isinstance(value, sympy.Expr) else value


ALGEBRA = Algebra(4, 1, simp_func=_expand)
_VECTOR_KEYS = tuple(ALGEBRA.canon2bin[name] for name in ("e1", "e2", "e3", "e4", "e5"))


def _functions(value):
    """Return the library whose sqrt, cos and sin accept `value`."""
    return sympy if isinstance(value, sympy.Expr) else np


def symbol(name):
    """Return the real sympy symbol with this name; equal names give equal symbols."""
    return sympy.Symbol(name, real=True)


def scalar(value):
    """Return the multivector of grade 0 with this value."""
    return ALGEBRA.multivector(keys=(0,), values=[value])


def vector(x=0, y=0, z=0, inf=0, zero=0):
    """Return the grade-1 multivector x e1 + y e2 + z e3 + inf e_inf + zero e_0."""
    # A single division at the end keeps symbols exact: zero / 2 would give the float 0.5.
    plus, minus = (2 * inf - zero) / 2, (2 * inf + zero) / 2
    return ALGEBRA.multivector(keys=_VECTOR_KEYS, values=[x, y, z, plus, minus])


e1, e2, e3, e_inf, e_0 = (vector(**{name: 1}) for name in ("x", "y", "z", "inf", "zero"))

PSEUDOSCALAR_INVERSE = -(e1 ^ e2 ^ e3 ^ e_inf ^ e_0)  # index 32 of table 2; its square is -1
i = e3 ^ e2  # (1)
j = e1 ^ e3  # (2)
k = e2 ^ e1  # (3)


def coefficient(mv, blade):
    """Return the coefficient of a multivector on a blade. Raises KeyError for a blade that is not in BLADES."""
    if blade not in BLADES:
        raise KeyError(f"{blade!r} is not a blade of table 2")
    factors = [] if blade == "1" else blade.split("^")
    euclidean = "e" + "".join(name[1] for name in factors if name in ("e1", "e2", "e3"))
    plus, minus = getattr(mv, euclidean + "4"), getattr(mv, euclidean + "5")
    # e+ = e_inf/2 - e_0 and e- = e_inf/2 + e_0, hence e+ ^ e- = e_inf ^ e_0.
    null = {"einf": (plus + minus) / 2, "e0": minus - plus, "einf^e0": getattr(mv, euclidean + "45")}
    return _expand(null.get("^".join(factors[len(euclidean) - 1 :]), getattr(mv, euclidean)))


def dual(mv):
    """Return X* = X I^-1, which converts the direct representation to the standard one.

    With this sign the dual of the direct line e_0 ^ x ^ e_inf is the quaternion unit of the right-handed rotation about
    x. The dual of the dual is -X, which represents the same entity.
    """
    return mv * PSEUDOSCALAR_INVERSE


# Table 1, standard representation.


def point(x, y, z):
    """Return the point P = x + x^2/2 e_inf + e_0, where x is the vector (x, y, z)."""
    return vector(x, y, z, inf=(x * x + y * y + z * z) / 2, zero=1)


def sphere(centre, radius):
    """Return the sphere s = P - r^2/2 e_inf, from its centre point P and its radius r."""
    return centre - e_inf * scalar(radius * radius / 2)


def plane(n_x, n_y, n_z, d):
    """Return the plane pi = n + d e_inf, from its unit normal n and its distance d from the origin along n."""
    return vector(n_x, n_y, n_z, inf=d)


def line_direct(x_1, x_2):
    """Return the direct line l* = x1 ^ x2 ^ e_inf through two points."""
    return x_1 ^ x_2 ^ e_inf


# Metric.


def inner(o_1, o_2):
    """Return the scalar coefficient of o_1 . o_2, for two entities of the same grade."""
    return (o_1 | o_2).e


def norm(o):
    """Return the norm |o| = sqrt(|o . o|); o . o may be negative."""
    square = abs(inner(o, o))
    return _functions(square).sqrt(square)


def euclidean_coordinates(p):
    """Return (x, y, z) of a point P of any scale: its coefficients divided by the e_0 coefficient, -e_inf . P."""
    weight = -inner(e_inf, p)
    return p.e1 / weight, p.e2 / weight, p.e3 / weight


def centre(o):
    """Return the centre of a sphere, circle or point pair `o` as a point of any scale: e_inf reflected in `o`."""
    return (o * e_inf * o).grade(1)


def radius(o):
    """Return the radius of a circle; nan for the imaginary circle of two disjoint spheres."""
    square = -inner(o, o) / inner(e_inf | o, e_inf | o)
    with np.errstate(invalid="ignore"):
        return _functions(square).sqrt(square)


def direction(o):
    """Return the unit normal (x, y, z) of a plane or the unit direction of a line, in standard representation."""
    x, y, z = (o.e1, o.e2, o.e3) if o.grades == (1,) else quaternion_coefficients(o)[1:]
    length = _functions(x).sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def cos_angle(o_1, o_2):
    """Return cos(theta) of two lines or two planes in the same representation, by (5): o1 . o2 / (|o1| |o2|).

    For direct lines and standard planes this is the cosine of the angle between directions or normals. For standard
    lines (as in c4) and direct planes (as in c3) it is the negative cosine of that angle.
    """
    return inner(o_1, o_2) / (norm(o_1) * norm(o_2))  # (5)


def half_angle(cos_phi):
    """Return cos(phi/2) and sin(phi/2), both >= 0, from cos(phi). A number outside [-1, 1] is clipped."""
    cos_phi = cos_phi if isinstance(cos_phi, sympy.Expr) else np.clip(cos_phi, -1.0, 1.0)
    sqrt = _functions(cos_phi).sqrt
    return sqrt((1 + cos_phi) / 2), sqrt((1 - cos_phi) / 2)  # (6), (7); for an angle between entities (8), (9)


# Quaternions: the part of the algebra spanned by 1, i, j, k.


def quaternion(w, q_i, q_j, q_k):
    """Return the quaternion w + q_i i + q_j j + q_k k."""
    return scalar(w) + i * scalar(q_i) + j * scalar(q_j) + k * scalar(q_k)


def quaternion_coefficients(q):
    """Return (w, q_i, q_j, q_k) of a quaternion. Other blades of `q` are ignored."""
    return q.e, -q.e23, q.e13, -q.e12


def rotation(axis, phi):
    """Return the right-handed rotation by phi (rad) about the standard line L = ``axis``, where |L| = 1, by equation
    (4): cos(phi/2) + L sin(phi/2)."""
    lib = _functions(phi)
    return scalar(lib.cos(phi / 2)) + axis * scalar(lib.sin(phi / 2))  # (4)


def rotate(q, mv):
    """Return Q X Q~ for a unit quaternion Q."""
    return (q * mv * ~q).grade(*mv.grades)

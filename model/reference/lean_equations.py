# SPDX-License-Identifier: Apache-2.0
"""Lean equations (L1), (L2), ... as a table, and their solution in double precision.

docs/generated/lean.md derives them from the paper's (10)-(18).  Model, RTL and page share numbers and names.  In the
core a root and its dependents hold the quantity in units of a power of two, from the normalization of its argument.

Right sides are text in the names above them and the inputs ``x, y, z, phi, d1, d2``.  ``rsqrt`` is the reciprocal
square root, ``half_c`` and ``half_s`` are the two parts of :data:`HALF`.  For a target in reach they are:

    A, B, K = a_far, b_near, k_law
    Qe = sqrt(A)/(2 sqrt(d1 d2)) - sqrt(B)/(2 sqrt(d1 d2)) i                         the paper's (14)
    (u_x, u_y) = (x, y)/rho    sin_el = z/|p|    cos_el = rho/|p|
    cos a = K/(2 d1 |p|)    sin a = sqrt(A) sqrt(B)/(2 d1 |p|)
    Qs = Rz(azimuth + 90 deg) Rx(90 deg - elevation) Rz(phi) Rx(-a)                  the paper's (18)

Each factor of Qs is a quaternion along half its angle, but not of unit length, so a single reciprocal root at the end
normalizes the product.

:func:`solve_lean` evaluates sums of the inputs exactly and rounds them once: like the core, which has them as integers,
it keeps its relative precision next to the z axis, the stretched and the folded arm, where ``equations.solve`` loses up
to half of its digits.
"""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, UNREACHABLE
from .equations import check_lengths, columns, pose_flags

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
    "Half the swivel angle": {"sin_h": "sin(phi/2)", "cos_h": "cos(phi/2)"},
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

CASES = {
    "u_x": {"on_axis": 1.0},
    "u_y": {"on_axis": 0.0},
    "sin_el": {"at_shoulder": 1.0},
    "qe_w": {"clamped": 1.0, "straight": 0.0},
    "qe_i": {"clamped": 0.0, "straight": -1.0},
    "cos_a": {"clamped": 1.0, "away": -1.0},
    "sin_a": {"clamped": 0.0},
}
"""Name -> case -> value: poses by convention and clamped poses; the last case that applies counts."""

SQUARES = ("rho_sq", "s", "a_far", "b_near", "k_law")  # sums whose unit is the square of the lengths'

EXACT, SCALED = ("Sums of the inputs",), ("Roots, first level", "Directions", "Triangle")
"""Groups evaluated without rounding, and with exponents beyond the range of doubles."""

_CODE = {group: {name: compile(text, name, "eval") for name, text in lines.items()} for group, lines in LEAN.items()}
_HALF = [[compile(text, branch, "eval") for text in parts] for branch, parts in HALF.items()]
_SPLIT = 2.0**27 + 1
_LEAST, _MOST = 1e-280, 1e280
"""Squares between which :func:`solve_direct` computes without scaling."""


def _half(part, c, s):
    """Return a part of :data:`HALF`; the branch determines which of the two opposite quaternions it is."""
    return np.where(c >= 0, *(eval(parts[part], {}, {"c": c, "s": s}) for parts in _HALF))


def _two_sum(a, b):
    """Return a + b rounded, and the rounding error: exact together."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _exact(values):
    """Return doubles (M, N) as Python integers, and the exponent (N,) of their unit in each column."""
    mantissas, exponents = np.frexp(values)
    exponents = np.where(mantissas == 0, exponents.max(axis=0), exponents)
    unit = exponents.min(axis=0)
    return np.ldexp(mantissas, 53).astype(np.int64).astype(object) << (exponents - unit).astype(object), unit - 53


@dataclass
class _Scaled:
    """Doubles times 2^exponent."""

    value: np.ndarray
    exponent: np.ndarray

    def __mul__(self, other):
        return _Scaled(self.value * other.value, self.exponent + other.exponent)

    def __pow__(self, two):
        return self * self

    def __truediv__(self, two):
        return _Scaled(self.value / two, self.exponent)

    def __neg__(self):
        return _Scaled(-self.value, self.exponent)

    def rsqrt(self):
        """Return the reciprocal root; 0 where there is none, so that v rsqrt(v) is 0 there."""
        half_exponent = (np.frexp(self.value)[1] + self.exponent + 1) // 2
        even = np.ldexp(self.value, self.exponent - 2 * half_exponent)
        return _Scaled(np.where(even > 0, 1 / np.sqrt(np.where(even > 0, even, 1.0)), 0.0), -half_exponent)

    def double(self):
        return np.ldexp(self.value, self.exponent)

    @classmethod
    def rounded(cls, words, exponent):
        """Round Python integers times 2^exponent once."""
        bits = np.frompyfunc(int.bit_length, 1, 1)(words)
        return cls((words / (1 << bits)).astype(np.float64), bits.astype(np.int64) + exponent)


_FUNCTIONS = {
    "rsqrt": lambda v: v.rsqrt() if isinstance(v, _Scaled) else 1 / np.sqrt(v),
    "half_c": partial(_half, 0),
    "half_s": partial(_half, 1),
    "Abs": np.abs,
    "sin": np.sin,
    "cos": np.cos,
}


def solve_lean(x, y, z, phi, d1, d2):
    """Return a pose for any N targets, with flags, by the lean equations.

    x, y, z (wrist target), d1 (upper arm), d2 (forearm) in one unit of length, phi in radians; numbers or arrays that
    broadcast to (N,). Targets need not be in reach nor lengths positive: such targets get the pose of
    `equations.solve_clamped`. Returns a dict of arrays (N,): every line of `LEAN`, and flags (int64). Squares of the
    user's unit are 0 or inf beyond the range of doubles, without effect on the others. Never nan, provided that d1 + d2
    and d1 - d2 are finite. Raises ValueError for inputs that are not finite or do not broadcast, and for arm lengths
    outside `equations.LENGTH_RANGE` of a target in reach.
    """
    x, y, z, phi, d1, d2 = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    flags = pose_flags(x, y, z, d1, d2)
    cases = {
        "on_axis": flags & ON_AXIS != 0,
        "at_shoulder": flags & AT_SHOULDER != 0,
        "clamped": flags & (UNREACHABLE | AT_SHOULDER) != 0,
        "straight": flags & (TOO_FAR | BAD_LENGTH) != 0,
        "away": (flags & TOO_NEAR != 0) & (d1 < d2),  # folded, with the upper arm away from the target
    }
    check_lengths(d1, d2, ~cases["clamped"])

    words, unit = _exact((x, y, z, d1, d2))
    values: dict[str, Any] = dict(zip(("x", "y", "z", "d1", "d2"), words, strict=True))

    def evaluate(groups):
        for name, code in ((name, code) for group in groups for name, code in _CODE[group].items()):
            values[name] = eval(code, _FUNCTIONS, values)

    with np.errstate(over="ignore", under="ignore"):
        evaluate(EXACT)
        values = {name: _Scaled.rounded(v, unit * (1 + (name in SQUARES))) for name, v in values.items()}
        evaluate(SCALED)
        values = {name: value.double() for name, value in values.items()} | {"phi": phi}
    # Where d1 + d2 or d1 - d2 is not a double, a target may be out of reach by less than its rounding; then A or B is
    # negative and the other value of each pair above 1, and the target counts as at the limit.
    for name, case in CASES.items():
        last_first = [cases[c] for c in reversed(case)], [*reversed(case.values())]
        values[name] = np.select(*last_first, np.clip(values[name], -1, 1))
    evaluate(group for group in LEAN if group not in (*EXACT, *SCALED))
    sign = np.where(values["k_1"] < 0, -1.0, 1.0)
    values |= {name: sign * values[name] for name in ("qs_w", "qs_i", "qs_j", "qs_k")}
    return {name: values[name] for name in NUMBER} | {"flags": flags}


# -- the same poses in fewer operations --------------------------------------------------------------------------------


def solve_direct(target):
    """Return the results (6, N) and flags (N,) of :func:`solve_lean` within rounding, in a tenth of its time.

    target (6, N): finite numbers in the order of FIELDS, lengths positive. Each result depends on its own target only.
    Plain sums suffice unless A or B is small relative to s. Such targets get exact sums, targets on the axis their
    conventions; `solve_lean` takes those with squares outside `_LEAST` to `_MOST`.
    """
    x, y, z, phi, d1, d2 = target
    with np.errstate(all="ignore"):
        rho_sq, product = x * x + y * y, d1 * d2
        s = rho_sq + z * z
        p, d_sum, d_dif = np.sqrt(s), d1 + d2, d1 - d2
        squares = np.empty((2, len(x)))  # A, B
        squares[0], squares[1] = (d_sum - p) * (d_sum + p), (p - d_dif) * (p + d_dif)
        # of the azimuth and 90 degrees, the tilt, the angle at the shoulder
        cosines, sines, divisors = np.empty((3, 3, len(x)))
        cosines[0], cosines[1], cosines[2] = -y, z, s + d_sum * d_dif
        sines[0], sines[1] = x, np.sqrt(rho_sq)
        divisors[0], divisors[1], divisors[2] = sines[1], p, (d1 + d1) * p
        regular = (np.minimum(squares[0], squares[1]) > s * 0.03125) & (rho_sq > _LEAST) & (squares[0] < _MOST)
        flags, extreme = np.zeros(len(x), dtype=np.int64), False
        if np.count_nonzero(regular) < len(x):
            rows = np.flatnonzero(~regular)
            few, most = target[:, rows], divisors[2, rows]
            law, squares[:, rows], flags[rows] = _near_limits(few, cosines[2, rows])
            cosines[2, rows] = np.minimum(np.maximum(law, -most), most)
            if (on_axis := (few[0] == 0) & (few[1] == 0)).any():
                at_shoulder = rows[on_axis & (few[2] == 0)]
                flags[rows] += ON_AXIS * on_axis
                flags[at_shoulder] += AT_SHOULDER
                sines[0, rows[on_axis]] = divisors[0, rows[on_axis]] = 1
                cosines[1, at_shoulder] = divisors[1:, at_shoulder] = 1
                cosines[2, at_shoulder] = np.where(d_dif[at_shoulder] < 0, -1, 1)
            size = np.square(few)
            extreme = ~((size < _MOST) & ((size > _LEAST) | (few == 0))).all(axis=0)
        roots = np.sqrt(squares)
        sines[2] = roots[0] * roots[1]
        results = np.empty((6, len(x)))
        qs, qe = results[:4], results[4:]
        np.divide(roots, np.sqrt(4.0 * product), out=qe)
        np.negative(qe[1], out=qe[1])
        cosines /= divisors
        sines /= divisors + divisors
        toward = cosines >= 0
        lengths = 0.5 * np.abs(cosines) + 0.5
        az_c, tilt_c, arm_c = np.where(toward, lengths, sines)
        az_s, tilt_s, arm_s = np.where(toward, sines, lengths)
        half = phi * 0.5
        sin_h, cos_h = np.sin(half), np.cos(half)
        cc, ss, sc, cs = az_c * cos_h, az_s * sin_h, az_s * cos_h, az_c * sin_h
        w, i, j, k = tilt_c * (cc - ss), tilt_s * (cc + ss), tilt_s * (sc - cs), tilt_c * (sc + cs)
        qs[0], qs[1] = w * arm_c + i * arm_s, i * arm_c - w * arm_s
        qs[2], qs[3] = j * arm_c - k * arm_s, k * arm_c + j * arm_s
        qs /= np.copysign(np.sqrt(lengths[0] * lengths[1] * lengths[2]), qs[3] + 0.0)  # -0 counts as 0
    if np.any(extreme):
        exact = solve_lean(*target[:, rows[extreme]])
        results[:, rows[extreme]] = [*(exact[f"qs_{unit}"] for unit in "wijk"), exact["qe_w"], exact["qe_i"]]
        flags[rows[extreme]] = exact["flags"]
    return results, flags


def _near_limits(target, law):
    """Return K, A and B (2, N), limited to 0 .. 4 d1 d2, and too_far and too_near, from sums in twice the precision."""
    x, y, z, _, d1, d2 = target
    v = np.array((x, y, z, d1 + d2, d1 - d2))
    high = v * _SPLIT
    high -= high - v
    low, square = v - high, v * v
    error = (high * high - square) + 2 * high * low + low * low
    rho_sq, first = _two_sum(square[0], square[1])
    s, second = _two_sum(rho_sq, square[2])
    limit, rest = _two_sum(square[3:], -s)
    limit += rest + (error[3:] - (error[0] + error[1] + error[2] + first + second))
    flags = TOO_FAR * (limit[0] < 0) + TOO_NEAR * (limit[1] > 0)
    doubt = np.minimum(np.abs(limit[0]), np.abs(limit[1])) <= 1e-28 * s
    if doubt.any():
        exact = pose_flags(*target[[0, 1, 2, 4, 5]][:, doubt])
        flags[doubt] = exact & (TOO_FAR | TOO_NEAR)
    # Flags are of the rounded d1 + d2 and d1 - d2, a pose in reach is of the exact ones.
    limit += np.where(flags, 0, 2) * v[3:] * _two_sum(d1, np.array((d2, -d2)))[1]
    a, b = limit[0], -limit[1]
    if (short := 16 * d1 < v[3]).any():  # s + d_sum d_dif would cancel
        form = np.where(s < 4 * d1 * d1, 2 * d1 * v[4] + b, 2 * d1 * v[3] - a)
        law = np.where(short, form, law)
    return law, np.maximum(np.minimum((a, b), 4 * (d1 * d2)), 0), flags

# SPDX-License-Identifier: Apache-2.0
"""Lean equations in double precision: the paper's results from square roots, without the paper's singular poses.

docs/generated/lean.md derives them from the paper's (10)-(18). With s = |p|^2, rho^2 = x^2 + y^2, A = (d1 + d2)^2 - s,
B = s - (d1 - d2)^2 and K = s + d1^2 - d2^2, for a target in reach:

    Qe = sqrt(A)/(2 sqrt(d1 d2)) - sqrt(B)/(2 sqrt(d1 d2)) i                         the paper's (14)
    cos azimuth = x/rho, sin azimuth = y/rho    sin elevation = z/|p|, cos elevation = rho/|p|
    cos a = K/(2 d1 |p|)    sin a = sqrt(A) sqrt(B)/(2 d1 |p|)
    Qs = Rz(azimuth + 90 deg) Rx(90 deg - elevation) Rz(phi) Rx(-a)                  the paper's (18)

Each factor of Qs except Rz(phi) is computed from the cosine and sine of its angle, as a quaternion that is not of unit
length: (1 + cos, sin)/2, or (sin, 1 - cos)/2 if cos < 0. The squared length of a factor is (1 + |cos|)/2. One root
normalizes the product.

The two solvers do not use the core's dataflow (:mod:`model.dataflow.lean`); tests compare the dataflow with both.
:func:`solve_lean` computes the squares of all sines and cosines as ratios of integers. It keeps full relative precision
next to the z axis and for an almost straight or closed arm, where ``equations.solve`` loses up to half of its digits.
:func:`solve_direct` has the same precision in a tenth of the time.
"""

import numpy as np

from ..io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, UNREACHABLE
from ..io.words import RESULT_FIELDS
from .equations import check_lengths, columns, pose_flags

_SPLIT = 2.0**27 + 1
_LEAST, _MOST = 1e-280, 1e280  # range of squared lengths for which :func:`solve_direct` needs no integers


def _integers(values):
    """Return doubles (M, N) as Python integers; each column has its own unit, a power of two."""
    mantissas, exponents = np.frexp(values)
    exponents = np.where(mantissas == 0, exponents.max(axis=0), exponents)
    return np.ldexp(mantissas, 53).astype(np.int64).astype(object) << (exponents - exponents.min(axis=0)).astype(object)


def _root(square, of, sign=1):
    """Return sqrt(``square`` / ``of``) of integers, with the sign of ``sign``. The ratio is limited to 0 .. 1, and is 0
    where ``of`` is 0."""
    square, of = np.where(of > 0, np.minimum(square, of), 0), np.where(of > 0, of, 1)
    return np.where(sign < 0, -1.0, 1.0) * np.sqrt(np.maximum((square / of).astype(np.float64), 0.0))


def _shoulder(cosines, half_sines, phi):
    """Return Qs (4, N) from cosines and halved sines (3, N) of azimuth + 90 deg, 90 deg - elevation and a."""
    toward = cosines >= 0
    lengths = 0.5 * np.abs(cosines) + 0.5
    az_c, tilt_c, bend_c = np.where(toward, lengths, half_sines)
    az_s, tilt_s, bend_s = np.where(toward, half_sines, lengths)
    half = phi * 0.5
    sin_h, cos_h = np.sin(half), np.cos(half)
    cc, ss, sc, cs = az_c * cos_h, az_s * sin_h, az_s * cos_h, az_c * sin_h
    w, i, j, k = tilt_c * (cc - ss), tilt_s * (cc + ss), tilt_s * (sc - cs), tilt_c * (sc + cs)
    qs = np.empty((4, len(phi)))
    qs[0], qs[1] = w * bend_c + i * bend_s, i * bend_c - w * bend_s
    qs[2], qs[3] = j * bend_c - k * bend_s, k * bend_c + j * bend_s
    qs /= np.copysign(np.sqrt(lengths[0] * lengths[1] * lengths[2]), qs[3] + 0.0)  # -0 counts as 0
    return qs


def solve_lean(x, y, z, phi, d1, d2):
    """Return poses and flags of any N targets by the lean equations.

    x, y, z (wrist target), d1 (upper arm) and d2 (forearm) share one unit of length, phi is in radians; all are numbers
    or arrays that broadcast to (N,). Targets out of reach or with lengths <= 0 get the pose of
    `equations.solve_clamped`. Returns a dict of arrays (N,): the results, and flags (int64). Results are never nan if
    d1 + d2 and d1 - d2 are finite. Raises ValueError for inputs that are not finite or do not broadcast, and for
    targets in reach with a length outside `equations.LENGTH_RANGE`.
    """
    x, y, z, phi, d1, d2 = columns(x=x, y=y, z=z, phi=phi, d1=d1, d2=d2)
    flags = pose_flags(x, y, z, d1, d2)
    on_axis, at_shoulder = flags & ON_AXIS != 0, flags & AT_SHOULDER != 0
    clamped = flags & (UNREACHABLE | AT_SHOULDER) != 0
    straight, away = flags & (TOO_FAR | BAD_LENGTH) != 0, (flags & TOO_NEAR != 0) & (d1 < d2)
    check_lengths(d1, d2, ~clamped)

    p_x, p_y, p_z, upper, fore = _integers((x, y, z, d1, d2))
    rho_sq = p_x * p_x + p_y * p_y
    s = rho_sq + p_z * p_z
    a, b, k = (upper + fore) ** 2 - s, s - (upper - fore) ** 2, s + upper * upper - fore * fore
    whole, law = (np.where(clamped, 0, square) for square in (4 * upper * fore, 4 * upper * upper * s))
    # A target out of reach by less than the rounding of d1 + d2 or d1 - d2 counts as at the limit.
    qe_w = np.where(clamped, ~straight, _root(a, whole))
    qe_i = np.where(clamped, -1.0 * straight, -_root(b, whole))
    cos_tilt = np.where(at_shoulder, 1.0, _root(p_z * p_z, s, p_z))
    cos_bend = np.where(clamped, np.where(away, -1.0, 1.0), _root(k * k, law, k))
    cosines = np.array([_root(p_y * p_y, rho_sq, -p_y), cos_tilt, cos_bend])
    sines = np.array([np.where(on_axis, 1.0, _root(p_x * p_x, rho_sq, p_x)), _root(rho_sq, s), _root(a * b, law)])
    results = [*_shoulder(cosines, sines / 2, phi), qe_w, qe_i]
    return dict(zip(RESULT_FIELDS, results, strict=True)) | {"flags": flags}


def solve_direct(target):
    """Return the results (6, N) and flags (N,) of :func:`solve_lean` within rounding, in a tenth of its time.

    target (6, N): finite numbers in the order of FIELDS, lengths positive. Each result depends on its own target only.
    Where A or B is small relative to s, sums have twice the precision of a double. Targets on the z axis follow the
    conventions of `solve_lean`; targets with squares outside `_LEAST` to `_MOST` are passed to `solve_lean`.
    """
    x, y, z, phi, d1, d2 = target
    with np.errstate(all="ignore"):
        rho_sq, product = x * x + y * y, d1 * d2
        s = rho_sq + z * z
        p, d_sum, d_dif = np.sqrt(s), d1 + d2, d1 - d2
        squares = np.empty((2, len(x)))  # A, B
        squares[0], squares[1] = (d_sum - p) * (d_sum + p), (p - d_dif) * (p + d_dif)
        # rows: azimuth + 90 deg, 90 deg - elevation, a
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
        qs[:] = _shoulder(cosines, sines, phi)
    if np.any(extreme):
        exact = solve_lean(*target[:, rows[extreme]])
        results[:, rows[extreme]] = [exact[name] for name in RESULT_FIELDS]
        flags[rows[extreme]] = exact["flags"]
    return results, flags


def _two_sum(a, b):
    """Return a + b rounded, and the rounding error; their exact sum is a + b."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _near_limits(target, law):
    """Return K, A, B and reach flags, from sums with twice a double's precision. A and B are limited to 0 .. 4 d1 d2.
    ``law``: K in double precision; it is returned unless d1 is so small that the terms of K cancel."""
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
    # Flags use the rounded d1 + d2 and d1 - d2; a pose in reach uses the exact sums.
    limit += np.where(flags, 0, 2) * v[3:] * _two_sum(d1, np.array((d2, -d2)))[1]
    a, b = limit[0], -limit[1]
    if (short := 16 * d1 < v[3]).any():  # s + d_sum d_dif would cancel
        law = np.where(short, 2 * d1 * v[3] - a, law)
    return law, np.maximum(np.minimum((a, b), 4 * (d1 * d2)), 0), flags

# SPDX-License-Identifier: Apache-2.0
"""Quaternions as arrays (N, 4) in the order w, i, j, k, the arm's forward kinematics, and the reference axis.

The units i, j, k are Hamilton's, as in the paper's (1)-(3), and Q v Q~ is the right-handed rotation (4). Vectors are
arrays (N, 3). Arguments are not normalized: a quaternion scales the rotated vector by its squared length.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Axis = str | Sequence[float] | NDArray[Any]
"""A name in :data:`NAMED_AXES`, or a vector (3,) of any length but 0."""

NAMED_AXES = ("z", "-z", "x", "-x", "y", "-y")

_HALF_TURN = (0.0, 1.0, 0.0, 0.0)  # about x: -z becomes z
_TO_Z = {"x": (0.5, -0.5, -0.5, -0.5), "y": (0.5, 0.5, 0.5, 0.5), "z": (1.0, 0.0, 0.0, 0.0)}
"""Axis -> quaternion of the cyclic exchange that takes it to z. It only permutes coordinates, so no bit is lost."""

_NO_AXIS = f"must be {', '.join(NAMED_AXES)} or a nonzero vector of three finite numbers"


def product(p, q):
    """Return the Hamilton product p q of quaternions with components first, (4, N) or (4,)."""
    (a_w, a_i, a_j, a_k), (b_w, b_i, b_j, b_k) = p, q
    w = a_w * b_w - a_i * b_i - a_j * b_j - a_k * b_k
    i = a_w * b_i + a_i * b_w + a_j * b_k - a_k * b_j
    j = a_w * b_j - a_i * b_k + a_j * b_w + a_k * b_i
    k = a_w * b_k + a_i * b_j - a_j * b_i + a_k * b_w
    return np.array((w, i, j, k))


def multiply(a, b):
    """Return the Hamilton product a b of quaternions, each (N, 4) or (4,)."""
    return np.stack(product(*(np.moveaxis(np.asarray(q, dtype=np.float64), -1, 0) for q in (a, b))), axis=-1)


def about(axis: int, angle):
    """Return quaternions (N, 4) of rotations by angles (N,), rad, about axis 0 (x), 1 (y) or 2 (z); (4,) for one."""
    q = np.zeros((*np.shape(angle), 4))
    q[..., 0], q[..., 1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return q


def fixed_axes(roll, pitch, yaw):
    """Return quaternions of rotations by roll, pitch and yaw (rad) about the fixed axes x, then y, then z."""
    return multiply(multiply(about(2, yaw), about(1, pitch)), about(0, roll))


def conjugate(q):
    """Return Q~ of quaternions (N, 4): the reverse rotation."""
    return np.asarray(q, dtype=np.float64) * (1.0, -1.0, -1.0, -1.0)


def rotate(q, v):
    """Return Q v Q~, (N, 3), for quaternions (N, 4) or (4,) and vectors (N, 3) or (3,)."""
    v = np.asarray(v, dtype=np.float64)
    pure = np.concatenate((np.zeros_like(v[..., :1]), v), axis=-1)
    return multiply(multiply(q, pure), conjugate(q))[..., 1:]


def matrix(q):
    """Return the rotation matrices (N, 3, 3) of unit quaternions (N, 4), or (3, 3) for one quaternion (4,)."""
    return np.stack([rotate(q, e) for e in np.eye(3)], axis=-1)


def quaternion(m):
    """Return unit quaternions (N, 4) of rotation matrices (N, 3, 3); their signs are arbitrary."""
    trace = np.trace(m, axis1=1, axis2=2)
    # Row n is 4 q_n times the quaternion; the row with the largest diagonal element loses the fewest digits.
    rows = np.empty((len(m), 4, 4))
    rows[:, 0, 0] = 1 + trace
    axis = [m[:, (n + 2) % 3, (n + 1) % 3] - m[:, (n + 1) % 3, (n + 2) % 3] for n in range(3)]
    rows[:, 0, 1:] = rows[:, 1:, 0] = np.stack(axis, axis=-1)
    rows[:, 1:, 1:] = m + np.swapaxes(m, 1, 2) + (1 - trace)[:, None, None] * np.eye(3)
    largest = np.argmax(np.diagonal(rows, axis1=1, axis2=2), axis=-1)
    q = rows[np.arange(len(rows)), largest]
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def angle_between(a, b):
    """Return the angles (N,), 0 to pi rad, of the rotations from quaternions a to b, (N, 4), of any length and sign."""
    relative = multiply(conjugate(a), b)  # the arc cosine of a . b would lose half of the digits of tiny angles
    return 2.0 * np.arctan2(np.linalg.norm(relative[..., 1:], axis=-1), np.abs(relative[..., 0]))


def forward(qs, qe, d1, d2):
    """Return the points (N, 3) of elbow and wrist for Qs (N, 4) and Qe, which is (N, 4), or (N, 2) with w and i only.

        elbow = Qs (d1 e3) Qs~          wrist = Qs (d1 e3 + Qe (-d2 e3) Qe~) Qs~

    d1 and d2 are numbers or (N,).
    """
    q, e = (np.atleast_2d(np.asarray(joint, dtype=np.float64)).T for joint in (qs, qe))
    d1, d2 = np.asarray(d1), np.asarray(d2)
    (_, i, j, k), (ww, ii, jj, kk), (twice_w, twice_i, twice_j, _) = q, q * q, q + q
    wi, wj, wk, ij, ik, jk = twice_w * i, twice_w * j, twice_w * k, twice_i * j, twice_i * k, twice_j * k
    y = np.array((ij - wk, (ww + jj) - (ii + kk), jk + wi))  # Qs e2 Qs~
    z = np.array((ik + wj, jk - wi, (ww + kk) - (ii + jj)))
    elbow = d1 * z
    if e[2:].any():
        return elbow.T, elbow.T + rotate(q.T, rotate(e.T, d2[..., None] * (0.0, 0.0, -1.0)))
    c, s = e[:2]
    return elbow.T, (elbow + d2 * ((c + c) * s) * y + d2 * (s * s - c * c) * z).T


def continuous(q: ArrayLike, arm: ArrayLike | None = None) -> NDArray[np.float64]:
    """Return quaternions (N, 4) or (4,) with signs that make successive rows continuous, for interpolation.

    Q and -Q are the same rotation, and the core keeps k >= 0. w may come first or last. Rows of nan are skipped.
    ``arm`` (N,) names the arm of each row; arms are processed separately.
    """
    q = np.array(q, dtype=np.float64)
    rows = q.reshape(-1, 4)  # a view: a single quaternion is one row
    arms = np.zeros(len(rows), dtype=int) if arm is None else np.asarray(arm)
    present = ~np.isnan(rows).any(axis=1)
    for name in np.unique(arms):
        path = np.flatnonzero((arms == name) & present)
        against = (rows[path[1:]] * rows[path[:-1]]).sum(axis=1) < 0
        rows[path[1:]] *= np.where(np.cumsum(against) % 2, -1.0, 1.0)[:, None]
    return q


def direction(axis: Axis) -> NDArray[np.float64]:
    """Return the unit vector (3,) of an axis.  Raises ValueError."""
    if isinstance(axis, str) and axis in NAMED_AXES:
        return np.where(np.array(list("xyz")) == axis[-1], -1.0 if axis[0] == "-" else 1.0, 0.0)
    try:
        vector = np.asarray(axis, dtype=np.float64)
    except (TypeError, ValueError):
        vector = np.empty(0)
    size = np.abs(vector).max(initial=0.0)
    if vector.shape != (3,) or not np.isfinite(vector).all() or size == 0:
        raise ValueError(f"axis {axis!r} {_NO_AXIS}")
    vector = vector / size  # squares of very long or short vectors would overflow or underflow
    return vector / np.linalg.norm(vector)


def parse_axis(text: str) -> Axis:
    """Parse an axis: a name, or three numbers separated by commas.  Raises ValueError."""
    try:
        axis = tuple(float(part) for part in text.split(",")) if "," in text else text
        direction(axis)
    except ValueError:
        raise ValueError(f"axis {text!r} {_NO_AXIS}") from None
    return axis


def to_z(axis: Axis) -> NDArray[np.float64]:
    """Return the quaternion (4,), in the order w, i, j, k, of a rotation that takes the axis to z."""
    a = direction(axis)
    if np.count_nonzero(a) == 1:
        turn = np.array(_TO_Z["xyz"[np.argmax(np.abs(a))]])
        return multiply(_HALF_TURN, turn) if a.sum() < 0 else turn
    # Turn to the nearer of z and -z: the angle is at most 90 degrees, so 1 + z does not cancel.
    below = a[2] < 0
    x, y, z = a * (1, -1, -1) if below else a
    turn = np.array((1 + z, y, -x, 0.0))
    turn /= np.linalg.norm(turn)
    return multiply(turn, _HALF_TURN) if below else turn

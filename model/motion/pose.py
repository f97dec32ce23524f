# SPDX-License-Identifier: Apache-2.0
"""Poses of an arm from Python: the public functions of `cga_ik`.

Frame: the shoulder at the origin, x forward, y to the left, z up.  Lengths are in any one unit, angles in radians.
Quaternions are Hamilton's and give the right-handed rotation; at rest the upper arm points along z and the forearm is
folded back on it:

    elbow = Qs (d1 e3) Qs~          wrist = Qs (d1 e3 + Qe (-d2 e3) Qe~) Qs~

The reference axis is the direction that replaces the paper's z axis, from which the swivel angle is measured.  The
equations are singular where the wrist lies on it, so it should point where no hand goes.  The core uses z only; the
host rotates coordinates by R, which takes the axis to z, and multiplies Qs by R~ afterwards.  Any such R will do: a
further turn about z changes azimuth and Qs by the same angle, and leaves phi unchanged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..dataflow import fixed
from ..dataflow.datapaths import CONFIGURATIONS
from ..dataflow.nodes import WIDTHS
from ..io.words import DEFAULT_D1, DEFAULT_D2, RESULT_FIELDS, Targets, from_words, result_values, to_words
from ..reference import kinematics
from ..reference.equations import solve_clamped
from ..reference.kinematics import continuous, matrix, multiply
from ..reference.lean_equations import solve_lean

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Order = Literal["wxyz", "xyzw"]
"""Position of a quaternion's scalar part: first, or last as in scipy and most engines."""

__all__ = ["Pose", "continuous", "forward", "hanging", "solve", "swivel"]

DOUBLE = {"lean": solve_lean, "paper": solve_clamped}


Axis = str | Sequence[float] | np.ndarray
"""A name of :data:`NAMED_AXES`, or a vector of three, of any length."""

_HALF_TURN = (0.0, 1.0, 0.0, 0.0)  # about x: -z becomes z
_TO_Z = {"x": (0.5, -0.5, -0.5, -0.5), "y": (0.5, 0.5, 0.5, 0.5), "z": (1.0, 0.0, 0.0, 0.0)}
"""Cyclic exchanges of the axes: they only permute coordinates, so no bit is lost."""

NAMED_AXES = ("z", "-z", "x", "-x", "y", "-y")


_NO_AXIS = f"is none of {', '.join(NAMED_AXES)} and no vector of three finite numbers, one of which is not 0"


@dataclass(frozen=True, eq=False)
class Pose:
    """N poses.

    * qs, qe (N, 4): shoulder and elbow quaternion, in ``order``; in words of ``width`` bits their values are exact
    * flags (N,): int64, see :mod:`model.io.flags`; 0 where the hand is at the target
    * elbow, wrist (N, 3): positions from forward kinematics, in the unit of the targets
    * phi (N,): the requested swivel angle, rad
    """

    qs: np.ndarray
    qe: np.ndarray
    flags: np.ndarray
    elbow: np.ndarray
    wrist: np.ndarray
    phi: np.ndarray
    order: Order = "wxyz"

    def to_scipy(self) -> tuple[Rotation, Rotation]:
        """Return shoulder and elbow as :class:`scipy.spatial.transform.Rotation` (matrices, Euler angles, slerp)."""
        from scipy.spatial.transform import Rotation

        first = self.order == "wxyz"
        return Rotation.from_quat(self.qs, scalar_first=first), Rotation.from_quat(self.qe, scalar_first=first)


def solve(
    points: ArrayLike,
    phi: ArrayLike | None = None,
    d1: ArrayLike = DEFAULT_D1,
    d2: ArrayLike = DEFAULT_D2,
    *,
    axis: Axis = "z",
    width: int | None = None,
    datapath: str = "lean",
    order: Order = "wxyz",
) -> Pose:
    """Return shoulder and elbow of arms for wrist targets, (10)-(18) of the paper.

    * points (N, 3) or (3,): wrist targets, the shoulder at the origin
    * phi: swivel angle, rad: 0 is the elbow in the plane of axis and wrist, on the side to which the axis points.
      None is :func:`hanging`
    * d1, d2: upper arm and forearm; they and phi are numbers or (N,)
    * axis: the reference axis, a name ("z", "-z", "x", ...) or a vector of three
    * width: None is double precision; 16 to 32 gives the words of the core, bit for bit
    * datapath: "lean", "paper", or "lean25", which is lean with products cut for 25x18-bit multipliers

    An unreachable target gets the nearest pose, and a flag.  Raises ValueError for shapes that do not broadcast,
    numbers that are not finite, an unknown width, datapath or order, and (as its subclass TargetError)
    for a target that does not fit the core's format together with the others.
    """
    if datapath not in CONFIGURATIONS:
        raise ValueError(f"datapath {datapath!r} is none of {', '.join(CONFIGURATIONS)}")
    widths = [w for w in CONFIGURATIONS[datapath].widths if w in WIDTHS]
    if width is not None and width not in widths:
        raise ValueError(f"width {width!r} is none of {', '.join(map(str, widths))}, and not None")
    points = np.atleast_2d(np.asarray(points, dtype=np.float64))
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points have the shape {points.shape}, not (N, 3)")
    x, y, z = points.T
    angle, upper, fore = (np.asarray(v, dtype=np.float64) for v in (hanging(axis) if phi is None else phi, d1, d2))
    targets = Targets("targets", x, y, z, angle, upper, fore, frame=to_z(axis))
    for name in ("position", "phi", "d1", "d2"):
        if not np.isfinite(getattr(targets, name)).all():
            raise ValueError(f"{'points' if name == 'position' else name}: not all numbers are finite")

    if width is None:
        x, y, z = targets.core_position.T
        answer = DOUBLE[CONFIGURATIONS[datapath].equations](x, y, z, targets.phi, targets.d1, targets.d2)
        words = np.column_stack([answer[field] for field in RESULT_FIELDS])
        flags, asked = answer["flags"], targets
    else:
        target_words, exponent = to_words(targets, width)
        run = fixed.run(target_words, width, datapath)
        words, flags = result_values(run.results, width), run.flags
        asked = from_words(target_words, exponent, width, targets.name)
    qs = targets.from_core(words[:, :4])
    qe = np.column_stack((words[:, 4:], np.zeros((len(words), 2))))
    elbow, wrist = kinematics.forward(qs, words[:, 4:], targets.d1, targets.d2)
    return Pose(_rolled(order, qs, -1), _rolled(order, qe, -1), np.asarray(flags), elbow, wrist, asked.phi, order)


def forward(
    qs: ArrayLike, qe: ArrayLike, d1: ArrayLike = DEFAULT_D1, d2: ArrayLike = DEFAULT_D2, *, order: Order = "wxyz"
) -> tuple[np.ndarray, np.ndarray]:
    """Return elbow and wrist (N, 3) of arms whose joints are at Qs and Qe, (N, 4) each, in the unit of the lengths.

    d1, d2: numbers or (N,).  Any reference axis: it is part of Qs.  Raises ValueError for shapes that do not match.
    """
    shoulder, elbow = (np.atleast_2d(np.asarray(q, dtype=np.float64)) for q in (qs, qe))
    for q in (shoulder, elbow):
        if q.shape[-1] != 4:
            raise ValueError(f"quaternions have the shape {q.shape}, not (N, 4)")
    return kinematics.forward(_rolled(order, shoulder, 1), _rolled(order, elbow, 1), d1, d2)


def swivel(shoulder: ArrayLike, elbow: ArrayLike, wrist: ArrayLike, axis: Axis = "z") -> np.ndarray:
    """Return the swivel angle (N,), rad in [-pi, pi], of arms whose joints are at these points, (N, 3) each or (3,).

    Passed to :func:`solve` as phi, it reproduces the elbow.  It is arbitrary where the arm is straight or folded;
    near those poses, rounding of the elbow's offset from the line limits its accuracy.
    """
    shoulder = np.asarray(shoulder, dtype=np.float64)
    turn = matrix(to_z(axis)).T
    e, p = (np.atleast_2d(np.asarray(point, dtype=np.float64) - shoulder) @ turn for point in (elbow, wrist))
    rho = np.hypot(p[:, 0], p[:, 1])
    on_axis = rho == 0  # azimuth 0, as in the core
    c, s = np.where(on_axis, 1.0, p[:, 0]), np.where(on_axis, 0.0, p[:, 1])
    length = np.hypot(c, s)
    c, s = c / length, s / length
    inward = e[:, 0] * c + e[:, 1] * s
    aside = e[:, 0] * s - e[:, 1] * c
    return np.arctan2(aside, (rho * e[:, 2] - p[:, 2] * inward) / np.linalg.norm(p, axis=1))


def hanging(axis: Axis = "z") -> float:
    """Return the swivel angle (rad) for which the elbow of an arm that reaches forward (x) hangs straight down (-z).

    It is pi for z, 0 for -z.  Where the axis is x itself, the arm reaches to the left (y) instead.
    """
    reach = (0.0, 1.0, 0.0) if abs(direction(axis)[0]) == 1 else (1.0, 0.0, 0.0)
    return float(swivel((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), reach, axis)[0])


def _rolled(order: Order, q: np.ndarray, places: int) -> np.ndarray:
    """Return quaternions in another order: `places` is -1 from wxyz to `order`, 1 from `order` to wxyz."""
    if order not in ("wxyz", "xyzw"):
        raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")
    return q if order == "wxyz" else np.roll(q, places, axis=-1)


# -- the reference axis ----------------------------------------------------------------------------


def direction(axis: Axis) -> np.ndarray:
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


def to_z(axis: Axis) -> np.ndarray:
    """Return the quaternion (4,) w, i, j, k of R, which takes the axis to z."""
    a = direction(axis)
    for name in NAMED_AXES:
        if (a == direction(name)).all():
            turn = np.array(_TO_Z[name[-1]])
            return multiply(_TO_Z["z"] if name[0] != "-" else _HALF_TURN, turn)
    # The shorter way to z or -z: half of it is below 45 degrees, where the sum does not cancel.
    below = a[2] < 0
    x, y, z = a * (1, -1, -1) if below else a
    turn = np.array((1 + z, y, -x, 0.0))
    turn /= np.linalg.norm(turn)
    return multiply(turn, _HALF_TURN) if below else turn

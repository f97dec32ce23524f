# SPDX-License-Identifier: Apache-2.0
"""Reference axis: the direction that replaces the paper's z axis, from which the swivel angle is measured.

The equations are singular where the wrist lies on this axis, so it should point where no hand goes.  The core uses z
only; the host rotates coordinates by R, which takes the axis to z, and multiplies Qs by R~ afterwards.  Any R that
takes the axis to z will do: a further turn about z changes azimuth and Qs by the same angle, and leaves phi unchanged.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..reference.kinematics import multiply

Axis = str | Sequence[float] | np.ndarray
"""A name of :data:`NAMED`, or a vector of three, of any length."""

_HALF_TURN = (0.0, 1.0, 0.0, 0.0)  # about x: -z becomes z
_TO_Z = {"x": (0.5, -0.5, -0.5, -0.5), "y": (0.5, 0.5, 0.5, 0.5), "z": (1.0, 0.0, 0.0, 0.0)}
"""Cyclic exchanges of the axes: they only permute coordinates, so no bit is lost."""

NAMED = ("z", "-z", "x", "-x", "y", "-y")


class AxisError(ValueError):
    """Invalid axis; the text is one line for the user."""


def direction(axis: Axis) -> np.ndarray:
    """Return the unit vector (3,) of an axis.  Raises :class:`AxisError`."""
    if isinstance(axis, str):
        if axis not in NAMED:
            raise AxisError(f"axis {axis!r} is none of {', '.join(NAMED)} and no vector of three")
        return np.where(np.array(list("xyz")) == axis[-1], -1.0 if axis[0] == "-" else 1.0, 0.0)
    try:
        vector = np.asarray(axis, dtype=np.float64)
    except (TypeError, ValueError):
        vector = np.empty(0)
    size = np.abs(vector).max(initial=0.0)
    if vector.shape != (3,) or not np.isfinite(vector).all() or size == 0:
        raise AxisError(f"axis {axis!r} is no vector of three finite numbers, one of which is not 0")
    vector = vector / size  # squares of very long or short vectors would overflow or underflow
    return vector / np.linalg.norm(vector)


def parse(text: str) -> Axis:
    """Parse an axis: a name, or three numbers separated by commas.  Raises :class:`AxisError`."""
    if "," not in text:
        direction(text)
        return text
    try:
        vector = tuple(float(part) for part in text.split(","))
        direction(vector)
    except ValueError:
        raise AxisError(f"axis {text!r} is no vector of three finite numbers, one of which is not 0") from None
    return vector


def to_z(axis: Axis) -> np.ndarray:
    """Return the quaternion (4,) w, i, j, k of R, which takes the axis to z.  Raises :class:`AxisError`."""
    a = direction(axis)
    for name in NAMED:
        if (a == direction(name)).all():
            turn = np.array(_TO_Z[name[-1]])
            return multiply(_TO_Z["z"] if name[0] != "-" else _HALF_TURN, turn)
    # The shorter way to z or -z: half of it is below 45 degrees, where the sum does not cancel.
    below = a[2] < 0
    x, y, z = a * (1, -1, -1) if below else a
    turn = np.array((1 + z, y, -x, 0.0))
    turn /= np.linalg.norm(turn)
    return multiply(turn, _HALF_TURN) if below else turn

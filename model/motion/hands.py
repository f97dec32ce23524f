# SPDX-License-Identifier: Apache-2.0
"""Hand poses: checked arguments, vectors from wrist to hand, joint limits as words."""

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..io.words import LENGTH_TOLERANCE
from ..reference import joints
from ..reference.kinematics import quaternion

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Hands:
    """Hands of N poses; a field may also hold a single value for all poses.

    * q (4, N): orientations, unit quaternions w, i, j, k
    * tool (N,): distance from the wrist to the hand's point, along the hand's z axis
    * branch (N,): bits of :class:`Branch`
    * missing (N,): True for poses with a nan in hand or tool; q and tool then hold other numbers
    """

    q: Floats
    tool: Floats
    branch: NDArray[np.int64]
    missing: NDArray[np.bool_]

    @classmethod
    def checked(
        cls, hand: ArrayLike, tool: ArrayLike, branch: ArrayLike, order: str = "wxyz", nan: str = "raise"
    ) -> "Hands":
        """Return the hands with quaternions, normalized to length 1, for orientations as in :func:`quaternions`.

        Raises ValueError for a length that is not about 1, for other wrong arguments, and for a nan with nan="raise".
        """
        check_order(order)
        rows = quaternions(hand, order)
        if rows.ndim != 2 or rows.shape[1] != 4:
            raise ValueError(f"hand has the shape {np.shape(hand)}, not (N, 4)")
        length = np.sqrt(np.einsum("ij,ij->i", rows, rows))
        wrong = (np.abs(length - 1) > LENGTH_TOLERANCE) | (length == np.inf)
        refuse("hand", wrong, f"length {length[wrong.argmax()]:.6g}, not 1," if wrong.any() else "")
        tools, branches = np.asarray(tool, dtype=np.float64), np.asarray(branch)
        if branches.dtype.kind not in "iu" or ((branches < 0) | (branches >= 2 ** len(joints.Branch))).any():
            raise ValueError(f"branch {branch!r} is not a combination of {', '.join(joints.Branch.__members__)}")
        if np.isinf(tools).any():
            raise ValueError("tool: not finite")
        missing = np.isnan(length) | np.isnan(tools)
        if missing.any():
            refuse("hand and tool", missing & (nan == "raise"), "not finite")
            rows, length = np.where(missing[:, None], 0.5, rows), np.where(missing, 1.0, length)
            tools = np.where(missing, 0.0, tools)
        q = rows.T[[0, 1, 2, 3] if order == "wxyz" else [3, 0, 1, 2]] / length
        return cls(q, tools, branches, missing)

    @property
    def offset(self) -> Floats:
        """Vectors (3, N) from the wrist to the hand's point."""
        return joints.tool_offset(self.q, self.tool)

    def part(self, rows: slice) -> "Hands":
        """Return the hands of the poses in ``rows``."""
        return Hands(*(v if v.shape[-1:] in ((), (1,)) else v[..., rows] for v in vars(self).values()))


def limit_words(limits: Floats | None, width: int) -> list[tuple[int, int]]:
    """Return lowest and highest word of each joint within its limits. A range of a turn or more allows any word."""
    half, unit, words = 2 ** (width - 1), 2**width / (2 * np.pi), []
    for low, high in [(-np.inf, np.inf)] * 7 if limits is None else limits.tolist():
        free = not high - low < 2 * np.pi
        words.append((-half, half - 1) if free else (math.ceil(low * unit), math.floor(high * unit)))
    return words


def refuse(name: str, rows: NDArray[np.bool_], reason: str) -> None:
    """Raise ValueError if any of ``rows`` (N,) is True; the message names the first three rows."""
    if rows.any():
        first = np.flatnonzero(rows)
        more = f" and {len(first) - 3} more" if len(first) > 3 else ""
        raise ValueError(f"{name}: {reason} in row{'s'[: len(first) > 1]} {', '.join(map(str, first[:3]))}{more}")


def check_order(order: str) -> None:
    if order not in ("wxyz", "xyzw"):
        raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")


def quaternions(hand: Any, order: str) -> Floats:
    """Return quaternions (N, 4) in ``order`` of orientations: quaternions (N, 4) or (4,), matrices (N, 3, 3), (3, 3) or
    (N, 4, 4), or a scipy Rotation.  Raises ValueError for matrices that are no rotations."""
    if hasattr(hand, "as_quat"):
        return np.atleast_2d(np.roll(hand.as_quat(), int(order == "wxyz"), axis=-1))
    values = np.asarray(hand, dtype=np.float64)
    if values.shape[-2:] != (3, 3) and not (values.ndim == 3 and values.shape[1:] == (4, 4)):
        return np.atleast_2d(values)
    turns = values[..., :3, :3].reshape(-1, 3, 3)
    off = np.abs(turns @ turns.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2))
    refuse("hand", ~(off < LENGTH_TOLERANCE) | ~(np.linalg.det(np.nan_to_num(turns)) > 0), "no rotation")
    return np.roll(quaternion(turns), -int(order == "xyzw"), axis=1)


def checked_rows(name: str, values: ArrayLike, size: int) -> Floats:
    """Return an array (N, size); one row may have the shape (size,).  Raises ValueError for others and for a nan."""
    rows = np.asarray(values, dtype=np.float64)
    rows = rows[None] if rows.ndim == 1 and rows.size else rows.reshape(-1, size) if not rows.size else rows
    if rows.ndim != 2 or rows.shape[1] != size:
        raise ValueError(f"{name}: shape {np.shape(values)}, not (N, {size})")
    refuse(name, np.asarray(~np.isfinite(rows).all(axis=1)), "not finite")
    return rows


def common_count(counts: dict[str, int]) -> int:
    """Return the number of rows of arguments with this number each, or 1.  Raises ValueError if they do not match."""
    if len(different := set(counts.values()) - {1} or {1}) > 1:
        listed = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise ValueError(f"numbers of rows do not broadcast: {listed}")
    return different.pop()


def checked_limits(limits: ArrayLike) -> Floats:
    """Return joint limits as an array (7, 2), rad.  Warns of degrees.  Raises ValueError for a wrong shape or an empty
    interval."""
    ends = np.asarray(limits, dtype=np.float64)
    if ends.shape != (7, 2):
        raise ValueError(f"limits have the shape {ends.shape}, not (7, 2)")
    for joint, (low, high) in enumerate(ends.tolist(), 1):
        if not low <= high:
            raise ValueError(f"limits of joint {joint}: {low:.6g} to {high:.6g} is not an interval")
    sizes = np.abs(ends)
    largest = sizes[sizes <= 1080].max(initial=0.0)
    if largest > 8 * np.pi:
        warnings.warn(f"limits reach {largest:g}; their unit is the radian: convert degrees", stacklevel=3)
    return ends

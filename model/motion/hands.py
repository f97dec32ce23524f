# SPDX-License-Identifier: Apache-2.0
"""Hands of poses: checks, wrist targets, and the seven joint angles of the arm that holds a hand."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..dataflow import fixed
from ..dataflow.datapaths import MODELS
from ..io.flags import BAD_HAND, OVER_BIT
from ..io.words import (
    FIELDS,
    JOINTS,
    LENGTH_TOLERANCE,
    RESULT_FIELDS,
    WRIST_FIELDS,
    Targets,
    from_words,
    result_values,
    to_words,
)
from ..reference import joints
from ..reference.kinematics import product

Floats = NDArray[np.float64]


class ArmWords(NamedTuple):
    """Output of ``ik_arm`` for n hand poses.

    * results (6, n): Qs and Qe, as ``RESULT_FIELDS``; flags (n,), without over_limit
    * phi (n,): the swivel angle that the words represent, rad
    * qw (4, n): wrist quaternion; joints (7, n): rad; over_limit (7, n)
    """

    results: Floats
    flags: NDArray[np.int64]
    phi: Floats
    qw: Floats
    joints: Floats
    over_limit: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Hands:
    """Hands of N poses; a field may also hold a single value for all poses.

    * q (4, N): orientations, unit quaternions w, i, j, k
    * tool (N,): distance from the wrist to the hand's point, along the hand's z axis
    * branch (N,): bits of :class:`Branch`
    * missing (N,): poses with a nan in hand or tool, replaced here
    """

    q: Floats
    tool: Floats
    branch: NDArray[np.int64]
    missing: NDArray[np.bool_]

    @classmethod
    def checked(
        cls, hand: ArrayLike, tool: ArrayLike, branch: ArrayLike, order: str = "wxyz", nan: str = "raise"
    ) -> "Hands":
        """Check hands (N, 4) or (4,), and make their lengths exactly 1.

        Raises ValueError for hands that are not of length 1, wrong arguments, and a nan unless it may "pass".
        """
        check_order(order)
        rows = np.atleast_2d(np.asarray(hand, dtype=np.float64))
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
    def sizes(self) -> dict[str, int]:
        """Dict: argument name -> number of its rows."""
        return {"hand": len(self.q.T), "tool": self.tool.size, "branch": self.branch.size}

    @property
    def offset(self) -> Floats:
        """Vectors (3, N) from the wrist to the hand's point."""
        return joints.tool_offset(self.q, self.tool)

    def part(self, rows: slice) -> "Hands":
        """Return the hands of some poses."""
        return Hands(*(v if v.shape[-1:] in ((), (1,)) else v[..., rows] for v in vars(self).values()))

    def in_words(self, targets: Targets, exponent: int, width: int, limits: Floats | None) -> ArmWords:
        """Solve hand poses at ``targets`` with the bit-true model of ``ik_arm``."""
        path, ends = MODELS["arm"], limit_words(limits, width)
        words, _ = to_words(replace(targets, hand=self.q.T, tool=self.tool, branch=self.branch), width, exponent)
        run = fixed.run(words[:, :-1], width, path.name, words[:, -1], ends)
        over = run.flags >> OVER_BIT + np.arange(7)[:, None] & 1 > 0
        over |= np.array([[high < low] for low, high in ends])  # limits with no word between them
        value = dict(zip(path.results, result_values(run.results, width).T, strict=True))
        results, qw, th = (np.array([value[k] for k in names]) for names in (RESULT_FIELDS, WRIST_FIELDS, JOINTS))
        th *= np.pi / 2  # the word 1 is a quarter turn
        phi = from_words(words[:, : len(FIELDS)], exponent, width, targets.name).phi
        return ArmWords(results, run.flags & 2 * BAD_HAND - 1, phi, qw, th, over)

    def offset_of(self, qs: Floats, qe: Floats, qw: Floats) -> Floats:
        """Return vectors as `offset` for Qs (4, N), qe_w and qe_i (2, N), Qw (4, N); their lengths do not matter."""
        q = product(product(qs, np.array((-qe[1], qe[0], 0 * qe[0], 0 * qe[0]))), qw)
        return joints.tool_offset(q / np.linalg.norm(q, axis=0), self.tool)


def limit_words(limits: Floats | None, width: int) -> list[tuple[int, int]]:
    """Return the lowest and highest word of each joint within its limits; a joint without limits has a whole turn."""
    half, unit, words = 2 ** (width - 1), 2**width / (2 * np.pi), []
    for low, high in [(-np.inf, np.inf)] * 7 if limits is None else limits.tolist():
        free = not high - low < 2 * np.pi
        words.append((-half, half - 1) if free else (math.ceil(low * unit), math.floor(high * unit)))
    return words


def refuse(name: str, rows: NDArray[np.bool_], reason: str) -> None:
    """Raise ValueError, which names the first of the rows (N,) that are True, if there are any."""
    if rows.any():
        first = np.flatnonzero(rows)
        more = f" and {len(first) - 3} more" if len(first) > 3 else ""
        raise ValueError(f"{name}: {reason} in row{'s'[: len(first) > 1]} {', '.join(map(str, first[:3]))}{more}")


def check_order(order: str) -> None:
    """Raise ValueError for an unknown order of a quaternion's components."""
    if order not in ("wxyz", "xyzw"):
        raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")


def checked_limits(limits: ArrayLike) -> Floats:
    """Return limits (7, 2) of the joints, rad.  Raises ValueError."""
    ends = np.asarray(limits, dtype=np.float64)
    if ends.shape != (7, 2):
        raise ValueError(f"limits have the shape {ends.shape}, not (7, 2)")
    for joint, (low, high) in enumerate(ends.tolist(), 1):
        if not low <= high:
            raise ValueError(f"limits of joint {joint}: {low:.6g} to {high:.6g} is not an interval")
    return ends

# SPDX-License-Identifier: Apache-2.0
"""Poses of a hand: checks, wrist targets, and the seven joint angles of the arm that holds it."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..dataflow import fixed
from ..dataflow.datapaths import MODELS
from ..io.flags import BAD_HAND, OVER_BIT
from ..io.words import (
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


class Hands:
    """Orientations of N hands or of one, and what goes with them.

    * tool: distance from the wrist to the hand's point, along the hand's z axis; a number or (N,)
    * branch: bits of :class:`Branch`; a number or (N,)
    * lost (N,): rows with a nan in hand or tool, which are replaced
    """

    def __init__(self, hand: ArrayLike, tool: ArrayLike, branch: ArrayLike, order: str = "wxyz") -> None:
        """Take hands (N, 4) or (4,).  Raises ValueError for rows that are not of length 1, and wrong arguments."""
        if order not in ("wxyz", "xyzw"):
            raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")
        q = np.atleast_2d(np.asarray(hand, dtype=np.float64))
        if q.ndim != 2 or q.shape[1] != 4:
            raise ValueError(f"hand has the shape {np.shape(hand)}, not (N, 4)")
        length = np.sqrt(np.einsum("ij,ij->i", q, q))
        self.tool, self.branch = np.asarray(tool, dtype=np.float64), np.asarray(branch)
        wrong = (np.abs(length - 1) > LENGTH_TOLERANCE) | (length == np.inf)
        refuse("hand", wrong, f"length {length[wrong.argmax()]:.6g}, not 1," if wrong.any() else "")
        self.lost = np.isnan(length) | np.isnan(self.tool)
        if self.lost.any():
            q, length = np.where(self.lost[:, None], 0.5, q), np.where(self.lost, 1.0, length)
            self.tool = np.where(np.isnan(self.tool), 0.0, self.tool)
        self._rows, self._length, self._from = q, length, [0, 1, 2, 3] if order == "wxyz" else [3, 0, 1, 2]
        if self.branch.dtype.kind not in "iu" or ((self.branch < 0) | (self.branch >= 2 ** len(joints.Branch))).any():
            raise ValueError(f"branch {branch!r} is no combination of {', '.join(joints.Branch.__members__)}")
        if np.isinf(self.tool).any():
            raise ValueError("tool: not finite")
        self.count = max(len(q), self.tool.size, self.branch.size)

    def part(self, rows: slice) -> tuple[Any, Any, Any]:
        """Return Qh (4, n), unit quaternions w, i, j, k, the vectors to the hand's point (3, n), and branches."""
        q, length, tool, branch = (  # one for all, or one for each
            each if each.ndim == 0 or len(each) == 1 else each[rows]
            for each in (self._rows, self._length, self.tool, self.branch)
        )
        q = q.T[self._from] / length
        return q, joints.tool_offset(q, tool), branch

    def in_words(self, rows: slice, targets: Targets, exponent: int, width: int, bounds: Floats | None) -> tuple:
        """Return what ``ik_arm`` computes for these hands at ``targets``: results of the core (6, n), flags and swivel
        angles (n,), Qw (4, n), joints and whether they are outside their limits (7, n)."""
        path, (q, _, branch) = MODELS["arm"], self.part(rows)
        words, _ = to_words(replace(targets, hand=q.T, tool=self._tool(rows), branch=branch), width, exponent)
        limits = limit_words(bounds, width)
        run = fixed.run(words[:, :-1], width, path.name, words[:, -1], limits)
        over = run.flags >> OVER_BIT + np.arange(7)[:, None] & 1 > 0
        over |= np.array([[last < first] for first, last in limits])  # there is no word within them
        value = dict(zip(path.results, result_values(run.results, width).T, strict=True))
        core, turn, th = (np.array([value[k] for k in names]) for names in (RESULT_FIELDS, WRIST_FIELDS, JOINTS))
        th *= np.pi / 2  # words of an angle have 1 at a quarter turn
        asked = from_words(words[:, :6], exponent, width, targets.name).phi
        return core, run.flags & 2 * BAD_HAND - 1, asked, turn, th, over

    def _tool(self, rows: slice) -> Floats:
        return self.tool[rows] if self.tool.ndim and len(self.tool) > 1 else self.tool

    def reached(self, rows: slice, qs: Floats, qe: Floats, qw: Floats) -> Floats:
        """Return vectors (3, n) from the wrist to the hand's point for Qs (4, n), qe_w and qe_i (2, n), Qw (4, n)."""
        q = product(product(qs, np.array((-qe[1], qe[0], 0 * qe[0], 0 * qe[0]))), qw)
        return joints.tool_offset(q / np.linalg.norm(q, axis=0), self._tool(rows))


def limit_words(limits: Floats | None, width: int) -> list[tuple[int, int]]:
    """Return the lowest and highest word of each joint within its limits; a joint without limits has a whole turn."""
    half, unit, found = 2 ** (width - 1), 2**width / (2 * np.pi), []
    for low, high in [(-np.inf, np.inf)] * 7 if limits is None else limits.tolist():
        free = not high - low < 2 * np.pi
        found.append((-half, half - 1) if free else (math.ceil(low * unit), math.floor(high * unit)))
    return found


def refuse(name: str, rows: NDArray[np.bool_], reason: str) -> None:
    """Raise ValueError, which names the first of the rows (N,) that are True, if there are any."""
    if rows.any():
        first = np.flatnonzero(rows)
        more = f" and {len(first) - 3} more" if len(first) > 3 else ""
        raise ValueError(f"{name}: {reason} in row{'s'[: len(first) > 1]} {', '.join(map(str, first[:3]))}{more}")


def checked_limits(limits: ArrayLike) -> Floats:
    """Return limits (7, 2) of the joints, rad.  Raises ValueError."""
    found = np.asarray(limits, dtype=np.float64)
    if found.shape != (7, 2):
        raise ValueError(f"limits have the shape {found.shape}, not (7, 2)")
    if (wrong := np.flatnonzero(~(found[:, 0] <= found[:, 1]))).size:
        low, high = found[wrong[0]]
        raise ValueError(f"limits of joint {wrong[0] + 1}: {low:.6g} to {high:.6g}")
    return found

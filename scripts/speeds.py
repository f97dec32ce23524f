# SPDX-License-Identifier: Apache-2.0
"""Speeds of a robot's joints along timed hand poses."""

from typing import NamedTuple

import numpy as np

from model.io.files import number
from model.io.words import Targets, cell_error
from model.motion.arms import Arm
from model.motion.path import JointPath


class Speeds(NamedTuple):
    """Largest speeds of a robot's joints (7,), rad/s; their limits (7,), inf for none; numbers of rows above (7,)."""

    names: tuple[str, ...]
    largest: np.ndarray
    limits: np.ndarray
    above: np.ndarray

    def figures(self) -> list[tuple[str, ...]]:
        """Return a row of a table for each joint: name and largest speed."""
        limits = (f", limit {limit:.4g}" if np.isfinite(limit) else "" for limit in self.limits)
        rows = zip(self.names, limits, self.largest, strict=True)
        return [(f"largest speed of {name}{limit} (rad/s)", f"{speed:.3g}") for name, limit, speed in rows]

    def doubt(self) -> str:
        """Return a warning that names the joints above their limits, or an empty string."""
        fast = np.flatnonzero(self.above)
        listed = [
            f"{self.names[k]} in {self.above[k]} rows, up to {self.largest[k]:.3g} of {self.limits[k]:.4g} rad/s"
            for k in fast
        ]
        return f"{len(fast)} of 7 joints exceed their limits of speed: {'; '.join(listed)}" if listed else ""


def times(targets: Targets, rate: float | None) -> np.ndarray | None:
    """Return the time of each row, s, (N,): by a rate, Hz, from 0 in each path, or a column t; None without either.

    Raises TargetError for times that do not increase inside a path.
    """
    seconds, name = np.empty(len(targets)), next((name for name in targets.others if name.lower() == "t"), None)
    if rate is not None:
        for rows in targets.paths:
            seconds[rows] = np.arange(len(rows)) / rate
        return seconds
    if name is None:
        return None
    assert targets.rows is not None
    cells, lines = [cell.strip() for cell in targets.others[name]], targets.rows.tolist()
    for n, cell in enumerate(cells):
        try:
            seconds[n] = number(cell.replace(",", "."))
        except ValueError:
            raise cell_error(targets.path, lines[n], name, cell, "is not a time in seconds") from None
    for rows in targets.paths:
        for n, before in zip(rows[1:], rows, strict=False):
            if seconds[n] <= seconds[before]:
                reason = f"is not after {cells[before]!r} of row {lines[before]}: times increase inside a path"
                raise cell_error(targets.path, lines[n], name, cells[n], reason)
    return seconds


def speeds(robot: Arm, path: JointPath, positions: np.ndarray, seconds: np.ndarray, targets: Targets) -> Speeds:
    """Return the speeds at joint positions (N, 7) along planned paths; rows without planned joints are left out."""
    limits = np.where(robot.velocities > 0, robot.velocities, np.inf)  # some files have 0 for an unknown limit
    moves = [np.zeros((1, 7))]
    for rows in targets.paths:
        rows = rows[np.isfinite(path.joints[rows, 0])]
        moves.append(np.abs(np.diff(positions[rows], axis=0)) / np.diff(seconds[rows])[:, None])
    all_moves = np.concatenate(moves)
    return Speeds(robot.names, all_moves.max(axis=0), limits, np.count_nonzero(all_moves > limits, axis=0))

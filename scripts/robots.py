# SPDX-License-Identifier: Apache-2.0
"""Planned paths of a robot through hand poses, and the speeds of its joints if the poses have times."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from model.io.files import number
from model.io.words import Targets, cell_error
from model.motion.arms import GOAL, Arm
from model.motion.path import JointPath
from model.reference.kinematics import conjugate, multiply


class Speeds(NamedTuple):
    """Each joint's largest speed (7,), rad/s; speed limit (7,), rad/s or inf; number of rows above the limit (7,). All
    are empty if the rows have no times."""

    names: tuple[str, ...] = ()
    largest: np.ndarray = np.zeros(0)
    limits: np.ndarray = np.zeros(0)
    above: np.ndarray = np.zeros(0, dtype=int)

    def figures(self) -> list[tuple[str, ...]]:
        """Return a table row for each joint: its name with its limit, and its largest speed."""
        limits = (f", limit {limit:.4g}" if np.isfinite(limit) else "" for limit in self.limits)
        rows = zip(self.names, limits, self.largest, strict=True)
        return [(f"largest speed of {name}{limit} (rad/s)", f"{speed:.3g}") for name, limit, speed in rows]

    def doubt(self) -> str:
        """Return a warning that names the joints above their speed limits; an empty string if there are none."""
        rows = zip(self.names, self.above, self.largest, self.limits, strict=True)
        fast = [f"{name} in {n} rows, up to {most:.3g} of {limit:.4g} rad/s" for name, n, most, limit in rows if n]
        return f"{len(fast)} of 7 joints exceed their limits of speed: {'; '.join(fast)}" if fast else ""


def times(targets: Targets, rate: float | None) -> np.ndarray | None:
    """Return each row's time (s), (N,). With ``rate`` (Hz), each path starts at 0; without it, column t has the times.

    Returns None if both are missing. Raises TargetError for a column t whose times do not increase inside a path.
    """
    seconds, name = np.empty(len(targets)), next((name for name in targets.others if name.lower() == "t"), None)
    if rate is not None:
        for rows in targets.paths:
            seconds[rows] = np.arange(len(rows)) / rate
        return seconds
    if name is None:
        return None
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


def planned(
    robot: Arm, poses: Targets, each: bool = False, progress: Callable[[int, str], None] = lambda rows, text: None
) -> tuple[Targets, JointPath]:
    """Convert poses of the robot's tip to targets of `ik_arm`; return them with the planned path through them.

    Swivel angles are planned if all phi are nan, and branches if there is no column ``branch``. Rows with the same
    ``path`` form a path; with `each`, every row is a path. If no joints are within the limits, `Arm.solve` sets phi and
    branch of the row. progress: called with the number of planned rows and a text.
    Raises ValueError for bent links, and for axes that do not meet exactly; use :meth:`Arm.nearest` for these.
    """
    if robot.chain:
        raise ValueError("ik_arm solves only arms whose axes meet exactly")
    if robot.bent:
        raise ValueError("links are bent: the joints of ik_arm are along or across its bones")
    count, paths = len(poses), poses.paths
    phi = None if np.isnan(poses.phi).all() else poses.phi
    branch = poses.branch if "branch" in poses.others else None
    empty = np.full((count, 7), np.nan)
    whole = JointPath(empty, empty[:, 0].copy(), np.zeros(count, dtype=np.int64), np.zeros(count), {})
    done = 0
    for group in np.arange(count)[:, None] if each else paths:
        some_phi, some_branch = (None if v is None else v[group] for v in (phi, branch))

        def report(part: float, angles: int, done: int = done, rows: int = len(group)) -> None:
            progress(done + int(part * rows), f"{angles} swivel angles")

        path = robot.path(poses.position[group], poses.hand[group], phi=some_phi, branch=some_branch, progress=report)
        done += len(group)
        for name in ("joints", "phi", "branch", "step"):
            getattr(whole, name)[group] = getattr(path, name)
        whole.jumps.update({int(group[n]): text for n, text in path.jumps.items()})
    for rows in (rows[np.isfinite(whole.phi[rows])] for rows in paths if each):
        whole.step[rows[1:]] = np.abs(np.diff(whole.joints[rows], axis=0)).max(axis=1)
        large = rows[whole.step[rows] > GOAL].tolist()
        whole.jumps.update({n: f"a joint moves by {whole.step[n]:.3g} rad" for n in large})
    missing = np.flatnonzero(np.isnan(whole.phi))
    asked = (None if v is None else v[missing] for v in (phi, branch))
    pose = robot.solve(poses.position[missing], poses.hand[missing], *asked)
    whole.phi[missing], whole.branch[missing] = pose.phi, pose.branch
    others = {name: poses.others[name] for name in poses.others if name != "branch"}
    others |= {"branch": [*map(str, whole.branch.tolist())], "step": [*map(repr, whole.step.tolist())]}
    lengths: dict[str, Any] = {"d1": robot.d1, "d2": robot.d2, "tool": robot.tool[None], "default_arm": ()}
    lengths |= {"origin": robot.base, "frame": conjugate(robot.mount), "others": others, "branch": whole.branch}
    q = multiply(poses.hand, conjugate(robot.tip))
    targets = replace(poses, phi=whole.phi if phi is None else phi, hand=q, **lengths)
    return targets, replace(whole, jumps=dict(sorted(whole.jumps.items())))

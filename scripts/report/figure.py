# SPDX-License-Identifier: Apache-2.0
"""Human figure of a clip for the report: every bone in every frame, with the core's arms; joint angles.

The page draws with z up, so the clip's axes are permuted cyclically until its up axis is z.  Points are integers in a
small unit, relative to the root, which keeps a page of 3000 frames at a few megabytes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from model.motion.clip import Arm, Clip, Motion, outward_and_up, rest_up
from model.reference.kinematics import conjugate, rotate
from scripts.run import quaternions, turned
from scripts.trajectory import Prepared
from tb.sim.simulate import Run

STEPS = 4000
"""Units per height of the figure: finer than a pixel."""

BODY, UPPER, FORE, HEAD = range(4)
"""Body part of the bone that ends at a node."""


def place(up: str) -> np.ndarray:
    """Return the rotation (3, 3) from a clip's frame to the page's frame (z up). up: the clip's up axis, e.g. "-y"."""
    turn = np.roll(np.eye(3), 2 - "xyz".index(up[-1]), axis=0)
    return turn if up[0] != "-" else np.diag((1.0, -1.0, -1.0)) @ turn


def _parts(clip: Clip, moves: tuple[Motion, ...]) -> list[int]:
    """Return the body part of the bone that ends at each node; an end site below a joint named head is HEAD."""
    parts = [HEAD if node.end and "head" in clip.names[node.parent].lower() else BODY for node in clip.nodes]
    for move in moves:
        arm = move.arm
        for part, joint, high in ((UPPER, arm.fore, arm.upper), (FORE, arm.hand, arm.fore)):
            while joint != high:
                parts[joint] = part
                joint = clip.parents[joint]
    return parts


def _facing(item: Prepared, turn: np.ndarray) -> float:
    """Return the figure's facing direction in the first frame (rad, about z)."""
    left = np.zeros(3)
    for move in item.moves:
        arm = move.arm
        out = turn @ (item.clip.positions[0, arm.upper] - item.clip.positions[0, arm.torso])
        left += out if arm.side == "left" else -out
    return float(np.arctan2(-left[0], left[1]))  # left x up


def figure_data(item: Prepared, ran: Run, width: int) -> dict[str, Any]:
    """Return the figure with the core's arms in F frames, and the clip's own arms, in the page's frame.

    * nodes: per frame the root, then every node relative to the root; own: per frame elbow and wrist of each of the
      clip's own arms, relative to the root; both flat lists in `unit`
    * floor, middle: heights of the floor and of the view's centre; middle None: height of the root
    * radius: largest distance of any point from the view's centre, which is above the root's position on the floor
    """
    clip, moves = item.clip, item.moves
    turn = place(clip.up)
    nodes = turned(item, ran, width).positions @ turn.T
    root = nodes[:, :1].copy()
    own = clip.positions[:, [joint for move in moves for joint in (move.arm.fore, move.arm.hand)]] @ turn.T - root
    low, high = float(nodes[..., 2].min()), float(nodes[..., 2].max())
    size = np.linalg.norm(np.ptp(nodes - root, axis=1), axis=1).max()
    unit = float(f"{size / STEPS:.3g}")
    from_middle = np.concatenate((nodes - root, own), axis=1)
    # If the figure climbs or flies, the view follows its height.
    middle = (low + high) / 2 if np.ptp(root[..., 2]) < size / 2 else None
    if middle is not None:
        from_middle[..., 2] += root[..., 2] - middle

    def whole(points: np.ndarray) -> list[list[int]]:
        return np.rint(points.reshape(len(points), -1) / unit).astype(int).tolist()

    return {
        "rate": float(f"{1 / clip.period:.6g}"),
        "arms": [
            {"side": move.arm.label} | {part: getattr(move.arm, part) for part in ("upper", "fore", "hand")}
            for move in moves
        ],
        "parents": clip.parents,
        "parts": _parts(clip, moves),
        "unit": unit,
        "nodes": whole(np.concatenate((root, (nodes - root)[:, 1:]), axis=1)),
        "own": whole(own),
        "place": turn.tolist(),
        "facing": round(_facing(item, turn), 4),
        "floor": low,
        "middle": middle,
        "radius": float(np.linalg.norm(from_middle, axis=2).max()),
    }


def joint_angles(item: Prepared, ran: Run, width: int) -> np.ndarray:
    """Return angles (N, 4) in degrees: azimuth and elevation of the upper arm, swivel angle, elbow flexion.

    Azimuth is measured from forward (x) to the left, elevation from the horizontal: in the torso's frame for a clip,
    else in the frame of the targets.  Flexion is 0 for a straight arm.
    """
    qs, qe = quaternions(item, ran, width)
    upper = rotate(qs, (0.0, 0.0, 1.0))
    for n, move in enumerate(item.moves):
        upper[n :: len(item.moves)] = _from_torso(item.clip, move.arm, upper[n :: len(item.moves)])
    azimuth = np.arctan2(upper[:, 1], upper[:, 0])
    elevation = np.arcsin(np.clip(upper[:, 2], -1, 1))
    # Qe rotates by 0 if the forearm is folded onto the upper arm and by pi if the arm is straight.
    flexion = np.pi - 2 * np.arctan2(np.abs(qe[:, 1]), qe[:, 0])
    return np.degrees(np.column_stack((azimuth, elevation, item.targets.phi, flexion)))


def _from_torso(clip: Clip, arm: Arm, directions: np.ndarray) -> np.ndarray:
    """Convert directions (F, 3) from a clip's frame to the torso's axes: forward, left, up."""
    up = rest_up(clip)
    left = outward_and_up(clip, arm) - up
    left = left if arm.side == "left" else -left
    axes = np.stack((np.cross(left, up), left, up), axis=1)
    return rotate(conjugate(clip.turn[:, arm.torso]), directions) @ axes

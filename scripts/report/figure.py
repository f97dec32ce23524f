# SPDX-License-Identifier: Apache-2.0
"""The human figure of a clip for the report: every bone in every frame, with the core's arms; and joint angles.

The page draws with z up, so a clip's axes are exchanged in a circle until its up is z.  Points are whole numbers of a
small unit, from the root; that keeps a page of 3000 frames at a few megabytes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from model.io.words import result_values
from model.motion.clip import Arm, Clip, Motion, outward_and_up
from model.reference.kinematics import rotate
from scripts.results import turned
from scripts.trajectory import Prepared
from tb.sim.simulate import Run

STEPS = 4000
"""Units from the figure's foot to its head: finer than a pixel."""

BODY, UPPER, FORE, HEAD = range(4)
"""What the bone that ends at a node is part of."""


def place(up: str) -> np.ndarray:
    """The rotation (3, 3) from a clip's frame, with its up such as "+y", to the page's, where z is up."""
    turn = np.roll(np.eye(3), 2 - "xyz".index(up[1]), axis=0)
    return turn if up[0] != "-" else np.diag((1.0, -1.0, -1.0)) @ turn


def _nodes(clip: Clip) -> tuple[list[int], list[int]]:
    """Parent of every node, end sites included, and the node of every joint."""
    index = clip.bvh.node_index
    parents = [-1 if node.parent is None else index[node.parent.name] for node in clip.bvh.nodes]
    return parents, [index[name] for name in clip.bvh.joint_names]


def _parts(clip: Clip, moves: tuple[Motion, ...], node_of: list[int]) -> list[int]:
    """For the bone that ends at each node; that of an end site below a joint named head is the head."""
    nodes = clip.bvh.nodes
    parts = [HEAD if node.is_end_site() and "head" in node.parent.name.lower() else BODY for node in nodes]
    for move in moves:
        arm = move.arm
        for part, low, high in ((UPPER, arm.fore, arm.upper), (FORE, arm.hand, arm.fore)):
            joint = low
            while joint != high:
                parts[node_of[joint]] = part
                joint = clip.parents[joint]
    return parts


def _facing(item: Prepared, turn: np.ndarray) -> float:
    """The direction (rad, about z) to which the figure looks in the first frame."""
    left = np.zeros(3)
    for move in item.moves:
        arm = move.arm
        out = turn @ (item.clip.positions[0, arm.upper] - item.clip.positions[0, arm.torso])
        left += out if arm.side == "left" else -out
    return float(np.arctan2(-left[0], left[1]))  # left x up


def figure_data(item: Prepared, ran: Run, width: int) -> dict[str, Any]:
    """The figure with the core's arms in F frames, and the clip's own arms, in the page's frame.

    * nodes: of each frame the root, then every node from the root; own: of each frame elbow and wrist of each arm of
      the clip itself, from the root; both in `unit` and in one flat list
    * floor, middle: heights of the floor and of the view's middle, None for that of the root
    * radius: how far anything is from the middle of the view, which is above the root's place on the floor
    """
    clip, moves = item.clip, item.moves
    turn = place(clip.bvh.world_up)
    parents, node_of = _nodes(clip)
    nodes = turned(item, ran, width).node_positions() @ turn.T
    root = nodes[:, :1].copy()
    own = clip.positions[:, [joint for move in moves for joint in (move.arm.fore, move.arm.hand)]] @ turn.T - root
    low, high = float(nodes[..., 2].min()), float(nodes[..., 2].max())
    size = np.linalg.norm(np.ptp(nodes - root, axis=1), axis=1).max()
    unit = float(f"{size / STEPS:.3g}")
    from_middle = np.concatenate((nodes - root, own), axis=1)
    # Of a figure that climbs or flies the view follows the height, too.
    middle = (low + high) / 2 if np.ptp(root[..., 2]) < size / 2 else None
    if middle is not None:
        from_middle[..., 2] += root[..., 2] - middle

    def whole(points: np.ndarray) -> list[list[int]]:
        return np.rint(points.reshape(len(points), -1) / unit).astype(int).tolist()

    return {
        "rate": float(f"{1 / clip.bvh.frame_time:.6g}"),
        "arms": [
            {"side": move.arm.side} | {part: node_of[getattr(move.arm, part)] for part in ("upper", "fore", "hand")}
            for move in moves
        ],
        "parents": parents,
        "parts": _parts(clip, moves, node_of),
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
    """Angles (N, 4) in degrees: azimuth and elevation of the upper arm, swivel angle, flexion of the elbow.

    Azimuth counts from forward (x) to the left, elevation from the horizontal: of a clip as its torso sees them, else
    in the frame of the targets.  Flexion is 0 of a straight arm.
    """
    values = result_values(ran.results, width)
    upper = rotate(item.targets.from_core(values[:, :4]), (0.0, 0.0, 1.0))
    for n, move in enumerate(item.moves):
        upper[n :: len(item.moves)] = _from_torso(item.clip, move.arm, upper[n :: len(item.moves)])
    azimuth = np.arctan2(upper[:, 1], upper[:, 0])
    elevation = np.arcsin(np.clip(upper[:, 2], -1, 1))
    # Qe turns by 0 where the forearm lies folded on the upper arm, and by pi where the arm is straight.
    flexion = np.pi - 2 * np.arctan2(np.abs(values[:, 5]), values[:, 4])
    return np.degrees(np.column_stack((azimuth, elevation, item.targets.phi, flexion)))


def _from_torso(clip: Clip, arm: Arm, directions: np.ndarray) -> np.ndarray:
    """Directions (F, 3) of a clip's frame as the torso sees them: forward, left, up."""
    up = np.zeros(3)
    up["xyz".index(clip.bvh.rest_up[1])] = -1.0 if clip.bvh.rest_up[0] == "-" else 1.0
    left = outward_and_up(clip, arm) - up
    left = left if arm.side == "left" else -left
    axes = np.stack((np.cross(left, up), left, up), axis=1)
    return np.einsum("fij,fi->fj", clip.world[:, arm.torso] @ axes, directions)

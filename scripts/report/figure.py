# SPDX-License-Identifier: Apache-2.0
"""Data for drawings of the report: entities of the paper's figures 1 to 5; the human figure of a clip; joint angles.

The entities are computed in double precision from the core's input words, not from its results.

A clip's figure has every bone in every frame; the core poses its arms. The page draws with z up, so the clip's axes are
permuted cyclically until its up axis is z. Points are integers in a small unit, relative to the root, which keeps a
page of 3000 frames at a few megabytes.
"""

import base64
from typing import Any

import numpy as np

from model.io.words import from_words
from model.motion.clip import Clip, Motion, outward_and_up, rest_up
from model.reference import cga, geometry
from model.reference.cga import e3
from model.reference.kinematics import conjugate, rotate
from scripts.trajectory import Prepared, quaternions, turned
from tb.sim.simulate import Run

UNITS = 32000
"""Steps per length 1 and per half turn. All numbers then fit in 16 bits, which keeps pages of long clips small."""

NOTHING = -32768
"""Number that stands for an undefined entity, such as the elbow where the spheres do not meet."""

NEAR = 1e-4
"""Largest geometric error, as a fraction of the reach, at which an entity near a singular pose is still drawn."""


def entities(item: Prepared, width: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the entities by name: vectors (N, 3) in the user's frame, angles (N,) in rad, and lengths (N,).

    Points and lengths are relative to the reach; directions are unit vectors. Undefined entities are nan.
    """
    asked = from_words(item.core_words(width), 0, width, item.targets.name)
    lengths = [values / asked.reach for values in (asked.x, asked.y, asked.z, asked.d1, asked.d2)]
    d1, d2 = lengths[3:]
    with np.errstate(divide="ignore", invalid="ignore"):
        solution = geometry.solve(*lengths[:3], asked.phi, d1, d2)
        P_w, Q_s, Q_e, Q_12 = (solution[name] for name in ("P_w", "Q_s", "Q_e", "Q_12"))
        # The rest pose after the rotation about the elbow, before the rotation about the shoulder.
        rest = cga.rotate(Q_e, e3 * cga.scalar(-d2)) + e3 * cga.scalar(d1)
        coordinates = {
            "axis": (0 * d1, 0 * d1, 0 * d1 + 1),  # L_z
            "along": cga.direction(solution["L_sw"]),
            "vertical": cga.direction(geometry.swivel_plane(P_w, 0 * d1)[2]),  # normal of the swivel plane at phi = 0
            "swivel": cga.direction(solution["pi_swivel"]),
            "centre": cga.euclidean_coordinates(cga.centre(solution["Z_e"])),
            "elbow": cga.euclidean_coordinates(solution["P_e"]),
            "other": cga.euclidean_coordinates(geometry.elbow_point(-solution["PP"])),
            # The wrist before the rotation by Q_e, by Q_12 and by Q_3.
            "folded": cga.euclidean_coordinates(cga.rotate(Q_s, cga.point(0 * d1, 0 * d1, d1 - d2))),
            "rest": _vector(rest),
            "half": _vector(cga.rotate(Q_12, rest)),
            "middle": cga.direction(solution["L_m"]),
            "yz2": cga.direction(solution["pi_yz2"]),
        }
        vectors = {name: np.column_stack(np.broadcast_arrays(*values)) for name, values in coordinates.items()}
        q3_w, _, _, q3_k = cga.quaternion_coefficients(solution["Q_3"])
        angles = {"theta4": np.arccos(np.clip(solution["c4"], -1, 1)), "theta3": 2 * np.arctan2(q3_k, q3_w)}
        radius = cga.radius(solution["Z_e"])
        wrist = np.column_stack(_vector(cga.rotate(Q_s, rest)))
        met = np.abs(np.linalg.norm(vectors["elbow"], axis=1) - d1) < NEAR
        home = met & (np.linalg.norm(wrist - np.column_stack(lengths[:3]), axis=1) < NEAR)
    radius[met & np.isnan(radius)] = 0.0  # arm straight within roundoff
    for name in ("elbow", "other"):
        vectors[name][~met] = np.nan
    turns = (vectors[name] for name in ("folded", "rest", "half", "middle", "yz2"))
    for values in (*turns, *angles.values()):
        values[~home] = np.nan
    shown = {name: item.targets.points_from_core(values) for name, values in vectors.items()}
    return shown, angles, {"radius": radius}


def _vector(mv: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return mv.e1, mv.e2, mv.e3


def packed(item: Prepared, width: int) -> dict[str, Any]:
    """Encode the entities for the page: per target, a row of vectors, angles and lengths as 16-bit words, in base64."""
    vectors, angles, lengths = entities(item, width)
    rows = np.column_stack([*vectors.values(), *(values / np.pi for values in angles.values()), *lengths.values()])
    words = np.where(np.isfinite(rows), np.rint(UNITS * np.nan_to_num(rows)), NOTHING)
    return {
        "vectors": list(vectors),
        "angles": list(angles),
        "lengths": list(lengths),
        "steps": UNITS,
        "nothing": NOTHING,
        "rows": base64.b64encode(words.astype("<i2").tobytes()).decode(),
    }


STEPS = 4000
"""Units per diagonal of the figure's bounding box. A unit is smaller than a pixel."""

BODY, UPPER, FORE, HEAD = range(4)
"""Body parts. A node carries the part of the bone that ends there."""


def place(up: str) -> np.ndarray:
    """Return the rotation (3, 3) from a clip's frame to the page's frame (z up). up: the clip's up axis, e.g. "-y"."""
    turn = np.roll(np.eye(3), 2 - "xyz".index(up[-1]), axis=0)
    return turn if up[0] != "-" else np.diag((1.0, -1.0, -1.0)) @ turn


def _parts(clip: Clip, moves: tuple[Motion, ...]) -> list[int]:
    """Return the body part of the bone that ends at each node. An end site is HEAD if its joint's name has "head"."""
    parts = [HEAD if node.end and "head" in clip.names[node.parent].lower() else BODY for node in clip.nodes]
    for move in moves:
        arm = move.limb
        for part, joint, high in ((UPPER, arm.fore, arm.upper), (FORE, arm.hand, arm.fore)):
            while joint != high:
                parts[joint] = part
                joint = clip.parents[joint]
    return parts


def _facing(item: Prepared, turn: np.ndarray) -> float:
    """Return the direction that the figure faces in the first frame: the angle about z from x, in rad."""
    first, limbs = item.clip.positions[0], [move.limb for move in item.moves]
    out = [(first[arm.upper] - first[arm.torso]) * (1 if arm.side == "left" else -1) for arm in limbs]
    left = turn @ np.sum(out, axis=0)
    return float(np.arctan2(-left[0], left[1]))  # left x up


def figure_data(item: Prepared, ran: Run, width: int) -> dict[str, Any]:
    """Return the page's data of a clip's figure, in the page's frame.

    * nodes: for each frame a flat list, the root and then all other nodes relative to the root, posed by the core
    * own: for each frame a flat list, elbow and wrist of each arm as in the clip, relative to the root
    * unit: length of one step of nodes and own; floor: height of the floor
    * middle: height of the view's centre; None if it follows the root vertically, as it always does horizontally
    * radius: largest distance of any point from the view's centre
    """
    clip, moves = item.clip, item.moves
    turn = place(clip.up)
    nodes = turned(item, ran, width).positions @ turn.T
    root = nodes[:, :1].copy()
    joints = [joint for move in moves for joint in (move.limb.fore, move.limb.hand)]
    clip_arms = clip.positions[:, joints] @ turn.T - root
    low, high = float(nodes[..., 2].min()), float(nodes[..., 2].max())
    size = np.linalg.norm(np.ptp(nodes - root, axis=1), axis=1).max()
    unit = float(f"{size / STEPS:.3g}")
    from_middle = np.concatenate((nodes - root, clip_arms), axis=1)
    # If the figure climbs or flies, the view follows its height.
    middle = (low + high) / 2 if np.ptp(root[..., 2]) < size / 2 else None
    if middle is not None:
        from_middle[..., 2] += root[..., 2] - middle

    def whole(points: np.ndarray) -> list[list[int]]:
        return np.rint(points.reshape(len(points), -1) / unit).astype(int).tolist()

    return {
        "rate": float(f"{1 / clip.period:.6g}"),
        "arms": [
            {"side": move.limb.label} | {part: getattr(move.limb, part) for part in ("upper", "fore", "hand")}
            for move in moves
        ],
        "parents": clip.parents,
        "parts": _parts(clip, moves),
        "unit": unit,
        "nodes": whole(np.concatenate((root, (nodes - root)[:, 1:]), axis=1)),
        "own": whole(clip_arms),
        "place": turn.tolist(),
        "facing": round(_facing(item, turn), 4),
        "floor": low,
        "middle": middle,
        "radius": float(np.linalg.norm(from_middle, axis=2).max()),
    }


def joint_angles(item: Prepared, ran: Run, width: int) -> np.ndarray:
    """Return angles (N, 4) in degrees: azimuth and elevation of the upper arm, swivel angle, elbow flexion.

    Azimuth is measured from forward (x) to the left, elevation from the horizontal. Both are in the torso's frame for
    a clip, else in the frame of the targets. Flexion is 0 for a straight arm.
    """
    qs, qe = quaternions(item, ran, width)
    upper = rotate(qs, (0.0, 0.0, 1.0))
    for n, move in enumerate(item.moves):
        frames, arm, up = slice(n, None, len(item.moves)), move.limb, rest_up(item.clip)
        left = (outward_and_up(item.clip, arm) - up) * (1 if arm.side == "left" else -1)
        axes = np.stack((np.cross(left, up), left, up), axis=1)  # of the torso: forward, left, up
        upper[frames] = rotate(conjugate(item.clip.turn[:, arm.torso]), upper[frames]) @ axes
    azimuth = np.arctan2(upper[:, 1], upper[:, 0])
    elevation = np.arcsin(np.clip(upper[:, 2], -1, 1))
    # Qe rotates by 0 if the arm is closed and by pi if the arm is straight.
    flexion = np.pi - 2 * np.arctan2(np.abs(qe[:, 1]), qe[:, 0])
    return np.degrees(np.column_stack((azimuth, elevation, item.targets.phi, flexion)))

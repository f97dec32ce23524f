# SPDX-License-Identifier: Apache-2.0
"""Write BVH clips of a synthetic figure, with many variants of names, up axis and order of angles; compute their
kinematics with scipy's rotations."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from model.motion.clip import read

NAMES = {
    "cmu": ("{Side}Shoulder", "{Side}Arm", "{Side}ForeArm", "{Side}Hand"),
    "mixamo": ("mixamorig:{Side}Shoulder", "mixamorig:{Side}Arm", "mixamorig:{Side}ForeArm", "mixamorig:{Side}Hand"),
    "unity": ("{Side}Collar", "{Side}UpperArm", "{Side}LowerArm", "{Side}Hand"),
    "max": ("Bip01_{S}_Clavicle", "Bip01_{S}_UpperArm", "Bip01_{S}_Forearm", "Bip01_{S}_Hand"),
    "poser": ("{s}Collar", "{s}Shldr", "{s}ForeArm", "{s}Hand"),
    "smpl": ("{S}_Collar", "{S}_Shoulder", "{S}_Elbow", "{S}_Wrist"),
    "blender": ("shoulder.{S}", "upper_arm.{S}", "forearm.{S}", "hand.{S}"),
    "rigify": ("DEF-shoulder.{S}", "DEF-upper_arm.{S}", "DEF-forearm.{S}", "DEF-hand.{S}"),
    "daz": ("{s}Collar", "{s}ShldrBend", "{s}ForearmBend", "{s}Hand"),
    "second life": ("mCollar{Side}", "mShoulder{Side}", "mElbow{Side}", "mWrist{Side}"),
    "makehuman": ("shoulder01.{S}", "upperarm01.{S}", "lowerarm01.{S}", "wrist.{S}"),
    "motive": ("{S}Shoulder", "{S}UArm", "{S}FArm", "{S}Hand"),
    "theia": ("{s}_clavicle", "{s}_uarm", "{s}_larm", "{s}_hand"),
    "named": ("Bob_{Side}Shoulder", "Bob_{Side}Arm.001", "Bob_{Side}Elbow", "Bob_{Side}Palm"),
    "blanks": ("Bip01 {S} Clavicle", "Bip01 {S} UpperArm", "Bip01 {S} Forearm", "Bip01 {S} Hand"),
    "own": ("a{s}", "b{s}", "c{s}", "d{s}"),
}

REST = np.array((1, 0.3, 0)) / np.hypot(1, 0.3)
"""Direction of the right arm at rest; x to the right, y forward, z up."""

UPPER, FORE = 3.1, 2.6

TURNS = {"x": ((0, 1, 0), (0, 0, 1), (1, 0, 0)), "y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)), "z": np.eye(3)}
"""Up axis of a clip -> matrix to the clip's frame from a frame with x to the right, y forward, z up."""


def joints(names: str, side: str) -> tuple[str, ...]:
    """Return the names of collar bone, upper arm, forearm and hand of a side."""
    return tuple(form.format(Side=side.title(), S=side[0].upper(), s=side[0]) for form in NAMES[names])


def write(path, names="cmu", up="y", order="ZYX", frames=60, sides=("left", "right"), rich=False, two_legs=False):
    """Write a figure whose body sways and whose arms swing, smoothly and at random.

    rich: each joint also has position channels, which move it near its OFFSET; an extra joint halves each upper arm.
    """
    random = np.random.default_rng(1)

    def offset(vector) -> str:
        return " ".join(f"{value:.6f}" for value in TURNS[up] @ np.asarray(vector, dtype=float))

    lines, channels, places = ["HIERARCHY"], 0, {}

    def joint(name, vector, children, root=False):
        nonlocal channels, places
        lines.extend([f"{'ROOT' if root else 'JOINT'} {name}" if name else "End Site", "{", f"OFFSET {offset(vector)}"])
        if name:
            place = "Xposition Yposition Zposition " if root or rich else ""
            lines.append(f"CHANNELS {6 if place else 3} {place}{' '.join(f'{axis}rotation' for axis in order)}")
            places |= {} if root or not rich else dict(enumerate(map(float, offset(vector).split()), channels))
            channels += 6 if place else 3
        for child in children:
            joint(*child)
        lines.append("}")

    def arm(side):
        mirror = np.array((1 if side == "right" else -1, 1, 1))
        collar, upper, fore, hand = joints(names, side)
        rest = mirror * REST
        below = (fore, rest * UPPER / (2 if rich else 1), [(hand, rest * FORE, [(None, mirror * (0.3, 0, -0.4), [])])])
        below = (f"{upper}.001", rest * UPPER / 2, [below]) if rich else below
        below = (upper, mirror * (1.2, 0, 0.1), [below])
        return collar, mirror * (0.5, 0, 4), [below]

    head = ("Head", (0, 0, 5), [(None, (0, 0, 1), [])])
    legs = [("Leg", (0, 0, -4), [(None, (0, 0, -4), [])])]
    if two_legs:
        for side, x in (("Left", -0.8), ("Right", 0.8)):
            foot = (f"{side}Foot", (0, -0.1, -3.8), [(None, (0, 1, 0), [])])
            legs.append((f"{side}UpLeg", (x, 0, -0.2), [(f"{side}Leg", (0, 0.1, -4.1), [foot])]))
    joint("Hips", (0.5, 0, 9), [("Spine", (0, 0, 1), [head, *(arm(side) for side in sides)]), *legs], root=True)
    t = np.linspace(0, 2 * np.pi, frames)[:, None]
    angles = random.uniform(-40, 40, channels) + random.uniform(10, 40, channels) * np.sin(
        t * random.integers(1, 3, channels) + random.uniform(0, 6, channels)
    )
    for column, at in places.items():
        angles[:, column] = at + angles[:, column] / 400
    lines += ["MOTION", f"Frames: {frames}", "Frame Time: 0.0083333"]
    lines += [" ".join(f"{value:.6f}" for value in row) for row in angles]
    path.write_text("\n".join(lines) + "\n")
    return path


def kinematics(clip):
    """Return the nodes' positions (K, F, 3) and rotations, independently of :class:`Clip`."""
    positions, turns = [], []
    for node in clip.nodes:
        place, turn = np.tile(node.offset, (len(clip.table), 1)), Rotation.identity(len(clip.table))
        for kind, axis, column in node.channels:
            if kind == "position":
                place[:, axis] = clip.table[:, column]
            else:
                turn = turn * Rotation.from_euler("XYZ"[axis], clip.table[:, [column]], degrees=True)
        parent = node.parent
        positions.append(place if parent < 0 else positions[parent] + turns[parent].apply(place))
        turns.append(turn if parent < 0 else turns[parent] * turn)
    return np.array(positions), turns


def compare(path, again, free=(), tolerance=1e-6):
    """Check that the clip `again` has the nodes of `path` and, except for nodes whose numbers are in `free`, the same
    positions and orientations. tolerance: relative to the body's size for positions, in rad for orientations."""
    clip, clip_again = read(Path(path)), read(Path(again))
    (places, turns), (places_again, turns_again) = kinematics(clip), kinematics(clip_again)
    assert clip.nodes == clip_again.nodes and clip.table.shape == clip_again.table.shape
    kept = [k for k in range(len(clip.nodes)) if k not in free]
    size = np.ptp(places[:, 0], axis=0).max()
    away = np.linalg.norm(places_again - places, axis=2)[kept] / size
    assert away.max() <= tolerance, (clip.nodes[kept[int(away.max(axis=1).argmax())]].name, away.max())
    for k in kept:
        turned = (turns[k].inv() * turns_again[k]).magnitude()
        assert turned.max() <= tolerance, (clip.nodes[k].name, turned.max())

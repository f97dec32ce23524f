# SPDX-License-Identifier: Apache-2.0
"""BVH clips of a synthetic figure in many variants: names, up direction, rest pose, order of angles."""

from __future__ import annotations

from pathlib import Path

import numpy as np

NAMES = {
    "cmu": ("{Side}Shoulder", "{Side}Arm", "{Side}ForeArm", "{Side}Hand"),
    "mixamo": ("mixamorig:{Side}Shoulder", "mixamorig:{Side}Arm", "mixamorig:{Side}ForeArm", "mixamorig:{Side}Hand"),
    "unity": ("{Side}Collar", "{Side}UpperArm", "{Side}LowerArm", "{Side}Hand"),
    "max": ("Bip01_{S}_Clavicle", "Bip01_{S}_UpperArm", "Bip01_{S}_Forearm", "Bip01_{S}_Hand"),
    "poser": ("{s}Collar", "{s}Shldr", "{s}ForeArm", "{s}Hand"),
    "smpl": ("{S}_Collar", "{S}_Shoulder", "{S}_Elbow", "{S}_Wrist"),
    "blender": ("shoulder.{S}", "upper_arm.{S}", "forearm.{S}", "hand.{S}"),
    "plain": ("{Side}Collar", "{Side}Shoulder", "{Side}Elbow", "{Side}Wrist"),
    "own": ("a{s}", "b{s}", "c{s}", "d{s}"),
}

OFFSETS = {
    "t": ((1, 0, 0), (1, 0, 0)),
    "hanging": ((0.1, 0, -1), (0.05, 0.1, -1)),
    "forward": ((0.3, 1, 0), (0, 1, 0.2)),
}
"""Rest poses: directions of upper arm and forearm of the right arm; x to the right, y forward, z up."""

UPPER, FORE = 3.1, 2.6


def joints(names: str, side: str) -> tuple[str, ...]:
    """Return upper arm, forearm and hand of a side."""
    return tuple(form.format(Side=side.title(), S=side[0].upper(), s=side[0]) for form in NAMES[names][1:])


def write(
    path: Path,
    names: str = "cmu",
    up: str = "y",
    rest: str = "t",
    order: str = "ZYX",
    frames: int = 60,
    seed: int = 1,
    sides: tuple[str, ...] = ("left", "right"),
) -> Path:
    """Write a figure whose body sways and whose arms swing, smoothly and at random."""
    random = np.random.default_rng(seed)
    spot = {"z": (0, 1, 2), "y": (0, 2, 1), "x": (2, 0, 1)}[up]  # positions of right, forward and up
    flip = np.array((1, -1 if up == "y" else 1, 1))  # keeps the frame right-handed

    def offset(vector) -> str:
        out = np.zeros(3)
        out[list(spot)] = np.asarray(vector, dtype=float) * flip
        return " ".join(f"{value:.6f}" for value in out)

    lines, channels = ["HIERARCHY"], 0

    def joint(name, vector, children, root=False):
        nonlocal channels
        lines.append(f"{'ROOT' if root else 'JOINT'} {name}" if name else "End Site")
        lines.extend(["{", f"OFFSET {offset(vector)}"])
        if name:
            place = "Xposition Yposition Zposition " if root else ""
            lines.append(f"CHANNELS {6 if root else 3} {place}{' '.join(f'{axis}rotation' for axis in order)}")
            channels += 6 if root else 3
        for child in children:
            joint(*child)
        lines.append("}")

    def arm(side):
        mirror = np.array((1 if side == "right" else -1, 1, 1))
        collar = NAMES[names][0].format(Side=side.title(), S=side[0].upper(), s=side[0])
        directions = [np.array(v) / np.linalg.norm(v) * mirror for v in OFFSETS[rest]]
        upper, fore, hand = joints(names, side)
        end = (None, directions[1] * 0.5, [])
        below = (upper, mirror * (1.2, 0, 0.1), [(fore, directions[0] * UPPER, [(hand, directions[1] * FORE, [end])])])
        return collar, mirror * (0.5, 0, 4), [below]

    head = ("Head", (0, 0, 5), [(None, (0, 0, 1), [])])
    leg = ("Leg", (0, 0, -4), [(None, (0, 0, -4), [])])
    joint("Hips", (0.5, 0, 9), [("Spine", (0, 0, 1), [head, *(arm(side) for side in sides)]), leg], root=True)
    t = np.linspace(0, 2 * np.pi, frames)[:, None]
    angles = random.uniform(-40, 40, channels) + random.uniform(10, 40, channels) * np.sin(
        t * random.integers(1, 3, channels) + random.uniform(0, 6, channels)
    )
    lines += ["MOTION", f"Frames: {frames}", "Frame Time: 0.0083333"]
    lines += [" ".join(f"{value:.6f}" for value in row) for row in angles]
    path.write_text("\n".join(lines) + "\n")
    return path

# SPDX-License-Identifier: Apache-2.0
"""BVH clips of a synthetic figure in many variants: names, up direction, order of angles."""

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

REST = np.array((1, 0.3, 0)) / np.hypot(1, 0.3)
"""Direction of the right arm at rest; x to the right, y forward, z up."""

UPPER, FORE = 3.1, 2.6


def joints(names: str, side: str) -> tuple[str, ...]:
    """Return upper arm, forearm and hand of a side."""
    return called(names, side)[1:]


def called(names: str, side: str) -> tuple[str, ...]:
    """Return collar bone, upper arm, forearm and hand of a side."""
    return tuple(form.format(Side=side.title(), S=side[0].upper(), s=side[0]) for form in NAMES[names])


def write(
    path: Path,
    names: str = "cmu",
    up: str = "y",
    order: str = "ZYX",
    frames: int = 60,
    sides: tuple[str, ...] = ("left", "right"),
) -> Path:
    """Write a figure whose body sways and whose arms swing, smoothly and at random."""
    random = np.random.default_rng(1)
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
        collar, upper, fore, hand = called(names, side)
        rest = mirror * REST
        below = (upper, mirror * (1.2, 0, 0.1), [(fore, rest * UPPER, [(hand, rest * FORE, [(None, rest * 0.5, [])])])])
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

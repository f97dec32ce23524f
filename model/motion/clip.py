# SPDX-License-Identifier: Apache-2.0
"""Convert the limbs of a BVH clip to targets of the core, and turn the limbs by the core's quaternions.

Positions use the clip's frame and unit of length.  A limb is an arm or a leg.  Its joints upper, fore and hand are the
shoulder, elbow and wrist, or the hip, knee and ankle.  Targets are relative to the shoulder or hip.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ..io.files import QUATERNION
from ..io.words import Targets
from ..reference.kinematics import Axis, conjugate, direction, multiply, rotate, to_z
from .bvh import Clip, ClipError, parse
from .pose import swivel

__all__ = ["Clip", "ClipError", "arms", "motion", "parse", "read", "targets", "turned"]

SIDES = ("left", "right")
TORSO = "torso"  # name of the axis that points outward and up from the torso

ARM_NAMES = (
    ("upperarm|uparm|uarm", "forearm|lowerarm|lowarm|farm|larm", "hand|wrist|palm"),  # Unity, 3ds Max, Blender, Motive
    ("arm", "forearm|farm|elbow", "hand|wrist|palm"),  # CMU, Mixamo, Rokoko; the shoulder is the collar bone
    ("shldr|shoulder|humerus", "forearm|lowerarm|elbow|radius", "hand|wrist|palm"),  # Poser, Daz, SMPL, Second Life
)
LEG_NAMES = (
    ("upperleg|upleg|thigh|femur", "leg|lowerleg|lowleg|shin|calf|knee|shank|tibia", "foot|ankle"),
    ("hip", "knee|shin|calf|leg", "ankle|foot"),  # SMPL, Second Life
)
NAMES = {"arm": ARM_NAMES, "leg": LEG_NAMES}
"""Kind of limb -> patterns of its joints' names without the side; earlier lines are tried first."""

LIMBS = {"arms": ("arm",), "legs": ("leg",), "all": ("arm", "leg")}

HEADS = ("head", "neck")
FEET = ("foot|feet|ankle", "toe|toes|toebase", "leg|lowerleg|lowleg|shin|calf|knee|shank")
DROPPED = {"joint", "jnt", "bone", "bind", "bend", "stretch"}


@dataclass(frozen=True)
class Limb:
    """Numbers of the joints of an arm or a leg.

    torso: joint that carries the limbs of both sides; opposite: upper joint of the limb on the other side, or torso
    """

    side: str
    upper: int
    fore: int
    hand: int
    torso: int
    opposite: int
    kind: str = "arm"

    @property
    def label(self) -> str:
        """Name of the limb in a clip: "left" for an arm, "left leg" for a leg."""
        return self.side if self.kind == "arm" else f"{self.side} {self.kind}"


def read(path: Path, up: str | None = None) -> Clip:
    """Read a clip.  up: a name of :data:`kinematics.NAMED_AXES`; None: use :func:`up_axis`.  Raises OSError, and
    :class:`ClipError` for a file that is not BVH."""
    clip = parse(path.read_bytes(), path)
    return replace(clip, up=up or up_axis(clip))


def arms(clip: Clip, which: str = "both", joints: Sequence[str] | None = None, limbs: str = "arms") -> list[Limb]:
    """Return limbs of a clip: "arms", "legs" or "all" (``limbs``), on the "left", "right" or "both" sides (``which``).

    joints: three joint names for each side; None: recognize usual names.  Raises :class:`ClipError` if the names do not
    identify the limbs.
    """
    if len(LIMBS[limbs]) > 1:
        if joints is not None:
            raise ClipError(f"{clip.path}: joints {','.join(joints)}: choose one limb, LIMB=arms or LIMB=legs")
        return [limb for kind in ("arms", "legs") for limb in arms(clip, which, None, kind)]
    (kind,), sides = LIMBS[limbs], SIDES if which == "both" else (which,)
    named_joints: dict[str, tuple[int, int, int]] = {}
    if joints is not None:
        if len(joints) != 3 * len(sides):
            hint = "upper arm, forearm and hand of each side; ARM=left or ARM=right chooses one"
            raise ClipError(f"{clip.path}: joints {','.join(joints)}: expected {hint}")
        for n, side in enumerate(sides):
            named_joints[side] = _chosen(clip, joints[3 * n : 3 * n + 3], list(named_joints.values()))
    known = {side: three for side in SIDES if (three := named_joints.get(side) or _known(clip, side, NAMES[kind]))}
    for side in sides:
        if side not in known:
            hint = "".join(f"ARM={other} runs the other, or " for other in known)
            hint += f"choose its three with JOINTS= from {', '.join(_joint_names(clip))}"
            raise ClipError(f"{clip.path}: no {side} {kind} recognized; {hint}")
    above = [set(clip.ancestors(upper)) for upper, *_ in known.values()]
    result = []
    for side in sides:
        torso = _torso(clip, known[side][0], above)
        opposite = next((known[other][0] for other in known if other != side), torso)
        result.append(Limb(side, *known[side], torso, opposite, kind))
    return result


def _torso(clip: Clip, upper: int, common: list[set[int]]) -> int:
    """Return the lowest joint that carries both limbs; for a single limb, the joint that carries its collar bone."""
    above = clip.ancestors(upper)
    if not above:
        return upper
    if len(common) < 2:
        return above[min(1, len(above) - 1)]
    return next((joint for joint in above if all(joint in chain for chain in common)), above[-1])


def _joint_names(clip: Clip) -> list[str]:
    return [node.name for node in clip.nodes if not node.end]


def _words(name: str) -> list[str]:
    """Return the words of a joint's name in lower case; omit namespace, Blender's number suffix, and DROPPED words."""
    name = re.sub(r"\.\d{3}$", "", re.split("[:|]", name)[-1])
    words = (word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name))
    return [word for word in words if word not in DROPPED]


def _called(clip: Clip, pattern: str) -> list[int]:
    """Return the joints whose names end with words that match ``pattern``."""
    words = [[] if node.end else _words(node.name) for node in clip.nodes]
    last = [["".join(name[first:]) for first in range(len(name))] for name in words]
    return [joint for joint, names in enumerate(last) if any(re.fullmatch(pattern, name) for name in names)]


def named(clip: Clip, name: str) -> list[int]:
    """Return the joints that are called ``name``.  Raises :class:`ClipError` if there is none."""
    if joints := [k for k, node in enumerate(clip.nodes) if not node.end and node.name == name]:
        return joints
    raise ClipError(f"{clip.path}: no joint {name!r} among {', '.join(_joint_names(clip))}")


def _chosen(clip: Clip, joints: Sequence[str], others: list[tuple[int, int, int]]) -> tuple[int, int, int]:
    """Return the first limb (upper, fore, hand) that has the joint names ``joints`` and is not in ``others``."""
    for upper, fore, hand in product(*(named(clip, name) for name in joints)):
        if upper in clip.ancestors(fore) and fore in clip.ancestors(hand) and (upper, fore, hand) not in others:
            return upper, fore, hand
    raise ClipError(f"{clip.path}: joints {','.join(joints)}: expected a chain in the order upper arm, forearm, hand")


def _known(clip: Clip, side: str, table: Sequence[tuple[str, str, str]]) -> tuple[int, int, int] | None:
    """Return the joints of a limb whose names match a line of ``table``, or None."""
    letter = f"(?:{side}|{side[0]})"
    for parts in table:
        uppers, fores, hands = (_called(clip, f"{letter}(?:{x})(?:0?1)?|(?:{x})(?:0?1)?{letter}") for x in parts)
        for fore in fores:
            above = [joint for joint in clip.ancestors(fore) if joint in uppers]
            below = [joint for joint in hands if fore in clip.ancestors(joint)]
            if above and below:
                return above[-1], fore, below[0]
    return None


def _body(clip: Clip) -> tuple[list[int], list[int]]:
    """Return joints of the head (else neck, else shoulders) and of the feet; both lists are empty if one would be."""
    optional = "(?:left|right|l|r)?"
    heads, feet = (
        next((joints for names in table if (joints := _called(clip, rf"{optional}(?:{names})\d*{optional}"))), [])
        for table in (HEADS, FEET)
    )
    heads = heads[:1] or [known[0] for side in SIDES if (known := _known(clip, side, ARM_NAMES))]
    return (heads, feet) if heads and feet else ([], [])


def up_axis(clip: Clip) -> str:
    """Return the axis nearest to the mean direction from feet to head, or y if head or feet are not recognized.

    If the mean over all frames is near no axis, the direction in the rest pose is used.
    """
    heads, feet = _body(clip)
    if not heads:
        return "y"
    body = _unit(clip.positions[:, heads].mean(axis=1) - clip.positions[:, feet].mean(axis=1)).mean(axis=0)
    if np.abs(body).max() < 0.8:
        body = rest_up(clip)
    best = int(np.argmax(np.abs(body)))
    return ("-" if body[best] < 0 else "") + "xyz"[best]


def rest_up(clip: Clip) -> np.ndarray:
    """Return the direction (3,) from hips to head in the rest pose, or the axis within 30 degrees of it, if any."""
    heads, feet = _body(clip)
    if not heads:
        return direction(clip.up)
    above = [set(clip.ancestors(foot)) for foot in feet]
    hips = next((joint for joint in clip.ancestors(feet[0]) if all(joint in chain for chain in above)), 0)
    up = _unit(clip.rest[heads].mean(axis=0) - clip.rest[hips])
    if not up.any():
        return direction(clip.up)
    axis = np.where(np.abs(up) == np.abs(up).max(), np.sign(up), 0.0)
    return axis if np.abs(up).max() > np.cos(np.radians(30)) else up


UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254, "cmu": 0.0254 / 0.45}
"""Unit of length -> metres. cmu is the unit of the BVH conversions of the CMU database."""

ARM = 0.55  # length of a human arm to the wrist, m


def metres(unit: str, arm: float) -> float:
    """Return a unit of length in metres; "auto" selects the unit in which ``arm`` is nearest to a human arm."""
    return UNITS[unit] if unit != "auto" else min(UNITS.values(), key=lambda metre: abs(np.log(arm * metre / ARM)))


@dataclass(frozen=True)
class Motion:
    """Motion of a limb in F frames, in the clip's frame and unit.

    * elbow, wrist (F, 3): relative to the shoulder; d1, d2 (F,): lengths of upper arm and forearm
    * frame (F, 4): the quaternion of R, which takes the clip's frame to the core's frame
    * phi (F,): the swivel angle (rad) in the core's frame
    * hand (F, 4): orientation of the hand, z along the hand's bone; None if the clip has no channels for it
    """

    limb: Limb
    elbow: np.ndarray
    wrist: np.ndarray
    d1: np.ndarray
    d2: np.ndarray
    frame: np.ndarray
    phi: np.ndarray
    hand: np.ndarray | None = None

    @property
    def arm_length(self) -> float:
        """Median length of the arm; for a leg, the estimated length of the same person's arm."""
        return float(np.median(self.d1 + self.d2)) * (1.0 if self.limb.kind == "arm" else 0.65)

    @property
    def typical_phi(self) -> float:
        """Circular mean (rad) of the swivel angles, weighted by how far the limb is bent."""
        bent = np.linalg.norm(np.cross(self.elbow, self.wrist), axis=1)
        return float(np.angle((bent * np.exp(1j * self.phi)).sum()))


def outward_and_up(clip: Clip, limb: Limb) -> np.ndarray:
    """Return the bisector (3,) of two directions in the rest pose: up, and outward from the torso."""
    up = rest_up(clip)
    out = clip.rest[limb.upper] - clip.rest[limb.opposite]
    out = out - (out @ up) * up
    if not np.linalg.norm(out) > 0:
        line = f"joint {clip.names[limb.upper]} is straight above or below {clip.names[limb.opposite]}"
        raise ClipError(f"{clip.path}: {line}, so no direction is outward; set the reference axis with AXIS=")
    return out / np.linalg.norm(out) + up


def motion(clip: Clip, limb: Limb, axis: Axis = TORSO) -> Motion:
    """Return the motion of a limb.  axis: reference axis in the world, or "torso": outward and up from the torso."""
    for joint in (limb.upper, limb.fore):
        if not clip.can_turn(joint):
            raise ClipError(f"{clip.path}: joint {clip.names[joint]} has no rotation channel for each axis")
    joints = [limb.upper, limb.fore, limb.hand]
    shoulder, elbow, wrist = np.moveaxis(clip.positions[:, joints], 1, 0)
    d1, d2 = map(_lengths, np.diff(clip.rest[joints], axis=0), (elbow - shoulder, wrist - elbow))
    if min(d1.min(), d2.min()) == 0:
        raise ClipError(f"{clip.path}: the {limb.side} {limb.kind} has a bone without length")
    if isinstance(axis, str) and axis == TORSO:
        frame = multiply(to_z(outward_and_up(clip, limb)), conjugate(clip.turn[:, limb.torso]))
    else:
        frame = np.broadcast_to(to_z(axis), (len(shoulder), 4))
    elbow, wrist = elbow - shoulder, wrist - shoulder
    phi = swivel((0.0, 0.0, 0.0), rotate(frame, elbow), rotate(frame, wrist))
    hand = hands(clip, limb) if clip.can_turn(limb.hand) else None
    return Motion(limb, elbow, wrist, d1, d2, frame, phi, hand)


def _to_palm(clip: Clip, limb: Limb) -> np.ndarray:
    """Return the quaternion (4,) that takes the hand's bone (if there is none, the forearm) in the rest pose to z."""
    below = (clip.rest[k] - clip.rest[limb.hand] for k, parent in enumerate(clip.parents) if parent == limb.hand)
    bone = sum(below, np.zeros(3))
    return to_z(bone if np.linalg.norm(bone) > 0 else clip.rest[limb.hand] - clip.rest[limb.fore])


def hands(clip: Clip, limb: Limb) -> np.ndarray:
    """Return the orientations (F, 4) of a limb's hand, z along the hand's bone."""
    return multiply(clip.turn[:, limb.hand], conjugate(_to_palm(clip, limb)))


def _lengths(rest: np.ndarray, bone: np.ndarray) -> np.ndarray:
    """Return the lengths (F,) of ``bone`` (F, 3). Lengths equal to |``rest``| within rounding are set to it."""
    length, lengths = np.linalg.norm(rest), np.linalg.norm(bone, axis=1)
    return np.where(np.isclose(lengths, length, rtol=1e-9, atol=0), length, lengths)


def targets(
    clip: Clip, moves: Sequence[Motion], phi: Sequence[np.ndarray | float], width: int, by_hand: bool = False
) -> Targets:
    """Return targets of all limbs as one stream, frame by frame: wrist targets, or hand poses if ``by_hand``.

    phi: swivel angles of each limb, (F,) or a number.  Rounding to words of ``width`` bits could move the elbow of a
    straight limb sideways by the square root of an ulp, so targets of straight limbs are moved two ulps out of reach.
    """
    count = len(moves[0].wrist)
    ulp = 2.0 ** (2 - width)  # upper bound, relative to the reach
    wrists = []
    for move in moves:
        distance, reach = np.linalg.norm(move.wrist, axis=1, keepdims=True), (move.d1 + move.d2)[:, None]
        longer = reach * (1 + 2 * ulp) / np.maximum(distance, reach / 2)
        wrists.append(move.wrist * np.where(distance >= reach * (1 - 2 * ulp), longer, 1.0))
    arm, hand = np.tile([move.limb.label for move in moves], count), None
    others = {"frame": np.arange(count).repeat(len(moves)).astype(str).tolist(), "arm": arm.tolist()}
    if by_hand:
        hand = interleaved([move.hand for move in moves if move.hand is not None])
        others |= {name: [*map(repr, q)] for name, q in zip(QUATERNION, hand.T.tolist(), strict=True)}
    angles = interleaved([np.broadcast_to(angle, count) for angle in phi])
    d1, d2, frame = (interleaved([getattr(move, name) for move in moves]) for name in ("d1", "d2", "frame"))
    x, y, z = interleaved(wrists).T
    path = clip.path
    return Targets(path.stem, x, y, z, angles, d1, d2, str(path), others=others, frame=frame, arm=arm, hand=hand)


def interleaved(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """Return the rows of arrays with F rows each, frame by frame: row 0 of each array, then row 1 of each, ..."""
    return np.concatenate(np.stack(arrays, axis=1))


TWISTS = ("clip", "core")


def turned(clip: Clip, moves: Sequence[tuple[Any, ...]], twist: str = "clip") -> Clip:
    """Return the clip with turned limbs.  moves: (motion, Qs, Qe[, Qh]), quaternions (F, 4) in the clip's frame.

    Each bone turns the shortest way to the direction that the core gives, which keeps the clip's twist.  With the twist
    "core", each bone also turns about itself until the elbow's mean hinge axis in the clip is parallel to the core's
    hinge.  Hands without Qh keep their orientation in the world.
    """
    world = {}
    for move, qs, qe, *qh in moves:
        limb, fore = move.limb, move.wrist - move.elbow
        normal = np.cross(move.elbow, fore)
        for joint, bone, q, z in ((limb.upper, move.elbow, qs, 1.0), (limb.fore, fore, multiply(qs, qe), -1.0)):
            aim, turn = rotate(q, (0.0, 0.0, z)), clip.turn[:, joint]
            world[joint] = multiply(_shortest(bone, aim), turn)
            if twist == "core":
                back = conjugate(turn)
                hinge = _hinge(_unit(rotate(back, bone)).mean(axis=0), rotate(back, normal))
                world[joint] = multiply(_roll(aim, rotate(world[joint], hinge), rotate(q, HINGE)), world[joint])
        if clip.can_turn(limb.hand):
            world[limb.hand] = multiply(qh[0], _to_palm(clip, limb)) if qh else clip.turn[:, limb.hand]
    return clip.turned(world)


HINGE = (1.0, 0.0, 0.0)  # hinge axis of the core's elbow: direction of upper arm x forearm


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Return vectors (..., 3) scaled to length 1; vectors of length 0 stay."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def _shortest(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the quaternions (F, 4) of the shortest rotations from directions ``start`` to ``end`` (F, 3)."""
    a, b = _unit(start), _unit(end)
    q = np.column_stack((1 + (a * b).sum(axis=1), np.cross(a, b)))
    opposite = np.linalg.norm(q, axis=1) < 1e-7  # turn about any perpendicular axis
    q[opposite, 1:] = np.cross(a, np.eye(3)[np.argmin(np.abs(a), axis=1)])[opposite]
    return _unit(q)


def _hinge(along: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the mean (3,) of normals (F, 3), made perpendicular to a bone's direction and scaled to length 1."""
    along = _unit(along)
    hinge = normals.sum(axis=0)
    hinge -= (hinge @ along) * along
    if np.linalg.norm(hinge) <= 1e-9 * np.linalg.norm(normals, axis=1).sum():  # never bent, or about all axes
        hinge = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    return _unit(hinge)


def _roll(axis: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the rotations (F, 4) about ``axis`` that take ``start`` to ``end`` as seen along the axis; all (F, 3)."""
    across = np.cross(axis, start)
    along = (start * axis).sum(axis=1) * (end * axis).sum(axis=1)
    half = np.arctan2((across * end).sum(axis=1), (start * end).sum(axis=1) - along) / 2
    return np.column_stack((np.cos(half), axis * np.sin(half)[:, None]))

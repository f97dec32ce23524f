# SPDX-License-Identifier: Apache-2.0
"""BVH clip: its arms as targets of the core, and the clip with its arms turned by the core's quaternions.

Everything is in the clip's own frame and unit.  An arm is three joints: the start of the upper arm, the elbow, the
wrist.  Each target is relative to the shoulder, in a frame that may move: with the world's axes, or with the torso's,
whose outward-and-up axis no hand comes near.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pybvh
from pybvh.rotations import rotmat_to_quat

from ..io.words import TargetError, Targets
from ..reference.kinematics import conjugate, matrix, multiply, rotate
from .pose import Axis, swivel, to_z

SIDES = ("left", "right")
TORSO = "torso"
"""Name of the axis that points outward and up from the torso."""

STEMS = {
    "upper arm": ("arm", "uparm", "upperarm", "shldr", "shoulder", "humerus"),
    "forearm": ("forearm", "lowarm", "lowerarm", "elbow", "radius"),
    "hand": ("hand", "wrist"),
}
"""Names of joints without their side, each at the start of its bone: CMU and Mixamo (LeftArm, LeftForeArm, LeftHand),
Unity (LeftUpperArm, ..), 3ds Max (Bip01 L UpperArm, ..), Poser (lShldr, ..), SMPL (L_Shoulder, L_Elbow, L_Wrist),
Blender (upper_arm.L, ..).  A shoulder above a joint named arm is the collar bone."""

PREFIX = r"(?:mixamorig\d*|bip\d*|jbip|character\d*)?"


class ClipError(TargetError):
    """Unusable clip, or arm of a clip; the text is one line for the user."""


@dataclass(frozen=True)
class Arm:
    """Numbers of an arm's joints, and of the torso joint that carries both arms."""

    side: str
    upper: int
    fore: int
    hand: int
    torso: int


@dataclass(frozen=True)
class Clip:
    """Clip of F frames and J joints, as read."""

    path: Path
    bvh: pybvh.Bvh

    @cached_property
    def parents(self) -> list[int]:
        """Parent of each joint; -1 for the root."""
        return [-1, *(parent for _, parent in self.bvh.edges)]

    @cached_property
    def local(self) -> np.ndarray:
        """Rotation matrices (F, J, 3, 3) of the joints relative to their parents."""
        return self.bvh.to_rotmat()[1]

    @cached_property
    def world(self) -> np.ndarray:
        """Rotation matrices (F, J, 3, 3) of the joints relative to the world."""
        found = np.empty_like(self.local)
        for joint, parent in enumerate(self.parents):  # parents come first
            found[:, joint] = self.local[:, joint] if parent < 0 else found[:, parent] @ self.local[:, joint]
        return found

    @cached_property
    def positions(self) -> np.ndarray:
        """Positions of the joints, (F, J, 3)."""
        return self.bvh.joint_positions()

    @cached_property
    def rest(self) -> np.ndarray:
        """Positions (J, 3) of the joints in the rest pose."""
        index = self.bvh.node_index
        return self.bvh.rest_pose_positions()[[index[name] for name in self.bvh.joint_names]]

    def ancestors(self, joint: int) -> list[int]:
        """Return the ancestors of a joint, from the parent up to the root."""
        found = []
        while (joint := self.parents[joint]) >= 0:
            found.append(joint)
        return found


def read(path: Path) -> Clip:
    """Read a BVH clip.  Raises :class:`ClipError`, with the reason, for a file that is not BVH or cannot be read."""
    try:
        path.open("rb").close()  # raises OSError with the reason
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pybvh guesses the up direction, and warns where two guesses differ
            bvh = pybvh.read_bvh_file(path)
    except OSError as error:
        raise ClipError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ClipError(f"{path}: no BVH clip: not text") from None
    except (ValueError, IndexError, KeyError) as error:
        if not path.stat().st_size:
            raise ClipError(f"{path}: the file is empty") from None
        if wrong := _wrong_number(path):
            raise ClipError(f"{path}: {wrong}") from None
        text = " ".join(str(error).replace(f" in {path}", "").replace(f" in file {path}", "").split())
        raise ClipError(f"{path}: no BVH clip: {text}") from None
    if not all(np.isfinite(part).all() for part in (bvh.joint_angles, bvh.root_pos, bvh.rest_pose_positions())):
        raise ClipError(f"{path}: {_wrong_number(path)}")
    return Clip(path, bvh)


def _wrong_number(path: Path) -> str:
    """Describe the first entry that is not a finite number: line, joint, word; or return an empty string."""
    joint, channels, frames = "", [], False
    for line, words in enumerate(map(str.split, path.read_text(errors="replace").splitlines()), 1):
        numbers, of = words[1:], []  # the joints of the numbers
        match words:
            case ["ROOT" | "JOINT", *name]:
                joint = f", joint {' '.join(name)}"
            case ["OFFSET", *_]:
                of = [joint] * 3
            case ["CHANNELS", _, *kinds]:
                channels += [joint] * len(kinds)
            case ["Frames:", *_]:
                of = [""]
            case ["Frame", "Time:", *numbers]:
                of, frames = [""], True
            case [_, *_] if frames:
                numbers, of = words, channels
        for where, word in zip(of, numbers, strict=False):
            if not _is_finite(word):
                return f"line {line}{where}: {word!r} is not a finite number"
        if of and len(numbers) != len(of):
            return f"line {line}: {len(numbers)} numbers, not {len(of)}"
    return ""


def _is_finite(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


# -- joints ------------------------------------------------------------------------------------------------------------


def arms(clip: Clip, which: str = "both", joints: Sequence[str] | None = None) -> list[Arm]:
    """Return the arms of a clip, "left", "right" or "both": found by name, or one of them given by its three joints.

    Raises :class:`ClipError`, which lists the joints, where names are not sufficient.
    """
    sides = SIDES if which == "both" else (which,)
    if joints is not None and which == "both":
        raise ClipError(f"{clip.path}: joints {','.join(joints)} are those of one arm: ARM= says which, left or right")
    found = {side: _named(clip, joints) if joints is not None else _known(clip, side) for side in sides}
    other = {side: found.get(side) or _known(clip, side, must=False) for side in SIDES}
    common = [set(clip.ancestors(three[0])) for three in other.values() if three]
    return [Arm(side, *three, torso=_torso(clip, three[0], common)) for side, three in found.items() if three]


def _torso(clip: Clip, upper: int, common: list[set[int]]) -> int:
    """Return the lowest joint that carries all arms found; for a single arm, the joint that carries its collar bone."""
    above = clip.ancestors(upper)
    if not above:
        return upper
    if len(common) < 2:
        return above[min(1, len(above) - 1)]
    return next((joint for joint in above if all(joint in of for of in common)), above[-1])


def _named(clip: Clip, joints: Sequence[str]) -> tuple[int, int, int]:
    index = clip.bvh.joint_index
    for name in joints:
        if name not in index:
            raise ClipError(f"{clip.path}: no joint {name!r} among {', '.join(clip.bvh.joint_names)}")
    if len(joints) != 3:
        raise ClipError(f"{clip.path}: joints {','.join(joints)}: not the three of upper arm, forearm and hand")
    upper, fore, hand = (index[name] for name in joints)
    if upper not in clip.ancestors(fore) or fore not in clip.ancestors(hand):
        raise ClipError(f"{clip.path}: joints {','.join(joints)}: not one below the other, upper arm first")
    return upper, fore, hand


def _known(clip: Clip, side: str, must: bool = True) -> tuple[int, int, int] | None:
    names = clip.bvh.joint_names

    def called(joint: int, part: str) -> bool:
        stems, letter = "|".join(STEMS[part]), f"(?:{side}|{side[0]})"
        plain = re.sub(r"[^a-z0-9]", "", names[joint].rpartition(":")[2].lower())
        return bool(re.fullmatch(rf"{PREFIX}(?:{letter}(?:{stems})|(?:{stems}){letter})", plain))

    for fore in (joint for joint in range(len(names)) if called(joint, "forearm")):
        upper = next((joint for joint in clip.ancestors(fore) if called(joint, "upper arm")), None)
        below = (joint for joint in range(len(names)) if fore in clip.ancestors(joint) and called(joint, "hand"))
        if upper is not None and (hand := next(below, None)) is not None:
            return upper, fore, hand
    if must:
        raise ClipError(f"{clip.path}: no {side} arm is known by name; JOINTS= names its three of {', '.join(names)}")
    return None


# -- targets -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Motion:
    """Motion of an arm in F frames, from the shoulder, in the clip's frame and unit.

    * elbow, wrist (F, 3); d1, d2: lengths of upper arm and forearm
    * frame (F, 4): the quaternion of R, which takes the clip's frame to the core's
    * phi (F,): the swivel angle (rad) in that frame
    """

    arm: Arm
    elbow: np.ndarray
    wrist: np.ndarray
    d1: float
    d2: float
    frame: np.ndarray
    phi: np.ndarray

    @property
    def typical_phi(self) -> float:
        """Mean direction (rad) of the clip's own swivel angles, each weighted by the bend of the arm."""
        bent = np.linalg.norm(np.cross(self.elbow, self.wrist), axis=1)
        return float(np.angle((bent * np.exp(1j * self.phi)).sum()))


def outward_and_up(clip: Clip, arm: Arm) -> np.ndarray:
    """Return the direction (3,) between the arm's side and up, of the body at rest, in the torso's frame."""
    up = clip.bvh.rest_up_axis.vector
    out = clip.rest[arm.upper] - clip.rest[arm.torso]
    out = out - (out @ up) * up
    if not np.linalg.norm(out) > 0:
        raise ClipError(f"{clip.path}: joint {clip.bvh.joint_names[arm.upper]} is above the torso, not beside it")
    return out / np.linalg.norm(out) + up


def motion(clip: Clip, arm: Arm, axis: Axis = TORSO) -> Motion:
    """Return the motion of an arm for a reference axis of the world's frame, or "torso": outward and up from it."""
    bones = clip.rest[arm.fore] - clip.rest[arm.upper], clip.rest[arm.hand] - clip.rest[arm.fore]
    d1, d2 = (float(np.linalg.norm(bone)) for bone in bones)
    if min(d1, d2) == 0:
        raise ClipError(f"{clip.path}: the {arm.side} arm has a bone without length")
    shoulder, elbow, wrist = (clip.positions[:, joint] for joint in (arm.upper, arm.fore, arm.hand))
    count = len(shoulder)
    if isinstance(axis, str) and axis == TORSO:
        turn = rotmat_to_quat(clip.world[:, arm.torso])
        frame = multiply(to_z(outward_and_up(clip, arm)), conjugate(turn))
    else:
        frame = np.broadcast_to(to_z(axis), (count, 4))
    elbow, wrist = elbow - shoulder, wrist - shoulder
    phi = swivel((0.0, 0.0, 0.0), rotate(frame, elbow), rotate(frame, wrist))
    return Motion(arm, elbow, wrist, d1, d2, frame, phi)


def targets(clip: Clip, moves: Sequence[Motion], phi: Sequence[np.ndarray | float], width: int) -> Targets:
    """Return the wrists of all arms as one stream, frame by frame, with a swivel angle (F,) or one number for each arm.

    For a straight arm, rounding to words of ``width`` bits could make the elbow stick out by the root of an ulp, so its
    target is moved two ulps out of reach, which keeps it straight.
    """
    count = len(moves[0].wrist)
    ulp = 2.0 ** (2 - width)  # upper bound, relative to the reach
    wrists = []
    for move in moves:
        distance, reach = np.linalg.norm(move.wrist, axis=1, keepdims=True), move.d1 + move.d2
        longer = reach * (1 + 2 * ulp) / np.maximum(distance, reach / 2)
        wrists.append(move.wrist * np.where(distance >= reach * (1 - 2 * ulp), longer, 1.0))
    x, y, z = np.stack(wrists, axis=1).reshape(-1, 3).T
    arm = np.tile([move.arm.side for move in moves], count)
    return Targets(
        name=clip.path.stem,
        path=str(clip.path),
        x=x,
        y=y,
        z=z,
        phi=np.stack([np.broadcast_to(angle, count) for angle in phi], axis=1).reshape(-1),
        d1=np.tile([move.d1 for move in moves], count),
        d2=np.tile([move.d2 for move in moves], count),
        frame=np.stack([move.frame for move in moves], axis=1).reshape(-1, 4),
        arm=arm,
        others={"frame": np.arange(count).repeat(len(moves)).astype(str).tolist(), "arm": arm.tolist()},
    )


# -- the turned clip ---------------------------------------------------------------------------------------------------


def turned(clip: Clip, moves: Sequence[tuple[Motion, np.ndarray, np.ndarray]]) -> pybvh.Bvh:
    """Return the clip with arms turned by Qs and Qe, (F, 4) each, in the clip's frame; the rest of the body is
    unchanged.

    Rigs differ in how a bone is turned about itself at rest.  The core's hinge, about which the elbow bends, is fixed
    in both bones, and is aligned with the clip's average hinge.  Hands keep their direction in the world.
    """
    local = clip.local.copy()
    for move, qs, qe in moves:
        arm = move.arm
        normal = np.cross(move.elbow, move.wrist - move.elbow)
        world = {
            joint: matrix(q) @ _to_rest(clip, joint, below, normal, bone)
            for joint, below, q, bone in (
                (arm.upper, arm.fore, qs, (0.0, 0.0, 1.0)),
                (arm.fore, arm.hand, multiply(qs, qe), (0.0, 0.0, -1.0)),
            )
        } | {arm.hand: clip.world[:, arm.hand]}
        above = clip.parents[arm.upper]
        carried = np.eye(3) if above < 0 else clip.world[:, above]
        for joint in (arm.upper, arm.fore, arm.hand):
            local[:, joint] = np.swapaxes(np.broadcast_to(carried, local[:, joint].shape), 1, 2) @ world[joint]
            carried = world[joint]
        for low, high in ((arm.fore, arm.upper), (arm.hand, arm.fore)):
            for between in clip.ancestors(low)[: clip.ancestors(low).index(high)]:  # twist joints within a bone
                local[:, between] = np.eye(3)
    return clip.bvh.from_rotmat(clip.bvh.root_pos, local)


def _to_rest(clip: Clip, joint: int, below: int, normal: np.ndarray, bone: tuple[float, float, float]) -> np.ndarray:
    """Return the rotation (3, 3) from a joint's bone at rest to the core's, along `bone` and with hinge x."""
    along = clip.rest[below] - clip.rest[joint]
    along = along / np.linalg.norm(along)
    hinge = (np.swapaxes(clip.world[:, joint], 1, 2) @ normal[:, :, None])[:, :, 0].sum(axis=0)
    hinge -= (hinge @ along) * along
    if np.linalg.norm(hinge) <= 1e-9 * np.linalg.norm(normal, axis=1).sum():  # never bent, or about every axis
        hinge = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    hinge /= np.linalg.norm(hinge)
    # The core's arm bends so that upper arm x forearm points along HINGE.
    here = np.stack((along, hinge, np.cross(along, hinge)), axis=1)
    there = np.stack((bone, HINGE, np.cross(bone, HINGE)), axis=1)
    return there @ here.T


HINGE = (1.0, 0.0, 0.0)

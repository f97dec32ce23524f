# SPDX-License-Identifier: Apache-2.0
"""Motion-capture clips: arms found and followed, and the clip written back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model.bounds import tolerances
from model.motion import clip as clips
from model.motion.clip import ClipError, arms, motion, read, turned
from model.motion.pose import solve
from model.motion.tests import figure
from model.reference.kinematics import angle_between, conjugate, forward, multiply, rotate

MOCAP = sorted((Path(__file__).parents[4] / "shared" / "mocap").glob("*.bvh"))
ELBOW = {None: 1e-12, 32: 2e-8, 18: 2e-4}


def followed(clip, axis, width=None, phi=None):
    """Solve each arm of a clip: motion, shoulder and elbow quaternion in the clip's frame."""
    moves = [motion(clip, arm, axis) for arm in arms(clip)]
    targets = clips.targets(clip, moves, [move.phi if phi is None else phi(move) for move in moves], width or 52)
    pose = solve(targets.core_position, targets.phi, targets.d1, targets.d2, width=width)
    qs = targets.from_core(pose.qs)
    return [(move, qs[n :: len(moves)], pose.qe[n :: len(moves)]) for n, move in enumerate(moves)]


def off(ours, theirs, move):
    return np.linalg.norm(ours - theirs, axis=1) / (move.d1 + move.d2)


@pytest.mark.parametrize("axis", ["torso", "z", (0.3, 1, 0)])
@pytest.mark.parametrize("width", ELBOW)
@pytest.mark.parametrize(
    "way", [{}, {"up": "z", "rest": "hanging"}, {"up": "x", "order": "XZY"}, {"rest": "forward", "order": "YXZ"}]
)
def test_hand_and_elbow_of_a_figure(tmp_path, way, width, axis):
    clip = read(figure.write(tmp_path / "clip.bvh", **way))
    moves = followed(clip, axis, width)
    assert [move.arm.side for move, *_ in moves] == ["left", "right"]
    for move, qs, qe in moves:
        assert (move.d1, move.d2) == pytest.approx((figure.UPPER, figure.FORE), abs=1e-5)
        elbow, wrist = forward(qs, qe, move.d1, move.d2)
        # Near a singular pose, rounding of the target moves the elbow further.
        beside = np.linalg.norm(rotate(move.frame, move.wrist)[:, :2], axis=1) / np.linalg.norm(move.wrist, axis=1)
        bent = np.linalg.norm(np.cross(move.elbow, move.wrist), axis=1) / (move.d1 * move.d2)
        regular = (beside > 0.3) & (bent > 0.3)
        assert regular.sum() > 20
        assert off(elbow, move.elbow, move)[regular].max() <= ELBOW[width]
        assert off(wrist, move.wrist, move).max() <= (tolerances.lean(width) if width else 1e-14)


@pytest.mark.parametrize(("up", "axes"), [("y", {"left": (-1, 1, 0), "right": (1, 1, 0)}), ("z", {"right": (1, 0, 1)})])
def test_axis_of_the_torso(tmp_path, up, axes):
    """The axis moves with the torso, and R takes it to the core's z."""
    clip = read(figure.write(tmp_path / "clip.bvh", up=up))
    for side, axis in axes.items():
        (arm,) = arms(clip, side)
        moved = clip.world[:, arm.torso] @ (np.array(axis) / np.sqrt(2))
        np.testing.assert_allclose(rotate(motion(clip, arm).frame, moved), [(0, 0, 1)] * len(moved), atol=1e-12)


def test_typical_angle_is_that_of_a_bent_arm(tmp_path):
    clip = read(figure.write(tmp_path / "clip.bvh"))
    move = motion(clip, arms(clip)[0])
    straight, bent = (2.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    move = replace(move, elbow=np.array([straight, bent, bent]), wrist=np.array([(4.0, 0, 0)] * 3))
    assert replace(move, phi=np.array([2.0, 0.4, 0.6])).typical_phi == pytest.approx(0.5)
    assert replace(move, phi=np.array([0.0, 3.1, -3.1])).typical_phi == pytest.approx(np.pi)


@pytest.mark.parametrize("way", [{}, {"up": "z", "rest": "hanging"}, {"rest": "forward", "order": "YXZ"}])
def test_the_clip_written_again_has_the_same_joints(tmp_path, way):
    clip = read(figure.write(tmp_path / "clip.bvh", **way))
    turned(clip, followed(clip, "torso", 32)).write(tmp_path / "again.bvh")
    again = read(tmp_path / "again.bvh")
    assert again.bvh.joint_names == clip.bvh.joint_names and again.bvh.frame_time == clip.bvh.frame_time
    np.testing.assert_allclose(again.positions, clip.positions, atol=1e-5)
    hands = [arm.hand for arm in arms(clip)]
    np.testing.assert_allclose(again.world[:, hands], clip.world[:, hands], atol=1e-6)
    arm_joints = {joint for arm in arms(clip) for joint in (arm.upper, arm.fore, arm.hand)}
    others = [joint for joint in range(len(clip.parents)) if joint not in arm_joints]
    np.testing.assert_allclose(again.local[:, others], clip.local[:, others], atol=1e-6)


def test_bones_turn_about_themselves_as_in_the_clip_on_average(tmp_path):
    """A figure whose elbow is a hinge, as in the core: all joint rotations are reproduced, not only the positions."""
    clip = read(figure.write(tmp_path / "clip.bvh"))
    angles = clip.bvh.joint_angles.copy()
    for arm in arms(clip):
        angles[:, arm.fore] = (0.0, 1.0, 0.0) * (0.4 + np.abs(angles[:, arm.fore]))  # ZYX: about y only
    clip.bvh.joint_angles = angles
    again = clips.Clip(clip.path, turned(clip, followed(clip, "torso")))
    np.testing.assert_allclose(again.local, clip.local, atol=1e-6)


@pytest.mark.parametrize("names", figure.NAMES)
def test_names_of_joints(tmp_path, names):
    clip = read(figure.write(tmp_path / "clip.bvh", names))
    if names == "own":
        with pytest.raises(ClipError, match="no left arm is known by name; JOINTS= names its three of Hips, Spine,"):
            arms(clip)
    else:
        assert [arm.side for arm in arms(clip)] == ["left", "right"]
    for side in clips.SIDES:
        joints = figure.joints(names, side)
        (named,) = arms(clip, side, joints)
        assert tuple(clip.bvh.joint_names[joint] for joint in (named.upper, named.fore, named.hand)) == joints
        if names != "own":
            assert arms(clip, side) == [named]
            assert clip.bvh.joint_names[named.torso] == "Spine"


def test_a_lone_arm(tmp_path):
    clip = read(figure.write(tmp_path / "clip.bvh", sides=("right",)))
    (arm,) = arms(clip, "right")
    assert clip.bvh.joint_names[arm.torso] == "Spine"
    with pytest.raises(ClipError, match="no left arm"):
        arms(clip)


@pytest.mark.parametrize(
    ("which", "joints", "message"),
    [
        ("both", ("LeftArm", "LeftForeArm", "LeftHand"), "ARM= says which, left or right"),
        ("left", ("LeftArm", "LeftElbow", "LeftHand"), "no joint 'LeftElbow' among Hips, Spine"),
        ("left", ("LeftArm", "LeftHand"), "not the three"),
        ("left", ("LeftForeArm", "LeftArm", "LeftHand"), "not one below the other"),
        ("left", ("LeftArm", "LeftForeArm", "RightHand"), "not one below the other"),
    ],
)
def test_named_joints_that_are_no_arm(tmp_path, which, joints, message):
    clip = read(figure.write(tmp_path / "clip.bvh"))
    with pytest.raises(ClipError, match=message):
        arms(clip, which, joints)


def spoil(text, line, column, word):
    lines = text.split("\n")
    n = lines.index("MOTION") + line
    words = lines[n].split()
    words[column] = word
    lines[n] = " ".join(word for word in words if word)
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: "", "the file is empty"),
        (lambda text: "x,y,z\n1,2,3\n", "No ROOT"),
        (lambda text: text.partition("MOTION")[0], "Frame count"),
        (lambda text: text[: len(text) * 2 // 3], r"60 frames|line \d+: \d+ numbers, not"),
        (lambda text: spoil(text, 5, 3, "abc"), r"line \d\d, joint Hips: 'abc' is not a finite number"),
        (lambda text: spoil(text, 5, 6, "abc"), r"line \d\d, joint Spine: 'abc' is not a finite number"),
        (lambda text: spoil(text, 5, 3, ""), r"line \d\d: \d+ numbers, not \d+"),
        (lambda text: spoil(text, 5, 3, "nan"), r"line \d\d, joint Hips: 'nan' is not a finite number"),
        (lambda text: spoil(text, 5, 1, "inf"), r"line \d\d, joint Hips: 'inf' is not a finite number"),
        (lambda text: spoil(text, 1, 1, "many"), r"line \d\d: 'many' is not a finite number"),
        (lambda text: spoil(text, 2, 2, "nan"), r"line \d\d: 'nan' is not a finite number"),
        (lambda text: text.replace("0.000000 1.0", "inf 1.0", 1), "line 8, joint Spine: 'inf' is not a finite"),
        (lambda text: text.replace("0.500000 9", "zero 9", 1), "line 4, joint Hips: 'zero' is not a finite"),
        (lambda text: text.replace("Zrotation", "Wrotation", 1), "Wrotation"),
        (lambda text: text.replace("OFFSET", "OFFSTE", 1), "."),
    ],
)
def test_a_file_that_is_no_clip(tmp_path, change, message):
    path = figure.write(tmp_path / "clip.bvh")
    path.write_text(change(path.read_text()))
    with pytest.raises(ClipError, match=message) as raised:
        read(path)
    assert str(raised.value).startswith(f"{path}: ") and "\n" not in str(raised.value)


def test_a_binary_file_and_none(tmp_path):
    (tmp_path / "clip.bvh").write_bytes(b"\xff\xfe\x00" * 50)
    with pytest.raises(ClipError, match="no BVH clip: not text"):
        read(tmp_path / "clip.bvh")
    with pytest.raises(ClipError, match="none.bvh: cannot be read: No such file"):
        read(tmp_path / "none.bvh")
    with pytest.raises(ClipError, match="cannot be read: Is a directory"):
        read(tmp_path)


@pytest.mark.parametrize("path", MOCAP, ids=lambda path: path.stem)
def test_motion_capture(path, tmp_path):
    """Human motion: with a constant swivel angle from the torso's axis, no arm turns much faster than the original."""
    clip = read(path)
    for width, tolerance in ELBOW.items():
        moves = followed(clip, "torso", width)
        for move, qs, qe in moves:
            elbow, wrist = forward(qs, qe, move.d1, move.d2)
            assert off(elbow, move.elbow, move).max() <= tolerance, "the T pose of the first frame included"
    turned(clip, moves).write(tmp_path / "again.bvh")
    for (move, qs, _), arm in zip(followed(clip, "torso", phi=lambda m: m.typical_phi), arms(clip), strict=True):
        torso, upper = clip.world[:, arm.torso], clip.world[:, arm.upper]
        own = clips.rotmat_to_quat(np.swapaxes(torso, 1, 2) @ upper)
        ours = multiply(conjugate(clips.rotmat_to_quat(torso)), qs)
        fastest = [angle_between(q[1:-1], q[2:]).max() for q in (ours, own)]
        assert fastest[0] <= 1.5 * fastest[1], move.arm

# SPDX-License-Identifier: Apache-2.0
"""Motion-capture clips: arms found and followed, the clip written back, and as an animated file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pygltflib
import pytest
from pygltflib.validator import validate
from scipy.spatial.transform import Rotation

from model.bounds import tolerances
from model.motion import clip as clips
from model.motion.clip import ClipError, arms, motion, read, turned
from model.motion.gltf import animated
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
@pytest.mark.parametrize("way", [{}, {"up": "z"}, {"up": "x", "order": "XZY"}, {"order": "YXZ"}])
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


@pytest.mark.parametrize("way", [{}, {"up": "z", "order": "YXZ"}])
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
        (lambda text: spoil(text, 5, 3, ""), r"line \d\d: \d+ numbers, not \d+"),
        (lambda text: spoil(text, 5, 3, "nan"), r"line \d\d, joint Hips: 'nan' is not a finite number"),
        (lambda text: spoil(text, 1, 1, "many"), r"line \d\d: 'many' is not a finite number"),
        (lambda text: spoil(text, 2, 2, "nan"), r"line \d\d: 'nan' is not a finite number"),
        (lambda text: text.replace("0.000000 1.0", "inf 1.0", 1), "line 8, joint Spine: 'inf' is not a finite"),
        (lambda text: text.replace("Zrotation", "Wrotation", 1), "Wrotation"),
        (lambda text: text.replace("OFFSET", "OFFSTE", 1), "."),
        (lambda text: b"\xff\xfe\x00" * 50, "no BVH clip: not text"),
    ],
)
def test_a_file_that_is_no_clip(tmp_path, change, message):
    path = figure.write(tmp_path / "clip.bvh")
    path.write_bytes(content if isinstance(content := change(path.read_text()), bytes) else content.encode())
    with pytest.raises(ClipError, match=message) as raised:
        read(path)
    assert str(raised.value).startswith(f"{path}: ") and "\n" not in str(raised.value)
    with pytest.raises(ClipError, match="none.bvh: cannot be read: No such file"):
        read(tmp_path / "none.bvh")


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


# -- the animated file -----------------------------------------------------------------------------


def values(file, accessor):
    """Return the numbers of an accessor, (count, components)."""
    about = file.accessors[accessor]
    view = file.bufferViews[about.bufferView]
    kind = {pygltflib.FLOAT: np.float32, pygltflib.UNSIGNED_BYTE: np.uint8}[about.componentType]
    data = file.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    table = np.frombuffer(data, kind).reshape(about.count, -1)
    if about.min:
        assert (table.min(axis=0), table.max(axis=0)) == (pytest.approx(about.min), pytest.approx(about.max))
    return table


@pytest.mark.parametrize("up", "xyz")
@pytest.mark.filterwarnings("ignore:.*provisional")
def test_nodes_are_where_the_joints_are(tmp_path, up):
    clip = read(figure.write(tmp_path / "clip.bvh", up=up))
    if up == "x":
        clip.bvh.world_up = "+x"  # an up direction that cannot be guessed
    assert clip.bvh.world_up == f"+{up}"
    angles = clip.bvh.joint_angles.copy()
    angles[:, 0, 0] += np.linspace(0, 20, len(angles))  # three turns, through both signs of the quaternion
    clip.bvh.joint_angles = angles
    (tmp_path / "clip.glb").write_bytes(animated(clip.bvh, "a figure"))
    file = pygltflib.GLTF2().load(tmp_path / "clip.glb")
    assert not validate(file)
    (animation,) = file.animations
    tracks = {}
    for channel in animation.channels:
        sampler = animation.samplers[channel.sampler]
        times = values(file, sampler.input)[:, 0]
        np.testing.assert_allclose(times, np.arange(len(times)) / 120, rtol=1e-6)
        tracks[channel.target.node, channel.target.path] = values(file, sampler.output)

    found, count = {}, clip.bvh.frame_count
    for (_, path), track in tracks.items():
        assert len(track) == count
        if path == "rotation":
            np.testing.assert_allclose(np.linalg.norm(track, axis=1), 1, atol=1e-6)
            assert (np.sum(track[1:] * track[:-1], axis=1) > 0).all(), "no flip of signs"

    def walk(number, turn, place):
        node = file.nodes[number]
        move = tracks.get((number, "translation"), np.tile(node.translation or (0.0, 0, 0), (count, 1)))
        spin = tracks.get((number, "rotation"), np.tile(node.rotation or (0.0, 0, 0, 1), (count, 1)))
        place, turn = place + turn.apply(move), turn * Rotation.from_quat(spin)
        found[node.name] = place
        if node.mesh is not None:
            found["tip", number] = place + turn.apply([(0, node.scale[1], 0)] * count)
        for child in node.children or ():
            walk(child, turn, place)

    walk(file.scenes[file.scene].nodes[0], Rotation.identity(count), np.zeros((count, 3)))
    assert found["a figure"].max() == 0
    order = {"x": [2, 0, 1], "y": [0, 1, 2], "z": [1, 2, 0]}[up]  # the clip's axes that become x, y, z
    expected = clip.bvh.node_positions()[:, :, order]
    for name, n in clip.bvh.node_index.items():
        np.testing.assert_allclose(found[name], expected[:, n], atol=1e-5)
        if n:  # the bone that ends here
            tips = [place for key, place in found.items() if isinstance(key, tuple)]
            assert min(np.abs(tip - expected[:, n]).max() for tip in tips) < 1e-5

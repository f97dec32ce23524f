# SPDX-License-Identifier: Apache-2.0
"""Test motion-capture clips: read files, find the arms and follow them, write clips and animated files."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygltflib
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pygltflib.validator import validate
from scipy.spatial.transform import Rotation

from model.motion import clip as clips
from model.motion.clip import ClipError, arms, motion, parse, read, turned
from model.motion.gltf import animated
from model.motion.pose import solve
from model.motion.tests import figure
from model.reference.kinematics import angle_between, conjugate, forward, multiply

MOCAP = sorted((Path(__file__).parents[4] / "shared" / "mocap").glob("*.bvh"))


def followed(clip, width=32, phi=lambda move: move.phi):
    """Solve each arm of a clip; return for each arm its motion, Qs in the clip's frame, and Qe."""
    moves = [motion(clip, arm) for arm in arms(clip)]
    targets = clips.targets(clip, moves, [phi(move) for move in moves], width or 52)
    pose = solve(targets.core_position, targets.phi, targets.d1, targets.d2, width=width)
    qs = targets.from_core(pose.qs)
    return [(move, qs[n :: len(moves)], pose.qe[n :: len(moves)]) for n, move in enumerate(moves)]


def test_typical_angle_is_that_of_a_bent_arm(tmp_path):
    clip = read(figure.write(tmp_path / "clip.bvh"))
    move = motion(clip, arms(clip)[0])
    straight, bent = (2.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    move = replace(move, elbow=np.array([straight, bent, bent]), wrist=np.array([(4.0, 0, 0)] * 3))
    assert replace(move, phi=np.array([2.0, 0.4, 0.6])).typical_phi == pytest.approx(0.5)
    assert replace(move, phi=np.array([0.0, 3.1, -3.1])).typical_phi == pytest.approx(np.pi)


def written(path, clip, *options):
    """Solve the arms of a clip, write the clip with the solutions next to `path`, and return the new file's path."""
    again = path.with_name("again.bvh")
    again.write_bytes(turned(clip, followed(clip), *options).content())
    return again


@pytest.mark.parametrize("way", [{}, {"up": "z", "order": "YXZ"}, {"up": "x", "order": "XZY"}, {"rich": True}])
def test_the_clip_written_again_has_the_same_joints(tmp_path, way):
    path = figure.write(tmp_path / "clip.bvh", **way)
    figure.compare(path, written(path, read(path)))


def test_angles_stay_near_the_original_ones(tmp_path):
    """Test Euler angles beyond a turn, in their second solution, and at gimbal lock."""
    clip = read(figure.write(tmp_path / "clip.bvh"))
    for arm in arms(clip):
        columns = [channel.column for channel in clip.nodes[arm.upper].channels]
        clip.table[:, columns] = clip.table[:, columns] * (1, -1, 1) + (540, 180, -180)
        clip.table[:5, columns[1]] = 90
    clip = saved(clip)
    again = written(clip.path, clip)
    figure.compare(clip.path, again)
    np.testing.assert_allclose(read(again).table, clip.table, atol=1e-4)


def test_twist_of_the_core(tmp_path):
    """Check that only joints of the arms change, and that none changes if the elbow bends about one axis only."""
    path = figure.write(tmp_path / "clip.bvh")
    clip = read(path)
    again = written(path, clip, "core")
    with pytest.raises(AssertionError):
        figure.compare(path, again)
    figure.compare(path, again, [joint for arm in arms(clip) for joint in (arm.upper, arm.fore, arm.hand)])
    for arm in arms(clip):  # bend only about one axis
        columns = [channel.column for channel in clip.nodes[arm.fore].channels]  # ZYX
        clip.table[:, columns] = (0.0, 1.0, 0.0) * (20 + np.abs(clip.table[:, columns]))
    figure.compare(path, written(path, saved(clip), "core"))


def saved(clip):
    """Write a clip with a changed table back to the clip's file; read the file again and return the clip."""
    clip.path.write_bytes(clip.content())
    return read(clip.path)


@pytest.mark.parametrize(
    ("up", "rows", "head", "foot"),
    [
        ("y", 0, "Head", "Leg"),
        ("y", 1, "mixamorig:Head", "Bob_LeftFoot"),
        ("z", slice(None), "Bob_Neck1", "ankle_r"),
        ("z", slice(None), "DEF-spine.006", "Leg"),
    ],
)
def test_up(tmp_path, up, rows, head, foot):
    """Test the up and torso axes of a figure that lies in one frame, or that lies at rest but stands in all frames."""
    path = figure.write(tmp_path / "clip.bvh", frames=3, up=up)
    text = path.read_text().replace("Head", head).replace("Leg", foot).replace("-0.5", "1.5")
    path.write_text(re.sub(r"(Shoulder\n{\nOFFSET) (-?)0.5", r"\1 \g<2>2.5", text))

    clip = read(path)
    clip.table[:] = 0
    clip.table[rows, 5] = -90  # about x
    clip = saved(clip)
    assert clip.up == "y" and (read(path, "-z").up, clip.notes) == ("-z", ())
    axes = [(-1, 1, 0), (1, 1, 0)] if up == "y" else [(-1, 0, 1), (1, 0, 1)]
    np.testing.assert_allclose([clips.outward_and_up(clip, arm) for arm in arms(clip)], axes, atol=1e-12)


@pytest.mark.parametrize(("reach", "unit"), [(53, "cm"), (0.6, "m"), (550, "mm"), (21, "inch"), (8.4, "cmu")])
def test_unit_of_length(reach, unit):
    assert clips.metres("auto", reach) == clips.metres(unit, 1) == clips.UNITS[unit]


@pytest.mark.parametrize("names", figure.NAMES)
def test_names_of_joints(tmp_path, names):
    clip = read(figure.write(tmp_path / "clip.bvh", names, rich=names == "rigify"))
    if names == "own":
        with pytest.raises(ClipError, match="no left arm recognized; choose its three with JOINTS= from Hips, Spine,"):
            arms(clip)
    else:
        assert [arm.side for arm in arms(clip)] == ["left", "right"]
    for side in clips.SIDES:
        joints = figure.joints(names, side)[1:]
        (named,) = arms(clip, side, joints)
        assert tuple(clip.names[joint] for joint in (named.upper, named.fore, named.hand)) == joints
        if names != "own":
            assert arms(clip, side) == [named]
        else:
            six = [*figure.joints(names, "left")[1:], *figure.joints(names, "right")[1:]]
            assert replace(arms(clip, joints=six)[side == "right"], opposite=named.opposite) == named
        assert clip.names[named.torso] == "Spine"


def test_a_lone_arm(tmp_path):
    clip = read(figure.write(tmp_path / "clip.bvh", sides=("right",)))
    (arm,) = arms(clip, "right")
    assert clip.names[arm.torso] == "Spine"


@pytest.mark.parametrize(
    ("which", "joints", "message"),
    [
        ("both", ("LeftArm", "LeftForeArm", "LeftHand"), "each side; ARM=left or ARM=right chooses one"),
        ("left", ("LeftArm", "LeftElbow", "LeftHand"), "no joint 'LeftElbow' among Hips, Spine"),
        ("left", ("LeftArm", "LeftForeArm", "LeftHand") * 2, "expected upper arm, forearm and hand"),
        ("left", ("LeftArm", "Hips end", "LeftHand"), "no joint 'Hips end'"),
        ("left", ("LeftForeArm", "LeftArm", "LeftHand"), "expected a chain in the order upper arm, forearm, hand"),
    ],
)
def test_named_joints_that_are_no_arm(tmp_path, which, joints, message):
    clip = read(figure.write(tmp_path / "clip.bvh"))
    with pytest.raises(ClipError, match=message):
        arms(clip, which, joints)


def test_arms_whose_joints_have_the_same_names(tmp_path):
    path = figure.write(tmp_path / "clip.bvh")
    path.write_text(path.read_text().replace("LeftHand", "Palm").replace("Left", "").replace("Right", ""))
    left, right = arms(read(path), joints=("Arm", "ForeArm", "Palm", "Arm", "ForeArm", "Hand"))
    assert (left.upper, left.hand, right.upper, right.hand) == (5, 7, 10, 12)
    path.write_text(path.read_text().replace("Palm", "Hand"))
    assert arms(read(path), joints=("Arm", "ForeArm", "Hand") * 2) == [left, right]


def spoil(text, line, column, word):
    lines = text.split("\n")
    n = lines.index("MOTION") + line
    words = lines[n].split()
    words[column] = word
    lines[n] = " ".join(words)
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: "x,y,z\n1,2,3\n", "line 1: 'x,y,z' is not ROOT"),
        (lambda text: "HIERARCHY\n", "not a BVH clip: ROOT is missing"),
        (lambda text: text.partition("MOTION")[0], "not a BVH clip: MOTION is missing"),
        (lambda text: text.replace("Frames", "Pictures"), r"line \d+: MOTION without 'Frames:' and 'Frame Time:'"),
        (lambda text: text[:300].rpartition("C")[0], r"line 12, joint Head: the hierarchy ends where .* is expected"),
        (lambda text: text.partition("Time: 0.008")[0] + "Time: 0.008", "the clip has no frames"),
        (lambda text: spoil(text, 5, 3, "abc"), r"line \d\d, joint Hips: 'abc' is not a finite number"),
        (lambda text: spoil(text, 5, 3, ""), r"line \d\d: expected 39 numbers, one per channel, got 38"),
        (lambda text: spoil(text, 5, 3, "1 2"), r"line \d\d: expected 39 numbers, one per channel, got 40"),
        (lambda text: re.sub(r"(?m)^(-?\d.*)$", r"\1 0", text), r"line \d\d: expected 39 numbers, .* got 40"),
        (lambda text: spoil(text, 5, 3, "nan"), r"line \d\d, joint Hips: 'nan' is not a finite number"),
        (lambda text: spoil(text, 5, 3, "1_0"), r"line \d\d, joint Hips: '1_0' is not a finite number"),
        (lambda text: spoil(text, 1, 1, "many"), r"line \d\d: 'many' is not a finite number"),
        (lambda text: text.replace("0.000000 1.0", "inf 1.0", 1), r"line 8, joint Spine: 'inf' is not a finite number"),
        (lambda text: text.replace("Zrotation", "Wrotation", 1), "line 5, joint Hips: 'Wrotation' is not a position"),
        (lambda text: text.replace("JOINT Spine", "ROOT Spine"), "line 6, joint Hips: 'ROOT' is not OFFSET, CHANNELS"),
        (lambda text: text.replace("ROOT", "JOINT"), "line 2: 'JOINT' is not ROOT"),
        (lambda text: text.replace("{", "", 1), "line 4: 'OFFSET' is not {"),
        (lambda text: "\0", "not a BVH clip: the file is not text"),
        (lambda text: text.replace("Left", "Other"), "no left arm recognized; ARM=right runs the other, or choose"),
        (
            lambda text: re.sub(r"(LeftForeArm\n.*\n.*\n.* 3 )Z", r"\1X", text),
            "joint LeftForeArm has no rotation channel",
        ),
    ],
)
def test_a_file_without_usable_arms(tmp_path, change, message):
    path = figure.write(tmp_path / "clip.bvh")
    path.write_text(change(path.read_text()))
    with pytest.raises(ClipError, match=f"^{path}: {message}"):
        motion(clip := read(path), arms(clip)[0])


def walk(path):
    """Write and return a clip, y up: the arms are out along x in the first frame, as at rest; then the figure walks."""
    clip = read(figure.write(path, order="XZY"))
    clip.table[:, 6:] *= 0.1
    swing = np.sin(np.linspace(0, 12, len(clip.table)))
    for arm, side in zip(arms(clip), (-1, 1), strict=True):
        upper, fore = ([channel.column for channel in clip.nodes[joint].channels] for joint in (arm.upper, arm.fore))
        clip.table[1:, upper] += np.outer(swing, (side * 25, 0, 0))[1:] - (0, side * 75, 0)
        clip.table[:, fore[2]] += side * (30 + 15 * swing)
    return saved(clip)


@pytest.mark.parametrize("path", [None, *MOCAP], ids=lambda path: path.stem if path else "drawn")
def test_motion_capture(path, tmp_path):
    """Follow human motion; with a constant swivel angle, no arm turns more than 1.5 times as fast as in the clip."""
    clip = read(path) if path else walk(tmp_path / "walk.bvh")
    for width, tolerance in ((None, 1e-12), (32, 2e-8), (18, 2e-4)):  # the T pose of the first frame included
        for move, qs, qe in followed(clip, width):
            elbow, _ = forward(qs, qe, move.d1, move.d2)
            assert (np.linalg.norm(elbow - move.elbow, axis=1) <= tolerance * (move.d1 + move.d2)).all(), width
    figure.compare(clip.path, written(tmp_path / "clip.bvh", clip))
    for (move, qs, _), arm in zip(followed(clip, None, lambda m: m.typical_phi), arms(clip), strict=True):
        torso, upper = conjugate(clip.turn[:, arm.torso]), clip.turn[:, arm.upper]
        theirs, ours = multiply(torso, upper), multiply(torso, qs)
        fastest = [angle_between(q[1:-1], q[2:]).max() for q in (ours, theirs)]
        assert fastest[0] <= 1.5 * fastest[1], move.limb


def values(file, accessor):
    """Return the numbers of an accessor as an array (count, components)."""
    about = file.accessors[accessor]
    view = file.bufferViews[about.bufferView]
    kind = {pygltflib.FLOAT: np.float32, pygltflib.UNSIGNED_SHORT: np.uint16}.get(about.componentType, np.uint32)
    data = file.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    table = np.frombuffer(data, kind).reshape(about.count, -1)
    if about.min:
        assert (table.min(axis=0), table.max(axis=0)) == (pytest.approx(about.min), pytest.approx(about.max))
    return table


@pytest.mark.parametrize("up", ["x", "y", "z", "-y"])
@pytest.mark.filterwarnings("ignore:.*provisional")
def test_nodes_and_bones_are_where_the_joints_are(tmp_path, up):
    clip = read(figure.write(tmp_path / "clip.bvh"), up)
    clip.table[:, 3] += np.linspace(0, 1200, len(clip.table))  # turns, through both signs of the quaternion
    (tmp_path / "clip.glb").write_bytes(animated(clip, "a figure", 0.01))
    file = pygltflib.GLTF2().load(tmp_path / "clip.glb")
    assert not validate(file)
    (animation,) = file.animations
    tracks, count = {}, len(clip.table)
    for channel in animation.channels:
        sampler = animation.samplers[channel.sampler]
        np.testing.assert_allclose(values(file, sampler.input)[:, 0], np.arange(count) / 120, rtol=1e-5)
        track = tracks[channel.target.node, channel.target.path] = values(file, sampler.output)
        assert len(track) == count
        if channel.target.path == "rotation":
            np.testing.assert_allclose(np.linalg.norm(track, axis=1), 1, atol=1e-6)
            assert (np.sum(track[1:] * track[:-1], axis=1) > 0).all(), "no flip of signs"

    frames = {}

    def walk(number, turn, place):
        node = file.nodes[number]
        move = tracks.get((number, "translation"), np.tile(node.translation or (0.0, 0, 0), (count, 1)))
        spin = tracks.get((number, "rotation"), np.tile(node.rotation or (0.0, 0, 0, 1), (count, 1)))
        frames[number] = place, turn = place + turn.apply(move), turn * Rotation.from_quat(spin)
        for child in node.children or ():
            walk(child, turn, place)

    (armature,) = file.scenes[file.scene].nodes
    assert file.nodes[armature].name == file.skins[0].name == "a figure"
    walk(armature, Rotation.identity(count), np.zeros((count, 3)))
    order, sign = {"x": ([2, 0, 1], 1), "y": ([0, 1, 2], 1), "z": ([1, 2, 0], 1), "-y": ([0, 1, 2], (-1, -1, 1))}[up]
    expected = clip.positions[:, :, order] * sign / 100
    bones = file.meshes[0].primitives[0]
    corners, owners = values(file, bones.attributes.POSITION), values(file, bones.attributes.JOINTS_0)[:, 0]
    (skin,) = file.skins
    inverse = values(file, skin.inverseBindMatrices).reshape(-1, 4, 4)
    assert [file.nodes[joint].name for joint in skin.joints] == clip.names
    tips = []
    for corner, owner in zip(corners, owners, strict=True):
        place, turn = frames[skin.joints[owner]]
        tips.append(place + turn.apply([(*corner, 1) @ inverse[owner][:, :3]] * count))
    assert (values(file, bones.attributes.WEIGHTS_0) == (1, 0, 0, 0)).all()
    for k, parent in enumerate(clip.parents):
        np.testing.assert_allclose(frames[k][0], expected[:, k], atol=1e-6)
        if parent >= 0:  # the bone that ends here
            assert min(np.abs(tip - expected[:, k]).max() for tip in tips[5::6]) < 1e-6
            assert min(np.abs(tip - expected[:, parent]).max() for tip in tips[::6]) < 1e-6


FILE = Path("clip.bvh")


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    return figure.write(tmp_path_factory.mktemp("bvh") / "clip.bvh", frames=4, rich=True).read_text()


def rows_of(text, change):
    head, frames, rows = text.partition("0.0083333\n")
    return head + frames + change(rows)


SAME = {
    "two joints of one name": lambda t: re.sub("LeftShoulder|RightShoulder", "Collar", t),
    "end": lambda t: t.replace("End Site", "END SITE"),
    "other keywords": lambda t: t.replace("JOINT", "Joint").replace("OFFSET", "Offset").replace("CHANNELS", "Channels"),
    "one line": lambda t: t.replace("\n{", " {"),
    "frames": lambda t: t.replace("Frames: 4", "Frames:4").replace("Frame Time: ", "Frame Time:\t"),
    "comments": lambda t: rows_of("# a clip\n" + t.replace("{", "{ # here", 3), lambda rows: "# frames\n" + rows),
    "wrapped rows": lambda t: rows_of(t, lambda rows: re.sub(r"((?:\S+ ){9})", r"\1\n", rows)),
    "lines that ignore rows": lambda t: rows_of(t, lambda rows: "\n".join(rows.split())),
    "dos": lambda t: t.replace("\n", "\r\n"),
    "blank lines": lambda t: t.replace("\n", " \n\n"),
}


@pytest.mark.parametrize("change", SAME.values(), ids=SAME)
def test_variants_of_one_clip(text, change):
    clip, original = parse(change(text).encode(), FILE), parse(text.encode(), FILE)
    assert (clip.table == original.table).all() and not clip.notes
    assert [node.channels for node in clip.nodes] == [node.channels for node in original.nodes]
    assert clip.content().decode().startswith(change(text).partition("Frames")[0])


def test_a_position_channel_replaces_a_coordinate_of_offset(text):
    moved = re.sub("OFFSET .*(?=\nCHANNELS 6)", "OFFSET 7 8 9", text)
    assert moved != text and (parse(moved.encode(), FILE).positions == parse(text.encode(), FILE).positions).all()


@pytest.mark.parametrize(
    ("change", "rows", "note"),
    [
        (lambda t: t.replace("Frames: 4", "Frames: 5"), 4, "'Frames: 5' is wrong; number of frames in the file: 4"),
        (lambda t: t.replace("Frames: 4", "Frames: 3"), 4, "'Frames: 3' is wrong; number of frames in the file: 4"),
        (lambda t: t[:-20], 3, r"line \d+: expected \d+ numbers, .* got \d+: the frame is ignored"),
        (lambda t: t.replace("0.0083333", "0"), 4, "'Frame Time: 0' is not positive: 30 frames per second are assumed"),
    ],
)
def test_doubts(text, change, rows, note):
    clip = parse(change(text).encode(), FILE)
    assert re.fullmatch(note, clip.notes[0]) and (clip.table == parse(text.encode(), FILE).table[:rows]).all()
    assert clip.period == (1 / 30 if "Time" in note else 0.0083333)
    assert f"Frames: {rows}\n".encode() in clip.content()


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig", "utf-16"])
def test_encodings(text, encoding):
    content = text.replace("Spine", "Wirbels\u00e4ule").encode(encoding)
    clip = parse(content, FILE)
    assert clip.names[1] == "Wirbels\u00e4ule"
    assert clip.content().startswith(text.partition("Frame Time")[0].replace("Spine", clip.names[1]).encode(encoding))


WORDS = [*"{ } JOINT ROOT End OFFSET CHANNELS MOTION Frames: 0 -1 1e999 1e29 nan".split(), "\n"]


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_a_spoiled_file_is_a_clip_or_an_error(text, data):
    content = text.encode()
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content)))
        new = data.draw(st.sampled_from(WORDS).map(str.encode) | st.binary(max_size=4))
        content = content[:start] + new + content[start + data.draw(st.integers(0, 12)) :]
    try:
        clip = parse(content, FILE)
        again = parse(clip.content(), FILE)
        assert (again.table == clip.table).all() and again.nodes == clip.nodes
        clips.up_axis(clip)
        moves = [motion(clip, arm) for arm in arms(clip)]
        assert all(np.isfinite(move.phi).all() for move in moves)
    except ClipError as error:
        assert "\n" not in str(error)

# SPDX-License-Identifier: Apache-2.0
"""Animated file: it is valid, and its nodes are at the clip's joints."""

import numpy as np
import pygltflib
import pytest
from pygltflib.validator import validate
from scipy.spatial.transform import Rotation

from model.motion.clip import read
from model.motion.gltf import animated
from model.motion.tests import figure


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

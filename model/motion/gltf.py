# SPDX-License-Identifier: Apache-2.0
"""Clip as an animated glTF 2.0 binary: its joints as nodes, a small double pyramid for each bone."""

from __future__ import annotations

import numpy as np
import pybvh
import pygltflib as gltf

from ..reference.kinematics import continuous, multiply

POINTS = np.array(
    [(0, 0, 0), (0.08, 0.15, 0), (0, 0.15, 0.08), (-0.08, 0.15, 0), (0, 0.15, -0.08), (0, 1, 0)], dtype=np.float32
)
"""Corners of a bone of length 1 along y."""

RING = ((1, 2), (2, 3), (3, 4), (4, 1))
FACES = np.array([*((0, a, b) for a, b in RING), *((5, b, a) for a, b in RING)], dtype=np.uint8)

TO_Y = ((0.5, 0.5, 0.5, 0.5), (1.0, 0.0, 0.0, 0.0), (0.5, -0.5, -0.5, -0.5))
"""wxyz quaternions of the cyclic axis exchanges that take the clip's up axis, x, y or z, to glTF's y."""


def animated(bvh: pybvh.Bvh, name: str) -> bytes:
    """Return the bytes of a .glb file; lengths are the clip's numbers, up is always y."""
    file = gltf.GLTF2(asset=gltf.Asset(generator="cga-ik"), scene=0)
    data = _Data(file)
    corners = data.put(POINTS, gltf.VEC3, gltf.ARRAY_BUFFER, bounds=True)
    faces = data.put(FACES.reshape(-1), gltf.SCALAR, gltf.ELEMENT_ARRAY_BUFFER)
    shape = gltf.Primitive(attributes=gltf.Attributes(POSITION=corners), indices=faces)
    file.meshes = [gltf.Mesh(primitives=[shape], name="bone")]

    up = bvh.up_axis
    turn = np.array(TO_Y[up.index])
    if up.sign < 0:  # first half a turn, about the next axis
        turn = multiply(turn, np.eye(4)[1 + (up.index + 1) % 3])
    file.nodes = [gltf.Node(name=name, rotation=np.roll(turn, -1).tolist(), children=[1])]
    file.scenes = [gltf.Scene(nodes=[0])]
    number = {node.name: 1 + k for k, node in enumerate(bvh.nodes)}
    for node in bvh.nodes:
        file.nodes.append(gltf.Node(name=node.name, translation=node.offset.tolist()))
    for node in bvh.nodes:
        if node.parent is not None:
            children = file.nodes[number[node.parent.name]].children
            children.append(number[node.name])
            if np.linalg.norm(node.offset) > 0:
                children.append(len(file.nodes))
                file.nodes.append(_bone(node.offset))

    clock = data.put(np.arange(bvh.frame_count, dtype=np.float32) * bvh.frame_time, gltf.SCALAR, bounds=True)
    motion = gltf.Animation(name=name)
    positions, rotations = bvh.to_quat()
    tracks = [(number[bvh.nodes[0].name], "translation", positions, gltf.VEC3)]
    for k, joint in enumerate(bvh.joint_names):
        tracks.append((number[joint], "rotation", np.roll(continuous(rotations[:, k]), -1, axis=1), gltf.VEC4))
    for target, path, values, kind in tracks:
        sampler = len(motion.samplers)
        motion.samplers.append(gltf.AnimationSampler(input=clock, output=data.put(values.astype(np.float32), kind)))
        aim = gltf.AnimationChannelTarget(node=target, path=path)
        motion.channels.append(gltf.AnimationChannel(sampler=sampler, target=aim))
    file.animations = [motion]
    file.buffers = [gltf.Buffer(byteLength=len(data.bytes))]
    file.set_binary_blob(bytes(data.bytes))
    return b"".join(file.save_to_bytes())


class _Data:
    """Contents of the buffer, and their accessors."""

    KINDS = {"f": gltf.FLOAT, "u": gltf.UNSIGNED_BYTE}

    def __init__(self, file: gltf.GLTF2) -> None:
        self.file, self.bytes = file, bytearray()

    def put(self, values: np.ndarray, kind: str, target: int | None = None, bounds: bool = False) -> int:
        """Append values to the buffer and return the number of their accessor."""
        view = gltf.BufferView(buffer=0, byteOffset=len(self.bytes), byteLength=values.nbytes, target=target)
        self.bytes += values.tobytes() + bytes(-values.nbytes % 4)
        self.file.bufferViews.append(view)
        table = values.reshape(len(values), -1)
        low, high = (table.min(axis=0).tolist(), table.max(axis=0).tolist()) if bounds else (None, None)
        self.file.accessors.append(
            gltf.Accessor(
                bufferView=len(self.file.bufferViews) - 1,
                componentType=self.KINDS[values.dtype.kind],
                count=len(values),
                type=kind,
                min=low,
                max=high,
            )
        )
        return len(self.file.accessors) - 1


def _bone(offset: np.ndarray) -> gltf.Node:
    """Return the double pyramid from a joint to the next."""
    length = float(np.linalg.norm(offset))
    x, y, z = offset / length
    turn = np.array((z, 0.0, -x, 1 + y)) if y > -1 + 1e-9 else np.array((1.0, 0.0, 0.0, 0.0))
    return gltf.Node(mesh=0, rotation=(turn / np.linalg.norm(turn)).tolist(), scale=[length] * 3)

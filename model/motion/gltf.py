# SPDX-License-Identifier: Apache-2.0
"""Write a clip as an animated glTF 2.0 binary in metres: an armature of joints, with double pyramids as bones."""

import numpy as np
import pygltflib as gltf

from ..reference.kinematics import continuous, multiply, rotate
from .bvh import Clip

POINTS = np.array([(0, 0, 0), (0.08, 0.15, 0), (0, 0.15, 0.08), (-0.08, 0.15, 0), (0, 0.15, -0.08), (0, 1, 0)])
"""Corners of a bone of length 1 along y."""

RING = ((1, 2), (2, 3), (3, 4), (4, 1))
FACES = np.array([*((0, a, b) for a, b in RING), *((5, b, a) for a, b in RING)], dtype=np.uint32)

COMPONENTS = {"f4": gltf.FLOAT, "u2": gltf.UNSIGNED_SHORT, "u4": gltf.UNSIGNED_INT}

TO_Y = {"x": (0.5, 0.5, 0.5, 0.5), "y": (1.0, 0.0, 0.0, 0.0), "z": (0.5, -0.5, -0.5, -0.5)}
"""Up axis of a clip -> wxyz quaternion of the cyclic axis exchange that takes it to glTF's y."""


def animated(clip: Clip, name: str, scale: float = 1.0) -> bytes:
    """Return the bytes of a .glb file, in which y is up. scale: metres per unit of length of the clip."""
    file = gltf.GLTF2(asset=gltf.Asset(generator="cga-ik"), scene=0)
    file.set_binary_blob(bytearray())
    turn = np.array(TO_Y[clip.up[-1]])
    if clip.up[0] == "-":  # before that, turn by pi about the next axis
        turn = multiply(turn, np.eye(4)[1 + ("xyz".index(clip.up[-1]) + 1) % 3])
    for label, node in zip(clip.names, clip.nodes, strict=True):
        file.nodes.append(gltf.Node(name=label, translation=(scale * np.array(node.offset)).tolist()))
    for k, parent in enumerate(clip.parents):
        if parent >= 0:
            file.nodes[parent].children.append(k)
    armature = len(file.nodes)
    roots = [k for k, parent in enumerate(clip.parents) if parent < 0]
    file.nodes.append(gltf.Node(name=name, rotation=np.roll(turn, -1).tolist(), children=[*roots, armature + 1]))
    file.nodes.append(gltf.Node(name=f"{name} bones", mesh=0, skin=0))
    file.scenes = [gltf.Scene(nodes=[armature])]
    file.meshes = [_bones(clip, scale, file)]
    inverse = np.tile(np.eye(4, dtype=np.float32), (armature, 1, 1))
    inverse[:, 3, :3] = -scale * clip.rest  # glTF stores columns
    matrices = _put(file, inverse.reshape(-1, 16), gltf.MAT4)
    file.skins = [gltf.Skin(name=name, inverseBindMatrices=matrices, skeleton=armature, joints=list(range(armature)))]

    clock = _put(file, np.arange(len(clip.table), dtype=np.float32) * clip.period, gltf.SCALAR, bounds=True)
    motion = gltf.Animation(name=name)
    for k, node in enumerate(clip.nodes):
        tracks = []
        if node.of("position"):
            tracks.append(("translation", scale * clip.places[:, k], gltf.VEC3))
        if node.of("rotation"):
            tracks.append(("rotation", np.roll(continuous(clip.local[:, k]), -1, axis=1), gltf.VEC4))
        for path, values, kind in tracks:
            aim = gltf.AnimationChannelTarget(node=k, path=path)
            motion.channels.append(gltf.AnimationChannel(sampler=len(motion.samplers), target=aim))
            motion.samplers.append(gltf.AnimationSampler(input=clock, output=_put(file, values, kind)))
    file.animations = [motion]
    file.buffers = [gltf.Buffer(byteLength=len(file.binary_blob()))]
    return b"".join(file.save_to_bytes())


def _bones(clip: Clip, scale: float, file: gltf.GLTF2) -> gltf.Mesh:
    """Return the mesh of the bones in the rest pose; each bone moves with the joint at which it begins."""
    points, joints = [np.zeros((0, 3))], []
    for node in clip.nodes:
        if node.parent >= 0 and (length := float(np.linalg.norm(node.offset))) > 0:
            x, y, z = np.array(node.offset) / length
            turn = np.array((1 + y, z, 0.0, -x)) if y > -1 + 1e-9 else np.array((0.0, 1.0, 0.0, 0.0))
            bone = rotate(turn / np.linalg.norm(turn), POINTS * length)
            points.append(scale * (clip.rest[node.parent] + bone))
            joints += [(node.parent, 0, 0, 0)] * len(POINTS)
    corners = _put(file, np.concatenate(points), gltf.VEC3, gltf.ARRAY_BUFFER, bounds=True)
    owners = _put(file, np.array(joints, dtype=np.uint16), gltf.VEC4, gltf.ARRAY_BUFFER)
    weights = _put(file, np.tile((1.0, 0.0, 0.0, 0.0), (len(joints), 1)), gltf.VEC4, gltf.ARRAY_BUFFER)
    faces = np.concatenate([FACES.reshape(-1) + first for first in range(0, len(joints), len(POINTS))])
    attributes = gltf.Attributes(POSITION=corners, JOINTS_0=owners, WEIGHTS_0=weights)
    indices = _put(file, faces, gltf.SCALAR, gltf.ELEMENT_ARRAY_BUFFER)
    return gltf.Mesh(name="bones", primitives=[gltf.Primitive(attributes=attributes, indices=indices)])


def _put(file: gltf.GLTF2, values: np.ndarray, kind: str, target: int | None = None, bounds: bool = False) -> int:
    """Append values to the file's only buffer and return the number of their accessor."""
    values = values.astype(np.float32) if values.dtype.kind == "f" else values
    blob = file.binary_blob()
    file.bufferViews.append(gltf.BufferView(buffer=0, byteOffset=len(blob), byteLength=values.nbytes, target=target))
    blob += values.tobytes() + bytes(-values.nbytes % 4)
    table = values.reshape(len(values), -1)
    low, high = (table.min(axis=0).tolist(), table.max(axis=0).tolist()) if bounds else (None, None)
    number, component = len(file.accessors), COMPONENTS[values.dtype.str[1:]]  # a view for each accessor
    about = {"bufferView": number, "componentType": component, "count": len(values), "type": kind}
    file.accessors.append(gltf.Accessor(**about, min=low, max=high))
    return number

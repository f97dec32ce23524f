# SPDX-License-Identifier: Apache-2.0
"""Second, independent reader of BVH files, recursive and with scipy's rotations; comparison of two files."""

import codecs
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation


def read(path):
    """Return the nodes [(name, parent, offset, channels)], the table (F, C), the nodes' positions and rotations."""
    content = Path(path).read_bytes()
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    text = content.decode("utf-16" if wide else "utf-8", errors="replace")
    skeleton, _, motion = text.partition("MOTION")
    lines = [line.partition("#")[0].split() for line in skeleton.split("\n")]
    lines = iter([words for words in lines if words and words != ["{"]])
    nodes = []

    def node(name, parent):
        me, offset, channels = len(nodes), None, []
        nodes.append(None)
        for words in lines:
            if words[0] == "OFFSET":
                offset = np.array(words[1:], dtype=float)
            elif words[0] == "CHANNELS":
                channels = words[2:]
            elif words[0] == "}":
                break
            else:
                nodes[me] = (name, parent, offset, channels)  # all lines before the first child
                node(" ".join(words[1:]), me)
        nodes[me] = (name, parent, offset, channels)

    for words in lines:
        if words[0] == "ROOT":
            node(" ".join(words[1:]), -1)
    numbers = motion.partition("Time:")[2].split()[1:]
    columns = sum(len(channels) for *_, channels in nodes)
    table = np.array(numbers[: len(numbers) // columns * columns], dtype=float).reshape(-1, columns)
    positions, turns, column = [], [], 0
    for _, parent, offset, channels in nodes:
        place, turn = np.tile(offset, (len(table), 1)), Rotation.identity(len(table))
        for name in channels:
            if name.endswith("position"):
                place[:, "XYZ".index(name[0])] = table[:, column]
            else:
                turn = turn * Rotation.from_euler(name[0], table[:, [column]], degrees=True)
            column += 1
        positions.append(place if parent < 0 else positions[parent] + turns[parent].apply(place))
        turns.append(turn if parent < 0 else turns[parent] * turn)
    return nodes, table, np.array(positions), turns


def compare(path, again, free=(), positions=1e-6, angles=1e-6, frames=slice(None)):
    """Check that a written clip has the original's joints: nodes, and of every joint position, relative to the size of
    the body, and orientation, rad; `free` joints, by number, may move and turn. Joints that keep their orientation to
    the parent keep every number."""
    nodes, table, places, turns = read(path)
    nodes_again, table_again, places_again, turns_again = read(again)
    assert [(*node[:2], node[3]) for node in nodes] == [(*node[:2], node[3]) for node in nodes_again]
    assert all((one[2] == other[2]).all() for one, other in zip(nodes, nodes_again, strict=True))
    assert table.shape == table_again.shape
    kept = [k for k in range(len(nodes)) if k not in free]
    size = np.ptp(places[:, 0], axis=0).max()
    away = np.linalg.norm(places_again - places, axis=2)[kept][:, frames] / size
    assert away.max() <= positions, (nodes[kept[int(away.max(axis=1).argmax())]][0], away.max())
    for k in kept:
        turned = (turns[k].inv() * turns_again[k]).magnitude()[frames]
        assert turned.max() <= angles, (nodes[k][0], turned.max())

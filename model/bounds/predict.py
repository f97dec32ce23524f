# SPDX-License-Identifier: Apache-2.0
"""Predicted errors: what the rounding of every node does to the hand, from word lengths and the pose alone.

The dataflow runs in double precision with single nodes moved by as much as their rounding rule may move them
(:class:`Real`).  Nothing of the bit-true model's rounding enters but its decisions: shift counts and masks.  So a
prediction knows the conditioning of the equations at the pose, and a measured error can be held against it.
"""

from __future__ import annotations

import numpy as np

from ..dataflow import fixed
from ..dataflow.nodes import Node
from ..dataflow.reals import Real
from ..io.words import ARMS


def rounded_nodes(bits: fixed.Bits) -> list[Node]:
    """The nodes that a rounding can move, in dataflow order."""
    return [node for node in bits.nodes.values() if node.error != (0.0, 0.0)]


CORNERS = 32
"""Random ends of all roundings together that :func:`hand_bar` tries besides the worst of first order."""


def hand_bar(words: np.ndarray, width: int, datapath: str = "paper") -> np.ndarray:
    """Largest hand error / reach that the roundings of a datapath explain, for input words (N, 6); shape (N,).

    Every node is moved to either end of its rounding's range on its own; then, for each axis, all are moved at once
    to the ends that push the hand furthest along that axis.  To first order no set of roundings does worse.  Where a
    root or a limited cosine is at its end, first order says little: there :data:`CORNERS` random sets of ends are
    tried as well.  The rounding of the input words is added, half an ulp each.
    """
    return bar(fixed.run(words, width, datapath).bits, HAND)


ELBOW, HAND = 0, 1
"""What :func:`bar` is of."""


def bar(bits: fixed.Bits, point: int) -> np.ndarray:
    """:func:`hand_bar` of the targets that ``bits`` was run with, or the same of the elbow."""
    nodes = rounded_nodes(bits)
    length = 2.0 ** (2 - bits.width)
    d1, d2 = (bits.nodes[name].value * length for name in ARMS)
    count = len(d1)

    def hand(moves: dict[str, np.ndarray]) -> np.ndarray:
        return Real(bits, moves).points(d1, d2)[point]

    ends = {}
    for node in nodes:
        low, high = node.error
        ends[node.name] = hand({node.name: np.full(count, high)}) - hand({node.name: np.full(count, low)})
    base = hand({})
    worst = np.zeros((count, 3))
    for axis in range(3):
        for side in (1, -1):
            moves = {n.name: np.where(side * ends[n.name][:, axis] > 0, n.error[1], n.error[0]) for n in nodes}
            worst[:, axis] = np.maximum(worst[:, axis], np.abs(hand(moves) - base)[:, axis])
    furthest = np.linalg.norm(worst, axis=1)
    random = np.random.default_rng(0)
    for _ in range(CORNERS):
        moves = {n.name: random.choice(n.error, count) for n in nodes}
        furthest = np.maximum(furthest, np.linalg.norm(hand(moves) - base, axis=1))
    reach = np.maximum(np.abs(d1) + np.abs(d2), length)
    inputs = (np.sqrt(3) / 2 + 1) * length
    return (furthest + inputs) / reach

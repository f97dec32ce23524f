# SPDX-License-Identifier: Apache-2.0
"""Predicted errors: the effect of every node's rounding on the hand, from word lengths and the pose alone.

The dataflow runs in double precision with single nodes moved by the limits of their rounding rule (:class:`Real`).
Only the decisions of the bit-true model are used: shift counts and masks.  A prediction therefore reflects the
conditioning of the equations at the pose, and measured errors can be compared with it.
"""

from __future__ import annotations

import numpy as np

from ..dataflow import fixed
from ..dataflow.nodes import Node
from ..dataflow.reals import Real
from ..io.words import ARMS


def rounded_nodes(bits: fixed.Bits) -> list[Node]:
    """Return the nodes that rounding can move, in dataflow order."""
    return [node for node in bits.nodes.values() if node.error != (0.0, 0.0)]


CORNERS = 32
"""Number of random combinations of rounding ends that :func:`hand_bar` tries besides the first-order worst case."""


def hand_bar(words: np.ndarray, width: int, datapath: str = "paper") -> np.ndarray:
    """Return the largest hand error / reach explained by the roundings of a datapath, for input words (N, 6); shape
    (N,).

    Every node is moved alone to either end of its rounding range; then, for each axis, all nodes are moved at once to
    the ends that push the hand furthest along that axis.  To first order no set of roundings is worse.  Where a root or
    a limited cosine is at its end, first order is unreliable: there :data:`CORNERS` random sets of ends are tried as
    well. The rounding of the input words is added, half an ulp each.
    """
    return bar(fixed.run(words, width, datapath).bits, HAND)


ELBOW, HAND = 0, 1
"""Points for which :func:`bar` is computed."""


def bar(bits: fixed.Bits, point: int) -> np.ndarray:
    """Return :func:`hand_bar` for the targets of ``bits``, or its equivalent for the elbow."""
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

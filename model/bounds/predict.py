# SPDX-License-Identifier: Apache-2.0
"""Predicted errors: the effect of every node's rounding on the hand, computed from formats and the pose.

:class:`Real` evaluates the dataflow in double precision, with chosen nodes moved to the ends of their rounding range.
The bit-true model supplies masks, shift counts, the nodes of the section ``guard``, and words that count as exact. A
prediction includes the conditioning of the equations at its pose, so measured errors can be compared with it.
"""

from collections.abc import Mapping

import numpy as np

from ..dataflow import fixed
from ..dataflow.datapaths import DEFAULT
from ..dataflow.expressions import EXACT
from ..dataflow.nodes import Node
from ..io.words import ARMS, RESULT_FIELDS
from ..reference.kinematics import forward


class Real:
    """Dataflow in double precision for the targets of a run, with some nodes moved; ``values``: node name -> values.

    ``nodes``: from an :class:`..dataflow.fixed.Answer`.  ``moves`` maps the name of each moved node to the distances
    (N,), in ulps, that are added to the node's value.
    """

    def __init__(self, nodes: Mapping[str, Node], moves: Mapping[str, np.ndarray]) -> None:
        self.nodes = nodes
        self.values: dict[str, np.ndarray] = {}
        self._as_words: frozenset[str] = frozenset()  # of the node being evaluated
        for name, node in nodes.items():
            value = self._value(node)
            self.values[name] = value + moves[name] * node.format.ulp if name in moves else value

    def _value(self, node: Node):
        if not node.frac:
            return node.value
        if node.kind == "input" or node.section == "guard":
            return np.asarray(self.word(node.name), float)
        self._as_words = node.as_words
        return node.op.real_result(node, self) * node.format.ulp

    def __getitem__(self, name: str):
        """Return the value of an operand of the node being evaluated, in ulps of the operand."""
        value = self.word(name) if name in self._as_words else self.values[name]
        return value / self.nodes[name].format.ulp

    def word(self, name: str):
        """Return the value of a node's word in the bit-true model."""
        return self.nodes[name].value * self.nodes[name].format.ulp


CORNERS = 32
"""Number of random combinations of rounding errors that :func:`predicted_error` tries."""


def predicted_error(words: np.ndarray, width: int, datapath: str = DEFAULT) -> np.ndarray:
    """Return the largest hand errors (N,), relative to the reach, that rounding can cause for input words (N, 6).

    First, each node alone is moved to both ends of its rounding range. Then, for both directions of each axis, all
    nodes are moved at once, each to the end that pushes the hand further that way: to first order, the worst case.
    First order is unreliable where a root or a limited cosine is at the end of its range, so :data:`CORNERS` random
    combinations of ends are tried as well. The rounding of the input words, half an ulp each, is added.
    """
    nodes = fixed.run(words, width, datapath).nodes
    rounded = [node for node in nodes.values() if node.error != EXACT]
    length = 2.0 ** (2 - width)
    d1, d2 = (nodes[name].value * length for name in ARMS)
    count = len(d1)

    def hand(moves: dict[str, np.ndarray]) -> np.ndarray:
        values = Real(nodes, moves).values
        q = np.stack([values[name] for name in RESULT_FIELDS], axis=1)
        return forward(q[:, :4], q[:, 4:], d1, d2)[1]

    ends = {}
    for node in rounded:
        low, high = node.error
        ends[node.name] = hand({node.name: np.full(count, high)}) - hand({node.name: np.full(count, low)})
    base = hand({})
    worst = np.zeros((count, 3))
    for axis in range(3):
        for side in (1, -1):
            moves = {n.name: np.where(side * ends[n.name][:, axis] > 0, n.error[1], n.error[0]) for n in rounded}
            worst[:, axis] = np.maximum(worst[:, axis], np.abs(hand(moves) - base)[:, axis])
    furthest = np.linalg.norm(worst, axis=1)
    random = np.random.default_rng(0)
    for _ in range(CORNERS):
        moves = {n.name: random.choice(n.error, count) for n in rounded}
        furthest = np.maximum(furthest, np.linalg.norm(hand(moves) - base, axis=1))
    reach = np.maximum(np.abs(d1) + np.abs(d2), length)
    inputs = (np.sqrt(3) / 2 + 1) * length
    return (furthest + inputs) / reach

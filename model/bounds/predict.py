# SPDX-License-Identifier: Apache-2.0
"""Predicted errors: the effect of every node's rounding on the hand, from word lengths and the pose alone.

The dataflow runs in double precision with single nodes moved by the limits of their rounding rule (:class:`Real`).
Only the decisions of the bit-true model are used: shift counts and masks.  A prediction therefore reflects the
conditioning of the equations at the pose, and measured errors can be compared with it.
"""

from dataclasses import replace

import numpy as np

from ..dataflow import fixed
from ..dataflow.angles import gain
from ..dataflow.datapaths import DEFAULT, MODELS
from ..dataflow.nodes import EXACT, Domain, Node, real_value
from ..io.words import ARMS, RESULT_FIELDS
from ..reference.kinematics import forward


class Real(Domain):
    """Dataflow in double precision at the pose of ``bits``, with some nodes moved.

    ``moves`` maps a node's name to an array (N,), in ulps.  Decisions and the guard's nodes come from the integer run.
    """

    def __init__(self, bits: fixed.Bits, moves: dict[str, np.ndarray]) -> None:
        super().__init__(bits.width, MODELS[bits.datapath].widths, bits.tile)
        self.bits = bits
        self.moves = moves
        for name, node in bits.nodes.items():
            if node.section == "guard":
                value = np.asarray(node.value * node.format.ulp, float) if node.format.signed else node.value
                self.nodes[name] = replace(node, value=self._moved(name, value, node.format))
        MODELS[bits.datapath].after_guard(self, self.nodes["phi"])

    def _moved(self, name, value, fmt):
        return value + self.moves[name] * fmt.ulp if name in self.moves else value

    def constant(self, value, fmt):
        return Node("", "", "", "constant", (), fmt, None, 0, value)

    def apply(self, name, operands, fmt, words):
        if self.decides(fmt):
            return self.bits.nodes[name].value
        return self._moved(name, real_value(words, operands, [n.value for n in operands], fmt), fmt)

    def product(self, name, a, b, fmt, scale):
        return self._moved(name, a.value * b.value * 2.0**scale, fmt)

    def total(self, name, signs, nodes, fmt):
        return self._moved(name, sum(s * n.value for s, n in zip(signs, nodes, strict=True)), fmt)

    def quotient(self, name, n, d, fmt):
        value = n.value / np.where(d.value > 0, d.value, fmt.ulp)
        return self._moved(name, np.clip(value, fmt.low * fmt.ulp, fmt.high * fmt.ulp), fmt)

    def square_root(self, name, n, fmt):
        return self._moved(name, np.sqrt(np.maximum(n.value, 0)), fmt)

    def mantissa(self, name, word, words, counts, fill):
        empty = np.logical_and.reduce([w.value == 0 for w in self.bits.nodes[name].operands])
        scaled = word.value * 2.0 ** (counts.value - (word.format.width - 1 - word.format.frac))
        return self._moved(name, np.where(empty, 0.5 if fill else 0.0, scaled), self.word(0))

    def cordic(self, names, phi):
        return self.half_sincos(names, phi, self.word(1))

    # lean datapath; operations with several results move their nodes where they create them

    def product3(self, name, a, b, fmt, scale):
        return self.product(name, a, b, fmt, scale)

    def even_mantissa(self, count, name, value, width, fmt):
        shift, mantissa = (self.bits.nodes[k].value for k in (count, name))
        exact = value.value / value.format.ulp * 2.0 ** (2 * shift - width)
        return shift, self._moved(name, np.where(mantissa == 0, 0.0, exact), fmt)

    def reciprocal_root(self, name, m, fmt, twice):
        inverse = 0.5 / np.sqrt(np.where(m.value > 0, m.value, 0.25))
        inverse = inverse * np.where(twice.value, 2.0, 1.0) if twice else inverse
        return self._moved(name, inverse, fmt)

    def half_sincos(self, names, phi, fmt):
        half = phi.value * (np.pi / 2)  # phi's word has its sign in the MSB: half a turn is 1
        return tuple(self._moved(n, v, fmt) for n, v in zip(names, (np.sin(half), np.cos(half)), strict=True))

    # the whole arm

    def words(self, *names):
        for name in names:
            self.nodes[name].value = self.bits.nodes[name].value * self.nodes[name].format.ulp

    def polar(self, names, x, y, sign):
        return gain(self.width) * np.hypot(x.value, y.value), np.arctan2(sign * y.value, x.value) / np.pi

    def points(self, d1, d2) -> tuple[np.ndarray, np.ndarray]:
        """Return elbow and wrist (N, 3) of an arm d1, d2 in the computed pose."""
        q = np.stack([self.nodes[k].value for k in RESULT_FIELDS], axis=1)
        return forward(q[:, :4], q[:, 4:], d1, d2)


CORNERS = 32
"""Number of random combinations of rounding ends that :func:`hand_bar` tries besides the first-order worst case."""


def hand_bar(words: np.ndarray, width: int, datapath: str = DEFAULT) -> np.ndarray:
    """Return the largest hand error / reach explained by the roundings of a datapath, for input words (N, 6); shape
    (N,).

    Every node is moved alone to either end of its rounding range; then, for each axis, all nodes are moved at once to
    the ends that push the hand furthest along that axis.  To first order no set of roundings is worse.  Where a root or
    a limited cosine is at its end, first order is unreliable: there :data:`CORNERS` random sets of ends are tried as
    well. The rounding of the input words is added, half an ulp each.
    """
    bits = fixed.run(words, width, datapath).bits
    nodes = [node for node in bits.nodes.values() if node.error != EXACT]  # those that rounding can move
    length = 2.0 ** (2 - bits.width)
    d1, d2 = (bits.nodes[name].value * length for name in ARMS)
    count = len(d1)

    def hand(moves: dict[str, np.ndarray]) -> np.ndarray:
        return Real(bits, moves).points(d1, d2)[1]

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

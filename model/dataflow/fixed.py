# SPDX-License-Identifier: Apache-2.0
"""Layer 4 of the model: every node of the RTL in integers, bit for bit.  Layers 1 to 3 are :mod:`model.reference`.

A node's value is an int64 array over targets (an object array of Python integers where it exceeds 64 bits).  No result
depends on floating point: a product or sum is computed exactly, then rounded once; division and root are rounded down.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..io.flags import BAD_HAND, SATURATED
from ..io.words import FIELDS
from .datapaths import DEFAULT, MODELS
from .nodes import Dataflow, Limits, Node

FIFO_CLOCKS = 2
"""Clocks that the output FIFO of ``ik_axis`` adds to the latency of a pipelined datapath: memory, output register."""


@lru_cache(maxsize=64)
def dataflow(datapath: str, width: int, limits: tuple[tuple[int, int], ...] | None = None) -> Dataflow:
    """Return the dataflow of a datapath at a word length; ``limits`` (of the joints) are only for the whole arm."""
    path = MODELS[datapath]
    flow = Dataflow(width, path.widths, path.tile, limits)
    path.flow(flow, flow.inputs((*path.inputs, *path.side)))
    if path.times:
        times = path.times(width)
        for name, node in flow.nodes.items():
            node.time = times.get(name, -1)
    return flow


@dataclass(frozen=True)
class Answer:
    """Outputs of a datapath for N targets.  ``results``: words (N, 6), or (N, 17) for the whole arm, in the order of
    :attr:`.Datapath.results`; ``flags`` (N,); ``nodes``: name -> node, with its words in ``value``."""

    results: np.ndarray
    flags: np.ndarray
    nodes: dict[str, Node]

    @property
    def shown(self) -> list[Node]:
        """Nodes that the RTL has, with their words."""
        return [node for node in self.nodes.values() if node.in_rtl]


def run(words: np.ndarray, width: int, datapath: str = DEFAULT, branch=0, limits: Limits | None = None) -> Answer:
    """Run N targets through a datapath.  ``words``: (N, 6), or (N, 11) for the whole arm, in the order of its inputs.

    Only for the whole arm: ``branch`` is a number from 0 to 7 or an array (N,); ``limits`` are seven pairs of words
    (low, high), by default no limits.  Raises ValueError if the datapath does not support ``width``.
    """
    path = MODELS[datapath]
    flow = dataflow(datapath, width, limits if limits is None else tuple((int(low), int(high)) for low, high in limits))
    values = dict(zip(path.inputs, np.asarray(words, dtype=np.int64).T, strict=True))
    values |= {name: np.broadcast_to(branch, len(words)) >> k & 1 for k, name in enumerate(path.side)}
    for name, node in flow.nodes.items():
        if name not in values:
            values[name] = node.evaluate(values)
    nodes = {name: replace(node, value=values[name]) for name, node in flow.nodes.items()}
    flags = sum(values[name] * np.int64(flag) for name, flag in path.flags.items())
    return Answer(np.stack([values[name] for name in path.results], axis=1), flags, nodes)


def nodes(datapath: str, width: int) -> dict[str, Node]:
    """Return the nodes of a datapath that its RTL has, in dataflow order, with their formats and clocks."""
    return {name: node for name, node in dataflow(datapath, width).nodes.items() if node.in_rtl}


def latency(datapath: str, width: int) -> int:
    """Return the clocks of ``ik_axis`` from a target's input to its result's output, without stalls."""
    return max(node.time for node in nodes(datapath, width).values()) + MODELS[datapath].behind


def of_hands(words: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return, for hand poses (the whole arm's input words (N, 11)), the core's input words (N, 6) and the flags (N,)
    ``BAD_HAND`` and ``SATURATED``."""
    answer = run(words, width, "arm")
    return np.stack([answer.nodes[name].value for name in FIELDS], axis=1), answer.flags & (BAD_HAND | SATURATED)

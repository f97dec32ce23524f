# SPDX-License-Identifier: Apache-2.0
"""Monte Carlo runs of the paper's dataflow: words, errors and overflows observed at every node."""

from dataclasses import dataclass, field

import numpy as np

from ..bounds.predict import Real
from ..bounds.tolerances import REGULAR_DISTANCE
from ..dataflow import fixed
from ..dataflow.nodes import Node
from .scoring import singular_distance
from .stimuli import edges, random_reachable, unreachable
from .words import from_words

CHUNK = 20000  # targets in one chunk


def chunk(number: int, count: int, width: int, seed: int) -> np.ndarray:
    """Return the ``number``-th chunk of random targets: 3/4 in reach, 1/8 clamped, 1/8 most likely to overflow."""
    seed += 1000003 * number
    parts = [unreachable(count // 8, width, seed), edges(count // 8, width, seed)]
    parts.append(random_reachable(count - sum(map(len, parts)), width, seed))
    return np.concatenate(parts)


@dataclass
class Seen:
    """Observations of one node: words, and errors against double precision in ulps."""

    low: int
    high: int
    worst: float = 0.0
    count: int = 0


@dataclass
class Observed:
    """Observations of all nodes.

    * beyond: number of targets, not observed otherwise, in which a node is beyond its format; first: the first of them
    """

    nodes: dict[str, Seen] = field(default_factory=dict)
    beyond: dict[str, int] = field(default_factory=dict)
    first: dict[str, list[int]] = field(default_factory=dict)
    targets: int = 0


def shown(nodes: dict[str, Node]) -> list[str]:
    """Return the nodes of the table: all but the one-bit decisions."""
    return [name for name, node in nodes.items() if node.format.width > 1]


def observe(into: Observed, words: np.ndarray, width: int) -> None:
    """Run targets in words and in double precision; add ranges and errors to ``into``."""
    bits = fixed.run(words, width, "paper").bits
    clamped = np.asarray(bits.nodes["clamp"].value).astype(bool)
    good = np.ones(len(words), dtype=bool)
    for name, node in bits.nodes.items():
        out = (node.value < node.format.low) | (node.value > node.format.high)
        out = np.broadcast_to(np.asarray(out | bits.overflow.get(name, False)).astype(bool), good.shape)
        if node.limited:
            out = out & ~clamped & node.limited.clamped
        out = out & good
        if out.any():
            into.beyond[name] = into.beyond.get(name, 0) + int(out.sum())
            into.first.setdefault(name, words[np.argmax(out)].tolist())
            good = good & ~out
    with np.errstate(all="ignore"):
        real = Real(bits, {}).values
    into.targets += len(words)
    regular = good & ~clamped
    asked = from_words(words[regular], 0, width, "random")
    regular[regular] = singular_distance(asked) >= REGULAR_DISTANCE
    for name in shown(bits.nodes):
        node = bits.nodes[name]
        value = np.broadcast_to(node.value, good.shape)
        seen = into.nodes.setdefault(name, Seen(1 << 80, -(1 << 80)))
        seen.low = min(seen.low, int(value[good].min()))
        seen.high = max(seen.high, int(value[good].max()))
        if node.error == (0.0, 0.0) and node.section == "guard" or not node.format.signed and node.format.frac == 0:
            continue
        exact = np.broadcast_to(np.asarray(real[name], dtype=np.float64), good.shape)[regular] / node.format.ulp
        error = np.abs(value[regular].astype(np.float64) - exact)
        seen.worst = max(seen.worst, float(error.max(initial=0.0)))
        seen.count += len(error)


def monte_carlo(targets: int, width: int, seed: int, step=lambda done: None) -> Observed:
    """Observe ``targets`` random targets, chunk by chunk."""
    result = Observed()
    for number, start in enumerate(range(0, targets, CHUNK)):
        # A chunk is always generated in full, so that a smaller run is the start of a larger one.
        observe(result, chunk(number, CHUNK, width, seed)[: targets - start], width)
        step(result.targets)
    return result

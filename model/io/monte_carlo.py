# SPDX-License-Identifier: Apache-2.0
"""Monte Carlo runs of the paper's dataflow: words, errors and overflows observed at every node."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..bounds.predict import Real
from ..bounds.tolerances import REGULAR_DISTANCE
from ..dataflow import fixed
from ..dataflow.nodes import WIDTHS, Node
from ..reference.kinematics import forward
from . import trajectories
from .flags import UNREACHABLE, expected_flags
from .scoring import singular_distance
from .stimuli import random_reachable, unreachable
from .words import DEFAULT_D1, DEFAULT_D2, Targets, from_words, result_values, scale_exponent, to_words

CHUNK = 20000
"""Targets in one chunk."""


# -- targets ---------------------------------------------------------------------------------------------------------


def edges(count: int, width: int, seed: int) -> np.ndarray:
    """Return reachable targets whose words are most likely to be too short: arms that fill their words with a target a
    few lsb from the shoulder, and a forearm of a few lsb on an upper arm along the z axis."""
    random = np.random.default_rng((seed, width, 5))
    top = (1 << (width - 1)) - 1
    near = np.arange(count) % 2 == 0
    small = np.exp2(random.uniform(0, width / 2, count)).astype(np.int64)
    # target near the shoulder
    position = np.rint(random.normal(size=(count, 3)) * small[:, None] * 0.5).astype(np.int64)
    length = np.floor(np.sqrt((position.astype(np.float64) ** 2).sum(axis=1))).astype(np.int64)
    d2 = random.integers(1 << (width - 3), top - 2 * small.max(), count)
    d1 = d2 + np.rint(length * random.choice([-1.0, 1.0, 0.5, 0.0], count)).astype(np.int64)
    # a long upper arm along z
    d2 = np.where(near, d2, small)
    d1 = np.where(near, d1, top - small - random.integers(0, 3, count))
    direction = random.normal(size=(count, 3))
    direction *= (small * random.uniform(0, 1, count) / np.linalg.norm(direction, axis=1))[:, None]
    arm = np.column_stack([np.zeros((count, 2)), random.choice([-1.0, 1.0], count) * d1])
    position = np.where(near[:, None], position, np.rint(direction + arm).astype(np.int64))
    phi = random.integers(-top - 1, top + 1, count)
    rows = np.column_stack([np.clip(position, -top - 1, top), phi, d1, d2])
    return rows[expected_flags(rows, width) & UNREACHABLE == 0]


def chunk(number: int, count: int, width: int, seed: int) -> np.ndarray:
    """Return the ``number``-th chunk of random targets: 3/4 in reach, 1/8 clamped, 1/8 from :func:`edges`."""
    own = seed + 1000003 * number
    parts = [unreachable(count // 8, width, own), edges(count // 8, width, own)]
    parts.append(random_reachable(count - sum(map(len, parts)), width, own))
    return np.concatenate(parts)


REACH = 1.9
"""d1 + d2 of the arms of random regular poses, in the core's unit: nearly the largest that its words hold."""


def default_arm() -> tuple[float, float]:
    """Return d1 and d2 of the default arm in the core's unit, scaled as its targets are; equal at all word lengths."""
    exponent = scale_exponent(trajectories.make(trajectories.DEFAULT), WIDTHS[-1])
    return math.ldexp(DEFAULT_D1, exponent), math.ldexp(DEFAULT_D2, exponent)


def regular_poses(count: int, seed: int, arm: tuple[float, float] | None = None) -> Targets:
    """Return poses at least 0.2 rad from every singular one: of an ``arm`` d1, d2, or of arms with d1 + d2 =
    :data:`REACH` and shares of 30 to 70 %."""
    random = np.random.default_rng((seed, 6))
    columns = np.zeros((6, 0))
    while columns.shape[1] < count:
        if arm:
            d1, d2 = (np.full(2 * count, length) for length in arm)
        else:
            d1 = REACH * random.uniform(0.3, 0.7, 2 * count)
            d2 = REACH - d1
        p = random.normal(size=(3, 2 * count))
        p *= random.uniform(np.abs(d1 - d2), d1 + d2) / np.linalg.norm(p, axis=0)
        rows = np.vstack([p, random.uniform(-np.pi, np.pi, 2 * count), d1, d2])
        far = singular_distance(Targets("regular", *rows)) >= REGULAR_DISTANCE
        columns = np.hstack([columns, rows[:, far]])
    return Targets("regular", *columns[:, :count])


# -- Monte Carlo -----------------------------------------------------------------------------------------------------


@dataclass
class Seen:
    """Observations of one node: words, and errors against double precision in ulps."""

    low: int
    high: int
    worst: float = 0.0
    squares: float = 0.0
    count: int = 0

    @property
    def rms(self) -> float:
        """Root mean square error."""
        return float(np.sqrt(self.squares / self.count)) if self.count else 0.0


@dataclass
class Observed:
    """Observations of all nodes.  Targets with a node beyond its format are only counted, in ``beyond``."""

    nodes: dict[str, Seen] = field(default_factory=dict)
    beyond: dict[str, int] = field(default_factory=dict)
    first: dict[str, list[int]] = field(default_factory=dict)
    targets: int = 0
    regular: int = 0


def shown(nodes: dict[str, Node]) -> list[str]:
    """Return the nodes of the table: all but the one-bit decisions."""
    return [name for name, node in nodes.items() if node.format.width > 1]


def observe(into: Observed, words: np.ndarray, width: int) -> None:
    """Run targets through the bit-true model and in double precision; add ranges and errors to ``into``."""
    bits = fixed.run(words, width).bits
    clamped = np.asarray(bits.nodes["clamp"].value).astype(bool)
    good = np.ones(len(words), dtype=bool)
    for name, node in bits.nodes.items():
        out = (node.value < node.format.low) | (node.value > node.format.high)
        out = np.broadcast_to(np.asarray(out | bits.overflow.get(name, False)).astype(bool), good.shape)
        if node.facts.limited:
            out = out & ~clamped & node.facts.limited.clamped
        out = out & good
        if out.any():
            into.beyond[name] = into.beyond.get(name, 0) + int(out.sum())
            into.first.setdefault(name, words[np.argmax(out)].tolist())
            good = good & ~out
    with np.errstate(all="ignore"):
        real = Real(bits, {}).nodes
    into.targets += len(words)
    regular = good & ~clamped
    asked = from_words(words[regular], 0, width, "random")
    regular[regular] = singular_distance(asked) >= REGULAR_DISTANCE
    into.regular += int(regular.sum())
    for name in shown(bits.nodes):
        node = bits.nodes[name]
        value = np.broadcast_to(node.value, good.shape)
        seen = into.nodes.setdefault(name, Seen(1 << 80, -(1 << 80)))
        seen.low = min(seen.low, int(value[good].min()))
        seen.high = max(seen.high, int(value[good].max()))
        if node.error == (0.0, 0.0) and node.section == "guard" or not node.format.signed and node.format.frac == 0:
            continue
        exact = np.broadcast_to(np.asarray(real[name].value, dtype=np.float64), good.shape)[regular] / node.format.ulp
        error = np.abs(value[regular].astype(np.float64) - exact)
        seen.worst = max(seen.worst, float(error.max(initial=0.0)))
        seen.squares += float(np.sum(error**2))
        seen.count += len(error)


def monte_carlo(targets: int, width: int, seed: int, step=lambda done: None) -> Observed:
    """Observe ``targets`` random targets, chunk by chunk."""
    result = Observed()
    for number, start in enumerate(range(0, targets, CHUNK)):
        # A chunk is always generated in full, so that a smaller run is the start of a larger one.
        observe(result, chunk(number, CHUNK, width, seed)[: targets - start], width)
        step(result.targets)
    return result


# -- the hand --------------------------------------------------------------------------------------------------------


def hand_errors(width: int, poses: Targets) -> np.ndarray:
    """Return the distance of the hand from the unrounded target / reach."""
    values = result_values(fixed.run(to_words(poses, width, 0)[0], width).results, width)
    _, wrist = forward(values[:, :4], values[:, 4:], poses.d1, poses.d2)
    return np.linalg.norm(wrist - poses.position, axis=1) / poses.reach

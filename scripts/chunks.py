# SPDX-License-Identifier: Apache-2.0
"""Chunks of random targets through the core on several processes, in order, until one has a failure."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from scripts.second import opinions
from scripts.spread import spread
from tb.core.random_targets import CHUNK, Core, Failure, Found, chunk, judge
from tb.sim.simulate import SimulationError


def named(seed: int | None) -> str:
    """What the chunks are of, for the user."""
    return "all targets of special words" if seed is None else f"seed {seed}"


@dataclass(frozen=True)
class Chunk:
    """What became of a chunk: its first target, its words, what :func:`judge` says of them."""

    first: int
    words: np.ndarray
    found: Found
    failures: list[Failure]
    hand: np.ndarray


def piece(core: Core, seed: int | None, end: int, against: Path | None, number: int) -> Chunk:
    """Chunk `number` as far as target `end`."""
    start = number * CHUNK
    words = chunk(number, core.width, seed)[: end - start]
    others = partial(opinions, against) if against else None
    return Chunk(start, words, *judge(core, words, range(start, start + len(words)), others))


class Chunks:
    """The `targets` from chunk `first` of a seed, or of all of special words; `against`: the C that has a say, too.

    found: of those that passed; number: the chunk that is next."""

    def __init__(self, core: Core, seed: int | None, first: int, targets: int, against: Path | None = None):
        self.core, self.seed, self.number, self.against = core, seed, first, against
        self.end = first * CHUNK + targets
        self.found = Found()

    def run(self, jobs: int, done: Callable[[int], None]) -> Chunk | None:
        """The first chunk with a failure, if there is one; calls `done` with the number of targets that passed.
        Raises SimulationError if a simulation breaks off."""
        numbers = range(self.number, -(-self.end // CHUNK))
        try:
            with spread(min(jobs, len(numbers))) as each:
                for run in each(partial(piece, self.core, self.seed, self.end, self.against), numbers):
                    if run.failures:
                        return run
                    self.number += 1
                    self.found += run.found
                    done(self.found.targets)
        except BrokenProcessPool:
            where = f"in chunk {self.number} of {named(self.seed)} or later"
            raise SimulationError(f"a process broke off, {where}") from None
        return None

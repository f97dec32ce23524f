# SPDX-License-Identifier: Apache-2.0
"""Chunks of random targets through the core on several processes, in order, until one has a failure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from scripts.parallel import BrokenOffError, shared
from scripts.second import opinions
from tb.core.random_targets import CHUNK, Core, Failure, Found, chunk, judge


def named(seed: int | None) -> str:
    """What the chunks are of, for the user."""
    return "all targets of special words" if seed is None else f"seed {seed}"


@dataclass(frozen=True)
class Chunk:
    """What became of a chunk: its first target, what :func:`judge` says of it; words and hand errors if it fails."""

    first: int
    words: np.ndarray
    found: Found
    failures: list[Failure]
    hand: np.ndarray


def piece(core: Core, seed: int | None, end: int, against: bool, number: int) -> Chunk:
    """Chunk `number` as far as target `end`."""
    start = number * CHUNK
    words = chunk(number, core.width, seed)[: end - start]
    core = core if core.program else built(core)
    others = opinions if against else None
    found, failures, hand = judge(core, words, range(start, start + len(words)), others)
    kept = slice(None if failures else 0)
    return Chunk(start, words[kept], found, failures, hand[kept])


@cache
def built(core: Core) -> Core:
    """The same with the program of this machine, which may be another one than that of the command."""
    return Core.built(core.sim, core.datapath, core.width)


class Chunks:
    """The `targets` from chunk `first` of a seed, or of all of special words; `against`: the C has a say, too.

    found: of those that passed; number: the chunk that is next."""

    def __init__(self, core: Core, seed: int | None, first: int, targets: int, against: bool = False):
        self.core, self.seed, self.number, self.against = core, seed, first, against
        self.end = first * CHUNK + targets
        self.found = Found()

    def run(self, jobs: int, done: Callable[[int], None], farm: str | None = None) -> Chunk | None:
        """The first chunk with a failure, if there is one; calls `done` with the number of targets that passed.
        Raises SimulationError if a simulation breaks off."""
        numbers = range(self.number, -(-self.end // CHUNK))
        try:
            with shared(min(jobs, len(numbers)), farm) as each:
                for run in each(partial(piece, self.core, self.seed, self.end, self.against), numbers):
                    if run.failures:
                        return run
                    self.number += 1
                    self.found += run.found
                    done(self.found.targets)
        except BrokenOffError as error:
            raise BrokenOffError(f"{error}, in chunk {self.number} of {named(self.seed)} or later") from None
        return None

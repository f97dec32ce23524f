# SPDX-License-Identifier: Apache-2.0
"""A row of docs/generated/proofs.md: one proof, its runner, and the digest of the proved code."""

import hashlib
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter

Say = Callable[[str], None]


def digest_of(*texts: str) -> str:
    """Return a short digest of texts."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def no_circle(rests: dict[str, Iterable[str]]) -> None:
    """Raise RuntimeError if claims rest on each other; ``rests`` maps a claim to those on which it rests."""
    try:
        tuple(TopologicalSorter(rests).static_order())
    except CycleError as error:
        raise RuntimeError(f"claims rest on each other: {' <- '.join(error.args[1])}") from None


@dataclass
class Outcome:
    """Result of a proof: ``result`` for the page, one line for each failure, and a full table for build/."""

    result: str = ""
    seconds: float = 0.0
    failed: list[str] = field(default_factory=list)
    table: list[list[str]] = field(default_factory=list)


@dataclass(frozen=True)
class Task:
    """A proof: ``digest`` covers everything that it proves and assumes, not the code that runs it."""

    name: str
    what: str
    engine: str
    digest: Callable[[], str]
    run: Callable[[Executor, Say], Outcome]

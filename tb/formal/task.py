# SPDX-License-Identifier: Apache-2.0
"""Proof for `make formal` and docs/generated/proofs.md: its runner, and the digest of the proved code."""

import hashlib
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter

Say = Callable[[str], None]


def digest_of(*texts: str) -> str:
    """Return the first 16 hex digits of the SHA-256 of texts."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def no_circle(rests: dict[str, Iterable[str]]) -> None:
    """Raise RuntimeError if claims use each other in a circle; ``rests`` maps a claim to the claims that it uses."""
    try:
        tuple(TopologicalSorter(rests).static_order())
    except CycleError as error:
        raise RuntimeError(f"claims rest on each other: {' <- '.join(error.args[1])}") from None


@dataclass
class Outcome:
    """Result of a proof: ``result`` for the page, ``failed`` with a line per failure, the full ``table`` for build/."""

    result: str = ""
    seconds: float = 0.0
    failed: list[str] = field(default_factory=list)
    table: list[list[str]] = field(default_factory=list)


@dataclass(frozen=True)
class Task:
    """Proof to run; ``digest`` covers everything that it proves and assumes, but not the code that runs it."""

    name: str
    what: str
    engine: str
    digest: Callable[[], str]
    run: Callable[[Executor, Say], Outcome]

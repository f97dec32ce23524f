# SPDX-License-Identifier: Apache-2.0
"""A row of docs/generated/proofs.md: one proof, its runner, and the digest of the proved code."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, field

Say = Callable[[str], None]


def digest_of(*texts: str) -> str:
    """Return a short digest of texts."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


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

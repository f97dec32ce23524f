# SPDX-License-Identifier: Apache-2.0
"""Proof for `make formal` and docs/generated/proofs.md: its runner, and the digest of the proved code.

A proof by z3 about numbers is a list of named questions, each with a claim. It passes if z3 proves all claims, can
satisfy their assumptions, and finds a counterexample to a false claim.
"""

import hashlib
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

from tb.formal.tools import Answer

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
    """Proof to run; ``digest`` covers all its claims and assumptions, but not the code that runs the proof."""

    name: str
    what: str
    engine: str
    digest: Callable[[], str]
    run: Callable[[Executor, Say], Outcome]


class Question(NamedTuple):
    """Question to z3. ``ask`` returns "unsat" if a claim holds; ``meet`` returns "sat" if its assumptions can hold."""

    name: str
    says: str
    ask: Callable[[], Answer]
    meet: Callable[[], Answer] | None = None


def answer(question: Question) -> tuple[float, str]:
    """Ask a question; return the seconds for its claim, and the problem (an empty text if the claim is proved)."""
    claim = question.ask()
    problem = "" if claim.said == "unsat" else {"sat": "counterexample"}.get(claim.said, claim.said)
    if not problem and question.meet and (met := question.meet().said) != "sat":
        problem = f"its assumptions cannot be met: {met}"
    return claim.seconds, problem


def run(questions: Iterable[Question], wrong: Iterable[Question], pool: Executor, say: Say) -> Outcome:
    """Ask all questions of a proof. At least one question of ``wrong`` (a seeded bug) must have a counterexample."""
    start, asked = time.monotonic(), list(questions)
    outcome = Outcome(f"{len(asked)} questions", table=[["question", "meaning", "seconds"]])
    for question, (seconds, problem) in zip(asked, pool.map(answer, asked), strict=True):
        outcome.table.append([question.name, question.says, f"{seconds:.1f}"])
        if problem:
            outcome.failed.append(f"{question.name}: {problem}")
            say(f"     {outcome.failed[-1]}")
    said = [question.ask().said for question in wrong]
    if "sat" not in said:
        outcome.failed.append(f"seeded bug: no counterexample: {', '.join(said) or 'no question'}")
    outcome.seconds = time.monotonic() - start
    return outcome

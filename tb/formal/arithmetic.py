# SPDX-License-Identifier: Apache-2.0
"""Proofs by z3 about numbers: named questions, and one with a seeded bug that must have a counterexample.

Each question's assumptions are checked to be satisfiable.
"""

import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass

from tb.formal.task import Outcome, Say
from tb.formal.unrolled import Answer


def _number(value: int) -> str:
    return str(value) if value >= 0 else f"(- {-value})"


def inside(name: str, low: int, high: int) -> str:
    """Return low <= name <= high."""
    return f"(<= {_number(low)} {name} {_number(high)})"


def word(name: str, width: int) -> str:
    """Return the condition that an integer fits a signed word of ``width`` bits."""
    return inside(name, -(1 << (width - 1)), (1 << (width - 1)) - 1)


@dataclass(frozen=True)
class Question:
    """A question: ``ask`` decides whether the claim holds, ``meet`` whether its assumptions are satisfiable."""

    name: str
    says: str
    ask: Callable[[], Answer]
    meet: Callable[[], Answer] | None = None


def answer(question: Question) -> tuple[float, str]:
    """Decide a question; return the seconds, and the problem if it is not proved."""
    claim = question.ask()
    problem = "" if claim.said == "unsat" else {"sat": "counterexample"}.get(claim.said, claim.said)
    if not problem and question.meet and (met := question.meet().said) != "sat":
        problem = f"its assumptions cannot be met: {met}"
    return claim.seconds, problem


def run(questions: Iterable[Question], wrong: Iterable[Question], pool: Executor, say: Say) -> Outcome:
    """Decide all questions of a proof; one of ``wrong``, which have a seeded bug, must have a counterexample."""
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

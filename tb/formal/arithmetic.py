# SPDX-License-Identifier: Apache-2.0
"""Runner of the proofs by z3 about numbers. A proof is a list of named questions, each with a claim.

A proof passes if z3 proves all claims, can satisfy their assumptions, and finds a counterexample to a false claim.
"""

import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from typing import NamedTuple

from tb.formal.task import Outcome, Say
from tb.formal.unrolled import Answer


def _number(value: int) -> str:
    return str(value) if value >= 0 else f"(- {-value})"


def inside(name: str, low: int, high: int) -> str:
    return f"(<= {_number(low)} {name} {_number(high)})"


def word(name: str, width: int) -> str:
    """Return the SMT-LIB condition that the integer ``name`` fits a signed word of ``width`` bits."""
    return inside(name, -(1 << (width - 1)), (1 << (width - 1)) - 1)


class Question(NamedTuple):
    """Question to z3. ``ask`` returns "unsat" if the claim holds, ``meet`` "sat" if its assumptions are satisfiable."""

    name: str
    says: str
    ask: Callable[[], Answer]
    meet: Callable[[], Answer] | None = None


def answer(question: Question) -> tuple[float, str]:
    """Ask a question; return the seconds for its claim and the problem, an empty text if the claim is proved."""
    claim = question.ask()
    problem = "" if claim.said == "unsat" else {"sat": "counterexample"}.get(claim.said, claim.said)
    if not problem and question.meet and (met := question.meet().said) != "sat":
        problem = f"its assumptions cannot be met: {met}"
    return claim.seconds, problem


def run(questions: Iterable[Question], wrong: Iterable[Question], pool: Executor, say: Say) -> Outcome:
    """Ask all questions of a proof; at least one of ``wrong``, which have a seeded bug, must have a counterexample."""
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

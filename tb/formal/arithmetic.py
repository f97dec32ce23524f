# SPDX-License-Identifier: Apache-2.0
"""Proofs by z3 about numbers: what ranges, dividers and cores rest on besides the proofs on the Verilog.

A part (:class:`Part`) asks questions by name and has seeded bugs, texts of the model or the RTL that become
another one, for each of which a question named beforehand must have a counterexample. What a question assumes is
asked as well: whether it can be met.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, field

from tb.formal.unrolled import Answer
from tb.sim.seeded_bugs import Bug

Say = Callable[[str], None]

ELSEWHERE = re.compile(", [WF]=")
"""In a question's name: of another width than the full one."""


@dataclass
class Asked:
    """A question: its name, what it says, what it rests on, and what came out; ``problem`` is empty if it is proved."""

    name: str
    says: str
    rests: str = ""
    seconds: float = 0.0
    problem: str = ""


@dataclass
class Found:
    """What came out of a part: its questions, bugs with their seconds, and a line for all that failed."""

    asked: list[Asked] = field(default_factory=list)
    bugs: list[tuple[Bug, float]] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    seconds: float = 0.0


@dataclass(frozen=True)
class Question:
    """One question: ``ask`` says whether the claim holds, ``meet`` whether what it assumes can be met."""

    name: str
    says: str
    rests: str
    ask: Callable[[], Answer]
    meet: Callable[[], Answer] | None = None


@dataclass(frozen=True)
class Part:
    """A part of the proofs: its questions, those of a seeded bug, the bugs; and what a page says of it."""

    name: str
    title: str
    about: str
    questions: Callable[[], Iterable[Question]]
    seeded: Callable[[Bug], Iterable[Question]]
    bugs: tuple[Bug, ...]

    @staticmethod
    def elsewhere(found: Found) -> list[Asked]:
        """The questions of other widths than the full one."""
        return [asked for asked in found.asked if ELSEWHERE.search(asked.name)]


def answer(question: Question) -> Asked:
    """Asks it."""
    found = question.ask()
    asked = Asked(question.name, question.says, question.rests, found.seconds)
    if found.said != "unsat":
        asked.problem = {"sat": "counterexample"}.get(found.said, found.said)
    elif question.meet and (met := question.meet().said) != "sat":
        asked.problem = f"can what is assumed be met? {met}"
    return asked


def survives(part: Part, bug: Bug) -> str:
    """Why no question fails on a seeded bug as it should, or an empty text."""
    try:
        wanted = [question for question in part.seeded(bug) if question.name == bug.fails]
    except LookupError as error:
        return f"cannot be seeded: {error}"
    if not wanted:
        return f"there is no question {bug.fails!r}"
    said = [question.ask().said for question in wanted]
    return "" if "sat" in said else f"survives: {bug.fails}: {', '.join(said)}"


def run(part: Part, pool: Executor, say: Say) -> Found:
    """All questions of a part, and its bugs."""
    found, start = Found(), time.monotonic()
    found.asked = list(pool.map(answer, part.questions()))
    found.failed = [f"{part.name}: {asked.name}: {asked.problem}" for asked in found.asked if asked.problem]

    def seeded(bug: Bug) -> tuple[str, float]:
        began = time.monotonic()
        return survives(part, bug), time.monotonic() - began

    proved = f"{len(found.asked) - len(found.failed)} of {len(found.asked)} questions"
    say(f"{'FAIL' if found.failed else 'ok  '} {part.name:<16} {proved}, {time.monotonic() - start:.0f} s")
    for bug, (wrong, took) in zip(part.bugs, pool.map(seeded, part.bugs), strict=True):
        found.bugs.append((bug, took))
        if wrong:
            found.failed.append(f"{part.name}: seeded bug '{bug.what}': {wrong}")
        else:
            say(f"ok   {part.name:<16} fails as it should: {bug.what} ({bug.fails}) {took:.1f} s")
    for line in found.failed:
        say(f"FAIL {line}")
    found.seconds = time.monotonic() - start
    return found

# SPDX-License-Identifier: Apache-2.0
"""Questions to z3 about nodes, in integers or bit vectors, and their answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product

from tb.formal.netlist import Operand
from tb.formal.range_table import Range
from tb.formal.unrolled import Answer, ask


@dataclass(frozen=True)
class Claim:
    """An answered question: property, engine, depth of the induction, answer."""

    name: str
    engine: str
    depth: int
    answer: Answer

    @property
    def holds(self) -> bool:
        return self.answer.said == "unsat"


@dataclass
class Row:
    """Result for one node: the reason why it `fits` and is in its `range`; `problem` is empty if it is proved."""

    node: str
    module: str = ""
    parameters: str = ""
    operands: str = ""
    fits: str = ""
    range: str = ""
    engine: str = ""
    depth: int | None = None
    seconds: float = 0.0
    problem: str = ""
    sources: list[Operand] = field(default_factory=list)


@dataclass
class Lemma:
    """Properties of an operator with its parameters that need no ranges."""

    module: str
    parameters: tuple
    claims: list[Claim] = field(default_factory=list)

    @property
    def problem(self) -> str:
        bad = [f"{c.name}: {c.answer.said}" for c in self.claims if not c.holds]
        return f"{self.module}: {', '.join(bad)}" if bad else ""


def spell(parameters: tuple) -> str:
    """Return AW=32, BW=32, ..."""
    return ", ".join(f"{name}={value}" for name, value in parameters)


# -- integers --------------------------------------------------------------------------------------------------------


def _number(value: int) -> str:
    return str(value) if value >= 0 else f"(- {-value})"


def integers(names: str, facts: list[str], claim: str) -> str:
    """Return the formula "the facts hold for these integers and the claim does not"."""
    lines = [f"(declare-const {name} Int)" for name in names.split()]
    return "\n".join([*lines, *(f"(assert {fact})" for fact in facts), f"(assert (not {claim}))"])


def conjunction(names: str, facts: list[str], claims: list[str]) -> str:
    return integers(names, facts, f"(and {' '.join(claims)})")


def inside(name: str, low: int, high: int) -> str:
    """Return low <= name <= high."""
    return f"(<= {_number(low)} {name} {_number(high)})"


def word(name: str, width: int) -> str:
    """Return the condition that a number fits a signed word of ``width`` bits."""
    return inside(name, -(1 << (width - 1)), (1 << (width - 1)) - 1)


def floor_of(quotient: str, dividend: str, shift: int) -> str:
    """Return quotient = floor(dividend / 2^shift)."""
    scaled = f"(* {1 << shift} {quotient})"
    return f"(and (<= {scaled} {dividend}) (< {dividend} (+ {scaled} {1 << shift})))"


def corners(a: Range, b: Range, square: bool) -> tuple[int, int]:
    """Return the least and largest product; with `square`, of a number with itself."""
    ends = [x * y for x in (a.low, a.high) for y in (b.low, b.high)]
    if square:
        return (0 if a.low <= 0 <= a.high else min(ends[0], ends[3])), max(ends[0], ends[3])
    return min(ends), max(ends)


@dataclass(frozen=True)
class Question:
    """Question about one node: `fits` and `in_range` follow from `facts`, and from `rule` where needed."""

    engine: str
    depth: int | None
    text: Callable[[list[str], list[str]], str]  # of assumptions and claims
    facts: list[str]
    rule: list[str]
    fits: list[str]
    in_range: str
    cases: tuple[str, ...] = ()  # conditions that split the question

    def ask(self, assumed: list[str], claims: list[str]) -> Answer:
        """Return z3's answer: "unsat" only if every case is."""
        seconds = 0.0
        for values in product((True, False), repeat=len(self.cases)):
            case = [c if value else f"(not {c})" for c, value in zip(self.cases, values, strict=True)]
            answer = ask(self.text([*assumed, *case], claims))
            seconds += answer.seconds
            if answer.said != "unsat":
                break
        return Answer(answer.said, seconds)

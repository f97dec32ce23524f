# SPDX-License-Identifier: Apache-2.0
"""Clocks in which a step of the fold datapath reads, computes and writes, counted from its issue.

A program repeats with the period of a lap, and around the lap's end two targets are in flight.  Clocks here count from
the start of the target's own lap: modulo the period they are places in the program.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from .steps import ALWAYS, NO_COUNT, POWER, Group, Pick, Step

BEND, READ, ROW, ADD, SUM, WRITE, NORM = -1, 0, 1, 3, 4, 5, 7
"""Clocks of a step, from its issue: read the row for c2; read the words; read the row for the addend; take the addend
and the product's sign; product ready; write T and take its sign; write the normalized word."""

FETCH = 3
"""Clocks from a step's place in the program to its issue."""

INPUTS = ("x", "y", "z", "phi", "d1", "d2")

ELBOW = ("qe_w", "qe_i")
"""Results that are constants where there is no elbow."""

CLOCKED = (ALWAYS, NO_COUNT, "")
"""Flags that depend on no earlier step."""


@dataclass(frozen=True)
class Placed:
    """Step with the clock of its issue."""

    at: int
    step: Step


@dataclass(frozen=True)
class Use:
    """Use of a word, flag or count in a clock."""

    of: str
    at: int


def word_of(operand: str | Pick) -> str:
    """Return the variable of an operand; both words of a pair share one."""
    return operand.pair if isinstance(operand, Pick) else operand


def row_reads(placed: Placed) -> list[int]:
    """Return the clocks in which the step reads a table row's argument."""
    bend = [placed.at + BEND] if placed.step.a is None else []
    return bend + [placed.at + ROW] * bool(placed.step.rows)


def word_reads(placed: Placed) -> list[Use]:
    """Return the words read and their clocks, without constants."""
    step, at = placed.step, placed.at
    operands = [word_of(o) for o in (step.a, step.b) if o is not None]
    uses = [Use(name, at + READ) for name in operands if name not in ("0", "1", "1/2", POWER)]
    return uses + [Use(step.rows[0].of, clock) for clock in row_reads(placed)]


def word_writes(placed: Placed) -> list[Use]:
    """Return the words written and their clocks."""
    step, at = placed.step, placed.at
    written = [Use(word_of(step.write.to), at + WRITE)] if step.write else []
    return written + ([Use(step.norm.to, at + NORM)] if step.norm else [])


def flag_uses(placed: Placed) -> list[Use]:
    """Return the flags needed and their clocks."""
    step, at = placed.step, placed.at
    uses = [Use(o.flag, at + READ) for o in (step.a, step.b) if isinstance(o, Pick)]
    uses += [Use(step.addend_by, at + ADD), Use(step.minus, at + ADD)]
    if step.write:
        uses.append(Use(step.write.double_by, at + WRITE))
        if isinstance(step.write.to, Pick):
            uses.append(Use(step.write.to.flag, at + WRITE))
    if step.result in ELBOW:
        uses += [Use("clamp", at + WRITE), Use("fold", at + WRITE)]
    return [use for use in uses if use.of]


EVENS = ("e_rho", "e_s", "e_far", "e_near", "e_1", "e_2", "e_q")
"""Count registers set by normalizations."""

ZEROS = {"e_rho": "on_axis", "e_s": "at_shoulder", "e_1": "no_1", "e_2": "no_2"}
"""Count register -> flag set when the normalized word was 0."""

MADE_OF = {
    "clamp": ("a_far<0", "b_near<0", "at_shoulder", "d1<0", "d2<0", "no_1", "no_2"),
    "fold": ("b_near<0", "at_shoulder", "d1<0", "d2<0", "no_1", "no_2"),
    "away": ("b_near<0", "d_dif<0", "d1<0", "d2<0", "no_1", "no_2"),
    "arm_swap": ("clamp", "away", "cos_a<0"),
    "minus": ("k_1<0",),
    "bad_length": ("d1<0", "d2<0", "no_1", "no_2"),
    "too_far": ("a_far<0", "d1<0", "d2<0", "no_1", "no_2"),
    "too_near": ("b_near<0", "d1<0", "d2<0", "no_1", "no_2"),
    "low": ("e_q",),
    "flags": ("clamp", "away", "on_axis"),
}
"""Flags derived from others; ``flags`` are those output with the results."""


def terms_of(flag: str) -> list[tuple[str, bool]]:
    """Split ``a & ~b`` or ``~b`` into its terms: a name, and whether it is negated."""
    return [(term.removeprefix("~"), term.startswith("~")) for term in flag.split(" & ")]


def roots_of(flag: str) -> set[str]:
    """Return the registers that a flag is made of."""
    if flag in CLOCKED:
        return set()
    roots = (map(roots_of, MADE_OF[term]) if term in MADE_OF else [{term}] for term, _ in terms_of(flag))
    return set().union(*itertools.chain.from_iterable(roots))


def flag_sets(placed: Placed) -> list[Use]:
    """Return the flag and count registers that the step sets and their clocks; usable one clock later."""
    step, at = placed.step, placed.at
    sets = [Use(step.sign, at + WRITE)] if step.sign else []
    if step.norm and step.norm.count:
        sets.append(Use(step.norm.count, at + NORM))
        if step.norm.count in ZEROS:
            sets.append(Use(ZEROS[step.norm.count], at + NORM))
    return sets


def first_count(placed: Placed) -> int:
    """Return the clock that adds the first term of a step's count; the last is added just before its use."""
    assert placed.step.count
    return placed.at + (WRITE if placed.step.norm else READ) - len(placed.step.count.terms)


def last_count(placed: Placed) -> int:
    """Return the last clock in which the count is needed."""
    return placed.at + (NORM if placed.step.norm else ADD)


@dataclass(frozen=True)
class Schedule:
    """Program schedule: the clocks of a lap, the clock in which each input is loaded, and the clock in which the first
    step of each group, which names the group, is issued."""

    period: int
    loads: dict[str, int]
    starts: dict[str, int]


def placed_steps(groups: list[Group], starts: dict[str, int]) -> list[Placed]:
    """Return all steps with their clocks, in order."""
    steps = [Placed(starts[group.name] + at, step) for group in groups for at, step in group.steps]
    return sorted(steps, key=lambda placed: placed.at)

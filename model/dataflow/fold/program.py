# SPDX-License-Identifier: Apache-2.0
"""Schedule encoded as program words: the operation of every part of the datapath in each clock.

Fields belong to clocks and not to steps: in one clock the memory reads for one step, the multiplier works for another,
and T of a third one is written.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from ...io.words import FIELDS as INPUTS
from ...io.words import RESULT_FIELDS
from . import steps as timing
from .lowering import Groups, Lowering, lower
from .steps import ADDENDS, ALWAYS, CUTS, HALF, NEVER, NO_COUNT, NORMS, ONE, POWER, ZERO, Pick, Placed, Selector


@dataclass(frozen=True)
class Schedule:
    """Program schedule: the clocks of a lap, the clock in which each input is loaded, and the clock in which the first
    step of each group, which names the group, is issued."""

    period: int
    loads: dict[str, int]
    starts: dict[str, int]


WIDTH = 24
"""A word length; steps and program are the same at all."""

PLACES = 64
"""Read/write words of the memory; an equal number of powers follows."""

WINDOWS = ("plain", "double", "low")
LASTS = ("inner", "root", "slope", "sine")
SOURCES = ("none", "sum", "normal", "input")
FUNCTIONS = ("root", "sine", "cosine")
PLACED_AS = ("", "root", "angle")
CARRIES = ("", "minus")
BASES = ("count", "1", "2", "4", "-2")


def codes() -> dict[str, tuple]:
    """Return field -> its codes; selectors, signs and counts in the order of the dataflow, inputs first."""
    lowering, groups = lower(WIDTH)
    steps = [step for group in groups.values() for _, step in group]
    fixed = (NEVER, ALWAYS, NO_COUNT)
    found = dict.fromkeys(s for step in steps for s in step.selectors if s not in fixed)
    order = sorted(found, key=lambda selector: selector.node not in INPUTS)

    def selectors(used, *first: Selector) -> tuple[Selector, ...]:
        return NEVER, *first, *(s for s in order if s in used)

    def picked(operands) -> tuple[Selector, ...]:
        return selectors({o.flag for o in operands if isinstance(o, Pick)})

    signs = [name for name in lowering.nodes if name in {step.sign for step in steps}]
    counts = "", *dict.fromkeys(normal.count for normal, _ in lowering.norms.values() if normal.count)
    return {
        "a_by": picked(step.a for step in steps), "b_by": picked(step.b for step in steps),
        "w_by": picked(step.write and step.write.to for step in steps),
        "s_by": selectors({step.addend_by for step in steps}),
        "minus_by": selectors({step.minus for step in steps}, ALWAYS, NO_COUNT),
        "r_function": FUNCTIONS, "b_place": PLACED_AS, "cut": CUTS, "s": ADDENDS, "carry": CARRIES, "window": WINDOWS,
        "last": LASTS, "sign": ("", *signs), "norm": ("", *NORMS), "source": SOURCES, "input": INPUTS,
        "result": ("", *RESULT_FIELDS), "e_set": counts, "n_base": BASES, "n_e": counts,
    }  # fmt: skip


CODES = codes()

PLAIN_BITS = {
    "a": 7, "b": 7, "b_count": 1, "r": 6, "a_bend": 1, "b_high": 1, "limit": 1, "w": 6, "n_minus": 1, "n_twice": 1,
    "last_input": 1, "hold": 1, "first_result": 1, "last_result": 1,
}  # fmt: skip
"""Numeric field -> bits."""

FIELDS = {name: max(1, (len(codes) - 1).bit_length()) for name, codes in CODES.items()} | PLAIN_BITS
"""Field -> bits."""


@dataclass
class Program:
    """Program words, one per clock of the lap, and the places of nodes and variables."""

    period: int
    clocks: list[dict[str, int]] = field(default_factory=list)
    places: dict[str, int] = field(default_factory=dict)
    steps: list[Placed] = field(default_factory=list)
    loads: dict[str, int] = field(default_factory=dict)

    def word(self, clock: int) -> int:
        """Return the packed fields of a clock, the first of :data:`FIELDS` lowest."""
        word = at = 0
        for name, bits in FIELDS.items():
            word |= self.clocks[clock][name] << at
            at += bits
        return word


class ConflictError(ValueError):
    """Field needed by two steps in the same clock."""


def lives(steps: list[Placed], loads: dict[str, int]) -> dict[str, tuple[int, int]]:
    """Return variable -> the first clock in which it is written and the last one in which it is read."""
    first: dict[str, int] = dict(loads)
    last: dict[str, int] = {}
    for placed in steps:
        for use in timing.word_writes(placed):
            first[use.of] = min(first.get(use.of, use.at), use.at)
            last[use.of] = max(last.get(use.of, use.at), use.at)
        for use in timing.word_reads(placed):
            last[use.of] = max(last.get(use.of, use.at), use.at)
    return {name: (clock, last.get(name, clock)) for name, clock in first.items()}


def allocate(steps: list[Placed], loads: dict[str, int], period: int) -> dict[str, int]:
    """Return variable -> its place; a pair takes an even place and the next.  Pairs are not shared."""
    operands = (o for p in steps for o in (p.step.a, p.step.b, p.step.write and p.step.write.to))
    doubles = {of.pair for of in operands if isinstance(of, Pick)}
    life = lives(steps, loads)
    taken: list[set[int]] = [set() for _ in range(PLACES)]
    places = {}
    for name in sorted(life, key=lambda n: (n not in doubles, life[n])):
        first, last = life[name]
        if last - first >= period:
            raise ConflictError(f"{name} lives {last - first} clocks of a lap of {period}")
        wanted = {clock % period for clock in range(first, last + 1)}
        if name in doubles:
            wanted = set(range(period))  # its second word may be a constant
        size = 2 if name in doubles else 1
        for place in range(0, PLACES, size):
            if not any(taken[place + k] & wanted for k in range(size)):
                for k in range(size):
                    taken[place + k] |= wanted
                places[name] = place
                break
        else:
            raise ConflictError(f"no place for {name}")
    return places


def encode(groups: Groups, of: Schedule) -> Program:
    """Return the program of a schedule."""
    steps = [Placed(of.starts[name] + at, step) for name, group in groups.items() for at, step in group]
    steps.sort(key=lambda placed: placed.at)
    loads, period = of.loads, of.period
    program = Program(period, [dict.fromkeys(FIELDS, 0) for _ in range(period)], {}, steps, loads)
    program.places = allocate(steps, loads, period)
    taken: set[tuple[int, str]] = set()

    def put(clock: int, **fields: int | str | Selector) -> None:
        for name, value in fields.items():
            if (clock % period, name) in taken:
                raise ConflictError(f"{name} is needed twice in clock {clock % period}")
            taken.add((clock % period, name))
            code = CODES[name].index(value) if isinstance(value, str | Selector) else int(value)
            if code >> FIELDS[name]:
                raise ConflictError(f"{name}: {value} has no code")
            program.clocks[clock % period][name] = code

    def operand(of) -> tuple[int, Selector]:
        if isinstance(of, Pick):
            return program.places[of.pair] + of.second, of.flag
        constants = {ZERO: PLACES + 63, ONE: PLACES + 1, HALF: PLACES + 2}
        return constants.get(of, program.places.get(of, 0)), NEVER

    for name, clock in loads.items():
        put(clock, source="input", input=name, w=program.places[name], w_by=NEVER)
    put(max(loads.values()), last_input=1)
    results = sorted((p for p in steps if p.step.result), key=lambda p: p.at)
    first, last = results[0].at + timing.WRITE, results[-1].at + timing.WRITE
    put(first - 1, hold=1)
    put(first, first_result=1)
    put(last, last_result=1)
    for placed in steps:
        t, step = placed.at, placed.step
        if step.a is not None:
            place, flag = operand(step.a)
            put(t, a=place, a_by=flag)
        place, flag = operand(step.b)
        put(t, b=place, b_by=flag, b_count=step.b == POWER)
        for row, clock in zip(reversed(step.rows * 2), reversed(timing.row_reads(placed)), strict=False):
            put(clock, r=program.places[row.of])
            put(clock + 1, r_function=row.function)
        function = {"root": "root", "sine": "angle", "cosine": "angle"}[step.rows[0].function] if step.place else ""
        put(t + 1, a_bend=step.a is None, b_place=function, b_high=step.place == "high")
        put(t + timing.ADD, cut=step.cut, s=step.addend, s_by=step.addend_by, minus_by=step.minus, carry=step.carry)
        w = step.write
        window = (str(w.double_by) or {1: "plain", 2: "double"}[w.window]) if w else ""
        if step.result:
            window = "double" if step.cut == "double" else "plain"
        put(
            t + timing.WRITE,
            window=window or "plain",
            limit=bool(w and w.limit),
            last=w.last if w else "inner",
            sign=step.sign,
            result=step.result,
            norm=step.norm.kind if step.norm else "",
        )
        if w:
            place, flag = operand(w.to)
            put(t + timing.WRITE, source="sum", w=place, w_by=flag)
        if step.norm:
            put(t + timing.NORM, source="normal", w=program.places[step.norm.to], w_by=NEVER, e_set=step.norm.count)
        if step.count:
            begin = timing.first_count(placed)
            for number, (factor, register) in enumerate(step.count.terms):
                base = str(step.count.base) if number == 0 else "count"
                put(begin + number, n_base=base, n_e=register, n_minus=factor < 0, n_twice=abs(factor) == 2)
    return program


SCHEDULE = Path(__file__).with_name("schedule.json")
"""Schedule found by `make schedule`."""


@cache
def schedule() -> Schedule:
    """Return the schedule on file."""
    return Schedule(**json.loads(SCHEDULE.read_text(encoding="utf-8")))


@cache
def program(width: int) -> tuple[Lowering, Program]:
    """Return the dataflow's steps at a word length, and the program of the schedule on file."""
    lowering, groups = lower(width)
    return lowering, encode(groups, schedule())

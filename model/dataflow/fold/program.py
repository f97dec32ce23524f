# SPDX-License-Identifier: Apache-2.0
"""Schedule encoded as program words: the operation of every part of the datapath in each clock.

Fields belong to clocks and not to steps: in one clock the memory reads for one step, the multiplier works for another,
and the T of a third is written.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from . import steps as timing
from .lowering import ArmLowering, Lowering
from .steps import ADDENDS, ALWAYS, CUTS, HALF, NEVER, NO_COUNT, NORMS, ONE, POWER, ZERO, Pick, Placed, Selector

PROGRAMS: dict[str, type[Lowering]] = {"fold": Lowering, "fold_arm": ArmLowering}
"""Program name -> class that makes its steps at an even word length: the core, and the whole arm."""


@dataclass(frozen=True)
class Schedule:
    """Program schedule.  ``period``: clocks of a lap.  ``loads``: input -> clock in which it is loaded.  ``starts``
    has two kinds of keys: a group gives the clock in which its first step is issued; the angle of a vector gives the
    clock in which that vector is handed over."""

    period: int
    loads: dict[str, int]
    starts: dict[str, int]


WIDTH = 24  # any word length: the steps are the same at each
PLACES = 64  # places of read/write words; 64 powers of two follow
WORDS = 32  # read/write words: a word has two places, n and n + 32


@cache
def codes(name: str = "fold") -> dict[str, tuple]:
    """Return a dict: field -> its codes.  Selectors, signs and counts are in the order of the dataflow, inputs first.

    The whole arm's selectors and signs follow the core's, so that both programs' units share the codes.
    """
    lowering = PROGRAMS[name](WIDTH)
    steps = [step for group in lowering.groups().values() for _, step in group]
    fixed = (NEVER, ALWAYS, NO_COUNT)
    found = dict.fromkeys(s for step in steps for s, _ in timing.selections(Placed(0, step)) if s not in fixed)
    order = sorted(found, key=lambda selector: selector.node not in lowering.INPUTS)

    def selectors(used, *first: Selector) -> tuple[Selector, ...]:
        return NEVER, *first, *(s for s in order if s in used)

    def picked(operands) -> tuple[Selector, ...]:
        return selectors({o.flag for o in operands if isinstance(o, Pick)})

    signs = [node for node in lowering.nodes if node in {step.sign for step in steps}]
    counts = "", *dict.fromkeys(normal.count for normal, _ in lowering.norms.values() if normal.count)
    joints = lowering.joints.values()
    made: dict[str, tuple] = {"a_by": picked(step.a for step in steps), "b_by": picked(step.b for step in steps)}
    made |= {"w_by": picked(step.write and step.write.to for step in steps)}
    made |= {"s_by": selectors({step.addend_by for step in steps})}
    made |= {"minus_by": selectors({step.minus for step in steps}, ALWAYS, NO_COUNT)}
    made |= {"r_function": ("root", "sine", "cosine"), "b_place": ("", "root", "angle"), "cut": CUTS, "s": ADDENDS}
    made |= {"carry": ("", "minus"), "window": ("plain", "double", "low"), "last": ("inner", "root", "slope", "sine")}
    made |= {"sign": ("", *signs), "norm": ("", *NORMS), "source": ("none", "sum", "normal", "input")}
    made |= {"input": lowering.INPUTS, "result": ("", *lowering.RESULTS)}
    made |= {"e_set": counts, "n_base": ("count", "1", "2", "4", "-2"), "n_e": counts}
    if joints:
        shared = {field: (*of, *(code for code in made[field] if code not in of)) for field, of in codes().items()}
        made |= {field: of for field, of in shared.items() if field not in ("input", "result")}
        made["source"] += "result", "wrist"
        made["result"] += timing.ELBOW
        by = {joint.angle: joint.by for joint in joints}
        made["again_by"] = "", *(by[angle] for angle, vector in lowering.vectors.items() if vector.lengths)
    return made


PLAIN_BITS = {"a": 7, "b": 7, "b_count": 1, "r": 6, "a_bend": 1, "b_high": 1, "limit": 1, "w": 6}
PLAIN_BITS |= dict.fromkeys(("n_minus", "n_twice", "last_input", "hold", "first_result", "last_result"), 1)
"""Numeric field -> number of bits."""

ANGLE_BITS = {"over": 1, "to_h": 1}
"""Numeric field of the angle unit -> number of bits; the result in the same clock sets the unit's other controls."""


@cache
def fields(name: str = "fold") -> dict[str, int]:
    """Return a dict: field of a program word -> number of bits."""
    coded = {name: max(1, (len(codes) - 1).bit_length()) for name, codes in codes(name).items()}
    return coded | PLAIN_BITS | (ANGLE_BITS if "again_by" in coded else {})


@dataclass
class Program:
    """Program: the fields of each clock of the lap, the memory place of each variable, and the steps."""

    name: str
    period: int
    clocks: list[dict[str, int]] = field(default_factory=list)
    places: dict[str, int] = field(default_factory=dict)
    steps: list[Placed] = field(default_factory=list)
    loads: dict[str, int] = field(default_factory=dict)
    results: tuple[int, int] = (0, 0)  # clocks of the first and the last result
    turns: dict[str, Turn] = field(default_factory=dict)
    shown: dict[str, int] = field(default_factory=dict)  # joint -> the clock of its angle
    written: dict[str, int] = field(default_factory=dict)  # result -> its clock

    def word(self, clock: int) -> int:
        """Return the program word of a clock; the first of :func:`fields` is in the lowest bits."""
        word = at = 0
        for name, bits in fields(self.name).items():
            word |= self.clocks[clock][name] << at
            at += bits
        return word


class ConflictError(ValueError):
    """Schedule that has no program, for example because two steps need a field in the same clock."""


def lives(steps: list[Placed], loads: dict[str, int]) -> dict[str, tuple[int, int]]:
    """Return a dict: variable -> (first clock in which it is written, last clock in which it is written or read)."""
    first, last = dict(loads), dict[str, int]()
    writes = [use for placed in steps for use in timing.word_writes(placed)]
    for use in writes:
        first[use.of] = min(first.get(use.of, use.at), use.at)
    for use in (*writes, *(use for placed in steps for use in timing.word_reads(placed))):
        last[use.of] = max(last.get(use.of, use.at), use.at)
    return {name: (clock, last.get(name, clock)) for name, clock in first.items()}


CONSTANTS = {ONE: range(1, 2), ZERO: range(WORDS + 16, PLACES)}
"""Constant of a :class:`Pick` -> places n at which the pick's variable may be: the word ``PLACES`` further, 2^(1-n),
has to be the constant.  From n = 48 on, 2^(1-n) is 0 at any word length."""


def allocate(steps: list[Placed], loads: dict[str, int], period: int) -> dict[str, int]:
    """Return a dict: variable -> its memory place.  A pair takes an even place and the next one, for the whole lap."""
    operands = (o for p in steps for o in (p.step.a, p.step.b, p.step.write and p.step.write.to))
    picks = {of.pair: of.constant for of in operands if isinstance(of, Pick)}
    doubles = {name for name, constant in picks.items() if not constant}
    life = lives(steps, loads)
    taken: list[set[int]] = [set() for _ in range(WORDS)]
    places = {}
    for name in sorted(life, key=lambda n: (not picks.get(n), n not in doubles, life[n])):
        first, last = life[name]
        if last - first >= period:
            raise ConflictError(f"{name} lives {last - first} clocks, too long for a lap of {period}")
        double = name in doubles
        wanted = {clock % period for clock in (range(period) if double else range(first, last + 1))}
        for place in CONSTANTS.get(picks.get(name, ""), range(0, WORDS, 1 + double)):
            both = taken[place % WORDS :][: 1 + double]
            if not any(words & wanted for words in both):
                break
        else:
            raise ConflictError(f"no place for {name}")
        places[name] = place
        for words in both:
            words |= wanted
    return places


@dataclass(frozen=True)
class Turn:
    """Vector in the angle unit, with the clocks in which its two words are loaded and the clock of its hand-over."""

    vector: timing.Vector
    loads: tuple[int, int]
    over: int


def turns(lowering: Lowering, steps: list[Placed], starts: dict[str, int]) -> dict[str, Turn]:
    """Return a dict: angle -> :class:`Turn` of its vector.  A vector of lengths is loaded at the previous hand-over."""
    results = {p.step.result: p.at + timing.WRITE for p in steps if p.step.result}
    early = (of.step for of in steps if of.step.name in timing.ELBOW and of.step.write)
    results |= {timing.word_of(step.write.to): results[step.result] for step in early if step.write}
    found, over = {}, 0
    for angle, vector in lowering.vectors.items():
        loads = (over, over) if vector.lengths else (results[vector.x], results[vector.y])
        over = over + lowering.angle_clocks.again if vector.lengths else starts[angle]
        found[angle] = Turn(vector, loads, over)
    return found


def encode(lowering: Lowering, of: Schedule, name: str) -> Program:
    """Return the program of the schedule ``of``.  Raises ConflictError if there is none."""
    groups = lowering.groups().items()
    steps = [Placed(of.starts[first] + at, step) for first, group in groups for at, step in group]
    steps.sort(key=lambda placed: placed.at)
    loads, period, bits, coded = of.loads, of.period, fields(name), codes(name)
    program = Program(name, period, [dict.fromkeys(bits, 0) for _ in range(period)], {}, steps, loads)
    program.places = allocate(steps, loads, period)
    taken: set[tuple[int, str]] = set()

    def put(clock: int, **fields: int | str | Selector) -> None:
        for name, value in fields.items():
            if (clock % period, name) in taken:
                raise ConflictError(f"{name} is needed twice in clock {clock % period}")
            taken.add((clock % period, name))
            code = coded[name].index(value) if isinstance(value, str | Selector) else int(value)
            if code >> bits[name]:
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
    program.turns = turns(lowering, steps, of.starts)
    joints = lowering.joints.values()
    angle = {name: turn.over + lowering.angle_clocks.shown for name, turn in program.turns.items()}
    program.shown = {joint.name: angle[joint.angle] + joint.late for joint in joints}
    results = {p.step.result: p.at + timing.WRITE for p in steps if p.step.result in lowering.RESULTS}
    program.written = results | program.shown
    first = min(program.written.values())
    last = max(*results.values(), *(clock + timing.COMPARED for clock in program.shown.values()))
    program.results = first, last
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
        kept, norm = w.last if w else "inner", step.norm.kind if step.norm else ""
        put(t + timing.WRITE, window=window or "plain", limit=bool(w and w.limit), last=kept, sign=step.sign, norm=norm)
        if step.result:
            put(t + timing.WRITE, result=step.result)
        if w:
            place, flag = operand(w.to)
            put(t + timing.WRITE, source=w.source, w=place, w_by=flag)
        if step.norm:
            put(t + timing.NORM, source="normal", w=program.places[step.norm.to], w_by=NEVER, e_set=step.norm.count)
        if step.count:
            begin = timing.first_count(placed)
            for number, (factor, register) in enumerate(step.count.terms):
                base = str(step.count.base) if number == 0 else "count"
                put(begin + number, n_base=base, n_e=register, n_minus=factor < 0, n_twice=abs(factor) == 2)
    firsts = {joint.other for joint in joints}
    for name, turn in program.turns.items():
        of_angle = [joint for joint in joints if joint.angle == name]
        if turn.vector.lengths:
            put(turn.loads[0], again_by=of_angle[0].by)
        put(turn.over, over=1)
        if name in firsts or not of_angle[0].other:
            put(angle[name], to_h=1)
    for name, clock in program.shown.items():
        put(clock, result=name)
    return program


SCHEDULES = {name: Path(__file__).with_name(f"{name.replace('fold', 'schedule')}.json") for name in PROGRAMS}
"""Program name -> file of its schedules, written by `make schedule`."""


@cache
def schedules(name: str) -> dict[int, Schedule]:
    """Return the schedules on file: longest word length that a schedule supports -> schedule, in ascending order."""
    found = json.loads(SCHEDULES[name].read_text(encoding="utf-8"))
    return {int(longest): Schedule(**of) for longest, of in found.items()}


def schedule(width: int, name: str = "fold") -> Schedule:
    """Return the schedule at a word length."""
    return next(of for longest, of in schedules(name).items() if width <= longest)


@cache
def program(width: int, name: str = "fold") -> tuple[Lowering, Program]:
    """Return the lowering at a word length, and the program of the schedule on file."""
    lowering = PROGRAMS[name](width)
    return lowering, encode(lowering, schedule(width, name), name)

# SPDX-License-Identifier: Apache-2.0
"""Schedule a program of the fold datapath: assign a clock to every step by constraint programming.

Writes the schedule with the least latency found within the time limit to model/dataflow/fold/schedule.json or
schedule_arm.json, from which `python -m scripts.generate.headers` makes the program. Rerun this command after
adding, dropping or renaming a step of the dataflow.
"""

import json
import sys
from collections.abc import Callable, Iterable
from dataclasses import asdict

import click

from model.dataflow.fold import steps as timing
from model.dataflow.fold.lowering import Lowering
from model.dataflow.fold.program import PROGRAMS, SCHEDULES, Schedule, encode, schedules
from model.dataflow.fold.steps import Placed, Selector
from scripts.console import InputError, Options, command, option, whole

LATENCY, PERIOD = {"fold": 140, "fold_arm": 340}, {"fold": {32: 88}, "fold_arm": {24: 140, 32: 143}}
"""Clocks: datapath -> largest latency of a target; datapath -> largest word length of a program -> default period."""


class _Problem:
    """Constraint model of a schedule. Variables are clocks: ``loads`` of inputs, ``starts`` of groups and vectors."""

    def __init__(self, model, lowering: Lowering, period: int, latency: int) -> None:
        self.model, self.lowering, self.period, self.latency = model, lowering, period, latency
        groups = lowering.groups()
        self.at_place: dict[str, list] = {}  # load or start -> a mask for each place of the lap
        self.loads = {name: self._clock(f"load {name}", 0, period - 1) for name in lowering.INPUTS}
        vectors = [angle for angle, vector in lowering.vectors.items() if not vector.lengths]
        self.starts = {name: self._clock(name, 1, latency) for name in [*groups, *vectors]}
        self.placed = [(name, Placed(at, step)) for name, group in groups.items() for at, step in group]
        results = [(of.step.result, self.starts[name] + of.at + timing.WRITE) for name, of in self.placed]
        self.results = {result: clock for result, clock in results if result}
        self._words()
        self.joints = self._angles()
        self._results(self._registers())
        self._resources()

    def _clock(self, name: str, first: int, last: int):
        """Return a variable for a clock. ``at_place[name]`` gets the clock's place in the lap, as one-hot bits."""
        clock, place = self.model.new_int_var(first, last, name), self.model.new_int_var(0, self.period - 1, name)
        lap = self.model.new_int_var(0, last // self.period, name)
        self.model.add(clock == lap * self.period + place)
        self.at_place[name] = [self.model.new_bool_var(f"{name} in {n}") for n in range(self.period)]
        self.model.add_exactly_one(self.at_place[name])
        self.model.add(place == sum(n * mask for n, mask in enumerate(self.at_place[name])))
        return clock

    def _one_each(self, uses: Iterable[tuple[str, int]]) -> None:
        """Allow at most one use in each clock of the lap. A use (name, n) is n clocks after the named load or start."""
        uses = list(uses)
        for n in range(self.period):
            self.model.add_at_most_one(self.at_place[name][(n - clock) % self.period] for name, clock in uses)

    def _resources(self) -> None:
        """In each clock of the lap, allow one step issue, one row read, one word write, one result and one user of the
        counter."""
        steps, last = self.placed, timing.last_count
        loads = [(f"load {name}", 0) for name in self.loads]
        self._one_each((name, of.at) for name, of in steps)
        self._one_each((name, clock) for name, of in steps for clock in timing.row_reads(of))
        self._one_each(loads + [(name, use.at) for name, of in steps for use in timing.word_writes(of)])
        self._one_each(self.joints + [(name, of.at + timing.WRITE) for name, of in steps if of.step.result])
        counting = [(name, of) for name, of in steps if of.step.count]
        self._one_each((name, n) for name, of in counting for n in range(timing.first_count(of), last(of) + 1))

    def _angles(self) -> list[tuple[str, int]]:
        """Allow at most one vector in each stage of the angle unit. The elbow's vector goes first, the wrist's vectors
        go last. Return the clock of each joint as (name, n): n clocks after the start with that name."""
        early = (of.step for _, of in self.placed if of.step.name in timing.ELBOW and of.step.write)
        at = self.results | {step.write.to: self.results[step.result] for step in early}
        handed_over: dict[str, tuple[str, int]] = {}  # angle -> when its vector passes to the second stage
        clocks = self.lowering.angle_clocks
        order = sorted(self.lowering.vectors.values(), key=lambda vector: not vector.opposite)
        for before, vector in zip([None, *order], order, strict=False):
            name, after = (before.angle, clocks.again) if vector.lengths else (vector.angle, 0)
            handed_over[vector.angle] = name, after
            if not vector.lengths:
                x, y, over = at[vector.x], at[vector.y], self.starts[name]
                self.model.add(y >= x + 2)
                self.model.add(over >= y + clocks.iterated)
                if before:
                    name, after = handed_over[before.angle]
                    self.model.add(x > self.starts[name] + after)
                    self.model.add(over > self.starts[name] + after + clocks.shown)
        if order:  # in the next lap, but before the first vector of that lap's target, which thus needs no reset
            name, after = handed_over[order[-1].angle]
            over = self.starts[name] + after
            self.model.add(over >= self.period)
            self.model.add(over < at[order[0].x] + self.period)
            self.model.add(over + clocks.shown < self.starts[order[0].angle] + self.period)
        joints = [(handed_over[joint.angle], joint.late) for joint in self.lowering.joints.values()]
        return [(name, after + clocks.shown + late) for (name, after), late in joints]

    def _written(self, by: Callable[[Placed], Iterable[timing.Use]], loaded: Iterable[str]) -> dict[str, list]:
        """Return a dict: word or register -> clocks of its writes. by(step): the step's writes. loaded: input names."""
        clocks = {name: [self.loads[name]] for name in loaded}
        for name, placed in self.placed:
            for use in by(placed):
                clocks.setdefault(use.of, []).append(self.starts[name] + use.at)
        return clocks

    def _words(self) -> None:
        """Constrain each read of a word to follow its write and precede the next target's write of the same word."""
        written = self._written(timing.word_writes, self.loads)
        for name, placed in self.placed:
            for use in timing.word_reads(placed):
                self._needs(written, {use.of}, self.starts[name] + use.at, self.period - 1)

    def _registers(self) -> dict[str, list]:
        """Constrain the reads of flags and counts. These are in registers, so a read may be as late as the clock that
        sets the register for the next target. Return a dict: register -> clocks that set it."""
        written = self._written(timing.registers_set, ["phi"])
        for name, placed in self.placed:
            start = self.starts[name]
            for selector, at in timing.selections(placed):
                self._needs(written, self.lowering.registers(selector), start + at, self.period)
            for number, (_, register) in enumerate(placed.step.count.terms if placed.step.count else ()):
                self._needs(written, {register}, start + timing.first_count(placed) + number, self.period)
        return written

    def _needs(self, written: dict[str, list], names: set[str], clock, most: int) -> None:
        """Constrain ``clock`` to be 1 to ``most`` clocks after each write of ``names``. written: name -> writes."""
        for at in (at for name in names for at in written[name]):
            self.model.add(clock > at)
            self.model.add(clock <= at + most)

    def _results(self, registers: dict[str, list]) -> None:
        """Constrain the results of a target, and minimize the clock of the last result.

        Flags and tag leave with the first result. The last result leaves before the next target's first result. It does
        not leave in the final clocks of a lap, in which steps of the next lap are already fetched. A joint's angle is
        compared with its limits after it is written.
        """
        joints = [self.starts[name] + clock for name, clock in self.joints]
        results = [clock for name, clock in self.results.items() if name in self.lowering.RESULTS]
        first, last, taken = (self.model.new_int_var(0, 2 * self.latency, name) for name in ("first", "last", "taken"))
        self.model.add_min_equality(first, results + joints)
        self.model.add_max_equality(last, results + [clock + timing.COMPARED for clock in joints])
        self.model.add_max_equality(taken, list(self.loads.values()))
        flags = [name for name in ("clamp", "away", "on_axis", "bad_hand", "saturated") if name in self.lowering.nodes]
        for name in flags:
            self._needs(registers, self.lowering.registers(Selector(name)), first, self.period)
        self.model.add(first <= taken + self.period)
        self.model.add(last + bool(joints) < first + self.period)
        if joints:  # the elbow uses the branch of the target loaded last, the joints the branch kept for the results
            self.model.add(self.results["elbow_w"] > taken)
            self.model.add(self.results["elbow_w"] <= taken + self.period)
        lap, place = self.model.new_int_var(0, 3, "lap"), self.model.new_int_var(0, self.period - 1, "place")
        self.model.add(last == lap * self.period + place)
        self.model.add(lap <= (2 if joints else 1))  # the RTL keeps a target for no more laps
        self.model.add(place < self.period - timing.FETCH)
        self.model.add(last <= self.latency)
        self.model.minimize(last)


@command(
    "schedule",
    [
        option("--datapath", "program", click.Choice([*PROGRAMS]), default="fold"),
        option("--period", "clocks of a lap", whole(1), metavar="CLOCKS"),
        option("--seconds", "seconds to search", whole(1), default=240, metavar="N"),
    ],
    fails="no schedule was found",
)
def main(parsed: Options) -> int:
    try:
        from ortools.sat.python import cp_model
    except ImportError:
        raise InputError("ortools is not installed: use make schedule") from None
    name = parsed.datapath
    made = schedules(name).copy()
    for longest, clocks in PERIOD[name].items():
        lowering = PROGRAMS[name](longest)
        period = parsed.period or clocks
        steps = sum(map(len, lowering.groups().values()))
        print(f"{steps} steps, one target every {period} clocks up to W = {longest}", flush=True)
        problem = _Problem(cp_model.CpModel(), lowering, period, LATENCY[name])
        solver = cp_model.CpSolver()
        solver.parameters.max_time_in_seconds = parsed.seconds
        status = solver.solve(problem.model)
        if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            none = f"no schedule within {LATENCY[name]} clocks"
            print(none if status == cp_model.INFEASIBLE else f"none found in {parsed.seconds} s")
            return 1
        parts = ({name: solver.value(of) for name, of in part.items()} for part in (problem.loads, problem.starts))
        made[longest] = Schedule(period, *parts)
        encode(lowering, made[longest], name)  # raises if two steps need the same field or place
    written = {longest: asdict(of) for longest, of in made.items()}
    SCHEDULES[name].write_text(json.dumps(written, indent=1) + "\n", encoding="utf-8")
    print(f"wrote {SCHEDULES[name].name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

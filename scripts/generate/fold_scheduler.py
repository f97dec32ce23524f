# SPDX-License-Identifier: Apache-2.0
"""Schedule the fold datapath: assign a clock to every step of the lean dataflow by constraint programming.

    make schedule [PERIOD=CLOCKS] [SECONDS=N]

Writes the schedule of least latency found in the time limit to model/dataflow/fold/schedule.json, the source of the
program (`python -m scripts.generate.headers`).  Rerun after adding, dropping or renaming a step of the dataflow.

Exit status: 0 a schedule was found, 1 none exists or none was found in time, 2 bad input.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable
from dataclasses import asdict
from types import SimpleNamespace

from model.dataflow.fold import steps as timing
from model.dataflow.fold.lowering import Groups, Lowering, lower
from model.dataflow.fold.program import INPUTS, SCHEDULE, WIDTH, Schedule, encode
from model.dataflow.fold.steps import Placed, Selector
from scripts.console import InputError, command, option, whole

try:
    from ortools.sat.python import cp_model
except ImportError:
    cp_model = None

LATENCY = 140
"""Largest latency of a target, in clocks."""


class _Problem:
    """Schedule as variables and constraints: ``model`` and the start of each group."""

    def __init__(self, lowering: Lowering, groups: Groups, period: int) -> None:
        self.lowering, self.model, self.period = lowering, cp_model.CpModel(), period
        self.loads = {name: self.model.new_int_var(0, period - 1, name) for name in INPUTS}
        self.starts = {name: self.model.new_int_var(1, LATENCY, name) for name in groups}
        steps = ((name, Placed(at, step)) for name, group in groups.items() for at, step in group)
        self.placed = [(self.starts[name], placed) for name, placed in steps]
        self._resources()
        self._words()
        self._results(self._registers())

    def _clocks(self, of: Callable[[Placed], Iterable[int]]) -> list:
        return [start + clock for start, placed in self.placed for clock in of(placed)]

    def _in_lap(self, clocks: list, what: str) -> list:
        """Return each clock modulo the lap length."""
        places = []
        for number, clock in enumerate(clocks):
            lap = self.model.new_int_var(-1, LATENCY // self.period + 1, f"{what} {number}, lap")
            places.append(self.model.new_int_var(0, self.period - 1, f"{what} {number}"))
            self.model.add(clock == lap * self.period + places[-1])
        return places

    def _resources(self) -> None:
        """Allow one step issue, one row read and one word write per clock of the lap, and one user of the counter."""
        writes = self._clocks(lambda placed: [use.at for use in timing.word_writes(placed)])
        for what, clocks in (
            ("issue", self._clocks(lambda placed: [placed.at])),
            ("row", self._clocks(timing.row_reads)),
            ("write", writes + list(self.loads.values())),
        ):
            self.model.add_all_different(self._in_lap(clocks, what))
        counting = [(start, placed) for start, placed in self.placed if placed.step.count]
        begins = self._in_lap([start + timing.first_count(placed) for start, placed in counting], "count")
        intervals = []
        for begin, (_, placed) in zip(begins, counting, strict=True):
            clocks = timing.last_count(placed) - timing.first_count(placed) + 1
            for lap in (0, self.period):  # twice: an interval may wrap around the end of the lap
                intervals.append(self.model.new_fixed_size_interval_var(begin + lap, clocks, "count"))
        self.model.add_no_overlap(intervals)

    def _written(self, by: Callable[[Placed], Iterable[timing.Use]], loaded: Iterable[str]) -> dict[str, list]:
        """Return word or register -> the clocks in which it is written. by: the writes of a step."""
        found = {name: [self.loads[name]] for name in loaded}
        for start, placed in self.placed:
            for use in by(placed):
                found.setdefault(use.of, []).append(start + use.at)
        return found

    def _words(self) -> None:
        """Constrain reads of a word to lie between its write and the next target's write."""
        written = self._written(timing.word_writes, self.loads)
        for start, placed in self.placed:
            for use in timing.word_reads(placed):
                for write in written[use.of]:
                    self.model.add(start + use.at > write)
                    self.model.add(start + use.at < write + self.period)

    def _registers(self) -> dict[str, list]:
        """Constrain flags and counts, which are registers, in the same way; return the clocks that set them."""
        written = self._written(timing.registers_set, ["phi"])
        for start, placed in self.placed:
            for selector, at in timing.selections(placed):
                self._needs(written, self.lowering.registers(selector), start + at)
            if placed.step.count:
                for number, (_, register) in enumerate(placed.step.count.terms):
                    self._needs(written, {register}, start + timing.first_count(placed) + number)
        return written

    def _needs(self, written: dict[str, list], registers: set[str], clock) -> None:
        for at in (at for register in registers for at in written[register]):
            self.model.add(clock > at)
            self.model.add(clock <= at + self.period)

    def _results(self, registers: dict[str, list]) -> None:
        """Flags and tag leave with the first result. The last result precedes the next target's first one and stays
        clear of the last clocks of a lap, in which the core would begin another lap."""
        results = [start + placed.at + timing.WRITE for start, placed in self.placed if placed.step.result]
        first, last, taken = (self.model.new_int_var(0, 2 * LATENCY, name) for name in ("first", "last", "taken"))
        self.model.add_min_equality(first, results)
        self.model.add_max_equality(last, results)
        self.model.add_max_equality(taken, list(self.loads.values()))
        for name in ("clamp", "away", "on_axis"):  # they give the flags
            self._needs(registers, self.lowering.registers(Selector(name)), first)
        self.model.add(first <= taken + self.period)
        self.model.add(last < first + self.period)
        (place,) = self._in_lap([last], "last result")
        self.model.add(place < self.period - timing.FETCH)
        self.model.minimize(last)


@command(
    "schedule",
    "Schedule the folded datapath.",
    [
        option("--period", "clocks of a lap", whole(1), default=88, metavar="CLOCKS"),
        option("--seconds", "seconds to search", whole(1), default=240, metavar="N"),
    ],
    fails="no schedule was found",
)
def main(parsed: SimpleNamespace) -> int:
    if cp_model is None:
        raise InputError("ortools is not installed: use make schedule")
    lowering, groups = lower(WIDTH)
    print(f"{sum(map(len, groups.values()))} steps, one target every {parsed.period} clocks", flush=True)
    problem, solver = _Problem(lowering, groups, parsed.period), cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = parsed.seconds
    status = solver.solve(problem.model)
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        none = status == cp_model.INFEASIBLE
        print(f"no schedule within {LATENCY} clocks" if none else f"none found in {parsed.seconds} s")
        return 1
    found = ({name: solver.value(of) for name, of in part.items()} for part in (problem.loads, problem.starts))
    made = Schedule(parsed.period, *found)
    encode(groups, made)  # raises where two steps need a field or a place
    SCHEDULE.write_text(json.dumps(asdict(made), indent=1) + "\n", encoding="utf-8")
    print(f"wrote {SCHEDULE.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Small changes of the Verilog, one at a time, each of which a bench has to notice: what `make mutants` does.

    python -m scripts.mutants [--count N] [--seed S] [--only FILE] [--jobs N] [--farm tcp://HOST:PORT] [--keep]

A mutant is a copy of rtl/ with one place changed (tb/mutation/operators.py). Those that do not build, and those of
which Icarus makes the same program for every bench, do not count and are replaced by others. Each is given to the
benches that hold its file (tb/mutation/killers.py), the cheapest first, until one notices or Yosys proves that none can
(tb/mutation/equivalence.py). The seed says which mutants are tried, as many of each file as of the others where there
are so many. To N of them come N / 4 of netlists, by Yosys' `mutate` (tb/mutation/netlist.py).

Results are lines of OUT/SEED.jsonl as soon as they are there: a second call skips the mutants that it names, or that
tb/mutation/results.jsonl names, but tries survivors without a reason again, and those around which the Verilog has
changed. At the end comes a table by file, and each survivor that tb/mutation/equivalent.json gives no reason for.

Exit status: 0 none of these survived, 1 one did or a simulation breaks off, 2 input that cannot be used (one line on
stderr), 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

from rich.table import Table

from scripts import parallel
from scripts.console import InputError, Parser, Stopped, command, folder_name, progress, show, whole, whole_file
from scripts.generate.render import render
from tb.mutation import netlist
from tb.mutation.killers import LINT
from tb.mutation.mutant import (
    COUNTED,
    HARD,
    KILLED,
    PROVED,
    RESULTS,
    SURVIVED,
    Mutant,
    Result,
    append,
    excused,
    files,
    hard_text,
    hardest,
    judge,
    order,
    recorded,
    results_text,
)
from tb.mutation.netlist import Wired
from tb.mutation.operators import OPERATORS
from tb.sim.env import GENERATED
from tb.sim.simulate import SimulationError

PAGE = GENERATED / "mutants.md"
COUNT, SEED = 1000, 1
NETLISTS = 4
"""To so many mutants of the text comes one of a netlist."""


@dataclass
class Campaign:
    """Mutants of a seed: `count` in all, spread over the files, each file's in an `order`; what became of them."""

    count: int
    seed: int
    only: str
    path: Path
    order: Callable[[str, int], Iterator[Mutant | Wired]] = order
    results: list[Result] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.files = files(self.only)
        if not self.files:
            raise InputError(f"argument --only: no file of rtl/ has {self.only!r} in its name")
        self.known = recorded(self.path)

    @property
    def counted(self) -> int:
        return sum(result.verdict in COUNTED for result in self.results)

    def run(self, each: Callable, done: Callable[[int], None]) -> None:
        """Tries mutants until enough of them count, or there are no more."""
        left = {name: self.order(name, self.seed) for name in self.files}
        while batch := self._batch(left):
            for result in self._tried(each, batch):
                self.results.append(result)
                done(self.counted)

    def _batch(self, left: dict[str, Iterator[Mutant]]) -> list[Mutant]:
        """As many as are missing, each of the file that has the fewest by then; files without more leave `left`."""
        batch: list[Mutant] = []
        counted = [result.mutant for result in self.results if result.verdict in COUNTED]
        of = {name: sum(mutant.file == name for mutant in counted) for name in left}
        while left and len(counted) + len(batch) < self.count:
            name = min(left, key=lambda name: of[name])
            mutant = next(left[name], None)
            if mutant is None:
                del left[name]
            else:
                batch.append(mutant)
                of[name] += 1
        return batch

    def _tried(self, each: Callable, batch: list[Mutant]) -> Iterator[Result]:
        """Known results, then those of the others; what survived and has no reason is another one."""
        new = []
        for mutant in batch:
            row = self.known.get(mutant.key)
            result = row and Result(**row | {"mutant": mutant})
            if result and (result.verdict != SURVIVED or excused(mutant)):
                yield result
            else:
                new.append(mutant)
        for result in each(judge, new):
            append(self.path, result)
            yield result


def by_file(results: Sequence[Result]) -> dict[str, list[Result]]:
    """Those that count."""
    counted = [result for result in results if result.verdict in COUNTED]
    return {name: [r for r in counted if r.mutant.file == name] for name in sorted({r.mutant.file for r in counted})}


def kind(result: Result) -> str:
    """The first word of a killer: one of KINDS."""
    return result.killer.partition(" ")[0]


KINDS = ("nodes", "unit", "streams", "memory", LINT)


def rows(results: Sequence[Result]) -> list[list]:
    """File, mutants, killed by each kind of bench, proved equivalent, survivors with and without a reason."""
    found = []
    for name, own in [*by_file(results).items(), ("all", [r for r in results if r.verdict in COUNTED])]:
        killed = [sum(kind(r) == k for r in own if r.verdict == KILLED) for k in KINDS]
        survived = [r for r in own if r.verdict == SURVIVED]
        reason = sum(bool(excused(r.mutant)) for r in survived)
        proved = sum(r.verdict == PROVED for r in own)
        found.append([name.removeprefix("rtl/"), len(own), *killed, proved, reason, len(survived) - reason])
    return found


HEAD = ("file", "mutants", *KINDS, "proved", "argued", "survived")


def _table(results: Sequence[Result]) -> Table:
    table = Table("file")
    for name in HEAD[1:]:
        table.add_column(name, justify="right")
    for row in rows(results):
        table.add_row(*map(str, row))
    return table


@command("mutants")
def main(arguments: Sequence[str] | None) -> int:
    about = "Small changes of the Verilog, each of which a bench has to notice."
    parser = Parser("mutants", about, fails="one survives")
    add = parser.add_argument
    about = "how many, and N / 4 of netlists (default: %(default)s)"
    add("--count", type=whole(1), default=COUNT, metavar="N", help=about)
    add("--seed", type=whole(0), default=SEED, metavar="S", help="which (default: %(default)s)")
    add("--only", default="", metavar="FILE", help="of files of rtl/ with this in their name")
    add("--jobs", type=whole(1), default=os.cpu_count(), metavar="N", help="mutants at a time (default: %(default)s)")
    parallel.option(parser)
    about = "folder of the results (default: %(default)s)"
    add("--out", type=folder_name, default=Path("build/mutants"), metavar="DIR", help=about)
    about = "of a run over all files: write docs/generated/mutants.md, tb/mutation/hard.json and results.jsonl"
    add("--keep", action="store_true", help=about)
    options = parser.parse_args(arguments)
    if options.keep and options.only:
        raise InputError("argument --keep: goes with all files, not with --only")
    given = options.seed, options.only, options.out / f"{options.seed}.jsonl"
    text = Campaign(options.count, *given)
    netlists = Campaign(options.count // NETLISTS, *given, netlist.order)
    with parallel.shared(options.jobs, options.farm) as each, progress("mutants", text.count + netlists.count) as meter:
        try:
            text.run(each, meter)
            netlists.run(each, lambda done: meter(text.counted + done))
        except AssertionError as error:
            raise SimulationError(str(error)) from None
        except Stopped:
            counted = text.counted + netlists.counted
            print(f"mutants: stopped after {counted}; the same again resumes", file=sys.stderr)
            raise
    results = text.results + netlists.results
    show(_table(results))
    left = [r for r in results if r.verdict == SURVIVED and not excused(r.mutant)]
    for result in left:
        old, new = result.mutant.lines()
        print(f"{result.mutant.file}:{result.mutant.line}: {result.mutant.operator}\n  - {old}\n  + {new}")
    counted = text.counted + netlists.counted
    others = len(results) - counted
    print(f"seed {options.seed}: {counted} mutants, {len(left)} survived; {others} others did not count")
    if options.keep:
        texts = {PAGE: page(text, netlists), HARD: hard_text(hardest(results)), RESULTS: results_text(results)}
        for path, text in texts.items():
            with whole_file(path) as place:
                place.write_text(text, encoding="utf-8")
            print(f"wrote {path.name}")
    return 1 if left else 0


def page(text: Campaign, netlists: Campaign) -> str:
    """docs/generated/mutants.md."""
    results = text.results + netlists.results
    survived = [r.mutant for r in results if r.verdict == SURVIVED]
    seconds = [r.seconds for r in results if r.verdict in COUNTED]
    return render(
        "mutants", today=date.today().isoformat(), text=text, netlists=netlists, head=HEAD,
        rows=rows(results), rows_of_netlists=rows(netlists.results)[-1:], operators=len(OPERATORS),
        machines=[of.name for of in netlist.MACHINES], mean=sum(seconds) / max(len(seconds), 1),
        survivors=[(m, *m.lines(), excused(m)) for m in sorted(survived, key=lambda m: (m.file, m.line))],
    )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())

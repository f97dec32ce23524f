# SPDX-License-Identifier: Apache-2.0
"""A mutant: one place of one file of rtl/ changed; the order in which a seed tries them, and what became of one."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import random
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from tb.mutation import netlist
from tb.mutation.equivalence import equivalent
from tb.mutation.killers import (
    BROKEN,
    BUILD,
    KILLED,
    LINT,
    MEASURED,
    PROVED,
    SAME,
    SURVIVED,
    BuildError,
    digest_around,
    first_of,
    killers_of,
    linted,
)
from tb.mutation.netlist import Wired
from tb.mutation.operators import SELDOM, edits
from tb.sim.env import ROOT
from tb.sim.sources import sources

COUNTED = (KILLED, PROVED, SURVIVED)

EQUIVALENT = Path(__file__).with_name("equivalent.json")
HARD = Path(__file__).with_name("hard.json")
RESULTS = Path(__file__).with_name("results.jsonl")
RECORD = ("key", "verdict", "killer", "why", "seconds")


@dataclass(frozen=True)
class Mutant:
    """``file`` with the text from ``start`` to ``end`` replaced by ``new``."""

    file: str
    operator: str
    start: int
    end: int
    new: str

    def text(self) -> str:
        """The file's text."""
        text = (ROOT / self.file).read_text(encoding="utf-8")
        return text[: self.start] + self.new + text[self.end :]

    @property
    def key(self) -> str:
        """Of the mutant in the Verilog around it as it is now."""
        own = [*asdict(self).values(), digest_around(self.file)]
        return hashlib.sha256(json.dumps(own).encode()).hexdigest()[:16]

    @property
    def line(self) -> int:
        return (ROOT / self.file).read_text(encoding="utf-8").count("\n", 0, self.start) + 1

    def lines(self) -> tuple[str, str]:
        """The lines that it changes, before and after, each without the blanks around it."""
        before = (ROOT / self.file).read_text(encoding="utf-8")
        first = before.rfind("\n", 0, self.start) + 1
        last = before.find("\n", self.end)
        after = before[first : self.start] + self.new + before[self.end : last]
        return tuple(" ".join(text.split()) for text in (before[first:last], after))


@dataclass(frozen=True)
class Result:
    """What became of a mutant: by whom it was noticed, and how."""

    mutant: Mutant | Wired
    verdict: str
    killer: str = ""
    why: str = ""
    seconds: float = 0.0


def files(only: str = "") -> list[str]:
    """The files of rtl/ that are mutated, of a name that holds `only`."""
    names = [path.relative_to(ROOT).as_posix() for path in sources()]
    return [name for name in names if only in name]


def order(file: str, seed: int) -> Iterator[Mutant]:
    """The mutants of a file in the order of a seed: operators with equal chances but SELDOM, then one of its places."""
    chosen = random.Random(f"{seed} {file}")
    left = {name: list(found) for name, found in edits((ROOT / file).read_text(encoding="utf-8")).items()}
    while left:
        name = chosen.choice(sorted(left))
        if name in SELDOM and chosen.random() < 0.75 and set(left) - SELDOM:
            name = chosen.choice(sorted(set(left) - SELDOM))
        start, end, new = left[name].pop(chosen.randrange(len(left[name])))
        if not left[name]:
            del left[name]
        yield Mutant(file, name, start, end, new)


@functools.cache
def _place() -> tempfile.TemporaryDirectory:
    """This process' copy of rtl/, in the checkout, which goes with it."""
    folder = BUILD / "copies"
    folder.mkdir(parents=True, exist_ok=True)
    return tempfile.TemporaryDirectory(prefix="ik_mutant_", dir=folder)


def _emptied() -> Path:
    """The same without anything in it."""
    place = Path(_place().name)
    for part in place.iterdir():
        shutil.rmtree(part) if part.is_dir() else part.unlink()
    return place


def _copied(mutant: Mutant) -> Path:
    """The copy of rtl/, changed by the mutant and nothing else."""
    place = _emptied()
    shutil.copytree(ROOT / "rtl", place / "rtl")
    (place / mutant.file).write_text(mutant.text(), encoding="utf-8")
    return place


def judge(mutant: Mutant | Wired) -> Result:
    """Tries the mutant's killers one after the other until one notices, or it is proved that none can."""
    begin = time.monotonic()

    def result(verdict: str, killer: str = "", why: str = "") -> Result:
        return Result(mutant, verdict, killer, why, time.monotonic() - begin)

    if isinstance(mutant, Wired):
        return result(*netlist.judged(mutant, _emptied()))
    place = _copied(mutant)
    changed, first, known = False, len(first_of(mutant.file)), {}
    for number, killer in enumerate(killers_of(mutant.file)):
        if changed and number == first:
            if why := linted(_copied(mutant), mutant.file):  # benches put modules of their own into it
                return result(KILLED, LINT, why)
            if where := equivalent(mutant.file, place, known, climb=False):
                return result(PROVED, "", where)
        try:
            differs, why = killer.judged(place)
        except BuildError as error:
            return result(BROKEN, killer.name, str(error)[-200:])
        changed |= differs
        if why:
            return result(KILLED, killer.name, why)
    if not changed:
        return result(SAME)
    where = equivalent(mutant.file, place, known)
    return result(PROVED, "", where) if where else result(SURVIVED)


# ---- the hardest ones ------------------------------------------------------------------------------------------------

HARDEST = 60
"""So many mutants are in the list of those that `make test-all` runs."""


@dataclass(frozen=True)
class Hard:
    """A mutant that few benches notice, as text: it outlives changes of other lines."""

    file: str
    old: str
    new: str
    killer: str

    def text(self) -> str:
        """The file's text.  Raises LookupError where the line is not there exactly once."""
        lines = (ROOT / self.file).read_text(encoding="utf-8").splitlines()
        found = [n for n, line in enumerate(lines) if " ".join(line.split()) == self.old]
        if len(found) != 1:
            raise LookupError(f"{self.file} has not exactly one line {self.old!r}: take it out of {HARD.name}")
        return "\n".join(lines[: found[0]] + [self.new] + lines[found[0] + 1 :]) + "\n"


def hard() -> list[Hard]:
    """The list."""
    return [Hard(**row) for row in json.loads(HARD.read_text(encoding="utf-8"))]


def hardest(results: list[Result]) -> list[Hard]:
    """Of results those that the first benches did not notice, and a bench did by itself: those first that were noticed
    last for the time that it takes."""
    found = []
    for result in results:
        if isinstance(result.mutant, Wired):
            continue
        killers = {killer.name: killer for killer in killers_of(result.mutant.file)}
        late = list(killers).index(result.killer) if result.verdict == KILLED and result.killer in killers else 0
        mutant = Hard(result.mutant.file, *result.mutant.lines(), result.killer)
        try:
            mutant.text()
        except LookupError:
            continue
        if late and not result.why.startswith(MEASURED):
            found.append((killers[mutant.killer].right()["seconds"], late, mutant))
    found.sort(key=lambda one: (-one[1] / (one[0] + 3), one[2].file, one[2].new))
    return sorted((mutant for *_, mutant in found[:HARDEST]), key=lambda one: (one.killer, one.file, one.new))


def hard_text(mutants: list[Hard]) -> str:
    """What HARD holds."""
    return json.dumps([asdict(one) for one in mutants], indent=1) + "\n"


# ---- what is kept ----------------------------------------------------------------------------------------------------


def record(result: Result) -> str:
    """A line of the file of results."""
    return json.dumps({"key": result.mutant.key} | asdict(result))


def recorded(path: Path) -> dict[str, dict]:
    """Key -> what became of a mutant, as :class:`Result` has it: from RESULTS and `path`.  Half a line is none."""
    rows = (dict(zip(RECORD, row, strict=True)) for row in _rows(RESULTS))
    return {row.pop("key"): row for row in (*rows, *_rows(path))}


def _rows(path: Path) -> Iterator:
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        with suppress(ValueError):
            yield json.loads(line)


def results_text(results: list[Result]) -> str:
    """What RESULTS holds: all but survivors without a reason, which the next campaign tries again.

    Of what was said only whether it was :data:`MEASURED`: the rest names folders.
    """
    kept = [r for r in results if r.verdict != SURVIVED or excused(r.mutant)]
    rows = [
        (r.mutant.key, r.verdict, r.killer, MEASURED if r.why.startswith(MEASURED) else "", round(r.seconds))
        for r in kept
    ]
    return "".join(f"{json.dumps(row)}\n" for row in sorted(rows))


def append(path: Path, result: Result) -> None:
    """In one write, so that a signal cuts no line."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    try:
        os.write(handle, f"{record(result)}\n".encode())
    finally:
        os.close(handle)


def reasons() -> dict[tuple[str, str, str], str]:
    """(file, line, changed line) of mutants that no test can notice -> why."""
    rows = json.loads(EQUIVALENT.read_text(encoding="utf-8"))
    return {(row["file"], row["old"], row["new"]): row["reason"] for row in rows}


def excused(mutant: Mutant | Wired) -> str:
    """Why no test can notice a mutant, if the list says so."""
    return reasons().get((mutant.file, *mutant.lines()), "")

# SPDX-License-Identifier: Apache-2.0
"""No node of either datapath overflows, proved on the RTL as it is elaborated.

For every node its operator's guard bits equal its sign, from the ranges that the word-length table gives its operands
(tb/formal/obligations.py). The same run sees each kind of proof fail on seeded bugs (tb/formal/range_bugs.py), and
every node fail whose format is made a bit shorter than its range needs.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, field
from os import cpu_count

from tb.formal.claims import Lemma, Row
from tb.formal.design import ObligationError
from tb.formal.exact_values import SECTIONS, properties
from tb.formal.netlist import NetlistError
from tb.formal.obligations import Design
from tb.formal.range_bugs import BUGS, FULL, LIB, SWEEP, NodeBug
from tb.formal.range_table import DATAPATHS, model_nodes, table
from tb.formal.tools import running
from tb.sim.env import ROOT
from tb.sim.sources import digest

BUILD = ROOT / "build" / "formal_ranges"
FILES = ("rtl/lib/ik_[!f]*.v", "rtl/paper/*.v*", "rtl/lean/*.v*", "tb/formal/ranges/*.vh")

Say = Callable[[str], None]


def _short(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def digests() -> dict[str, str]:
    """What is proved, a file, the exact values of a section or a table of ranges: a digest of it."""
    paths = sorted(path for pattern in FILES for path in ROOT.glob(pattern))
    found = {path.relative_to(ROOT).as_posix(): digest([path]) for path in paths}
    found |= {f"exact values of {section}": _short(properties(section)) for section in SECTIONS}
    found["seeded bugs"] = _short(repr(BUGS))
    for datapath in DATAPATHS:
        for width in (FULL, SWEEP):
            found[f"ranges of {datapath}, W={width}"] = _short(repr(sorted(table(datapath, width).items())))
    return found


@dataclass
class Run:
    """What came out of one datapath at one width."""

    datapath: str
    width: int
    rows: list[Row] = field(default_factory=list)
    lemmas: list[Lemma] = field(default_factory=list)
    seconds: float = 0.0
    problem: str = ""
    design: Design | None = None

    @property
    def failed(self) -> list[str]:
        """A line for everything that is not proved."""
        where = f"{self.datapath}, W={self.width}"
        found = [f"{where}: {self.problem}"] if self.problem else []
        return found + [f"{where}: {row.node}: {row.problem}" for row in self.rows if row.problem]


def prove(datapath: str, width: int, names: list[str], pool: Executor, say: Say) -> Run:
    """All obligations of some nodes."""
    run = Run(datapath, width)
    start = shown = time.monotonic()
    done = 0

    def progress(problem: str) -> None:
        nonlocal done, shown
        done += 1
        now = time.monotonic()
        if problem:
            say(f"FAIL {datapath}, W={width}: {problem}")
        if now - shown > 20:
            say(f"     {datapath}, W={width}: {done} operators and nodes, {now - start:.0f} s")
            shown = now

    try:
        run.design = Design(datapath, width, BUILD / f"{datapath}{width}")
        run.rows = run.design.run(names, pool, progress)
        run.lemmas = list(run.design.lemmas.values())
    except (ObligationError, NetlistError) as error:
        run.problem = str(error)
    run.seconds = time.monotonic() - start
    verdict = "FAIL" if run.failed else "ok  "
    say(f"{verdict} {datapath}, W={width}: {len(run.rows)} nodes, {len(run.lemmas)} operators, {run.seconds:.0f} s")
    return run


def survives(number: int, runs: dict[str, Run], pool: Executor) -> str:
    """Seeds a bug: why the proof of its node does not fail on it, or an empty text if it fails as it should."""
    case = BUGS[number]
    bug = case.bug
    try:
        inside = bug.file.startswith(LIB) and case.datapath in runs and case.width == FULL
        like = runs[case.datapath].design if inside else None
        design = Design(case.datapath, case.width, BUILD / f"bug{number}", bug, like)
        row = design.run([case.node], pool, lambda problem: None)[0]
    except LookupError as error:
        return f"cannot be seeded: {error}"
    except (ObligationError, NetlistError) as error:
        return f"cannot be built: {error}"
    if not row.problem:
        return f"survives: {case.node} is still proved"
    return "" if bug.fails in row.problem else f"{case.node} fails otherwise: {row.problem}"


@dataclass
class Sweep:
    """Every format of a datapath a bit shorter: nodes tried, those still proved, and what is not as expected."""

    datapath: str
    tried: list[str] = field(default_factory=list)
    survive: list[str] = field(default_factory=list)
    seconds: float = 0.0
    problem: str = ""


def sweep(datapath: str, pool: Executor, say: Say) -> Sweep:
    """Takes an integer bit from the result of every operator that rounds: all must fail that have none to spare."""
    found, start = Sweep(datapath), time.monotonic()
    try:
        design = Design(datapath, SWEEP, BUILD / f"{datapath}_shorter")
        found.tried = design.shorten()
        rows = design.run(found.tried, pool, lambda problem: None)
    except (ObligationError, NetlistError) as error:
        found.problem = str(error)
        return found
    found.survive = [row.node for row in rows if not row.problem.startswith("does not fit")]
    wrong = [name for name in found.survive if not design.spare(name)]
    found.problem = f"with a bit less, not as the table says: {', '.join(wrong)}" if wrong else ""
    found.seconds = time.monotonic() - start
    fail = f"{len(found.tried) - len(found.survive)} of {len(found.tried)} nodes fail"
    say(f"{'FAIL' if wrong else 'ok  '} {datapath}, W={SWEEP}, a bit shorter: {fail}, {found.seconds:.0f} s")
    return found


@dataclass
class Found:
    """What came out of a run: bugs with the seconds that each took to be noticed, and a line for all that failed."""

    runs: list[Run] = field(default_factory=list)
    bugs: list[tuple[NodeBug, float]] = field(default_factory=list)
    sweeps: list[Sweep] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    seconds: float = 0.0


def chosen(datapath: str, width: int, only: Sequence[str]) -> list[str]:
    """The nodes of a datapath that were asked for, `paper/s` or `s`; all if none was."""
    names = list(model_nodes(datapath, width))
    return [n for n in names if not only or n in only or f"{datapath}/{n}" in only or datapath in only]


def run(widths: Sequence[int], only: Sequence[str], say: Say) -> Found:
    """Proofs, then bugs, then, with all nodes of the full width, shorter formats."""
    found, start = Found(), time.monotonic()
    pool = ThreadPoolExecutor(cpu_count())
    several = ThreadPoolExecutor(cpu_count())  # bugs, which wait for the pool
    try:
        for width in widths:
            for datapath in DATAPATHS:
                if names := chosen(datapath, width, only):
                    found.runs.append(prove(datapath, width, names, pool, say))
                    found.failed += found.runs[-1].failed
        plain = {run.datapath: run for run in found.runs if run.width == FULL and run.design}
        wanted = [
            number
            for number, case in enumerate(BUGS)
            if case.datapath in plain and case.node in chosen(case.datapath, FULL, only)
        ]

        def seeded(number: int) -> tuple[str, float]:
            began = time.monotonic()
            return survives(number, plain, pool), time.monotonic() - began

        for number, (wrong, took) in zip(wanted, several.map(seeded, wanted), strict=True):
            case = BUGS[number]
            found.bugs.append((case, took))
            if wrong:
                found.failed.append(f"seeded bug '{case.bug.what}' in {case.bug.file}: {wrong}")
                say(f"FAIL {found.failed[-1]}")
            else:
                said = f"{case.datapath}/{case.node} fails as it should: {case.bug.what} ({case.bug.fails})"
                say(f"ok   {said} {took:.1f} s")
        if tuple(widths) == (FULL,) and not only:
            found.sweeps = [sweep(datapath, pool, say) for datapath in DATAPATHS]
            found.failed += [f"{s.datapath}: {s.problem}" for s in found.sweeps if s.problem]
    except BaseException:
        running.stop()
        raise
    finally:
        several.shutdown(wait=False, cancel_futures=True)
        pool.shutdown(cancel_futures=True)
    found.seconds = time.monotonic() - start
    nodes = sum(len(run.rows) for run in found.runs)
    say(f"{nodes} nodes, {len(found.bugs)} seeded bugs, {len(found.failed)} failures, {found.seconds:.0f} s")
    return found

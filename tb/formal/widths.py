# SPDX-License-Identifier: Apache-2.0
"""No node overflows, at the word lengths besides the full one: a run of :mod:`tb.formal.overflow` a width, and a bug.

What has gone through is kept in build/formal_ranges under a digest of RTL, properties, ranges and tools: a repeated run
is quick, an interrupted one resumes.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from model.dataflow.nodes import WIDTHS
from tb.formal import overflow
from tb.formal.design import ObligationError
from tb.formal.exact_values import SECTIONS, properties
from tb.formal.netlist import NetlistError
from tb.formal.obligations import Design
from tb.formal.range_bugs import BUGS, FULL, NodeBug
from tb.formal.range_table import DATAPATHS, table
from tb.formal.tools import versions
from tb.sim.env import ROOT
from tb.sim.sources import code

OTHERS = [width for width in WIDTHS if width != FULL]
LIGHT = ("lean",)
"""What every `make formal` does; the paper's datapath takes three times as long."""

SEEDED = {"paper": "product with an integer bit too few", "lean": "three-tile product with two integer bits too few"}
"""Datapath -> the bug of :data:`tb.formal.range_bugs.BUGS` that each width has to notice."""


@dataclass
class Result:
    """What came out of one datapath at one width; `ruled`: nodes that fit by a rule; `seeded`: seconds of its bug."""

    datapath: str
    width: int
    nodes: int = 0
    ruled: int = 0
    operators: int = 0
    seconds: float = 0.0
    seeded: float = 0.0
    failed: list[str] = field(default_factory=list)


def bug(datapath: str, width: int) -> NodeBug:
    """The bug of a width."""
    return replace(next(case for case in BUGS if case.bug.what == SEEDED[datapath]), width=width)


def sources() -> list[str]:
    """RTL and properties, of all widths."""
    files = [path for pattern in overflow.FILES for path in ROOT.glob(pattern)]
    return [*(code(path) for path in sorted(files)), *(properties(section) for section in SECTIONS)]


def digest(datapath: str, width: int, read: list[str]) -> str:
    """Of all that a result depends on, but for the proofs' own code; ``read``: the sources."""
    text = [*read, repr(sorted(table(datapath, width).items())), repr(bug(datapath, width))]
    return hashlib.sha256("\0".join(text).encode()).hexdigest()[:16]


def kept(datapath: str, width: int) -> Path:
    """Where its result is kept."""
    tools = hashlib.sha256(versions().encode()).hexdigest()[:8]
    return overflow.BUILD / f"width_{datapath}{width}-{digest(datapath, width, sources())}-{tools}.json"


def recall(datapath: str, width: int) -> Result | None:
    """A result of an earlier run."""
    path = kept(datapath, width)
    return Result(**json.loads(path.read_text())) if path.exists() else None


def survives(case: NodeBug, pool: Executor) -> str:
    """Why the proof of a node does not fail on a seeded bug, or an empty text if it fails as it should."""
    try:
        design = Design(case.datapath, case.width, overflow.BUILD / f"{case.datapath}{case.width}_bug", case.bug)
        row = design.run([case.node], pool, lambda problem: None)[0]
    except (LookupError, ObligationError, NetlistError) as error:
        return str(error)
    return "" if case.bug.fails in row.problem else f"survives: {case.node}: {row.problem or 'is still proved'}"


def run(datapath: str, width: int, pool: Executor, say: Callable[[str], None], again: bool = False) -> Result:
    """One width, all its nodes and its bug."""
    path = kept(datapath, width)
    if not again and (result := recall(datapath, width)):
        say(f"ok   {datapath}, W={width}: as before, {result.seconds:.0f} s")
        return result
    found = overflow.prove(datapath, width, overflow.chosen(datapath, width, ()), pool, say)
    result = Result(datapath, width, len(found.rows), operators=len(found.lemmas), seconds=found.seconds)
    result.failed = found.failed
    if found.design:
        result.ruled = sum(row.fits == found.design.ranges[row.node].rule != "" for row in found.rows)
    case, start = bug(datapath, width), time.monotonic()
    if wrong := survives(case, pool):
        result.failed.append(f"{datapath}, W={width}: seeded bug '{case.bug.what}': {wrong}")
    else:
        say(f"ok   {datapath}, W={width}: {case.node} fails as it should: {case.bug.what}")
    result.seeded = time.monotonic() - start
    for line in result.failed:
        say(f"FAIL {line}")
    if not result.failed and path == kept(datapath, width):
        path.write_text(json.dumps(asdict(result)))
    return result


def digests() -> dict[str, str]:
    """Datapath and width -> what its proof is about."""
    read = sources()
    return {f"{datapath}, W={width}": digest(datapath, width, read) for datapath in DATAPATHS for width in OTHERS}

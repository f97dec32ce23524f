# SPDX-License-Identifier: Apache-2.0
"""Proof on the elaborated RTL, at one word length, that no node of the lean datapath overflows.

Each operator's guard bits equal its sign for operands in the ranges of the word-length table
(:mod:`tb.formal.obligations`), and the proof of one node fails on a seeded bug.
"""

from __future__ import annotations

import time
from concurrent.futures import Executor

from tb.formal.bugs import BUGS
from tb.formal.claims import Row
from tb.formal.design import PROPERTIES, ObligationError
from tb.formal.exact_values import SECTIONS, properties
from tb.formal.netlist import NetlistError
from tb.formal.obligations import Design
from tb.formal.range_table import table
from tb.formal.task import Outcome, Say, digest_of
from tb.sim.env import ROOT
from tb.sim.sources import closure, code

BUILD = ROOT / "build" / "formal_ranges"
SEEDED = "cc"
"""The node whose proof must fail on the seeded bug."""


def digest(width: int) -> str:
    """Return the digest of RTL, properties and ranges."""
    texts = [code(path) for path in (*closure("ik_lean"), *sorted(PROPERTIES.glob("*.vh")))]
    return digest_of(*texts, *map(properties, SECTIONS), repr(sorted(table(width).items())))


def survives(width: int, pool: Executor) -> str:
    """Seed the bug; return the reason if the node's proof does not fail, else an empty text."""
    bug = BUGS["ranges"]
    row = Design(width, BUILD / f"lean{width}_bug", bug).run([SEEDED], pool, lambda problem: None)[0]
    return "" if bug.fails in row.problem else f"survives: {SEEDED}: {row.problem or 'is still proved'}"


def _cells(row: Row, design: Design) -> list[str]:
    node, held = design.nodes[row.node], design.ranges[row.node]
    fmt = node.format
    size = f"{'s' if fmt.signed else 'u'}{fmt.width}.{fmt.frac}"
    span = f"{held.low * fmt.ulp:.6g} .. {held.high * fmt.ulp:.6g}"
    engine = [row.engine, str(row.depth), f"{row.seconds:.1f}"] if row.engine else ["-", "-", "-"]
    module = [f"`{row.module}`", row.parameters, row.operands]
    return [row.node, node.equation or "-", size, span, *module, row.fits, row.range, *engine]


HEAD = "node equation format range module parameters operands fits-by in-range-by engine depth seconds".split()


def run(width: int, pool: Executor, say: Say, names: list[str] | None = None) -> Outcome:
    """Prove all nodes, or the nodes ``names``, and that the seeded bug is found."""
    start = shown = time.monotonic()
    done, outcome = 0, Outcome()

    def progress(problem: str) -> None:
        nonlocal done, shown
        done, now = done + 1, time.monotonic()
        if problem:
            outcome.failed.append(problem)
            say(f"     W={width}: {problem}")
        elif now - shown > 20:
            say(f"     W={width}: {done} operators and nodes, {now - start:.0f} s")
            shown = now

    try:
        design = Design(width, BUILD / f"lean{width}")
        rows = design.run(names or list(design.nodes), pool, progress)
        outcome.result = f"{len(rows)} nodes, {len(design.lemmas)} operators"
        outcome.table = [HEAD, *(_cells(row, design) for row in rows)]
        for lemma in design.lemmas.values():
            outcome.table += [[lemma.module, claim.name, claim.engine, claim.answer.said] for claim in lemma.claims]
        if wrong := survives(width, pool):
            outcome.failed.append(f"seeded bug: {wrong}")
    except (LookupError, ObligationError, NetlistError) as error:
        outcome.failed.append(str(error))
    outcome.seconds = time.monotonic() - start
    return outcome

# SPDX-License-Identifier: Apache-2.0
"""docs/generated/ranges_proofs.md of a run of tb/formal/overflow.py."""

from __future__ import annotations

from datetime import date

from scripts.generate.render import render
from tb.formal.claims import Lemma, Row, spell
from tb.formal.overflow import Found, Run
from tb.formal.range_bugs import FULL, SWEEP
from tb.formal.range_table import CASES
from tb.formal.tools import versions


def page(found: Found, digests: dict[str, str]) -> str:
    """The page of a full run."""
    counts = [_counts(run) for run in found.runs]
    wrapping = [(row, run) for run in found.runs for row in run.rows if "SAT=0" in row.parameters]
    return render(
        "ranges_proofs", today=date.today().isoformat(), tools=versions(), seconds=found.seconds,
        full=FULL, short=SWEEP, cases=CASES, summary=[(name, [c[name] for c in counts]) for name in counts[0]],
        wrapping=wrapping, ruled=[row for row, run in wrapping if row.fits == _rule(row, run)],
        runs=found.runs, rows={run.datapath: [_cells(row, run) for row in run.rows] for run in found.runs},
        lemmas=_lemmas(found.runs), bugs=found.bugs, sweeps=found.sweeps, digests=digests,
    )  # fmt: skip


def _rule(row: Row, run: Run) -> str:
    return run.design.ranges[row.node].rule


def _cells(row: Row, run: Run) -> list[str]:
    """A node's row of the table."""
    node, held = run.design.nodes[row.node], run.design.ranges[row.node]
    fmt = node.format

    def reason(text: str) -> str:
        plain = text.replace("|", "\\|")
        return f"*{plain}*" if text and text == _rule(row, run) else plain

    return [
        f"`{row.node}`",
        node.equation or "-",
        f"{'s' if fmt.signed else 'u'}{fmt.width}.{fmt.frac}",
        f"{held.low * fmt.ulp:.6g} .. {held.high * fmt.ulp:.6g}",
        f"`{row.module}`",
        row.parameters,
        row.operands,
        reason(row.fits),
        reason(row.range),
        row.engine or "-",
        "-" if row.depth is None else str(row.depth),
        f"{row.seconds:.1f}" if row.engine else "-",
    ]


def _lemmas(runs: list[Run]) -> list[list[str]]:
    """The operators' own properties, those of equal parameters once."""
    lemmas: dict[tuple, Lemma] = {}
    for lemma in (lemma for run in runs for lemma in run.lemmas):
        lemmas.setdefault((lemma.module, lemma.parameters), lemma)
    found = []
    for lemma in lemmas.values():
        for engine in ("bit vectors", "integers"):
            claims = [c for c in lemma.claims if c.engine == engine]
            if claims:
                names = ", ".join(f"`{c.name}`" for c in claims)
                seconds = sum(c.answer.seconds for c in claims)
                cells = [f"`{lemma.module}`", spell(lemma.parameters), names, engine, str(claims[0].depth)]
                found.append([*cells, f"{seconds:.1f}"])
    return found


def _counts(run: Run) -> dict[str, int]:
    """How many nodes fit for which reason."""
    rows = run.rows
    bits = [r for r in rows if r.fits in ("one bit", "any word")]
    rules = [r for r in rows if r.fits and r.fits.split("; limited")[0] == _rule(r, run)]
    limited = [r for r in rows if "limited" in r.fits]
    elsewhere = [r for r in rows if not r.engine and r not in bits and r not in limited]
    special = {r.node for r in (*bits, *rules, *limited, *elsewhere)}
    return {
        "nodes": len(rows),
        "inputs and one-bit nodes: nothing to overflow": len(bits),
        "fits for operands in their ranges, or for any": len(rows) - len(special),
        "fits by a rule": len([r for r in rules if r not in limited]),
        "limited on purpose": len(limited),
        "range shown elsewhere": len(elsewhere),
        "operators with their parameters": len(run.lemmas),
    }

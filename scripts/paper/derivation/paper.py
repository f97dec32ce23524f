# SPDX-License-Identifier: Apache-2.0
"""Derive equations (10)-(19) of the paper symbolically from its geometry and write docs/generated/derivation.md.

The left side of each comparison is the result of model/reference/geometry.py for symbols; the right side is PRINTED,
the equations as printed. Every row must be equal, except the rows of KNOWN_WRONG, which must differ; any other verdict
gives exit status 1.
"""

from __future__ import annotations

from scripts.generate.render import render
from scripts.paper.derivation import paper_steps
from scripts.paper.derivation.markdown import aligned, cell, write_page
from scripts.paper.derivation.paper_proofs import Row, Section
from scripts.paper.derivation.printed import FACTOR, KNOWN_WRONG, PRINTED, TEX, latex, tex
from tb.sim.env import GENERATED

PAGE = GENERATED / "derivation.md"

STEPS = (
    paper_steps.swivel_plane,
    paper_steps.point_pair,
    paper_steps.sums,
    paper_steps.elbow_point,
    paper_steps.elbow_quaternion,
    paper_steps.rotate_to_elbow,
    paper_steps.rotate_to_wrist,
    paper_steps.product,
)


def derive(printed: dict = PRINTED) -> list[Section]:
    """Derive all sections. `printed` may be an altered copy of PRINTED."""
    return [step(printed) for step in STEPS]


def unexpected(sections: list[Section]) -> list[str]:
    """Return the verdicts that differ from the expected ones."""
    found = []
    for section in sections:
        for row in section.rows:
            wrong = (row.equation, row.name) in KNOWN_WRONG
            expected = "differs" if wrong else "factor" if FACTOR.get(row.equation, 1) != 1 else "equal"
            if row.verdict != expected or row.method.startswith("undecided"):
                found.append(f"({row.equation}) {row.name}: {row.verdict}, expected {expected}; {row.method}")
        for fact in section.facts:
            if fact.holds == (fact.equation == "fact false") or fact.method.startswith("undecided"):
                found.append(f"{section.title}: {fact.name}: {'holds' if fact.holds else 'does not hold'}")
    return found


def page(sections: list[Section]) -> str:
    """Render docs/generated/derivation.md."""
    groups: dict[tuple[str, str], list[Row]] = {}
    equations = list(dict.fromkeys(row.equation for section in sections for row in section.rows))
    for equation in equations:
        for verdict in ("equal", "factor", "differs"):
            for section in sections:
                for row in section.rows:
                    if (row.equation, row.verdict) == (equation, verdict):
                        groups.setdefault((equation, verdict), []).append(row)
    summary = [
        {
            "equation": equation,
            "names": ", ".join(f"${cell(TEX[row.name])}$" for row in rows),
            "verdict": _verdict(rows[0]),
            "methods": "; ".join(dict.fromkeys(row.method for row in rows)),
        }
        for (equation, _), rows in groups.items()
    ]
    return render(
        "derivation",
        summary=summary,
        refuted=[fact for section in sections for fact in section.facts if fact.equation == "fact false"],
        sections={step.__name__: section for step, section in zip(STEPS, sections, strict=True)},
        derived=lambda section: [(TEX[row.name], latex(row.derived)) for row in section.rows],
        printed=lambda section: [(TEX[row.name], tex(PRINTED[row.equation][row.name])) for row in section.rows],
        differences=lambda rows: [(rf"\Delta {TEX[row.name]}", latex(row.difference)) for row in rows],
        tex=TEX,
        latex=latex,
        verdict=_verdict,
        cell=cell,
        aligned=aligned,
    )


def _verdict(row: Row) -> str:
    if row.verdict == "factor":
        return f"equal up to the factor {row.factor}"
    return {"equal": "equal", "differs": "**print wrong**"}[row.verdict]


def write() -> int:
    """Derive and write derivation.md; return 1 if a statement does not hold."""
    sections = derive()
    proved = f"{sum(len(s.rows) for s in sections)} printed rows, {sum(len(s.facts) for s in sections)} statements"
    return write_page(PAGE, page(sections), [f"unexpected: {line}" for line in unexpected(sections)], proved)

# SPDX-License-Identifier: Apache-2.0
"""Derives the lean dataflow from the paper's equations (10)-(18), with symbols, and writes docs/generated/lean.md.

The paper's side of every comparison is the table of model/reference/printed.py with the one edit that
scripts/derive/paper.py proves to be needed. The lean side is the table of model/reference/lean_table.py; a test holds
model/reference/lean_equations.py against it.
The status is 1 when a statement does not hold, and the step is named.
"""

from __future__ import annotations

import sys

from model.reference.lean_table import NUMBER
from scripts.derive import lean_counts, lean_geometry, lean_quaternion
from scripts.derive.lean_forms import TEX, Tables, line_tex
from scripts.derive.lean_proofs import Step
from scripts.derive.markdown import aligned, cell, write
from scripts.pages.render import render
from tb.sim.env import GENERATED

PAGE = GENERATED / "lean.md"

STEPS = (
    lean_geometry.directions, lean_geometry.swivel, lean_geometry.elbow, lean_geometry.elbow_quaternion,
    lean_geometry.shoulder, lean_geometry.factors, lean_quaternion.half, lean_quaternion.product,
    lean_quaternion.length, lean_quaternion.shifts, lean_quaternion.near_singular, lean_counts.counts,
)  # fmt: skip


def derive(tables: Tables | None = None) -> list[Step]:
    """All steps."""
    return [step(tables or Tables()) for step in STEPS]


def unexpected(steps: list[Step]) -> list[str]:
    """Statements that do not hold, with their step. Empty if all is well."""
    return [
        f"step {step.title}: {check.statement}: does not hold; left minus right: {check.rest}"
        for step in steps
        for check in step.checks
        if not check.holds
    ]


def page(steps: list[Step], tables: Tables | None = None) -> str:
    """docs/generated/lean.md."""
    tables = tables or Tables()
    halves = [
        ("h(c, s) = (h_c(c, s), h_s(c, s))", rf"\left({line_tex(c)},\ {line_tex(s)}\right) \text{{ for }} {branch}")
        for branch, (c, s) in zip((r"c \ge 0", "c < 0"), tables.half.values(), strict=True)
    ]
    named = {function.__name__: step for function, step in zip(STEPS, steps, strict=True)}
    return render(
        "lean", groups=tables.lean, number=NUMBER, tex=TEX, line_tex=line_tex, halves=halves, steps=named,
        cell=cell, aligned=aligned,
    )  # fmt: skip


def make() -> tuple[str, list[str], str]:
    """What `markdown.write` writes."""
    steps = derive()
    return page(steps), unexpected(steps), f"{len(steps)} steps, {sum(len(step.checks) for step in steps)} statements"


def main(arguments: list[str] | None = None) -> int:
    return write("derive.lean", __doc__.splitlines()[0], PAGE, make, arguments)


if __name__ == "__main__":
    sys.exit(main())

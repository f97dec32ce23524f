# SPDX-License-Identifier: Apache-2.0
"""Derive the lean dataflow symbolically from the paper's equations (10)-(18) and write docs/generated/lean.md.

The paper's side of each comparison is the table of model/reference/printed.py with the one correction that
scripts/paper/derivation/paper.py proves necessary. The lean side is the table of model/reference/lean_equations.py.
If a statement fails, the exit status is 1 and the step is printed.
"""

from __future__ import annotations

from model.reference.lean_equations import NUMBER
from scripts.generate.render import render
from scripts.paper.derivation import lean_counts, lean_geometry, lean_quaternion
from scripts.paper.derivation.lean_forms import TEX, Tables, line_tex
from scripts.paper.derivation.lean_proofs import Step
from scripts.paper.derivation.markdown import aligned, cell, write_page
from tb.sim.env import GENERATED

PAGE = GENERATED / "lean.md"

STEPS = (
    lean_geometry.directions,
    lean_geometry.swivel,
    lean_geometry.elbow,
    lean_geometry.elbow_quaternion,
    lean_geometry.shoulder,
    lean_geometry.factors,
    lean_quaternion.half,
    lean_quaternion.product,
    lean_quaternion.length,
    lean_quaternion.shifts,
    lean_quaternion.near_singular,
    lean_counts.counts,
)


def derive(tables: Tables | None = None) -> list[Step]:
    """Derive all steps."""
    return [step(tables or Tables()) for step in STEPS]


def unexpected(steps: list[Step]) -> list[str]:
    """Return the statements that do not hold, each with its step."""
    return [
        f"step {step.title}: {check.statement}: does not hold; left minus right: {check.rest}"
        for step in steps
        for check in step.checks
        if not check.holds
    ]


def page(steps: list[Step], tables: Tables | None = None) -> str:
    """Render docs/generated/lean.md."""
    tables = tables or Tables()
    halves = [
        ("h(c, s) = (h_c(c, s), h_s(c, s))", rf"\left({line_tex(c)},\ {line_tex(s)}\right) \text{{ for }} {branch}")
        for branch, (c, s) in zip((r"c \ge 0", "c < 0"), tables.half.values(), strict=True)
    ]
    named = {function.__name__: step for function, step in zip(STEPS, steps, strict=True)}
    return render(
        "lean",
        groups=tables.lean,
        number=NUMBER,
        tex=TEX,
        line_tex=line_tex,
        halves=halves,
        steps=named,
        cell=cell,
        aligned=aligned,
    )


def write() -> int:
    """Derive and write lean.md; return 1 if a statement does not hold."""
    steps = derive()
    proved = f"{len(steps)} steps, {sum(len(step.checks) for step in steps)} statements"
    return write_page(PAGE, page(steps), unexpected(steps), proved)

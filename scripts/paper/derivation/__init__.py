# SPDX-License-Identifier: Apache-2.0
"""Symbolic derivations of the paper's equations and of the lean dataflow, and their pages derivation.md and lean.md."""

import sys
from collections.abc import Mapping

from model.dataflow.lean import SECTIONS
from scripts.generate.render import render
from scripts.paper.derivation import lean, paper
from scripts.paper.derivation.proofs import Step, aligned, derive, failures, tex
from tb.sim.env import GENERATED

STEPS = {"derivation": paper.STEPS, "lean": lean.STEPS}  # page -> its steps


def page(name: str, steps: Mapping[str, Step]) -> str:
    """Return docs/generated/<name>.md."""
    halves = {
        rf"h(c, s) \text{{ for }} {branch}".replace(">=", r"\ge"): rf"\left({tex(c)},\ {tex(s)}\right)"
        for branch, (c, s) in lean.HALF.items()
    }
    proofs = {step: done.block() for step, done in steps.items()}
    sections = {title: [] for title in SECTIONS.values()}
    for node in lean.NODES.values():
        if node.kind != "input":
            sections[SECTIONS[node.section]].append(f"{node.name} = {node.right_side}")
    return render(name, proofs=proofs, sections=sections, halves=aligned(halves))


def write() -> int:
    """Derive and write both pages; if statements do not hold, print them and return 1."""
    for name, functions in STEPS.items():
        steps = derive(functions)
        if wrong := failures(steps):
            print(*wrong, f"{name}.md not written", sep="\n", file=sys.stderr)
            return 1
        (GENERATED / f"{name}.md").write_text(page(name, steps), encoding="utf-8")
        print(f"wrote {name}.md: {len(steps)} steps, {sum(len(step.statements) for step in steps.values())} statements")
    return 0

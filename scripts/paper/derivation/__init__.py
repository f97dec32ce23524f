# SPDX-License-Identifier: Apache-2.0
"""Symbolic derivations of the paper's equations and of the lean dataflow, and their pages derivation.md and lean.md."""

from collections.abc import Mapping
from pathlib import Path

from model.dataflow.lean import SECTIONS
from scripts.generate.render import render
from scripts.paper.derivation import lean, paper
from scripts.paper.derivation.proofs import ProofError, Step, aligned, derive, failures, tex
from tb.sim.env import GENERATED

STEPS = {"derivation": paper.STEPS, "lean": lean.STEPS}  # page -> its steps


def page(name: str, steps: Mapping[str, Step]) -> str:
    halves = {
        rf"h(c, s) \text{{ for }} {branch}".replace(">=", r"\ge"): rf"\left({tex(c)},\ {tex(s)}\right)"
        for branch, (c, s) in lean.HALF.items()
    }
    proofs = {step: done.block() for step, done in steps.items()}
    shown = [(n.section, f"{n.name} = {n.right_side}") for n in lean.NODES.values() if n.kind != "input"]
    sections = {title: [text for where, text in shown if where == part] for part, title in SECTIONS.items()}
    return render(name, proofs=proofs, sections=sections, halves=aligned(halves))


def texts() -> dict[Path, str]:
    """Run all derivations; return a dict: page -> text. Raises ProofError if statements do not hold."""
    steps = {name: derive(functions) for name, functions in STEPS.items()}
    if wrong := [line for proved in steps.values() for line in failures(proved)]:
        raise ProofError("\n".join(wrong))
    return {GENERATED / f"{name}.md": page(name, proved) for name, proved in steps.items()}

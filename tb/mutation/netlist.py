# SPDX-License-Identifier: Apache-2.0
"""Mutants by Yosys' ``mutate``: a bit of a port of a cell stuck, inverted, or inverted by another bit of it.

A machine is elaborated with one set of parameters; its netlist holds many mutants at once, and a number switches one
on.  What the first bench does not notice is given to Yosys as a miter of the module that it is in, then to larger
benches, then to miters of the modules around it.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
import re
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from tb.axi.instances import echoing
from tb.mutation import nodes
from tb.mutation.equivalence import SECONDS, YOSYS, Values, alike, chparam, copied, plain, read, signed, yosys
from tb.mutation.killers import (
    BUILD,
    KILLED,
    LEAST,
    MEASURED,
    PROVED,
    SAME,
    SURVIVED,
    TIMES,
    BuildError,
    Killer,
    around_the_core,
    ended,
    finished,
    flat_unit,
    memory,
    parts,
    rtl_digest,
)
from tb.mutation.nodes import Nodes
from tb.sim.env import ROOT
from tb.sim.runner import alone
from tb.sim.sources import sources

SELECT, BITS = "mutant", 16
"""The plusarg, and the register of the top, that says which mutant is on; 0 none."""
EACH = 24
"""Mutants of a file in the netlist of a machine."""
CLOCKS = {"clk", "CLK", "WR_CLK"}
"""What the solver does not look at."""
LEFT_OUT = {"RD_CLK", "RD_EN", "RD_ARST", "RD_SRST", "Q"}
"""Ports: tied, as memories are read between clocks, and Yosys writes no Verilog of others; a register's output would
lose its initial value, and its input does as well."""
OPTIONS = ("-mode", "-module", "-cell", "-port", "-portbit", "-ctrlbit")


@dataclass(frozen=True)
class Machine:
    """A top as it is built, and who looks at it, the quick one first: benches of its nodes, or the jobs of tb/axi."""

    name: str
    top: str
    parameters: Values
    benches: tuple[Nodes | Killer, ...]

    @property
    def of_memory(self) -> bool:
        return self.top == "ik_axi"

    def has(self, file: str) -> bool:
        """Whether a file may be changed in it: of memory to memory what is around the core."""
        return around_the_core(file) if self.of_memory else file in parts(self.benches[0].path.rtl)


def _of_nodes(*benches: Nodes) -> Machine:
    name = " ".join(benches[0].name.split()[1:-1])
    return Machine(name, "ik_axis", tuple(benches[0].parameters.items()), benches)


def _of_memory(jobs: Killer, **parameters: int) -> Machine:
    return Machine(jobs.name, "ik_axi", tuple(parameters.items()), (jobs,))


MACHINES = (
    _of_nodes(Nodes("lean", 18, 250), Nodes("lean", 18, 4000, corners=True)),
    _of_nodes(Nodes("lean", 32, 300, corners=True), Nodes("lean", 32, 3000, corners=True)),
    _of_nodes(Nodes("fold", 20, 50), Nodes("fold", 20, 400)),
    _of_nodes(Nodes("fold", 32, 50), Nodes("fold", 32, 400)),
    _of_nodes(Nodes("paper", 18, 250), Nodes("paper", 18, 3000)),
    _of_nodes(Nodes("paper", 18, 200, digit=1), Nodes("paper", 18, 3000, digit=1)),
    _of_memory(memory(3, 64, jobs=16), W=18, LOG2_BURST=3, DATA_W=64),
    _of_memory(memory(1, 32, jobs=16), W=18, LOG2_BURST=1, DATA_W=32),
)


@dataclass(frozen=True)
class Wired:
    """A mutant of a machine's netlist: ``command`` is what Yosys is told, ``number`` switches it on."""

    file: str
    machine: str
    seed: int
    number: int
    line: int
    command: str

    @functools.cached_property
    def told(self) -> dict[str, str]:
        """Option -> value."""
        return {key[1:]: value for key, value in itertools.pairwise(self.command.split()) if key in OPTIONS}

    @property
    def key(self) -> str:
        of = [self.command, netlist(self.machine, self.seed).key]
        return hashlib.sha256(json.dumps(of).encode()).hexdigest()[:16]

    @property
    def operator(self) -> str:
        return f"mutate {self.told['mode']}"

    def lines(self) -> tuple[str, str]:
        """The line of the Verilog that the cell comes from; which bit of it is changed, in which machine."""
        before = (ROOT / self.file).read_text(encoding="utf-8").splitlines()[self.line - 1]
        told = self.told
        cell = told["cell"].split("$")[1] if told["cell"].startswith("$") else told["cell"]
        by = f" with bit {told['ctrlbit']}" if "ctrlbit" in told else ""
        place = f"{plain_name(told['module'])}: {cell}.{told['port']}[{told['portbit']}]"
        return " ".join(before.split()), f"{told['mode']} {place}{by}, {self.machine}"


def plain_name(module: str) -> str:
    """Of a module as Yosys names it with its parameters, the name in the sources."""
    return next(part for part in reversed(module.split("\\")) if "=" not in part)


@dataclass(frozen=True)
class Netlist:
    """What Yosys makes of a machine, kept in build/: the design, the mutants of a seed, Verilog that holds them all."""

    of: Machine
    seed: int

    @functools.cached_property
    def key(self) -> str:
        own = [self.of.top, self.of.parameters, EACH, sorted(LEFT_OUT), self.seed]
        own += [rtl_digest(), metadata.version(YOSYS)]
        return hashlib.sha256(json.dumps(own).encode()).hexdigest()[:16]

    @functools.cached_property
    def folder(self) -> Path:
        folder = BUILD / "netlists" / f"{self.of.name.replace(' ', '-')}-{self.key}"
        with alone(folder.parent):
            if not (folder / "mutants.json").exists():
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir(parents=True)
                self._make(folder)
        return folder

    def _make(self, folder: Path) -> None:
        within = folder.relative_to(ROOT)
        if self.of.of_memory:
            echoing(folder)
        else:
            shutil.copytree(ROOT / "rtl", folder / "rtl")
        design = f"read_rtlil {within}/design.il"
        run(folder, [
            *read(folder, self.of.top), f"hierarchy -check -top {self.of.top} {chparam(self.of.parameters)}",
            "proc", "memory_collect", f"write_rtlil {within}/design.il", f"write_json {within}/design.json",
        ])  # fmt: skip
        modules = json.loads((folder / "design.json").read_text())["modules"]
        (folder / "design.json").unlink()
        (folder / "parents.json").write_text(json.dumps(parents(modules)))
        own = self._modules(modules)
        found: list[Wired] = []
        for file, names in own.items():
            run(folder, [design, f"mutate -list {EACH} -seed {self.seed} -o {within}/list.txt {' '.join(names)}"])
            for command in (folder / "list.txt").read_text().splitlines():
                if set(command.split()) & LEFT_OUT:
                    continue
                where = re.search(rf"-src \S*{re.escape(file)}:(\d+)", command)
                line = int(where[1]) if where else 1
                command = re.sub(r" -(?:src|wire|wirebit) \S+", "", command)
                found.append(Wired(file, self.of.name, self.seed, len(found) + 1, line, command))
        wired = [f"{one.command} -ctrl {SELECT} {BITS} {one.number}" for one in found]
        run(folder, [design, *wired, f"write_verilog -noattr {within}/netlist.v"])
        given = {name: signed(bits) for name, bits in modules[self.of.top]["parameter_default_values"].items()}
        (folder / "netlist.v").write_text(switched((folder / "netlist.v").read_text(), self.of.top, given))
        (folder / "mutants.json").write_text(json.dumps([[m.file, m.number, m.line, m.command] for m in found]))

    def _modules(self, modules: dict) -> dict[str, list[str]]:
        """File -> its modules in the design."""
        files = {path.stem: path.relative_to(ROOT).as_posix() for path in sources()}
        found: dict[str, list[str]] = {}
        for name in modules:
            file = files.get(plain_name(name), "")
            if self.of.has(file):
                found.setdefault(file, []).append(name)
        return dict(sorted(found.items()))

    @functools.cached_property
    def mutants(self) -> dict[str, list[Wired]]:
        """Of each file."""
        found: dict[str, list[Wired]] = {}
        for file, *more in json.loads((self.folder / "mutants.json").read_text()):
            found.setdefault(file, []).append(Wired(file, self.of.name, self.seed, *more))
        return found

    # ---- benches

    def ran(self, bench: Nodes | Killer, number: int, place: Path, seconds: float) -> tuple[str | None, str]:
        """As :attr:`tb.mutation.killers.Killer.ran`, with a mutant, or 0, switched on."""
        if isinstance(bench, Killer):
            top, rest = divided((self.folder / "netlist.v").read_text(), self.of.top)
            copied(place)
            for name in re.findall(r"^module (\w+)", rest, re.M):  # which no parameter tells from the source
                next((place / "rtl").rglob(f"{name}.v")).write_text("")
            (place / "rtl" / "ik_axi.v").write_text(top.replace(f"{SELECT} = 0;", f"{SELECT} = {number};"))
            (place / "rtl" / "axi" / "ik_axi_job.v").write_text(rest)
            return bench.ran(place, seconds)
        own = self.folder / bench.name.replace(" ", "-")
        with alone(own):
            if not (own / "program").exists():
                top, half = bench.written(own, netlist=True), own / "half"
                command = ["iverilog", "-g2001", "-s", nodes.TOP, "-o", half, top, self.folder / "netlist.v"]
                status, said = finished(command, own, SECONDS)
                assert status == 0, f"Icarus does not read what Yosys has made of {self.of.name}: {said[-300:]}"
                half.rename(own / "program")
        return ended(own / "program", own / nodes.DATA, place, seconds, f"+{SELECT}={number}")

    def right(self, bench: Nodes | Killer) -> dict:
        """What the netlist gives with no mutant on."""
        file = self.folder / f"{bench.name.replace(' ', '-')}.json"
        with alone(self.folder / "right"):
            if not file.exists():
                with tempfile.TemporaryDirectory(prefix="ik_") as place:
                    begin = time.monotonic()
                    wrong, measured = self.ran(bench, 0, Path(place), 10 * SECONDS)
                    assert wrong is None, f"{bench.name}: the netlist itself is wrong: {wrong}"
                    file.write_text(json.dumps({"measured": measured, "seconds": time.monotonic() - begin}))
        return json.loads(file.read_text())

    def wrong(self, bench: Nodes | Killer, number: int, place: Path) -> str | None:
        """Why the netlist is wrong with a mutant on."""
        right = self.right(bench)
        wrong, measured = self.ran(bench, number, place, max(LEAST, TIMES * right["seconds"]))
        if wrong is None and measured != right["measured"]:
            wrong = f"{MEASURED}: {measured} instead of {right['measured']}"
        return wrong

    # ---- proofs

    def flat(self, module: str, place: Path, command: str, deep: bool) -> Path:
        """Writes a module of the design, changed by a command; as :func:`tb.mutation.equivalence.flat`."""
        name = "changed" if command else "right"
        file = place / f"{name}.il"
        lines = [
            f"read_rtlil {self.folder.relative_to(ROOT)}/design.il", *([command] if command else []),
            f"hierarchy -top {module}", "flatten" if deep else "blackbox * A:top %d", "opt_clean",
            f"rename -top {name}", f"write_rtlil {file.relative_to(ROOT)}",
        ]  # fmt: skip
        if said := yosys(place, lines, SECONDS):
            raise BuildError(said)
        return file

    def versions(self, mutant: Wired, module: str, place: Path, deep: bool) -> tuple[Path, Path]:
        """A module of the design without and with a mutant in it.  Raises :class:`BuildError`."""
        kept = self.folder / "flat" / hashlib.sha256(f"{module} {deep}".encode()).hexdigest()[:16]
        with alone(kept):
            right = kept / "right.il" if (kept / "right.il").exists() else self.flat(module, kept, "", deep)
        return right, self.flat(module, place, mutant.command, deep)

    def unit(self, mutant: Wired, place: Path) -> tuple[str, str]:
        """The bench of its module that notices a mutant, with the parameters of this machine, and why; or empty."""
        module = mutant.told["module"]
        try:
            right, changed = self.versions(mutant, module, place, deep=True)
        except BuildError:
            return "", ""
        given = {name: number(value) for name, value in PARAMETER.findall(right.read_text())}
        bench = flat_unit(plain_name(module), given)
        if not bench or self._of_unit(bench, right, module, given, SECONDS):  # it does not suit these parameters
            return "", ""
        why = self._of_unit(bench, changed, module, given, TIMES * SECONDS)
        return (bench.name, why) if why else ("", "")

    def _of_unit(self, bench: Killer, flat: Path, module: str, given: dict[str, int], seconds: float) -> str | None:
        """Why a version of a module is wrong."""
        name = plain_name(module)
        with tempfile.TemporaryDirectory(prefix="ik_", dir=flat.parent) as folder:
            place = Path(folder)
            copied(place)
            (file,) = (place / "rtl").rglob(f"{name}.v")
            verilog = f"write_verilog -noattr {file.relative_to(ROOT)}"
            run(place, [f"read_rtlil {flat.relative_to(ROOT)}", f"rename -top {name}", verilog])
            head = re.compile(r"^module [^;]*;\n", re.M)
            file.write_text(head.sub(lambda m: m[0] + declared(given), file.read_text(), count=1))
            return bench.ran(place, seconds)[0]

    def stuck(self, mutant: Wired, place: Path) -> bool:
        """Whether it is no change of its module: what is stuck was so before."""
        try:
            before, after = self.versions(mutant, mutant.told["module"], place, deep=False)
        except BuildError:
            return False
        return plain(before) == plain(after)

    def same(self, mutant: Wired, module: str, place: Path, deep: bool) -> bool:
        """Whether a module is shown to be the same with a mutant in it."""
        try:
            return alike(self.versions(mutant, module, place, deep), place, unknown=False)
        except BuildError:
            return False

    def equivalent(self, mutant: Wired, place: Path, climb: bool) -> str:
        """Where a mutant is shown to make no difference: in its module, with `climb` in those around it; or empty."""
        if mutant.told["port"] in CLOCKS:
            return ""
        around = json.loads((self.folder / "parents.json").read_text())
        own = mutant.told["module"]
        with_modules = {name for names in around.values() for name in names}
        wanted, shown = {own}, []

        def differs(module: str) -> bool:
            shallow = module == own and self.same(mutant, module, place, deep=False)
            return not (shallow or (module in with_modules and self.same(mutant, module, place, deep=True)))

        while wanted:
            left = sorted(filter(differs, wanted))
            shown += wanted - {*left}
            if left and not (climb and all(around[module] for module in left)):
                return ""
            wanted = {parent for module in left for parent in around[module]}
        return ", ".join(sorted(map(plain_name, shown)))


@functools.cache
def netlist(name: str, seed: int) -> Netlist:
    return Netlist(next(of for of in MACHINES if of.name == name), seed)


def order(file: str, seed: int) -> Iterator[Wired]:
    """The mutants of a file, of each machine that has it in turns."""
    lists = [netlist(of.name, seed).mutants.get(file, []) for of in MACHINES if of.has(file)]
    for group in itertools.zip_longest(*lists):
        yield from (mutant for mutant in group if mutant)


def judged(mutant: Wired, place: Path) -> tuple[str, str, str]:
    """Verdict of a mutant, who noticed it, and how or where it is shown to make no difference; `place` is an empty
    folder of the checkout."""
    of = netlist(mutant.machine, mutant.seed)
    first, *more = of.of.benches
    if why := of.wrong(first, mutant.number, place):
        return KILLED, first.name, why
    if of.stuck(mutant, place):
        return SAME, "", ""
    if where := of.equivalent(mutant, place, climb=not more):
        return PROVED, "", where
    name, why = of.unit(mutant, place)
    if why:
        return KILLED, name, why
    for bench in more:
        if why := of.wrong(bench, mutant.number, place):
            return KILLED, bench.name, why
    where = more and of.equivalent(mutant, place, climb=True)
    return (PROVED, "", where) if where else (SURVIVED, "", "")


def run(folder: Path, lines: Sequence[str]) -> None:
    said = yosys(folder, [*lines], 10 * SECONDS)
    assert not said, f"Yosys does not make the netlist: {said}"


def parents(modules: dict) -> dict[str, list[str]]:
    """Of Yosys' JSON: module -> those that have an instance of it."""
    found: dict[str, set[str]] = {name: set() for name in modules}
    for name, module in modules.items():
        for cell in module["cells"].values():
            if cell["type"] in found:
                found[cell["type"]].add(name)
    return {name: sorted(around) for name, around in found.items()}


def switched(text: str, top: str, parameters: dict[str, int]) -> str:
    """Verilog in whose top a plusarg says which mutant is on, and parameters are what they were."""
    given = declared(parameters)
    text, ports = re.subn(rf"^(module {top}\([^;]*), {SELECT}\);", rf"\1);\n{given}", text, flags=re.M)
    head, own = text[: text.index(f"module {top}(")], text[text.index(f"module {top}(") :]
    switch = f'  reg [{BITS - 1}:0] {SELECT} = 0;\n  initial if ($value$plusargs("{SELECT}=%d", {SELECT})) ;\n'
    port = rf"  input \[{BITS - 1}:0\] {SELECT};\n  wire \[{BITS - 1}:0\] {SELECT};\n"
    own, inputs = re.subn(port, lambda _: switch, own, count=1)
    assert ports == inputs == 1, f"{top} has no {SELECT}"
    return head + own


def declared(parameters: dict[str, int]) -> str:
    """As Verilog, for a netlist whose instances still give them."""
    return "".join(f"  parameter {name} = {value};\n" for name, value in parameters.items())


PARAMETER = re.compile(r"^  parameter (?:signed )?\\(\w+) (.*)$", re.M)


def number(value: str) -> int:
    """A parameter's value as Yosys' RTLIL has it: an integer, or bits."""
    return signed(value.partition("'")[2].removeprefix("s")) if "'" in value else int(value)


def divided(text: str, top: str) -> tuple[str, str]:
    """The text of the top, and the others'."""
    begin = text.index(f"module {top}(")
    end = text.index("endmodule\n", begin) + len("endmodule\n")
    return text[begin:end], text[:begin] + text[end:]

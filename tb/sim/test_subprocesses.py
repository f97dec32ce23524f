# SPDX-License-Identifier: Apache-2.0
"""Stopped compilers and simulators leave no process and no file. scripts/tests/test_console.py covers signals."""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tb.sim import simulate, subprocesses

PARENT = """
import os, subprocess, sys, tempfile
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
tempfile.mkstemp()
print(os.getpid(), child.pid, flush=True)
child.wait()
"""


def alive(pid: int) -> bool:
    """Return True if the process is running; a zombie is not."""
    stat = Path(f"/proc/{pid}/stat")
    return stat.exists() and stat.read_text().rsplit(")", 1)[1].split()[0] != "Z"


def test_the_whole_group_ends_and_its_temporary_files_are_in_one_folder(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        with subprocesses.started(
            [sys.executable, "-c", PARENT], tmp_path, stdout=subprocess.PIPE, text=True
        ) as process:
            pids = [int(pid) for pid in process.stdout.readline().split()]
            assert len(pids) == 2 and all(map(alive, pids))
            raise KeyboardInterrupt
    assert not any(map(alive, pids))
    assert len(list(tmp_path.iterdir())) == 1


def test_a_process_that_ignores_sigterm_is_killed(tmp_path, monkeypatch):
    monkeypatch.setattr(subprocesses, "GRACE", 0.1)
    deaf = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(flush=True); time.sleep(20)"
    with subprocesses.started([sys.executable, "-c", deaf], tmp_path, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
    assert process.returncode == -signal.SIGKILL


def test_a_compiler_leaves_no_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(subprocesses.tempfile, "tempdir", str(tmp_path))
    words = "import os, tempfile; tempfile.mkstemp(); print(os.environ['TMPDIR'])"
    done = subprocesses.compiled([sys.executable, "-c", words])
    assert done.returncode == 0 and done.stdout.startswith(str(tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_named(tmp_path, monkeypatch):
    usage = subprocesses.shutil.disk_usage(tmp_path)
    assert subprocesses.full(tmp_path, tmp_path / "none") == ""
    monkeypatch.setattr(subprocesses.shutil, "disk_usage", lambda path: usage._replace(free=4096))
    assert subprocesses.full(tmp_path) == f"no space left on the disk of '{tmp_path}'"


def test_a_full_temporary_folder_is_named(monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space") as raised:
        simulate.simulate([], simulator="icarus", datapath="lean", width=32)
    assert raised.value.filename.endswith("jobs.npz")

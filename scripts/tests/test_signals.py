# SPDX-License-Identifier: Apache-2.0
"""Tests of signals to `make`: command and simulator end within seconds and leave no temporary files."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tb.sim.env import ROOT, environment
from tb.sim.test_subprocesses import alive

COMMAND = """
import os, sys, tempfile
from scripts.console import exit_status
from tb.sim.subprocesses import started

def work():
    with tempfile.TemporaryDirectory() as folder, started(["sleep", "600"], folder) as simulator:
        print(os.getpid(), simulator.pid, flush=True)
        return simulator.wait()

sys.exit(exit_status("some", work))
"""
MESSAGES = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}


def start(tmp_path, *env_options):
    """Start make, which starts a command, which starts a simulator; return make and the two other process ids."""
    (tmp_path / "command.py").write_text(COMMAND)
    (tmp_path / "Makefile").write_text(f"run:\n\t@PYTHONPATH={ROOT} exec {sys.executable} command.py\n")
    (tmp_path / "tmp").mkdir()
    make = subprocess.Popen(
        ["env", "--default-signal", *env_options, "make", "run"],
        cwd=tmp_path,
        start_new_session=True,
        text=True,
        env=environment() | {"TMPDIR": str(tmp_path / "tmp")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    return make, [int(pid) for pid in make.stdout.readline().split()]


@pytest.mark.parametrize(
    ("number", "to"),
    [*((number, os.killpg) for number in MESSAGES), (signal.SIGTERM, os.kill), (signal.SIGKILL, os.kill)],
)
def test_a_signal_ends_command_and_simulator(tmp_path, number, to):
    """The signal goes to the process group, as from a terminal, or to make alone, which forwards SIGTERM."""
    make, pids = start(tmp_path)
    assert len(pids) == 2 and all(map(alive, pids))
    to(make.pid, number)
    err = make.communicate(timeout=60)[1]  # also waits for the command, which shares stderr
    assert make.returncode == -number and f"some: {MESSAGES.get(number, 'terminated')}\n" in err
    limit = time.monotonic() + 10
    while any(map(alive, pids)) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not any(map(alive, pids)) and os.listdir(tmp_path / "tmp") == []


def test_nohup(tmp_path):
    make, pids = start(tmp_path, "--ignore-signal=HUP")
    os.killpg(make.pid, signal.SIGHUP)
    time.sleep(0.5)
    assert all(map(alive, pids))
    make.terminate()
    assert "some: terminated\n" in make.communicate(timeout=60)[1]


def test_a_killed_command_ends_its_simulator(tmp_path):
    make, (command, simulator) = start(tmp_path)
    os.kill(command, signal.SIGKILL)
    make.communicate(timeout=60)
    limit = time.monotonic() + 10
    while alive(simulator) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not alive(simulator)

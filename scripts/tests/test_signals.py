# SPDX-License-Identifier: Apache-2.0
"""Signals to make alone, as `make run & kill -HUP $!` sends them: the command and its simulator end, too."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tb.sim.env import ROOT, environment
from tb.sim.tests.test_children import alive

COMMAND = """
import os, sys, tempfile
from scripts.console import exit_status
from tb.sim.children import started

def work():
    with tempfile.TemporaryDirectory() as folder, started(["sleep", "600"], folder) as simulator:
        print(os.getpid(), simulator.pid, flush=True)
        return simulator.wait()

sys.exit(exit_status("some", work))
"""


def made(tmp_path, ignore=()):
    """A make that has started a command that has started a simulator: the process, and the pids of both others."""
    (tmp_path / "command.py").write_text(COMMAND)
    (tmp_path / "Makefile").write_text(f"run:\n\t@PYTHONPATH={ROOT} exec {sys.executable} command.py\n")
    (tmp_path / "tmp").mkdir()
    # SIGINT may be ignored here: a shell does so to what it runs in the background
    words = ["env", "--default-signal", *(f"--ignore-signal={name}" for name in ignore), "make", "run"]
    env = environment() | {"TMPDIR": str(tmp_path / "tmp")}
    make = subprocess.Popen(
        words, cwd=tmp_path, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    return make, [int(pid) for pid in make.stdout.readline().split()]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT, signal.SIGKILL])
def test_what_make_alone_gets_ends_all(tmp_path, number):
    make, pids = made(tmp_path)
    assert len(pids) == 2 and all(map(alive, pids))
    make.send_signal(number)
    said = make.communicate(timeout=60)[1]  # make's stderr is the command's, too: this waits for both
    names = {signal.SIGHUP: "hung up", signal.SIGINT: "interrupted"}
    assert make.returncode == -number and f"some: {names.get(number, 'terminated')}\n" in said
    for _ in range(100):  # what has closed its stderr may still be about to end
        if any(map(alive, pids)):
            time.sleep(0.05)
    assert not any(map(alive, pids)) and os.listdir(tmp_path / "tmp") == []


def test_under_nohup_a_hang_up_ends_nothing(tmp_path):
    make, pids = made(tmp_path, ignore=["HUP"])
    make.send_signal(signal.SIGHUP)
    with pytest.raises(subprocess.TimeoutExpired):
        make.wait(2)
    assert all(map(alive, pids))
    make.terminate()
    assert "some: terminated\n" in make.communicate(timeout=60)[1]

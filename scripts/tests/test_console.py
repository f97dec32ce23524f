# SPDX-License-Identifier: Apache-2.0
"""Test scripts/console.py: make variables, exit status, signals, progress."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scripts import console
from tb.sim.env import ROOT, environment
from tb.sim.test_runner import alive

OPTIONS = [
    console.option("--count", "", console.whole(2), default=3),
    console.option("--from", "", str),
    console.option("--out", "", Path),
    console.switch("--keep", ""),
]


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (console.InputError("no"), 2, "no"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (OSError(28, "disk full", "a/b"), 2, "cannot read or write 'a/b': disk full"),
        (OSError(28, "disk full"), 2, "cannot read or write a file: disk full"),
    ],
)
def test_errors_become_a_status_and_one_line(error, status, message, capsys):
    def work(_):
        raise error

    assert console.command("some", "", OPTIONS)(work)([]) == status
    assert capsys.readouterr().err == f"some: {message}\n"


@pytest.mark.parametrize(
    ("words", "values"),
    [
        ([], (3, None, None, False)),
        (["COUNT=5", "FROM=a=b $x", "OUT=~/x", "KEEP=1"], (5, "a=b $x", Path.home() / "x", True)),
        (["--count", "5", "FROM=", "KEEP=0"], (5, None, None, False)),
        (["COUNT=1"], "argument COUNT=: 1 is not in the range x>=2."),
        (["KEEP=yes"], "KEEP=yes: use 1 or 0"),
        (["count=5"], "unknown variable count=; known: COUNT, FROM, HELP, KEEP, OUT"),
    ],
)
def test_variables_of_make_are_options(monkeypatch, capsys, words, values):
    monkeypatch.setattr(console, "end_with_parent", lambda: None)
    monkeypatch.setenv("MAKELEVEL", "1")
    parsed = []
    status = console.command("some", "", OPTIONS)(lambda options: parsed.append(options) or 0)(words)
    if isinstance(values, str):
        assert (status, capsys.readouterr().err) == (2, f"some: {values}\n")
    else:
        (options,) = parsed
        assert status == 0 and (options.count, options.from_, options.out, options.keep) == values


def test_progress_is_printed_while_nothing_gets_done(monkeypatch, capsys):
    monkeypatch.setattr(console, "EVERY", 0.01)
    with console.progress("some", 5000) as meter:
        meter(1000, "half [3/4]")
        time.sleep(0.5)
    lines = capsys.readouterr().err.splitlines()
    assert lines and lines[-1].startswith("some: half [3/4]: 1000 of 5000 done after ")


COMMAND = """
import os, tempfile
from scripts.console import command
from tb.sim.subprocesses import started

@command("some", "")
def main(_):
    with tempfile.TemporaryDirectory() as folder, started(["sleep", "600"], folder) as simulator:
        print(os.getpid(), simulator.pid, flush=True)
        return simulator.wait()
"""


@pytest.mark.parametrize(
    ("number", "send", "message"), [(signal.SIGINT, os.killpg, "interrupted"), (signal.SIGKILL, os.kill, "terminated")]
)
def test_a_signal_ends_command_and_simulator(tmp_path, number, send, message):
    """Send SIGINT to the process group, as a terminal does, and SIGKILL to make alone."""
    (tmp_path / "command.py").write_text(COMMAND)
    (tmp_path / "Makefile").write_text(f"run:\n\t@PYTHONPATH={ROOT} exec {sys.executable} command.py\n")
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "start_new_session": True, "text": True}
    words = ["env", "--default-signal", f"TMPDIR={tmp_path}", "make", "run"]
    make = subprocess.Popen(words, cwd=tmp_path, env=environment(), **streams)
    processes = [int(pid) for pid in make.stdout.readline().split()]
    assert all(map(alive, processes))
    send(make.pid, number)
    assert f"some: {message}\n" in make.communicate(timeout=60)[1]  # also waits for the command, which shares stderr
    limit = time.monotonic() + 10
    while any(map(alive, processes)) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not any(map(alive, processes)) and sorted(os.listdir(tmp_path)) == ["Makefile", "command.py"]

# SPDX-License-Identifier: Apache-2.0
"""scripts/console.py: exit status, signals to make and to a command, folders, progress."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scripts import console
from scripts.console import InputError
from tb.sim.env import ROOT, environment
from tb.sim.test_runner import alive


def raising(error):
    def work(_):
        raise error

    return console.command("some", "", [console.option("--count", "", console.whole(2))])(work)


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (InputError("no"), 2, "no"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (OSError(28, "disk full", "a/b"), 2, "cannot read or write 'a/b': disk full"),
        (OSError(28, "disk full"), 2, "cannot read or write a file: disk full"),
    ],
)
def test_errors_become_a_status_and_one_line(error, status, message, capsys):
    assert raising(error)([]) == status
    assert capsys.readouterr().err == f"some: {message}\n"


def test_options_are_those_of_make(monkeypatch, capsys):
    monkeypatch.setattr(console, "end_with_parent", lambda: None)
    monkeypatch.setenv("MAKELEVEL", "1")
    assert raising(InputError("argument --count: '--sum' is not --counted"))([]) == 2
    assert capsys.readouterr().err == "some: argument COUNT=: '--sum' is not --counted\n"


@pytest.mark.usefixtures("interruptible")
def test_a_second_signal_does_not_stop_the_clean_up():
    cleaned = []

    @console.command("some", "")
    def main(_):
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            signal.raise_signal(signal.SIGINT)
            cleaned.append(True)

    before = signal.getsignal(signal.SIGTERM)
    assert main([]) == 143 and cleaned == [True]
    assert signal.getsignal(signal.SIGTERM) is before


def test_new_empty_folders_are_removed(tmp_path):
    (tmp_path / "old").mkdir()
    with pytest.raises(KeyboardInterrupt), console.output(tmp_path / "old/a/b", [tmp_path / "old/a/c/file"]):
        assert (tmp_path / "old/a/c").is_dir()
        raise KeyboardInterrupt
    assert list(tmp_path.rglob("*")) == [tmp_path / "old"]
    with console.output(tmp_path / "old/a/b", []):
        (tmp_path / "old/a/b/file").touch()
    assert (tmp_path / "old/a/b/file").exists()


def test_a_path_may_begin_with_the_home_folder():
    assert console.option("--out", "", Path).type("~/x") == Path.home() / "x"


CLOSED = """import sys
from scripts.console import command
work = lambda _: print() or open(sys.executable).fileno() <= 2 or not sys.stdout
sys.exit(command("some", "")(work)([]))"""


def test_closed_standard_streams():
    command = ["bash", "-c", '"$0" -c "$1" <&- >&- 2>&-', sys.executable, CLOSED]
    assert subprocess.run(command, cwd=ROOT, env=environment(), check=False).returncode == 0


INTERRUPTED = """import os, runpy, signal, sys
class Finder:
    def find_spec(self, name, *_):
        if name == "scripts.console":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Finder())
sys.argv[0] = "-m"  # as python -m sets it
runpy.run_module("scripts.run", run_name="__main__", alter_sys=True)
"""


def test_ctrl_c_during_imports_prints_no_traceback():
    default = ["env", "--default-signal=INT"]  # a background job ignores it
    command = [*default, sys.executable, "-c", INTERRUPTED, "--list"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, check=False)
    assert (done.stdout, done.stderr, done.returncode) == (b"", b"", -signal.SIGINT)


def test_progress_is_printed_while_nothing_gets_done(monkeypatch, capsys):
    monkeypatch.setattr(console, "EVERY", 0.01)
    with console.progress("some", 5000) as meter:
        meter(1000, "half [3/4]")
        time.sleep(0.5)
    lines = capsys.readouterr().err.splitlines()
    assert lines and lines[-1].startswith("some: half [3/4]: 1000 of 5000 done after ")


COMMAND = """
import os, sys, tempfile
from scripts.console import command
from tb.sim.subprocesses import started

@command("some", "")
def main(_):
    with tempfile.TemporaryDirectory() as folder, started(["sleep", "600"], folder) as simulator:
        print(os.getpid(), simulator.pid, flush=True)
        return simulator.wait()

sys.exit(main())
"""
TERMINATED, HUNG_UP = "some: terminated\n", "some: hung up\n"


@pytest.mark.parametrize(
    ("number", "to", "message"),
    [
        (signal.SIGINT, "group", "some: interrupted\n"),
        (signal.SIGTERM, "group", TERMINATED),
        (signal.SIGHUP, "group", HUNG_UP),
        (signal.SIGTERM, "make", TERMINATED),
        (signal.SIGKILL, "make", TERMINATED),
        (signal.SIGKILL, "command", ""),
        (signal.SIGHUP, "nohup", TERMINATED),
    ],
)
def test_a_signal_ends_command_and_simulator(tmp_path, number, to, message):
    """The group gets a signal from a terminal, make alone from kill; under nohup SIGHUP is ignored and SIGTERM ends."""
    (tmp_path / "command.py").write_text(COMMAND)
    (tmp_path / "Makefile").write_text(f"run:\n\t@PYTHONPATH={ROOT} exec {sys.executable} command.py\n")
    (tmp_path / "tmp").mkdir()
    ignored = ["--ignore-signal=HUP"] if to == "nohup" else []
    words = ["env", "--default-signal", *ignored, "make", "run"]
    env, pipes = (
        environment() | {"TMPDIR": str(tmp_path / "tmp")},
        {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE},
    )
    make = subprocess.Popen(words, cwd=tmp_path, start_new_session=True, text=True, env=env, **pipes)
    command, simulator = (int(pid) for pid in make.stdout.readline().split())
    assert alive(command) and alive(simulator)
    send, pid = {"make": (os.kill, make.pid), "command": (os.kill, command)}.get(to, (os.killpg, make.pid))
    send(pid, number)
    if to == "nohup":
        time.sleep(0.5)
        assert alive(command) and alive(simulator)
        make.terminate()
    assert message in make.communicate(timeout=60)[1]  # also waits for the command, which shares stderr
    limit = time.monotonic() + 10
    while (alive(command) or alive(simulator)) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not alive(command) and not alive(simulator)
    assert to == "command" or os.listdir(tmp_path / "tmp") == []

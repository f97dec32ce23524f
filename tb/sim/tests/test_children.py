# SPDX-License-Identifier: Apache-2.0
"""What compilers and simulators leave behind when they are ended: nothing."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tb.sim import children, simulate
from tb.sim.env import ROOT

PARENT = """
import os, subprocess, sys, tempfile
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
tempfile.mkstemp()
print(os.getpid(), child.pid, flush=True)
child.wait()
"""


def alive(pid: int) -> bool:
    """Whether it runs; a process that has ended and that nobody has asked about does not."""
    stat = Path(f"/proc/{pid}/stat")
    return stat.exists() and stat.read_text().rsplit(")", 1)[1].split()[0] != "Z"


def test_the_whole_group_ends_and_its_temporary_files_are_where_we_said(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        with children.started([sys.executable, "-c", PARENT], tmp_path, stdout=subprocess.PIPE, text=True) as process:
            pids = [int(pid) for pid in process.stdout.readline().split()]
            assert len(pids) == 2 and all(map(alive, pids))
            raise KeyboardInterrupt
    assert not any(map(alive, pids))
    assert len(list(tmp_path.iterdir())) == 1


def test_a_signal_before_the_process_has_a_name(tmp_path, monkeypatch):
    made, popen = [], subprocess.Popen

    def interrupted(*arguments, **options):
        made.append(popen(*arguments, **options))
        signal.raise_signal(signal.SIGINT)
        return made[0]

    monkeypatch.setattr(children.subprocess, "Popen", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            with children.started([sys.executable, "-c", "import time; time.sleep(600)"], tmp_path):
                pass
    finally:
        signal.signal(signal.SIGINT, before)
    assert not alive(made[0].pid)


def test_who_does_not_listen_is_made_to(tmp_path, monkeypatch):
    monkeypatch.setattr(children, "GRACE", 0.1)
    deaf = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(flush=True); time.sleep(20)"
    with children.started([sys.executable, "-c", deaf], tmp_path, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
    assert process.returncode == -signal.SIGKILL


def test_a_compiler_leaves_no_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(children.tempfile, "tempdir", str(tmp_path))
    words = "import os, tempfile; tempfile.mkstemp(); print(os.environ['TMPDIR'])"
    done = children.compiled([sys.executable, "-c", words])
    assert done.returncode == 0 and done.stdout.startswith(str(tmp_path))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_to_the_command_ends_the_simulator(tmp_path, number):
    """The simulator is a program that waits for ever and says who it is."""
    temporary, said = tmp_path / "tmp", tmp_path / "said"
    temporary.mkdir()
    os.mkfifo(said)
    stand_in = f"import os, time; open({str(said)!r}, 'w').write(str(os.getpid())); time.sleep(600)"
    text = f"""
import signal, sys
from scripts import run
from tb.sim import simulate
signal.signal(signal.SIGINT, signal.default_int_handler)  # these may be ignored here, as under nohup
signal.signal(signal.SIGHUP, signal.SIG_DFL)
right = simulate.started
simulate.started = lambda command, *a, **k: right([sys.executable, "-c", {stand_in!r}], *a, **k)
sys.exit(run.main(["--out", {str(tmp_path / "a/out")!r}, "--waves"]))
"""
    env = os.environ | {"TMPDIR": str(temporary)}
    command = [sys.executable, "-c", text]
    with subprocess.Popen(command, cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        simulator = int(said.read_text())
        assert alive(simulator) and any(temporary.iterdir())
        process.send_signal(number)
        out, err = process.communicate()
    names = {signal.SIGTERM: "terminated", signal.SIGHUP: "hung up", signal.SIGINT: "interrupted"}
    assert (process.returncode, out, err.decode()) == (128 + number, b"", f"run: {names[number]}\n")
    assert not alive(simulator)
    assert list(temporary.iterdir()) == [] and not (tmp_path / "a").exists()


def test_a_full_disk_is_named(tmp_path, monkeypatch):
    usage = children.shutil.disk_usage(tmp_path)
    assert children.full(tmp_path, tmp_path / "none") == ""
    monkeypatch.setattr(children.shutil, "disk_usage", lambda path: usage._replace(free=4096))
    assert children.full(tmp_path) == f"no space left on the disk of '{tmp_path}'"


def test_a_full_temporary_folder_is_named(monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space") as raised:
        simulate.simulate([], simulator="icarus", datapath="lean", width=32)
    assert raised.value.filename.endswith("jobs.npz")

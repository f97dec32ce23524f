# SPDX-License-Identifier: Apache-2.0
"""Tests of the ordered map: over processes, and over a farm of real processes on loopback whose workers die."""

import contextlib
import functools
import importlib.util
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from scripts import parallel
from scripts.console import InputError
from tb.sim.env import ROOT, environment

farm_test = pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="needs distributed")


def noted(folder, seconds, number):
    """Record the number at the start and again at the end."""
    with open(Path(folder) / "begun", "a") as notes:
        print(number, file=notes)
    time.sleep(seconds)
    with open(Path(folder) / "done", "a") as notes:
        print(number, file=notes)
    return number * number


def noted_in(folder, name):
    path = Path(folder) / name
    return path.read_text().split() if path.exists() else []


def fails(number):
    raise InputError(f"{number} fails")


def until(true, seconds=60):
    limit = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < limit
        time.sleep(0.02)


# -- processes of this machine -----------------------------------------------------------------------------------------


@pytest.mark.cost(5)
def test_processes_keep_the_order_and_end_with_the_block(tmp_path):
    with parallel.shared(2) as each:
        assert list(each(pow, range(5), range(5))) == [number**number for number in range(5)]
    with pytest.raises(KeyboardInterrupt), parallel.shared(2) as each:
        each(functools.partial(noted, tmp_path, 20), range(8))
        until(lambda: len(noted_in(tmp_path, "begun")) == 2)
        raise KeyboardInterrupt
    assert len(noted_in(tmp_path, "begun")) == 2 and not noted_in(tmp_path, "done")


def test_a_process_that_dies():
    with pytest.raises(parallel.BrokenOffError, match="a process broke off"), parallel.shared(2) as each:
        list(each(os._exit, [3]))


# -- a farm ------------------------------------------------------------------------------------------------------------


class Farm:
    """A scheduler and its workers, each in its own process group."""

    def __init__(self, folder):
        self.folder, self.groups = folder, []
        file = folder / "scheduler.json"
        self.scheduler = self.start(
            "-m", "dask", "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
            "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(file),
        )  # fmt: skip
        until(lambda: file.exists() and file.read_text().rstrip().endswith("}"))
        self.address = json.loads(file.read_text())["address"]

    def start(self, *words):
        env = environment() | {"TMPDIR": str(self.folder)}
        with open(self.folder / f"{len(self.groups)}.log", "w") as log:
            process = subprocess.Popen(
                [sys.executable, *words],
                cwd=ROOT,
                env=env,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        self.groups.append(process)
        return process

    def worker(self):
        return self.start("-m", "scripts.parallel", "--farm", self.address, "--jobs", "1")

    def kill(self, process):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@pytest.fixture
def farm(tmp_path):
    own = Farm(tmp_path)
    yield own
    for process in own.groups:
        own.kill(process)


@farm_test
@pytest.mark.release
def test_a_worker_that_dies_loses_nothing(farm, tmp_path):
    first = farm.worker()

    def kill():
        until(lambda: len(noted_in(tmp_path, "begun")) > max(3, len(noted_in(tmp_path, "done"))))
        farm.kill(first)
        farm.worker()

    threading.Thread(target=kill, daemon=True).start()
    with parallel.shared(1, farm.address) as each:
        assert list(each(functools.partial(noted, tmp_path, 0.3), range(12))) == [n * n for n in range(12)]
    assert len(noted_in(tmp_path, "begun")) > 12


@farm_test
@pytest.mark.release
def test_errors_of_the_work_and_other_sources(farm, monkeypatch):
    farm.worker()
    with pytest.raises(InputError, match="7 fails"), parallel.shared(1, farm.address) as each:
        list(each(fails, [7]))
    with pytest.raises(parallel.BrokenOffError, match="several workers"), parallel.shared(1, farm.address) as each:
        list(each(os._exit, [3]))
    monkeypatch.setattr(parallel, "sources", lambda: "another")
    with pytest.raises(InputError, match=r"has other sources than this checkout \(\w+, not another\)"):
        with parallel.shared(1, farm.address) as each:
            list(each(abs, [1]))


@farm_test
@pytest.mark.release
def test_a_scheduler_that_dies(farm, tmp_path):
    worker = farm.worker()

    def kill():
        until(lambda: noted_in(tmp_path, "begun"))
        farm.kill(farm.scheduler)

    threading.Thread(target=kill, daemon=True).start()
    with pytest.raises(parallel.BrokenOffError, match=f"^the scheduler {farm.address} is gone$"):
        with parallel.shared(1, farm.address) as each:
            list(each(functools.partial(noted, tmp_path, 20), range(2)))
    assert worker.wait(90) is not None


@farm_test
@pytest.mark.release
def test_no_scheduler(monkeypatch):
    monkeypatch.setattr(parallel, "CONNECT", 1)
    with pytest.raises(InputError, match="no scheduler answers at tcp://127.0.0.1:9"):
        with parallel.shared(1, "tcp://127.0.0.1:9"):
            pass

# SPDX-License-Identifier: Apache-2.0
"""Tests of the ordered map: over processes, and over a farm of real processes on loopback whose workers die."""

import contextlib
import functools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scripts import parallel
from scripts.console import InputError
from tb.sim.env import ROOT, environment


def noted(folder, seconds, number):
    """Record the number at the start and again at the end."""
    for name in ("begun", "done"):
        with open(Path(folder) / name, "a") as notes:
            print(number, file=notes)
        time.sleep(seconds * (name == "begun"))
    return number * number


def noted_in(folder, name):
    path = Path(folder) / name
    return path.read_text().split() if path.exists() else []


def fails(number):
    raise InputError(f"{number} fails")


def until(true):
    limit = time.monotonic() + 60
    while not true():
        assert time.monotonic() < limit
        time.sleep(0.02)


@pytest.mark.cost(5)
def test_processes_keep_the_order_and_end_with_the_block(tmp_path):
    with parallel.shared(2) as each:
        assert list(each(pow, range(5), range(5))) == [number**number for number in range(5)]
    with pytest.raises(KeyboardInterrupt), parallel.shared(2) as each:
        each(functools.partial(noted, tmp_path, 20), range(8))
        until(lambda: len(noted_in(tmp_path, "begun")) == 2)
        raise KeyboardInterrupt
    assert len(noted_in(tmp_path, "begun")) == 2 and not noted_in(tmp_path, "done")
    with pytest.raises(parallel.BrokenOffError, match="a worker process died"), parallel.shared(2) as each:
        list(each(os._exit, [3]))


def farmed(test):
    """Mark a test that needs Dask."""
    return pytest.mark.release(pytest.mark.needs("farm")(test))


class Farm:
    """A scheduler and its workers, each in its own process group."""

    def __init__(self, folder):
        self.folder, self.groups, file = folder, [], folder / "scheduler.json"
        options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
        self.scheduler = self.start("dask", "scheduler", *options, "--scheduler-file", str(file))
        until(lambda: file.exists() and file.read_text().rstrip().endswith("}"))
        self.address = json.loads(file.read_text())["address"]

    def start(self, *words):
        env = environment() | {"TMPDIR": str(self.folder)}
        with open(self.folder / f"{len(self.groups)}.log", "w") as log:
            streams = {"stdin": subprocess.DEVNULL, "stdout": log, "stderr": log, "start_new_session": True}
            self.groups.append(subprocess.Popen([sys.executable, "-m", *words], cwd=ROOT, env=env, **streams))
        return self.groups[-1]

    def worker(self):
        return self.start("scripts.parallel", "--farm", self.address, "--jobs", "1")

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


@farmed
def test_a_worker_that_dies_loses_nothing(farm, tmp_path):
    first = farm.worker()
    begun = functools.partial(noted_in, tmp_path, "begun")
    with parallel.shared(1, farm.address) as each:
        results = each(functools.partial(noted, tmp_path, 0.3), range(12))
        until(lambda: len(begun()) > max(3, len(noted_in(tmp_path, "done"))))
        farm.kill(first)
        farm.worker()
        assert list(results) == [n * n for n in range(12)]
    assert len(begun()) > 12


@farmed
@pytest.mark.parametrize(
    ("work", "error", "message"),
    [
        (fails, InputError, "3 fails"),
        (os._exit, parallel.BrokenOffError, "several workers"),
        (abs, InputError, r"has other sources than this checkout \(\w+, not another\)"),
    ],
)
def test_errors_of_the_work_and_other_sources(farm, monkeypatch, work, error, message):
    farm.worker()
    if work is abs:
        monkeypatch.setattr(parallel, "sources", lambda: "another")
    with pytest.raises(error, match=message), parallel.shared(1, farm.address) as each:
        list(each(work, [3]))


@farmed
def test_a_scheduler_that_dies(farm, tmp_path):
    worker = farm.worker()
    with pytest.raises(parallel.BrokenOffError, match=f"^lost the scheduler {farm.address}$"):
        with parallel.shared(1, farm.address) as each:
            results = each(functools.partial(noted, tmp_path, 20), range(2))
            until(lambda: noted_in(tmp_path, "begun"))
            farm.kill(farm.scheduler)
            list(results)
    assert worker.wait(90) is not None


@farmed
def test_no_scheduler(monkeypatch):
    monkeypatch.setattr(parallel, "CONNECT", 1)
    with pytest.raises(InputError, match="no scheduler answers at tcp://127.0.0.1:9"):
        with parallel.shared(1, "tcp://127.0.0.1:9"):
            pass

# SPDX-License-Identifier: Apache-2.0
"""Tests of the ordered map: over processes, and over a farm of real processes on loopback whose workers die."""

import contextlib
import functools
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
    with parallel.shared(2) as ordered_map:
        assert list(ordered_map(pow, range(5), range(5))) == [number**number for number in range(5)]
    with pytest.raises(KeyboardInterrupt), parallel.shared(2) as ordered_map:
        ordered_map(functools.partial(noted, tmp_path, 20), range(8))
        until(lambda: len(noted_in(tmp_path, "begun")) == 2)
        raise KeyboardInterrupt
    assert len(noted_in(tmp_path, "begun")) == 2 and not noted_in(tmp_path, "done")
    with pytest.raises(parallel.BrokenOffError, match="a process broke off"), parallel.shared(2) as ordered_map:
        list(ordered_map(os._exit, [3]))


def farmed(test):
    """Mark a test that needs Dask."""
    return pytest.mark.release(pytest.mark.needs("farm")(test))


@pytest.fixture
def scheduler():
    """Start a scheduler; return its address."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None) as cluster:
        yield cluster.scheduler_address


def kill(process):
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@pytest.fixture
def worker(scheduler, tmp_path):
    """Return a function that starts a worker in its own process group."""
    workers, env = [], environment() | {"TMPDIR": str(tmp_path)}
    command = [sys.executable, "-m", "scripts.parallel", "--farm", scheduler, "--jobs", "1"]

    def start():
        streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        workers.append(subprocess.Popen(command, cwd=ROOT, env=env, start_new_session=True, **streams))
        return workers[-1]

    yield start
    for process in workers:
        kill(process)


@farmed
def test_a_worker_that_dies_loses_nothing(scheduler, worker, tmp_path):
    first = worker()
    begun = functools.partial(noted_in, tmp_path, "begun")
    with parallel.shared(1, scheduler) as ordered_map:
        results = ordered_map(functools.partial(noted, tmp_path, 0.3), range(12))
        until(lambda: len(begun()) > max(3, len(noted_in(tmp_path, "done"))))
        kill(first)
        worker()
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
def test_errors_of_the_work_and_other_sources(scheduler, worker, monkeypatch, work, error, message):
    worker()
    if work is abs:
        monkeypatch.setattr(parallel, "sources", lambda: "another")
    with pytest.raises(error, match=message), parallel.shared(1, scheduler) as ordered_map:
        list(ordered_map(work, [3]))


@farmed
def test_no_scheduler(monkeypatch):
    monkeypatch.setattr(parallel, "CONNECT", 1)
    with pytest.raises(InputError, match="no scheduler answers at tcp://127.0.0.1:9"):
        with parallel.shared(1, "tcp://127.0.0.1:9"):
            pass

# SPDX-License-Identifier: Apache-2.0
"""Tests of the ordered map: over processes, and over a farm of one worker process."""

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
    with pytest.raises(parallel.BrokenOffError, match="a worker process died"), parallel.shared(2) as ordered_map:
        list(ordered_map(os._exit, [3]))


def farmed(test):
    """Mark a test that needs Dask."""
    return pytest.mark.release(pytest.mark.needs("farm")(test))


@pytest.fixture
def farm(tmp_path):
    """Start a cluster without workers, and a worker in its own process group; return the cluster."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None) as cluster:
        command = [sys.executable, "-m", "scripts.parallel", "--farm", cluster.scheduler_address, "--jobs", "1"]
        streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        env = environment() | {"TMPDIR": str(tmp_path)}
        worker = subprocess.Popen(command, cwd=ROOT, env=env, start_new_session=True, **streams)
        yield cluster
        os.killpg(worker.pid, signal.SIGKILL)
        worker.wait()


@farmed
def test_a_farm_keeps_the_order(farm):
    with parallel.shared(1, farm.scheduler_address) as ordered_map:
        assert list(ordered_map(abs, range(-9, 9))) == list(map(abs, range(-9, 9)))


@farmed
def test_errors_of_the_work_and_other_sources(farm, monkeypatch):
    with pytest.raises(InputError, match="3 fails"), parallel.shared(1, farm.scheduler_address) as ordered_map:
        list(ordered_map(fails, [3]))
    monkeypatch.setattr(parallel, "sources", lambda: "another")
    message = r"has other sources than this checkout \(\w+, not another\)"
    with pytest.raises(InputError, match=message), parallel.shared(1, farm.scheduler_address) as ordered_map:
        list(ordered_map(abs, [3]))


@farmed
def test_workers_and_schedulers_that_die(farm, tmp_path):
    with pytest.raises(parallel.BrokenOffError, match="^several workers of the farm died"):
        with parallel.shared(1, farm.scheduler_address) as ordered_map:
            list(ordered_map(os._exit, [3]))
    with pytest.raises(parallel.BrokenOffError, match="^lost the scheduler tcp:"):
        with parallel.shared(1, farm.scheduler_address) as ordered_map:
            results = ordered_map(functools.partial(noted, tmp_path, 20), range(2))
            until(lambda: noted_in(tmp_path, "begun"))
            farm.close()
            list(results)


@farmed
def test_no_scheduler(monkeypatch):
    monkeypatch.setattr(parallel, "CONNECT", 1)
    with pytest.raises(InputError, match="no scheduler answers at tcp://127.0.0.1:9"):
        with parallel.shared(1, "tcp://127.0.0.1:9"):
            pass

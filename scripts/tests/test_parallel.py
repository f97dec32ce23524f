# SPDX-License-Identifier: Apache-2.0
"""Test the ordered map over processes, and over a farm of one worker process."""

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
    """Write the number to the file `begun` and, after a pause, to the file `done`; return its square."""
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


@pytest.fixture
def farm(tmp_path):
    """Return a cluster with one worker process, which has its own process group."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None) as cluster:
        command = [sys.executable, "-m", "scripts.parallel", "--farm", cluster.scheduler_address, "--jobs", "1"]
        streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        env = environment() | {"TMPDIR": str(tmp_path)}
        worker = subprocess.Popen(command, cwd=ROOT, env=env, start_new_session=True, **streams)
        yield cluster
        os.killpg(worker.pid, signal.SIGKILL)
        worker.wait()


@pytest.mark.release
@pytest.mark.needs("farm")
def test_a_farm_keeps_the_order_and_reports_what_fails(farm, monkeypatch, tmp_path):
    """Check the errors if work fails, a worker has other sources, workers die, or the scheduler is lost or absent."""

    def results_of(work, items):
        with parallel.shared(1, farm.scheduler_address) as ordered_map:
            return list(ordered_map(work, items))

    assert results_of(abs, range(-9, 9)) == list(map(abs, range(-9, 9)))
    with pytest.raises(InputError, match="3 fails"):
        results_of(fails, [3])
    with monkeypatch.context() as patch:
        patch.setattr(parallel, "sources", lambda: "another")
        with pytest.raises(InputError, match=r"has other sources than this checkout \(\w+, not another\)"):
            results_of(abs, [3])
    with pytest.raises(parallel.BrokenOffError, match="^several workers of the farm died"):
        results_of(os._exit, [3])
    with pytest.raises(parallel.BrokenOffError, match="^lost the scheduler tcp:"):
        with parallel.shared(1, farm.scheduler_address) as ordered_map:
            results = ordered_map(functools.partial(noted, tmp_path, 20), range(2))
            until(lambda: noted_in(tmp_path, "begun"))
            farm.close()
            list(results)
    monkeypatch.setattr(parallel, "CONNECT", 1)
    with pytest.raises(InputError, match="no scheduler answers at tcp://127.0.0.1:9"):
        with parallel.shared(1, "tcp://127.0.0.1:9"):
            pass

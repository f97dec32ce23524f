# SPDX-License-Identifier: Apache-2.0
"""A farm of real processes on loopback: workers that die, other sources, a client or a scheduler that goes."""

import contextlib
import importlib.util
import json
import os
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import pytest

from scripts import farm
from scripts.chunks import Chunks
from scripts.console import InputError, Stopped, stoppable
from scripts.spread import BrokenOffError
from tb.core.random_targets import CHUNK, Core
from tb.sim.env import ROOT, environment, simulator
from tb.sim.tests.test_children import alive

dask = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None,
    reason="the package of requirements-farm.lock is not installed: `make test-all` does it",
)


# -- what a worker is given --------------------------------------------------------------------------------------------


def noted(folder, seconds, number):
    """Says when it begins, with its process, and when it ends."""
    with open(Path(folder) / "notes", "a") as notes:
        print("begin", number, os.getpid(), file=notes, flush=True)
        time.sleep(seconds)
        print("end", number, os.getpid(), file=notes, flush=True)
    return number * number


def notes(folder, what):
    """(number, process) of lines that say so."""
    path = Path(folder) / "notes"
    rows = [line.split() for line in path.read_text().splitlines()] if path.exists() else []
    return [(int(number), int(pid)) for said, number, pid in rows if said == what]


def waits_for(folder, other, number):
    """The first one waits for another one's end."""
    if number == 0:
        until(lambda: any(ended == other for ended, _ in notes(folder, "end")), seconds=30)
    return noted(folder, 0, number)


def ends(folder, number):
    raise InputError(f"{number} in {folder} cannot be")


def until(true, seconds=60):
    """Waits for it."""
    limit = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < limit, "in vain"
        time.sleep(0.02)


class Farm:
    """A scheduler and its workers, each a group of processes of its own."""

    def __init__(self, folder):
        self.folder, self.groups = folder, []
        self.scheduler = self.start(
            "-m", "dask", "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
            "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(folder / "scheduler.json"),
        )  # fmt: skip
        file = folder / "scheduler.json"
        until(lambda: file.exists() and file.read_text().rstrip().endswith("}"))
        self.address = json.loads(file.read_text())["address"]

    def start(self, *words, root=ROOT):
        log = open(self.folder / f"{len(self.groups)}.log", "w")
        process = subprocess.Popen(
            [sys.executable, *words], cwd=root, env=environment() | {"TMPDIR": str(self.folder)},
            stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True,
        )  # fmt: skip
        self.groups.append(process)
        return process

    def worker(self, root=ROOT):
        return self.start("-m", "scripts.farm", "--farm", self.address, "--jobs", "1", root=root)

    def kill(self, process):
        """As when its machine loses power."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@pytest.fixture
def processes(tmp_path):
    own = Farm(tmp_path)
    yield own
    for process in own.groups:
        own.kill(process)
    until(lambda: not any(alive(pid) for _, pid in notes(tmp_path, "begin")))


# -- workers that die --------------------------------------------------------------------------------------------------


@dask
@pytest.mark.slow
@pytest.mark.cost(30)
def test_a_worker_that_dies_in_the_middle_loses_nothing(processes, tmp_path):
    """In order, each once; what it had begun is begun again by another."""
    first, killed = processes.worker(), []

    def kill():
        until(lambda: len(notes(tmp_path, "begin")) > max(3, len(notes(tmp_path, "end"))))
        processes.kill(first)
        killed.extend(notes(tmp_path, "begin")[-1])
        processes.worker()

    threading.Thread(target=kill, daemon=True).start()
    with farm.shared(1, processes.address) as each:
        assert list(each(partial(noted, tmp_path, 0.3), range(12))) == [n * n for n in range(12)]
    begun, done = notes(tmp_path, "begin"), notes(tmp_path, "end")
    number, process = killed
    assert (number, process) not in done and len({pid for n, pid in begun if n == number}) == 2
    assert sorted({n for n, _ in done}) == list(range(12))


@dask
@pytest.mark.slow
@pytest.mark.sim
@pytest.mark.cost(90)
@pytest.mark.skipif(simulator() != "verilator", reason="its chunks are for the native program: SIM=verilator")
def test_a_soak_with_a_worker_that_dies_is_the_same_soak(processes):
    """Found, counts and hardest targets."""
    core, targets = Core("verilator", "lean", 18), 9 * CHUNK + 7
    alone, told = Chunks(core, 3, 1, targets), []
    assert alone.run(1, told.append) is None
    workers, said = [processes.worker()], []

    def done(targets):
        said.append(targets)
        if len(said) == 3:
            processes.kill(workers[0])
            workers.append(processes.worker())

    shared = Chunks(core, 3, 1, targets)
    assert shared.run(1, done, processes.address) is None
    assert len(workers) == 2 and said == told
    assert (shared.found, shared.number) == (alone.found, alone.number)


@dask
@pytest.mark.slow
@pytest.mark.cost(10)
def test_workers_do_not_wait_for_the_slowest_piece(processes, tmp_path):
    """What is behind it is done meanwhile, and comes behind it."""
    processes.worker()
    processes.worker()
    with farm.shared(1, processes.address) as each:
        assert list(each(partial(waits_for, tmp_path, 9), range(10))) == [n * n for n in range(10)]


@dask
@pytest.mark.slow
@pytest.mark.cost(20)
def test_work_that_ends_its_worker_again_and_again_is_given_up(processes):
    processes.worker()
    with pytest.raises(BrokenOffError, match="the same piece of work has ended several workers"):
        with farm.shared(1, processes.address) as each:
            list(each(os._exit, [3]))


# -- sources -----------------------------------------------------------------------------------------------------------


@dask
@pytest.mark.slow
@pytest.mark.cost(15)
def test_a_worker_with_other_sources_does_nothing(processes, tmp_path, monkeypatch):
    processes.worker()
    monkeypatch.setattr(farm, "sources", lambda: "of another commit")
    with pytest.raises(InputError, match=r"worker tcp://127.* has other sources than this checkout \(\w+, not of ano"):
        with farm.shared(1, processes.address) as each:
            list(each(partial(noted, tmp_path, 0), [1]))
    assert not notes(tmp_path, "begin")


def test_sources_are_all_code_and_nothing_else(tmp_path, monkeypatch):
    (tmp_path / "requirements").mkdir()
    for name in ("model", "rtl", "scripts", "tb"):
        (tmp_path / name / "sub").mkdir(parents=True)
    monkeypatch.setattr(farm, "ROOT", tmp_path)
    seen = {farm.sources()}
    for name in ("rtl/sub/a.v", "rtl/a.v", "model/a.py", "tb/sub/a.cpp", "requirements/checkout.lock"):
        (tmp_path / name).write_text("1")
        seen.add(farm.sources())
    (tmp_path / "rtl" / "a.v").write_text("2 ")
    seen.add(farm.sources())
    (tmp_path / "rtl" / "a.v").rename(tmp_path / "rtl" / "b.v")
    seen.add(farm.sources())
    assert len(seen) == 8
    for name in ("tb/hardest.csv", "model/a.pyc", "notes.py"):
        (tmp_path / name).write_text("1")
        assert farm.sources() in seen


# -- ends --------------------------------------------------------------------------------------------------------------


@dask
@pytest.mark.slow
@pytest.mark.cost(15)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_client_and_what_the_farm_does_for_it(processes, tmp_path, number, interruptible):
    processes.worker()

    def send():
        until(lambda: notes(tmp_path, "begin"))
        signal.pthread_kill(threading.main_thread().ident, number)

    threading.Thread(target=send, daemon=True).start()
    with pytest.raises(Stopped), stoppable(), farm.shared(1, processes.address) as each:
        list(each(partial(noted, tmp_path, 600), range(9)))
    ((_, process),) = notes(tmp_path, "begin")
    until(lambda: not alive(process), 10)
    with farm.shared(1, processes.address) as each:  # the worker is free again
        assert list(each(partial(noted, tmp_path, 0), [5])) == [25]
    assert [n for n, _ in notes(tmp_path, "begin")] == [0, 5]


@dask
@pytest.mark.slow
@pytest.mark.cost(15)
def test_a_scheduler_that_goes_is_one_line(processes, tmp_path):
    worker = processes.worker()

    def kill():
        until(lambda: notes(tmp_path, "begin"))
        processes.kill(processes.scheduler)

    threading.Thread(target=kill, daemon=True).start()
    with pytest.raises(BrokenOffError, match=f"^the scheduler {processes.address} is gone$"):
        with farm.shared(1, processes.address) as each:
            list(each(partial(noted, tmp_path, 600), range(9)))
    assert worker.wait(60) is not None


@dask
@pytest.mark.slow
@pytest.mark.cost(10)
def test_a_worker_ends_with_its_scheduler(processes, tmp_path):
    """With nothing to do, too."""
    worker = processes.worker()
    with farm.shared(1, processes.address) as each:
        assert list(each(partial(noted, tmp_path, 0), [5])) == [25]
    assert not list(tmp_path.glob("dask*/worker*"))  # TMPDIR: what it writes lies in build/
    processes.kill(processes.scheduler)
    assert worker.wait(60) is not None


@dask
@pytest.mark.slow
@pytest.mark.cost(10)
def test_what_work_raises_is_raised_here(processes, tmp_path):
    processes.worker()
    with pytest.raises(InputError, match="7 in .* cannot be"):
        with farm.shared(1, processes.address) as each:
            list(each(partial(ends, tmp_path), [7]))


@dask
@pytest.mark.slow
@pytest.mark.cost(12)
def test_without_a_scheduler(monkeypatch):
    monkeypatch.setattr(farm, "CONNECT", 1)
    with pytest.raises(InputError, match="argument --farm: no scheduler answers at tcp://127.0.0.1:9"):
        with farm.shared(1, "tcp://127.0.0.1:9"):
            pass


# -- the command line --------------------------------------------------------------------------------------------------


def test_without_the_package(command, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    status, out, err = command(farm.main, "--farm", "tcp://here:8786")
    missing = "farm: argument --farm: the package distributed is missing; make with FARM=... installs it"
    assert (status, out, err) == (2, [], [missing])


def test_a_worker_wants_a_scheduler(command):
    assert command(farm.main) == (2, [], ["farm: argument --farm: which scheduler, as in tcp://scheduler:8786"])

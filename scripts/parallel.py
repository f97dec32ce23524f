# SPDX-License-Identifier: Apache-2.0
"""An ordered parallel map, over processes of this machine or over Dask workers on others.

    python -m scripts.parallel --farm tcp://SCHEDULER:8786 [--jobs N]

makes this machine a worker of the scheduler (`make farm-worker`). Work consists of functions of this tree with their
arguments; a worker refuses it if its sources differ from the client's. Work begun by a worker that died is repeated.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib.util
import logging
import multiprocessing
import os
import pickle
import re
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from types import SimpleNamespace

import click

from scripts.console import EVERY, InputError, command, option, whole
from tb.sim.env import ROOT
from tb.sim.simulate import SimulationError

CONNECT = 10
"""Seconds to wait for a scheduler."""

CODE = {".py", ".v", ".vh", ".f", ".c", ".cc", ".cpp", ".h", ".rdl", ".vlt"}


class BrokenOffError(SimulationError):
    """The process or worker died, not the work itself."""


def address(text: str) -> str:
    """Return the address of a scheduler, the type of an option."""
    found = re.fullmatch(r"tcp://([\w.-]+|\[[0-9a-fA-F:]+\]):(\d{1,5})", text, re.ASCII)
    if not (found and 0 < int(found[2]) < 1 << 16):
        raise click.BadParameter(f"{text!r} is not the address of a scheduler, as in tcp://scheduler:8786")
    return text


FARM = option(
    "--farm", "run on the Dask workers of this scheduler, not on this machine", address, metavar="tcp://HOST:PORT"
)


def shared(jobs: int, farm: str | None = None) -> contextlib.AbstractContextManager[Callable]:
    """Return a context manager for an ordered `map`, on a farm or on `jobs` processes."""
    if farm:
        return _farm(farm)
    return contextlib.nullcontext(map) if jobs == 1 else _pool(jobs)


# -- processes of this machine -----------------------------------------------------------------------------------------


def _start() -> None:
    """Ignore the terminal's signals, which the parent handles; end at SIGTERM and with the parent."""

    def end(*_) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise SystemExit

    def follow() -> None:
        multiprocessing.parent_process().join()
        os.kill(os.getpid(), signal.SIGTERM)

    os.setsid()
    signal.signal(signal.SIGTERM, end)
    threading.Thread(target=follow, daemon=True).start()


def _call(work: Callable, *items):
    try:
        return work(*items)
    except SystemExit:
        os._exit(1)  # a pool's process would return it as a result and take the next item


@contextlib.contextmanager
def _pool(jobs: int) -> Iterator[Callable]:
    # Processes are spawned: a progress bar has a thread, and fork copies its locks.
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _start) as pool:
        try:
            yield lambda work, *items: pool.map(functools.partial(_call, work), *items)
        except BaseException as error:
            for process in multiprocessing.active_children():
                process.terminate()
            if isinstance(error, BrokenProcessPool):
                raise BrokenOffError("a process broke off") from None
            raise
        finally:
            pool.shutdown(cancel_futures=True)


# -- workers on other machines -----------------------------------------------------------------------------------------


def _needs_dask() -> None:
    if importlib.util.find_spec("distributed") is None:
        raise InputError("argument --farm: the package distributed is missing; make with FARM=... installs it")


@contextlib.contextmanager
def _farm(farm: str) -> Iterator[Callable]:
    _needs_dask()
    import dask
    from distributed import Client

    for name in ("distributed", "distributed.client", "tornado", "asyncio"):  # errors are reported here
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    with dask.config.set({"distributed.comm.timeouts.connect": CONNECT}):
        try:
            client = Client(farm, timeout=CONNECT)
        except (OSError, ValueError) as error:
            raise InputError(f"argument --farm: no scheduler answers at {farm}") from error
        try:
            yield functools.partial(_each, client, farm)
        finally:
            client.close(timeout=1)  # cancels outstanding work


def _each(client, farm: str, work: Callable, items: Iterable) -> Iterator:
    """Submit all items and yield their results in order."""
    import distributed

    flying = deque(client.submit(_checked, pickle.dumps((work, item)), sources(), pure=False) for item in items)
    waiting = False
    while flying:
        try:
            while not flying[0].done():
                with contextlib.suppress(distributed.TimeoutError):
                    distributed.wait(flying[0], EVERY)
                if not (waiting or flying[0].done() or client.nthreads()):
                    waiting = True
                    print(f"farm: {farm} has no workers, waiting for one", file=sys.stderr, flush=True)
        except (CancelledError, OSError, RuntimeError):
            raise BrokenOffError(f"the scheduler {farm} is gone") from None
        try:
            result = flying[0].result()
        except CancelledError:
            raise BrokenOffError(f"the scheduler {farm} is gone") from None
        except distributed.KilledWorker:
            raise BrokenOffError("the same piece of work has ended several workers of the farm") from None
        flying.popleft()
        yield result


@functools.cache
def sources() -> str:
    """Return a digest of the code of this tree and of the versions of its packages, as first seen by this process."""
    paths = [path for room in ("model", "rtl", "scripts", "tb") for path in (ROOT / room).rglob("*")]
    paths = [path for path in paths if path.suffix in CODE] + list((ROOT / "requirements").glob("*.lock"))
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(f"{path.relative_to(ROOT)}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _checked(payload: bytes, digest: str):
    """Run a pickled function on a worker with the same sources."""
    if sources() != digest:
        raise InputError(
            f"argument --farm: worker {os.uname().nodename} has other sources than this checkout ({sources()}, not "
            f"{digest}): bring it to the same commit and start it again"
        )
    work, item = pickle.loads(payload)
    return work(item)


@command(
    "parallel",
    "Work for a Dask scheduler.",
    [FARM, option("--jobs", "pieces of work at a time", whole(1), default=os.cpu_count(), metavar="N")],
    fails="the worker fails",
)
def main(options: SimpleNamespace) -> int:
    if not options.farm:
        raise InputError("argument --farm: the address of the scheduler is missing, as in tcp://scheduler:8786")
    _needs_dask()
    words = [options.farm, "--nworkers", str(options.jobs), "--nthreads", "1", "--no-dashboard"]
    words += ["--local-directory", str(ROOT / "build" / "farm")]
    # Daemonic processes may not have children.
    env = os.environ | {"DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    os.chdir(ROOT)
    os.execve(sys.executable, [sys.executable, "-m", "dask", "worker", *words], env)


if __name__ == "__main__":
    sys.exit(main())

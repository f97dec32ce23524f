# SPDX-License-Identifier: Apache-2.0
"""Ordered parallel map over processes on this machine, or over a farm of Dask workers on other machines.

    python -m scripts.parallel --farm tcp://SCHEDULER:8786 [--jobs N]

This command makes this machine a worker of the scheduler (`make farm-worker`). A work item is a function from
this checkout, with its arguments. A worker refuses all items if its sources differ from the sources of
the client. If a worker dies, the farm repeats the worker's items.
"""

import contextlib
import functools
import logging
import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from scripts.console import InputError, Options, command, option, whole
from tb.sim.env import ROOT
from tb.sim.simulate import SimulationError
from tb.sim.sources import digest
from tb.sim.subprocesses import end_with_parent

CONNECT = 10  # seconds to wait for a scheduler

CODE = {".py", ".v", ".vh", ".f", ".c", ".cc", ".cpp", ".h", ".rdl", ".vlt", ".lock"}


class BrokenOffError(SimulationError):
    """Death of a worker process, or loss of the farm's scheduler. The work itself did not fail."""


FARM = option("--farm", "run on the Dask workers of this scheduler, not on this machine", metavar="tcp://HOST:PORT")


def _start() -> None:
    """Prepare a worker process: ignore the terminal's signals; end at SIGTERM or when the parent ends."""

    def end(*_) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise SystemExit

    os.setsid()
    signal.signal(signal.SIGTERM, end)
    end_with_parent()


def _call(work: Callable, *items):
    try:
        return work(*items)
    except SystemExit:
        os._exit(1)  # otherwise the pool's process returns the exception as a result and takes the next item


@contextlib.contextmanager
def shared(jobs: int, farm: str | None = None) -> Iterator[Callable]:
    """Yield an ordered `map` that runs on a farm or on `jobs` processes here. Raises BrokenOffError and InputError."""
    if farm:
        with _farm(farm) as each:
            yield each
        return
    if jobs == 1:
        yield map
        return
    # Spawn, not fork: fork would copy the locks of the progress bar's thread.
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _start) as pool:
        try:
            yield lambda work, *items: pool.map(functools.partial(_call, work), *items)
        except BaseException as error:
            for process in multiprocessing.active_children():
                process.terminate()
            if isinstance(error, BrokenProcessPool):
                raise BrokenOffError("a worker process died") from None
            raise
        finally:
            pool.shutdown(cancel_futures=True)


@contextlib.contextmanager
def _farm(farm: str) -> Iterator[Callable]:
    try:
        import distributed
    except ImportError:
        raise InputError("argument --farm: distributed is missing; make with FARM=... installs it") from None
    for name in ("distributed", "distributed.client", "tornado", "asyncio"):  # errors are reported here
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        client = distributed.Client(farm, timeout=CONNECT)
    except (OSError, ValueError) as error:
        raise InputError(f"argument --farm: no scheduler answers at {farm}") from error

    def each(work: Callable, items: Iterable) -> Iterator:
        if not client.nthreads():
            print(f"farm: {farm} has no workers, waiting for one", file=sys.stderr, flush=True)
        pickled = [pickle.dumps((work, item)) for item in items]
        return client.get_executor(pure=False).map(functools.partial(_checked, sources()), pickled)

    try:
        yield each
    except distributed.KilledWorker:
        raise BrokenOffError("several workers of the farm died on the same work item") from None
    except CancelledError:
        raise BrokenOffError(f"lost the scheduler {farm}") from None
    finally:
        client.close(timeout=1)  # cancels outstanding work


@functools.cache
def sources() -> str:
    """Return the digest of this checkout's code and lock files; it is computed once per process."""
    paths = (path for room in ("model", "rtl", "scripts", "tb", "requirements") for path in (ROOT / room).rglob("*"))
    return digest(sorted(path for path in paths if path.suffix in CODE))


def _checked(client: str, payload: bytes):
    """Run a pickled work item on a worker. Raises InputError if ``client`` is not the digest of the worker's code."""
    if sources() != client:
        raise InputError(
            f"argument --farm: worker {os.uname().nodename} has other sources than this checkout ({sources()}, not "
            f"{client}): bring it to the same commit and start it again"
        )
    work, item = pickle.loads(payload)
    return work(item)


@command(
    "parallel",
    [FARM, option("--jobs", "pieces of work at a time", whole(1), default=os.cpu_count(), metavar="N")],
    about="Work for a Dask scheduler.",
    fails="the worker fails",
)
def main(options: Options) -> int:
    if not options.farm:
        raise InputError("argument --farm: the address of the scheduler is missing, as in tcp://scheduler:8786")
    words = [options.farm, "--nworkers", str(options.jobs), "--nthreads", "1", "--no-dashboard"]
    words += ["--local-directory", str(ROOT / "build" / "farm")]
    # Daemonic processes may not have children.
    env = os.environ | {"DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    os.chdir(ROOT)
    os.execve(sys.executable, [sys.executable, "-m", "dask", "worker", *words], env)


if __name__ == "__main__":
    sys.exit(main())

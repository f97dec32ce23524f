# SPDX-License-Identifier: Apache-2.0
"""Work given to Dask workers on other machines, in order, instead of to this machine's own cores.

    python -m scripts.farm --farm tcp://SCHEDULER:8786 [--jobs N]

makes this machine work for the scheduler there (`make farm-worker`). What FARM= gives out are functions of this tree
with their arguments; a worker runs them in a process of its own, and only where its sources are those of the client.
A worker that dies takes nothing with it: what it had begun goes to another one, and counts once.

Exit status: that of the worker, 2 input that cannot be used (one line on stderr).
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import hashlib
import importlib.util
import itertools
import logging
import multiprocessing
import os
import pickle
import re
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.util import Finalize
from pathlib import Path

from scripts.console import EVERY, InputError, Parser, command, whole
from scripts.spread import BrokenOffError, process_of_its_own, spread
from tb.sim.env import ROOT

CONNECT = 10
"""Seconds in which a scheduler has to answer."""

AHEAD = 2
"""Pieces of work that each worker has or is about to get."""

CODE = {".py", ".v", ".vh", ".f", ".c", ".cc", ".cpp", ".h", ".sby", ".rdl", ".vlt"}


def option(parser: Parser) -> None:
    """--farm of a command."""
    about = "give the work to Dask workers by the scheduler there (default: to this machine's cores)"
    parser.add_argument("--farm", type=address, metavar="tcp://HOST:PORT", help=about)


def address(text: str) -> str:
    """The type of an option that takes a scheduler."""
    found = re.fullmatch(r"tcp://([\w.-]+|\[[0-9a-fA-F:]+\]):(\d{1,5})", text, re.ASCII)
    if not (found and 0 < int(found[2]) < 1 << 16):
        raise argparse.ArgumentTypeError(f"{text!r} is not the address of a scheduler, as in tcp://scheduler:8786")
    return text


def shared(jobs: int, farm: str | None = None) -> contextlib.AbstractContextManager[Callable]:
    """A `map` that keeps the order: of a farm, or else of so many processes of this machine."""
    return _farm(farm) if farm else spread(jobs)


# -- the client --------------------------------------------------------------------------------------------------------


@contextlib.contextmanager
def _farm(farm: str) -> Iterator[Callable]:
    needs_dask()
    import dask
    from distributed import Client

    for name in ("distributed", "distributed.client", "tornado", "asyncio"):  # what they have to say is said here
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    with dask.config.set({"distributed.comm.timeouts.connect": CONNECT}):
        try:
            client = Client(farm, timeout=CONNECT)
        except (OSError, ValueError) as error:
            raise InputError(f"argument --farm: no scheduler answers at {farm}") from error
        try:
            yield functools.partial(_each, client, farm)
        finally:
            client.close(timeout=1)  # the scheduler forgets what was not fetched, and workers leave it


def needs_dask() -> None:
    if importlib.util.find_spec("distributed") is None:
        raise InputError("argument --farm: the package distributed is missing; make with FARM=... installs it")


def _each(client, farm: str, work: Callable, items: Iterable) -> Iterator:
    left, flying = iter(items), deque()
    digest = sources()

    def feed() -> None:
        """Results may wait for an earlier one, workers do not."""
        room = AHEAD * max(1, _workers(client, farm)) - sum(not future.done() for future in flying)
        for item in itertools.islice(left, max(0, room)):
            flying.append(client.submit(here, pickle.dumps((work, item)), digest, pure=False))

    feed()
    while flying:
        yield pickle.loads(_result(client, farm, flying[0], feed))
        flying.popleft()
        feed()


def _workers(client, farm: str) -> int:
    try:
        return sum(client.nthreads().values())
    except (OSError, RuntimeError, ValueError):
        raise _gone(farm) from None


def _gone(farm: str) -> BrokenOffError:
    return BrokenOffError(f"the scheduler {farm} is gone")


def _result(client, farm: str, future, meanwhile: Callable[[], None]) -> bytes:
    import distributed

    said = False
    while not future.done():
        with contextlib.suppress(distributed.TimeoutError, CancelledError):
            distributed.wait(future, EVERY)
        if future.done():
            break
        if not said and not _workers(client, farm):
            said = True
            print(f"farm: {farm} has no workers, waiting for one", file=sys.stderr, flush=True)
        meanwhile()
    try:
        return future.result()
    except CancelledError:
        raise _gone(farm) from None
    except distributed.KilledWorker:
        raise BrokenOffError("the same piece of work has ended several workers of the farm") from None


# -- the worker --------------------------------------------------------------------------------------------------------


def sources() -> str:
    """A digest of the code of this tree, and of the versions of what it needs."""
    paths = [path for room in ("model", "rtl", "scripts", "tb") for path in (ROOT / room).rglob("*")]
    paths = sorted(path for path in paths if path.suffix in CODE) + sorted(ROOT.glob("requirements/*.lock"))
    stats = [path.stat() for path in paths]
    return _digest(tuple(zip(paths, [(stat.st_mtime_ns, stat.st_size) for stat in stats], strict=True)))


@functools.lru_cache(1)
def _digest(files: Sequence[tuple[Path, tuple[int, int]]]) -> str:
    whole = hashlib.sha256()
    for path, _ in files:
        whole.update(f"{path.relative_to(ROOT)}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()[:16]


_one = threading.Lock()
"""Simulators and their folders are of one piece of work at a time."""


def here(payload: bytes, digest: str) -> bytes:
    """On a worker: the result of a function with its argument, both pickled as the worker itself may have old code."""
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()
    with _one:
        own = sources()
        if own != digest:
            raise InputError(
                f"argument --farm: worker {worker.address} has other sources than this checkout ({own}, not {digest}): "
                "bring it to the same commit"
            )
        pool = _pool(digest)
        future = pool.submit(_done, payload)
        while not wait([future], 0.2).done:
            task = worker.state.tasks.get(key)
            gone = worker.status.name in ("closing", "closed", "failed")  # with the scheduler
            if gone or task is None or task.state == "cancelled":  # with the client
                _end(pool)
                return b""
        try:
            return future.result()
        except BrokenProcessPool:
            os._exit(1)  # as if the worker itself had died: the scheduler counts those


@functools.lru_cache(1)
def _pool(digest: str) -> ProcessPoolExecutor:
    """A process that has read these sources."""
    pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), process_of_its_own)
    Finalize(None, _end, (pool,), exitpriority=1)  # a worker that ends waits for its processes
    return pool


def _end(pool: ProcessPoolExecutor) -> None:
    _pool.cache_clear()
    for process in multiprocessing.active_children():
        process.terminate()
    pool.shutdown()


def _done(payload: bytes) -> bytes:
    work, item = pickle.loads(payload)
    try:
        return pickle.dumps(work(item))
    except SystemExit:
        os._exit(1)  # after SIGTERM; a pool's process would take it for a result, and wait for more work


@command("farm")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("farm", "A worker: it does what commands with FARM= give out.", fails="the worker breaks off")
    option(parser)
    about = "pieces of work at a time (default: %(default)s)"
    parser.add_argument("--jobs", type=whole(1), default=os.cpu_count(), metavar="N", help=about)
    options = parser.parse_args(arguments)
    if not options.farm:
        raise InputError("argument --farm: which scheduler, as in tcp://scheduler:8786")
    needs_dask()
    words = [options.farm, "--nworkers", str(options.jobs), "--nthreads", "1", "--no-dashboard"]
    words += ["--local-directory", str(ROOT / "build" / "farm")]
    # Not a daemon, which would have no processes of its own.
    env = os.environ | {"DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    os.chdir(ROOT)
    os.execve(sys.executable, [sys.executable, "-m", "dask", "worker", *words], env)


if __name__ == "__main__":
    sys.exit(main())

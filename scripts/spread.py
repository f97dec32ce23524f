# SPDX-License-Identifier: Apache-2.0
"""Work spread over processes, in order, that ends with the command that began it."""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import NoReturn

from tb.sim.children import GRACE
from tb.sim.simulate import SimulationError


class BrokenOffError(SimulationError):
    """What did the work has ended, not the work."""


_ends = threading.Event()


def process_of_its_own() -> None:
    """Ctrl-C is for the parent, whose SIGTERM, or whose end, is a way out that ends the simulation, too."""

    def end(*_) -> NoReturn:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        _ends.set()
        raise SystemExit

    def follow() -> None:
        multiprocessing.parent_process().join()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(2 * GRACE)
        os._exit(1)  # a pool's process takes SystemExit for a result, and waits for more work

    os.setsid()
    signal.signal(signal.SIGTERM, end)
    threading.Thread(target=follow, daemon=True).start()


def _unless_it_ends(work: Callable, *items):
    """A pool's process takes SystemExit for a result, and goes on with what has been queued for it."""
    if _ends.is_set():
        raise SystemExit
    return work(*items)


@contextlib.contextmanager
def spread(jobs: int) -> Iterator[Callable]:
    """A `map` that keeps the order; with more than one job, over processes, which end with the block."""
    if jobs == 1:
        yield map
        return
    # Not forked: a progress bar has a thread.
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), process_of_its_own) as pool:
        try:
            yield lambda work, *items: pool.map(functools.partial(_unless_it_ends, work), *items)
        except BaseException as error:
            for process in multiprocessing.active_children():
                process.terminate()
            if isinstance(error, BrokenProcessPool):
                raise BrokenOffError("a process broke off") from None
            raise
        finally:
            pool.shutdown(cancel_futures=True)

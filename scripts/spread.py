# SPDX-License-Identifier: Apache-2.0
"""Work spread over processes, in order, that ends with the command that began it."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import NoReturn


def _worker() -> None:
    """A process of its own: Ctrl-C is for the parent, whose SIGTERM is a way out that ends the simulation, too."""

    def end(*_) -> NoReturn:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise SystemExit

    os.setsid()
    signal.signal(signal.SIGTERM, end)


@contextlib.contextmanager
def spread(jobs: int) -> Iterator[Callable]:
    """A `map` that keeps the order; with more than one job, over processes, which end with the block."""
    if jobs == 1:
        yield map
        return
    # Not forked: a progress bar has a thread.
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _worker) as pool:
        try:
            yield pool.map
        except BaseException:
            for process in multiprocessing.active_children():
                process.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)

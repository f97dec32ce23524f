# SPDX-License-Identifier: Apache-2.0
"""cocotb tests with a limit in simulated time. If a test exceeds it, the message shows the line that waits."""

import functools
import linecache
from collections.abc import Callable
from pathlib import Path

import cocotb
from cocotb.triggers import SimTimeoutError, with_timeout

from tb.sim.env import ROOT


def timed_test(milliseconds: float = 10, name: str | None = None) -> Callable:
    """Return a decorator like :func:`cocotb.test` that fails a test after ``milliseconds`` of simulated time.

    Write ``cocotb.parametrize`` above this decorator.
    """

    def decorate(function):
        @cocotb.test(name=name)
        @functools.wraps(function)
        async def run(dut, **parameters):
            coroutine = function(dut, **parameters)
            task = cocotb.start_soon(coroutine)
            try:
                await with_timeout(task, milliseconds, "ms")
            except SimTimeoutError:
                if task.done():  # an error of the test itself
                    raise
                raise AssertionError(f"no end after {milliseconds} ms; it waits in {waiting(coroutine)}") from None

        return run

    return decorate


def waiting(coroutine) -> str:
    """Return the innermost line of the project at which a coroutine waits: file, number and text."""
    line = ""
    while coroutine is not None:
        frame = getattr(coroutine, "cr_frame", None)
        file = Path(frame.f_code.co_filename) if frame else Path()
        if file.is_relative_to(ROOT) and "site-packages" not in file.parts:
            text = linecache.getline(str(file), frame.f_lineno).strip()
            line = f"{file.relative_to(ROOT)}, line {frame.f_lineno}: {text}"
        coroutine = getattr(coroutine, "cr_await", None)
    return line

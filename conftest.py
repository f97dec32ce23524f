# SPDX-License-Identifier: Apache-2.0
"""Test order and fixtures shared by all tests. The longest files start first, to balance the parallel workers."""

import signal

import pytest


def pytest_collection_modifyitems(items):
    """Sort files by their longest case, longest first. A file stays together because its tests share fixtures."""
    longest: dict = {}
    for item in items:
        longest[item.path] = max(longest.get(item.path, 0), cost(item))
    items.sort(key=lambda item: longest[item.path], reverse=True)


def cost(item) -> float:
    """Return the estimated seconds of a test: its ``cost`` marker, or a default for its kind."""
    marker = item.get_closest_marker("cost")
    if marker:
        return marker.args[0]
    return 20 * bool(item.get_closest_marker("slow")) + 5 * bool(item.get_closest_marker("sim"))


@pytest.fixture
def interruptible():
    """Restore the default handlers of signals that a shell or nohup may have set to be ignored."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in (signal.SIGTERM, signal.SIGHUP)}
    before[signal.SIGINT] = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)

# SPDX-License-Identifier: Apache-2.0
"""What all tests share: the longest files start first, so that no worker is left with one at the end."""

import signal

import pytest


def pytest_collection_modifyitems(items):
    """A file is a unit, as its fixtures serve all its tests; that with the longest case comes first."""
    longest: dict = {}
    for item in items:
        longest[item.path] = max(longest.get(item.path, 0), cost(item))
    items.sort(key=lambda item: longest[item.path], reverse=True)


def cost(item) -> float:
    """Seconds: of the marker ``cost``, else what the others of its kind take."""
    marker = item.get_closest_marker("cost")
    if marker:
        return marker.args[0]
    return 20 * bool(item.get_closest_marker("slow")) + 5 * bool(item.get_closest_marker("sim"))


@pytest.fixture
def interruptible():
    """Restore the default handlers of signals that a shell or nohup has set to be ignored."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in (signal.SIGTERM, signal.SIGHUP)}
    before[signal.SIGINT] = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)

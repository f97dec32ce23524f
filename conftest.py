# SPDX-License-Identifier: Apache-2.0
"""Order and needs of all tests. The longest files start first, to balance the parallel workers."""

import json
import os
import shutil

import pytest

from scripts.setup.bootstrap import EXTRAS, PROGRAMS, STAMP
from tb.sim.env import ROOT

STAMPED = json.loads((ROOT / STAMP).read_text())["ready"] if (ROOT / STAMP).exists() else []
"""What set-up has installed."""


def pytest_itemcollected(item):
    """Add `slow` to a test that needs more than `make test` installs."""
    if needs(item) - {"cc"}:
        item.add_marker("slow")


def pytest_runtest_setup(item):
    """Skip a test without the tools that it needs; in continuous integration it fails."""
    if lacks := [need for need in sorted(needs(item)) if is_missing(need)]:
        message = f"not installed; to install it: python3 scripts/setup/bootstrap.py {' '.join(lacks)}"
        (pytest.fail if os.environ.get("CI") else pytest.skip)(message)


def needs(item) -> set[str]:
    """Return the arguments of a test's `needs` markers."""
    return {need for marker in item.iter_markers("needs") for need in marker.args}


def is_missing(need: str) -> bool:
    """Return whether a program or the packages of a need of scripts/setup/bootstrap.py are missing."""
    return (
        need in EXTRAS
        and need not in STAMPED
        or any(shutil.which(program) is None for program in PROGRAMS[need] if program != "ccache")
    )


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

# SPDX-License-Identifier: Apache-2.0
"""Pytest hooks for all tests: skip tests without their tools; start the longest files first, to balance the workers."""

import json
import os
import shutil

import pytest

from scripts.setup.bootstrap import EXTRAS, PROGRAMS, STAMP
from tb.sim.env import ROOT
from tb.sim.sources import closure

STAMPED = json.loads((ROOT / STAMP).read_text())["ready"] if (ROOT / STAMP).exists() else []
"""Optional extras that set-up has installed."""


def pytest_addoption(parser):
    parser.addoption("--module", help="run only the benches that compare this module of rtl/ with the model")


def pytest_itemcollected(item):
    """Mark a test as `slow` if it needs anything except a C compiler (`cc`)."""
    if needs(item) - {"cc"}:
        item.add_marker("slow")


def pytest_runtest_setup(item):
    """Skip a test if a tool that it needs is not installed; if CI is set, fail it instead."""
    if lacks := [need for need in sorted(needs(item)) if is_missing(need)]:
        message = f"not installed; to install it: python3 scripts/setup/bootstrap.py {' '.join(lacks)}"
        (pytest.fail if os.environ.get("CI") else pytest.skip)(message)


def needs(item) -> set[str]:
    """Return the arguments of a test's `needs` markers."""
    return {need for marker in item.iter_markers("needs") for need in marker.args}


def is_missing(need: str) -> bool:
    """Return True if a need's packages, or any of its programs except ccache, are not installed."""
    return (
        need in EXTRAS
        and need not in STAMPED
        or any(shutil.which(program) is None for program in PROGRAMS[need] if program != "ccache")
    )


def modules(item) -> set[str]:
    """Return the modules of rtl/ that a test compares with the model: its `bench` modules and their submodules."""
    return {path.stem for mark in item.iter_markers("bench") for path in closure(*mark.args, **mark.kwargs)}


def pytest_collection_modifyitems(config, items):
    """Apply --module. Sort files by their longest test, longest first; with --module, put unit benches first. Tests of
    a file stay together because they share fixtures."""
    if module := config.getoption("module"):
        config.hook.pytest_deselected(items=[item for item in items if module not in modules(item)])
        items[:] = [item for item in items if module in modules(item)]
    longest: dict = {}
    for item in items:
        longest[item.path] = max(longest.get(item.path, 0), cost(item))
    items.sort(key=lambda item: (bool(module) and "units" in item.path.parts, longest[item.path]), reverse=True)


def cost(item) -> float:
    """Return the estimated seconds of a test: its ``cost`` marker, or a default for slow and simulated tests."""
    marker = item.get_closest_marker("cost")
    if marker:
        return marker.args[0]
    return 20 * bool(item.get_closest_marker("slow")) + 5 * bool(item.get_closest_marker("sim"))

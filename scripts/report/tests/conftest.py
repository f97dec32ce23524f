# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the report's tests: pages and their data."""

import numpy as np
import pytest

from model.motion.tests import figure
from scripts import trajectory
from scripts.report import __main__ as report
from scripts.tests.conftest import FakeSimulator
from tb.sim.env import simulator as simulator_name


def without_rtl(patch):
    """Replace the simulator by the bit-true model, and the predicted errors by a ramp; return the fake simulator."""
    fake = FakeSimulator()
    patch.setattr(trajectory, "simulate", fake)
    patch.setattr(
        trajectory, "predicted_error", lambda words, width, _: np.linspace(1, 2, len(words)) * 2.0 ** (8 - width)
    )
    return fake


def write(folder, *options):
    """Write a page into a folder; return its address."""
    assert report.main([*options, "--sim", simulator_name(), "--out", str(folder)]) == 0
    return (folder / "report.html").as_uri()


def write_without_rtl(folder, *options):
    with pytest.MonkeyPatch.context() as patch:
        without_rtl(patch)
        return write(folder, *options)


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Address of the page of all trajectories."""
    return write_without_rtl(tmp_path_factory.mktemp("report"), "--trajectory", "all")


@pytest.fixture(scope="session")
def clip(tmp_path_factory):
    """Address of the page of a clip whose swivel angles are changed to 1.5 rad."""
    path = figure.write(tmp_path_factory.mktemp("clip") / "t.bvh", frames=61)
    return write_without_rtl(path.parent, "--trajectory", str(path), "--phi", "1.5")


@pytest.fixture(scope="session")
def three(tmp_path_factory):
    """Address of the page of 20 targets, run through the RTL of three datapaths."""
    path = tmp_path_factory.mktemp("three") / "t.csv"
    path.write_text("x,y,z\n" + "".join(f"0.3,{n / 50},0.1\n" for n in range(20)))
    return write(path.parent, "--trajectory", str(path), "--datapath", "lean,fold,paper")


@pytest.fixture
def simulator(monkeypatch):
    return without_rtl(monkeypatch)

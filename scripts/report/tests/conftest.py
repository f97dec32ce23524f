# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the report's browser tests: pages from the RTL and a browser."""

import pytest

from model.motion.tests import figure
from scripts import run
from scripts.report import page as report
from scripts.report.tests.browser import WIDE, Page
from scripts.tests.test_run import FakeSimulator
from tb.sim.env import simulator


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Write the report of an RTL run of all trajectories; return its address."""
    out = tmp_path_factory.mktemp("report")
    assert report.main(["--trajectory", "all", "--sim", simulator(), "--out", str(out)]) == 0
    return (out / "report.html").as_uri()


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """Write a report of a file's targets without the RTL; return its address."""
    monkeypatch.setattr(run, "simulate", FakeSimulator().simulate)

    def fake(text):
        (tmp_path / "t.csv").write_text(text)
        assert report.main(["--trajectory", str(tmp_path / "t.csv"), "--out", str(tmp_path)]) == 0
        return (tmp_path / "report.html").as_uri()

    return fake


@pytest.fixture(scope="session")
def clip(tmp_path_factory):
    """Write the report of an RTL run of a clip with a changed swivel angle; return its address."""
    out = tmp_path_factory.mktemp("clip")
    figure.write(out / "t.bvh", frames=61)
    options = ["--trajectory", str(out / "t.bvh"), "--phi", "1.5", "--sim", simulator(), "--out", str(out)]
    assert report.main(options) == 0
    return (out / "report.html").as_uri()


@pytest.fixture
def browser(tmp_path):
    """Open pages with browser(address, size, features); fail at teardown if a page had a problem."""
    pages = []

    def browser(address, size=WIDE, **features):
        profile = tmp_path / f"profile{len(pages)}"
        media = {name.replace("_", "-"): value for name, value in features.items()}
        page = Page(profile, *size, media)
        pages.append(page)
        return page.open(address)

    yield browser
    for page in pages:
        page.__exit__()
    assert [page.problems for page in pages] == [[] for _ in pages]

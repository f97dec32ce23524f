# SPDX-License-Identifier: Apache-2.0
"""Fixtures for tests of commands."""

from functools import partial
from pathlib import Path
from shutil import which

import numpy as np
import pytest

from scripts import console, run, trajectory
from scripts.report.tests.browser import WIDE, Page


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Return a function that calls a main() in an empty folder and returns its exit status, stdout and stderr lines."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console, "EVERY", 1e6)  # no lines of progress on stderr
    monkeypatch.delenv("MAKELEVEL", raising=False)

    def command(main, *arguments):
        status = main(list(arguments))
        captured = capsys.readouterr()
        return status, captured.out.splitlines(), captured.err.splitlines()

    return command


@pytest.fixture
def cli(simulator, command, monkeypatch):
    monkeypatch.setattr(
        trajectory, "predicted_error", lambda words, width, datapath: np.full(len(words), 2.0 ** (8 - width))
    )
    return partial(command, run.main)


@pytest.fixture
def files():
    """Return a function that lists the files below the working folder, sorted."""
    return lambda: sorted(str(path) for path in Path().rglob("*") if path.is_file())


@pytest.fixture(scope="session")
def chromium():
    """Start the installed Chromium with Playwright; no browser is downloaded."""
    from playwright.sync_api import sync_playwright  # `make test` does not install it

    with sync_playwright() as playwright:
        options = ["--disable-gpu", "--disable-dev-shm-usage"]
        yield playwright.chromium.launch(executable_path=which("chromium"), args=options)


@pytest.fixture
def browser(chromium):
    """Return a function browser(address, size, **features) that opens a page. A problem of a page fails the test."""
    pages = []

    def browser(address, size=WIDE, **features):
        pages.append(Page(chromium, *size, **features))
        return pages[-1].open(address)

    yield browser
    for page in pages:
        page.close()
    assert [page.problems for page in pages] == [[] for _ in pages]

# SPDX-License-Identifier: Apache-2.0
"""Fixtures for tests of commands."""

from pathlib import Path

import pytest

from scripts import console


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Call a main() in an empty folder; return exit status, stdout lines and stderr lines."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console, "EVERY", 1e6)  # no lines of progress on stderr

    def command(main, *arguments):
        status = main(list(arguments))
        captured = capsys.readouterr()
        return status, captured.out.splitlines(), captured.err.splitlines()

    return command


@pytest.fixture
def files():
    """Return a function that lists the files below the working folder, sorted."""
    return lambda: sorted(str(path) for path in Path().rglob("*") if path.is_file())

# SPDX-License-Identifier: Apache-2.0
"""What the tests of commands share."""

from pathlib import Path

import pytest


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Calls a main() in an empty folder: (exit status, stdout lines, stderr lines)."""
    monkeypatch.chdir(tmp_path)

    def command(main, *arguments):
        status = main(list(arguments))
        captured = capsys.readouterr()
        return status, captured.out.splitlines(), captured.err.splitlines()

    return command


@pytest.fixture
def files():
    """The files below the working folder, sorted."""
    return lambda: sorted(str(path) for path in Path().rglob("*") if path.is_file())

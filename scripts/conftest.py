# SPDX-License-Identifier: Apache-2.0
"""What the tests of commands share."""

from pathlib import Path

import pytest

from scripts import console


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Calls a main() in an empty folder: (exit status, stdout lines, stderr lines)."""
    monkeypatch.chdir(tmp_path)
    # what a busy machine takes seconds for says so, which is no matter of these tests
    monkeypatch.setattr(console.Meter, "beat", lambda meter: None)

    def command(main, *arguments):
        status = main(list(arguments))
        captured = capsys.readouterr()
        return status, captured.out.splitlines(), captured.err.splitlines()

    return command


@pytest.fixture
def files():
    """The files below the working folder, sorted."""
    return lambda: sorted(str(path) for path in Path().rglob("*") if path.is_file())

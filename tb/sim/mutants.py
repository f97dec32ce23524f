# SPDX-License-Identifier: Apache-2.0
"""Seeded bugs: one text in a copy of the RTL or the model becomes another one, and something has to notice."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from tb.sim.env import ROOT


@dataclass(frozen=True)
class Bug:
    """In the copy of `file`, the text `old`, which is there once, becomes `new`; `fails` is what must notice it."""

    what: str
    file: str
    old: str
    new: str
    fails: str = ""

    def seeded(self, text: str) -> str:
        """The file's text with the bug in it. Raises LookupError where `old` is not there exactly once."""
        if text.count(self.old) != 1:
            raise LookupError(f"{self.file} has not exactly one {self.old!r}")
        return text.replace(self.old, self.new)


def _copy(place: Path, folder: str, bug: Bug | None) -> Path:
    shutil.rmtree(place / folder, ignore_errors=True)
    shutil.copytree(ROOT / folder, place / folder, ignore=shutil.ignore_patterns("__pycache__"))
    if bug:
        path = place / bug.file
        path.write_text(bug.seeded(path.read_text()))
    return place


def copy_rtl(place: Path, bug: Bug | None = None) -> Path:
    """A fresh copy of rtl/ in `place`, with the bug in it if there is one; returns `place`.

    Raises LookupError if the bug cannot be seeded.
    """
    return _copy(place, "rtl", bug)


def copy_model(place: Path, bug: Bug | None = None) -> Path:
    """The same of model/, with what pytest needs to run its tests there."""
    for name in ("pyproject.toml", "conftest.py"):
        shutil.copy(ROOT / name, place)
    return _copy(place, "model", bug)

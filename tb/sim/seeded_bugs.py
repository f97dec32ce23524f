# SPDX-License-Identifier: Apache-2.0
"""Seeded bugs: text replacements in a copy of the RTL that a test or a proof must detect."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from tb.sim.env import ROOT


@dataclass(frozen=True)
class Bug:
    """Replacement of the text `old`, which occurs once in `file`, by `new`. The check named `fails` must detect it."""

    what: str
    file: str
    old: str
    new: str
    fails: str = ""

    def seeded(self, text: str) -> str:
        """Return the file's text with the bug in it. Raises LookupError unless `old` occurs exactly once."""
        if text.count(self.old) != 1:
            raise LookupError(f"{self.file} does not contain {self.old!r} exactly once")
        return text.replace(self.old, self.new)


def copy_rtl(place: Path, bug: Bug | None = None) -> Path:
    """Copy rtl/ into `place`, with `bug` if it is given, and return `place`. Raises LookupError as Bug.seeded does."""
    shutil.rmtree(place / "rtl", ignore_errors=True)
    shutil.copytree(ROOT / "rtl", place / "rtl")
    if bug:
        path = place / bug.file
        path.write_text(bug.seeded(path.read_text()))
    return place

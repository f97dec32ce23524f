# SPDX-License-Identifier: Apache-2.0
"""Points of the RTL that no test can reach: ``waivers.json``, matched by the text of their line, each with its reason."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from tb.sim.coverage import Point
from tb.sim.env import ROOT

WAIVERS = ROOT / "tb" / "coverage" / "waivers.json"


@dataclass(frozen=True)
class Waiver:
    """Points in files that match ``file`` (with * and ?), of lines with ``text``, blanks aside, of a ``kind`` (several with
    | between), whose ``what`` matches in whole."""

    file: str
    text: str
    kind: str
    reason: str
    what: str = ".*"

    def fits(self, point: Point) -> bool:
        return (
            point.kind in self.kind.split("|")
            and fnmatchcase(point.file, self.file)
            and plain(self.text) in plain(source(point.file, point.line))
            and re.fullmatch(self.what, point.what) is not None
        )


def plain(text: str) -> str:
    """Without blanks."""
    return re.sub(r"\s+", "", text)


@functools.cache
def _lines(file: str) -> list[str]:
    return (ROOT / file).read_text(encoding="utf-8").splitlines()


def source(file: str, line: int) -> str:
    """The text of a line."""
    return _lines(file)[line - 1].strip()


def waivers() -> list[Waiver]:
    """Those of the file."""
    return [Waiver(**fields) for fields in json.loads(WAIVERS.read_text(encoding="utf-8"))]


def excused(missed: Iterable[Point], given: Sequence[Waiver]) -> tuple[dict[Point, str], list[Waiver]]:
    """The points among those not reached that a waiver excuses, with its reason, and the waivers that excuse none."""
    reasons: dict[Point, str] = {}
    idle = set(given)
    for point in missed:
        for waiver in given:
            if waiver.fits(point):
                reasons.setdefault(point, waiver.reason)
                idle.discard(waiver)
    return reasons, [waiver for waiver in given if waiver in idle]

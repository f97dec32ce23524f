# SPDX-License-Identifier: Apache-2.0
"""Waivers for unreachable points of the RTL: ``waivers.json`` matches them by line text and gives each a reason."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from tb.coverage.proved import still
from tb.sim.coverage import Point
from tb.sim.env import ROOT

PROVED = "proved"
WAIVERS = ROOT / "tb" / "coverage" / "waivers.json"


@dataclass(frozen=True)
class Waiver:
    """Points of a ``kind`` (alternatives separated by |) in files that match ``file`` (with * and ?), on lines that
    contain ``text``, ignoring blanks. ``what`` selects points of a line, all if empty, in the notation of the report:
    signals with bits, ``a[7:5,0]; b``, both ways or with `` 0->1``; otherwise the point itself. :data:`PROVED` selects
    node bits that are 0 by proof."""

    file: str
    text: str
    kind: str
    reason: str
    what: str = ""

    def fits(self, point: Point) -> bool:
        return (
            point.kind in self.kind.split("|")
            and fnmatchcase(point.file, self.file)
            and plain(self.text) in plain(source(point.file, point.line))
            and (
                still(point)
                if self.what == PROVED
                else not self.what or any(named(point.what, one) for one in self.what.split("; "))
            )
        )


def named(what: str, by: str) -> bool:
    """Return True if part ``by`` of a waiver's names covers the ``what`` of a point."""
    name, numbers, way = re.fullmatch(r"(.*?)(?:\[([\d:,]+)\])?( [01]->[01])?", by).groups()
    found = re.fullmatch(r"(.*?)(?:\[(\d+)\])?:([01]->[01])", what)
    if what == by or not found:
        return what == by
    spans = [[int(end) for end in span.split(":")] for span in numbers.split(",")] if numbers else []
    return (
        found[1] == name
        and (not spans or any(span[-1] <= int(found[2] or -1) <= span[0] for span in spans))
        and way in (None, f" {found[3]}")
    )


def plain(text: str) -> str:
    """Remove all blanks."""
    return re.sub(r"\s+", "", text)


@functools.cache
def _lines(file: str) -> list[str]:
    return (ROOT / file).read_text(encoding="utf-8").splitlines()


def source(file: str, line: int) -> str:
    """Return the text of a line."""
    return _lines(file)[line - 1].strip()


def waivers() -> list[Waiver]:
    """Return the waivers of the file, which groups them by reason."""
    given = json.loads(WAIVERS.read_text(encoding="utf-8"))
    return [Waiver(reason=reason, **fields) for reason, some in given.items() for fields in some]


def excused(missed: Iterable[Point], given: Sequence[Waiver]) -> tuple[dict[Point, str], list[Waiver]]:
    """Return the waived points among ``missed`` with their reasons, and the waivers that match none."""
    reasons: dict[Point, str] = {}
    idle = set(given)
    for point in missed:
        for waiver in given:
            if waiver.fits(point):
                reasons.setdefault(point, waiver.reason)
                idle.discard(waiver)
    return reasons, [waiver for waiver in given if waiver in idle]

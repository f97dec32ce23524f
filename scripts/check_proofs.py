# SPDX-License-Identifier: Apache-2.0
"""make check-proofs: which pages of proofs and measurements are of other code than the present one, and which code.

    python -m scripts.check_proofs [--strict]

A page carries digests of the code that it is of, without comments and blanks: a changed comment costs nothing. A stale
page is said and is no mistake (exit status 0), but with --strict, as for a release (1).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from scripts import soak_page
from scripts.console import Parser, exit_status
from scripts.formal import ARITHMETIC_PAGE, RANGES_PAGE, STREAMS_PAGE, WIDTHS_PAGE
from scripts.fpga import measure
from scripts.generate.page_tables import table
from tb.formal import arithmetic_parts, overflow, prove, widths


@dataclass(frozen=True)
class Page:
    """A page, the command that writes it, the digests that it carries and those of the present code."""

    path: Path
    command: str
    recorded: Callable[[], dict[str, str]]
    present: Callable[[], dict[str, str]]

    def stale(self) -> list[str]:
        """What has changed since the page was written."""
        recorded, present = self.recorded(), self.present()
        return sorted(name for name in {*recorded, *present} if recorded.get(name) != present.get(name))


def _page(path: Path, command: str, present: Callable[[], dict[str, str]]) -> Page:
    return Page(path, command, lambda: dict(table(path.read_text(), "code")), present)


def _widths() -> dict[str, str]:
    """What `make formal` does of the widths, and what the page has besides."""
    there = dict(table(WIDTHS_PAGE.read_text(), "code"))
    return {name: now for name, now in widths.digests().items() if name in there or name.startswith(widths.LIGHT)}


def _soaks(code: Callable[[dict], str]) -> Callable[[], dict[str, str]]:
    return lambda: {name: code(row) for name, row in soak_page.recorded().items()}


PAGES = (
    _page(STREAMS_PAGE, "make formal", prove.digests),
    _page(RANGES_PAGE, "make formal", overflow.digests),
    _page(ARITHMETIC_PAGE, "make formal", arithmetic_parts.digests),
    _page(WIDTHS_PAGE, "make formal", _widths),
    Page(measure.PAGE, "make fpga", measure.recorded, measure.present),
    Page(
        soak_page.PAGE,
        "make soak KEEP=1",
        _soaks(lambda row: row["code"]),
        _soaks(lambda row: soak_page.code(row["datapath"])),
    ),
)


def check(pages: Sequence[Page], strict: bool) -> int:
    """Says what is stale; the exit status."""
    found = {page: page.stale() for page in pages}
    for page, names in found.items():
        if names:
            print(f"warning: {page.path.name} is stale, `{page.command}` writes it again: {', '.join(names)} changed")
    count = sum(map(bool, found.values()))
    print(f"{len(pages) - count} of {len(pages)} pages are of the present code")
    return 1 if count and strict else 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit status."""
    parser = Parser("check_proofs", "Which pages of proofs are stale.", passes="said", fails="stale, with --strict")
    parser.add_argument("--strict", action="store_true", help="a stale page fails")
    return exit_status("check-proofs", lambda: check(PAGES, parser.parse_args(arguments).strict))


if __name__ == "__main__":
    sys.exit(main())

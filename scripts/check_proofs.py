# SPDX-License-Identifier: Apache-2.0
"""make check-proofs: list the proofs and measurements on the pages that do not match the present code.

    python -m scripts.check_proofs [--strict]

A page carries digests of the code it describes, without comments and blanks. A stale page is a warning (exit status 0),
or a failure (1) with --strict, as for a release.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

from scripts import formal, soak
from scripts.console import command, switch
from scripts.fpga import designs


@dataclass(frozen=True)
class Page:
    """A page, the command that writes it, and digests: on the page and of the present code."""

    path: Path
    command: str
    recorded: Callable[[], dict[str, str]]
    present: Callable[[], dict[str, str]]

    def stale(self) -> list[str]:
        """Return the names of digests that have changed since the page was written."""
        recorded, present = self.recorded(), self.present()
        return sorted(name for name in {*recorded, *present} if recorded.get(name) != present.get(name))


PAGES = (
    Page(formal.PAGE, "make formal", lambda: {name: row[-1] for name, row in formal.rows().items()}, formal.digests),
    Page(designs.PAGE, "make fpga", designs.recorded, designs.present),
    Page(
        soak.PAGE,
        "make soak KEEP=1",
        lambda: {name: row["code"] for name, row in soak.recorded().items()},
        lambda: {name: soak.code(row["datapath"]) for name, row in soak.recorded().items()},
    ),
)


def check(pages: Sequence[Page], strict: bool) -> int:
    """Report stale pages; return the exit status."""
    found = {page: page.stale() for page in pages}
    for page, names in found.items():
        if names:
            print(f"warning: {page.path.name} is stale, `{page.command}` writes it again: {', '.join(names)} changed")
    count = sum(map(bool, found.values()))
    print(f"{len(pages) - count} of {len(pages)} pages are of the present code")
    return 1 if count and strict else 0


@command(
    "check_proofs",
    "List stale proofs and measurements.",
    [switch("--strict", "a stale page fails")],
    passes="done",
    fails="stale, with --strict",
)
def main(options: SimpleNamespace) -> int:
    return check(PAGES, options.strict)


if __name__ == "__main__":
    sys.exit(main())

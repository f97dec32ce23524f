# SPDX-License-Identifier: Apache-2.0
"""make check-proofs: list the proofs and measurements on the pages that do not match the present code.

A page carries digests of the code it describes, without comments and blanks. A stale page is a warning (exit status 0),
or a failure (1) with --strict, as for a release.
"""

import sys
from types import SimpleNamespace

from scripts import formal, soak
from scripts.console import command, switch
from scripts.fpga import designs
from scripts.generate.render import read_table

PAGES = {
    "proofs.md": ("make formal", lambda: {name: row[-1] for name, row in formal.rows().items()}, formal.digests),
    "fpga.md": ("make fpga", designs.recorded, designs.present),
    "soak.md": (
        "make soak KEEP=1",
        lambda: {", ".join(row[:3]): row[-1] for row in read_table(soak.PAGE, "datapath")},
        lambda: {", ".join(row[:3]): soak.code(row[0]) for row in read_table(soak.PAGE, "datapath")},
    ),
}
"""Page -> the command that writes it, and the digests by name: on the page and of the present code."""


def stale(page: str) -> list[str]:
    """Return the names of digests that have changed since a page was written."""
    _, recorded, present = PAGES[page]
    written, now = recorded(), present()
    return sorted(name for name in {*written, *now} if written.get(name) != now.get(name))


@command(
    "check_proofs",
    "List stale proofs and measurements.",
    [switch("--strict", "fail on a stale page")],
    passes="done",
    fails="stale, with --strict",
)
def main(options: SimpleNamespace) -> int:
    count = 0
    for page, (writer, *_) in PAGES.items():
        if names := stale(page):
            count += 1
            print(f"warning: {page} is stale; regenerate it with `{writer}`: {', '.join(names)} changed")
    print(f"{len(PAGES) - count} of {len(PAGES)} pages are up to date")
    return 1 if count and options.strict else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""List the pages whose proofs or measurements do not match the present code: `make check-proofs`.

A page carries digests of the code that it describes; comments and white space do not change them. A stale page is a
warning (exit status 0). With --strict, as for a release, it is a failure (exit status 1).
"""

import sys

from scripts import formal, soak
from scripts.console import Options, command, switch
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
"""Page -> command that writes the page, and two functions that return digests by name: recorded and present ones."""


def stale(page: str) -> list[str]:
    """Return the names of the digests that have changed since the page was written."""
    _, recorded, present = PAGES[page]
    written, now = recorded(), present()
    return sorted(name for name in {*written, *now} if written.get(name) != now.get(name))


@command("check_proofs", [switch("--strict", "fail on a stale page")], passes="done", fails="stale, with --strict")
def main(options: Options) -> int:
    count = 0
    for page, (writer, *_) in PAGES.items():
        if names := stale(page):
            count += 1
            print(f"warning: {page} is stale; regenerate it with `{writer}`: {', '.join(names)} changed")
    print(f"{len(PAGES) - count} of {len(PAGES)} pages are up to date")
    return 1 if count and options.strict else 0


if __name__ == "__main__":
    sys.exit(main())

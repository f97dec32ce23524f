# SPDX-License-Identifier: Apache-2.0
"""Reproduce the paper: derivation, table 4, figures 6 and 7, table 6 (make paper).

    python -m scripts.paper [--only derivation|operations|figures|table6]

Each part writes its page in docs/generated; a failed check stops the command. Table 5 is `make fpga`.
"""

import sys
from types import SimpleNamespace

import click

from model.bounds.ranges import RangeError
from scripts.console import command, option
from scripts.paper import derivation, figures, operations
from scripts.paper.table6 import __main__ as table6

PARTS = {
    "derivation": derivation.write,
    "operations": operations.write,
    "figures": figures.write,
    "table6": lambda: table6.main([]),
}
"""Part -> function that writes its page and returns 0, or 1 if a check fails."""


@command(
    "paper",
    "Write the pages of comparison with the paper.",
    [option("--only", "one part  [default: all]", click.Choice(PARTS))],
)
def main(options: SimpleNamespace) -> int:
    for part in [options.only] if options.only else PARTS:
        try:
            if status := PARTS[part]():
                return status
        except RangeError as error:
            print(error, file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

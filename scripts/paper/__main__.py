# SPDX-License-Identifier: Apache-2.0
"""Reproduce the paper: derivation, table 4, figures 6 and 7, table 6 (make paper).

    python -m scripts.paper [--only derivation|operations|figures|table6]

Each part but table6 writes only pages that have changed. A failed check stops the command. Table 5 is `make fpga`.
"""

import sys
from types import SimpleNamespace

import click

from model.bounds.ranges import RangeError
from scripts.console import command, option
from scripts.generate.render import update
from scripts.paper import derivation, figures, operations
from scripts.paper.derivation.proofs import ProofError
from scripts.paper.table6 import __main__ as table6

PARTS = {"derivation": derivation.texts, "operations": operations.texts, "figures": figures.texts}
"""Part -> function that returns a dict: path -> text. The part table6 has a command of its own."""


@command(
    "paper",
    "Write the pages of comparison with the paper.",
    [option("--only", "one part  [default: all]", click.Choice([*PARTS, "table6"]))],
)
def main(options: SimpleNamespace) -> int:
    parts = [options.only] if options.only else [*PARTS, "table6"]
    try:
        for part in filter(PARTS.get, parts):
            update(PARTS[part]())
    except (RangeError, ProofError) as error:
        print(error, file=sys.stderr)
        return 1
    return table6.main([]) if "table6" in parts else 0


if __name__ == "__main__":
    sys.exit(main())

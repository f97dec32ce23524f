# SPDX-License-Identifier: Apache-2.0
"""A GTKWave save file for a VCD of ``ik_axis`` that a simulator of your own recorded.

python -m scripts.waves WAVES.vcd DATAPATH WIDTH SAVE.gtkw
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import click
from vcd.reader import VCDParseError

from model.dataflow.datapaths import CONFIGURATIONS
from scripts.console import WORD_LENGTH, InputError, command, whole_file
from scripts.save_file import write_save_file


@command(
    "waves",
    f"{__doc__.splitlines()[0]} DATAPATH is one of {', '.join(CONFIGURATIONS)}; WIDTH is the word length.",
    [
        click.Argument(["vcd"], type=Path, metavar="WAVES.vcd"),
        click.Argument(["datapath"], type=click.Choice(list(CONFIGURATIONS)), metavar="DATAPATH"),
        click.Argument(["width"], type=WORD_LENGTH),
        click.Argument(["save"], type=Path, metavar="SAVE.gtkw"),
    ],
    passes="the save file is written",
    fails="never",
)
def main(options: SimpleNamespace) -> int:
    try:
        with whole_file(options.save) as path:
            write_save_file(options.vcd, options.datapath, options.width, path)
    except ValueError as error:
        raise InputError(str(error)) from None
    except VCDParseError as error:
        raise InputError(f"{options.vcd}: {error}") from None
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""A GTKWave save file for a VCD of ``ik_axis`` that a simulator of your own recorded.

python -m scripts.waves WAVES.vcd DATAPATH WIDTH SAVE.gtkw
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from vcd.reader import VCDParseError

from model.dataflow.datapaths import CONFIGURATIONS
from scripts.console import InputError, Parser, command, one_of, whole_file, word_length, writing
from scripts.save_file import write_save_file


@command("waves")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("waves", __doc__.splitlines()[0], passes="the save file is written", fails="never")
    add = parser.add_argument
    add("vcd", type=Path, metavar="WAVES.vcd", help="a recording of ik_axis, by any simulator")
    add("datapath", type=one_of("datapath", CONFIGURATIONS), metavar="DATAPATH", help="of the recorded core")
    add("width", type=word_length, metavar="WIDTH", help="its word length, 16 to 32")
    add("save", type=Path, metavar="SAVE.gtkw", help="what is written")
    options = parser.parse_args(arguments)
    try:
        options.vcd.open("rb").close()
    except OSError as error:
        raise InputError(f"{options.vcd}: cannot be read: {error.strerror}") from None
    try:
        with writing(), whole_file(options.save) as path:
            write_save_file(options.vcd, options.datapath, options.width, path)
    except ValueError as error:
        raise InputError(str(error)) from None
    except VCDParseError as error:
        raise InputError(f"{options.vcd}: {error}") from None
    return 0


if __name__ == "__main__":
    sys.exit(main())

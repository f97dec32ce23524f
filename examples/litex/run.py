# SPDX-License-Identifier: Apache-2.0
"""Simulate a LiteX SoC, a VexRiscv with ik_axi, that solves the paper's targets with examples/driver and compares them.

    python -m examples.litex.run [--targets 1..100] [--width 16..32] [--bus wishbone|axi] [--out DIR]

Builds the SoC with its headers, its simulator, and the program main.c for its CPU. Prints what the program writes to
the UART.
"""

import logging
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import click
import numpy as np

from model.dataflow import fixed
from model.io import trajectories
from model.io.words import FIELDS, RECORDS, Targets, to_words
from scripts.console import WORD_LENGTH, InputError, command, option
from tb.sim.job import SimulationError


def header(count: int, width: int) -> str:
    """Return the text of targets.h: the first targets of the paper's scenario, and the result records of the model."""
    whole_set = trajectories.make(trajectories.DEFAULT)
    targets = Targets(name="", **{name: getattr(whole_set, name)[:count] for name in FIELDS})
    tags = np.arange(count) + 0xA50000
    kept, *_ = RECORDS.core_words(RECORDS.targets(to_words(targets, 32)[0], tags), width)
    answer = fixed.run(kept, width, "lean")
    records = np.frombuffer(RECORDS.written(answer.results, answer.flags, tags, width), "<u4").reshape(-1, 8)
    rows = zip(*(getattr(targets, name) for name in FIELDS), tags, strict=True)
    return "\n".join(
        [
            f"enum {{ TARGETS = {count} }};",
            "static const ik_target targets[TARGETS] = {",
            *(f"    {{{', '.join(float(value).hex() for value in row)}, {tag}}}," for *row, tag in rows),
            "};",
            "static const uint32_t expected[TARGETS][8] = {",
            *(f"    {{{', '.join(f'0x{word:08x}' for word in record)}}}," for record in records),
            "};\n",
        ]
    )


def run(out: Path) -> bool:
    """Run the simulation and print what the UART sends; return whether the program passes. Raises SimulationError."""
    printed = []
    with subprocess.Popen([out / "model" / "Vtop"], stdout=subprocess.PIPE, text=True, cwd=out / "gateware") as process:
        for line in process.stdout:
            if not line.startswith("- "):  # Verilator's message for $finish
                print(line, end="", flush=True)
                printed.append(line.strip())
    if process.returncode:
        raise SimulationError("the program does not end within the clocks of LATEST in examples/litex/soc.py")
    return printed[-1:] == ["passed"]


@command(
    "litex",
    __doc__.splitlines()[0],
    [
        option("--targets", "number of the paper's targets", click.IntRange(1, 100), default=100),
        option("--width", "word length W", WORD_LENGTH, default=32),
        option("--bus", "the SoC's bus, by adapters of LiteX", click.Choice(["wishbone", "axi"]), default="wishbone"),
        option("--out", "folder for what is built", Path, default="build/litex", metavar="DIR"),
    ],
    passes="all words equal the model's",
)
def main(options: SimpleNamespace) -> int:
    try:
        from examples.litex import soc
    except ImportError as error:
        raise InputError(f"the package {error.name} is not installed: use make -C examples/litex") from None
    logging.basicConfig(level=logging.ERROR)  # without LiteX's log
    out = options.out.resolve()
    soc.build(out, options.width, options.bus, optimize=options.targets > 10)
    soc.load(out, header(options.targets, options.width))
    return 0 if run(out) else 1


if __name__ == "__main__":
    sys.exit(main())

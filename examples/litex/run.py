# SPDX-License-Identifier: Apache-2.0
"""Simulate a LiteX SoC (VexRiscv, ik_axi) that solves the paper's targets with examples/driver and checks the results.

Builds the SoC with its headers, its simulator, and the program main.c for its CPU. Prints what the program writes to
the UART.
"""

import logging
import subprocess
import sys
from pathlib import Path

import click
import numpy as np

from model.dataflow import fixed
from model.io import trajectories
from model.io.stimuli import hand_poses, random_reachable
from model.io.words import ARM_RECORDS, FIELDS, RECORDS, Targets, to_words
from scripts.console import WORD_LENGTH, InputError, Options, command, option, switch
from tb.sim.job import SimulationError


def wrists(count: int) -> tuple[np.ndarray, list]:
    """Return the first targets of the paper's scenario, as 32-bit words (N, 6) and as a list of rows of values."""
    whole_set = trajectories.make(trajectories.DEFAULT)
    targets = Targets(name="", **{name: getattr(whole_set, name)[:count] for name in FIELDS})
    return to_words(targets, 32)[0], list(zip(*(getattr(targets, name) for name in FIELDS), strict=True))


def hands(count: int) -> tuple[np.ndarray, list]:
    """Return random hand poses in reach, as 32-bit words (N, 11) and as a list of rows of values."""
    wrist = random_reachable(4 * count, 32, 1)
    words = hand_poses(wrist[wrist[:, 4:].min(axis=1) > 1 << 24][:count], 32, 1)
    values = np.ldexp(words.astype(float), -30)
    values[:, 3] *= np.pi / 2
    return words, values.tolist()


def header(count: int, width: int, arm: bool = False) -> str:
    """Return the text of targets.h: the targets, as doubles and as records, and the records of the model's results."""
    words, values = (hands if arm else wrists)(count)
    layout, branch = (ARM_RECORDS, np.arange(count) % 8) if arm else (RECORDS, np.zeros(count, int))
    tags = np.arange(count) + 0xA50000
    records = layout.packed(words, branch << 24 | tags)
    answer = fixed.run(layout.core_words(records, width)[0], width, "arm" if arm else "lean", branch)
    results = layout.written(answer.results[:, : len(layout.results)], answer.flags, tags, width)
    rows = []
    for row, bit, tag in zip(values, branch, tags, strict=True):
        numbers = [float(value).hex() for value in row]
        rows.append([*numbers[:7], f"{{{', '.join(numbers[7:])}}}", tag, bit] if arm else [*numbers, tag])

    def array(head: str, rows) -> list[str]:
        return [f"{head} = {{", *(f"    {{{', '.join(map(str, row))}}}," for row in rows), "};"]

    def table(name: str, data: bytes) -> list[str]:
        rows = [[f"0x{word:08x}" for word in row] for row in np.frombuffer(data, "<u4").reshape(count, -1)]
        return array(f"static const uint32_t {name}[TARGETS][{layout.size // 4}]", rows)

    kind = "ik_hand" if arm else "ik_target"
    lines = [f"#define ARM {int(arm)}", f"enum {{ TARGETS = {count} }};"]
    lines += array(f"static const {kind} targets[TARGETS]", rows)
    return "\n".join([*lines, *table("records", records), *table("expected", results), ""])


def run(out: Path) -> bool:
    """Run the simulation and print what the UART sends; return whether the program passes. Raises SimulationError."""
    printed = []
    with subprocess.Popen([out / "model" / "Vtop"], stdout=subprocess.PIPE, text=True, cwd=out / "gateware") as process:
        for line in process.stdout:
            if not line.startswith("- "):  # Verilator's message for $finish
                print(line, end="", flush=True)
                printed.append(line.strip())
    if process.returncode:
        raise SimulationError("the program did not end within LATEST clocks (see examples/litex/soc.py)")
    return printed[-1:] == ["passed"]


@command(
    "litex",
    [
        option("--targets", "number of the paper's targets", click.IntRange(1, 100), default=100),
        option("--width", "word length W", WORD_LENGTH, default=32),
        option("--bus", "the SoC's bus, by adapters of LiteX", click.Choice(["wishbone", "axi"]), default="wishbone"),
        switch("--arm", "a core for the whole arm, and random hand poses"),
        option("--out", "folder for what is built", Path, default="build/litex", metavar="DIR"),
    ],
    passes="all words equal the model's",
)
def main(options: Options) -> int:
    try:
        from examples.litex import soc
    except ImportError as error:
        raise InputError(f"the package {error.name} is not installed: use make -C examples/litex") from None
    logging.basicConfig(level=logging.ERROR)  # without LiteX's log
    out = options.out.resolve()
    soc.build(out, options.width, options.bus, options.arm, optimize=options.targets > 10)
    soc.load(out, header(options.targets, options.width, options.arm))
    return 0 if run(out) else 1


if __name__ == "__main__":
    sys.exit(main())

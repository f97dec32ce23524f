# SPDX-License-Identifier: Apache-2.0
"""Print every node of one target in dataflow order, RTL next to model: `make follow`.

A `!` marks a node that differs from the model; the last lines show the first such node and its operands.
"""

import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

from model.dataflow.datapaths import MODELS
from model.dataflow.nodes import Node
from scripts.console import InputError, Options, command, option, output, switch, trajectory_options, whole
from scripts.trajectory import datapaths, prepare, simulated, sources
from scripts.waves import ALIGNED, VCD, WAVES, Recording, column, differences, model_bits, read, write_waves
from tb.sim.job import Difference, answer, hexadecimal, value
from tb.sim.simulate import SimulationError

OPTIONS = [
    option("--target", "target of the trajectory, counted from 0", whole(0), required=True, metavar="N"),
    *trajectory_options("build/follow", "the waves"),
    switch("--waves", f"also write OUT/{VCD} and OUT/{ALIGNED}, a target's nodes in one clock, and GTKWave save files"),
]


HEADINGS = ("clock", "after", "paper", "node", "RTL word", "model word", "RTL value", "model value", "equation")


def listing(recording: Recording, nodes: Sequence[Node], target: int, datapath: str) -> Iterator[str]:
    """Yield the headings, then a line for each node of a target, in dataflow order with a title before each section."""
    rows = []
    for node in nodes:
        words = recording.word(node, target), model_bits(node, target)
        shown = (*map(hexadecimal, words), *(value(word, node.format, 10) for word in words))
        clock = str(recording.admitted[target] + node.time)
        rows.append((clock, f"+{node.time}", node.equation, node.name, *shown, node.right_side))
    widths = [max(map(len, column)) for column in zip(HEADINGS, *rows, strict=True)]
    sides = [str.ljust if heading in ("paper", "node", "equation") else str.rjust for heading in HEADINGS]

    def line(mark: str, cells: Sequence[str]) -> str:
        placed = (side(cell, width) for side, cell, width in zip(sides, cells, widths, strict=True))
        return f"{mark} {'  '.join(placed)}".rstrip()

    yield line(" ", HEADINGS)
    about = MODELS[datapath].sections
    title = ""
    for node, row in zip(nodes, rows, strict=True):
        now = "inputs" if node.kind == "input" else f"{node.section}: {about[node.section]}"
        if now != title:
            title = now
            yield title
        yield line(" " if recording.word(node, target) == model_bits(node, target) else "!", row)


def explanation(recording: Recording, differing: Sequence[Difference]) -> Iterator[str]:
    """Yield lines about a target's first wrong node and about its operands, whose words are equal in RTL and model."""
    first, target = differing[0], differing[0].target
    yield f"first difference: {first}"
    yield f"        equation: {first.node.name} = {first.node.right_side}"
    for node in first.node.operands:
        word, clock = recording.word(node, target), recording.admitted[target] + node.time
        here = node.kind == "input" or node.section == first.node.section
        name = node.name if here else f"{node.section}.{node.name}"
        yield f"                  {name} at clock {clock}: {hexadecimal(word)} ({value(word, node.format)})"
    if len(differing) > 1:
        more = len(differing) - 1
        yield f"            then: {more} more node{'s' * (more > 1)} of this target, marked with !"


@command("follow", OPTIONS, passes="every node of the target equals the model", fails="one differs")
def main(arguments: Options) -> int:
    item, *others = prepare(arguments)
    target, total = arguments.target, len(item.words)
    if others:
        raise InputError("argument --trajectory: --target needs a single trajectory")
    if target >= total:
        raise InputError(f"argument --target: {item.targets.name} has targets 0 to {total - 1}, not {target}")
    (datapath,), width = datapaths(arguments, [item]), arguments.width
    nodes = answer(item.words, width, datapath, item.limits).shown
    with ExitStack() as stack:
        out = arguments.out if arguments.waves else Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ik_")))
        written = [out / name for name in WAVES]
        files = stack.enter_context(output(out, written, sources([item])))
        vcd = files(out / VCD)
        simulated(arguments, datapath, [item], vcd)
        recording = read(vcd, datapath, nodes)
        if len(recording.admitted) != total:
            raise SimulationError(f"{len(recording.admitted)} of {total} targets were admitted")
        differing = list(differences(recording, nodes))
        if arguments.waves:
            write_waves(out / VCD, recording, differing, datapath, width, nodes, files)

    admitted, last = recording.admitted[target], column(recording, nodes, target)
    about = f"target {target} of {item.targets.name}: {datapath} datapath, {width} bits, {arguments.sim}"
    print(f"{about}; admitted in clock {admitted}, its last node in clock {last}")
    print(*listing(recording, nodes, target, datapath), sep="\n")
    ours = [difference for difference in differing if difference.target == target]
    print(*(explanation(recording, ours) if ours else [f"all {len(nodes)} nodes equal the model"]), sep="\n")
    if differing and differing[0].target != target:
        print(f"follow: the first target that differs is {differing[0].target}", file=sys.stderr)
    if arguments.waves:
        print(*(f"wrote {file}" for file in written), sep="\n")
    return 1 if ours else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Read waveforms of ``ik_axis`` and ``ik_arm`` from a VCD; write an aligned VCD and GTKWave save files.

An aligned VCD shows all nodes of a target in one clock. Save files group signals and show words as real numbers.

    python -m scripts.waves WAVES.vcd DATAPATH WIDTH SAVE.gtkw

This command writes a save file for a VCD that your own simulator recorded.

Words are sampled at the falling edge of the clock, as in the scoreboard (:mod:`tb.core.pipeline`). Signals are found by
their path below the top, which is the same in all simulators. A node's label shows its equation and its delay: ``tmp1
(13) +102`` has a target's value 102 clocks after the target is admitted. GTKWave shows at most 64 bits as a decimal
number, so a save file shows only the highest 64 bits of a longer word.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from vcd.gtkw import GTKWColor, GTKWFlag, GTKWSave
from vcd.writer import VCDWriter

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.formats import Format
from model.dataflow.nodes import Limits, Node
from model.io.files import Place
from model.io.words import JOINTS, TargetError
from scripts.console import WORD_LENGTH, Options, command, output
from tb.sim.job import Difference, answer
from tb.sim.waves import Signals

TOPS = sorted({path.top for path in MODELS.values()})
VCD, ALIGNED = "waves.vcd", "aligned.vcd"
WAVES = [Path(name).with_suffix(suffix) for name in (VCD, ALIGNED) for suffix in (".vcd", ".gtkw")]
"""Waveform files of a run: the VCD, its save file, the aligned VCD, its save file."""

Nodes = Sequence[Node]

SHOWN_BITS = 64  # longest word that GTKWave shows as a decimal number

STREAMS = ("s_axis_tvalid", "s_axis_tready", "s_axis_tuser", "m_axis_tvalid", "m_axis_tready", "m_axis_tuser")


def place(datapath: str, node: Node) -> tuple[str, ...]:
    """Return the path of a node's signal below the top."""
    path = MODELS[datapath]
    return (f"g_{path.rtl}", "u_core", *filter(None, path.instance(node).split(".")), node.name)


def write_save_file(
    vcd: Path,
    datapath: str,
    width: int,
    path: Path,
    dumpfile: str,
    aligned: bool = False,
    first: Difference | None = None,
    start: int = 0,
    marker: int = -1,
) -> None:
    """Write the save file ``path`` for ``vcd``, a recording of a datapath with words of ``width`` bits.

    ``dumpfile`` is the path of the VCD relative to the save file's folder. ``aligned``: `write_aligned` wrote the
    VCD, which thus has no streams. GTKWave starts at the time ``start``, with its marker at ``marker``. It opens the
    section of the difference ``first`` and shows the node in red. Raises TargetError for a VCD of another design.
    """
    nodes, of = fixed.nodes(datapath, width), MODELS[datapath]
    core = f"g_{of.rtl}", "u_core"
    how = "aligned: one clock, one target" if aligned else f"python -m scripts.waves VCD {datapath} {width} GTKW"
    with open(path, "w", encoding="utf-8", newline="\n") as stream:
        save = _Save(stream, vcd)
        save.dumpfile(dumpfile, abspath=False)
        save.savefile(Path(dumpfile).stem + ".gtkw", abspath=False)
        save.comment(f"{of.top}, {datapath} datapath, words of {width} bits: {how}")
        if first:
            save.comment(f"first difference: {first}")
        save.timestart(start)
        save.size(1600, 1000)
        save.sst_expanded(False)
        save.signals_width(640)
        save.zoom_markers(zoom=-15.0, marker=marker)  # about 15 clocks of 10 ns in sight
        with save.group("target" if aligned else "streams"):
            for name in ("target", "differs") if aligned else ("clk", "rst", *STREAMS[:3], "s_axis_tdata"):
                save.plain((name,), "dec" if aligned else "hex")
            for name in of.inputs:
                save.word(place(datapath, nodes[name]), nodes[name].format, name + " (half turns)" * (name == "phi"))
            if not aligned:
                for name in (*STREAMS[3:], "m_axis_tdata"):
                    save.plain((name,))
                for k, name in enumerate(of.results):
                    label = name + " (half turns)" * (name in JOINTS)
                    save.word(("m_axis_tdata",), nodes[name].format, label, k * width)
                for name in ("in_valid", "out_valid") if of.period == 1 else ("clock", "go"):
                    save.plain((*core, name))
        for section, what in of.sections.items():
            with save.group(f"{section}: {what}", closed=not first or first.node.section != section):
                for node in nodes.values():
                    if node.section == section and node.kind != "input":
                        label = " ".join(filter(None, (node.name, node.equation, f"+{node.time}")))
                        color = GTKWColor.red if first and first.node.name == node.name else None
                        save.word(place(datapath, node), node.format, label, 0, color)


class _Save(GTKWSave):
    """Save file. Its methods take the path of a signal below the top."""

    def __init__(self, stream, vcd: Path) -> None:
        super().__init__(stream)
        self.signals = Signals(vcd, TOPS)

    def plain(self, path: tuple[str, ...], shown: str = "hex") -> None:
        """Add a signal: binary if it is a single bit, else in the format ``shown``."""
        name = self.signals[path].name
        self.trace(name, alias=path[-1], datafmt=shown if name.endswith("]") else "bin")

    def word(self, path: tuple[str, ...], fmt: Format, label: str, lowest: int = 0, color=None) -> None:
        """Add a word, which may be part of a signal, as a number. The word's bit 0 is the signal's bit ``lowest``."""
        signal = self.signals[path]
        if fmt.width == 1:
            self.trace(signal.name, alias=label, datafmt="bin", color=color)
            return
        shown = min(fmt.width, SHOWN_BITS)
        frac = fmt.frac - (fmt.width - shown)
        flags = GTKWFlag.fpdecshift if frac else GTKWFlag.none
        options = {"datafmt": "signed" if fmt.signed else "dec", "extraflags": flags, "color": color}
        if frac:  # pyvcd does not write this line
            self.file.write(f"[fpshift_count] {frac}\n")
        if shown == signal.size:
            self.trace(signal.name, alias=label, **options)
        else:  # GTKWave counts bits from the left
            first = signal.size - lowest - fmt.width
            self.trace_combined(label, [(first + k, signal.name) for k in range(shown)], **options)


@dataclass(frozen=True)
class Recording:
    """Recording of one trajectory. words: node -> its bits in each clock, from clock 1. admitted: admission clock of
    each target. first, period: time of clock 1's falling edge, and clock period, in units of `timescale`."""

    words: dict[str, list[str]]
    admitted: list[int]
    timescale: str
    first: int
    period: int

    def time(self, clock: int) -> int:
        """Return the time of a clock's falling edge in units of `timescale`."""
        return self.first + (clock - 1) * self.period

    def word(self, node: Node, target: int) -> str:
        """Return the bits of a node for a target; X after the end of the recording."""
        words, clock = self.words[node.name], self.admitted[target] + node.time
        return words[clock - 1] if clock <= len(words) else "x" * node.format.width


def read(vcd: Path, datapath: str, nodes: Nodes) -> Recording:
    """Read the VCD of a run of one trajectory. Raises TargetError for a VCD of another design."""
    signals = Signals(vcd, TOPS)
    words: dict[str, list[str]] = {node.name: [] for node in nodes}
    shown = [(words[node.name], signals[place(datapath, node)].code) for node in nodes]
    clk = signals[("clk",)].code
    handshake = [signals[(name,)].code for name in ("rst", "s_axis_tvalid", "s_axis_tready")]
    edges: list[int] = []
    admitted: list[int] = []
    before = "x"
    for now, bits in signals.changes():
        if (before, bits[clk]) == ("1", "0"):
            edges.append(now)
            for column, code in shown:
                column.append(bits[code])
            if [bits[code] for code in handshake] == ["0", "1", "1"]:
                admitted.append(len(edges))
        before = bits[clk]
    if len(edges) < 2:
        raise TargetError(f"{vcd}: no clock in this VCD")
    return Recording(words, admitted, signals.timescale, edges[0], edges[1] - edges[0])


def model_bits(node: Node, target: int) -> str:
    """Return the model's bits of a node for a target, from `node.value`, the words of all targets."""
    return format(int(node.value[target]) & ((1 << node.format.width) - 1), f"0{node.format.width}b")


def differences(recording: Recording, nodes: Nodes) -> Iterator[Difference]:
    """Yield the differences between RTL and model: target by target, and for each target in dataflow order."""
    for target, clock in enumerate(recording.admitted):
        for node in nodes:
            rtl, model = recording.word(node, target), model_bits(node, target)
            if rtl != model:
                yield Difference(node, target, clock + node.time, rtl, model)


def column(recording: Recording, nodes: Nodes, target: int) -> int:
    """Return the clock in which the aligned VCD shows a target: the clock of the target's last node."""
    return recording.admitted[target] + max(node.time for node in nodes)


def write_aligned(path: Path, recording: Recording, datapath: str, nodes: Nodes, wrong: set[int]) -> None:
    """Write a VCD that delays every node to the clock of the last node, so each clock shows the words of one target.

    Names, scopes and times match the VCD of the run. In a clock without a target all signals are X. The signal `target`
    is the target's number; `differs` is 1 for targets in `wrong`, which have a node that differs from the model.
    """
    top = MODELS[datapath].top
    with (
        open(path, "w", encoding="ascii", newline="\n") as stream,
        VCDWriter(stream, recording.timescale, date="", version="", comment=f"{top}, aligned") as writer,
    ):
        lines = [variable(writer, (top, name), bits) for name, bits in (("target", 32), ("differs", 1))]
        lines += [variable(writer, (top, *place(datapath, node)), node.format.width) for node in nodes]
        end = 0
        for target in range(len(recording.admitted)):
            now = recording.time(column(recording, nodes, target)) - recording.period // 2
            if end and end != now:
                for line in lines:
                    writer.change(line, end, "x")
            values = target, int(target in wrong), *(recording.word(node, target) for node in nodes)
            for line, bits in zip(lines, values, strict=True):
                writer.change(line, now, bits)
            end = now + recording.period
        for line in lines:
            writer.change(line, end, "x")
        writer.close(end + recording.period)


def variable(writer: VCDWriter, path: tuple[str, ...], bits: int):
    """Register a variable of a VCD at its path; the name ends with a bit range, as simulators write it."""
    *scopes, name = path
    return writer.register_var(tuple(scopes), f"{name}[{bits - 1}:0]" if bits > 1 else name, "wire", bits, init="x")


def write_waves(
    vcd: Path, recording: Recording, wrong: Sequence[Difference], datapath: str, width: int, nodes: Nodes, files: Place
) -> None:
    """Write the aligned VCD next to ``vcd``, and save files for both that mark the first difference in ``wrong``."""
    aligned = vcd.with_name(ALIGNED)
    first = wrong[0] if wrong else None
    write_aligned(files(aligned), recording, datapath, nodes, {difference.target for difference in wrong})
    for path in (vcd, aligned):
        clock = (column(recording, nodes, first.target) if path == aligned else first.clock) if first else 0
        marker = recording.time(clock) if first else -1
        begin = recording.time(column(recording, nodes, 0)) - recording.period // 2  # X before the first target
        start = max(begin if path == aligned else 0, marker - 7 * recording.period)
        save = files(path.with_suffix(".gtkw"))
        write_save_file(files(path), datapath, width, save, path.name, path == aligned, first, start, marker)


def align(
    vcd: Path, words: np.ndarray, width: int, datapath: str, files: Place = Path, limits: Limits | None = None
) -> None:
    """Read ``vcd``, a recording of one trajectory with input words ``words``, and call `write_waves`."""
    nodes = answer(words, width, datapath, limits).shown
    recording = read(files(vcd), datapath, nodes)
    write_waves(vcd, recording, list(differences(recording, nodes)), datapath, width, nodes, files)


@command(
    "waves",
    [
        click.Argument(["vcd"], type=Path, metavar="WAVES.vcd"),
        click.Argument(["datapath"], type=click.Choice(list(MODELS)), metavar="DATAPATH"),
        click.Argument(["width"], type=WORD_LENGTH),
        click.Argument(["save"], type=Path, metavar="SAVE.gtkw"),
    ],
    about=(
        "Write a GTKWave save file for a VCD of ik_axis or ik_arm that a simulator of your own recorded. "
        f"DATAPATH is one of {', '.join(MODELS)}; WIDTH is the word length."
    ),
    passes="the save file is written",
    fails="not used",
)
def main(options: Options) -> int:
    with output(options.save.parent, [options.save], [options.vcd]) as files:
        dumpfile = os.path.relpath(options.vcd, options.save.parent)
        write_save_file(options.vcd, options.datapath, options.width, files(options.save), dumpfile)
    return 0


if __name__ == "__main__":
    sys.exit(main())

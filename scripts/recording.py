# SPDX-License-Identifier: Apache-2.0
"""Read every node of every target from a VCD of ``ik_axis``; write a VCD with all nodes of a target in one clock.

Words are sampled at the falling edge of the clock, as in the scoreboard (:mod:`tb.core.pipeline`), and found by their
path below ``ik_axis``, which is the same in all simulators.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from vcd.reader import TokenKind, tokenize
from vcd.writer import VCDWriter

from model.dataflow import fixed
from model.dataflow.nodes import Node
from scripts.console import whole_file
from scripts.waves import TOP, Mark, Signals, place, write_save_file
from tb.sim.job import Difference

VCD, ALIGNED = "waves.vcd", "aligned.vcd"
WAVES = [Path(name).with_suffix(suffix) for name in (VCD, ALIGNED) for suffix in (".vcd", ".gtkw")]
"""Files that :func:`write_waves` writes: two recordings and their save files."""

HANDSHAKE = (("rst",), ("s_axis_tvalid",), ("s_axis_tready",))
NUMBER, DIFFERS = "target", "differs"
"""Other signals of the aligned VCD: a target's number, and whether one of its nodes differs from the model."""

NUMBER_BITS = 32


@dataclass(frozen=True)
class Recording:
    """One trajectory in a VCD. words: bits of each node by clock, from clock 1; admitted: admission clock of each
    target; first: falling edge of clock 1; first and period are in units of `timescale`."""

    words: dict[str, list[str]]
    admitted: list[int]
    timescale: str
    first: int
    period: int

    def time(self, clock: int) -> int:
        """Return the time of a clock's falling edge in units of the VCD."""
        return self.first + (clock - 1) * self.period

    def word(self, node: Node, target: int) -> str:
        """Return the bits of a node for a target; X after the end of the recording."""
        words, clock = self.words[node.name], self.admitted[target] + node.time
        return words[clock - 1] if clock <= len(words) else "x" * node.format.width


def read(vcd: Path, datapath: str, nodes: Sequence[Node]) -> Recording:
    """Read the VCD of a run of one trajectory. Raises TargetError for a VCD of another design."""
    found = Signals(vcd)
    words: dict[str, list[str]] = {node.name: [] for node in nodes}
    shown = [(words[node.name], found[place(datapath, node)].code, node.format.width) for node in nodes]
    clk, handshake = found[("clk",)].code, [found[path].code for path in HANDSHAKE]
    value: dict[str, int | str] = {}
    edges: list[int] = []
    admitted: list[int] = []
    timescale, now, fell = "", 0, False

    def sample() -> None:
        edges.append(now)
        for column, code, bits in shown:
            column.append(_bits(value.get(code, "x"), bits))
        if [_bits(value.get(code, "x"), 1) for code in handshake] == ["0", "1", "1"]:
            admitted.append(len(edges))

    with open(vcd, "rb") as stream:
        for token in tokenize(stream):
            if token.kind in (TokenKind.CHANGE_SCALAR, TokenKind.CHANGE_VECTOR):
                change = token.data
                value[change.id_code] = change.value
                fell |= change.id_code == clk and change.value in (0, "0") and now > 0  # not the initial value
            elif token.kind is TokenKind.CHANGE_TIME:
                if fell:
                    sample()
                now, fell = token.time_change, False
            elif token.kind is TokenKind.TIMESCALE:
                timescale = f"{int(token.timescale.magnitude)} {token.timescale.unit.value}"
    if fell:
        sample()
    if len(edges) < 2:
        raise ValueError(f"{vcd}: no clock in this VCD")
    return Recording(words, admitted, timescale, edges[0], edges[1] - edges[0])


def _bits(value: int | str, width: int) -> str:
    """Return all bits of a VCD's value, which omits leading digits."""
    if isinstance(value, int):
        return format(value, f"0{width}b")
    return value.lower().rjust(width, value[0].lower() if value[0] in "xXzZ" else "0")


def model_bits(node: Node, target: int) -> str:
    """Return the model's bits for a target; `node` holds its words for all targets."""
    return format(int(node.value[target]) & ((1 << node.format.width) - 1), f"0{node.format.width}b")


def differences(recording: Recording, nodes: Sequence[Node]) -> Iterator[Difference]:
    """Yield the differences between RTL and model, target by target, each in dataflow order."""
    for target, clock in enumerate(recording.admitted):
        for node in nodes:
            rtl, model = recording.word(node, target), model_bits(node, target)
            if rtl != model:
                yield Difference(node, target, clock + node.time, rtl, int(model, 2))


# -- aligned -------------------------------------------------------------------------------------------------------


def column(recording: Recording, nodes: Sequence[Node], target: int) -> int:
    """Return the clock in which the aligned VCD shows a target: the clock of its last node."""
    return recording.admitted[target] + max(node.time for node in nodes)


def write_aligned(path: Path, recording: Recording, datapath: str, nodes: Sequence[Node], wrong: set[int]) -> None:
    """Write a VCD with every node delayed to the clock of the last one, so that all words of a clock belong to one
    target.

    Names, scopes and times match the VCD of the run. A clock without a target is X. wrong: targets with a node that
    differs.
    """
    with open(path, "w", encoding="ascii", newline="\n") as stream:
        writer = VCDWriter(stream, timescale=recording.timescale, date="", version="", comment=f"{TOP}, aligned")
        with writer:
            number = _line(writer, (TOP, NUMBER), NUMBER_BITS)
            differs = _line(writer, (TOP, DIFFERS), 1)
            lines = [_line(writer, (TOP, *place(datapath, node)), node.format.width) for node in nodes]
            end = 0

            def blank() -> None:
                for line in (number, differs, *lines):
                    writer.change(line, end, "x")

            for target in range(len(recording.admitted)):
                now = recording.time(column(recording, nodes, target)) - recording.period // 2
                if end and end != now:
                    blank()
                writer.change(number, now, target)
                writer.change(differs, now, int(target in wrong))
                for line, node in zip(lines, nodes, strict=True):
                    writer.change(line, now, recording.word(node, target))
                end = now + recording.period
            blank()
            writer.close(end + recording.period)


def _line(writer: VCDWriter, path: tuple[str, ...], bits: int):
    """Register a variable at its path, with a range as simulators write it."""
    *scopes, name = path
    return writer.register_var(tuple(scopes), f"{name}[{bits - 1}:0]" if bits > 1 else name, "wire", bits, init="x")


def write_waves(
    vcd: Path, recording: Recording, found: Sequence[Difference], datapath: str, width: int, nodes: Sequence[Node]
) -> None:
    """Write the aligned VCD next to the ordinary one, and save files for both that mark the first difference."""
    aligned = vcd.with_name(ALIGNED)
    first = found[0] if found else None
    with whole_file(aligned) as unfinished:
        write_aligned(unfinished, recording, datapath, nodes, {each.target for each in found})
    for path in (vcd, aligned):
        clock = (column(recording, nodes, first.target) if path == aligned else first.clock) if first else 0
        mark = Mark(str(first), first.node.name, recording.time(clock), recording.period) if first else None
        with whole_file(path.with_suffix(".gtkw")) as unfinished:
            write_save_file(path, datapath, width, unfinished, mark, aligned=path == aligned)


def align(vcd: Path, words: np.ndarray, width: int, datapath: str) -> None:
    """Call `write_waves` for the recording of one trajectory with the targets `words` (N, 6)."""
    nodes = list(fixed.run(words, width, datapath).bits.nodes.values())
    recording = read(vcd, datapath, nodes)
    write_waves(vcd, recording, list(differences(recording, nodes)), datapath, width, nodes)

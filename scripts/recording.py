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
from scripts.save_file import TOP, Mark, place, write_aligned_save_file, write_save_file
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
    """Read the VCD of a run of one trajectory. Raises ValueError for a VCD of another design."""
    wanted = {place(datapath, node): node for node in nodes}
    code_of: dict[tuple[str, ...], str] = {}
    value: dict[str, int | str] = {}
    words: dict[str, list[str]] = {node.name: [] for node in nodes}
    shown: list[tuple[list[str], str, int]] = []  # a node's words, its identifier in the VCD, its bits
    scopes: list[str] = []
    edges: list[int] = []
    admitted: list[int] = []
    timescale, now, fell, clk = "", 0, False, ""

    def sample() -> None:
        edges.append(now)
        for column, code, bits in shown:
            column.append(_bits(value.get(code, "x"), bits))
        if [_bits(value.get(code_of[path], "x"), 1) for path in HANDSHAKE] == ["0", "1", "1"]:
            admitted.append(len(edges))

    with open(vcd, "rb") as stream:
        for token in tokenize(stream):
            kind = token.kind
            if kind is TokenKind.CHANGE_SCALAR or kind is TokenKind.CHANGE_VECTOR:
                change = token.data
                value[change.id_code] = change.value
                fell |= change.id_code == clk and change.value in (0, "0") and now > 0  # not the initial value
            elif kind is TokenKind.CHANGE_TIME:
                if fell:
                    sample()
                now, fell = token.time_change, False
            elif kind is TokenKind.SCOPE:
                scopes.append(token.scope.ident)
            elif kind is TokenKind.UPSCOPE:
                scopes.pop()
            elif kind is TokenKind.VAR and TOP in scopes:
                code_of[(*scopes[scopes.index(TOP) + 1 :], token.var.reference)] = token.var.id_code
            elif kind is TokenKind.TIMESCALE:
                timescale = f"{int(token.timescale.magnitude)} {token.timescale.unit.value}"
            elif kind is TokenKind.ENDDEFINITIONS:
                missing = [path for path in (("clk",), *HANDSHAKE, *wanted) if path not in code_of]
                if missing:
                    raise ValueError(f"{vcd}: no {'.'.join((TOP, *missing[0]))} in this VCD")
                clk = code_of[("clk",)]
                shown = [(words[node.name], code_of[path], node.format.width) for path, node in wanted.items()]
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
            for target in range(len(recording.admitted)):
                now = recording.time(column(recording, nodes, target)) - recording.period // 2
                if end and end != now:
                    _blank(writer, end, [number, differs, *lines])
                writer.change(number, now, target)
                writer.change(differs, now, int(target in wrong))
                for line, node in zip(lines, nodes, strict=True):
                    writer.change(line, now, recording.word(node, target))
                end = now + recording.period
            _blank(writer, end, [number, differs, *lines])
            writer.close(end + recording.period)


def _line(writer: VCDWriter, path: tuple[str, ...], bits: int):
    """Register a variable at its path, with a range as simulators write it."""
    *scopes, name = path
    return writer.register_var(tuple(scopes), f"{name}[{bits - 1}:0]" if bits > 1 else name, "wire", bits, init="x")


def _blank(writer: VCDWriter, now: int, lines) -> None:
    for line in lines:
        writer.change(line, now, "x")


def write_waves(
    vcd: Path, recording: Recording, found: Sequence[Difference], datapath: str, width: int, nodes: Sequence[Node]
) -> None:
    """Write the aligned VCD next to the ordinary one, and save files for both that mark the first difference."""
    aligned = vcd.with_name(ALIGNED)
    first = found[0] if found else None
    with whole_file(aligned) as unfinished:
        write_aligned(unfinished, recording, datapath, nodes, {each.target for each in found})
    for path, clock, write in (
        (vcd, first.clock if first else 0, write_save_file),
        (aligned, column(recording, nodes, first.target) if first else 0, write_aligned_save_file),
    ):
        mark = Mark(str(first), first.node.name, recording.time(clock), recording.period) if first else None
        with whole_file(path.with_suffix(".gtkw")) as unfinished:
            write(path, datapath, width, unfinished, mark)


def align(vcd: Path, words: np.ndarray, width: int, datapath: str) -> None:
    """Call `write_waves` for the recording of one trajectory with the targets `words` (N, 6)."""
    nodes = list(fixed.run(words, width, datapath).bits.nodes.values())
    recording = read(vcd, datapath, nodes)
    write_waves(vcd, recording, list(differences(recording, nodes)), datapath, width, nodes)

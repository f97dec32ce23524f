# SPDX-License-Identifier: Apache-2.0
"""Signals of a VCD, and a GTKWave save file that marks the time at which a test failed."""

import os
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import NamedTuple

from vcd.gtkw import GTKWSave
from vcd.reader import TokenKind, VCDParseError, tokenize

from model.io.words import TargetError

PER_NS = {"1 ps": 1000, "1 ns": 1}  # time unit of a VCD -> units per nanosecond


class Signal(NamedTuple):
    """Signal of a VCD. name: GTKWave's name, with all scopes; code: identifier in the file; size: number of bits."""

    name: str
    code: str
    size: int


class Signals(dict[tuple[str, ...], Signal]):
    """Dict of the signals in a VCD: path below the top -> signal. The top is the first scope named in ``tops``.

    Raises TargetError for a path that the VCD lacks.
    """

    def __init__(self, vcd: Path, tops: Collection[str]) -> None:
        super().__init__()
        self.vcd, self.top = vcd, ""
        scopes: list[str] = []
        try:
            with open(vcd, "rb") as stream:
                for token in tokenize(stream):
                    if token.kind is TokenKind.SCOPE:
                        scopes.append(token.scope.ident)
                        self.top = self.top or (scopes[-1] if scopes[-1] in tops else "")
                    elif token.kind is TokenKind.UPSCOPE:
                        scopes.pop()
                    elif token.kind is TokenKind.VAR and self.top in scopes:
                        below = scopes[scopes.index(self.top) + 1 :]
                        name = ".".join([*scopes, token.var.ref_str])
                        self[(*below, token.var.reference)] = Signal(name, token.var.id_code, token.var.size)
                    elif token.kind is TokenKind.TIMESCALE:
                        self.timescale = f"{int(token.timescale.magnitude)} {token.timescale.unit.value}"
                    elif token.kind is TokenKind.ENDDEFINITIONS:
                        break
        except VCDParseError as error:
            raise TargetError(f"{vcd}: {error}") from None
        if not self:
            raise TargetError(f"{vcd}: no module {' or '.join(tops)} in this VCD")

    def __missing__(self, path: tuple[str, ...]) -> Signal:
        raise TargetError(f"{self.vcd}: no {'.'.join((self.top, *path))} in this VCD")

    def changes(self) -> Iterator[tuple[int, dict[str, str]]]:
        """Yield each time at which signals change, and a dict with the new bits of all signals by identifier. The dict
        is the same object each time."""
        sizes = {signal.code: signal.size for signal in self.values()}
        now, bits, changed = 0, dict.fromkeys(sizes, "x"), False
        with open(self.vcd, "rb") as stream:
            for token in tokenize(stream):
                if token.kind in (TokenKind.CHANGE_SCALAR, TokenKind.CHANGE_VECTOR) and token.data.id_code in sizes:
                    bits[token.data.id_code] = _bits(token.data.value, sizes[token.data.id_code])
                    changed = True
                elif token.kind is TokenKind.CHANGE_TIME:
                    if changed:
                        yield now, bits
                    now, changed = token.time_change, False
        if changed:
            yield now, bits


def _bits(value: int | str, width: int) -> str:
    """Return all ``width`` bits of a value in a VCD, which omits leading digits."""
    if isinstance(value, int):
        return format(value, f"0{width}b")
    return value.lower().rjust(width, value[0].lower() if value[0] in "xXzZ" else "0")


def mark(vcd: Path, scope: str, nanoseconds: float, save: Path) -> None:
    """Write a GTKWave save file with the marker at a time. It shows the signals of ``scope`` and a closed group for
    each inner scope. Raises TargetError if the VCD has no such scope."""
    signals = Signals(vcd, [scope])
    marker = round(nanoseconds * PER_NS[signals.timescale])
    with open(save, "w", encoding="utf-8") as stream:
        writer = GTKWSave(stream)
        writer.dumpfile(os.path.relpath(vcd, save.parent), abspath=False)
        writer.timestart(max(0, marker - 150 * PER_NS[signals.timescale]))
        writer.size(1600, 1000)
        writer.signals_width(400)
        writer.zoom_markers(zoom=-15.0, marker=marker)  # about 15 clocks of 10 ns in sight
        for group in dict.fromkeys(path[0] if path[1:] else "" for path in sorted(signals, key=len)):
            with writer.group(group or scope, closed=bool(group)):
                for path, signal in signals.items():
                    if path[:-1] == (group,) * bool(group):
                        writer.trace(signal.name, alias=path[-1], datafmt="hex" if signal.size > 1 else "bin")

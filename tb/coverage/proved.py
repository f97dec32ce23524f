# SPDX-License-Identifier: Apache-2.0
"""Node bits that no input sets, from the proved ranges in model/bounds."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator

from model.bounds import ranges
from model.bounds.lean_ranges import LeanRanges
from model.dataflow.nodes import WIDTHS, Node
from tb.sim.coverage import Point


def _limits(datapath: str, width: int) -> Iterator[tuple[Node, float, float]]:
    """Yield each node with the range of its word."""
    if datapath == "paper":
        for proof in ranges.proved(width).values():
            yield proof.node, proof.low, proof.high
        return
    for node in LeanRanges(width).nodes.values():
        yield node, node.value.low - node.value.error, node.value.high + node.value.error


@functools.cache
def lowest(datapath: str) -> dict[str, int]:
    """Return node -> lowest bit that is 0, like all bits above it, at every word length that has it."""
    found: dict[str, int] = {}
    for width in WIDTHS:
        for node, low, high in _limits(datapath, width):
            most = min(int(high / node.format.ulp), node.format.high)  # the proof shows that no value leaves its format
            first = most.bit_length() if low >= 0 else node.format.width
            found[node.name] = max(found.get(node.name, 0), first)
    return found


def still(point: Point) -> bool:
    """Return True if the point is a toggle of a constant bit of a node or of its delayed copy (x_at_y)."""
    folder = point.file.split("/")[1]
    signal = re.fullmatch(r"(?:.*\.)?(\w+?)(?:_at_\w+)?\[(\d+)\]:[01]->[01]", point.what)
    if folder not in ("lean", "paper", "fold") or point.kind != "toggle" or not signal:
        return False
    bits = lowest("paper" if folder == "paper" else "lean")
    return signal[1] in bits and int(signal[2]) >= bits[signal[1]]

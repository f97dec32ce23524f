# SPDX-License-Identifier: Apache-2.0
"""Ranges to prove: the words of each lean node, from the table of word lengths, and how products are scaled."""

from __future__ import annotations

import math
from dataclasses import dataclass

from model.bounds.lean_ranges import LeanRanges
from model.dataflow.nodes import Node


@dataclass(frozen=True)
class Range:
    """Words from `low` to `high`; `rule`: the reason if the range is narrower than interval arithmetic gives."""

    low: int
    high: int
    rule: str = ""


def model_nodes(width: int) -> dict[str, Node]:
    """Return the nodes of the lean dataflow's model."""
    return dict(LeanRanges(width).nodes)


def table(width: int) -> dict[str, Range]:
    """Return every node's range in words of its format."""
    found = {}
    for name, node in LeanRanges(width).nodes.items():
        fmt, bound, limits = node.format, node.value, node.facts.within
        if not fmt.frac:
            found[name] = Range(fmt.low, min(fmt.high, round(bound.high)), limits.why if limits else "")
            continue
        below = limits is not None and limits.below
        low = math.ceil((bound.low - bound.error) / fmt.ulp)
        high = math.ceil(bound.high / fmt.ulp) - 1 if below else math.floor((bound.high + bound.error) / fmt.ulp)
        found[name] = Range(max(low, fmt.low), min(high, fmt.high), limits.why if limits else "")
    return found


class _Scales(LeanRanges):
    """Runs the dataflow and records the power of two that scales each product."""

    def __init__(self, width: int) -> None:
        self.scales: dict[str, int] = {}
        super().__init__(width)

    def product3(self, name, a, b, fmt, scale):
        self.scales[name] = scale
        return super().product3(name, a, b, fmt, scale)


def scales(width: int) -> dict[str, int]:
    """Return product -> the power of two that scales it."""
    return _Scales(width).scales

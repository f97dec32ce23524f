# SPDX-License-Identifier: Apache-2.0
"""What is proved of each node: the words of its range in the table of word lengths, and how products are scaled."""

from __future__ import annotations

import math
from dataclasses import dataclass

from model.bounds import lean_ranges, ranges
from model.dataflow.nodes import Node

DATAPATHS = ("paper", "lean")

CASES = "intervals, part by part of the input domain"
"""Why a node of the paper's datapath without a rule can have a narrower range than its operands' ranges give."""


@dataclass(frozen=True)
class Range:
    """Words from `low` to `high`; `rule`: why it is narrower than plain intervals say, if it is."""

    low: int
    high: int
    rule: str = ""


def model_nodes(datapath: str, width: int) -> dict[str, Node]:
    """The nodes of a datapath's model."""
    if datapath == "paper":
        return {name: row.node for name, row in ranges.proved(width).items()}
    return dict(lean_ranges.LeanRanges(width).nodes)


def table(datapath: str, width: int) -> dict[str, Range]:
    """Every node's proved range in words of its format, as the table of word lengths has it."""
    found = {}
    if datapath == "paper":
        for name, row in ranges.proved(width).items():
            fmt = row.node.format
            low, high = (round(v / fmt.ulp) for v in (row.low, row.high))
            rule = "; ".join(row.rules) or ("" if row.node.op == "input" else CASES)
            found[name] = Range(max(low, fmt.low), min(high, fmt.high), rule)
        return found
    proved = lean_ranges.LeanRanges(width)
    for name, node in proved.nodes.items():
        fmt, bound, limits = node.format, node.value, node.facts.within
        if not fmt.frac:
            found[name] = Range(fmt.low, min(fmt.high, round(bound.high)), limits.why if limits else "")
            continue
        below = limits is not None and limits.below
        low = math.ceil((bound.low - bound.error) / fmt.ulp)
        high = math.ceil(bound.high / fmt.ulp) - 1 if below else math.floor((bound.high + bound.error) / fmt.ulp)
        found[name] = Range(max(low, fmt.low), min(high, fmt.high), limits.why if limits else "")
    return found


class _PaperScales(ranges.Ranges):
    """Runs the paper's dataflow and keeps by which power of two each product is scaled."""

    def __init__(self, width: int) -> None:
        super().__init__(width, ranges.cases(width)[0])
        self.scales: dict[str, int] = {}
        self.run()

    def product(self, name, a, b, fmt, scale):
        self.scales[name] = scale
        return super().product(name, a, b, fmt, scale)


class _LeanScales(lean_ranges.LeanRanges):
    """The same for the lean dataflow."""

    def __init__(self, width: int) -> None:
        self.scales: dict[str, int] = {}
        super().__init__(width)

    def product3(self, name, a, b, fmt, scale):
        self.scales[name] = scale
        return super().product3(name, a, b, fmt, scale)


def scales(datapath: str, width: int) -> dict[str, int]:
    """Product -> the power of two that it is scaled by."""
    return (_PaperScales if datapath == "paper" else _LeanScales)(width).scales

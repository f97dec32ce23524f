# SPDX-License-Identifier: Apache-2.0
"""Exact values of the lean nodes that a section computes without an operator module.

The expression is stated at the node in the dataflow. :mod:`tb.formal.overflow` evaluates it in a word long enough to be
exact, and proves that the node holds the whole value. Every word of an expression is signed, unsigned nodes as
``$signed({1'b0, ...})``, so that Verilog extends signs. Nodes of one bit cannot overflow and are left out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import WIDTHS, Latency, Node
from model.io.words import FIELDS


@dataclass(frozen=True)
class Value:
    """The `expression` that a node, read as `held`, holds `clocks` later."""

    expression: str
    held: str
    clocks: int


def _signed(expression: str, nodes: dict[str, Node]) -> str:
    """Return the expression with a zero in front of every unsigned node, delayed or not."""

    def word(found: re.Match) -> str:
        node = nodes.get(found[0].partition("_at_")[0])
        unsigned = node and not node.format.signed and node.format.width > 1
        return f"$signed({{1'b0, {found[0]}}})" if unsigned else found[0]

    return re.sub(r"\b[a-z]\w*", word, expression)


def _sections() -> dict[str, dict[str, Value]]:
    found: dict[str, dict[str, Value]] = {}
    latency, target = Latency(WIDTHS[-1]), np.zeros((1, len(FIELDS)), dtype=np.int64)
    nodes = fixed.run(target, latency.width, "lean").bits.nodes
    for node in nodes.values():
        if node.facts.exact:
            clocks = latency[node.latency] if node.latency else 0
            value = Value(_signed(node.facts.exact, nodes), _signed(node.name, nodes), clocks)
            found.setdefault(DATAPATHS["lean"].module(node.section), {})[node.name] = value
    return found


SECTIONS = _sections()
"""Module of a section -> node -> value."""


def inner(section: str, node: str) -> list[str]:
    """Return the operands of a node that the same section computes."""
    expression = SECTIONS[section][node].expression
    return [other for other in SECTIONS[section] if other != node and re.search(rf"\b{other}\b", expression)]


def depth(section: str, node: str) -> int:
    """Return the clocks after which a node depends on the section's inputs only."""
    return SECTIONS[section][node].clocks + bool(inner(section, node))


def last(section: str, node: str) -> str:
    """Return the signal that holds a node's exact value in the clock of the node."""
    clocks = SECTIONS[section][node].clocks
    return f"exact_{node}_{clocks}" if clocks else f"exact_{node}"


def properties(section: str) -> str:
    """Return the properties of a section: each node's exact value and the assertion that the node holds it."""
    lines = ["localparam integer EXACT_W = 2 * W + 8;", "reg [1:0] exact_age = 2'd0;  // clocks, up to 3"]
    lines.append("wire signed [EXACT_W-1:0] wide = 0;  // widens a comparison")
    lines += ["always @(posedge clk) if (exact_age != 2'd3) exact_age <= exact_age + 2'd1;"]
    for node, value in SECTIONS[section].items():
        name = f"exact_{node}"
        lines.append(f"wire signed [EXACT_W-1:0] {name} = {value.expression};")
        for clock in range(value.clocks):
            before = f"{name}_{clock}" if clock else name
            lines.append(f"reg signed [EXACT_W-1:0] {name}_{clock + 1};")
            lines.append(f"always @(posedge clk) {name}_{clock + 1} <= {before};")
        check = f"holds_{node} : assert ({last(section, node)} == {value.held});"
        lines.append(f"always @* if (exact_age >= {depth(section, node)}) {check}")
    return "\n".join(lines) + "\n"

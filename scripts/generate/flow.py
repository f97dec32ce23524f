# SPDX-License-Identifier: Apache-2.0
"""Analysis of dataflow graphs for pages and pictures: kinds of operations, cones, longest path, balancing delays."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from model.dataflow.expressions import HALF_UP, Floor, Operation, Sum, Term
from model.dataflow.formats import Format, Latency
from model.dataflow.lean_operations import Count
from model.dataflow.nodes import Node

WIDTH = 32

KINDS = {
    "input": ("input", "", "#ffffff", "#333333"),
    "mul": ("product", "×", "#dbeafe", "#1d4ed8"),
    "add": ("sum", "+", "#dcfce7", "#15803d"),
    "div": ("division", "÷", "#fde2c8", "#c2410c"),
    "root": ("root", "√", "#fbd5e5", "#be185d"),
    "sincos": ("sine, cosine", "sin cos", "#ede4fd", "#6d28d9"),
    "scale": ("shift", "shift", "#e0f2f1", "#0f766e"),
    "choose": ("choice", "?", "#f1f1f1", "#666666"),
}
"""Kind of operation -> name, symbol in a graph, fill colour and line colour in a schedule."""


def additions(term: Term) -> int:
    """Return the number of additions and subtractions in an expression or in a sum of shift counts."""
    if isinstance(term, Count):
        return len(term.terms) - 1 + (term.constant > 0)
    if not isinstance(term, Operation) or isinstance(term, Floor):  # half angles share their sums
        return 0
    return sum(map(additions, term.parts)) + (len(term.terms) - 1 if isinstance(term, Sum) else 0)


def added(node: Node) -> int:
    """Return the number of additions in a node that is a choice or an exact sum. Rounding counts as an addition."""
    return additions(node.op) + (node.rounding == HALF_UP)


def operation(node: Node) -> str:
    """Return the kind of the unit that computes a node, a key of ``KINDS``; "choose" for a node without a unit."""
    return Latency.TABLE[node.latency][2] if node.latency else "choose"


def kind(node: Node) -> str:
    """Return the kind of a node's operation, a key of ``KINDS``. A selection that adds is of kind "add"."""
    if node.latency == "mux" and added(node):
        return "add"
    return {"input": "input", "sum": "add"}.get(node.kind) or operation(node)


class Outside(Operation):
    """Placeholder for the operation of a node that is shown without operands."""

    kind, latency = "outside", None


def start(node: Node, width: int = WIDTH) -> int:
    """Return the clock, counted from admission, in which a node's operands are sampled."""
    return node.time - (Latency(width)[node.latency] if node.latency else 0)


def operands(node: Node) -> list[str]:
    return [operand.name for operand in node.operands]


class Delay(NamedTuple):
    """Balancing delay of a word of ``bits`` bits by ``clocks`` clocks, from clock ``begin`` to ``end``."""

    begin: int
    end: int
    bits: int
    clocks: int


def delays(nodes: Mapping[str, Node]) -> dict[str, Delay]:
    """Return a dict: name -> delay, for each node that an operation samples after the clock in which it is ready."""
    last = {n: v.time for n, v in nodes.items()}
    for node in nodes.values():
        for name in operands(node):
            last[name] = max(last[name], start(node))
    late = {n: v for n, v in nodes.items() if last[n] > v.time}
    return {n: Delay(v.time, last[n], v.format.width, last[n] - v.time) for n, v in late.items()}


def cone(nodes: Mapping[str, Node], name: str) -> dict[str, Node]:
    """Return a node and the nodes of the same equation on which it depends. Operands from other equations are included
    with the operation :class:`Outside`."""
    found, todo = {}, [name]
    while todo:
        node = nodes[todo.pop()]
        inside = node.equation == nodes[name].equation
        found[node.name] = node if inside or node.kind == "input" else replace(node, op=Outside(), after=None)
        todo += operands(found[node.name])
    return {n: found[n] for n in nodes if n in found}


def longest_path(nodes: Mapping[str, Node]) -> list[Node]:
    """Return the critical path, from an input to the last result."""
    path = [max(nodes.values(), key=lambda n: n.time)]
    while before := [o for o in (*path[-1].operands, path[-1].after) if o and o.name in nodes]:
        path.append(nodes[max(before, key=lambda n: n.time).name])
    return path[::-1]


def q(fmt: Format) -> str:
    """Return "Q i.f" for a format with i integer bits, sign excluded, and f fraction bits; U, not Q, if unsigned."""
    if fmt.width == 1:
        return "bit"
    return f"{'Q' if fmt.signed else 'U'} {fmt.width - fmt.signed - fmt.frac}.{fmt.frac}"


def tip(node: Node) -> str:
    """Describe a node in one line: equation, format, range, clocks."""
    fmt = node.format
    what = f"{node.equation} {node.name}".strip() + (f" = {node.right_side}" if node.operands else "")
    clocks = f"clocks {start(node)} to {node.time}" if node.latency else f"clock {node.time}"
    bits = fmt.width - fmt.signed - fmt.frac
    top = f"{2.0**bits:g}" if -3 <= bits <= 10 else f"2^{bits}"
    span = "0, 1" if fmt.width == 1 and not fmt.signed else f"[{f'-{top}' if fmt.signed else 0}, {top})"
    return f"{what}; {q(fmt)}, {fmt.width} bits, {span}; {clocks}"

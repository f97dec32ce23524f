# SPDX-License-Identifier: Apache-2.0
"""Dataflow graph after a run: nodes, the cone of a node, the longest path, balancing delays.

Pages and pictures are drawn from it. Formats and clocks do not depend on the target.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import Format, Latency, Node
from model.io.words import RESULT_FIELDS
from scripts.generate.counts import WIDTH, counted_run

KINDS = {
    "input": "input",
    "mul": "product",
    "add": "sum",
    "div": "division",
    "root": "root",
    "sincos": "sine, cosine",
    "scale": "shift",
    "choose": "choice",
}
"""Kind of operation -> its name."""

KIND_OF = {
    "mul": "mul", "mul3": "mul", "mul3_far": "mul", "square": "mul", "product": "mul",
    "sum2": "add", "sum3": "add", "wide": "add", "div": "div", "root": "root", "rsqrt": "root", "rsqrt_far": "root",
    "sincos": "sincos", "trig": "sincos", "norm": "scale", "lzc": "scale",
    "shift": "scale", "shift3": "scale", "even": "scale", "mux": "choose", None: "choose",
}  # fmt: skip
"""Operation of `Latency.TABLE` -> its kind."""

FLAGS = ("too_far", "too_near", "on_axis", "at_shoulder", "bad_length")


def design(datapath: str, width: int = WIDTH) -> dict[str, Node]:
    """Return the nodes of a datapath; a selection that adds words counts as a sum."""
    bits, additions = counted_run(DATAPATHS[datapath].flow, width)
    exact = {n for n, v in bits.nodes.items() if v.latency == "mux" and additions[n]}
    return {n: replace(v, op="sum") if n in exact else v for n, v in bits.nodes.items()}


def kind(node: Node) -> str:
    """Return the kind of a node's operation, a key of ``KINDS``."""
    return {"input": "input", "sum": "add"}.get(node.op) or KIND_OF[node.latency]


def start(node: Node, width: int = WIDTH) -> int:
    """Return the clock in which the node's operands are sampled."""
    return node.time - (Latency(width)[node.latency] if node.latency else 0)


def operands(node: Node, nodes: Mapping[str, Node]) -> list[str]:
    """Return the names of the operands that are in ``nodes``, each once."""
    return list(dict.fromkeys(o.name for o in node.operands if o.name in nodes))


@dataclass(frozen=True)
class Delay:
    """Delay of a word of ``bits`` bits from clock ``begin`` to clock ``end``."""

    begin: int
    end: int
    bits: int

    @property
    def clocks(self) -> int:
        """Length of the delay in clocks."""
        return self.end - self.begin

    @property
    def flip_flops(self) -> int:
        """Flip-flops of the delay."""
        return self.clocks * self.bits


def check(nodes: Mapping[str, Node], width: int = WIDTH) -> None:
    """Raise ValueError with the node's name for a missing format, a missing operand or a negative delay."""
    for node in nodes.values():
        if not isinstance(node.format, Format):
            raise ValueError(f"node {node.name}: no format")
        if start(node, width) < 0:
            raise ValueError(f"node {node.name}: starts in clock {start(node, width)}")
        for o in node.operands:
            if not o.name:
                continue
            if o.name not in nodes:
                raise ValueError(f"node {node.name}: its operand {o.name} is no node of the design")
            wait = start(node, width) - nodes[o.name].time
            if wait < 0:
                raise ValueError(f"node {node.name}: starts {-wait} clocks before its operand {o.name} is ready")


def delays(nodes: Mapping[str, Node], width: int = WIDTH, out: int | None = None) -> dict[str, Delay]:
    """Return the balancing delay of every node that has one; all results leave in clock ``out``."""
    last = {n: v.time for n, v in nodes.items()}
    for node in nodes.values():
        for o in node.operands:
            if o.name in nodes:
                last[o.name] = max(last[o.name], start(node, width))
    if out is not None:
        last |= {name: out for name in (*RESULT_FIELDS, *FLAGS) if name in nodes}
    found = {n: Delay(v.time, last[n], v.format.width) for n, v in nodes.items()}
    return {n: d for n, d in found.items() if d.flip_flops}


def cone(nodes: Mapping[str, Node], name: str) -> dict[str, Node]:
    """Return node ``name`` and all nodes it depends on. KeyError for an unknown name."""
    if name not in nodes:
        raise KeyError(f"no node {name}; results are {', '.join(RESULT_FIELDS)}")
    wanted, todo = set(), [name]
    while todo:
        at = todo.pop()
        if at not in wanted:
            wanted.add(at)
            todo += [o.name for o in nodes[at].operands if o.name]
    return {n: v for n, v in nodes.items() if n in wanted}


def part(nodes: Mapping[str, Node], *, section: str | None = None, equation: str | None = None) -> dict[str, Node]:
    """Return the nodes of a section or equation with their operands; outside operands become inputs."""
    inside = {n for n, v in nodes.items() if section in (None, v.section) and equation in (None, v.equation)}
    around = {o.name for n in inside for o in nodes[n].operands if o.name} - inside
    return {
        n: v if n in inside else replace(v, operands=(), after=None) for n, v in nodes.items() if n in inside | around
    }


def longest_path(nodes: Mapping[str, Node]) -> list[Node]:
    """Return the critical path, from an input to the last result."""
    path = [max(nodes.values(), key=lambda n: n.time)]
    while before := [o for o in (*path[-1].operands, path[-1].after) if o and o.name in nodes]:
        path.append(nodes[max(before, key=lambda n: n.time).name])
    return path[::-1]


def q(fmt: Format) -> str:
    """Return a format as Q i.f: integer bits without the sign, fraction bits; U for unsigned words."""
    if fmt.width == 1:
        return "bit"
    if not fmt.signed:
        return f"U {fmt.width - fmt.frac}.{fmt.frac}"
    return f"Q {fmt.width - 1 - fmt.frac}.{fmt.frac}"


def declared(fmt: Format) -> str:
    """Return the range of a format as text."""
    if not fmt.signed:
        return "0, 1" if fmt.width == 1 else f"[0, {_power(fmt.width - fmt.frac)})"
    top = _power(fmt.width - 1 - fmt.frac)
    return f"[-{top}, {top})"


def _power(i: int) -> str:
    return f"{2.0**i:g}" if -3 <= i <= 10 else f"2^{i}"


def tip(node: Node, width: int = WIDTH) -> str:
    """Describe a node in one line: operation, operands, format, clocks."""
    names = ", ".join(o.name or "constant" for o in node.operands)
    what = f"{node.name} {node.equation}".strip() + f": {KINDS[kind(node)]}" + (f" of {names}" if names else "")
    clocks = f"clocks {start(node, width)} to {node.time}" if node.latency else f"clock {node.time}"
    return f"{what}; {q(node.format)}, {node.format.width} bits, {declared(node.format)}; {clocks}"

# SPDX-License-Identifier: Apache-2.0
"""Dataflow graph after a run: nodes, operation counts, the cone of a node, the longest path, balancing delays.

Pages and pictures are drawn from it. Formats and clocks do not depend on the target.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import Format, Latency, Node

WIDTH = 32

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

VECTORS = ("norm", "sincos", "trig")  # units with several results


class _Counted(np.ndarray):
    """Array of words that counts the + and - applied to it."""

    done = 0

    def __array_ufunc__(self, ufunc, method, *inputs, **kwargs):
        _Counted.done += ufunc in (np.add, np.subtract)
        plain = [i.view(np.ndarray) if isinstance(i, _Counted) else i for i in inputs]
        return np.asarray(getattr(ufunc, method)(*plain, **kwargs)).view(_Counted)


class _Counting(fixed.Bits):
    """Dataflow run that records the number of + and - of every choice."""

    def __init__(self, width: int, flow: Callable) -> None:
        super().__init__(width)
        self.additions: Counter = Counter()
        flow(self, self.inputs(lambda name, fmt: np.array([1 << (width - 3)])))

    def apply(self, name, operands, fmt, words):
        before = _Counted.done
        value = words(*(np.asarray(n.value).view(_Counted) for n in operands))
        self.additions[name] = _Counted.done - before
        return np.asarray(value).view(np.ndarray)


def operations(flow: Callable) -> dict[str, Counter]:
    """Return for each section the number of each unit, a kind of `Latency.TABLE`, and of ``additions``.

    Each + or - of a rounded or exact sum is an addition; those inside another unit, such as the rounding of a product
    or a shift count, are not. A unit with several results counts once.
    """
    run = _Counting(WIDTH, flow)
    counts: dict[str, Counter] = {}
    counted = set()
    for node in run.nodes.values():
        mine, unit = counts.setdefault(node.section, Counter()), node.latency
        if unit in ("sum2", "sum3"):
            mine["additions"] += max(int(unit[-1]), len(node.operands)) - 1
        elif unit in ("mux", "wide"):
            mine["additions"] += run.additions[node.name]
        elif unit:
            key = (unit, *(o.name for o in node.operands)) if unit in VECTORS else node.name
            mine[unit.removesuffix("_far")] += key not in counted
            counted.add(key)
    return counts


def design(datapath: str, width: int = WIDTH) -> dict[str, Node]:
    """Return the nodes of a datapath; a selection that adds words counts as a sum."""
    run = _Counting(width, DATAPATHS[datapath].flow)
    return {
        name: replace(node, op="sum") if node.latency == "mux" and run.additions[name] else node
        for name, node in run.nodes.items()
    }


def kind(node: Node) -> str:
    """Return the kind of a node's operation, a key of ``KINDS``."""
    return {"input": "input", "sum": "add"}.get(node.op) or KIND_OF[node.latency]


def start(node: Node, width: int = WIDTH) -> int:
    """Return the clock in which the node's operands are sampled."""
    return node.time - (Latency(width)[node.latency] if node.latency else 0)


def operands(node: Node) -> list[str]:
    """Return the names of the operands, each once, without constants."""
    return list(dict.fromkeys(o.name for o in node.operands if o.name))


class Delay(NamedTuple):
    """Delay of a word of ``bits`` bits from clock ``begin`` to clock ``end``."""

    begin: int
    end: int
    bits: int

    @property
    def clocks(self) -> int:
        return self.end - self.begin

    @property
    def flip_flops(self) -> int:
        return self.clocks * self.bits


def delays(nodes: Mapping[str, Node]) -> dict[str, Delay]:
    """Return the balancing delay of every node that has one."""
    last = {n: v.time for n, v in nodes.items()}
    for node in nodes.values():
        for name in operands(node):
            last[name] = max(last[name], start(node))
    found = {n: Delay(v.time, last[n], v.format.width) for n, v in nodes.items()}
    return {n: d for n, d in found.items() if d.flip_flops}


def cone(nodes: Mapping[str, Node], name: str) -> dict[str, Node]:
    """Return a node and the nodes of its equation that it depends on; operands from outside become inputs."""
    found, todo = {}, [name]
    while todo:
        node = nodes[todo.pop()]
        inside = node.equation == nodes[name].equation
        found[node.name] = node if inside else replace(node, operands=(), after=None)
        todo += operands(found[node.name])
    return {n: found[n] for n in nodes if n in found}


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
    return f"{'Q' if fmt.signed else 'U'} {fmt.width - fmt.signed - fmt.frac}.{fmt.frac}"


def tip(node: Node) -> str:
    """Describe a node in one line: operation, operands, format, range, clocks."""
    names, fmt = ", ".join(o.name or "constant" for o in node.operands), node.format
    what = f"{node.name} {node.equation}".strip() + f": {KINDS[kind(node)]}" + (f" of {names}" if names else "")
    clocks = f"clocks {start(node)} to {node.time}" if node.latency else f"clock {node.time}"
    bits = fmt.width - fmt.signed - fmt.frac
    top = f"{2.0**bits:g}" if -3 <= bits <= 10 else f"2^{bits}"
    span = "0, 1" if fmt.width == 1 and not fmt.signed else f"[{f'-{top}' if fmt.signed else 0}, {top})"
    return f"{what}; {q(fmt)}, {fmt.width} bits, {span}; {clocks}"

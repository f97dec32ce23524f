# SPDX-License-Identifier: Apache-2.0
"""Figures 6 and 7 of the paper for the whole design: the dataflow graph and the pipeline schedule, as SVG.

    python -m scripts.pages.figures                            writes docs/figures/ and docs/figures.md
    python -m scripts.pages.figures --node c3 --out build/c3   the graph and the schedule of what leads to any node

Drawn from the nodes of model/dataflow/paper.py after a run: operands, formats and clocks; the proved ranges are those
of
model/bounds/ranges.py.  A balancing delay lasts from the clock in which a node is ready to the last clock in which
one of its consumers starts.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path

from model.bounds import ranges
from model.dataflow.nodes import Format, Latency, Node
from model.dataflow.paper import SECTIONS
from model.targets.words import RESULT_FIELDS
from scripts.pages import opcounts
from tb.sim.env import ROOT

FOLDER = ROOT / "docs" / "figures"
PAGE = ROOT / "docs" / "figures.md"
WIDTH = opcounts.WIDTH

COLOURS = {
    "input": ("#ffffff", "#333333"),
    "mul": ("#dbeafe", "#1d4ed8"),
    "add": ("#dcfce7", "#15803d"),
    "div": ("#fde2c8", "#c2410c"),
    "root": ("#fbd5e5", "#be185d"),
    "sincos": ("#ede4fd", "#6d28d9"),
    "scale": ("#e0f2f1", "#0f766e"),
    "choose": ("#f1f1f1", "#666666"),
}
"""Kind of operation -> fill and line."""

SECTION_TITLES = SECTIONS | {"results": "results"}


# -- the design ------------------------------------------------------------------------------------------------------


def design() -> dict[str, Node]:
    """The nodes of the dataflow after a run: formats and clocks do not depend on the target."""
    bits, additions = opcounts.counted_run()
    exact = {n: "sum" for n, v in bits.nodes.items() if v.latency == "mux" and additions[n]}
    return {n: replace(v, op=exact.get(n, v.op)) for n, v in bits.nodes.items()}


def kind(node: Node) -> str:
    """The kind of a node's operation, a key of ``COLOURS``."""
    if node.op in ("input", "sum"):
        return {"sum": "add"}.get(node.op, node.op)
    kinds = {"sum2": "add", "norm": "scale", "lzc": "scale", "shift": "scale", "mux": "choose"}
    return kinds.get(node.latency, node.latency)


OPERATION = {
    "input": "input", "mul": "×", "add": "+", "div": "÷", "root": "√", "sincos": "CORDIC", "scale": "scale",
    "choose": "choose",
}  # fmt: skip


def start(node: Node, width: int = WIDTH) -> int:
    """The clock in which the node's operands are taken."""
    return node.time - (Latency(width)[node.latency] if node.latency else 0)


@dataclass(frozen=True)
class Delay:
    """A word that waits, ``bits`` wide, from ``begin`` to ``end``; its overflow bit waits until ``flag``."""

    begin: int
    end: int
    flag: int
    bits: int

    @property
    def clocks(self) -> int:
        """How long the word waits."""
        return self.end - self.begin

    @property
    def flip_flops(self) -> int:
        """Bits that the delay takes."""
        return self.clocks * self.bits + self.flag - self.begin


def check(nodes: Mapping[str, Node], width: int = WIDTH) -> None:
    """ValueError, which names the node, for one without a format, one that nobody makes, or a negative delay."""
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
    """The balancing delay behind every node that has one; results wait for the clock ``out`` in which all leave."""
    last, flag = ({n: v.time for n, v in nodes.items()} for _ in range(2))
    for node in nodes.values():
        for o in node.operands:
            if o.name in nodes:
                # saturated asks a word only whether it fitted
                which = flag if node.op == "saturated" and o.format.width > 1 else last
                which[o.name] = max(which[o.name], start(node, width))
    if out is not None:
        last |= {name: out for name in _results(nodes)}
    found = {n: Delay(v.time, last[n], flag[n], v.format.width) for n, v in nodes.items()}
    return {n: d for n, d in found.items() if d.flip_flops}


def _results(nodes: Mapping[str, Node]) -> list[str]:
    flags = ("too_far", "too_near", "on_axis", "at_shoulder", "bad_length", "saturated")
    return [n for n in (*RESULT_FIELDS, *flags) if n in nodes]


def cone(nodes: Mapping[str, Node], name: str, equation: str | None = None) -> dict[str, Node]:
    """What leads to node ``name``; with ``equation``, the nodes of that equation and what goes into them.

    What comes from outside of the equation is left without operands.  KeyError for an unknown name.
    """
    if name not in nodes:
        results = ", ".join(RESULT_FIELDS)
        raise KeyError(f"no node {name}; results are {results}, and the nodes of model/dataflow/paper.py")
    wanted, todo = set(), [name]
    while todo:
        at = todo.pop()
        if at in wanted:
            continue
        wanted.add(at)
        if equation is None or nodes[at].equation == equation:
            todo += [o.name for o in nodes[at].operands if o.name]
    inside = {n: v for n, v in nodes.items() if n in wanted}
    if equation is not None:
        inside = {n: v if v.equation == equation else replace(v, operands=(), after=None) for n, v in inside.items()}
    return inside


def critical_path(nodes: Mapping[str, Node], width: int = WIDTH) -> list[str]:
    """Names from an input to the node that is ready last, each starting when the one before it is ready."""
    at = max(nodes.values(), key=lambda n: n.time)
    path = [at.name]
    while True:
        before = [o for o in (*at.operands, at.after) if o and o.name in nodes and o.time == start(at, width)]
        if not before:
            return path[::-1]
        at = nodes[before[0].name]
        path.append(at.name)


# -- words -----------------------------------------------------------------------------------------------------------


def _q(fmt: Format) -> str:
    """Q i.f: integer bits without the sign, fraction bits; U for words without a sign."""
    if fmt.width == 1:
        return "bit"
    if not fmt.signed:
        return f"U {fmt.width - fmt.frac}.{fmt.frac}"
    return f"Q {fmt.width - 1 - fmt.frac}.{fmt.frac}"


def _declared(fmt: Format) -> str:
    if not fmt.signed:
        return "0, 1" if fmt.width == 1 else f"[0, {_power(fmt.width - fmt.frac)})"
    top = _power(fmt.width - 1 - fmt.frac)
    return f"[-{top}, {top})"


def _power(i: int) -> str:
    return f"{2.0**i:g}" if -3 <= i <= 10 else f"2^{i}"


def _number(v: float) -> str:
    v = float(f"{v:.3g}")
    text = f"{v + 0.0:.3g}"
    return "0" if abs(v) < 1e-3 else text


def proved() -> dict[str, tuple[float, float]]:
    """Node -> proved range at the width of the figures."""
    return {n: (p.low, p.high) for n, p in ranges.proved(WIDTH).items()}


def _tip(node: Node, width: int = WIDTH, wait: Delay | None = None) -> str:
    operands = ", ".join(o.name or "constant" for o in node.operands)
    text = f"{node.name} {node.equation}: {OPERATION[kind(node)]}"
    if operands:
        text += f" of {operands}"
    text += f"; {_q(node.format)}, {node.format.width} bits"
    text += f"; clocks {start(node, width)} to {node.time}" if node.latency else "; ready at clock 0"
    if wait and wait.clocks:
        text += f"; then waits {wait.clocks} clocks, {wait.bits} bits"
    if wait and wait.flag > wait.begin:
        text += f"; its overflow bit waits {wait.flag - wait.begin} clocks"
    return text


# -- the dataflow graph ----------------------------------------------------------------------------------------------

BOX_W, BOX_H, GAP_X, GAP_Y, WIRE = 128, 58, 64, 14, 13
TOP = 74
LABELLED = 4
"""A wire has its name above it in every so many columns."""


@dataclass
class Place:
    """A box, or a wire that passes a column, with the y of its middle."""

    name: str
    column: int
    box: bool
    y: float = 0.0

    @property
    def height(self) -> float:
        return BOX_H + GAP_Y if self.box else WIRE


def _layout(nodes: Mapping[str, Node]) -> tuple[list[int], list[list[Place]], dict[str, list[Place]]]:
    """Clocks of the columns, their places from top to bottom, and for every node its box and the wire behind it."""
    clocks = sorted({n.time for n in nodes.values()})
    column = {name: clocks.index(n.time) for name, n in nodes.items()}
    reach: dict[str, int] = {}
    for n in nodes.values():
        for o in n.operands:
            if o.name in nodes:
                reach[o.name] = max(reach.get(o.name, 0), column[n.name] - 1)
    columns: list[list[Place]] = [[] for _ in clocks]
    nets: dict[str, list[Place]] = {}
    for name in nodes:
        net = [Place(name, c, c == column[name]) for c in range(column[name], reach.get(name, 0) + 1)]
        nets[name] = net or [Place(name, column[name], True)]
        for p in nets[name]:
            columns[p.column].append(p)

    neighbours: dict[int, tuple[list[Place], list[Place]]] = {id(p): ([], []) for c in columns for p in c}

    def join(a: Place, b: Place) -> None:
        neighbours[id(a)][1].append(b)
        neighbours[id(b)][0].append(a)

    for net in nets.values():
        for a, b in zip(net, net[1:], strict=False):
            join(a, b)
    for n in nodes.values():
        for o in {o.name: o for o in n.operands if o.name in nodes}:
            join(nets[o][column[n.name] - 1 - column[o]], nets[n.name][0])

    # Crossing reduction: order every column by the mean place of its neighbours, forth and back.
    for sweep in range(24):
        forward = sweep % 2 == 0
        rank = {id(p): (k + 0.5) / len(c) for c in columns for k, p in enumerate(c)}
        for c in columns if forward else reversed(columns):
            side = 0 if forward else 1

            def mean(p: Place, side=side, rank=rank) -> float:
                near = neighbours[id(p)][side] or [p]
                return sum(rank[id(q)] for q in near) / len(near)

            c.sort(key=mean)
            rank |= {id(p): (k + 0.5) / len(c) for k, p in enumerate(c)}
    # Places: each wants the mean of its neighbours, wires above all to run straight; a column keeps its order.
    for c in columns:
        _stack(c, [0.0] * len(c), [1.0] * len(c))
    for sweep in range(60):
        for c in columns if sweep % 2 == 0 else reversed(columns):
            wish, weight = [], []
            for p in c:
                before, behind = neighbours[id(p)]
                near = [*before, *behind]
                own = [q for q in near if q.name == p.name]
                wish.append(sum(q.y for q in own or near) / len(own or near) if near else p.y)
                weight.append(1.0 if p.box else 4.0)
            _stack(c, wish, weight)
    low = min(p.y - (BOX_H / 2 if p.box else 0) for c in columns for p in c)
    for c in columns:
        for p in c:
            p.y = round(p.y - low + TOP)
    return clocks, columns, nets


def _stack(column: list[Place], wish: list[float], weight: list[float]) -> None:
    """Puts the places of a column as near to their wishes as their heights allow (pool adjacent violators)."""
    offset, at = [], 0.0
    for k, p in enumerate(column):
        at += p.height / 2 + (column[k - 1].height / 2 if k else 0)
        offset.append(at)
    blocks: list[list[float]] = []  # mean, weight, count
    for w, o, g in zip(wish, offset, weight, strict=True):
        blocks.append([w - o, g, 1])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            b, a = blocks.pop(), blocks.pop()
            total = a[1] + b[1]
            blocks.append([(a[0] * a[1] + b[0] * b[1]) / total, total, a[2] + b[2]])
    k = 0
    for mean, _, count in blocks:
        for _ in range(int(count)):
            column[k].y = mean + offset[k]
            k += 1


STYLE = (
    "text{font:11px sans-serif;fill:#111}.n{font-weight:bold;font-size:12px}.s{font-size:10px;fill:#444}"
    ".w{fill:none;stroke:#8a94a3;stroke-width:1}.c{stroke:#dc2626;stroke-width:2}"
    ".l{font-size:9px;fill:#556}g:hover .b{stroke-width:3}path.w:hover{stroke-width:3;stroke:#111}"
)


def _head(wide: float, high: float, title: str, note: str) -> list[str]:
    kinds = "".join(f".{k}{{fill:{f};stroke:{s}}}" for k, (f, s) in COLOURS.items())
    return [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.0f}" height="{high:.0f}" '
        f'viewBox="0 0 {wide:.0f} {high:.0f}">',
        f"<style>{STYLE}{kinds}</style>",
        '<defs><marker id="a" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto" markerUnits="userSpaceOnUse"><path d="M0 0L8 4L0 8z" fill="#5b6472"/></marker>'
        '<marker id="r" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="9" markerHeight="9" '
        'orient="auto" markerUnits="userSpaceOnUse"><path d="M0 0L8 4L0 8z" fill="#dc2626"/></marker></defs>',
        f'<rect width="{wide:.0f}" height="{high:.0f}" fill="#fff"/>',
        f'<text x="12" y="20" style="font-size:15px">{escape(title)}</text>',
        f'<text x="12" y="38" class="s">{escape(note)}</text>',
    ]


def dataflow_svg(nodes: Mapping[str, Node], title: str, proofs: Mapping[str, tuple[float, float]]) -> str:
    """The dataflow graph of ``nodes``: from left to right, a column for every clock in which something is ready."""
    check(nodes)
    clocks, columns, nets = _layout(nodes)
    on_path = critical_path(nodes)
    steps = set(zip(on_path, on_path[1:], strict=False))
    pitch = BOX_W + GAP_X
    wide = max(24 + pitch * len(clocks) - GAP_X + 12, 760)
    high = max(p.y + BOX_H / 2 for c in columns for p in c) + 36
    note = (
        "Top to bottom in a box: name; operation, equation; format Q integer.fraction bits, declared range; proved "
        "range. Red: critical path."
    )
    out = _head(wide, high, title, note)
    left = {k: 24 + pitch * k for k in range(len(clocks))}
    for k, clock in enumerate(clocks):
        for y in (58, high - 12):
            out.append(
                f'<text x="{left[k] + BOX_W / 2:g}" y="{y:g}" text-anchor="middle" class="s">clock {clock}</text>'
            )

    def curve(a: Place, b_column: int, b_y: float) -> str:
        x0, x1 = left[a.column] + BOX_W, left[b_column]
        dx, dy = x1 - x0, b_y - a.y
        return f"M{x0:g} {a.y:g}" + (f"h{dx:g}" if dy == 0 else f"c{dx / 2:g} 0 {dx / 2:g} {dy:g} {dx:g} {dy:g}")

    pins = _pins(nodes, nets)
    labels = []
    for name, net in nets.items():
        first = net[0].column
        ends = [(nets[user][0].column, y, (name, user) in steps) for (user, o), y in pins.items() if o == name]
        turn = max((column - 1 for column, _, red in ends if red), default=first)  # where the critical path leaves it
        trunk = {False: "", True: ""}
        for a, b in zip(net, net[1:], strict=False):
            trunk[b.column <= turn] += curve(a, b.column, b.y) + f"h{BOX_W}"
            if (b.column - first) % LABELLED == 0:
                labels.append(f'<text x="{left[b.column] + 4:g}" y="{b.y - 2:g}" class="l">{name}</text>')
        for red, d in trunk.items():
            if d:
                out.append(f'<path class="w{" c" if red else ""}" d="{d}"><title>{name}</title></path>')
        for column, y, red in sorted(ends, key=lambda end: end[2]):
            d = curve(net[column - 1 - first], column, y)
            out.append(f'<path class="w{" c" if red else ""}" marker-end="url(#{"r" if red else "a"})" d="{d}"/>')
    out += labels
    for name, net in nets.items():
        out.append(_box(nodes[name], left[net[0].column], net[0].y, proofs.get(name), name in on_path))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _pins(nodes: Mapping[str, Node], nets: Mapping[str, list[Place]]) -> dict[tuple[str, str], float]:
    """(consumer, operand) -> y at which the operand's arrow enters the consumer's box, in the order of the wires."""
    pins = {}
    for name, node in nodes.items():
        box = nets[name][0]
        names = list(dict.fromkeys(o.name for o in node.operands if o.name in nodes))
        names.sort(key=lambda o: nets[o][box.column - 1 - nets[o][0].column].y)
        for k, o in enumerate(names):
            pins[name, o] = round(box.y + (k - (len(names) - 1) / 2) * min(14, (BOX_H - 10) / len(names)))
    return pins


def _box(node: Node, x: float, y: float, proof: tuple[float, float] | None, critical: bool) -> str:
    k = kind(node)
    red = ' style="stroke:#dc2626;stroke-width:2.5"' if critical else ""
    what = f"{OPERATION[k]} {node.equation}".strip()
    lines = [("n", node.name), ("", what), ("s", f"{_q(node.format)}  {_declared(node.format)}")]
    if proof:
        lines.append(("s", f"proved [{_number(proof[0])}, {_number(proof[1])}]"))
    mark = {"": "", "n": ' class="n"', "s": ' class="s"'}
    mid = x + BOX_W / 2
    text = "".join(
        f'<text x="{mid:g}" y="{y - BOX_H / 2 + 14 + 13 * n:g}" text-anchor="middle"{mark[c]}>{escape(t)}</text>'
        for n, (c, t) in enumerate(lines)
    )
    return (
        f'<g id="{node.name}"><title>{escape(_tip(node))}</title>'
        f'<rect class="b {k}" x="{x:g}" y="{y - BOX_H / 2:g}" width="{BOX_W}" height="{BOX_H}" rx="5"{red}/>{text}</g>'
    )


# -- the schedule ----------------------------------------------------------------------------------------------------

ROW = 17
LABEL = 200


def schedule_svg(nodes: Mapping[str, Node], title: str, *, wires: bool, out_clock: int | None = None) -> str:
    """Every node's stage, the delay behind it, and the critical path; ``wires`` draws every operand's way too."""
    check(nodes)
    waits = delays(nodes, out=out_clock)
    on_path = critical_path(nodes)
    first = min(n.time if not n.operands else start(n) for n in nodes.values())
    latest = max([n.time for n in nodes.values()] + [max(d.end, d.flag) for d in waits.values()])
    scale = max(4.0, min(12.0, 1100 / (latest - first)))
    total = sum(d.flip_flops for d in waits.values())
    wide, high = LABEL + scale * (latest - first) + 150, 0
    order: list[tuple[str, list[Node]]] = []
    for section in SECTIONS:
        own = sorted((n for n in nodes.values() if n.section == section), key=lambda n: (start(n), n.time))
        if own:
            order.append((section, own))
    y, rows, heads = 86, {}, []
    for section, own in order:
        heads.append((section, y))
        y += 22
        for n in own:
            rows[n.name] = y
            y += ROW
        y += 8
    high = y + 20
    note = (
        "Bars: operations, from the clock in which operands are taken to that in which the result is ready. Hatched: "
        f"balancing delay (clocks × bits; {total} flip-flops in all); thin line: delay of its overflow bit. Red: "
        f"critical path, up to clock {latest}."
    )
    out = _head(wide, high, title, note)
    out.append(
        '<defs><pattern id="h" width="5" height="5" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
        '<rect width="5" height="5" fill="#f3f4f6"/><path d="M0 0V5" stroke="#9ca3af" stroke-width="1.6"/>'
        "</pattern></defs>"
    )

    def x(clock: float) -> float:
        return round(LABEL + scale * (clock - first), 1)

    step = 10 if scale >= 4 else 50
    ticks = range(-(-first // step) * step, latest + 1, step)
    for clock in ticks:
        out.append(f'<path d="M{x(clock):g} 70V{high - 14}" stroke="#e5e7eb"/>')
        out.append(f'<text x="{x(clock):g}" y="64" text-anchor="middle" class="s">{clock}</text>')
    for section, at in heads:
        out.append(f'<text x="12" y="{at + 12}" class="n">{escape(SECTION_TITLES[section])}</text>')
        out.append(f'<path d="M12 {at + 17}H{wide - 12:g}" stroke="#9ca3af"/>')
        for clock in ticks if section != heads[0][0] else ():
            if x(clock) > LABEL + 60:  # beside the title
                out.append(f'<text x="{x(clock):g}" y="{at + 13}" text-anchor="middle" class="s">{clock}</text>')
    steps = set(zip(on_path, on_path[1:], strict=False))
    for name, node in nodes.items() if wires else ():
        for o in {o.name: o for o in node.operands if o.name in nodes}:
            if (o, name) not in steps:
                out.append(_drop(x(start(node)), rows[o] + 8, rows[name] + 8, "w", "a"))
    for name, node in nodes.items():
        at = rows[name]
        wait, begin = waits.get(name), start(node) if node.operands else node.time
        red = name in on_path
        stage = f"{begin}–{node.time}" if node.latency and node.operands else f"{node.time}"
        style = ' style="stroke:#dc2626;stroke-width:2"' if red else ""
        ink = ' style="fill:#dc2626"' if red else ""
        bar = [f"<g><title>{escape(_tip(node, wait=wait))}</title>"]
        bar.append(f'<text x="24" y="{at + 12}"{ink}>{name}</text>')
        bar.append(f'<text x="{LABEL - 12}" y="{at + 12}" text-anchor="end" class="s">{stage}</text>')
        if wait and wait.flag > wait.begin:
            bar.append(f'<path d="M{x(wait.begin):g} {at + 13.5}H{x(wait.flag):g}" stroke="#9ca3af"/>')
        if wait and wait.clocks:
            bar.append(
                f'<rect x="{x(wait.begin):g}" y="{at + 5}" width="{scale * wait.clocks:g}" height="7" fill="url(#h)" '
                f'stroke="#9ca3af"/>'
            )
        length = max(scale * (node.time - begin), 3)
        bar.append(
            f'<rect class="b {kind(node)}" x="{x(begin) if node.time > begin else x(begin) - 3:g}" y="{at + 1}" '
            f'width="{length:g}" height="{ROW - 3}"{style}/>'
        )
        if wait and wait.clocks:
            end = x(wait.end) + 4
            bar.append(f'<text x="{end:g}" y="{at + 12}" class="s">{wait.clocks} × {wait.bits}</text>')
        out.append("".join(bar) + "</g>")
    for a, b in sorted(steps, key=lambda step: nodes[step[1]].time):
        out.append(_drop(x(nodes[a].time), rows[a] + 8, rows[b] + 8, "w c", "r"))
    legend, at = LABEL + 0.0, 44
    for k in ("mul", "add", "div", "root", "sincos", "scale", "choose"):
        if any(kind(n) == k for n in nodes.values()):
            out.append(f'<rect class="{k}" x="{legend:g}" y="{at}" width="12" height="9"/>')
            out.append(f'<text x="{legend + 16:g}" y="{at + 8}" class="s">{OPERATION[k]}</text>')
            legend += 70
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _drop(x: float, y0: float, y1: float, style: str, marker: str) -> str:
    """From one row down or up to the edge of another."""
    y1 += -8 if y1 > y0 else 8
    return f'<path class="{style}" marker-end="url(#{marker})" d="M{x:g} {y0:g}V{y1:g}"/>'


# -- files -----------------------------------------------------------------------------------------------------------


def figures(nodes: Mapping[str, Node] | None = None) -> dict[Path, str]:
    """File -> text, of all figures and their page."""
    nodes = design() if nodes is None else nodes
    check(nodes)
    proofs = proved()
    latency = max(n.time for n in nodes.values())
    files = {}
    for name in RESULT_FIELDS:
        title = f"Dataflow graph of {name}, W = {WIDTH}"
        files[FOLDER / f"dataflow_{name}.svg"] = dataflow_svg(cone(nodes, name), title, proofs)
    pair = cone(nodes, "p_e_x", "(13)")
    title = f"Dataflow graph of p_e_x (13), W = {WIDTH} (figure 6 of the paper)"
    files[FOLDER / "dataflow_p_e_x.svg"] = dataflow_svg(pair, title, proofs)
    files[FOLDER / "dataflow.svg"] = dataflow_svg(nodes, f"Dataflow graph of the whole design, W = {WIDTH}", proofs)
    title = f"Pipeline schedule of p_e_x (13), W = {WIDTH} (figure 7 of the paper)"
    files[FOLDER / "schedule_p_e_x.svg"] = schedule_svg(pair, title, wires=True)
    title = f"Pipeline schedule of the whole design, W = {WIDTH}"
    files[FOLDER / "schedule.svg"] = schedule_svg(nodes, title, wires=False, out_clock=latency)
    files[PAGE] = page(nodes)
    return files


def page(nodes: Mapping[str, Node]) -> str:
    """docs/figures.md."""
    latency = max(n.time for n in nodes.values())
    waits = delays(nodes, out=latency)
    bits = sum(d.flip_flops for d in waits.values())
    largest = sorted(waits.items(), key=lambda item: (-item[1].flip_flops, item[0]))[:5]
    words = ", ".join(f"`{n}` ({d.clocks} × {d.bits})" for n, d in largest)
    links = [f"- [{n}](figures/dataflow_{n}.svg): {len(cone(nodes, n))} nodes" for n in RESULT_FIELDS]
    path = " → ".join(f"`{n}`" for n in critical_path(nodes))
    return f"""# Figures 6 and 7 for the whole design

Written by `make figures` from the nodes of `model/dataflow/paper.py` and the ranges of `model/bounds/ranges.py`;
`make test` fails when a figure is out of date.
Any other node: `python -m scripts.pages.figures --node c3 --out build/c3`.

Open the figures themselves in a browser to read them; a node's tooltip has its operands and clocks.

## Dataflow graphs (figure 6)

A column holds what is ready in one clock. Q i.f is a signed word with i integer and f fraction bits, range
[-2^i, 2^i); U has no sign. Under it stands the range proved for all input words. The critical path is red.

![Dataflow graph of p_e_x](figures/dataflow_p_e_x.svg)

- [p_e_x](figures/dataflow_p_e_x.svg): equation (13) alone, as in the paper
{chr(10).join(links)}
- [the whole design](figures/dataflow.svg): {len(nodes)} nodes

## Pipeline schedule (figure 7)

A bar is an operation from the clock in which it takes its operands to that in which its result is ready; the hatched
bar behind it is the balancing delay, as long as its slowest consumer makes the word wait.

![Pipeline schedule of p_e_x](figures/schedule_p_e_x.svg)

- [p_e_x](figures/schedule_p_e_x.svg): equation (13) alone, as in the paper
- [the whole design](figures/schedule.svg): {latency} clocks; {len(waits)} words or their overflow bits wait, which
  takes {bits} bits. [operations.md](operations.md) has what the RTL has in `ik_delay` and `ik_ring`.

The largest delays (clocks × bits): {words}.

The critical path: {path}.
"""


def main(arguments: Iterable[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.pages.figures", description=__doc__.splitlines()[0])
    parser.add_argument("--node", help="only the graph and the schedule of what leads to this node")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "figures", help="folder for the figures of --node")
    options = parser.parse_args(None if arguments is None else list(arguments))
    try:
        if options.node:
            part = cone(design(), options.node)
            schedule = schedule_svg(part, f"Pipeline schedule of {options.node}, W = {WIDTH}", wires=len(part) < 40)
            files = {
                options.out / f"dataflow_{options.node}.svg": dataflow_svg(
                    part, f"Dataflow graph of {options.node}, W = {WIDTH}", proved()
                ),
                options.out / f"schedule_{options.node}.svg": schedule,
            }
        else:
            files = figures()
    except (ValueError, KeyError) as error:
        print(error.args[0], file=sys.stderr)
        return 2
    for line in ranges.failures(WIDTH).values():
        print(line, file=sys.stderr)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    size = sum(len(t.encode()) for t in files.values())
    print(f"wrote {len(files)} files, {size / 1000:.0f} kB")
    return 1 if ranges.failures(WIDTH) else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Pipeline schedule as SVG, figure 7 of the paper: the clocks of each operation and the delay after it."""

from __future__ import annotations

from collections.abc import Mapping

from model.dataflow.nodes import Node
from scripts.generate.flow import KINDS, check, delays, kind, longest_path, operands, start, tip
from scripts.generate.render import render

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

ROW = 17
LABEL = 200


def schedule_svg(
    nodes: Mapping[str, Node], title: str, sections: Mapping[str, str], *, wires: bool, out_clock: int | None = None
) -> str:
    """Draw each node's stage, its delay and the critical path; with ``wires`` also a line to each operand."""
    check(nodes)
    waits = delays(nodes, out=out_clock)
    path = [node.name for node in longest_path(nodes)]
    first = min(n.time if not n.operands else start(n) for n in nodes.values())
    latest = max([n.time for n in nodes.values()] + [d.end for d in waits.values()])
    scale = max(4.0, min(20.0, 1100 / (latest - first)))
    step = 10 if scale >= 4 else 50

    def x(clock: float) -> float:
        return round(LABEL + scale * (clock - first), 1)

    y, at, heads = 86, {}, []
    for section, head in sections.items():
        own = sorted((n for n in nodes.values() if n.section == section), key=lambda n: (start(n), n.time))
        if own:
            heads.append((head, y))
            at |= {n.name: y + 22 + ROW * k for k, n in enumerate(own)}
            y += 22 + ROW * len(own) + 8
    rows = {}
    for name, node in nodes.items():
        begin = start(node) if node.operands else node.time
        rows[name] = {
            "y": at[name],
            "taken": x(start(node)),
            "ready": x(node.time),
            "wait": waits.get(name),
            "kind": kind(node),
            "tip": tip(node),
            "stage": f"{begin}–{node.time}" if node.latency and node.operands else f"{node.time}",
            "left": x(begin) if node.time > begin else x(begin) - 3,
            "length": max(scale * (node.time - begin), 3),
        }
    steps = set(zip(path, path[1:], strict=False))
    ways = [(o, name) for name, node in nodes.items() for o in operands(node, nodes) if (o, name) not in steps]
    kinds = {kind(node) for node in nodes.values()}
    return render(
        "schedule.svg", title=title, wide=LABEL + scale * (latest - first) + 150, high=y + 20, label=LABEL,
        row_height=ROW, scale=scale, x=x, ticks=range(-(-first // step) * step, latest + 1, step), heads=heads,
        rows=rows, path=path, wires=ways if wires else [], steps=sorted(steps, key=lambda step: nodes[step[1]].time),
        flip_flops=sum(d.flip_flops for d in waits.values()), latest=latest, colours=COLOURS,
        legend=[(k, KINDS[k]) for k in COLOURS if k in kinds and k != "input"],
    )  # fmt: skip

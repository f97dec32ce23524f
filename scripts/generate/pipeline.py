# SPDX-License-Identifier: Apache-2.0
"""SVG of one target in the pipeline: operations by section and clock, coloured by kind."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby

from model.dataflow.datapaths import DATAPATHS
from model.dataflow.fixed import FIFO_CLOCKS
from model.dataflow.nodes import Node
from scripts.generate.flow import KINDS, WIDTH, design, kind, start
from scripts.generate.render import render

LEFT, DRAWN, RIGHT = 230, 1000, 20
"""Widths in pixels: section titles, all clocks, right margin."""

TOP, LANE, GAP = 62, 11, 8
"""Heights in pixels: above the first section, a lane of operations, between sections."""

COLOURS = {
    "root": "#c2410c",
    "div": "#1d4ed8",
    "sincos": "#15803d",
    "mul": "#60a5fa",
    "add": "#34d399",
    "scale": "#a78bfa",
    "choose": "#9ca3af",
    "fifo": "#475569",
}
"""Kind of operation -> colour of its bars."""

NAMES = KINDS | {"fifo": "output FIFO"}

Bar = tuple[str, int, int, list[str]]
"""Operations of one kind at the same clocks: kind, from, to, names."""


def bars(nodes: Iterable[Node], width: int = WIDTH) -> list[Bar]:
    """Group operations by kind and clocks; a selection without a clock is wiring and is omitted."""

    def key(node: Node) -> tuple[str, int, int]:
        return kind(node), start(node, width), node.time

    working = sorted((node for node in nodes if node.time > start(node, width)), key=key)
    return [(*of, [node.name for node in own]) for of, own in groupby(working, key)]


def lanes(of: Iterable[Bar]) -> list[list[Bar]]:
    """Place bars in lanes without overlap, kind by kind in the order of ``COLOURS``."""
    found: list[list[Bar]] = []
    order = list(COLOURS)
    for bar in sorted(of, key=lambda bar: (order.index(bar[0]), bar[1], bar[2])):
        free = [lane for lane in found if all(bar[1] >= end or bar[2] <= begin for _, begin, end, _ in lane)]
        if not free:
            found.append(lane := [])
            free = [lane]
        free[0].append(bar)
    return found


def pipeline_svg(datapath: str, width: int = WIDTH) -> str:
    """Return pipeline-<datapath>.svg: every clock from a target's admission to its result at `ik_axis`."""
    nodes = design(datapath, width).values()
    ready = max(node.time for node in nodes)
    total = ready + FIFO_CLOCKS
    scale = DRAWN / total
    drawn = [
        (title, lanes(bars((node for node in nodes if node.section == name), width)))
        for name, title in DATAPATHS[datapath].sections.items()
        if name != "results"
    ]
    drawn.append(("output FIFO", [[("fifo", ready, total, ["ik_fifo"])]]))
    rows, y = [], TOP
    for title, own in drawn:
        rows.append((y, title, own))
        y += LANE * len(own) + GAP
    used = {what for _, own in drawn for lane in own for what, *_ in lane}
    legend, at = [], LEFT
    for what in (what for what in COLOURS if what in used):
        legend.append((at, COLOURS[what], NAMES[what]))
        at += 44 + 7 * len(NAMES[what])
    return render(
        "pipeline.svg", datapath=datapath, width=width, total=total, scale=scale, rows=rows, legend=legend,
        x=lambda clock: round(LEFT + scale * clock, 1), wide=LEFT + DRAWN + RIGHT, high=y + 30, bottom=y, top=TOP,
        left=LEFT, drawn=DRAWN, lane_height=LANE, gap=GAP, colours=COLOURS, kinds=NAMES,
        step=next(step for step in (1, 2, 5, 10, 20, 50) if scale * step >= 40),
    )  # fmt: skip

# SPDX-License-Identifier: Apache-2.0
"""One target in the pipeline as SVG: the operations of each section at their clocks, coloured by kind."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from itertools import groupby

from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import Node
from scripts.pages.flow import KINDS, WIDTH, design, kind, start

FIFO_CLOCKS = 2
"""From the datapath's output to that of `ik_axis`: memory, output register."""

LEFT, DRAWN, RIGHT = 230, 1000, 20
"""Pixels: titles of the sections, all clocks, the rest."""

TOP, LANE, GAP = 62, 11, 8
"""Pixels: above the first section, a lane of operations, between sections."""

COLOURS = {
    "root": "#c2410c", "div": "#1d4ed8", "sincos": "#15803d", "mul": "#60a5fa", "add": "#34d399", "scale": "#a78bfa",
    "choose": "#9ca3af", "fifo": "#475569",
}  # fmt: skip
"""Kind of operation -> its bars."""

NAMES = KINDS | {"fifo": "output FIFO"}

Bar = tuple[str, int, int, list[str]]
"""Operations of one kind at the same clocks: kind, from, to, names."""


def bars(nodes: Iterable[Node], width: int = WIDTH) -> list[Bar]:
    """What works when, by kind; a choice that takes no clock is wiring and left out."""

    def key(node: Node) -> tuple[str, int, int]:
        return kind(node), start(node, width), node.time

    working = sorted((node for node in nodes if node.time > start(node, width)), key=key)
    return [(*of, [node.name for node in own]) for of, own in groupby(working, key)]


def lanes(of: Iterable[Bar]) -> list[list[Bar]]:
    """The bars in as few lanes as it takes, kind by kind in the order of ``COLOURS``, none over another."""
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
    """pipeline-<datapath>.svg: clocks from the one in which a target is admitted to that of its result at `ik_axis`."""
    nodes = design(datapath, width).values()
    ready = max(node.time for node in nodes)
    total = ready + FIFO_CLOCKS
    scale = DRAWN / total
    rows = [
        (title, lanes(bars((node for node in nodes if node.section == name), width)))
        for name, title in DATAPATHS[datapath].sections.items()
        if name != "results"
    ]
    rows.append(("output FIFO", [[("fifo", ready, total, ["ik_fifo"])]]))

    def x(clock: int) -> float:
        return round(LEFT + scale * clock, 1)

    body, y = [], TOP
    for title, own in rows:
        body.append(f'<text x="12" y="{y + LANE * len(own) / 2 + 4:g}">{escape(title)}</text>')
        for lane in own:
            for what, begin, end, names in lane:
                tip = f"{NAMES[what]}, clocks {begin} to {end}: {', '.join(names)}"
                body.append(
                    f'<rect x="{x(begin):g}" y="{y}" width="{scale * (end - begin):.1f}" height="{LANE - 1}" '
                    f'fill="{COLOURS[what]}" stroke="#fff" stroke-width="0.6"><title>{escape(tip)}</title></rect>'
                )
                if len(names) > 1 and scale * (end - begin) >= 6 * len(str(len(names))):
                    middle = x(begin) + scale * (end - begin) / 2
                    body.append(f'<text x="{middle:.1f}" y="{y + 8}" class="n">{len(names)}</text>')
            y += LANE
        y += GAP
        body.append(f'<path d="M12 {y - GAP / 2:g}H{LEFT + DRAWN}" stroke="#e5e7eb"/>')
    high = y + 30
    step = next(step for step in (1, 2, 5, 10, 20, 50) if scale * step >= 40)
    axis = []
    for clock in range(0, total + 1):
        if clock % step == 0 or clock == total:
            axis.append(f'<path d="M{x(clock):g} {TOP - 6}V{y}" stroke="#cbd5e1"/>')
        elif scale >= 10:
            axis.append(f'<path d="M{x(clock):g} {TOP - 4}V{y}" stroke="#f1f5f9"/>')
        if clock == total or (clock % step == 0 and scale * (total - clock) > 24):
            axis += [f'<text x="{x(clock):g}" y="{at}" class="t">{clock}</text>' for at in (TOP - 10, y + 14)]
    used = {what for _, own in rows for lane in own for what, *_ in lane}
    legend, at = [], LEFT
    for what in (what for what in COLOURS if what in used):
        legend.append(f'<rect x="{at}" y="28" width="14" height="10" fill="{COLOURS[what]}"/>')
        legend.append(f'<text x="{at + 19}" y="37">{NAMES[what]}</text>')
        at += 44 + 7 * len(NAMES[what])
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + DRAWN + RIGHT} {high}" '
        'font-family="sans-serif" font-size="12" fill="#111">',
        "<style>.n{font-size:9px;fill:#fff;text-anchor:middle;font-weight:bold}.t{fill:#475569;text-anchor:middle}"
        "</style>",
        f'<rect width="{LEFT + DRAWN + RIGHT}" height="{high}" fill="#fff"/>',
        f'<text x="12" y="18" font-size="14">One target in the {datapath} pipeline, W = {width}: {total} clocks from '
        "input to output. A number: operations at the same clocks</text>",
        *legend, *axis, *body, "</svg>",
    ]) + "\n"  # fmt: skip

# SPDX-License-Identifier: Apache-2.0
"""The pipeline schedule as SVG, figure 7 of the paper: when each operation works and how long its word then waits."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from model.dataflow.nodes import Node
from scripts.pages.flow import KINDS, check, delays, kind, longest_path, operands, start, tip

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


ROW = 17
LABEL = 200


def schedule_svg(
    nodes: Mapping[str, Node], title: str, sections: Mapping[str, str], *, wires: bool, out_clock: int | None = None
) -> str:
    """Every node's stage, the delay behind it, and the critical path; ``wires`` draws every operand's way too."""
    check(nodes)
    waits = delays(nodes, out=out_clock)
    on_path = [node.name for node in longest_path(nodes)]
    first = min(n.time if not n.operands else start(n) for n in nodes.values())
    latest = max([n.time for n in nodes.values()] + [max(d.end, d.flag) for d in waits.values()])
    scale = max(4.0, min(20.0, 1100 / (latest - first)))
    total = sum(d.flip_flops for d in waits.values())
    wide, high = LABEL + scale * (latest - first) + 150, 0
    order: list[tuple[str, list[Node]]] = []
    for section in sections:
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
        out.append(f'<text x="12" y="{at + 12}" class="n">{escape(sections[section])}</text>')
        out.append(f'<path d="M12 {at + 17}H{wide - 12:g}" stroke="#9ca3af"/>')
        for clock in ticks if section != heads[0][0] else ():
            if x(clock) > LABEL + 60:  # beside the title
                out.append(f'<text x="{x(clock):g}" y="{at + 13}" text-anchor="middle" class="s">{clock}</text>')
    steps = set(zip(on_path, on_path[1:], strict=False))
    for name, node in nodes.items() if wires else ():
        for o in operands(node, nodes):
            if (o, name) not in steps:
                out.append(_drop(x(start(node)), rows[o] + 8, rows[name] + 8, "w", "a"))
    for name, node in nodes.items():
        at = rows[name]
        wait, begin = waits.get(name), start(node) if node.operands else node.time
        red = name in on_path
        stage = f"{begin}–{node.time}" if node.latency and node.operands else f"{node.time}"
        style = ' style="stroke:#dc2626;stroke-width:2"' if red else ""
        ink = ' style="fill:#dc2626"' if red else ""
        bar = [f"<g><title>{escape(tip(node))}</title>"]
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
            out.append(f'<text x="{legend + 16:g}" y="{at + 8}" class="s">{KINDS[k]}</text>')
            legend += 100
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _drop(x: float, y0: float, y1: float, style: str, marker: str) -> str:
    """From one row down or up to the edge of another."""
    y1 += -8 if y1 > y0 else 8
    return f'<path class="{style}" marker-end="url(#{marker})" d="M{x:g} {y0:g}V{y1:g}"/>'

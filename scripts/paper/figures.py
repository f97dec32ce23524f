# SPDX-License-Identifier: Apache-2.0
"""Figures 6 and 7 of the paper: dataflow graphs and pipeline schedules of both datapaths, as SVG.

docs/generated/figures holds equation (13), as in the paper; graphs and schedules of whole datapaths and their sections
go to build/paper/figures. A balancing delay lasts from the clock in which a node is ready to the last clock in which a
consumer starts.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping

from model.bounds import ranges
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import Node
from scripts.generate.flow import WIDTH, check, cone, delays, design, part
from scripts.generate.render import render
from scripts.paper import graphs
from scripts.paper.schedule_figure import schedule_svg
from tb.sim.env import GENERATED, ROOT

SHOWN = GENERATED / "figures"
ALL = ROOT / "build" / "paper" / "figures"
PAGE = GENERATED / "figures.md"

Designs = Mapping[str, Mapping[str, Node]]
"""Datapath -> its nodes by name."""


def designs() -> Designs:
    """Return the nodes of every datapath."""
    return {name: design(name) for name in DATAPATHS}


def _tooltips(datapath: str) -> dict[str, str]:
    """Return the proved range of each node of the paper's datapath; empty for other datapaths."""
    if datapath != "paper":
        return {}

    def number(v: float) -> str:
        return "0" if abs(v) < 1e-3 else f"{v:.3g}"

    return {n: f"proved [{number(p.low)}, {number(p.high)}]" for n, p in ranges.proved(WIDTH).items()}


def graph(nodes: Mapping[str, Node], datapath: str, title: str) -> str:
    """Return the dataflow graph of some nodes in the DOT language."""
    return graphs.dot(nodes, f"{title}, W = {WIDTH}", DATAPATHS[datapath].sections, _tooltips(datapath))


def schedule(nodes: Mapping[str, Node], datapath: str, title: str, out: int | None = None) -> str:
    """Return the pipeline schedule of some nodes as SVG; wires are drawn for fewer than 40 nodes."""
    title = f"Pipeline schedule of {title}, W = {WIDTH}"
    return schedule_svg(nodes, title, DATAPATHS[datapath].sections, wires=len(nodes) < 40, out_clock=out)


def shown(nodes: Designs) -> dict[str, str]:
    """Return the figures of the page: file name -> graph or SVG."""
    check(nodes["paper"])
    pair = cone(part(nodes["paper"], equation="(13)"), "p_e_x")
    return {
        "graph_p_e_x.svg": graph(pair, "paper", "p_e_x (13), figure 6 of the paper"),
        "schedule_p_e_x.svg": schedule(pair, "paper", "p_e_x (13), figure 7 of the paper"),
    }


def whole(nodes: Designs) -> dict[str, str]:
    """Return the figures of each datapath and section: file name -> graph or SVG. ValueError for an invalid node."""
    found = {}
    for path, own in nodes.items():
        check(own)
        found[f"graph_{path}.svg"] = graph(own, path, f"The {path} datapath")
        for name, title in DATAPATHS[path].sections.items():
            if nodes_of := part(own, section=name):
                found[f"graph_{path}_{name}.svg"] = graph(nodes_of, path, f"The {path} datapath: {title}")
        latest = max(node.time for node in own.values())
        found[f"schedule_{path}.svg"] = schedule(own, path, f"the {path} datapath", latest)
    return found


def page(nodes: Designs) -> str:
    """Return docs/generated/figures.md."""
    datapaths = []
    for path, own in nodes.items():
        latest = max(node.time for node in own.values())
        waits = delays(own, out=latest)
        largest = sorted(waits.items(), key=lambda item: (-item[1].flip_flops, item[0]))[:5]
        datapaths.append(
            {
                "name": path,
                "nodes": len(own),
                "clocks": latest,
                "waits": len(waits),
                "bits": sum(d.flip_flops for d in waits.values()),
                "largest": ", ".join(f"`{n}` ({d.clocks} × {d.bits})" for n, d in largest),
            }
        )
    return render("figures", datapaths=datapaths)


def write() -> int:
    """Draw all figures and write the page; return 1 if a node does not fit its format."""
    if wrong := ranges.failures(WIDTH):
        print(*wrong.values(), sep="\n", file=sys.stderr)
        return 1
    nodes = designs()
    for folder, figures in {SHOWN: shown(nodes), ALL: whole(nodes)}.items():
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in figures.items():
            (folder / name).write_text(graphs.svg(text) if text.startswith("digraph") else text, encoding="utf-8")
    PAGE.write_text(page(nodes), encoding="utf-8")
    print(f"wrote {PAGE.name}; figures of the whole datapaths are in {ALL.relative_to(ROOT)}")
    return 0

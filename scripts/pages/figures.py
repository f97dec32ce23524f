# SPDX-License-Identifier: Apache-2.0
"""Figures 6 and 7 of the paper for both datapaths: dataflow graphs and pipeline schedules, as SVG.

    python -m scripts.pages.figures                            writes figures/ and figures.md
    python -m scripts.pages.figures --node c3 --out build/c3   the graph and the schedule of what leads to any node

A balancing delay lasts from the clock in which a node is ready to the last clock in which a consumer starts.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from model.bounds import ranges
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import Node
from scripts.console import InputError, Parser, command, folder_name, output, writing
from scripts.pages.flow import WIDTH, check, cone, delays, design, longest_path, part
from scripts.pages.graphs import dot, svg
from scripts.pages.render import render
from scripts.pages.schedule import schedule_svg
from tb.sim.env import GENERATED, ROOT

FOLDER = GENERATED / "figures"
PAGE = GENERATED / "figures.md"

Design = Mapping[str, Mapping[str, Node]]
"""Datapath -> its nodes by name."""


def designs() -> Design:
    """Both datapaths."""
    return {name: design(name) for name in DATAPATHS}


def proved(datapath: str) -> dict[str, str]:
    """Node -> its proved range, for the tooltip; of the paper's datapath."""
    if datapath != "paper":
        return {}
    return {n: f"proved [{_number(p.low)}, {_number(p.high)}]" for n, p in ranges.proved(WIDTH).items()}


def _number(v: float) -> str:
    return "0" if abs(v) < 1e-3 else f"{v:.3g}"


@dataclass(frozen=True)
class Figure:
    """A graph that graphviz draws, or a picture that is drawn here, with the name of its file."""

    name: str
    text: str

    @property
    def path(self) -> Path:
        """In the checkout."""
        return FOLDER / f"{self.name}.svg"

    @property
    def svg(self) -> str:
        """The picture.  Raises InputError where a graph needs graphviz and it is not there."""
        return svg(self.text) if self.text.startswith("digraph") else self.text


def graph(nodes: Mapping[str, Node], datapath: str, name: str, title: str) -> Figure:
    """The dataflow graph of some nodes of a datapath."""
    sections = DATAPATHS[datapath].sections
    return Figure(f"graph_{name}", dot(nodes, f"{title}, W = {WIDTH}", sections, proved(datapath)))


def schedule(nodes: Mapping[str, Node], datapath: str, name: str, title: str, out: int | None = None) -> Figure:
    """The pipeline schedule of some nodes; with all their wires if they are few."""
    sections, title = DATAPATHS[datapath].sections, f"Pipeline schedule of {title}, W = {WIDTH}"
    return Figure(f"schedule_{name}", schedule_svg(nodes, title, sections, wires=len(nodes) < 40, out_clock=out))


def figures(nodes: Design) -> list[Figure]:
    """All figures.  ValueError, which names the node, for a design that makes no sense."""
    for own in nodes.values():
        check(own)
    pair = cone(part(nodes["paper"], equation="(13)"), "p_e_x")
    found = [
        graph(pair, "paper", "p_e_x", "p_e_x (13), figure 6 of the paper"),
        schedule(pair, "paper", "p_e_x", "p_e_x (13), figure 7 of the paper"),
    ]
    for path, own in nodes.items():
        found += [graph(own, path, path, f"The {path} datapath")]
        found += [
            graph(part(own, section=name), path, f"{path}_{name}", f"The {path} datapath: {title}")
            for name, title in _sections(path, own)
        ]
        latest = max(node.time for node in own.values())
        found.append(schedule(own, path, path, f"the {path} datapath", out=latest))
    return found


def _sections(datapath: str, nodes: Mapping[str, Node]) -> list[tuple[str, str]]:
    """Those with nodes enough for a graph of their own."""
    named = DATAPATHS[datapath].sections.items()
    return [(name, title) for name, title in named if sum(node.section == name for node in nodes.values()) > 1]


def page(nodes: Design) -> str:
    """figures.md."""
    datapaths = []
    for path, own in nodes.items():
        latest = max(node.time for node in own.values())
        waits = delays(own, out=latest)
        largest = sorted(waits.items(), key=lambda item: (-item[1].flip_flops, item[0]))[:5]
        sections = [
            {"name": name, "title": title, "nodes": sum(node.section == name for node in own.values())}
            for name, title in _sections(path, own)
        ]
        datapaths.append({
            "name": path, "nodes": len(own), "sections": sections, "clocks": latest, "waits": len(waits),
            "bits": sum(d.flip_flops for d in waits.values()),
            "largest": ", ".join(f"`{n}` ({d.clocks} × {d.bits})" for n, d in largest),
            "longest": " → ".join(f"`{node.name}`" for node in longest_path(own)),
        })  # fmt: skip
    return render("figures", datapaths=datapaths)


@command("figures")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("pages.figures", __doc__.splitlines()[0], fails="a node does not fit its format")
    parser.choice("--datapath", "datapath", tuple(DATAPATHS), "paper", "of --node (default: %(default)s)")
    parser.add_argument("--node", help="only the graph and the schedule of what leads to this node")
    about = "folder for the figures of --node"
    parser.add_argument("--out", type=folder_name, default=ROOT / "build" / "figures", help=about)
    options = parser.parse_args(arguments)
    try:
        nodes = designs()
        if options.node:
            own = cone(nodes[options.datapath], options.node)
            make = own, options.datapath, options.node
            both = graph(*make, options.node), schedule(*make, options.node)
            files = {options.out / f"{figure.name}.svg": figure for figure in both}
        else:
            files = {figure.path: figure for figure in figures(nodes)}
    except (ValueError, KeyError) as error:
        raise InputError(error.args[0]) from None
    for line in ranges.failures(WIDTH).values():
        print(line, file=sys.stderr)
    texts = {path: figure.svg for path, figure in files.items()} | ({} if options.node else {PAGE: page(nodes)})
    with output(options.out if options.node else FOLDER, list(texts)), writing():
        for path, text in texts.items():
            path.write_text(text, encoding="utf-8")
    print(f"wrote {len(texts)} files, {sum(len(t.encode()) for t in texts.values()) / 1000:.0f} kB")
    return 1 if ranges.failures(WIDTH) else 0


if __name__ == "__main__":
    sys.exit(main())

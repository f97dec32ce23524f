# SPDX-License-Identifier: Apache-2.0
"""Figures 6 and 7 of the paper: dataflow graph and pipeline schedule of p_e_x (13), as SVG.

A balancing delay lasts from the clock in which a node is ready to the last clock in which a consumer starts. graphviz
draws the graph; the picture carries the digest of its graph, so a test can check without graphviz that it is current.
"""

import hashlib
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping

from model.bounds import ranges
from model.dataflow import fixed
from model.dataflow.nodes import Node
from model.dataflow.paper import SECTIONS
from scripts.console import InputError
from scripts.generate import flow
from scripts.generate.flow import WIDTH, delays, kind, longest_path, operands, start
from scripts.generate.render import render
from tb.sim.env import GENERATED

SHOWN = GENERATED / "figures"
PAGE = GENERATED / "figures.md"

Nodes = Mapping[str, Node]

KINDS = {
    "input": ("", "#ffffff", "#333333"),
    "mul": ("×", "#dbeafe", "#1d4ed8"),
    "add": ("+", "#dcfce7", "#15803d"),
    "div": ("÷", "#fde2c8", "#c2410c"),
    "root": ("√", "#fbd5e5", "#be185d"),
    "sincos": ("sin cos", "#ede4fd", "#6d28d9"),
    "scale": ("shift", "#e0f2f1", "#0f766e"),
    "choose": ("?", "#f1f1f1", "#666666"),
}
"""Kind of operation -> its symbol in a graph, its fill and line in a schedule."""


def _critical(nodes: Nodes) -> tuple[list[str], set[tuple[str, str]]]:
    """Return the names on the longest path and its steps."""
    path = [node.name for node in longest_path(nodes)]
    return path, set(zip(path, path[1:], strict=False))


def _arrows(nodes: Nodes) -> list[tuple[str, str]]:
    """Return the pairs of operand and node."""
    return [(o, name) for name, node in nodes.items() for o in operands(node)]


def graph(nodes: Nodes) -> str:
    """Return the dataflow graph of nodes in the DOT language, coloured by section, with the longest path in red.

    A node without operands that is not an input belongs to another section and is dashed.
    """
    path, steps = _critical(nodes)
    drawn = {"nodes": nodes, "arrows": _arrows(nodes), "path": path, "steps": steps, "proved": ranges.proved(WIDTH)}
    title = f"p_e_x (13), figure 6 of the paper, W = {WIDTH}"
    return render("graph.dot", title=title, sections=SECTIONS, kinds=KINDS, flow=flow, **drawn)


def digest(text: str) -> str:
    """Return the graph digest that is embedded in the picture."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def svg(text: str) -> str:
    """Draw a graph with graphviz' ``dot``. Raises InputError if it is not installed."""
    if shutil.which("dot") is None:
        raise InputError("graphviz' dot is missing: `make paper ONLY=figures` installs it (Debian's package graphviz)")
    drawn = subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True, text=True, check=True).stdout
    drawn = re.sub(r"<!--.*?-->\n?", "", drawn[drawn.index("<svg") :], flags=re.S)
    return f"<!-- of the graph {digest(text)} -->\n{drawn}"


def schedule(nodes: Nodes) -> str:
    """Return the pipeline schedule of nodes as SVG: stages, delays, critical path and wires."""
    path, steps = _critical(nodes)
    in_order = sorted(nodes.values(), key=lambda node: (start(node), node.time))
    sections = [(title, [node for node in in_order if node.section == name]) for name, title in SECTIONS.items()]
    return render(
        "schedule.svg",
        title=f"Pipeline schedule of p_e_x (13), figure 7 of the paper, W = {WIDTH}",
        nodes=nodes,
        sections=sections,
        waits=delays(nodes),
        path=path,
        wires=[arrow for arrow in _arrows(nodes) if arrow not in steps],
        steps=sorted(steps, key=lambda step: nodes[step[1]].time),
        first=min(start(node) if node.operands else node.time for node in nodes.values()),
        kinds=KINDS,
        used={kind(node) for node in nodes.values()},
        flow=flow,
    )


def figures() -> dict[str, str]:
    """Return the figures of the page: file name -> graph or SVG."""
    elbow = flow.cone(fixed.nodes("paper", WIDTH), "p_e_x")
    return {"graph_p_e_x.svg": graph(elbow), "schedule_p_e_x.svg": schedule(elbow)}


def write() -> int:
    """Draw the figures and write the page; return 1 if a node does not fit its format."""
    if wrong := ranges.analyse(WIDTH)[1]:
        print(*wrong.values(), sep="\n", file=sys.stderr)
        return 1
    for name, text in figures().items():
        (SHOWN / name).write_text(svg(text) if text.startswith("digraph") else text, encoding="utf-8")
    PAGE.write_text(render("figures"), encoding="utf-8")
    print(f"wrote {PAGE.name}")
    return 0

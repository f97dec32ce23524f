# SPDX-License-Identifier: Apache-2.0
"""Figures 6 and 7 of the paper: dataflow graph and pipeline schedule of p_e_x (13), as SVG.

A balancing delay lasts from the clock in which a node is ready to the last clock in which a consumer starts. graphviz
draws the graph. The picture holds a digest of the graph, so a test without graphviz detects an outdated picture.
"""

import hashlib
import re
import shutil
import subprocess
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

from model.bounds import ranges
from model.dataflow import fixed
from model.dataflow.annotations import RangeError
from model.dataflow.nodes import Node
from model.dataflow.paper import SECTIONS
from scripts.console import InputError
from scripts.generate import flow
from scripts.generate.flow import WIDTH, delays, kind, longest_path, operands, start
from scripts.generate.render import render
from tb.sim.env import GENERATED

SHOWN = GENERATED / "figures"
PAGE = GENERATED / "figures.md"


def drawn(nodes: Mapping[str, Node]) -> dict[str, Any]:
    """Return the values that both templates need: nodes, arrows (operand, node), longest path and its arrows."""
    arrows = [(o, name) for name, node in nodes.items() for o in operands(node)]
    path = [node.name for node in longest_path(nodes)]
    return {
        "nodes": nodes,
        "arrows": arrows,
        "path": path,
        "steps": [*pairwise(path)],
        "kinds": flow.KINDS,
        "flow": flow,
    }


def digest(text: str) -> str:
    """Return the digest of a graph, which its picture holds."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def svg(text: str) -> str:
    """Return the picture of a graph, drawn by graphviz' ``dot``. Raises InputError if dot is not installed."""
    if shutil.which("dot") is None:
        raise InputError("graphviz' dot is missing: `make paper ONLY=figures` installs it (Debian's package graphviz)")
    drawn = subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True, text=True, check=True).stdout
    drawn = re.sub(r"<!--.*?-->\n?", "", drawn[drawn.index("<svg") :], flags=re.S)
    return f"<!-- of the graph {digest(text)} -->\n{drawn}"


def schedule(nodes: Mapping[str, Node]) -> str:
    """Return the pipeline schedule of nodes as SVG: stages, delays, critical path and wires."""
    in_order = sorted(nodes.values(), key=lambda node: (start(node), node.time))
    waits = delays(nodes)
    return render(
        "schedule.svg",
        title=f"Pipeline schedule of p_e_x (13), figure 7 of the paper, W = {WIDTH}",
        sections=[(title, [node for node in in_order if node.section == name]) for name, title in SECTIONS.items()],
        waits=waits,
        flip_flops=sum(wait.clocks * wait.bits for wait in waits.values()),
        first=min(start(node) if node.operands else node.time for node in nodes.values()),
        used={kind(node) for node in nodes.values()},
        **drawn(nodes),
    )


def figures() -> dict[str, str]:
    """Return a dict: file name of a picture -> SVG, or the DOT text from which it is drawn."""
    elbow = flow.cone(fixed.nodes("paper", WIDTH), "p_e_x")
    title = f"p_e_x (13), figure 6 of the paper, W = {WIDTH}"
    graph = render("graph.dot", title=title, sections=SECTIONS, proved=ranges.analyse(WIDTH)[0], **drawn(elbow))
    return {"graph_p_e_x.svg": graph, "schedule_p_e_x.svg": schedule(elbow)}


def texts() -> dict[Path, str]:
    """Return a dict: path -> figure or page. Raises RangeError if a node does not fit its format."""
    if wrong := ranges.analyse(WIDTH)[1]:
        raise RangeError("\n".join(wrong.values()))
    drawn = {SHOWN / name: svg(text) if text.startswith("digraph") else text for name, text in figures().items()}
    return {**drawn, PAGE: render("figures")}

# SPDX-License-Identifier: Apache-2.0
"""Dataflow graphs, figure 6 of the paper, drawn by graphviz.

Each picture carries the digest of its graph, so a test can check without `dot` that it is current.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
from collections.abc import Mapping
from html import escape

from model.dataflow.nodes import Node
from scripts.console import InputError
from scripts.generate.flow import check, kind, longest_path, operands, q, tip

SIGNS = {
    "input": "",
    "mul": "×",
    "add": "+",
    "div": "÷",
    "root": "√",
    "sincos": "sin cos",
    "scale": "shift",
    "choose": "?",
}
"""Symbol drawn for each kind of operation."""

COLOURS = ("#dbeafe", "#dcfce7", "#fde2c8", "#ede4fd", "#fbd5e5", "#fef3c7", "#e2e8f0")
"""Colours of the sections, in order."""

CRITICAL = "#dc2626"

HEAD = """digraph {{
  graph [rankdir=LR, nodesep=0.09, ranksep=0.45, fontname="Helvetica", fontsize=16, labelloc=t, labeljust=l,
         label=<<table border="0" cellspacing="6"><tr><td>{title}</td>{sections}</tr></table>>];
  node [shape=box, style="filled,rounded", color="#475569", fontname="Helvetica", fontsize=12, height=0.3,
        margin="0.07,0.03"];
  edge [color="#8a94a3", arrowsize=0.5];
"""


def dot(nodes: Mapping[str, Node], title: str, sections: Mapping[str, str], tips: Mapping[str, str]) -> str:
    """Return the graph of ``nodes`` in the DOT language, coloured by section, with the longest path in red.

    sections: name -> title. tips: node -> text added to its tooltip. A node without operands that is not an input
    belongs to another section and is dashed.
    """
    check(nodes)
    colours = dict(zip(sections, COLOURS, strict=False))
    used = [s for s in sections if any(node.section == s and node.operands for node in nodes.values())]
    cells = "".join(f'<td bgcolor="{colours[s]}">{escape(sections[s])}</td>' for s in used)
    lines = [HEAD.format(title=escape(title), sections=cells)]
    path = [node.name for node in longest_path(nodes)]
    steps = set(zip(path, path[1:], strict=False))
    for name, node in nodes.items():
        outside = not node.operands and node.op != "input"
        label = f"<b>{name}</b>" + (f"&#160;{escape(node.equation)}" if node.equation else "")
        what = " ".join(part for part in (SIGNS[kind(node)] if node.operands else "", q(node.format)) if part)
        looks = f'fillcolor="{"#ffffff" if outside or node.op == "input" else colours[node.section]}"'
        looks += ', style="filled,rounded,dashed"' if outside else ""
        looks += f', color="{CRITICAL}", penwidth=2' if name in path else ""
        more = f"; {tips[name]}" if name in tips else ""
        box = f'label=<{label}<br/><font point-size="10">{what}</font>>, tooltip="{tip(node)}{more}"'
        lines.append(f'  "{name}" [{box}, {looks}];')
    for name, node in nodes.items():
        for o in operands(node, nodes):
            red = f', color="{CRITICAL}", penwidth=2' if (o, name) in steps else ""
            lines.append(f'  "{o}" -> "{name}" [tooltip="{o} to {name}"{red}];')
    return "\n".join([*lines, "}"]) + "\n"


def digest(graph: str) -> str:
    """Return the graph digest that is embedded in the picture."""
    return hashlib.sha256(graph.encode()).hexdigest()[:16]


def svg(graph: str) -> str:
    """Draw a graph with graphviz' ``dot``. Raises InputError if it is not installed."""
    if shutil.which("dot") is None:
        raise InputError("graphviz' dot is missing: `make paper ONLY=figures` installs it (Debian's package graphviz)")
    done = subprocess.run(["dot", "-Tsvg"], input=graph, capture_output=True, text=True, check=True)
    drawn = done.stdout[done.stdout.index("<svg") :]
    drawn = re.sub(r"<!--.*?-->\n?", "", drawn, flags=re.S)
    return f"<!-- of the graph {digest(graph)} -->\n{drawn}"

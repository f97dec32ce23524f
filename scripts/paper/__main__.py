# SPDX-License-Identifier: Apache-2.0
"""Reproduce the paper: derivation, table 4, figures 6 and 7, table 6: `make paper`.

All parts except table6 write only pages that have changed. A failed check stops the command. `make fpga` makes table 5.

Figures 6 and 7 are the dataflow graph and the pipeline schedule of p_e_x (13), as SVG. A balancing delay lasts from the
clock in which a node is ready to the last clock in which a consumer starts. Graphviz draws the graph. The picture
contains a digest of the graph's text, so a test detects an outdated picture without graphviz.
"""

import re
import shutil
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import click

from model.bounds import ranges
from model.bounds.ranges import RangeError
from model.dataflow import fixed
from model.dataflow.lean import SECTIONS as LEAN_SECTIONS
from model.dataflow.nodes import Node
from model.dataflow.paper import SECTIONS
from scripts.console import InputError, Options, command, option
from scripts.generate import flow
from scripts.generate.flow import WIDTH, added, delays, kind, longest_path, operands, operation, start
from scripts.generate.render import render, update
from scripts.paper.derivation import lean, paper
from scripts.paper.derivation.proofs import ProofError, Step, aligned, derive, failures, tex
from scripts.paper.table6 import __main__ as table6
from tb.formal.task import digest_of
from tb.sim.env import GENERATED

STEPS = {"derivation": paper.STEPS, "lean": lean.STEPS}  # page of the derivation -> its steps

SHOWN = GENERATED / "figures"


def derivation_page(name: str, steps: Mapping[str, Step]) -> str:
    pairs = {branch: rf"\left({tex(c)},\ {tex(s)}\right)" for branch, (c, s) in lean.HALF.items()}
    halves = {rf"h(c, s) \text{{ for }} {branch}": pair for branch, pair in pairs.items()}
    proofs = {step: done.block() for step, done in steps.items()}
    shown = [(n.section, f"{n.name} = {n.right_side}") for n in lean.NODES.values() if n.kind != "input"]
    sections = {title: [text for where, text in shown if where == part] for part, title in LEAN_SECTIONS.items()}
    return render(name, proofs=proofs, sections=sections, halves=aligned(halves))


def derivation() -> dict[Path, str]:
    """Run all derivations; return a dict: page -> text. Raises ProofError if a statement does not hold."""
    steps = {name: derive(functions) for name, functions in STEPS.items()}
    if wrong := [line for proved in steps.values() for line in failures(proved)]:
        raise ProofError("\n".join(wrong))
    return {GENERATED / f"{name}.md": derivation_page(name, proved) for name, proved in steps.items()}


def by_section(datapath: str) -> dict[str, Counter]:
    """Return a dict: section of a datapath -> numbers of operations by kind; each is an instance or an operator in the
    RTL.

    Each + or - of a rounded or exact sum counts as an addition. Additions inside another unit, such as the rounding of
    a product, do not count. Sine and cosine of an angle come from one unit and count as two operations."""
    counts: dict[str, Counter] = defaultdict(Counter)
    angles = set()
    for node in fixed.nodes(datapath, WIDTH).values():
        mine, unit = counts[node.section], operation(node)
        if node.latency in ("sum2", "sum3"):
            mine["add"] += max(int(node.latency[-1]), len(node.operands)) - 1
        elif node.latency and unit in ("choose", "add"):
            mine["add"] += added(node)
        elif unit == "sincos":
            mine["trig"] += 2 * ((angle := tuple(operands(node))) not in angles)
            angles.add(angle)
        elif unit in ("mul", "div", "root"):
            mine[unit] += 1
    return counts


def operations() -> dict[Path, str]:
    """Return a dict: page of table 4 -> its text, with the operations counted in the dataflows."""
    by_name = by_section("paper")
    counts = {"guard": by_name["guard"], "everything": sum(by_name.values(), Counter())}
    counts |= {"rtl": counts["everything"] - counts["guard"], "lean": sum(by_section("lean").values(), Counter())}
    sections = {SECTIONS[name]: ops for name, ops in by_name.items()}
    return {GENERATED / "operations.md": render("operations", sections=sections, width=WIDTH, **counts)}


def drawn(nodes: Mapping[str, Node]) -> dict[str, Any]:
    """Return the values for both figures' templates: nodes, arrows (operand, node), longest path and its arrows."""
    arrows = [(o, name) for name, node in nodes.items() for o in operands(node)]
    path = [node.name for node in longest_path(nodes)]
    steps = [*pairwise(path)]
    return {"nodes": nodes, "arrows": arrows, "path": path, "steps": steps, "kinds": flow.KINDS, "flow": flow}


def svg(text: str) -> str:
    """Draw a graph's text with graphviz' ``dot``; return the picture. Raises InputError if dot is not installed."""
    if shutil.which("dot") is None:
        raise InputError("graphviz' dot is missing: `make paper ONLY=figures` installs it (Debian's package graphviz)")
    drawn = subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True, text=True, check=True).stdout
    drawn = re.sub(r"<!--.*?-->\n?", "", drawn[drawn.index("<svg") :], flags=re.S)
    return f"<!-- of the graph {digest_of(text)} -->\n{drawn}"


def schedule(nodes: Mapping[str, Node]) -> str:
    """Return the nodes' pipeline schedule as SVG: stages, delays, critical path and wires."""
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


def pictures() -> dict[str, str]:
    """Return a dict: file name of a picture -> its SVG, or the DOT text from which it is drawn."""
    elbow = flow.cone(fixed.nodes("paper", WIDTH), "p_e_x")
    title = f"p_e_x (13), figure 6 of the paper, W = {WIDTH}"
    graph = render("graph.dot", title=title, sections=SECTIONS, proved=ranges.analyse(WIDTH)[0], **drawn(elbow))
    return {"graph_p_e_x.svg": graph, "schedule_p_e_x.svg": schedule(elbow)}


def figures() -> dict[Path, str]:
    """Return a dict: path -> text of a figure or page. Raises RangeError if a node does not fit its format."""
    if wrong := ranges.analyse(WIDTH)[1]:
        raise RangeError("\n".join(wrong.values()))
    drawn = {SHOWN / name: svg(text) if text.startswith("digraph") else text for name, text in pictures().items()}
    return {**drawn, GENERATED / "figures.md": render("figures")}


PARTS = {"derivation": derivation, "operations": operations, "figures": figures}
"""Part -> function that returns a dict: path -> text. The part table6 has a command of its own."""


@command("paper", [option("--only", "one part  [default: all]", click.Choice([*PARTS, "table6"]))])
def main(options: Options) -> int:
    parts = [options.only] if options.only else [*PARTS, "table6"]
    try:
        for part in filter(PARTS.get, parts):
            update(PARTS[part]())
    except (RangeError, ProofError) as error:
        print(error, file=sys.stderr)
        return 1
    return table6.main([]) if "table6" in parts else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Table 4 of the paper: operations of the datapaths, counted in their dataflows for operations.md."""

from collections import Counter, defaultdict
from pathlib import Path

from model.dataflow import fixed
from model.dataflow.paper import SECTIONS
from scripts.generate.flow import WIDTH, added, operands, operation
from scripts.generate.render import render
from tb.sim.env import GENERATED


def by_section(datapath: str) -> dict[str, Counter]:
    """Return the operations of each section of a datapath. The RTL has an instance or an operator for each operation.

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


def texts() -> dict[Path, str]:
    paper = by_section("paper")
    counts = {"guard": paper["guard"], "everything": sum(paper.values(), Counter())}
    counts |= {"rtl": counts["everything"] - counts["guard"], "lean": sum(by_section("lean").values(), Counter())}
    sections = {SECTIONS[name]: ops for name, ops in paper.items()}
    return {GENERATED / "operations.md": render("operations", sections=sections, width=WIDTH, **counts)}

# SPDX-License-Identifier: Apache-2.0
"""Writes the generated pages of docs/: scores of all trajectories, where every clock goes, the pipeline as a picture.

    python -m scripts.pages.gen_docs [--sim icarus|verilator]     runs all trajectories through the RTL, then writes
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from html import escape
from pathlib import Path

import numpy as np

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import Latency, Node
from model.targets import trajectories
from scripts import run
from tb.sim.env import ROOT, SIMULATORS

DOCS = ROOT / "docs"
SCORES = DOCS / "scores.md"


# -- scores ----------------------------------------------------------------------------------------------------------


COLUMNS = ("trajectory", "hand max", "hand rms", "bar", "predicted", "angle", "elbow", "norm")
COLUMNS += ("flagged", "clamped", "singular")


def scores_page(scores: dict[str, list[dict]]) -> str:
    """docs/scores.md from datapath -> the objects of its score.json (of one simulator: the page does not name it)."""
    rows = [
        "# Scores of the built-in trajectories",
        "",
        "Written by `python -m scripts.pages.gen_docs` from an RTL run; `make test` fails when it is out of date.",
        "",
        "- *hand*: distance of the forward-kinematics wrist from the target / (d1 + d2), over the targets in reach;",
        f"- *bar*: what it must not exceed. {tolerances.LEAN[32]:.0e} for the lean datapath; for the paper's "
        f"{tolerances.REGULAR:.0e} where",
        "  every pose keeps 0.2 rad away from the singular poses of the equations, otherwise the largest prediction;",
        "- *predicted*: what the roundings can do at these poses, from word lengths and conditioning alone;",
        "- *angle*: largest angle of the shoulder or elbow rotation from double precision, rad;",
        "- *elbow*: largest distance of the elbow from double precision / (d1 + d2);",
        "- *norm*: largest abs(norm^2 - 1) of both quaternions;",
        "- *clamped*: the hand of unreachable targets, against the nearest point in reach;",
        "- *singular*: the least distance of a pose from a singular one, rad.",
    ]
    for datapath, of_it in scores.items():
        first = of_it[0]
        rows += [
            "",
            f"## The {datapath} datapath",
            "",
            f"{first['width']} bits, latency {first['latency_cycles']} clocks, {first['total_cycles']} clocks for 100 "
            f"targets, {first['results_per_cycle']:g} result a clock;",
            f"{sum(s['bit_mismatches'] for s in of_it)} bits of all nodes differ from the bit-true model.",
            "",
            f"| {' | '.join(COLUMNS)} |",
            f"|{' --- |' * len(COLUMNS)}",
            *map(_score_row, of_it),
        ]
    names = next(iter(scores.values()))
    rows += ["", "## What they are", ""]
    rows += [f"- `{s['trajectory']}`: {trajectories.describe(s['trajectory'])}" for s in names]
    return "\n".join(rows) + "\n"


def _score_row(s: dict) -> str:
    figures = [
        *(s[k] for k in ("hand_error_max", "hand_error_rms", "hand_error_bar", "hand_error_predicted")),
        *(s[k] for k in ("angle_error_max", "elbow_point_error_max", "norm_error_max")),
    ]
    cells = [s["trajectory"], *(f"{f:.1e}" for f in figures), str(s["flagged"])]
    cells += ["-" if s["clamped_error_max"] is None else f"{s['clamped_error_max']:.1e}"]
    cells += [f"{s['singular_distance_min']:.3f}"]
    return f"| {' | '.join(cells)} |"


# -- where every clock goes ------------------------------------------------------------------------------------------


def nodes_of(datapath: str, width: int) -> dict[str, Node]:
    """The nodes of a dataflow: formats and clocks do not depend on the target."""
    return fixed.run(np.zeros((1, 6), dtype=np.int64), width, datapath).bits.nodes


def longest_path(nodes: dict[str, Node]) -> list[Node]:
    """From an input to the last result: of the operands that an operation waits for, the one that comes last."""
    node = max(nodes.values(), key=lambda n: n.time)
    path = [node]
    while path[-1].op != "input":
        waits_for = [*path[-1].operands, *([path[-1].after] if path[-1].after else [])]
        path.append(max((n for n in waits_for if n.name), key=lambda n: n.time))
    return path[::-1]


def latency_page() -> str:
    """docs/latency.md."""
    rows = [
        "# Where every clock goes",
        "",
        "Written by `python -m scripts.pages.gen_docs` from the dataflow; `make test` fails when it is out of date.",
        "The longest path of each datapath, operation by operation, from the clock in which a target is admitted to",
        "the one in which its result stands at the output of `ik_axis`. What else happens runs beside it:",
        "",
        "![the lean pipeline over time](pipeline-lean.svg)",
        "",
        "![the paper's pipeline over time](pipeline-paper.svg)",
    ]
    for datapath, width in (("lean", 32), ("lean", 18), ("paper", 32)):
        nodes = nodes_of(datapath, width)
        path = [node for node in longest_path(nodes) if node.latency]
        rows += [
            "",
            f"## {datapath}, W = {width}: {path[-1].time + FIFO_CLOCKS} clocks",
            "",
            "| from | to | clocks | node | equation | what they do |",
            "| --- | --- | --- | --- | --- | --- |",
        ]
        for node in path:
            why = Latency.TABLE[node.latency][2]
            begin = _start(node)
            cells = [begin, node.time, node.time - begin, f"`{node.name}`", node.equation or "-", why]
            rows.append(f"| {' | '.join(map(str, cells))} |")
        end = path[-1].time
        rows.append(f"| {end} | {end + FIFO_CLOCKS} | {FIFO_CLOCKS} | output FIFO | - | memory, output register |")
    return "\n".join(rows) + "\n"


# -- the pipeline as a picture ---------------------------------------------------------------------------------------

SCALE = 2.6  # pixels a clock
LEAST = 340  # pixels for the legend
FIFO_CLOCKS = 2
LEFT, TOP, ROW = 216, 46, 34
SHOWN = {"root": "#c2410c", "div": "#1d4ed8", "sincos": "#15803d", "rsqrt": "#c2410c", "trig": "#15803d"}
WORDS = {
    "root": "square root", "div": "division", "sincos": "sine and cosine",
    "rsqrt": "reciprocal square root", "trig": "sine and cosine",
}  # fmt: skip


def pipeline_svg(datapath: str, width: int = 32) -> str:
    """docs/pipeline-<datapath>.svg: when each section works, its roots and divisions, in clocks since the target came
    in; both datapaths at one scale."""
    nodes = nodes_of(datapath, width)
    latest = max(node.time for node in nodes.values())
    titles = DATAPATHS[datapath].sections
    sections = [name for name in titles if name != "results"]
    wide, high = LEFT + max(SCALE * latest + 24, LEAST), TOP + ROW * len(sections) + 62
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:.0f} {high}" font-family="sans-serif" '
        f'font-size="12" fill="#111">',
        f'<rect width="{wide:.0f}" height="{high}" fill="#fff"/>',
        f'<text x="12" y="22" font-size="14">One target in the {datapath} pipeline, W = {width}: clocks since it came '
        "in</text>",
    ]
    bottom = TOP + ROW * len(sections)
    for clock in [*(c for c in range(0, latest, 50) if latest - c > 10), latest]:
        x = LEFT + SCALE * clock
        out.append(f'<line x1="{x:.1f}" y1="{TOP - 8}" x2="{x:.1f}" y2="{bottom}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle" fill="#555">{clock}</text>')
    for k, name in enumerate(sections):
        y = TOP + ROW * k
        own = [node for node in nodes.values() if node.section == name and node.op != "input"]
        begin = min(_start(node) for node in own)
        out.append(f'<text x="12" y="{y + 17}">{escape(titles[name])}</text>')
        end = max(node.time for node in own)
        out.append(_bar(y + 7, begin, end, "#e5e7eb", 12, f"{name}: clocks {begin} to {end}"))
        for node in own:
            if node.latency in SHOWN:
                tip = f"{node.name} {node.equation}: {WORDS[node.latency]}, clocks {_start(node)} to {node.time}"
                # Sine and cosine run beside the first root: the lower half is theirs.
                place, height = (17, 7) if node.latency in ("sincos", "trig") else (4, 12)
                out.append(_bar(y + place, _start(node), node.time, SHOWN[node.latency], height, tip))
    x = LEFT
    used = {node.latency for node in nodes.values()}
    for kind, colour in SHOWN.items():
        if kind in used:
            out.append(f'<rect x="{x}" y="{bottom + 30}" width="14" height="12" fill="{colour}"/>')
            out.append(f'<text x="{x + 20}" y="{bottom + 40}">{WORDS[kind]}</text>')
            x += 40 + 7 * len(WORDS[kind])
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _start(node: Node) -> int:
    waits_for = [*node.operands, *([node.after] if node.after else [])]
    return max((o.time for o in waits_for), default=0)


def _bar(y: int, begin: int, end: int, colour: str, height: int, tip: str) -> str:
    x, w = LEFT + SCALE * begin, SCALE * (end - begin)
    return (
        f'<rect x="{x:.1f}" y="{y}" width="{w:.1f}" height="{height}" fill="{colour}" stroke="#fff" stroke-width="0.6">'
        f"<title>{escape(tip)}</title></rect>"
    )


def pages() -> dict[Path, str]:
    """What needs no run: file -> text."""
    pictures = {DOCS / f"pipeline-{name}.svg": pipeline_svg(name) for name in DATAPATHS}
    return {DOCS / "latency.md": latency_page(), **pictures}


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.pages.gen_docs", description=__doc__.splitlines()[0])
    parser.add_argument("--sim", choices=SIMULATORS, default=SIMULATORS[0])
    sim = parser.parse_args().sim
    scores = {}
    for datapath in DATAPATHS:
        with tempfile.TemporaryDirectory() as out:
            status = run.main(["--trajectory", "all", "--datapath", datapath, "--out", out, "--sim", sim])
            if status:
                return status
            scores[datapath] = json.loads((Path(out) / "score.json").read_text())
    SCORES.write_text(scores_page(scores))
    for path, text in pages().items():
        path.write_text(text)
    print(f"wrote {', '.join(str(p.relative_to(ROOT)) for p in (SCORES, *pages()))}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

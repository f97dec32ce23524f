# SPDX-License-Identifier: Apache-2.0
"""Writes the generated pages of docs/: the scores of all trajectories, and the pipeline as a picture.

    python -m scripts.gen_docs [--sim icarus|verilator]     runs all trajectories through the RTL, then writes
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from html import escape
from pathlib import Path

import numpy as np

from model import fixed, trajectories
from model.dataflow import SECTIONS, Node
from scripts import run
from scripts.env import ROOT, SIMULATORS

SCORES = ROOT / "docs" / "scores.md"
PIPELINE = ROOT / "docs" / "pipeline.svg"


# -- scores ----------------------------------------------------------------------------------------------------------


def scores_page(scores: list[dict]) -> str:
    """docs/scores.md from the objects of score.json (of one simulator: the page does not name it)."""
    first = scores[0]
    rows = [
        "# Scores of the built-in trajectories",
        "",
        "Written by `python -m scripts.gen_docs` from an RTL run; `make test` fails when it is out of date.",
        "",
        f"Datapath `{first['datapath']}`, {first['width']} bits, latency {first['latency_cycles']} clocks, "
        f"{first['total_cycles']} clocks for 100 targets, {first['results_per_cycle']:g} result a clock; "
        f"{sum(s['bit_mismatches'] for s in scores)} bits of all nodes differ from the bit-true model.",
        "",
        "- *hand*: distance of the forward-kinematics wrist from the target / (d1 + d2), over the targets in reach;",
        "- *bar*: what it must not exceed. 1e-4 where every pose keeps 0.2 rad away from the singular poses of the",
        "  equations, otherwise the largest prediction;",
        "- *predicted*: what the roundings can do at these poses, from word lengths and conditioning alone;",
        "- *angle*: largest angle of the shoulder or elbow rotation from double precision, rad;",
        "- *elbow*: largest distance of the elbow from double precision / (d1 + d2);",
        "- *norm*: largest abs(norm^2 - 1) of both quaternions;",
        "- *clamped*: the hand of unreachable targets, against the nearest point in reach;",
        "- *singular*: the least distance of a pose from a singular one, rad.",
        "",
        "| trajectory | hand max | hand rms | bar | predicted | angle | elbow | norm | flagged | clamped | singular |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for s in scores:
        figures = [
            *(s[k] for k in ("hand_error_max", "hand_error_rms", "hand_error_bar", "hand_error_predicted")),
            *(s[k] for k in ("angle_error_max", "elbow_point_error_max", "norm_error_max")),
        ]
        cells = [s["trajectory"], *(f"{f:.1e}" for f in figures), str(s["flagged"])]
        cells += ["-" if s["clamped_error_max"] is None else f"{s['clamped_error_max']:.1e}"]
        cells += [f"{s['singular_distance_min']:.3f}"]
        rows.append(f"| {' | '.join(cells)} |")
    rows += ["", "What they are:", ""]
    rows += [f"- `{s['trajectory']}`: {trajectories.describe(s['trajectory'])}" for s in scores]
    return "\n".join(rows) + "\n"


# -- the pipeline as a picture ---------------------------------------------------------------------------------------

SCALE = 2.6  # pixels a clock
LEFT, TOP, ROW = 216, 46, 34
SHOWN = {"root": "#c2410c", "div": "#1d4ed8", "sincos": "#15803d"}
WORDS = {"root": "square root", "div": "division", "sincos": "sine and cosine"}


def pipeline_svg(width: int = 32) -> str:
    """docs/pipeline.svg: when each section works, its roots and divisions, in clocks since the target came in."""
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), width).bits.nodes
    latest = max(node.time for node in nodes.values())
    sections = [name for name in SECTIONS if name != "results"]
    wide, high = LEFT + SCALE * latest + 24, TOP + ROW * len(sections) + 62
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:.0f} {high}" font-family="sans-serif" '
        f'font-size="12" fill="#111">',
        f'<rect width="{wide:.0f}" height="{high}" fill="#fff"/>',
        f'<text x="12" y="22" font-size="14">One target in the pipeline, W = {width}: clocks since it came in</text>',
    ]
    bottom = TOP + ROW * len(sections)
    for clock in [*range(0, latest - 15, 50), latest]:
        x = LEFT + SCALE * clock
        out.append(f'<line x1="{x:.1f}" y1="{TOP - 8}" x2="{x:.1f}" y2="{bottom}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle" fill="#555">{clock}</text>')
    for k, name in enumerate(sections):
        y = TOP + ROW * k
        own = [node for node in nodes.values() if node.section == name and node.op != "input"]
        begin = min(_start(node) for node in own)
        out.append(f'<text x="12" y="{y + 17}">{escape(_title(name))}</text>')
        end = max(node.time for node in own)
        out.append(_bar(y + 7, begin, end, "#e5e7eb", 12, f"{name}: clocks {begin} to {end}"))
        for node in own:
            if node.latency in SHOWN:
                tip = f"{node.name} {node.equation}: {WORDS[node.latency]}, clocks {_start(node)} to {node.time}"
                # Sine and cosine run beside the first root: the lower half is theirs.
                place, height = (17, 7) if node.latency == "sincos" else (4, 12)
                out.append(_bar(y + place, _start(node), node.time, SHOWN[node.latency], height, tip))
    x = LEFT
    for kind, colour in SHOWN.items():
        out.append(f'<rect x="{x}" y="{bottom + 30}" width="14" height="12" fill="{colour}"/>')
        out.append(f'<text x="{x + 20}" y="{bottom + 40}">{WORDS[kind]}</text>')
        x += 130
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _title(section: str) -> str:
    return {"guard": "domain and scale"}.get(section, SECTIONS[section])


def _start(node: Node) -> int:
    waits_for = [*node.operands, *([node.after] if node.after else [])]
    return max((o.time for o in waits_for), default=0)


def _bar(y: int, begin: int, end: int, colour: str, height: int, tip: str) -> str:
    x, w = LEFT + SCALE * begin, SCALE * (end - begin)
    return (
        f'<rect x="{x:.1f}" y="{y}" width="{w:.1f}" height="{height}" fill="{colour}" stroke="#fff" stroke-width="0.6">'
        f"<title>{escape(tip)}</title></rect>"
    )


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.gen_docs", description=__doc__.splitlines()[0])
    parser.add_argument("--sim", choices=SIMULATORS, default=SIMULATORS[0])
    sim = parser.parse_args().sim
    with tempfile.TemporaryDirectory() as out:
        status = run.main(["--trajectory", "all", "--out", out, "--sim", sim])
        if status:
            return status
        scores = json.loads((Path(out) / "score.json").read_text())
    SCORES.parent.mkdir(exist_ok=True)
    SCORES.write_text(scores_page(scores))
    PIPELINE.write_text(pipeline_svg())
    print(f"wrote {SCORES.relative_to(ROOT)} and {PIPELINE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

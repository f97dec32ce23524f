# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core and write one HTML page to look at: what `make report` does.

    python -m scripts.report [--trajectory NAME|all|FILE.csv] [--out DIR] [--sim icarus|verilator] ...

Writes OUT/report.html: the arm in motion as the core's quaternions put it, of a clip the whole figure, joint angles,
errors of every target with what is asked and predicted, the score, the pipeline over time. The page holds all that it
needs (report.html, .css and the scripts of this folder, and the figures as JSON) and opens from disk without network.
Beside it are the files of `scripts.run`, to which it links.

Exit status: as `scripts.run`; a page is written also when a trajectory fails, and says so.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from model.reference.equations import swivel_normal
from model.targets import flags as flag_bits
from model.targets import trajectories
from model.targets.files import write_atomically
from model.targets.scoring import Score
from model.targets.words import from_words, result_values
from scripts import run
from scripts.console import command, output, writing
from scripts.report.figure import figure_data, joint_angles
from scripts.tables import figures, verdict
from tb.sim.simulate import Run

HERE = Path(__file__).parent
SCRIPTS = ("canvas", "arm", "figure", "plots", "overview", "report")

DIGITS = 7
"""Digits of the figures in the page: enough to draw, and to read."""

MOST_ARMS = 4
"""Arms of different lengths that are drawn side by side; of a file with more, only the one that moves is."""


def _numbers(array: np.ndarray, digits: int = DIGITS) -> Any:
    """An array as nested lists of short numbers."""
    if array.ndim > 1:
        return [_numbers(row, digits) for row in array]
    return [float(f"{value:.{digits}g}") for value in array.tolist()]


def _arms(d1: np.ndarray, d2: np.ndarray) -> list[int]:
    """For every target, which arm it is of: targets of the same lengths are of the same arm."""
    _, index = np.unique(np.column_stack((d1, d2)), axis=0, return_inverse=True)
    index = index.reshape(-1)
    return (index if index.max() < MOST_ARMS else np.zeros_like(index)).tolist()


def trajectory_data(item: run.Prepared, ran: Run, result: Score) -> dict[str, Any]:
    """What the page shows of one trajectory; lists are over its targets, lengths in the user's unit."""
    targets, width = item.targets, result.width
    values = result_values(ran.results, width)
    # What the words asked for: the swivel plane that the core was given.
    asked = from_words(item.words, 0, width, targets.name)
    each = result.each
    about = trajectories.describe(targets.name) if targets.path is None else f"Targets of {Path(targets.path).name}."
    of_clip, arms = {}, _arms(targets.d1, targets.d2)
    if item.clip:
        clip = figure_data(item, ran, width)
        sides = " and ".join(move.arm.side for move in item.moves)
        frames = len(targets) // len(item.moves)
        about = (
            f"{Path(targets.path).name}: {frames} frames at {clip['rate']:g} Hz; {sides} arm by the core, "
            "the rest of the body as in the clip."
        )
        of_clip = {"clip": clip, "elbowError": _numbers(run.elbow_errors(item, result))}
        arms = np.tile(np.arange(len(item.moves)), frames).tolist()
    return of_clip | {
        "name": targets.name,
        "about": about,
        "target": _numbers(targets.position),
        "phi": _numbers(targets.phi),
        "lengths": _numbers(np.column_stack((targets.d1, targets.d2))),
        "arm": arms,
        "angles": _numbers(joint_angles(item, ran, width), 5),
        "elbow": _numbers(np.ldexp(each.elbow, -item.exponent)),
        "wrist": _numbers(np.ldexp(each.wrist, -item.exponent)),
        "normal": _numbers(targets.points_from_core(swivel_normal(asked.x, asked.y, asked.z, asked.phi))),
        "qs": _numbers(targets.from_core(values[:, :4])),
        "qe": _numbers(values[:, 4:]),
        "flags": [flag_bits.names(int(bits)) for bits in ran.flags],
        "clamped": each.clamped.tolist(),
        "hand": _numbers(each.judged_error),
        "predicted": _numbers(each.predicted),
        "bar": result.hand_error_bar if result.hand_error_bar is not None else result.clamped_error_bar,
        "shoulderAngle": _numbers(each.shoulder_angle_error),
        "elbowAngle": _numbers(each.elbow_angle_error),
        "latency": result.latency_cycles,
        "cycles": result.total_cycles,
        "figures": figures(result, ran.flags),
        "passed": result.passed,
        "outcome": result.outcome,
        "failures": result.failures,
    }


def _links(out: Path, prepared: Sequence[run.Prepared]) -> dict[str, list[str]]:
    """The files beside the page, of each trajectory and, under "", of all."""
    names = [path.relative_to(out).as_posix() for path in run.written(out, prepared)]
    tables = [path.relative_to(out).as_posix() for path in run.result_paths(out, prepared)]
    own = {item.targets.name: [t, f"{t.removesuffix('csv')}npz"] for item, t in zip(prepared, tables, strict=True)}
    known = {name for each in own.values() for name in each}
    return own | {"": [name for name in names if name not in known]}


def script() -> str:
    """The scripts of the page, in the order in which they use each other."""
    return "\n".join((HERE / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS)


def page(
    shown: Sequence[dict[str, Any]], links: dict[str, list[str]], *, datapath: str, width: int, simulator: str
) -> str:
    """The whole page. `links`: files beside it, of each trajectory by its name, of all under ""."""
    data = json.dumps({"trajectories": shown, "files": links}, allow_nan=False, separators=(",", ":"))
    parts = {
        "title": html.escape(shown[0]["name"] if len(shown) == 1 else f"{len(shown)} trajectories"),
        "run": html.escape(f"{datapath} datapath, {width} bits, {simulator}"),
        "style": (HERE / "report.css").read_text(encoding="utf-8"),
        "script": script(),
        "data": data.replace("<", "\\u003c"),  # so that no name can end the script element
    }
    template = (HERE / "report.html").read_text(encoding="utf-8")
    # In one pass: what is put in is not looked at again.
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)


@command("report")
def main(arguments: Sequence[str] | None) -> int:
    """Run, score and write the page; the exit status."""
    about = "Run trajectories through the core in a simulator and write a page that shows them."
    parsed = run.parser_of("report", about, out="build/report", written="report.html").parse_args(arguments)
    path = parsed.out / "report.html"
    prepared = run.prepare(parsed)
    with output(parsed.out, [path, *run.written(parsed.out, prepared)]):
        done = run.run_and_score(parsed, prepared)
        shown = [trajectory_data(item, ran, result) for item, (ran, result) in zip(prepared, done, strict=True)]
        links = _links(parsed.out, prepared)
        text = page(shown, links, datapath=parsed.datapath, width=parsed.width, simulator=parsed.sim)
        with writing():
            write_atomically(path, text)
        run.write_results(parsed.out, prepared, done)
    print(f"wrote {path}")
    return verdict("report", [result for _, result in done])

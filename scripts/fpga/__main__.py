# SPDX-License-Identifier: Apache-2.0
"""Table 5 of the paper again: logic, multipliers and clock of the datapaths, by open tools (make fpga).

    python -m scripts.fpga [--datapath lean|lean25|paper|memory|fold|fold_arm] [--width BITS] [--page]
        [--farm tcp://HOST:PORT]

Synthesizes with Yosys for the paper's family (xc2vp, Virtex-II Pro), xc7, xcup and ECP5, and places and routes on an
ECP5-85k with nextpnr; the fold datapath targets the smallest chips. Each netlist is simulated next to the RTL; one that
differs has no figures. The figures go to fpga.json, the source of the page fpga.md; --page only renders the page. A run
is repeated only if the hash of its sources, options and tools is neither there nor in the cache in build/fpga, so an
interrupted command resumes. With --farm, Dask workers execute the runs in parallel (scripts/parallel.py).
"""

from __future__ import annotations

import datetime
import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace

import click

from model.dataflow.datapaths import MODELS
from model.dataflow.fixed import latency
from model.io.scoring import model_errors
from model.io.stimuli import hand_poses, region
from scripts import parallel
from scripts.console import WORD_LENGTH, InputError, command, option, progress, switch
from scripts.fpga import designs, page
from scripts.fpga.designs import Design
from scripts.fpga.netlist import HOLDS
from scripts.fpga.runs import TOOLS, Run, attempts, commands, version
from scripts.generate.pages import TARGETS
from scripts.soak import hand_errors
from tb.sim.env import ROOT

FULL = 0.97
"""Largest utilization of the device at which a design is placed."""


def fits(family: str, cells: dict) -> bool:
    """Return whether a synthesized design fits the ECP5-85k; the small chips are tried."""
    used = {"MULT18X18D": "multipliers", "TRELLIS_COMB": "LUT", "TRELLIS_FF": "FF", "DP16KD": "RAM"}
    return family != "ecp5" or all(cells[kind] <= FULL * HOLDS[bel] for bel, kind in used.items())


def commit() -> str:
    """Return the commit of the checkout, with a + if the RTL has been changed since."""

    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()

    return git("rev-parse", "--short", "HEAD") + ("+" if git("status", "--porcelain", "rtl") else "")


def describe(design: Design) -> dict:
    """Return commit and digest of the code; of a core, latency and the largest wrist error of the model, or hand error
    of the whole arm."""
    facts = {"rtl": designs.code(design), "commit": commit()}
    if design.datapath not in MODELS:
        return facts
    words = region("anywhere", TARGETS, design.width, 1)
    if MODELS[design.datapath].side:
        errors, _ = hand_errors(hand_poses(words, design.width, 1), design.width, design.datapath)[0]
    else:
        errors, _ = model_errors(words, design.width, design.datapath)
    return {"latency": latency(design.datapath, design.width), "hand": float(f"{errors.max():.2g}"), **facts}


class Measurement:
    """Figures of fpga.json, written after each run. ``left_out``: a line for each run that timed out
    or whose netlist differs from the RTL.

    ``tried`` in the file is written by hand: [what, where, before, after] of each change of the RTL, kept or not.
    """

    def __init__(self, each: Callable = map):
        self.data, self.each = designs.load(), each
        self.left_out: list[str] = []

    def execute(self, runs: Sequence[Run]) -> dict[str, dict]:
        """Execute the runs without recorded or cached figures of their key; record and return the figures by title.

        Of the seeds of a placement the fastest counts; ``tried`` has the clocks of all.
        """
        recorded = {run.title: (run, self.data["runs"].get(run.title, {})) for run in runs}
        best = {title: of for title, (run, of) in recorded.items() if of.get("key") == run.key()}
        runs = [run for run in runs if run.title not in best]
        known = [attempts(run, cached=True) for run in runs]
        fresh = iter(self.each(attempts, [run for run, found in zip(runs, known, strict=True) if not found]))
        with progress("fpga", len(runs)) as meter:
            for done, (run, found) in enumerate(zip(runs, known, strict=True)):
                meter(done, run.title)
                if not found:
                    found = next(fresh)
                    for figures in found:
                        replace(run, seed=figures.get("seed", run.seed)).cache(figures)
                if not found:
                    self.data["runs"].pop(run.title, None)
                    self.left_out.append(f"{run.title}: no figures")
                    continue
                best[run.title] = max(found, key=lambda figures: figures["mhz"]) if run.aim else found[0]
                extra = {"tried": [figures["mhz"] for figures in found]} if run.aim else {}
                date = datetime.date.today().isoformat()
                self.data["runs"][run.title] = {"date": date, "key": run.key(), **best[run.title], **extra}
                self.write()
        return best

    def measure(self, chosen: Sequence[Design]) -> None:
        """Synthesize designs for all of their families, and place them, if they fit."""
        for design in chosen:
            self.data["designs"].setdefault(design.name, {}).update(describe(design))
        runs = [design.run(family) for design in chosen for family in design.families]
        runs += [d.run("xc2vp", "tree") for d in chosen if d.width in page.BROKEN_DOWN.get(d.datapath, ())]
        done = self.execute(runs)
        placements: list[Run] = []
        for design in chosen:
            for family in design.aims:
                synthesized = done.get(design.run(family).title)
                if synthesized and fits(family, synthesized["cells"]):
                    placements.append(design.run(family, "place"))
        self.execute(placements)
        self.write()

    def write(self) -> None:
        self.data["tools"] = {tool: version(tool) for tool in TOOLS}
        self.data["commands"] = commands()
        for part in ("tools", "commands", "designs", "runs"):
            self.data[part] = dict(sorted(self.data[part].items()))
        # One line per run, so that a diff shows the new ones.
        lines = [f' "{part}": {json.dumps(self.data[part])}' for part in ("tools", "commands")]
        lines.append(' "tried": [\n' + ",\n".join(f"  {json.dumps(row)}" for row in self.data["tried"]) + "\n ]")
        for part in ("designs", "runs"):
            rows = (f'  "{key}": {json.dumps(value)}' for key, value in self.data[part].items())
            lines.append(f' "{part}": {{\n' + ",\n".join(rows) + "\n }")
        designs.FIGURES.write_text("{\n" + ",\n".join(lines) + "\n}\n")
        designs.PAGE.write_text(str(page.page(self.data)))


@command(
    "fpga",
    __doc__.splitlines()[0],
    [
        option("--datapath", "only this datapath or core", click.Choice(designs.GROUPS), multiple=True),
        option("--width", "only this word length", WORD_LENGTH, metavar="BITS", multiple=True),
        switch("--page", "only write the page from the figures"),
        parallel.FARM,
    ],
    fails="a run was not done in time, or a netlist differs from the RTL",
)
def main(options: SimpleNamespace) -> int:
    if options.farm and options.page:
        raise InputError("argument --farm: does not go with --page")
    if options.page:
        designs.PAGE.write_text(str(page.page(designs.load())))
        return 0
    for tool in TOOLS:
        version(tool)
    with parallel.shared(1, options.farm) as each:
        measurement = Measurement(each=each)
        measurement.measure(designs.select(options.datapath, options.width))
    made = page.page(measurement.data)
    print("\n".join([made.comparison(), made.folded(), *measurement.left_out]))
    return 1 if measurement.left_out else 0


if __name__ == "__main__":
    sys.exit(main())

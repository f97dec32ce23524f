# SPDX-License-Identifier: Apache-2.0
"""Measure logic, multipliers and clock of the datapaths with open tools, for table 5 of the paper: `make fpga`.

Synthesizes with Yosys for the paper's family (xc2vp, Virtex-II Pro), xc7, xcup and ECP5, and places and routes on an
ECP5-85k with nextpnr; the fold datapath targets the smallest chips. Each netlist is simulated side by side with the
RTL; a netlist that differs gets no figures. The figures go to fpga.json, the source of the page fpga.md; --page only
renders the page. A run whose key (hash of sources, options and tools) is in fpga.json is not repeated, so an
interrupted command resumes. With --farm, Dask workers execute the runs in parallel (scripts/parallel.py).
"""

import datetime
import json
import sys
from collections.abc import Callable, Sequence
from functools import partial

import click
from jinja2.environment import TemplateModule

from model.dataflow.datapaths import MODELS
from model.dataflow.fixed import latency
from model.io.scoring import model_errors
from model.io.stimuli import hand_poses, region
from scripts import parallel, score_tables
from scripts.console import WORD_LENGTH, InputError, Options, command, option, progress, switch
from scripts.fpga import designs, netlist
from scripts.fpga.designs import CHIPS, FAMILIES, Design, clock, find, measured, run_of
from scripts.fpga.runs import TOOLS, Run, commands, done, version
from scripts.generate.pages import TARGETS
from scripts.generate.render import TEMPLATES, commit
from scripts.soak import hand_errors

BROKEN_DOWN = {"lean": (32, 18), "paper": (32,)}
"""Datapath -> word lengths at which logic is counted by section."""


def describe(design: Design) -> dict:
    """Return the commit and digest of a design's code. If the design has a model, also return its latency in clocks
    and the model's largest errors: wrist error / reach; for the whole arm, hand error / reach and orientation error."""
    facts = {"rtl": designs.code(design), "commit": commit()}
    if design.datapath not in MODELS:
        return facts
    words = region("anywhere", TARGETS, design.width, 1)
    if MODELS[design.datapath].side:
        errors, turns = hand_errors(hand_poses(words, design.width, 1), design.width, design.datapath)[0]
        facts["orientation"] = float(f"{turns.max():.2g}")
    else:
        errors, _ = model_errors(words, design.width, design.datapath)
    return {"latency": latency(design.datapath, design.width), "hand": float(f"{errors.max():.2g}"), **facts}


def execute(data: dict, runs: Sequence[Run], ordered_map: Callable = map) -> dict[str, dict]:
    """Execute and record the runs whose key in ``data`` is missing or old; return title -> figures of all runs."""
    known = {run.title: data["runs"].get(run.title, {}) for run in runs}
    new = [run for run in runs if known[run.title].get("key") != run.key()]
    with progress("fpga", len(new)) as meter:
        results = iter(ordered_map(done, new))
        for number, run in enumerate(new):
            meter(number, run.title)
            figures = next(results)
            data["runs"].pop(run.title, None)
            if figures:
                data["runs"][run.title] = {"date": datetime.date.today().isoformat(), "key": run.key(), **figures}
            write(data)
    return {run.title: data["runs"][run.title] for run in runs if run.title in data["runs"]}


def measure(data: dict, chosen: Sequence[Design], ordered_map: Callable = map) -> list[str]:
    """Synthesize designs for their ``families`` and place them for ``aims``; return titles of runs without figures."""
    for design in chosen:
        data["designs"].setdefault(design.name, {}).update(describe(design))
    runs = [design.run(family) for design in chosen for family in design.families]
    runs += [one.run("xc2vp", "tree") for one in chosen if one.width in BROKEN_DOWN.get(one.datapath, ())]
    figures = execute(data, runs, ordered_map)
    aims = [(design, family) for design in chosen for family in design.aims]
    placements = [design.run(family, "place") for design, family in aims if design.run(family).title in figures]
    figures |= execute(data, placements, ordered_map)
    write(data)
    return [run.title for run in [*runs, *placements] if run.title not in figures]


def page(data: dict) -> TemplateModule:
    """Return the page as a template module, whose macros `comparison` and `folded` render single tables."""
    dates = sorted(run["date"] for run in data["runs"].values())

    def run(design: Design, family: str, kind: str = "synth") -> dict:
        return run_of(data, design.run(family, kind))

    def column(design: Design) -> dict:
        """Return the figures in a design's column of table 5."""
        figures = {"head": f"{design.datapath}, W = {design.width}", **data["designs"][design.name]}
        figures |= {family: run(design, family).get("cells", {}) for family in FAMILIES}
        if figures["xc2vp"]:
            figures["share"] = f"{figures['xc2vp']['LUT']} ({score_tables.of_chip(figures['xc2vp']['LUT'])})"
        if mhz := clock(data, design.datapath, design.width):
            figures |= {"mhz": mhz, "ns": 1000 * figures["latency"] / mhz, "us": (figures["latency"] + 100) / mhz}
        return figures

    columns = [column(design) for of in ("paper", "lean", "lean25") for design in reversed(measured(data, of))]
    broken = [find(name, width) for name, widths in BROKEN_DOWN.items() for width in widths]
    values = {"data": data, "run": run, "measured": partial(measured, data), "columns": columns}
    values |= {"broken": broken, "find": find, "dates": " to ".join(sorted({dates[0], dates[-1]}))}
    values |= {"clock": partial(clock, data), "chip": score_tables, "chips": CHIPS}
    values |= {"models": MODELS, "netlist": netlist}
    return TEMPLATES.get_template("fpga.md.j2").make_module(values)


def write(data: dict) -> None:
    """Write fpga.json and its page. Entry `tried` is written by hand: [what, where, before, after] for each change of
    the RTL that was tried, even if it was not kept."""
    data["tools"] = {tool: version(tool) for tool in TOOLS}
    data["commands"] = commands()
    for part in ("tools", "commands", "designs", "runs"):
        data[part] = dict(sorted(data[part].items()))
    # One line per run, so that a diff shows the new ones.
    lines = [f' "{part}": {json.dumps(data[part])}' for part in ("tools", "commands")]
    lines.append(' "tried": [\n' + ",\n".join(f"  {json.dumps(row)}" for row in data["tried"]) + "\n ]")
    for part in ("designs", "runs"):
        rows = (f'  "{key}": {json.dumps(value)}' for key, value in data[part].items())
        lines.append(f' "{part}": {{\n' + ",\n".join(rows) + "\n }")
    designs.FIGURES.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    designs.PAGE.write_text(str(page(data)))


@command(
    "fpga",
    [
        option("--datapath", "only this datapath or core", click.Choice(designs.GROUPS), multiple=True),
        option("--width", "only this word length", WORD_LENGTH, metavar="BITS", multiple=True),
        switch("--page", "only write the page from the figures"),
        parallel.FARM,
    ],
    fails="a run was not done in time, or a netlist differs from the RTL",
)
def main(options: Options) -> int:
    if options.farm and options.page:
        raise InputError("argument --farm: does not go with --page")
    if options.page:
        designs.PAGE.write_text(str(page(designs.load())))
        return 0
    for tool in TOOLS:
        version(tool)
    data = designs.load()
    with parallel.shared(1, options.farm) as ordered_map:
        left_out = measure(data, designs.select(options.datapath, options.width), ordered_map)
    made = page(data)
    print("\n".join([made.comparison(), made.folded(), *(f"{title}: no figures" for title in left_out)]))
    return 1 if left_out else 0


if __name__ == "__main__":
    sys.exit(main())

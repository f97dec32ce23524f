# SPDX-License-Identifier: Apache-2.0
"""Table 5 of the paper again: logic, multipliers and clock of both datapaths, by open tools (make fpga).

    python -m scripts.fpga [--datapath lean|lean25|paper|memory|fold] [--width BITS] [--page]
        [--farm tcp://HOST:PORT]

Synthesizes with Yosys for the paper's family (xc2vp, Virtex-II Pro), xc7, xcup and ECP5, and places and routes on an
ECP5-85k with nextpnr; the fold datapath targets the smallest chips. Every run is cached in build/fpga under a hash of
its sources, options and tools: a repeated command is quick, an interrupted one resumes. With --farm, Dask workers
execute independent runs in parallel (scripts/parallel.py). The figures go to fpga.json, the source of the page
fpga.md; --page only renders the page.
"""

from __future__ import annotations

import datetime
import json
import re
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import click

from model.dataflow.fixed import latency
from model.io.stimuli import region
from scripts import parallel
from scripts.console import WORD_LENGTH, InputError, command, option, progress, switch
from scripts.fpga.page import (
    AIM_MHZ,
    BROKEN_DOWN,
    FIGURES,
    FOLD,
    FOLD_MHZ,
    MEMORY,
    PARAMETERS,
    SECTIONS,
    TOPS,
    WHOLE_TOPS,
    comparison,
    fold_values,
    folded,
    page,
)
from scripts.fpga.report import HOLDS
from scripts.fpga.runs import ALLOW, PACKAGES, PLACE, Run, TimeOutError, content, program, say, version
from scripts.generate.accuracy import Errors
from tb.sim.env import GENERATED, ROOT
from tb.sim.sources import closure, digest

PAGE = GENERATED / "fpga.md"

WIDTHS = {"lean": (18, 24, 32), "lean25": (18,), "paper": (32,)}
"""Default word lengths of each datapath."""
FAMILIES = ("xc2vp", "xc7", "xcup", "ecp5")
ONLY_COUNTED = {"lean25": ("xc7", "xcup")}
"""Synthesized for these families but not placed: only the gain of shorter words and larger tiles is measured."""
FULL = 0.97
"""Largest utilization of the device at which a design is placed whole."""
SEEDS = range(1, 5)
"""Placement seeds, tried until the aim is reached."""


ECHO = (ROOT / "tb" / "axi" / "ik_lean.v",)
"""Replacement for the datapath when only its surroundings are measured."""


def rtl_digest(datapath: str) -> str:
    """Return the digest of a datapath's code; for `memory`, of ``ik_axi``; for `fold`, of ``ik_axis``."""
    return digest(closure(TOPS.get(datapath) or WHOLE_TOPS[datapath]))


def recorded() -> dict[str, str]:
    """Return design, such as lean-32 -> digest of the code behind the checked-in figures."""
    data = json.loads(FIGURES.read_text())
    designs = data["designs"] | {part: data[part] for part in WHOLE_TOPS if part in data}
    return {f"RTL of {name}": design["rtl"] for name, design in designs.items()}


def present() -> dict[str, str]:
    """Return design -> digest of the present code."""
    return {name: rtl_digest(name.split()[-1].split("-")[0]) for name in recorded()}


def synthesis(datapath: str, width: int, family: str, kind: str = "synth") -> Run:
    return Run(kind, family, TOPS[datapath], {"W": width, **PARAMETERS[datapath]})


def placement(datapath: str, width: int, module: str) -> Run:
    """Return the placement, with the first seed, of a module or the top of the datapath with its parameters."""
    text = content(closure(module)[0]).decode()
    values = {k: v for k, v in {"W": width, **PARAMETERS[datapath]}.items() if re.search(rf"\b{k}\s*=", text)}
    return Run("place", "ecp5", module, values)


def fits(cells: dict) -> bool:
    """Return whether a synthesized design fits the device, by its ECP5 counts."""
    used = {"MULT18X18D": "multipliers", "TRELLIS_COMB": "LUT", "TRELLIS_FF": "FF", "DP16KD": "RAM"}
    return all(cells[kind] <= FULL * HOLDS[bel] for bel, kind in used.items())


class Figures:
    """docs/generated/fpga.json: every run with its figures, and the page's other data on a design.

    ``tried`` is written by hand: [what, where, before, after] of each change of the RTL, kept or not.
    """

    def __init__(self, path: Path = FIGURES):
        self.path = path
        self.data = json.loads(path.read_text()) if path.exists() else {"designs": {}, "runs": {}}

    def add(self, name: str, figures: dict) -> None:
        self.data["runs"][name] = {"date": datetime.date.today().isoformat(), **figures}

    def design(self, datapath: str, width: int) -> dict:
        return self.data["designs"].setdefault(f"{datapath}-{width}", {})

    def write(self) -> None:
        self.data["tools"] = {name: version(name) for name in PACKAGES}
        self.data["commands"] = commands()
        for part in ("tools", "commands", "designs", "runs"):
            self.data[part] = dict(sorted(self.data[part].items()))
        # one line per run, so that a diff shows the new ones
        lines = [f' "{k}": {json.dumps(self.data[k])},' for k in ("tools", "commands", *WHOLE_TOPS) if k in self.data]
        tried = ",\n".join(f"  {json.dumps(row)}" for row in self.data.get("tried", []))
        lines += [' "tried": [', *([tried] if tried else []), " ],"]
        for part, end in (("designs", ","), ("runs", "")):
            rows = ",\n".join(f'  "{k}": {json.dumps(v)}' for k, v in self.data[part].items())
            lines += [f' "{part}": {{', rows, f" }}{end}"]
        self.path.write_text("\n".join(["{", *lines, "}", ""]))
        if self.path == FIGURES:
            PAGE.write_text(page(self.data))


def commands() -> dict[str, str]:
    """Return family or tool -> its command, without file names."""
    out = {}
    for family in dict.fromkeys((*FAMILIES, *(family for family, _, _ in FOLD))):
        lines = Run("synth", family, "ik_lean", {}).script().splitlines()
        out[family] = "; ".join(lines[1:-1]).replace("ik_lean", "TOP")
    for family, (tool, *told) in PLACE.items():
        out[f"{tool} for {family}"] = " ".join([tool, *told, *ALLOW, "--seed", "SEED", "--json", "netlist.json"])
    return out


def commit() -> str:
    """Return the commit of the checkout, with a + if the RTL has been changed since."""

    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()

    return git("rev-parse", "--short", "HEAD") + ("+" if git("status", "--porcelain", "rtl") else "")


def describe(datapath: str, width: int) -> dict:
    """Return latency and largest hand error of the bit-true model on 4000 random targets."""
    errors = Errors.of(region("anywhere", 4000, width, 1), width, datapath)
    return {"latency": latency(datapath, width), "hand": float(f"{errors.hand.max():.2g}")}


def code(datapath: str) -> dict:
    """Return digest and commit of the measured code."""
    return {"rtl": rtl_digest(datapath), "commit": commit()}


Job = tuple[Run, float | None]
"""A run, and None or the MHz at which to stop trying seeds."""


def attempts(job: Job) -> dict[Run, dict | None]:
    """Return the figures of the job's runs, None for a run that timed out."""
    found = {}
    for run in seeds(job):
        try:
            found[run] = run.done()
        except TimeOutError as error:
            say(str(error))
            found[run] = None
        if reached(found[run], job):
            break
    return found


def seeds(job: Job) -> list[Run]:
    first, aim = job
    return [first] if aim is None else [replace(first, seed=seed) for seed in SEEDS]


def reached(figures: dict | None, job: Job) -> bool:
    return bool(figures) and (job[1] is None or figures["mhz"] >= job[1])


class Measurement:
    """Runs whose figures are written after each. ``left_out``: a line for each run that timed out; ``each``: the `map`
    of a farm, if any."""

    def __init__(self, figures: Figures, each: Callable | None = None):
        self.figures, self.each = figures, each
        self.left_out: list[str] = []
        self.known: list[tuple[Job, dict[Run, dict | None]]] = []

    def ahead(self, jobs: Iterable[Job]) -> None:
        """Execute the coming jobs on the farm in parallel, if there is one."""
        if not self.each:
            return
        jobs = [job for job in jobs if not self._kept(job)]
        with progress("fpga", len(jobs)) as meter:
            for done, (job, found) in enumerate(zip(jobs, self.each(attempts, jobs), strict=True), 1):
                meter(done, job[0].name)
                self.known.append((job, found))
                for run, figures in found.items():
                    if figures:
                        run.keep(figures)

    @staticmethod
    def _kept(job: Job) -> bool:
        figures = [run.kept() for run in seeds(job)]
        return all(figures) or any(reached(done, job) for done in figures)

    def _attempts(self, job: Job) -> dict[Run, dict | None]:
        return next((found for known, found in self.known if known == job), None) or attempts(job)

    def synthesis(self, run: Run) -> dict | None:
        done = self._attempts((run, None))[run]
        if not done:
            self.left_out.append(f"{run.name}: not done in time")
        else:
            self.figures.add(run.name, done)
            self.figures.write()
        return done

    def placement(self, first: Run, aim: float) -> bool:
        """Record the fastest of the seeds tried until the aim is reached, with all their clocks; return success."""
        tried = [{**done, "seed": run.seed} for run, done in self._attempts((first, aim)).items() if done]
        if tried:
            best = max(tried, key=lambda done: done["mhz"])
            self.figures.add(first.title, {**best, "tried": [done["mhz"] for done in tried]})
            self.figures.write()
        else:
            self.left_out.append(f"{first.title}: no placement in time")
        return bool(tried)


def syntheses(datapath: str, width: int) -> Iterator[Run]:
    for family in ONLY_COUNTED.get(datapath, FAMILIES):
        yield synthesis(datapath, width, family)
        if family == "xc2vp" and width in BROKEN_DOWN and datapath not in ONLY_COUNTED:
            yield synthesis(datapath, width, family, "tree")


def measure(on: Measurement, datapaths: Sequence[str], widths: Sequence[int]) -> None:
    """Execute all runs of datapaths and widths."""
    figures = on.figures
    chosen = [(d, w) for d in datapaths for w in sorted(widths or WIDTHS[d])]
    on.ahead((run, None) for design in chosen for run in syntheses(*design))
    for datapath, width in chosen:
        figures.design(datapath, width).update(describe(datapath, width) | code(datapath))
        for run in syntheses(datapath, width):
            on.synthesis(run)
    whole, parts = {}, {}
    for datapath, width in ((d, w) for d, w in chosen if d not in ONLY_COUNTED):
        synthesized, aim = on.synthesis(synthesis(datapath, width, "ecp5")), AIM_MHZ[datapath]
        holds = synthesized and fits(synthesized["cells"])
        whole[datapath, width] = [(placement(datapath, width, TOPS[datapath]), aim)] if holds else []
        parts[datapath, width] = [(placement(datapath, width, module), aim) for module in SECTIONS[datapath]]
    on.ahead(job for design in whole for job in whole[design] + parts[design])
    for design in whole:
        holds = any(on.placement(*job) for job in whole[design])
        figures.design(*design)["placed"] = "whole" if holds else "by module"
        for job in parts[design]:
            on.placement(*job)
        figures.write()


def measure_memory(on: Measurement) -> None:
    """Execute all runs of ``ik_axi``, with an echo and with the lean datapath."""
    on.figures.data["memory"] = code("memory")
    runs = [
        [Run("synth", family, WHOLE_TOPS["memory"], {"W": width}, instead=ECHO if echo else ()) for family in FAMILIES]
        for width, echo in MEMORY
    ]
    on.ahead((run, None) for families in runs for run in families)
    synthesized = [[on.synthesis(run) for run in families][-1] for families in runs]
    fit = [run for (*_, run), done in zip(runs, synthesized, strict=True) if done and fits(done["cells"])]
    jobs = [(replace(run, kind="place"), AIM_MHZ["lean"]) for run in fit]
    on.ahead(jobs)
    for job in jobs:
        on.placement(*job)


def measure_fold(on: Measurement, widths: Sequence[int]) -> None:
    """Execute all runs of the fold datapath, placed whole."""
    figures = on.figures
    designs = {f"{datapath}-{width}": describe(datapath, width) for _, datapath, width in FOLD}
    figures.data["fold"] = {**code("fold"), "designs": designs}
    chosen = [(family, datapath, width) for family, datapath, width in FOLD if width in (widths or (width,))]
    runs = [Run("synth", family, WHOLE_TOPS["fold"], fold_values(*design)) for family, *design in chosen]
    jobs = [(replace(run, kind="place"), FOLD_MHZ[run.family]) if run.family in PLACE else (run, None) for run in runs]
    on.ahead([*((run, None) for run in runs), *(job for job in jobs if job[1])])
    for run, job in zip(runs, jobs, strict=True):
        if on.synthesis(run) and job[1]:
            on.placement(*job)


# -- command line ----------------------------------------------------------------------------------------------------


@command(
    "fpga",
    __doc__.splitlines()[0],
    [
        option("--datapath", "only this datapath or core", click.Choice([*TOPS, *WHOLE_TOPS]), multiple=True),
        option("--width", "only this word length", WORD_LENGTH, metavar="BITS", multiple=True),
        switch("--page", "only write the page from the figures"),
        parallel.FARM,
    ],
    fails="a run was not done in time",
)
def main(options: SimpleNamespace) -> int:
    if options.farm and options.page:
        raise InputError("argument --farm: does not go with --page")
    if options.page:
        PAGE.write_text(page(json.loads(FIGURES.read_text())))
        return 0
    for tool in PACKAGES:
        program(tool)
    chosen = options.datapath or [*TOPS, *WHOLE_TOPS]
    with parallel.shared(1, options.farm) as each:
        on = Measurement(Figures(), each if options.farm else None)
        measure(on, [datapath for datapath in chosen if datapath in TOPS], options.width)
        if "memory" in chosen:
            measure_memory(on)
        if "fold" in chosen:
            measure_fold(on, options.width)
    data = json.loads(FIGURES.read_text())
    print("\n".join([comparison(data), "", folded(data), *on.left_out]))
    return 1 if on.left_out else 0

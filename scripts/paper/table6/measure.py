# SPDX-License-Identifier: Apache-2.0
"""Table 6 of the paper again: its arm solved by today's software and by the core (make paper ONLY=table6).

    python -m scripts.paper.table6 [--targets 1000000] [--seed 1] [--only KEY] [--hardware] [--page]

Times the software in one run on the 100 targets of `reach` and on random targets, counts the clocks of the RTL on the
former, and writes docs/generated/table6.json and its page, table6.md. --only measures the named software and writes
nothing; --hardware counts clocks and keeps the software times; --page only writes the page.
"""

from __future__ import annotations

import datetime
import json
import os
import platform
import statistics
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np

from model.io.stimuli import random_reachable
from model.io.trajectories import STEPS, make
from model.io.words import Targets, from_words
from scripts.console import InputError, command, option, switch, whole
from scripts.fpga.designs import FIGURES as FPGA
from scripts.paper.table6 import hardware
from scripts.paper.table6.compiled import FLAGS, Software, compiler_version
from scripts.paper.table6.contenders import Bound, Contender, columns, in_c, in_jax, in_numba, in_numpy
from scripts.paper.table6.others import first, others
from scripts.paper.table6.page import page
from tb.sim.env import GENERATED

FIGURES = GENERATED / "table6.json"
PAGE = GENERATED / "table6.md"

RANDOM = 1_000_000
REPEATS, FEW_REPEATS = 7, 3
"""Measurements per median; the second number applies where each takes longer than `LONG`."""
LONG = 1.0  # s
SHORT = 0.02
"""Minimum duration of a measurement (s); faster functions are repeated within it."""


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


# -- the machine -----------------------------------------------------------------------------------


def cpu() -> tuple[str, str]:
    """Return the processor's model and its widest vector extension."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            lines = [line.partition(":") for line in stream]
    except OSError:
        lines = []
    told = {name.strip(): value.strip() for name, _, value in lines}
    flags = told.get("flags", told.get("Features", "")).split()
    widest = next((n for f, n in (("avx512f", "AVX-512"), ("avx2", "AVX2"), ("asimd", "NEON")) if f in flags), "")
    return told.get("model name") or platform.processor() or platform.machine(), widest


def machine() -> dict[str, Any]:
    """Describe the computer that ran the timings."""
    name, vectors = cpu()
    return {
        "cpu": name,
        "vectors": vectors,
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2),
        "compiler": compiler_version(),
        "flags": " ".join(FLAGS),
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


# -- timing ----------------------------------------------------------------------------------------


def seconds(again: Callable[[int], Any]) -> float:
    """Return the seconds of one repetition of `again(times)`, the median of several measurements."""

    def measured(times: int) -> float:
        begin = time.perf_counter()
        again(times)
        return (time.perf_counter() - begin) / times

    measured(1)  # compiles, fills caches
    once, times = measured(1), 1
    while once * times < SHORT:
        times = max(2 * times, min(100 * times, round(1.2 * SHORT / once)))
        once = measured(times)
    return statistics.median(measured(times) for _ in range(FEW_REPEATS if once * times > LONG else REPEATS))


def figure(value: float) -> float:
    """Round to the four digits stored in the file."""
    return float(f"{value:.4g}")


def accuracy(bound: Bound) -> tuple[float | None, int]:
    """Return the largest hand error / reach of the answers and the number of targets without one."""
    errors = bound.errors()
    answered = errors[np.isfinite(errors)]
    return (figure(answered.max()) if len(answered) else None), len(errors) - len(answered)


def row(contender: Contender, reach: Targets, random: Targets) -> dict[str, Any]:
    """Return a contender's row: what it lacks, or its times and errors."""
    told = {"key": contender.key, "group": contender.group, "name": contender.name}
    if contender.lacks or contender.bind is None:
        return told | {"lacks": contender.lacks}
    for name, targets in (("reach", reach), ("random", first(random, contender.most) if contender.most else random)):
        bound = contender.bind(targets)
        error, unanswered = accuracy(bound)
        told[name] = {
            "targets": len(targets),
            "ns": figure(1e9 * seconds(bound.again) / len(targets)),
            "error": error,
            "unanswered": unanswered,
        }
    return told


def jitter(software: Software, random: Targets) -> dict[str, float]:
    """Return the ns of single dependent solves of the lean equations in C: median, 99.9 % quantile, maximum."""
    ns = software.watched(columns(random)).watched()
    return {
        "median": figure(np.median(ns)),
        "999": figure(np.quantile(ns, 0.999)),
        "longest": figure(ns.max()),
    }


def core(words: np.ndarray) -> Iterator[dict[str, Any]]:
    """Yield the rows of the core."""
    for datapath in hardware.DATAPATHS:
        say(f"{datapath} RTL, {len(words)} random targets through its model ...")
        worst = figure(hardware.random_error(words, datapath))
        for path, clocks in hardware.PATHS.items():
            say(f"{datapath} RTL, {path} ...")
            told = clocks(datapath)
            told["reach_error"] = figure(told["reach_error"])
            yield {"datapath": datapath, "path": path, "width": hardware.WIDTH, "random_error": worst, **told}


def contenders(software: Software) -> list[Contender]:
    """Return all software in table order."""
    return [*in_c(software), *in_numpy(), *in_numba(), *in_jax(), *others()]


def rows(chosen: Iterable[Contender], reach: Targets, random: Targets) -> Iterator[dict[str, Any]]:
    """Yield a row per contender, reporting progress."""
    chosen = list(chosen)
    for n, contender in enumerate(chosen, 1):
        say(f"[{n}/{len(chosen)}] {contender.group}: {contender.name} {contender.lacks or '...'}")
        yield row(contender, reach, random)


def written(figures: dict[str, Any]) -> str:
    """Format the figures as JSON with one row per line, for readable diffs."""
    lines = [f' "{key}": {json.dumps(value)},' for key, value in figures.items() if not isinstance(value, list)]
    for key, value in figures.items():
        if isinstance(value, list):
            lines += [f' "{key}": [', ",\n".join(f"  {json.dumps(one)}" for one in value), " ],"]
    lines[-1] = lines[-1].rstrip(",")
    return "\n".join(["{", *lines, "}", ""])


def write_figures(figures: dict[str, Any]) -> None:
    """Write table6.json and the page."""
    FIGURES.write_text(written(figures), encoding="utf-8")
    write_page()
    print(f"wrote {FIGURES.name} and {PAGE.name}")


def write_page() -> None:
    """Write table6.md from table6.json and fpga.json."""
    PAGE.write_text(page(json.loads(FIGURES.read_text()), json.loads(FPGA.read_text())), encoding="utf-8")


@command(
    "table6",
    __doc__.splitlines()[0],
    [
        option("--targets", "random targets", whole(1), default=RANDOM, metavar="N"),
        option("--seed", "random seed", whole(0), default=1, metavar="N"),
        option("--only", "only software with this in its key; writes no file", multiple=True, metavar="KEY"),
        switch("--hardware", "only the core's rows, of the targets as they were"),
        switch("--page", "only write the page from the figures"),
    ],
    passes="all is measured",
    fails="the RTL differs from its model",
    module="scripts.paper.table6",
)
def main(options: SimpleNamespace) -> int:
    if options.page:
        write_page()
        return 0
    if options.hardware:
        kept = json.loads(FIGURES.read_text())
        words = random_reachable(kept["targets"], hardware.WIDTH, kept["seed"])
        write_figures(kept | {"hardware": list(core(words))})
        return 0
    about = machine()
    software = Software()
    every = contenders(software)
    chosen = [c for c in every if not options.only or any(part in c.key for part in options.only)]
    if not chosen:
        raise InputError(f"no software of that key; there is {', '.join(c.key for c in every)}")
    say(f"{options.targets} random targets, seed {options.seed} ...")
    words = random_reachable(options.targets, hardware.WIDTH, options.seed)
    reach, random = make("reach"), from_words(words, 0, hardware.WIDTH, "random")
    assert len(reach) == STEPS
    measured = list(rows(chosen, reach, random))
    for told in measured:
        print(f"{told['key']:24} " + (told.get("lacks") or _short(told)))
    if options.only:
        return 0
    figures = {
        "date": datetime.date.today().isoformat(),
        "targets": options.targets,
        "seed": options.seed,
        "machine": about,
        "jitter": jitter(software, random),
        "software": measured,
        "hardware": list(core(words)),
    }
    write_figures(figures)
    return 0


def _short(told: dict[str, Any]) -> str:
    parts = (told[name] for name in ("reach", "random"))
    return "   ".join(f"{part['ns']:10.4g} ns, error {part['error']:.1e}" for part in parts)

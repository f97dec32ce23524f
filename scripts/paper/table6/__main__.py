# SPDX-License-Identifier: Apache-2.0
"""Measure table 6 of the paper with today's software and with the core: `make paper ONLY=table6`.

    python -m scripts.paper.table6 [--only KEY | --hardware | --page]

Times the software on the 100 targets of `reach` and on random targets, counts the clocks of the RTL for `reach`, and
writes docs/generated/table6.json and its page, table6.md. --only measures the named software again and dates its rows.
For example, `--only jax-gpu` on a machine with a GPU adds the rows that need a GPU; later runs without a GPU keep them.
--hardware counts clocks and keeps the software times; --page only writes the page.
"""

import datetime
import json
import os
import platform
import re
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from model.dataflow import fixed
from model.io.scoring import hand_errors
from model.io.stimuli import random_reachable
from model.io.trajectories import make
from model.io.words import FIELDS, Targets, from_words, result_values, to_words
from scripts import score_tables
from scripts.console import InputError, Options, command, option, switch
from scripts.fpga.designs import clock, load
from scripts.generate.pages import measured
from scripts.generate.render import render
from scripts.paper.table6.contenders import FLAGS, Contender, compiler_version, contenders
from tb.sim.env import GENERATED, SIMULATORS
from tb.sim.simulate import SimulationError, simulate

FIGURES = GENERATED / "table6.json"
PAGE = GENERATED / "table6.md"

TARGETS, SEED = 1_000_000, 1  # number of random targets, and their seed
REPEATS = 7  # number of measurements from which a median is taken
SHORT = 0.02  # minimum duration of a measurement (s). A faster function is repeated within one measurement.

WIDTH, DATAPATH = 32, "lean"
BUS, LATENCY = 128, 34  # bus width (bits) and memory latency (clocks) of the memory-to-memory path
CHUNK = 20_000  # random targets per run of the bit-true model
STREAMS = "stream to stream"
"""Name of the path through `ik_axis`. The other path, memory to memory, is through `ik_axi`."""


def machine() -> dict[str, Any]:
    """Describe the computer that runs the timings."""
    described = Path("/proc/cpuinfo")
    about = dict(re.findall(r"^(.*?)\s*: (.*)$", described.read_text() if described.exists() else "", re.M))
    flags = about.get("flags", about.get("Features", "")).split()
    vectors = (name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2"), ("asimd", "NEON")) if flag in flags)
    return {
        "cpu": about.get("model name") or platform.processor() or platform.machine(),
        "vectors": next(vectors, ""),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2),
        "compiler": compiler_version(),
        "flags": " ".join(FLAGS),
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def seconds(again: Callable[[int], Any]) -> float:
    """Return the median time (s) per repetition in several measurements. `again(n)` executes n repetitions."""

    def measured(times: int) -> float:
        begin = time.perf_counter()
        again(times)
        return (time.perf_counter() - begin) / times

    measured(1)  # compiles, fills caches
    once, times = measured(1), 1
    while once * times < SHORT:
        times = max(2 * times, min(100 * times, round(1.2 * SHORT / once)))
        once = measured(times)
    return statistics.median(measured(times) for _ in range(REPEATS))


def figure(value: float) -> float:
    """Round a value to four significant digits, for table6.json."""
    return float(f"{value:.4g}")


def row(contender: Contender, reach: Targets, random: Targets) -> dict[str, Any]:
    """Return a contender's row: its times and errors, or what it lacks. Targets without an answer are only counted."""
    cells: dict[str, Any] = {"key": contender.key, "group": contender.group, "name": contender.name}
    if contender.lacks:
        return cells | {"lacks": contender.lacks}
    random = replace(random, **{name: getattr(random, name)[: contender.most] for name in FIELDS})
    for name, targets in (("reach", reach), ("random", random)):
        again, errors_of = contender.bind(targets)
        errors = errors_of()
        answered = errors[np.isfinite(errors)]
        cells[name] = {
            "targets": len(targets),
            "ns": figure(1e9 * seconds(again) / len(targets)),
            "error": figure(answered.max()) if len(answered) else None,
            "unanswered": len(errors) - len(answered),
        }
    return cells


def stream_to_stream() -> dict:
    """Run the 100 targets of `reach` through the RTL without stalls. Return the clocks to the first and to the last
    result, the clocks per result, and the largest hand error / reach."""
    words, _ = to_words(make("reach"), WIDTH)
    (run,) = simulate([words], simulator=SIMULATORS[0], datapath=DATAPATH, width=WIDTH)
    if run.bit_mismatches:
        raise SimulationError(f"{DATAPATH}: the RTL differs from the model: {run.first_mismatch}")
    first, last = run.latency_cycles, run.total_cycles
    return {"first": first, "last": last, "each": (last - first) / len(words), "reach_error": reach_error(run.results)}


def memory_to_memory() -> dict:
    """Return the figures of :func:`stream_to_stream` for `ik_axi`: register CLOCKS after a job of 1 target and of all
    100, clocks per target on channel R in a long job, and the largest error of the results in memory."""
    (row,) = measured(SIMULATORS[0], {"DATAPATH": 1, "DATA_W": BUS}, LATENCY)
    clocks = {name: row[name] for name in ("first", "last", "each")}
    return {**clocks, "reach_error": reach_error(np.array(row["results"]))}


def reach_error(results: np.ndarray) -> float:
    """Return the largest hand error / reach in result words (N, 6) for the targets of `reach`."""
    words, exponent = to_words(make("reach"), WIDTH)
    return figure(hand_errors(result_values(results, WIDTH), from_words(words, exponent, WIDTH, "reach")).max())


PATHS = {STREAMS: stream_to_stream, f"memory to memory, {BUS} bits, latency {LATENCY}": memory_to_memory}
"""Path -> function that returns its clocks and error."""


def random_error(words: np.ndarray) -> float:
    """Return the bit-true model's largest hand error / reach for input words (N, 6). The RTL equals the model."""
    parts = np.array_split(words, -(-len(words) // CHUNK))
    answers = (result_values(fixed.run(part, WIDTH, DATAPATH).results, WIDTH) for part in parts)
    errors = (hand_errors(a, from_words(p, 0, WIDTH, "random")) for a, p in zip(answers, parts, strict=True))
    return float(max(error.max() for error in errors))


def core(words: np.ndarray) -> Iterator[dict[str, Any]]:
    """Yield the core's rows, one for each of PATHS. words: input words of random targets (N, 6)."""
    click.echo(f"{DATAPATH} RTL, {len(words)} random targets through its model ...", err=True)
    worst = figure(random_error(words))
    for path, clocks in PATHS.items():
        click.echo(f"{DATAPATH} RTL, {path} ...", err=True)
        yield {"datapath": DATAPATH, "path": path, "width": WIDTH, "random_error": worst, **clocks()}


BUSY = 0.3  # load per processor core above which the page warns that the computer was busy


def page(figures: dict, fpga: dict) -> str:
    def clock_of(row: dict) -> float:
        """Return a hardware row's clock (MHz): the clock of the datapath or, for memory to memory, of ``ik_axi``."""
        return clock(fpga, row["datapath"] if row["path"] == STREAMS else "memory", row["width"])

    machine = figures["machine"]
    unanswered = [r for r in figures["software"] if r["key"][:2] == "c-" and r["random"]["unanswered"]]
    more = {"c_unanswered": unanswered, "busy": machine["load"] > BUSY * machine["cores"], "paper": score_tables}
    return render("table6", figures=figures, machine=machine, clock_of=clock_of, **more)


def write(figures: dict[str, Any]) -> int:
    FIGURES.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(figures, load()), encoding="utf-8")
    print(f"wrote {FIGURES.name} and {PAGE.name}")
    return 0


@command(
    "table6",
    [
        option("--only", "only software with this in its key; dates these rows", multiple=True, metavar="KEY"),
        switch("--hardware", "only the core's rows"),
        switch("--page", "only write the page from the figures"),
    ],
    passes="all is measured",
    fails="the RTL differs from its model",
)
def main(options: Options) -> int:
    kept = json.loads(FIGURES.read_text())
    if options.page:
        return write(kept)
    words = random_reachable(TARGETS, WIDTH, SEED)
    if options.hardware:
        return write(kept | {"hardware": list(core(words))})
    about, every = machine(), contenders()
    chosen = [one for one in every if not options.only or any(part in one.key for part in options.only)]
    if not chosen:
        raise InputError(f"unknown key; valid: {', '.join(one.key for one in every)}")
    reach, random = make("reach"), from_words(words, 0, WIDTH, "random")
    rows, before = {}, {one["key"]: one for one in kept["software"]}
    today = {"date": datetime.date.today().isoformat()}
    for n, one in enumerate(chosen, 1):
        click.echo(f"[{n}/{len(chosen)}] {one.group}: {one.name} {one.lacks or '...'}", err=True)
        elsewhere = one.lacks and "date" in before.get(one.key, {})
        rows[one.key] = before[one.key] if elsewhere else row(one, reach, random)
    if options.only:
        dated = {key: today | one for key, one in rows.items() if "lacks" not in one}
        return write(kept | {"software": [*(before | dated).values()]})
    run = {**today, "targets": TARGETS, "seed": SEED, "machine": about}
    return write(run | {"software": [*rows.values()], "hardware": list(core(words))})


if __name__ == "__main__":
    sys.exit(main())

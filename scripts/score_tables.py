# SPDX-License-Identifier: Apache-2.0
"""Tables that `make run` and `make soak` print: figures, tolerances, verdicts, comparison with the paper."""

import sys
from collections.abc import Sequence

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from model.bounds import tolerances
from model.dataflow.datapaths import MODELS
from model.io import flags as flag_bits
from model.io.scoring import Score
from scripts.fpga.designs import CHIPS, clock, find, load, size
from scripts.generate.render import error, form
from tb.core.worst_targets import Core, Found

LATENCY, CLOCKS, RATE = "latency (clocks)", "clocks for all targets", "results per clock while they flow"

TARGETS = 100
FIRST_US, ALL_US, SOFTWARE_US = 5.0, 6.0, 860.0
"""Times of the paper for TARGETS targets (us): its pipeline to the first and the last result, its software."""

LUTS, MHZ, STAGES = 30_000, 100, 550  # LUT4, clock (MHz) and latency (clocks) of the paper's pipeline

CHIP, CHIP_LUTS, CHIP_MULTIPLIERS = "2VP70", 66_176, 328
"""Virtex-II Pro 2VP70: name, LUT4 (33088 slices of two), 18x18 multipliers (Xilinx DS083)."""

FIRST, ALL = "until the first result (us)", "until the last (us)"
PART, TIMES = f"  of the {CHIP}'s", "times the paper's software"
SOURCES = (
    f"LUT4, multipliers (the {CHIP} has {CHIP_MULTIPLIERS}) and clock are from `make fpga`, "
    "docs/generated/fpga.md; clocks and errors were counted in this run. The paper's software takes "
    f"{SOFTWARE_US:.0f} us for {TARGETS} targets."
)

EXPLAINED = (
    "tolerance: largest permitted error, TOLERANCE= or from the table of tolerances; predicted: error that rounding "
    "can cause at these poses, never compared with the measured one"
)


def empty_table(title: str, headings: Sequence[str], **settings) -> Table:
    """Return an empty table whose first column is left-justified."""
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left", caption_justify="left", **settings)
    for n, heading in enumerate(headings):
        table.add_column(heading, justify="right" if n else "left", no_wrap="padding" in settings)
    return table


def _written(tolerance: float | None) -> str:
    return "none" if tolerance is None else f"{tolerance:.3g}"


def _verdict(result: Score) -> str:
    verdict = result.outcome[:4]
    colour = {"pass": "green", "warn": "yellow"}.get(verdict, "bold red")
    return f"[{colour}]{verdict}[/]"


def outcome(result: Score) -> str:
    """Return the verdict on a trajectory and the reason for it."""
    return f"{_verdict(result)}{escape(result.outcome[4:])}"


def figures(result: Score, flags: np.ndarray) -> list[tuple[str, ...]]:
    """Return a row for each figure of one trajectory: name, measured value, and optionally tolerance and prediction.

    flags (N,): the core's flag bits.
    """
    tolerance = "-" if result.hand_error_max is None else _written(result.hand_error_tolerance)
    rows: list[tuple[str, ...]] = [
        ("bits that differ from the bit-true model", str(result.bit_mismatches), "0"),
        ("hand error / reach, largest", error(result.hand_error_max), tolerance, error(result.hand_error_predicted)),
    ]
    if result.hand_error_pose is not None:
        rows.append((f"  {result.hand_error_pose}", f"target {result.hand_error_target}"))
    rows.append(("hand error / reach, rms", error(result.hand_error_rms)))
    if result.hand_error_over_tolerance is not None:
        rows.append(("hand error / tolerance", f"{result.hand_error_over_tolerance:.2g}", "1"))
    if result.orientation_error_max is not None:
        turn = error(result.orientation_error_max), _written(result.orientation_error_tolerance)
        rows.append(("orientation error of the hand, largest (rad)", *turn))
        rows.append(("targets with a joint outside its limits", str(result.over_limit)))
    rows += [
        ("shoulder angle error, largest (rad)", error(result.shoulder_angle_error_max)),
        ("elbow angle error, largest (rad)", error(result.elbow_angle_error_max)),
        ("elbow point error / reach, largest", error(result.elbow_point_error_max)),
        ("abs(norm^2 - 1) of Qs and Qe, largest", error(result.norm_error_max)),
    ]
    if result.clamped_error_max is not None:
        clamped = error(result.clamped_error_max), _written(result.clamped_error_tolerance)
        rows.append(("error of the clamped hand / reach, largest", *clamped))
    rows.append(("distance from singular poses, least (rad)", f"{result.singular_distance_min:.3f}"))
    if result.results_per_cycle:
        rows += [(LATENCY, str(result.latency_cycles)), (CLOCKS, str(result.total_cycles))]
        rows.append((RATE, f"{result.results_per_cycle:.3f}"))
    occurred = int(np.bitwise_or.reduce(flags)) & (1 << flag_bits.OVER_BIT) - 1
    return [*rows, ("flagged targets", f"{result.flagged} ({flag_bits.names(occurred)})" if occurred else "0")]


def table_of_one(result: Score, flags: np.ndarray, more: Sequence[tuple[str, ...]] = ()) -> Table:
    """Return the table of one trajectory: a line for each of its figures, then the rows ``more``."""
    title = f"{escape(result.trajectory)}: {result.targets} targets, {result.datapath} datapath, {result.width} bits, "
    caption = f"{outcome(result)}\n{EXPLAINED}"
    table = empty_table(title + result.simulator, ("figure", "measured", "tolerance", "predicted"), caption=caption)
    for row in (*figures(result, flags), *more):
        table.add_row(*row)
    return table


def table_of_many(scores: Sequence[Score]) -> Table:
    """Return a table with one line for each trajectory, at most 80 characters wide."""
    first = scores[0]
    latency = "" if first.latency_cycles is None else f", latency {first.latency_cycles} clocks"
    title = f"{first.datapath} datapath, {first.width} bits, {first.simulator}{latency}"
    passed = [result for result in scores if result.outcome.startswith("pass")]
    without = sum(result.hand_error_tolerance is None and result.clamped_error_tolerance is None for result in passed)
    warned = sum(result.passed for result in scores) - len(passed)
    share = f"{len(passed)} of {len(scores)} pass" + f", {warned} with targets out of reach" * bool(warned)
    share += f", {without} of them without a tolerance, by bits, flags and norms" if without else ""
    caption = (
        f"{share}\nhand: largest hand error / reach, at target; {EXPLAINED}; clamped: largest error "
        "of targets out of reach; angle: of shoulder or elbow (rad); bits: differing from the bit-true model"
    )
    headings = ("trajectory", "hand", "at", "tolerance", "predicted", "clamped", "angle", "bits", "flags", "")
    table = empty_table(title, headings, caption=caption, padding=0)
    for result in scores:
        hand = error(result.hand_error_max), form(result.hand_error_target), form(result.hand_error_tolerance, "{:.3g}")
        others = map(error, (result.hand_error_predicted, result.clamped_error_max, result.angle_error_max))
        counts = str(result.bit_mismatches), str(result.flagged)
        table.add_row(escape(result.trajectory), *hand, *others, *counts, _verdict(result))
    return table


def of_chip(luts: int) -> str:
    """Format a number of LUT4 as a percentage of those in the paper's chip."""
    return f"{luts / CHIP_LUTS:.0%}"


def _times(targets: int, us: float) -> str:
    return f"{SOFTWARE_US / TARGETS * targets / us:.0f}"


def _paper(targets: int) -> dict[str, str]:
    """Return a dict: name of a table row -> the paper's figure, with times computed for `targets` targets."""
    us = FIRST_US + targets / MHZ
    rows = {"LUT4": f"~{LUTS}", PART: of_chip(LUTS), "18x18 multipliers": "-", "clock (MHz)": str(MHZ), RATE: "1"}
    rows |= {LATENCY: f"~{STAGES}", CLOCKS: "-"}
    return rows | {FIRST: f"{FIRST_US:g}", ALL: f"{us:g}", TIMES: _times(targets, us)}


def _core(result: Score, flags: np.ndarray, more: Sequence[tuple[str, ...]], data: dict) -> dict[str, str]:
    """Return the rows of :func:`_paper` for a simulated run, and the rows ``more``. data: figures of `make fpga`."""
    datapath, width = result.datapath, result.width
    cells, family = size(data, datapath, width)
    rows = {name: value for name, value, *_ in (*figures(result, flags), *more) if not name.startswith(" ")}
    if cells:
        rows |= {"LUT4": str(cells["LUT"]), "18x18 multipliers": str(cells["multipliers"])}
        if family == "xc2vp":
            rows[PART] = of_chip(cells["LUT"])
    if find(datapath, width) and (mhz := clock(data, datapath, width)):
        us = result.total_cycles / mhz
        rows |= {"clock (MHz)": f"{mhz:.0f}", FIRST: f"{result.latency_cycles / mhz:.2f}", ALL: f"{us:.2f}"}
        rows[TIMES] = _times(result.targets, us)
    return rows


def table_of_datapaths(done: Sequence[tuple[Score, np.ndarray, Sequence[tuple[str, ...]]]]) -> Table:
    """Return a table with a column for the paper and one for each run of a trajectory. done: for each run, its
    score, flags (N,) and further table rows."""
    first, data = done[0][0], load()
    chips = {result.datapath: CHIPS.get(size(data, result.datapath, result.width)[1]) for result, *_ in done}
    small = [f"{name}: {chip[1]} and clock of an {chip[0]}." for name, chip in chips.items() if chip]
    title = f"{escape(first.trajectory)}: {first.targets} targets, {first.width} bits, {first.simulator}, next to "
    caption = "\n".join([*(f"{result.datapath}: {outcome(result)}" for result, *_ in done), SOURCES, *small])
    columns = {"the paper": _paper(first.targets)} | {one[0].datapath: _core(*one, data) for one in done}
    headings = "figure", *columns
    table = empty_table(f"{title}tables 5 and 6 of the paper", headings, caption=caption, padding=(0, 1, 0, 0))
    table.columns[0].no_wrap = False
    for name in dict.fromkeys(name for rows in columns.values() for name in rows):
        table.add_row(name, *(rows.get(name, "-") for rows in columns.values()), end_section=name == TIMES)
    return table


def verdict(name: str, scores: Sequence[Score]) -> int:
    """Print the failures on stderr; return the exit status, 0 or 1. Each line begins with `name`, the command, followed
    by the datapath if the scores are of several datapaths."""
    several = len({result.datapath for result in scores}) > 1
    for result in scores:
        of = f", {result.datapath} datapath" if several else ""
        for failure in result.failures:
            print(f"{name}{of}: {result.trajectory} fails: {failure}", file=sys.stderr)
    return 0 if all(result.passed for result in scores) else 1


def table_of_soak(what: str, core: Core, totals: Found, rate: float) -> Table:
    """Return the table of a soak. `totals` counts only targets that passed, so the number of wrong bits is 0."""
    most, norm = tolerances.hand(core.width, core.datapath), tolerances.norm(core.width, core.datapath)
    ratio = totals.by_hand[0].hardness if totals.by_hand else 0.0
    table = empty_table(f"soak: {what}", ("figure", "measured", "tolerance"))
    table.add_row("targets", str(totals.targets))
    table.add_row("of them in reach", str(totals.reachable))
    table.add_row("bits that differ from the bit-true model", "0", "0")
    permitted = "none" if most is None else f"{most:.2e}"
    table.add_row(f"{MODELS[core.datapath].error}, largest", f"{totals.hand_error_max:.2e}", permitted)
    divisor, permitted = ("tolerance", "1") if most else ("prediction", "")
    table.add_row(f"hand error / {divisor}, largest", f"{ratio:.3f}", permitted)
    if not most:
        table.add_row("targets seen above their prediction", str(totals.above))
    table.add_row("abs(norm^2 - 1) of Qs and Qe, largest", f"{totals.norm_error_max:.2e}", f"{norm:.2e}")
    table.add_row("targets a second, build excluded", f"{rate:.0f}")
    return table

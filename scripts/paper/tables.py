# SPDX-License-Identifier: Apache-2.0
"""Figures of the paper's tables 5 and 6, and the table in which `make run` compares datapaths with them."""

from collections.abc import Sequence

import numpy as np
from rich.markup import escape
from rich.table import Table

from model.io.scoring import Score
from scripts.fpga.designs import CHIPS, clock, find, load, size
from scripts.score_tables import CLOCKS, LATENCY, RATE, empty_table, figures, outcome

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


def of_chip(luts: int) -> str:
    """Format a number of LUT4 as a percentage of the paper's chip."""
    return f"{luts / CHIP_LUTS:.0%}"


def _times(targets: int, us: float) -> str:
    return f"{SOFTWARE_US / TARGETS * targets / us:.0f}"


def _paper(targets: int) -> dict[str, str]:
    """Return a dict: row of the table -> the paper's figure, with times for a number of targets."""
    us = FIRST_US + targets / MHZ
    rows = {"LUT4": f"~{LUTS}", PART: of_chip(LUTS), "18x18 multipliers": "-", "clock (MHz)": str(MHZ), RATE: "1"}
    rows |= {LATENCY: f"~{STAGES}", CLOCKS: "-"}
    return rows | {FIRST: f"{FIRST_US:g}", ALL: f"{us:g}", TIMES: _times(targets, us)}


def _core(result: Score, flags: np.ndarray, more: Sequence[tuple[str, ...]], data: dict) -> dict[str, str]:
    """Return the same rows as :func:`_paper` and ``more``, for a simulated run. data: the figures of `make fpga`."""
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
    """Return a table of the paper's figures and of runs of one trajectory. done: (score, flags (N,), more rows) of each
    run."""
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

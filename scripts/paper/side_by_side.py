# SPDX-License-Identifier: Apache-2.0
"""Several datapaths on one trajectory, compared with tables 5 and 6 of the paper; printed by `make run`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from model.io.scoring import Score
from scripts.fpga.designs import CHIPS, clock, find, load, size
from scripts.paper import tables
from scripts.tables import CLOCKS, LATENCY, RATE, figures, outcome

LUTS, PART, MULTIPLIERS, CLOCK = "LUT4", f"  of the {tables.CHIP}'s", "18x18 multipliers", "clock (MHz)"
FIRST, ALL, TIMES = "until the first result (us)", "until the last (us)", "times the paper's software"

SAID = {
    LUTS: f"~{tables.LUTS}",
    PART: tables.of_chip(tables.LUTS),
    MULTIPLIERS: "-",
    CLOCK: str(tables.MHZ),
    RATE: "1",
    LATENCY: f"~{tables.LATENCY}",
    CLOCKS: "-",
}
"""Table 5 of the paper; the rows of table 6 follow it."""

SOURCES = (
    f"LUT4, multipliers (the {tables.CHIP} has {tables.CHIP_MULTIPLIERS}) and clock are from `make fpga`, "
    "docs/generated/fpga.md; clocks and errors were counted in this run. The paper's software takes "
    f"{tables.SOFTWARE_US:.0f} us for {tables.TARGETS} targets."
)


def _said(targets: int) -> dict[str, str]:
    """Return the figures of tables 5 and 6 of the paper, with times for a number of targets."""
    total = tables.FIRST_US + targets / tables.MHZ
    return SAID | {FIRST: f"{tables.FIRST_US:g}", ALL: f"{total:g}", TIMES: _times(targets, total)}


def _times(targets: int, us: float) -> str:
    return f"{tables.SOFTWARE_US / tables.TARGETS * targets / us:.0f}"


def _ours(result: Score, flags: np.ndarray, data: dict) -> dict[str, str]:
    """Return the same rows for a run of the core. data: the figures of `make fpga`."""
    datapath, width = result.datapath, result.width
    cells, family = size(data, datapath, width)
    mhz = clock(data, datapath, width) if find(datapath, width) else None
    rows = {name: value for name, value, *_ in figures(result, flags) if not name.startswith(" ")}
    if cells:
        rows |= {LUTS: str(cells["LUT"]), MULTIPLIERS: str(cells["multipliers"])}
        if family == "xc2vp":
            rows[PART] = tables.of_chip(cells["LUT"])
    if mhz:
        total = result.total_cycles / mhz
        rows |= {CLOCK: f"{mhz:.0f}", FIRST: f"{result.latency_cycles / mhz:.2f}", ALL: f"{total:.2f}"}
        rows[TIMES] = _times(result.targets, total)
    return rows


def table_beside_the_paper(done: Sequence[tuple[Score, np.ndarray]]) -> Table:
    """Return a table of runs of one trajectory, with their flag bits (N,), next to the paper's figures."""
    first, data = done[0][0], load()
    families = {result.datapath: size(data, result.datapath, result.width)[1] for result, _ in done}
    chips = {name: CHIPS[family] for name, family in families.items() if family in CHIPS}
    small = [f"{name}: {logic} and clock of an {chip}." for name, (chip, logic) in chips.items()]
    table = Table(
        title=f"{escape(first.trajectory)}: {first.targets} targets, {first.width} bits, {first.simulator}, "
        "beside tables 5 and 6 of the paper",
        caption="\n".join([*(f"{result.datapath}: {outcome(result)}" for result, _ in done), SOURCES, *small]),
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        title_justify="left",
        caption_justify="left",
    )
    table.add_column("figure")
    columns = [_said(first.targets), *(_ours(result, flags, data) for result, flags in done)]
    for heading in ("the paper", *(result.datapath for result, _ in done)):
        table.add_column(heading, justify="right", no_wrap=True)
    for name in dict.fromkeys(name for rows in columns for name in rows):
        table.add_row(name, *(rows.get(name, "-") for rows in columns), end_section=name == TIMES)
    return table

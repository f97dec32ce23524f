# SPDX-License-Identifier: Apache-2.0
"""Both datapaths beside tables 5 and 6 of the paper: what `make run` prints of them on one trajectory."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from model.targets.scoring import Score
from scripts import published
from scripts.fpga.page import FIGURES, clock, synthesized
from scripts.tables import CLOCKS, LATENCY, RATE, figures, outcome

LUTS, PART, MULTIPLIERS, CLOCK = "LUT4", f"  of the {published.CHIP}'s", "18x18 multipliers", "clock (MHz)"
FIRST, ALL, TIMES = "until the first result (us)", "until the last (us)", "times the paper's software"

SAID = {
    LUTS: f"~{published.LUTS}",
    PART: published.of_chip(published.LUTS),
    MULTIPLIERS: "-",
    CLOCK: str(published.MHZ),
    RATE: "1",
    LATENCY: f"~{published.LATENCY}",
    CLOCKS: "-",
}
"""Table 5 of the paper; the rows of table 6 follow it."""

SOURCES = (
    f"LUT4, multipliers (the {published.CHIP} has {published.CHIP_MULTIPLIERS}) and clock are those of `make fpga`, "
    "docs/generated/fpga.md; clocks and errors were counted in this run. The paper's software takes "
    f"{published.SOFTWARE_US:.0f} us for {published.TARGETS} targets."
)


def _said(targets: int) -> dict[str, str]:
    """Tables 5 and 6 of the paper, the times for so many targets."""
    total = published.FIRST_US + targets / published.MHZ
    return SAID | {FIRST: f"{published.FIRST_US:g}", ALL: f"{total:g}", TIMES: _times(targets, total)}


def _times(targets: int, us: float) -> str:
    return f"{published.SOFTWARE_US / published.TARGETS * targets / us:.0f}"


def _ours(result: Score, flags: np.ndarray, data: dict) -> dict[str, str]:
    """The same rows of a run and its figures; `data`: what `make fpga` has measured."""
    mhz = clock(data, result.datapath, result.width)
    synthesis = synthesized(data, result.datapath, result.width, "xc2vp")
    rows = {name: value for name, value, *_ in figures(result, flags) if not name.startswith(" ")}
    if synthesis:
        cells = synthesis["cells"]
        luts, multipliers = cells["LUT"], cells["multipliers"]
        rows |= {LUTS: str(luts), PART: published.of_chip(luts), MULTIPLIERS: str(multipliers)}
    if mhz:
        total = result.total_cycles / mhz
        rows |= {CLOCK: f"{mhz:.0f}", FIRST: f"{result.latency_cycles / mhz:.2f}", ALL: f"{total:.2f}"}
        rows[TIMES] = _times(result.targets, total)
    return rows


def table_beside_the_paper(done: Sequence[tuple[Score, np.ndarray]]) -> Table:
    """Runs of one trajectory by several datapaths, with their flag bits (N,), in columns beside the paper's figures."""
    first, data = done[0][0], json.loads(FIGURES.read_text(encoding="utf-8"))
    table = Table(
        title=f"{escape(first.trajectory)}: {first.targets} targets, {first.width} bits, {first.simulator}, "
        "beside tables 5 and 6 of the paper",
        caption="\n".join([*(f"{result.datapath}: {outcome(result)}" for result, _ in done), SOURCES]),
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

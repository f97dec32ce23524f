# SPDX-License-Identifier: Apache-2.0
"""Page of table6.json: throughput, latency and accuracy of software and of the core."""

from collections.abc import Iterator
from typing import Any

from scripts.fpga.designs import clock
from scripts.generate.render import error, render
from scripts.paper import tables

QUOTED = (
    ("the paper, software on its CPU", tables.SOFTWARE_US, None),
    ("the paper, pipeline at 100 MHz", tables.ALL_US, 1000 * tables.FIRST_US),
    ("the same group later, 363 stages at 100 MHz", 4.63, 3630.0),
)
"""Name, us for 100 targets, ns until the first result: table 6 of the paper; times computed from the 363 stages and
100 MHz in its authors' chapter in Geometric Algebra Computing (Springer, 2010)."""

STREAMS = "stream to stream"
"""Path through the logic around the datapath of `ik_axis`; `ik_axi` has the other one, memory to memory."""

BUSY = 0.3  # load per processor core above which the page warns that the computer was busy


def clock_of(fpga: dict, row: dict) -> float:
    """Return the clock of a hardware row (MHz); memory to memory: the slower of datapath and ``ik_axi``."""
    datapath = clock(fpga, row["datapath"], row["width"])
    return datapath if row["path"] == STREAMS else min(datapath, clock(fpga, "echo", 32))


def number(value: float) -> str:
    """Format with three digits and no exponent."""
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def ratio(value: float) -> str:
    """Format a ratio, with two digits below 10."""
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def _times(group: str, name: str, us: float, *others: Any) -> tuple:
    """Return a row: time for the targets of `reach`, the paper's software relative to it, other cells."""
    return group, name, number(us), ratio(tables.SOFTWARE_US / us), *(others or "----")


def _software(figures: dict) -> Iterator[tuple]:
    for row in figures["software"]:
        name = ", ".join(filter(None, (row["name"], row.get("date"))))
        if "lacks" in row:
            yield row["group"], name, row["lacks"], *"-----"
            continue
        reach, random = row["reach"], row["random"]
        ns = number(random["ns"])
        yield _times(
            row["group"],
            name,
            reach["ns"] * tables.TARGETS / 1000,
            ns if random["targets"] == figures["targets"] else f"{ns} ({random['targets']} targets)",
            error(reach["error"]),
            error(random["error"]),
            reach["unanswered"] + random["unanswered"],
        )


def _hardware(figures: dict, fpga: dict) -> Iterator[tuple]:
    for row in figures["hardware"]:
        mhz = clock_of(fpga, row)
        name = f"`{row['datapath']}`, W = {row['width']}, {mhz:.0f} MHz, {row['path']}"
        errors = error(row["reach_error"]), error(row["random_error"])
        yield _times("this core", name, row["last"] / mhz, number(1000 * row["each"] / mhz), *errors, 0)


def _waits(figures: dict, fpga: dict) -> Iterator[list[str]]:
    """Yield rows with the nanoseconds from a target to its result."""
    for name, _, first in QUOTED:
        if first:
            yield [f"{name} (quoted)", number(first)]
    for row in figures["software"]:
        if row["key"].startswith("c-") and row["key"].endswith("-chain"):
            yield [f"C, {row['name']}", number(row["reach"]["ns"])]
    for row in figures["hardware"]:
        yield [f"this core, `{row['datapath']}`, {row['path']}", number(1000 * row["first"] / clock_of(fpga, row))]


def page(figures: dict, fpga: dict) -> str:
    """Return table6.md."""
    machine = figures["machine"]
    quoted = (_times("quoted", name, us) for name, us, _ in QUOTED)
    found = {"rows": [*quoted, *_software(figures), *_hardware(figures, fpga)], "waits": list(_waits(figures, fpga))}
    found["c_unanswered"] = [r for r in figures["software"] if r["key"][:2] == "c-" and r["random"]["unanswered"]]
    found |= {"busy": machine["load"] > BUSY * machine["cores"], "memory_mhz": clock(fpga, "echo", 32)}
    return render("table6", figures=figures, machine=machine, batch=tables.TARGETS, number=number, **found)

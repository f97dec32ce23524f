# SPDX-License-Identifier: Apache-2.0
"""The page of table6.json: the table, what it shows, and what lies past one chip. Every comparison is computed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from scripts.fpga.page import clock, memory_clock
from scripts.generate.render import error, render
from scripts.paper import tables
from scripts.paper.table6 import limits
from scripts.paper.table6.hardware import STREAMS

QUOTED = (
    ("the paper, software on its CPU", tables.SOFTWARE_US, None),
    ("the paper, pipeline at 100 MHz", tables.ALL_US, 1000 * tables.FIRST_US),
    ("the same group later, 363 stages at 100 MHz", 4.63, 3630.0),
)
"""What, us for 100 targets, ns until the first answer: table 6 of the paper; 363 stages and 100 MHz of its authors'
chapter in Geometric Algebra Computing (Springer, 2010), the times computed from them."""

BUSY = 0.3
"""Load a core above which the page says that the machine was not quiet."""


def mhz(fpga: dict, datapath: str, width: int) -> float:
    """The clock of a datapath, as on the page of `make fpga`."""
    found = clock(fpga, datapath, width)
    if found is None:
        raise ValueError(f"fpga.json has no clock of {datapath}, W = {width}")
    return found


def clock_of(fpga: dict, row: dict) -> float:
    """The clock of a row of the hardware: from memory to memory the slower one of datapath and ``ik_axi``."""
    datapath = mhz(fpga, row["datapath"], row["width"])
    return datapath if row["path"] == STREAMS else min(datapath, memory_clock(fpga) or datapath)


def number(value: float) -> str:
    """Three digits, without an exponent."""
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def ratio(value: float) -> str:
    """How many times; two digits below 10."""
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def compared(one: float, other: float) -> str:
    """How the time `one` is to the time `other`, in words."""
    if abs(one - other) <= 0.05 * other:
        return "as long as"
    return f"{ratio(other / one)} times less than" if one < other else f"{ratio(one / other)} times as long as"


def _quoted() -> Iterator[list[str]]:
    for name, total, _ in QUOTED:
        yield ["quoted", name, number(total), ratio(tables.SOFTWARE_US / total), "-", "-", "-", "-"]


def _software(figures: dict) -> Iterator[list[str]]:
    for row in figures["software"]:
        if "lacks" in row:
            yield [row["group"], row["name"], row["lacks"], "-", "-", "-", "-", "-"]
            continue
        reach, random = row["reach"], row["random"]
        total = reach["ns"] * tables.TARGETS / 1000
        ns = number(random["ns"])
        yield [
            row["group"], row["name"], number(total), ratio(tables.SOFTWARE_US / total),
            ns if random["targets"] == figures["targets"] else f"{ns} ({random['targets']} targets)",
            error(reach["error"]), error(random["error"]), reach["unanswered"] + random["unanswered"],
        ]  # fmt: skip


def _hardware(figures: dict, fpga: dict) -> Iterator[list[str]]:
    for row in figures["hardware"]:
        clock = clock_of(fpga, row)
        total = row["last"] / clock
        yield [
            "this core", f"`{row['datapath']}`, W = {row['width']}, {clock:.0f} MHz, {row['path']}", number(total),
            ratio(tables.SOFTWARE_US / total), number(1000 * row["each"] / clock), error(row["reach_error"]),
            error(row["random_error"]), 0,
        ]  # fmt: skip


def core_of(figures: dict, fpga: dict, datapath: str) -> dict[str, float]:
    """The core from stream to stream: ns an answer, ns until the first one, us for the paper's batch, clocks,
    errors."""
    row = next(r for r in figures["hardware"] if r["datapath"] == datapath and r["path"] == STREAMS)
    clock = mhz(fpga, datapath, row["width"])
    return {
        "ns": 1000 / clock, "first": 1000 * row["first"] / clock, "us": row["last"] / clock, "mhz": clock,
        "clocks": row["first"], "error": row["random_error"], "width": row["width"],
    }  # fmt: skip


def _waits(figures: dict, fpga: dict) -> Iterator[list[str]]:
    """ns from a target to its answer."""
    for name, _, first in QUOTED:
        if first:
            yield [f"{name} (quoted)", number(first)]
    for row in figures["software"]:
        if row["key"].startswith("c-") and row["key"].endswith("-chain"):
            yield [f"C, {row['name']}", number(row["reach"]["ns"])]
    for row in figures["hardware"]:
        clock = clock_of(fpga, row)
        yield [f"this core, `{row['datapath']}`, {row['path']}", number(1000 * row["first"] / clock)]


def _chips(takes: dict[str, int], clock: float) -> Iterator[list[str]]:
    for chip in limits.CHIPS:
        count, least = limits.lanes(chip, takes)
        holds = {"LUT": chip.luts, "FF": chip.flip_flops, "multipliers": chip.multipliers, "RAM": chip.memories}[least]
        yield [
            chip.name, chip.luts, chip.multipliers, least,
            f"{limits.FILLED} x {holds} / {takes[least]} = {count}",
            f"{count} x {clock:.0f} M = {count * clock / 1000:.1f} G", chip.source,
        ]  # fmt: skip


def _roads(clock: float) -> Iterator[list[str]]:
    size = limits.TARGET_BYTES + limits.RESULT_BYTES
    for road in limits.ROADS:
        each = size if road.both else limits.TARGET_BYTES
        yield [
            f"{road.name}, {road.what}", f"{road.bytes_per_second / 1e9:.1f}", f"{each}", f"{road.poses / 1e6:.0f} M",
            f"{road.poses / (clock * 1e6):.1f}", f"{limits.POSES / road.poses:.2f}", road.source,
        ]  # fmt: skip


def _bounds(takes: dict[str, int], clock: float) -> Iterator[dict[str, Any]]:
    """For each chip and road what binds."""
    for chip in limits.CHIPS:
        made = limits.lanes(chip, takes)[0] * clock * 1e6
        for road in (road for road in limits.ROADS if road.name in chip.roads):
            rate = min(made, road.poses)
            binds = "the lanes" if made <= road.poses else road.name
            yield {"chip": chip.name, "road": road.name, "rate": rate, "binds": binds, "seconds": limits.POSES / rate}


def _times(figures: dict, takes: dict[str, int], clock: float) -> Iterator[list[str]]:
    best = fastest(figures, "c-")
    yield [f"this CPU, one thread of C: {best['name']} (measured)", "", f"{1e3 / best['random']['ns']:.0f} M",
           f"{best['random']['ns'] * limits.POSES / 1e9:.2f}"]  # fmt: skip
    yield ["one lane, stream to stream", "its clock", f"{clock:.0f} M", f"{limits.POSES / (clock * 1e6):.2f}"]
    for one in _bounds(takes, clock):
        name = f"{one['chip']}, targets by {one['road']}"
        yield [name, one["binds"], f"{one['rate'] / 1e6:.0f} M", f"{one['seconds']:.2f}"]
    yield ["a GPU (quoted)", "", f"{limits.GPU / 1e6:.0f} M", f"{limits.POSES / limits.GPU:.2f}"]


def fastest(figures: dict, prefix: str) -> dict:
    """The software with the least time a random target, of those whose key starts so."""
    found = [row for row in figures["software"] if row["key"].startswith(prefix) and "lacks" not in row]
    return min(found, key=lambda row: row["random"]["ns"])


def named(figures: dict, key: str) -> dict:
    """A row of software."""
    return next(row for row in figures["software"] if row["key"] == key)


def page(figures: dict, fpga: dict) -> str:
    """table6.md."""
    lean, paper = (core_of(figures, fpga, datapath) for datapath in ("lean", "paper"))
    takes, clock = limits.lane(fpga), mhz(fpga, "lean", 32)
    bounds = list(_bounds(takes, clock))
    return render(
        "table6",
        figures=figures,
        machine=figures["machine"],
        busy=figures["machine"]["load"] > BUSY * figures["machine"]["cores"],
        rows=[*_quoted(), *_software(figures), *_hardware(figures, fpga)],
        waits=list(_waits(figures, fpga)),
        memory_mhz=memory_clock(fpga),
        batch=tables.TARGETS,
        lean=lean,
        paper=paper,
        vector={real: named(figures, f"c-lean-{real}-vector") for real in ("float", "double")},
        chain=named(figures, "c-lean-double-chain"),
        scalar=named(figures, "c-paper-double-batch"),
        paper_vector=named(figures, "c-paper-double-vector"),
        paper_ratio=ratio(tables.SOFTWARE_US / QUOTED[1][1]),
        fastest=fastest(figures, "c-"),
        c_unanswered=[r for r in figures["software"] if r["key"].startswith("c-") and r["random"]["unanswered"]],
        gpu=[r for r in figures["software"] if r["key"].startswith("jax-gpu") and "lacks" not in r],
        number=number,
        ratio=ratio,
        compared=compared,
        takes=takes,
        filled=limits.FILLED,
        size=limits.TARGET_BYTES + limits.RESULT_BYTES,
        chips=list(_chips(takes, clock)),
        roads=list(_roads(clock)),
        times=list(_times(figures, takes, clock)),
        gpu_rate=limits.GPU,
        best=max(bounds, key=lambda one: one["rate"]),
        by_road=sum(one["binds"] != "the lanes" for one in bounds),
        bounds=bounds,
    )

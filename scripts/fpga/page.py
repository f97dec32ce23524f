# SPDX-License-Identifier: Apache-2.0
"""Page fpga.md, made from fpga.json: our table 5, critical paths, logic by section."""

from __future__ import annotations

from functools import partial

from jinja2.environment import TemplateModule

from model.dataflow.datapaths import MODELS
from scripts.fpga.designs import CHIPS, FAMILIES, Design, clock, find, measured, run_of
from scripts.fpga.netlist import MULTIPLIER_NS, MULTIPLIERS
from scripts.generate.render import TEMPLATES
from scripts.paper import tables

BROKEN_DOWN = {"lean": (32, 18), "paper": (32,)}
"""Datapath -> word lengths at which logic is counted by section."""


def form(value: object, form: str = "{}") -> str:
    """Format a value; a dash for a missing one."""
    return "-" if value in (None, "") else form.format(value)


def clocks(figures: dict, digits: int = 0) -> str:
    return ", ".join(f"{mhz:.{digits}f}" for mhz in figures.get("tried", [])) or "-"


TEMPLATES.filters |= {"form": form, "clocks": clocks}


def page(data: dict) -> TemplateModule:
    """Return the page; its macros `comparison` and `folded` render single tables."""
    dates = sorted(run["date"] for run in data["runs"].values())

    def run(design: Design, family: str, kind: str = "synth") -> dict:
        return run_of(data, design.run(family, kind))

    def sources(*datapaths: str) -> str:
        """Return a text with the commit and digest of each datapath's measured code."""
        latest = {d.datapath: data["designs"][d.name] for d in measured(data, *datapaths)}
        return "; ".join(f"{name} as of commit `{of['commit']}`, sources `{of['rtl']}`" for name, of in latest.items())

    def column(design: Design) -> dict:
        """Return the figures of a design's column in table 5."""
        figures = {"head": f"{design.datapath}, W = {design.width}", **data["designs"][design.name]}
        figures |= {family: run(design, family).get("cells", {}) for family in FAMILIES}
        if figures["xc2vp"]:
            figures["share"] = f"{figures['xc2vp']['LUT']} ({tables.of_chip(figures['xc2vp']['LUT'])})"
        if mhz := clock(data, design.datapath, design.width):
            figures |= {"mhz": mhz, "ns": 1000 * figures["latency"] / mhz, "us": (figures["latency"] + 100) / mhz}
        return figures

    values = {
        "data": data,
        "run": run,
        "measured": partial(measured, data),
        "sources": sources,
        "dates": " to ".join(sorted({dates[0], dates[-1]})),
        "tools": ", ".join(f"{name} {number}" for name, number in data["tools"].items()),
        "columns": [
            column(d) for of in ("paper", "lean", "lean25") for d in sorted(measured(data, of), key=lambda d: -d.width)
        ],
        "chips": CHIPS,
        "chip": tables,
        "models": MODELS,
        "broken": [find(name, width) for name, widths in BROKEN_DOWN.items() for width in widths],
        "multipliers": MULTIPLIERS,
        "multiplier_ns": MULTIPLIER_NS,
        "multiplier_mhz": f"{1000 / MULTIPLIER_NS:.0f}",
        "aim": {"paper": find("paper", 18).aims["ecp5"], **{f"w{w}": find("lean", w).aims["ecp5"] for w in (18, 32)}},
    }
    return TEMPLATES.get_template("fpga.md.j2").make_module(values)

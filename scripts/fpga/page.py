# SPDX-License-Identifier: Apache-2.0
"""The page made from fpga.json: our table 5, critical paths, breakdown of the logic."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from model.dataflow.datapaths import MODELS
from scripts.fpga.designs import CHIPS, Design, clock, find, measured, run_of
from scripts.fpga.netlist import HOLDS, KINDS, MULTIPLIER_NS
from scripts.generate.render import render, table
from scripts.paper import tables

BROKEN_DOWN = {"lean": (32, 18)}
"""Datapath -> widths whose logic is counted by section."""

CELLS = {
    "xc2vp": ("LUT4 on xc2vp", "of them SRL16", "flip-flops", "carry bits (MUXCY)", "MULT18X18", "RAMB16"),
    "xc7": ("LUT6 on xc7", "of them SRL", "flip-flops", "CARRY4", "DSP48E1", "RAMB18"),
    "xcup": ("LUT6 on xcup", "of them SRL", "flip-flops", "CARRY4 (xcup)", "DSP48E2", "RAMB18 (xcup)"),
    "ecp5": ("LUT4 on ECP5", "", "flip-flops", "CCU2C", "MULT18X18D", "DP16KD"),
}
"""Family -> names of its LUTs, shift registers, flip-flops, carry cells, multipliers and memories."""

PAPER_TABLE = {
    "LUT4 on xc2vp": f"~{tables.LUTS} ({tables.of_chip(tables.LUTS)})",
    "clock (MHz)": f"{tables.MHZ}",
    "latency (clocks)": f"~{tables.STAGES}",
    "latency (ns)": f"{1000 * tables.STAGES / tables.MHZ:.0f}",
    "100 targets (us)": f"{tables.ALL_US:.0f}",
    "results a clock": "1",
}
"""Tables 5 and 6 of the paper: the Virtex-II Pro 2VP70, Xilinx ISE and Core Generator."""


def _form(value: object, form: str = "{}") -> str:
    """Format a value; a dash for a missing one."""
    return "-" if value in (None, "") else form.format(value)


def _clocks(figures: dict, digits: int = 0) -> str:
    return ", ".join(f"{mhz:.{digits}f}" for mhz in figures.get("tried", [])) or "-"


def comparison(data: dict) -> str:
    """Return the table with the paper's figures next to ours."""
    order = ("paper", "lean", "lean25")
    designs = sorted(measured(data, *order), key=lambda d: (order.index(d.datapath), -d.width))
    rows: list[list] = []

    def put(label: str, values: Iterable, form: str = "{}") -> None:
        cells = [_form(value, form) for value in values]
        if set(cells) != {"-"}:
            rows.append([label, PAPER_TABLE.get(label, "-"), *cells])

    for family, names in CELLS.items():
        found = [run_of(data, d.run(family)).get("cells", {}) for d in designs]
        for kind, name in zip(("LUT", "shift", "FF", "carry", "multipliers", "RAM"), names, strict=True):
            values = [cells.get(kind) for cells in found]
            if kind == "LUT" and family == "xc2vp":
                values = [n and f"{n} ({tables.of_chip(n)})" for n in values]
            if name:
                put(f"{name} ({family})" if kind in ("shift", "FF") else name, values)
    facts = [data["designs"][d.name] for d in designs]
    mhz = [clock(data, d.datapath, d.width) for d in designs]
    both = list(zip(facts, mhz, strict=True))
    put("clock (MHz)", mhz, "{:.0f}")
    put("latency (clocks)", [d["latency"] for d in facts])
    put("latency (ns)", [m and 1000 * d["latency"] / m for d, m in both], "{:.0f}")
    put("100 targets (us)", [m and (d["latency"] + 100) / m for d, m in both], "{:.2f}")
    put("results a clock", [1] * len(designs))
    put("largest hand error / reach", [d["hand"] for d in facts], "{:.1e}")
    return table(["", "the paper, table 5", *(f"{d.datapath}, W = {d.width}" for d in designs)], rows)


def memory(data: dict) -> str:
    """Return the table of ``ik_axi``."""
    rows = []
    for design in measured(data, "echo", "memory"):
        cells = [run_of(data, design.run(family)).get("cells", {}) for family in ("xc2vp", "xc7", "ecp5")]
        placed = run_of(data, design.run("ecp5", "place"))
        what = "an echo instead of the datapath" if design.datapath == "echo" else "`lean`"
        sizes = [each.get(kind) for kind in ("LUT", "FF") for each in cells]
        sizes += [cells[-1].get(kind) for kind in ("RAM", "multipliers")]
        clocks = [_form(placed.get("mhz"), "{:.0f}"), _clocks(placed)]
        rows.append([f"W = {design.width}, {what}", *map(_form, sizes), *clocks])
    head = ["`ik_axi`, 64 bits of data", "LUT4 on xc2vp", "LUT6 on xc7", "LUT4 on ECP5"]
    head += ["flip-flops: xc2vp", "xc7", "ECP5", "DP16KD", "MULT18X18D", "MHz on ECP5", "seeds"]
    return table(head, rows)


def folded(data: dict) -> str:
    """Return the table of the folded datapaths."""
    rows = []
    for family, (chip, logic) in CHIPS.items():
        designs = measured(data, "fold16", "fold", "fold_arm16", "fold_arm")
        for design in (one for one in designs if family in one.families):
            run, placed = (run_of(data, design.run(family, kind)) for kind in ("synth", "place"))
            if not run:
                continue
            cells, facts, path = run["cells"], data["designs"][design.name], MODELS[design.datapath]
            mhz, critical, period = placed.get("mhz"), placed.get("path", {}), path.lap(design.width)
            rows.append([
                f"`{path.top}` on {chip}, W = {design.width}", f"`{design.datapath}`", period, facts["latency"],
                _form(facts.get("hand"), "{:.1e}"),
                f"{cells['LUT']} {logic}", cells["FF"], cells["multipliers"], cells["RAM"], _form(mhz, "{:.1f}"),
                _form(mhz and period / mhz, "{:.2f}"), _form(mhz and (facts["latency"] + 99 * period) / mhz, "{:.0f}"),
                *(_form(critical.get(end), "`{}`") for end in ("from", "to")), _clocks(placed, 1),
            ])  # fmt: skip
    head = ["core", "`DATAPATH`", "clocks a target", "latency (clocks)", "largest hand error / reach", "logic"]
    head += ["flip-flops", "multipliers", "memories", "MHz", "us a target", "100 targets (us)", "from", "to", "seeds"]
    return table(head, rows)


def breakdown(data: dict, design: Design) -> dict:
    """Return the table of a datapath's logic by section."""
    tree = run_of(data, design.run("xc2vp", "tree"))
    names = ["LUT4", "of them SRL16", "flip-flops", "carry", "MUXF", "MULT18X18", "RAMB16"]

    def row(name: str, cells: dict) -> list:
        return [name, *(cells[kind] for kind in KINDS)]

    sections = [row(f"`{name}`", cells) for name, cells in tree["sections"].items() if name != "itself"]
    sections.sort(key=lambda cells: -cells[1])
    return {
        "datapath": design.datapath,
        "width": design.width,
        "flat": run_of(data, design.run("xc2vp"))["cells"],
        "sections": table(["section", *names], [*sections, row("outside them", tree["sections"]["itself"])]),
    }


def critical(data: dict) -> str:
    """Return the table of each placement's slowest path."""
    rows = []
    for design in measured(data, "lean", "paper"):
        if found := run_of(data, design.run("ecp5", "place")):
            path = found["path"]
            rows.append([
                f"{design.datapath} {design.width}", f"{found['mhz']:.0f}", f"`{path['from']}`",
                f"`{path['to']}`", ", ".join(path["through"]), f"{path['ns']:.2f}", f"{path['routing_ns']:.2f}",
                found["used"].get("MULT18X18D", 0), _clocks(found), found["place_s"],
            ])  # fmt: skip
    head = ["design", "MHz", "from", "to", "through", "ns", "of it routing", "multipliers", "seeds", "s"]
    return table(head, rows)


def sources(data: dict, designs: Sequence[Design]) -> str:
    """Return commit and digest of the measured code, each datapath once."""
    found = {d.datapath: data["designs"][d.name] for d in designs}
    return "; ".join(f"{name} as of commit `{of['commit']}`, sources `{of['rtl']}`" for name, of in found.items())


def page(data: dict) -> str:
    dates = sorted(run["date"] for run in data["runs"].values())
    broken = [find(name, width) for name, widths in BROKEN_DOWN.items() for width in widths]
    return render(
        "fpga",
        dates=" to ".join(sorted({dates[0], dates[-1]})),
        tools=", ".join(f"{name} {number}" for name, number in data["tools"].items()),
        rtl=sources(data, measured(data, "lean", "lean25", "paper")),
        comparison=comparison(data),
        chip=tables,
        multipliers=HOLDS["MULT18X18D"],
        multiplier_ns=MULTIPLIER_NS,
        multiplier_mhz=f"{1000 / MULTIPLIER_NS:.0f}",
        aim={"paper": find("paper", 18).aims["ecp5"], **{f"w{w}": find("lean", w).aims["ecp5"] for w in (18, 32)}},
        critical=critical(data),
        memory=memory(data),
        memory_code=sources(data, measured(data, "memory")),
        folded=folded(data),
        fold_code=sources(data, measured(data, "fold", "fold_arm")),
        tried=table(["change", "measured on", "before", "after"], data["tried"], left=4),
        parts=[breakdown(data, one) for one in broken if run_of(data, one.run("xc2vp", "tree"))],
        commands=data["commands"],
    )

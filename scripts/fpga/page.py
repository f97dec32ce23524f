# SPDX-License-Identifier: Apache-2.0
"""The page made from fpga.json: our table 5, critical paths, breakdown of the logic."""

from __future__ import annotations

from model.dataflow.datapaths import CONFIGURATIONS
from scripts.fpga.report import HOLDS, KINDS, MULTIPLIER_NS
from scripts.generate.render import render, table
from scripts.paper import tables
from tb.sim.env import GENERATED

FIGURES = GENERATED / "fpga.json"

DEVICE = "ECP5-85k, speed grade 8"

TOPS = {"lean": "ik_lean", "lean25": "ik_lean", "paper": "ik_paper"}
PARAMETERS = {"lean": {}, "lean25": {"TILE": 25}, "paper": {"DIGIT": 1}}
"""Parameters of each datapath besides its width; paper with the dividers and roots built from logic."""

SECTIONS = {
    "lean": ("ik_lean_guard", "ik_lean_direction", "ik_lean_triangle", "ik_lean_turn"),
    "paper": ("ik_guard", "ik_swivel", "ik_elbow", "ik_elbow_q", "ik_to_elbow", "ik_to_wrist"),
}

WHOLE_TOPS = {"memory": "ik_axi", "fold": "ik_axis"}
"""Tops with streams or memory ports, which have tables of their own."""

FOLD = (
    ("up5k", "fold16", 18),
    ("up5k", "fold16", 24),
    ("ecp5-12k", "fold", 24),
    ("ecp5-12k", "fold", 32),
    ("xc7", "fold", 24),
    ("xc7", "fold", 32),
    ("gowin", "fold", 24),
    ("gowin", "fold", 32),
)
"""Chip, configuration and word length of the fold datapath."""

FOLD_MHZ = {"up5k": 33, "ecp5-12k": 100}
"""Placement aim (MHz) of each chip."""

CHIPS = {
    "up5k": ("iCE40 UP5K", "logic cells"),
    "ecp5-12k": ("ECP5-12k, speed grade 6", "LUT4"),
    "xc7": ("xc7", "LUT6"),
    "gowin": ("Gowin GW2A", "LUT4"),
}

MEMORY = ((32, True), (18, False), (32, False))
"""Word length, and whether an echo replaces the lean datapath."""

AIM_MHZ = {"lean": 200, "paper": 150}
"""Placement aim: clocks vary by a tenth between seeds, so seeds are tried until this is reached."""

BROKEN_DOWN = (32, 18)
"""Widths whose logic is counted module by module."""

PAPER_TABLE = {
    "LUT4 on xc2vp": f"~{tables.LUTS} ({tables.of_chip(tables.LUTS)})",
    "clock (MHz)": f"{tables.MHZ}",
    "latency (clocks)": f"~{tables.LATENCY}",
    "latency (ns)": f"{1000 * tables.LATENCY / tables.MHZ:.0f}",
    "100 targets (us)": f"{tables.ALL_US:.0f}",
    "results a clock": "1",
}
"""Tables 5 and 6 of the paper: the Virtex-II Pro 2VP70, Xilinx ISE and Core Generator."""


def place_runs(data: dict, datapath: str, width: int, modules: tuple[str, ...]) -> list[tuple[str, dict]]:
    """Return (module, figures) of each of the modules that was placed alone, or of the top, placed whole."""
    found: list[tuple[str, dict]] = []
    if datapath not in SECTIONS:  # only counted
        return found
    for module in modules:
        starts = f"{module.removeprefix('ik_')}-W{width}-"
        named = (name for name in data["runs"] if name.startswith(starts) and name.endswith("-ecp5-place"))
        found += [(module, data["runs"][name]) for name in named]
    return found


def slowest(data: dict, datapath: str, width: int, modules: tuple[str, ...]) -> float | None:
    """Return the lowest clock (MHz), None unless all modules were placed."""
    found = place_runs(data, datapath, width, modules)
    return min(run["mhz"] for _, run in found) if found and len(found) == len(modules) else None


def clock(data: dict, datapath: str, width: int) -> float | None:
    """Return the clock (MHz) of a datapath: placed whole if it fits the device, otherwise of its slowest module."""
    whole = slowest(data, datapath, width, (TOPS[datapath],))
    return whole or slowest(data, datapath, width, SECTIONS.get(datapath, ()))


def synthesized(data: dict, datapath: str, width: int, family: str, kind: str = "") -> dict | None:
    values = [f"{name}{value}" for name, value in {"W": width, **PARAMETERS[datapath]}.items()]
    return data["runs"].get("-".join([TOPS[datapath].removeprefix("ik_"), *values, family, *([kind] if kind else [])]))


def comparison(data: dict) -> str:
    """Return the table with the paper's figures next to ours."""
    columns = [(d, w) for d in ("paper", "lean", "lean25") for w in range(32, 15, -1) if f"{d}-{w}" in data["designs"]]
    rows = {}

    def put(label, values, paper="-"):
        if any(v is not None for v in values):
            rows[label] = [PAPER_TABLE.get(label, paper), *("-" if v is None else v for v in values)]

    words = {
        "xc2vp": ("LUT4 on xc2vp", "of them SRL16", "MULT18X18", "RAMB16", "flip-flops", "carry bits (MUXCY)"),
        "xc7": ("LUT6 on xc7", "of them SRL", "DSP48E1", "RAMB18", "flip-flops", "CARRY4"),
        "xcup": ("LUT6 on xcup", "of them SRL", "DSP48E2", "RAMB18 (xcup)", "flip-flops", "CARRY4 (xcup)"),
        "ecp5": ("LUT4 on ECP5", None, "MULT18X18D", "DP16KD", "flip-flops", "CCU2C"),
    }
    for family, (lut, shift, multiplier, memory, flops, carry) in words.items():
        got = [synthesized(data, d, w, family) for d, w in columns]

        def of(kind, got=got):
            return [r["cells"][kind] if r else None for r in got]

        luts = of("LUT")
        put(lut, [n and f"{n} ({tables.of_chip(n)})" for n in luts] if family == "xc2vp" else luts)
        if shift:
            put(f"{shift} ({family})", of("shift"))
        put(f"{flops} ({family})", of("FF"))
        put(f"{carry}", of("carry"))
        put(multiplier, of("multipliers"))
        put(memory, of("RAM"))
    designs = [data["designs"][f"{d}-{w}"] for d, w in columns]
    alone = [slowest(data, d, w, SECTIONS.get(d, ())) for d, w in columns]
    mhz = [clock(data, d, w) for d, w in columns]
    put("clock (MHz)", [m and f"{m:.0f}" for m in mhz])
    put("placed", [d.get("placed") for d in designs])
    put("slowest of its modules alone (MHz)", [m and f"{m:.0f}" for m in alone])
    put("latency (clocks)", [d["latency"] for d in designs])
    put("latency (ns)", [m and f"{1000 * d['latency'] / m:.0f}" for m, d in zip(mhz, designs, strict=True)])
    put("100 targets (us)", [m and f"{(d['latency'] + 100) / m:.2f}" for m, d in zip(mhz, designs, strict=True)])
    put("results a clock", ["1"] * len(columns))
    put("largest hand error / reach", [f"{d['hand']:.1e}" for d in designs])
    head = ["", "the paper, table 5", *(f"{d}, W = {w}" for d, w in columns)]
    return table(head, [[label, *cells] for label, cells in rows.items()])


def memory_clock(data: dict) -> float | None:
    """Return the clock (MHz) of ``ik_axi`` with an echo, None if it was not placed."""
    return data["runs"].get("axi-W32-echo-ecp5-place", {}).get("mhz")


def memory(data: dict) -> str:
    """Return the table of ``ik_axi``, empty if nothing was measured."""
    rows = []
    for width, echo in MEMORY:
        name = "-".join(["axi", f"W{width}", *(["echo"] if echo else [])])
        of = {family: data["runs"].get(f"{name}-{family}", {}).get("cells") for family in ("xc2vp", "xc7", "ecp5")}
        if not all(of.values()):
            continue
        placed = data["runs"].get(f"{name}-ecp5-place", {})
        seeds = [f"{mhz:.0f}" for mhz in placed.get("tried", [])]
        rows.append(
            [
                f"W = {width}, " + ("an echo in the place of the datapath" if echo else "`lean`"),
                *(of[family]["LUT"] for family in of),
                *(of[family]["FF"] for family in of),
                of["ecp5"]["RAM"],
                of["ecp5"]["multipliers"],
                f"{placed['mhz']:.0f}" if placed else "-",
                ", ".join(seeds) or "-",
            ]
        )
    head = ["`ik_axi`, 64 bits of data", "LUT4 on xc2vp", "LUT6 on xc7", "LUT4 on ECP5"]
    head += ["flip-flops: xc2vp", "xc7", "ECP5", "DP16KD", "MULT18X18D", "MHz on ECP5", "seeds"]
    return table(head, rows) if rows else ""


def fold_values(datapath: str, width: int) -> dict[str, int]:
    """Return the parameters of ``ik_axis``."""
    chosen = CONFIGURATIONS[datapath].parameters
    return {"W": width, "DATAPATH": chosen["DATAPATH"], "TILE": chosen["TILE"]}


def fold_runs(data: dict, family: str, datapath: str, width: int) -> tuple[dict | None, dict | None]:
    """Return the fold datapath's figures on a chip, synthesized and placed; None where not measured."""
    name = "-".join(["axis", *(f"{k}{v}" for k, v in fold_values(datapath, width).items()), family])
    return data["runs"].get(name), data["runs"].get(f"{name}-place")


def folded(data: dict) -> str:
    """Return the table of the fold datapath, empty if nothing was measured."""
    rows = []
    for family, datapath, width in FOLD:
        run, placed = fold_runs(data, family, datapath, width)
        if not run:
            continue
        cells, (chip, logic), period = run["cells"], CHIPS[family], CONFIGURATIONS[datapath].period
        design = data["fold"]["designs"][f"{datapath}-{width}"]
        rows.append([
            f"{chip}, W = {width}", f"`{datapath}`", period, design["latency"], f"{design['hand']:.1e}",
            f"{cells['LUT']} {logic}", cells["FF"], cells["multipliers"], cells["RAM"], *((
                f"{placed['mhz']:.1f}", f"{period / placed['mhz']:.2f}",
                f"{(design['latency'] + 99 * period) / placed['mhz']:.0f}", f"`{placed['path']['from']}`",
                f"`{placed['path']['to']}`", ", ".join(f"{mhz:.1f}" for mhz in placed["tried"]),
            ) if placed else "------"),
        ])  # fmt: skip
    head = ["`ik_axis`", "`DATAPATH`", "clocks a target", "latency (clocks)", "largest hand error / reach", "logic"]
    head += ["flip-flops", "multipliers", "memories", "MHz", "us a target", "100 targets (us)", "from", "to", "seeds"]
    return table(head, rows) if rows else ""


def breakdown(data: dict, datapath: str, width: int) -> dict | None:
    """Return tables of a datapath's logic by section and by module, None if it was not counted."""
    tree = synthesized(data, datapath, width, "xc2vp", "tree")
    if not tree:
        return None
    names = ["LUT4", "of them SRL16", "flip-flops", "carry", "MUXF", "MULT18X18", "RAMB16"]
    sections = [[f"`{n}`", *(c[k] for k in KINDS)] for n, c in tree["sections"].items() if n != "itself"]
    sections.sort(key=lambda row: -row[1])
    sections.append(["beside them", *(tree["sections"]["itself"][k] for k in KINDS)])
    modules = sorted(tree["modules"].items(), key=lambda item: -item[1]["LUT"])
    rows = [[f"`{n}`", c["instances"], *(c[k] for k in KINDS)] for n, c in modules if any(c[k] for k in KINDS)]
    rows.append(["all", "", *(sum(c[k] for _, c in modules) for k in KINDS)])
    flat = synthesized(data, datapath, width, "xc2vp")
    return {
        "datapath": datapath,
        "width": width,
        "flat": flat["cells"] if flat else None,
        "sections": table(["section", *names], sections),
        "modules": table(["module, without those inside of it", "instances", *names], rows),
    }


def critical(data: dict) -> str:
    """Return the table of each placement's slowest path."""
    rows = []
    for design in data["designs"]:
        datapath, width = design.split("-")
        for module, run in place_runs(data, datapath, int(width), (TOPS[datapath], *SECTIONS.get(datapath, ()))):
            path = run["path"]
            rows.append(
                [
                    f"{datapath} {width}",
                    f"`{module}`",
                    f"{run['mhz']:.0f}",
                    f"`{path['from']}`",
                    f"`{path['to']}`",
                    ", ".join(path["through"]),
                    f"{path['ns']:.2f}",
                    f"{path['routing_ns']:.2f}",
                    run["used"].get("MULT18X18D", 0),
                    ", ".join(f"{mhz:.0f}" for mhz in run["tried"]),
                    run["place_s"],
                ]
            )
    head = ["design", "placed", "MHz", "from", "to", "through", "ns", "of it routing", "multipliers", "seeds", "s"]
    return table(head, rows)


def page(data: dict) -> str:
    """Return fpga.md."""
    dates = sorted(run["date"] for run in data["runs"].values())
    measured = sorted({(k.split("-")[0], d["commit"], d["rtl"]) for k, d in data["designs"].items()})
    parts = [breakdown(data, datapath, width) for width in BROKEN_DOWN for datapath in ("lean", "paper")]
    tried = data.get("tried", [])
    return render(
        "fpga",
        dates=" to ".join(sorted({dates[0], dates[-1]})),
        tools=", ".join(f"{name} {number}" for name, number in data["tools"].items()),
        rtl="; ".join(f"{d} as of commit `{c}`, sources `{h}`" for d, c, h in measured),
        comparison=comparison(data),
        device=DEVICE,
        chip=tables.CHIP,
        chip_luts=tables.CHIP_LUTS,
        chip_multipliers=tables.CHIP_MULTIPLIERS,
        multipliers=HOLDS["MULT18X18D"],
        multiplier_ns=MULTIPLIER_NS,
        multiplier_mhz=f"{1000 / MULTIPLIER_NS:.0f}",
        aim=AIM_MHZ,
        critical=critical(data),
        memory=memory(data),
        memory_commit=data.get("memory", {}).get("commit"),
        folded=folded(data),
        fold_commit=data.get("fold", {}).get("commit"),
        tried=table(["change", "measured on", "before", "after"], tried, left=4) if tried else "",
        parts=[part for part in parts if part],
        commands=data["commands"],
    )

# SPDX-License-Identifier: Apache-2.0
"""Reports of Yosys and nextpnr: cells by kind, by module and by section; clock and critical path."""

from __future__ import annotations

import re
from collections import Counter

from scripts.console import InputError

HOLDS = {"MULT18X18D": 156, "TRELLIS_COMB": 83640, "TRELLIS_FF": 83640, "DP16KD": 208}
"""Cells of an ECP5-85k."""

MULTIPLIER_NS = 3.65
"""Delay from input to output registers: nextpnr's 3.07 ns through the multiplier, 0.58 ns from clock to output."""

# kinds of cells in fpga.json and on the page; below, the cells that each sums by family: type -> weight
KINDS = ("LUT", "shift", "FF", "carry", "MUXF", "multipliers", "RAM")
_XILINX_LUT = {f"LUT{k}": 1 for k in range(1, 7)} | {"INV": 1}
_XILINX = {
    "LUT": _XILINX_LUT | {"SRL16E": 1, "SRLC32E": 1},
    "shift": {"SRL16E": 1, "SRLC32E": 1},
    "FF": {f"FD{x}": 1 for x in ("RE", "SE", "CE", "PE")},
    "MUXF": {f"MUXF{k}": 1 for k in range(5, 10)},
}
_PORTS = (1, 2, 4, 9, 18, 36)
# memories in LUTs: 16 bits each on xc2vp, 64 on xc7 and xcup; the second port of X1D doubles them
_LUT4_RAM = {f"RAM{depth}X1{port}": depth // 16 * (2 if port == "D" else 1) for depth in (16, 32, 64) for port in "SD"}
_LUT6_RAM = {"RAM32M": 4, "RAM64M": 4, "RAM32M16": 8, "RAM64M8": 8, "RAM32X1D": 2, "RAM64X1D": 2}
_LUT6_RAM |= {"RAM128X1D": 4, "RAM32X1S": 1, "RAM64X1S": 1}
CELLS = {
    "xc2vp": _XILINX
    | {
        "LUT": _XILINX["LUT"] | _LUT4_RAM,
        "carry": {"MUXCY": 1},
        "multipliers": {"MULT18X18": 1, "MULT18X18S": 1},
        "RAM": {f"RAMB16_S{a}{b}": 1 for a in _PORTS for b in ("", *(f"_S{k}" for k in _PORTS))},
    },
    "xc7": _XILINX
    | {
        "LUT": _XILINX["LUT"] | _LUT6_RAM,
        "carry": {"CARRY4": 1},
        "multipliers": {"DSP48E1": 1},
        "RAM": {"RAMB18E1": 1, "RAMB36E1": 2},
    },
    "xcup": _XILINX
    | {
        "LUT": _XILINX["LUT"] | _LUT6_RAM,
        "carry": {"CARRY4": 1},  # two of them are a CARRY8
        "multipliers": {"DSP48E2": 1},
        "RAM": {"RAMB18E2": 1, "RAMB36E2": 2},
    },
    # a CCU2C is two LUTs with a carry; a memory of 16x4 bits takes the LUTs of two slices, and two for writing
    "ecp5": {
        "LUT": {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6},
        "shift": {},
        "FF": {"TRELLIS_FF": 1},
        "carry": {"CCU2C": 1},
        "MUXF": {"PFUMX": 1, "L6MUX21": 1},
        "multipliers": {"MULT18X18D": 1},
        "RAM": {"DP16KD": 1},
    },
    # a LUT next to a carry shares the carry's logic cell; a run replaces the LUT count by the logic cell count
    "up5k": {
        "LUT": {"SB_LUT4": 1},
        "shift": {},
        "FF": {f"SB_DFF{x}": 1 for x in ("", "E", "SR", "SS", "ESR", "ESS")},
        "carry": {"SB_CARRY": 1},
        "MUXF": {},
        "multipliers": {"SB_MAC16": 1},
        "RAM": {"SB_RAM40_4K": 1},
    },
    # an ALU is a LUT with a carry
    "gowin": {
        "LUT": {f"LUT{k}": 1 for k in range(1, 5)} | {"ALU": 1},
        "shift": {},
        "FF": {f"DFF{x}": 1 for x in ("", "E", "R", "S", "RE", "SE")},
        "carry": {"ALU": 1},
        "MUXF": {f"MUX2_LUT{k}": 1 for k in range(5, 9)},
        "multipliers": {"MULT18X18": 1},
        "RAM": dict.fromkeys(("SPX9", "DPX9B", "SDPX9B", "SP", "DPB", "SDPB", "pROM", "pROMX9"), 1),
    },
}
CELLS["ecp5-12k"] = CELLS["ecp5"]
NOT_COUNTED = re.compile(r"\$scopeinfo|XORCY|GND|VCC|BUFG|\$paramod.*|ik_\w+")


class ToolError(InputError):
    """A tool is missing or has failed."""


def counted(stat: dict, family: str) -> dict[str, int]:
    """Return kind -> number for the whole design of a `stat -json`. Raises ToolError for an unknown cell."""
    totals = {name: _total(stat, name) for name in stat["modules"]}
    top = _top(stat)
    return _kinds(totals[top], family)


def _kinds(cells: Counter, family: str) -> dict[str, int]:
    known = {cell for of_it in CELLS[family].values() for cell in of_it}
    strange = sorted(c for c in cells if c not in known and not NOT_COUNTED.fullmatch(c.lstrip("\\")))
    if strange:
        raise ToolError(f"{family}: no rule to count {', '.join(strange)}")
    return {kind: sum(cells[c] * n for c, n in CELLS[family][kind].items()) for kind in KINDS}


def _own(stat: dict, name: str) -> Counter:
    return Counter(stat["modules"][name]["num_cells_by_type"])


def _modules(stat: dict) -> dict[str, str]:
    """Return cell type -> key of the module."""
    return {key.lstrip("\\"): key for key in stat["modules"]} | {key: key for key in stat["modules"]}


def _total(stat: dict, name: str) -> Counter:
    modules = _modules(stat)
    total = Counter()
    for cell, n in _own(stat, name).items():
        if cell in modules:
            for inner, m in _total(stat, modules[cell]).items():
                total[inner] += n * m
        else:
            total[cell] += n
    return total


def _top(stat: dict) -> str:
    """Return the module that no other instantiates."""
    modules = _modules(stat)
    inner = {modules[cell] for name in stat["modules"] for cell in _own(stat, name) if cell in modules}
    return next(name for name in stat["modules"] if name not in inner)


def _plain(name: str) -> str:
    """Return ik_delay for $paramod$1a2b\\ik_delay, $paramod\\ik_delay\\W=s32'0... or \\ik_delay."""
    return re.search(r"\\?(ik_\w+)", name)[1]


def by_module(stat: dict, family: str) -> dict[str, dict]:
    """Return module -> its instances and its own cells in all of them, without cells of inner modules."""
    modules = _modules(stat)
    instances = Counter()

    def walk(name, times):
        instances[name] += times
        for cell, n in _own(stat, name).items():
            if cell in modules:
                walk(modules[cell], times * n)

    walk(_top(stat), 1)
    own = {}
    for name, times in instances.items():
        kinds, cells = own.setdefault(_plain(name), ([0], Counter()))
        kinds[0] += times
        for cell, n in _own(stat, name).items():
            if cell not in modules:
                cells[cell] += n * times
    return {name: {"instances": kinds[0], **_kinds(cells, family)} for name, (kinds, cells) in own.items()}


def by_section(stat: dict, family: str) -> dict[str, dict]:
    """Return module that the top instantiates -> all cells inside, summed over its instances."""
    modules = _modules(stat)
    sections = {}
    top = _top(stat)
    for cell, n in _own(stat, top).items():
        if cell in modules:
            total = sections.setdefault(_plain(cell), Counter())
            for inner, m in _total(stat, modules[cell]).items():
                total[inner] += n * m
    rest = Counter({c: n for c, n in _own(stat, top).items() if c not in modules})
    return {name: _kinds(cells, family) for name, cells in sections.items()} | {"itself": _kinds(rest, family)}


def used(report: dict) -> dict[str, int]:
    """Return kind of cell -> number used."""
    kinds = (*HOLDS, "ICESTORM_LC", "ICESTORM_DSP", "ICESTORM_RAM")
    return {k: report["utilization"][k]["used"] for k in kinds if k in report["utilization"]}


def placed(report: dict) -> dict:
    """Return clock, utilization and critical path from nextpnr's report."""
    clock = next(iter(report["fmax"].values()))
    path = next(p for p in report["critical_paths"] if p["from"].split()[-1] == p["to"].split()[-1])["path"]
    share = {"logic": 0.0, "routing": 0.0}
    for step in path:
        share["routing" if step["type"] == "routing" else "logic"] += step["delay"]
    return {
        "mhz": round(min(clock["achieved"], 1000 / MULTIPLIER_NS), 1),
        "used": used(report),
        "path": {
            "from": signal(path[0]["from"]["cell"]),
            "to": signal(path[-1]["to"]["cell"]),
            "through": steps(path),
            "ns": round(sum(share.values()), 2),
            "routing_ns": round(share["routing"], 2),
        },
    }


def signal(cell: str) -> str:
    """Return u_turn.u_w_q.hh for dut.u_turn.u_w_q.hh_TRELLIS_FF_Q_12_DI_MULT18X18D_P3."""
    name = re.sub(r"^(\$\w+\$)?dut\.", "", cell)
    name = re.sub(r"_(TRELLIS_FF|MULT18X18D|LUT4|CCU2C|PFUMX|L6MUX21|DP16KD|SB_[A-Z]+\d*)_.*|_RAM$", "", name)
    return re.sub(r"\$[\w$:./-]+$", "", name) or cell


def steps(path: list[dict]) -> list[str]:
    """Return the kinds of cells along a path; repeats are collapsed with their number: CCU2C x 14."""
    kinds = []
    for step in path:
        if step["type"] == "routing":
            continue
        found = re.findall(r"MULT18X18D|CCU2C|LUT4|PFUMX|L6MUX21|DP16KD", step["to"]["cell"])
        kind = found[-1] if found else "logic"
        if step["type"] == "clk-to-q":
            kind = kind if kind == "MULT18X18D" else "DP16KD" if step["delay"] > 2 else "FF"
        if step["type"] != "setup" or kind == "MULT18X18D" and step["to"].get("port", "Q")[0] in "AB":
            kinds.append(kind)
    out = []
    for kind in kinds:
        if out and out[-1][0] == kind:
            out[-1][1] += 1
        else:
            out.append([kind, 1])
    return [kind if n == 1 else f"{kind} x {n}" for kind, n in out]

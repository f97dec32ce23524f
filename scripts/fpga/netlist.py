# SPDX-License-Identifier: Apache-2.0
"""Interface to YoWASP's Yosys and nextpnr: finds their versions, runs them, reads their reports (numbers of cells by
kind, clock, critical path), and packs registers into a netlist's hard blocks."""

import re
import subprocess
import time
from collections import Counter, defaultdict
from importlib import metadata
from itertools import groupby
from pathlib import Path

from scripts.console import InputError
from tb.sim.subprocesses import compiled

MULTIPLIERS = 156  # in an ECP5-85k

MULTIPLIER_NS = 3.65
"""Shortest clock period of a multiplier: nextpnr's 3.07 ns through the multiplier, 0.58 ns from clock to output."""

KINDS = ("LUT", "shift", "FF", "carry", "MUXF", "multipliers", "RAM")
"""Kinds of cells in fpga.json and on the page."""

CELLS = [
    ("LUT", r"LUT[1-6]|INV|SRL16E|SRLC32E|ALU|SB_LUT4", 1),
    ("LUT", r"CCU2C", 2),
    ("LUT", r"TRELLIS_DPR16X4", 6),  # 16x4 bits: four LUTs store, two write
    ("shift", r"SRL16E|SRLC32E", 1),
    ("FF", r"FD[RSCP]E|TRELLIS_FF|SB_DFFE?(S[RS])?|DFF[RS]?E?", 1),
    ("carry", r"MUXCY|CARRY4|CCU2C|SB_CARRY|ALU", 1),  # on xcup, two CARRY4 are a CARRY8
    ("MUXF", r"MUXF[5-9]|PFUMX|L6MUX21|MUX2_LUT[5-8]", 1),
    ("multipliers", r"MULT18X18[SD]?|MULT9X9|DSP48E[12]|SB_MAC16", 1),
    ("RAM", r"RAMB16(_S\d+){1,2}|RAMB18E[12]|DP16KD|SB_RAM40_4K|SPX9|S?DPX9B|SP|S?DPB|pROM(X9)?", 1),
    ("RAM", r"RAMB36E[12]", 2),
    ("", r"\$scopeinfo|XORCY|GND|VCC|BUFG", 0),
]
"""(kind, pattern of cell types, weight) for all families. A Gowin ALU is one LUT with a carry; an ECP5 CCU2C is two.
On iCE40 a LUT and a carry share a logic cell, so a run replaces the LUTs by nextpnr's number of logic cells."""

LUT4_MEMORIES = [("RAM16X1S", 1), ("RAM16X1D|RAM32X1S", 2), ("RAM32X1D|RAM64X1S", 4), ("RAM64X1D", 8)]
LUT6_MEMORIES = [("RAM(32|64)X1S", 1), ("RAM(32|64)X1D", 2), ("RAM(32|64)M|RAM128X1D", 4), ("RAM32M16|RAM64M8", 8)]
"""(pattern of Xilinx' memories made of LUTs, number of LUTs); LUT4_MEMORIES on xc2vp, LUT6_MEMORIES on others."""

LIMIT = 40 * 60.0
"""Time limit of one tool run in seconds."""


class ToolError(InputError):
    """A tool is missing or has failed."""


class LeftOutError(ToolError):
    """A run has no figures, because a tool exceeded its time limit or the netlist differs from the RTL."""


def version(tool: str) -> str:
    """Return the version of a tool, without its build number. Raises ToolError if it is not installed."""
    try:
        return re.match(r"\d+\.\d+(\.[1-9]\d*)?", metadata.version(f"yowasp-{tool}"))[0]
    except metadata.PackageNotFoundError:
        raise ToolError(f"yowasp-{tool} is not installed: run `make fpga`") from None


def call(command: list[str], folder: Path, label: str) -> int:
    """Run a tool with low priority in a folder; return the seconds it took. Raises LeftOutError after LIMIT seconds and
    ToolError if the tool fails; the messages begin with ``label``."""
    start = time.monotonic()
    try:
        done = compiled(["env", "-C", folder, "nice", *command], LIMIT)
    except subprocess.TimeoutExpired:
        raise LeftOutError(f"{label}: stopped after {LIMIT / 60:.0f} min, left out") from None
    if done.returncode:
        raise ToolError(f"{label}: failed: {(done.stderr or done.stdout)[-4000:].strip()}")
    return round(time.monotonic() - start)


def counted(stat: dict, family: str) -> dict[str, int]:
    """Return a dict: kind -> number of cells, from Yosys' `stat -json`. Raises ToolError for an unknown cell."""
    sections = by_section(stat, family).values()
    return {kind: sum(section[kind] for section in sections) for kind in KINDS}


def by_section(stat: dict, family: str) -> dict[str, dict]:
    """Return a dict: module instantiated by the top -> kind -> number of cells in all of the module's instances. Key
    "itself" has the top's cells outside of instances."""
    modules = {
        name.lstrip("\\"): {cell.lstrip("\\"): n for cell, n in module["num_cells_by_type"].items()}
        for name, module in stat["modules"].items()
    }
    (top,) = modules.keys() - {name for cells in modules.values() for name in cells}

    def inside(name: str) -> Counter:
        if name not in modules:
            return Counter({name: 1})
        cells: Counter = Counter()
        for inner, count in modules[name].items():
            cells.update({cell: count * n for cell, n in inside(inner).items()})
        return cells

    sections, rest = defaultdict(Counter), Counter()
    for name, count in modules[top].items():  # ik_delay, $paramod$1a2b\ik_delay or $paramod\ik_delay\W=s32'0
        section = sections[re.search(r"\b(ik_\w+)", name)[1]] if name in modules else rest
        section.update({cell: count * n for cell, n in inside(name).items()})
    return {name: _kinds(cells, family) for name, cells in {**sections, "itself": rest}.items()}


def _kinds(cells: Counter, family: str) -> dict[str, int]:
    """Return a dict: kind -> number of cells, weighted as in CELLS. ``cells``: cell type -> number."""
    memories = LUT4_MEMORIES if family == "xc2vp" else LUT6_MEMORIES
    rules = [*CELLS, *(("LUT", pattern, luts) for pattern, luts in memories)]
    kinds, strange = Counter(dict.fromkeys(KINDS, 0)), []
    for cell, n in cells.items():
        matching = {kind: weight for kind, pattern, weight in rules if re.fullmatch(pattern, cell)}
        kinds.update({kind: n * weight for kind, weight in matching.items()})
        strange += [] if matching else [cell]
    if strange:
        raise ToolError(f"{family}: no rule to count {', '.join(sorted(strange))}")
    return {kind: kinds[kind] for kind in KINDS}


def used(report: dict) -> dict[str, int]:
    """Return a dict: kind of cell -> number used, from nextpnr's report."""
    kinds = "MULT18X18D TRELLIS_COMB TRELLIS_FF DP16KD ICESTORM_LC ICESTORM_DSP ICESTORM_RAM".split()
    return {k: report["utilization"][k]["used"] for k in kinds if k in report["utilization"]}


def placed(report: dict) -> dict:
    """Return clock (MHz, at most 1000 / MULTIPLIER_NS), utilization and critical path from nextpnr's report."""
    clock = next(iter(report["fmax"].values()))
    path = next(p for p in report["critical_paths"] if p["from"].split()[-1] == p["to"].split()[-1])["path"]
    return {
        "mhz": round(min(clock["achieved"], 1000 / MULTIPLIER_NS), 1),
        "used": used(report),
        "path": {
            "from": signal(path[0]["from"]["cell"]),
            "to": signal(path[-1]["to"]["cell"]),
            "through": steps(path),
            "ns": round(sum(step["delay"] for step in path), 2),
            "routing_ns": round(sum(step["delay"] for step in path if step["type"] == "routing"), 2),
        },
    }


def signal(cell: str) -> str:
    """Return a cell's signal, such as u_turn.u_w_q.hh for dut.u_turn.u_w_q.hh_TRELLIS_FF_Q_12_DI_MULT18X18D_P3."""
    name = re.sub(r"^(\$\w+\$)?dut\.", "", cell)
    name = re.sub(r"_(TRELLIS_FF|MULT18X18D|LUT4|CCU2C|PFUMX|L6MUX21|DP16KD|SB_[A-Z]+\d*)_.*|_RAM$", "", name)
    return re.sub(r"\$[\w$:./-]+$", "", name) or cell


def steps(path: list[dict]) -> list[str]:
    """Return the kinds of cells along a path; 14 adjacent CCU2C become "CCU2C x 14"."""
    kinds = []
    for step in path:
        if step["type"] == "routing":
            continue
        cells = re.findall(r"MULT18X18D|CCU2C|LUT4|PFUMX|L6MUX21|DP16KD", step["to"]["cell"])
        kind = cells[-1] if cells else "logic"
        if step["type"] == "clk-to-q":
            kind = kind if kind == "MULT18X18D" else "DP16KD" if step["delay"] > 2 else "FF"
        if step["type"] != "setup" or kind == "MULT18X18D" and step["to"].get("port", "Q")[0] in "AB":
            kinds.append(kind)
    runs = [(kind, len(list(same))) for kind, same in groupby(kinds)]
    return [kind if n == 1 else f"{kind} x {n}" for kind, n in runs]


PACKER = "5"
"""Version of :func:`pack_registers`; part of a run's key."""


def pack_registers(module: dict) -> dict:
    """Move registers into MULT18X18D and DP16KD, as Lattice's tools do and Yosys does not. ``module`` is in the format
    of Yosys' write_json, has one clock and is changed in place.

    A multiplier or memory port gets its output register if the only reader of each bit is a plain flip-flop. A memory
    with words of 36 bits uses both ports for a word, so both get the register or neither does.
    A multiplier gets its input registers if all bits of A and B come from plain flip-flops or are constant. A flip-flop
    with other readers is not removed. A flip-flop fed by a memory is not moved, because memory outputs are late.
    Returns the numbers of multipliers, of registers moved into each kind of cell, and of removed flip-flops.
    """
    cells = module["cells"]
    readers, source, late, gone = defaultdict(list), {}, set(), set()
    for name, cell in cells.items():
        nets = cell["connections"]
        for port, bits in nets.items():
            if cell["port_directions"][port] == "input":
                for net in bits:
                    readers[net].append((name, port))
            elif cell["type"] == "DP16KD":
                late |= set(bits)
        simple = {"CEMUX": "1 ", "CLKMUX": "CLK", "REGSET": "RESET"}.items() <= cell["parameters"].items()
        if cell["type"] == "TRELLIS_FF" and simple and nets.get("LSR", ["0"]) == ["0"]:
            source[nets["Q"][0]] = name
    for port in module["ports"].values():
        for net in port["bits"] if port["direction"] == "output" else []:
            readers[net].append(("", ""))
    plain = set(source.values())

    def pin(name: str, port: str) -> int | str:
        return cells[name]["connections"][port][0]

    def data(name: str) -> int | str:
        return pin(name, "DI" if "DI" in cells[name]["connections"] else "M")

    (clock,) = {pin(name, "CLK") for name in plain}

    def absorb(nets: dict, ports: list[str]) -> bool:
        """Connect ports to the outputs of the flip-flops that read them, mark the flip-flops for removal, return True.
        Change nothing and return False if a port has any other reader, or if no port has a reader."""
        behind = {port: readers[nets[port][0]] for port in ports if port in nets and readers[nets[port][0]]}
        used = [reader for flops in behind.values() for reader in flops]
        if not len(used) == len(behind) > 0 or not all(name in plain and port == "DI" for name, port in used):
            return False
        for port, (name, _) in zip(behind, used, strict=True):
            nets[port] = [pin(name, "Q")]
            gone.add(name)
            source.pop(pin(name, "Q"), None)
        return True

    counts = Counter(multipliers=0)
    for name, cell in cells.items():
        nets, parameters = cell["connections"], cell["parameters"]
        if cell["type"] == "DP16KD":
            for sides in ("AB",) if int(parameters.get("DATA_WIDTH_B", "0"), 2) == 36 else "AB":
                if absorb(nets, [f"DO{side}{k}" for side in sides for k in range(18)]):
                    parameters |= {f"REGMODE_{side}": "OUTREG" for side in sides}
                    nets |= {f"OCE{side}": ["1"] for side in sides}
                    cell["port_directions"] |= {f"OCE{side}": "input" for side in sides}
                    counts["memory"] += 1
        if cell["type"] != "MULT18X18D":
            continue
        output = absorb(nets, [f"P{k}" for k in range(36)])
        inputs = [port for port in nets if re.fullmatch(r"[AB]\d+", port) and isinstance(nets[port][0], int)]
        fed = {port: source[nets[port][0]] for port in inputs if nets[port][0] in source}
        loaded = len(fed) == len(inputs) > 0 and not any(data(flop) in late for flop in fed.values())
        for port, flop in fed.items() if loaded else ():
            readers[nets[port][0]].remove((name, port))
            nets[port] = [data(flop)]
            readers[data(flop)].append((name, port))
        for which in ["INPUTA", "INPUTB"] * loaded + ["OUTPUT"] * output:
            nets |= {"CLK0": [clock], "CE0": ["1"], "RST0": ["0"]}
            cell["port_directions"] |= {"CLK0": "input", "CE0": "input", "RST0": "input"}
            parameters |= {f"REG_{which}_{pin}": f"{pin}0" for pin in ("CLK", "CE", "RST")}
        counts.update(multipliers=1, input=loaded, output=output)
    # Remove flip-flops without readers, and then the flip-flops that only these read.
    todo = list(source.values())
    while todo:
        name = todo.pop()
        if name not in gone and not readers[pin(name, "Q")]:
            gone.add(name)
            readers[data(name)] = [reader for reader in readers[data(name)] if reader[0] != name]
            todo += [source[net] for net in [data(name)] if net in source]
    for name in gone:
        del cells[name]
    return {**counts, "flip_flops": len(gone)}

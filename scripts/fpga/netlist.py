# SPDX-License-Identifier: Apache-2.0
"""Netlists of Yosys and reports of nextpnr: cells by kind, packing of registers, clock and critical path."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import groupby

from scripts.console import InputError

HOLDS = {"MULT18X18D": 156, "TRELLIS_COMB": 83640, "TRELLIS_FF": 83640, "DP16KD": 208}
"""Cells of an ECP5-85k."""

MULTIPLIER_NS = 3.65
"""Delay from input to output registers: nextpnr's 3.07 ns through the multiplier, 0.58 ns from clock to output."""

KINDS = ("LUT", "shift", "FF", "carry", "MUXF", "multipliers", "RAM")
"""Kinds of cells in fpga.json and on the page."""

_PORTS = (1, 2, 4, 9, 18, 36)
# Memories in LUTs: 16 bits each on xc2vp, 64 on xc7 and xcup; the second port of X1D doubles them.
_LUT4_RAM = {f"RAM{depth}X1{port}": depth // 16 * (2 if port == "D" else 1) for depth in (16, 32, 64) for port in "SD"}
_LUT6_RAM = {"RAM32M": 4, "RAM64M": 4, "RAM32M16": 8, "RAM64M8": 8, "RAM32X1D": 2, "RAM64X1D": 2}
_LUT6_RAM |= {"RAM128X1D": 4, "RAM32X1S": 1, "RAM64X1S": 1}


def _xilinx(lut_ram: dict[str, int], carry: str, multipliers: Sequence[str], ram: dict[str, int]) -> dict:
    shift = {"SRL16E": 1, "SRLC32E": 1}
    return {
        "LUT": {f"LUT{k}": 1 for k in range(1, 7)} | {"INV": 1} | shift | lut_ram,
        "shift": shift,
        "FF": dict.fromkeys(("FDRE", "FDSE", "FDCE", "FDPE"), 1),
        "carry": {carry: 1},
        "MUXF": {f"MUXF{k}": 1 for k in range(5, 10)},
        "multipliers": dict.fromkeys(multipliers, 1),
        "RAM": ram,
    }


CELLS = {
    "xc2vp": _xilinx(
        _LUT4_RAM,
        "MUXCY",
        ("MULT18X18", "MULT18X18S"),
        {f"RAMB16_S{a}{b}": 1 for a in _PORTS for b in ("", *(f"_S{k}" for k in _PORTS))},
    ),
    "xc7": _xilinx(_LUT6_RAM, "CARRY4", ["DSP48E1"], {"RAMB18E1": 1, "RAMB36E1": 2}),
    "xcup": _xilinx(_LUT6_RAM, "CARRY4", ["DSP48E2"], {"RAMB18E2": 1, "RAMB36E2": 2}),  # two CARRY4 are a CARRY8
    # A CCU2C is two LUTs with a carry; a memory of 16x4 bits takes the LUTs of two slices, and two for writing.
    "ecp5": {
        "LUT": {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6},
        "FF": {"TRELLIS_FF": 1},
        "carry": {"CCU2C": 1},
        "MUXF": {"PFUMX": 1, "L6MUX21": 1},
        "multipliers": {"MULT18X18D": 1},
        "RAM": {"DP16KD": 1},
    },
    # A LUT next to a carry shares the carry's logic cell; a run replaces the LUT count by the logic cell count.
    "up5k": {
        "LUT": {"SB_LUT4": 1},
        "FF": {f"SB_DFF{x}": 1 for x in ("", "E", "SR", "SS", "ESR", "ESS")},
        "carry": {"SB_CARRY": 1},
        "multipliers": {"SB_MAC16": 1},
        "RAM": {"SB_RAM40_4K": 1},
    },
    # An ALU is a LUT with a carry.
    "gowin": {
        "LUT": {f"LUT{k}": 1 for k in range(1, 5)} | {"ALU": 1},
        "FF": {f"DFF{x}": 1 for x in ("", "E", "R", "S", "RE", "SE")},
        "carry": {"ALU": 1},
        "MUXF": {f"MUX2_LUT{k}": 1 for k in range(5, 9)},
        "multipliers": {"MULT18X18": 1},
        "RAM": dict.fromkeys(("SPX9", "DPX9B", "SDPX9B", "SP", "DPB", "SDPB", "pROM", "pROMX9"), 1),
    },
}
"""Family -> kind -> cells that count, with their weight."""
CELLS["ecp5-12k"] = CELLS["ecp5"]
NOT_COUNTED = re.compile(r"\$scopeinfo|XORCY|GND|VCC|BUFG|\$paramod.*|ik_\w+")


class ToolError(InputError):
    """A tool is missing or has failed."""


def counted(stat: dict, family: str) -> dict[str, int]:
    """Return kind -> number for the whole design of a `stat -json`. Raises ToolError for an unknown cell."""
    return _kinds(stat, _instances(stat, _top(stat)), family)


def by_section(stat: dict, family: str) -> dict[str, dict]:
    """Return module that the top instantiates -> all cells inside, summed over its instances."""
    top = _top(stat)
    found = defaultdict(Counter)
    for key, times in _inner(stat, top).items():  # $paramod$1a2b\ik_delay, $paramod\ik_delay\W=s32'0... or \ik_delay
        for name, count in _instances(stat, key).items():
            found[re.search(r"\\?(ik_\w+)", key)[1]][name] += times * count
    found["itself"][top] = 1
    return {name: _kinds(stat, of, family) for name, of in found.items()}


def _inner(stat: dict, key: str) -> dict[str, int]:
    """Return the modules that a module instantiates, and how often."""
    keys = {name.lstrip("\\"): name for name in stat["modules"]}
    cells = stat["modules"][key]["num_cells_by_type"]
    return {keys[cell.lstrip("\\")]: n for cell, n in cells.items() if cell.lstrip("\\") in keys}


def _instances(stat: dict, top: str) -> Counter:
    """Return the number of instances of each module at or below ``top``."""
    found = Counter({top: 1})
    for key, times in _inner(stat, top).items():
        for name, count in _instances(stat, key).items():
            found[name] += times * count
    return found


def _top(stat: dict) -> str:
    """Return the module that no other instantiates."""
    inner = {key for name in stat["modules"] for key in _inner(stat, name)}
    return next(name for name in stat["modules"] if name not in inner)


def _kinds(stat: dict, instances: Counter, family: str) -> dict[str, int]:
    """Return kind -> number of cells in modules; inner modules are not counted."""
    cells = Counter()
    for key, times in instances.items():
        for cell, n in stat["modules"][key]["num_cells_by_type"].items():
            cells[cell] += n * times
    known = {cell for of in CELLS[family].values() for cell in of}
    strange = sorted(c for c in cells if c not in known and not NOT_COUNTED.fullmatch(c.lstrip("\\")))
    if strange:
        raise ToolError(f"{family}: no rule to count {', '.join(strange)}")
    return {kind: sum(cells[c] * n for c, n in CELLS[family].get(kind, {}).items()) for kind in KINDS}


def used(report: dict) -> dict[str, int]:
    """Return kind of cell -> number used."""
    kinds = (*HOLDS, "ICESTORM_LC", "ICESTORM_DSP", "ICESTORM_RAM")
    return {k: report["utilization"][k]["used"] for k in kinds if k in report["utilization"]}


def placed(report: dict) -> dict:
    """Return clock, utilization and critical path from nextpnr's report."""
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
    runs = [(kind, len(list(same))) for kind, same in groupby(kinds)]
    return [kind if n == 1 else f"{kind} x {n}" for kind, n in runs]


# -- registers packed into ECP5 multipliers and memories --------------------------------------------------------------


PACKER = "5"
"""Version of the function below."""


def pack_registers(module: dict) -> dict:
    """Move registers into MULT18X18D and DP16KD, as Lattice's tools do and Yosys does not (module of write_json).

    Output register of a multiplier or memory port: used if all its readers are plain flip-flops of one clock. A word of
    36 bits leaves a memory on both ports, which side B clocks: both have the register or neither.
    Input registers of a multiplier: used if A and B both come from plain flip-flops of that clock or are constant. A
    flip-flop with other readers is kept for them; one behind a memory, whose outputs are late, stays near it. Returns
    the number of registers of each kind and of removed flip-flops.
    """
    cells = module["cells"]
    readers, source, late, gone = defaultdict(list), {}, set(), set()
    for name, cell in cells.items():
        nets = cell["connections"]
        for port, bits in nets.items():
            if cell["port_directions"][port] == "input":
                for bit, net in enumerate(bits):
                    readers[net].append((name, port, bit))
            elif cell["type"] == "DP16KD":
                late |= set(bits)
        simple = {"CEMUX": "1 ", "CLKMUX": "CLK", "REGSET": "RESET"}.items() <= cell["parameters"].items()
        if cell["type"] == "TRELLIS_FF" and simple and nets.get("LSR", ["0"]) == ["0"]:
            source[nets["Q"][0]] = name
    for port in module["ports"].values():
        for net in port["bits"] if port["direction"] == "output" else []:
            readers[net].append(("", "", 0))
    plain = set(source.values())

    def pin(name, port):
        return cells[name]["connections"][port][0]

    def data(name):
        return pin(name, "DI" if "DI" in cells[name]["connections"] else "M")

    def clocks(names):
        return {pin(name, "CLK") for name in names}

    def absorb(nets, ports, clock=None):
        """Replace the flip-flops behind ports by their nets; merge flip-flops of the same bit.

        Returns their clock, empty and without a change if the ports have other readers or not one clock.
        """
        behind = {port: readers[nets[port][0]] for port in ports if port in nets and readers[nets[port][0]]}
        used = [reader for own in behind.values() for reader in own]
        if not all(name in plain and port == "DI" for name, port, _ in used):
            return set()
        found = clocks(name for name, _, _ in used)
        if len(found) != 1 or clock not in (None, *found):
            return set()
        for port, own in behind.items():
            first, *others = (pin(name, "Q") for name, _, _ in own)
            nets[port] = [first]
            for other in others:
                for name, its_port, bit in readers[other]:
                    cells[name]["connections"][its_port][bit] = first
                readers[first] += readers[other]
        for name, _, _ in used:
            gone.add(name)
            source.pop(pin(name, "Q"), None)
        return found

    counts = Counter(multipliers=0)
    for name, cell in cells.items():
        nets, parameters = cell["connections"], cell["parameters"]
        if cell["type"] == "DP16KD":
            for sides in ("AB",) if int(parameters.get("DATA_WIDTH_B", "0"), 2) == 36 else "AB":
                ports = [f"DO{side}{k}" for side in sides for k in range(18)]
                if absorb(nets, ports, nets[f"CLK{sides[-1]}"][0]):
                    parameters |= {f"REGMODE_{side}": "OUTREG" for side in sides}
                    nets |= {f"OCE{side}": ["1"] for side in sides}
                    cell["port_directions"] |= {f"OCE{side}": "input" for side in sides}
                    counts["memory"] += 1
        if cell["type"] != "MULT18X18D":
            continue
        output = absorb(nets, [f"P{k}" for k in range(36)])
        inputs = [port for port in nets if re.fullmatch(r"[AB]\d+", port) and isinstance(nets[port][0], int)]
        fed = {port: source[nets[port][0]] for port in inputs if nets[port][0] in source}
        clock = clocks(fed.values()) | output
        late_input = any(data(flop) in late for flop in fed.values())
        loaded = len(fed) == len(inputs) > 0 and len(clock) == 1 and not late_input
        if loaded:
            for port, flop in fed.items():
                readers[nets[port][0]].remove((name, port, 0))
                nets[port] = [data(flop)]
                readers[data(flop)].append((name, port, 0))
        for which, wanted in (("INPUTA", loaded), ("INPUTB", loaded), ("OUTPUT", output)):
            if wanted:
                nets |= {"CLK0": [*(output or clock)], "CE0": ["1"], "RST0": ["0"]}
                cell["port_directions"] |= {"CLK0": "input", "CE0": "input", "RST0": "input"}
                parameters |= {f"REG_{which}_{pin}": f"{pin}0" for pin in ("CLK", "CE", "RST")}
        counts.update(multipliers=1, input=loaded, output=len(output))
    # Remove flip-flops without readers, and then their sources that have become unread.
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

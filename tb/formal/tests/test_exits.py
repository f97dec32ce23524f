# SPDX-License-Identifier: Apache-2.0
"""Tests that every bit of data, flags and tag leaves a pipeline in the same clock as its valid bit.

In a netlist that Yosys has flattened, each output bit is traced back through registers and delays to its origin. The
proofs `valid_*` prove the latency of valid.
"""

import json
import shutil
from pathlib import Path
from typing import NamedTuple

import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import ARM, CONFIGURATIONS, MODELS
from tb.formal.tools import yosys
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import closure, header, includes

pytestmark = pytest.mark.needs("fpga")

TAG_W = 5

RING = "ik_ring"  # module whose q is d delayed by N clocks, in a memory


class Bit(NamedTuple):
    """Origin of a bit: `kind` is "constant", "node", "cell" (an output of a cell) or "port" (an input)."""

    kind: str
    name: str = ""  # name of the node, cell or port
    index: int = 0  # value of the constant, else number of the bit in the node, cell output or port
    clocks: int = 0  # delay from the origin to the traced bit


class Netlist:
    """Netlist of module `top` from a `write_json` file; `nodes` maps a node to its signal and its width in bits."""

    def __init__(self, path: Path, top: str, nodes: dict[str, tuple[str, int]]) -> None:
        self.modules = json.loads(path.read_text())["modules"]
        module = self.modules[top]
        self.wires = {name: wire["bits"] for name, wire in module["netnames"].items()}
        self.cells = module["cells"]
        self.origins = {
            bit: Bit("port", name, index)
            for name, port in module["ports"].items()
            for index, bit in enumerate(port["bits"])
            if port["direction"] == "input"
        }
        for name, (signal, width) in reversed(nodes.items()):  # two nodes may share a wire: keep the first
            bits = self.wires[signal]
            if len(bits) != width:
                raise ValueError(f"{name}: {len(bits)} bits in the netlist, {width} in the model")
            self.origins |= {bit: Bit("node", name, index) for index, bit in enumerate(bits)}
        self.drivers = {
            bit: (name, port, index)
            for name, cell in self.cells.items()
            for port, direction in cell["port_directions"].items()
            for index, bit in enumerate(cell["connections"][port])
            if direction == "output"
        }

    def _delay(self, cell: dict) -> tuple[int, str]:
        """Return the clocks by which a cell delays, 0 unless it is a register or ring, and the name of its input."""
        if cell["type"] == "$dff":
            return 1, "D"
        module = self.modules.get(cell["type"], {})
        is_ring = module.get("attributes", {}).get("hdlname", cell["type"]).endswith(RING)
        return int(module["parameter_default_values"]["N"], 2) if is_ring else 0, "d"

    def origin(self, bit: int | str) -> Bit:
        """Return the origin of a bit, found by tracing it back through registers and rings."""
        clocks = 0
        while not isinstance(bit, str):
            if bit in self.origins:
                return self.origins[bit]._replace(clocks=clocks)
            if bit not in self.drivers:
                raise ValueError(f"bit {bit} has no driver")
            name, port, index = self.drivers[bit]
            delay, source = self._delay(self.cells[name])
            if not delay:
                return Bit("cell", name, index, clocks)
            bit, clocks = self.cells[name]["connections"][source][index], clocks + delay
        if bit not in "01":
            raise ValueError(f"a bit is '{bit}'")
        return Bit("constant", index=int(bit))


def wrong(name: str, width: int, bug: Bug | None = None) -> list[str]:
    """Return a line for each output bit with a wrong origin, or that does not leave in the clock of its valid bit."""
    path = MODELS[name]
    top = path.entity
    place = ROOT / "build" / "formal_exits" / f"{name}{width}{'-bug' if bug else ''}"
    shutil.rmtree(place, ignore_errors=True)
    copy_rtl(place, bug)
    files = [file for file in closure(top, place) if file.suffix == ".v"]
    for file in files:
        if file.parent.name == "lib" and file.stem != "ik_delay":  # keep operators as cells without bodies
            text = file.read_text() if file.stem == RING else header(file.read_text())
            file.write_text(text.replace("\nmodule ", "\n(* keep_hierarchy *)\nmodule ", 1))
    here = place.relative_to(ROOT)
    include = " ".join(f"-I{folder.relative_to(ROOT)}" for folder in includes(place))
    values = {"W": width, "TAG_W": TAG_W} | {key: path.parameters[key] for key in ("TILE",) if key in path.parameters}
    sets = " ".join(f"-chparam {key} {value}" for key, value in values.items())
    names = " ".join(str(file.relative_to(ROOT)) for file in files)
    lines = [f"read_verilog -defer {include} {names}", f"hierarchy -check -top {top} {sets}", "proc", "flatten"]
    assert not yosys(place, "elaborate", [*lines, f"write_json {here}/design.json"])

    nodes = fixed.nodes(name, width)
    signals = {n.name: (".".join(filter(None, (path.instance(n), n.name))), n.format.width) for n in nodes.values()}
    netlist = Netlist(place / "design.json", top, signals)
    out = max(nodes[name].time for name in (*path.results, *path.flags.keys() & nodes.keys()))
    flags = {flag: name for name, flag in path.flags.items()}
    expected = {
        "out_data": [Bit("node", field, k, out - nodes[field].time) for field in path.results for k in range(width)],
        "out_flags": [
            Bit("node", flags[1 << k], clocks=out - nodes[flags[1 << k]].time) if 1 << k in flags else Bit("constant")
            for k in range(path.flag_bits)
        ],
        "out_tag": [Bit("port", "in_tag", k, clocks=out) for k in range(TAG_W)],
    }
    lines = []
    if not path.core and netlist.wires["out_valid"] != netlist.wires["valid"][out - 1 :]:
        lines.append("out_valid is not the last of valid")
    for port, bits in expected.items():
        for k, (bit, wanted) in enumerate(zip(netlist.wires[port], bits, strict=True)):
            if (origin := netlist.origin(bit)) != wanted:
                lines.append(f"{port}[{k}]: {origin}, and not {wanted}")
    return lines


PATHS = (path for path in (*CONFIGURATIONS.values(), ARM) if path.period == 1)
BUILT = [(path, w) for path in PATHS for w in (16, 18, 23, 32) if w in path.widths]
QUICK = [("lean", 32), ("paper", 32)]


@pytest.mark.parametrize(
    ("name", "width"),
    [pytest.param(p.name, w, marks=() if (p.name, w) in QUICK else pytest.mark.slow) for p, w in BUILT],
)
def test_all_leave_together(name, width):
    assert wrong(name, width) == []


EARLY = {
    "paper": Bug("", "rtl/paper/ik_paper.v", ".N(T_OUT-T_QE_I)", ".N(T_OUT-T_QE_I-1)", "out_data[90]"),
    "arm": Bug("", "rtl/lean/ik_lean_arm.v", ".N(T_X)) u_at_x", ".N(T_X-1)) u_at_x", "out_tag[0]"),
}
"""Datapath -> seeded bug by which a word or the tag leaves a clock early."""


@pytest.mark.parametrize("name", EARLY)
def test_an_early_word_is_found(name):
    lines = wrong(name, 18, EARLY[name])
    assert lines and lines[0].startswith(EARLY[name].fails), lines

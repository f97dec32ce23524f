# SPDX-License-Identifier: Apache-2.0
"""Tests that every bit of data, flags and tag leaves a pipeline in the same clock as its valid bit.

In a netlist that Yosys has flattened, each output bit is traced back through registers and delays to its origin. The
proofs `valid_*` prove the latency of valid.
"""

import json
import shutil

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


Origin = tuple[str, int, int]
"""(node or port from which a bit comes, or "constant"; number of the bit or constant's value; clocks of delay)."""


def delays(modules: dict, top: str) -> dict[int, tuple[int, int]]:
    """Return a dict of the bits that a register or ring delays: bit -> (bit at its input, clocks)."""
    sources = {}
    for cell in modules[top]["cells"].values():
        module = modules.get(cell["type"], {})
        is_ring = module.get("attributes", {}).get("hdlname", cell["type"]).endswith(RING)
        if is_ring or cell["type"] == "$dff":
            clocks = int(module["parameter_default_values"]["N"], 2) if is_ring else 1
            before, after = (cell["connections"][port] for port in ("dq" if is_ring else "DQ"))
            sources |= {bit: (at_input, clocks) for bit, at_input in zip(after, before, strict=True)}
    return sources


def wrong(name: str, width: int, bug: Bug | None = None) -> list[str]:
    """Return a line for each output bit that has a wrong origin or does not leave in the clock of its valid bit."""
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

    modules, nodes = json.loads((place / "design.json").read_text())["modules"], fixed.nodes(name, width)
    ports, wires = modules[top]["ports"], {name: wire["bits"] for name, wire in modules[top]["netnames"].items()}
    inputs = (name for name, port in ports.items() if port["direction"] == "input")
    origins = {bit: (name, k) for name in inputs for k, bit in enumerate(ports[name]["bits"])}
    for node in reversed(nodes.values()):  # two nodes may share a wire: keep the first
        bits = wires[".".join(filter(None, (path.instance(node), node.name)))]
        assert len(bits) == node.format.width, f"{node.name}: {len(bits)} bits in the netlist"
        origins |= {bit: (node.name, k) for k, bit in enumerate(bits)}
    delayed = delays(modules, top)

    def origin(bit: int | str) -> Origin:
        clocks = 0
        while bit in delayed and bit not in origins:
            bit, more = delayed[bit]
            clocks += more
        return ("constant", int(bit), 0) if isinstance(bit, str) else (*origins.get(bit, ("logic", bit)), clocks)

    out = max(nodes[name].time for name in (*path.results, *path.flags.keys() & nodes.keys()))
    flags = {flag: name for name, flag in path.flags.items()}
    expected: dict[str, list[Origin]] = {
        "out_data": [(field, k, out - nodes[field].time) for field in path.results for k in range(width)],
        "out_flags": [
            (flags[1 << k], 0, out - nodes[flags[1 << k]].time) if 1 << k in flags else ("constant", 0, 0)
            for k in range(path.flag_bits)
        ],
        "out_tag": [("in_tag", k, out) for k in range(TAG_W)],
    }
    early = not path.core and wires["out_valid"] != wires["valid"][out - 1 :]
    lines = ["out_valid is not the last of valid"] * early
    for port, bits in expected.items():
        for k, (bit, wanted) in enumerate(zip(wires[port], bits, strict=True)):
            if (of := origin(bit)) != wanted:
                lines.append(f"{port}[{k}]: {of}, and not {wanted}")
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

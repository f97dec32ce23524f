# SPDX-License-Identifier: Apache-2.0
"""Tests that every bit of data, flags and tag leaves a pipeline in the same clock as its valid bit.

Bits are traced in the flattened netlist (tb/formal/netlist.py) from outputs to nodes; the proofs `valid_*` prove
the latency of valid.
"""

import shutil

import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import ARM, CONFIGURATIONS, MODELS
from tb.formal.netlist import RING, Bit, Netlist
from tb.formal.tools import missing, yosys
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import closure, header, includes

pytestmark = pytest.mark.skipif(bool(missing()), reason="no tools of requirements/fpga.lock: `make formal`")

TAG_W = 5


def wrong(name: str, width: int, bug: Bug | None = None) -> list[str]:
    """Return a line for each bit that is wrong or does not leave with its valid bit."""
    path = MODELS[name]
    top = path.entity
    place = ROOT / "build" / "formal_exits" / f"{name}{width}{'-bug' if bug else ''}"
    shutil.rmtree(place, ignore_errors=True)
    copy_rtl(place, bug)
    files = [file for file in closure(top, place) if file.suffix == ".v"]
    for file in files:
        if file.parent.name == "lib" and file.stem != "ik_delay":  # an operator is a cell, whose body is not needed
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
        "out_data": [
            Bit("node", field, k, clocks=out - nodes[field].time) for field in path.results for k in range(width)
        ],
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


BUILT = [
    (path, w)
    for path in (*CONFIGURATIONS.values(), ARM)
    if path.period == 1
    for w in (16, 18, 23, 32)
    if w in path.widths
]
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
"""Datapath -> a word or tag that leaves a clock early."""


@pytest.mark.parametrize("name", EARLY)
def test_an_early_word_is_found(name):
    lines = wrong(name, 18, EARLY[name])
    assert lines and lines[0].startswith(EARLY[name].fails), lines

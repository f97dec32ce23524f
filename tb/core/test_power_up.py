# SPDX-License-Identifier: Apache-2.0
"""Power-up in Icarus, where registers start as X: valid and irq are low before the first clock, ready under reset."""

import re
import subprocess

import pytest

from tb.sim.env import environment
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import includes, sources

TOPS = [
    ("ik_axis", {"W": 16}),
    ("ik_axis", {"W": 16, "DATAPATH": 0}),
    ("ik_axis", {"W": 20, "DATAPATH": 2}),
    ("ik_axi", {"W": 16}),
]
ALWAYS_READY = ("m_axi_rready", "m_axi_bready")
KNOWN = {"ik_axis": 1, "ik_axi": 6}
"""Number of valid outputs, including the interrupt."""

BUG = Bug("valid without an initial value", "rtl/lib/ik_fifo.v", "  initial m_valid = 1'b0;\n", "")


def wrong(place, top: str, parameters: dict[str, int], root) -> list[str]:
    """Return a line for each output that is not 0: valid without reset, valid and ready under reset."""
    text = next(path for path in sources(root) if path.stem == top).read_text()
    ports = re.findall(r"^\s*(in|out)put\s+wire\s*(?:\[.*?\])?\s*(\w+)", text, re.M)
    outputs = [name for way, name in ports if way == "out"]
    offers = [name for name in outputs if re.search(r"valid$|^irq$", name)]
    takes = [name for name in outputs if name.endswith("ready") and name not in ALWAYS_READY]
    assert len(offers) == KNOWN[top] and takes
    values = ", ".join(f".{k}({v})" for k, v in parameters.items())
    wires = ", ".join(f".{name}({name})" for name in ("clk", "rst", *offers, *takes))
    shown = [f'if ({name} !== 1\'b0) $display("{name} %b", {name});' for name in offers]
    under = [f'if ({name} !== 1\'b0) $display("{name} %b under reset", {name});' for name in (*offers, *takes)]
    lines = [
        "module top;", "reg clk, rst;", f"wire {', '.join((*offers, *takes))};", f"{top} #({values}) u ({wires});",
        "initial begin", "#1", *shown, "rst = 1; clk = 0; #1", *under, "end", "endmodule", "",
    ]  # fmt: skip
    (place / "top.v").write_text("\n".join(lines))
    folders = [f"-I{folder}" for folder in includes(root)]
    build = ["iverilog", "-g2001", "-s", "top", "-o", place / "top", *folders, place / "top.v", *sources(root)]
    subprocess.run(build, env=environment(), check=True, capture_output=True)
    done = subprocess.run(["vvp", "-n", place / "top"], env=environment(), check=True, capture_output=True, text=True)
    return done.stdout.splitlines()


@pytest.mark.parametrize(("top", "parameters"), TOPS)
def test_nothing_is_offered(top, parameters, tmp_path):
    assert wrong(tmp_path, top, parameters, copy_rtl(tmp_path)) == []


@pytest.mark.slow
def test_unknown_valid_is_detected(tmp_path):
    assert wrong(tmp_path, *TOPS[1], copy_rtl(tmp_path, BUG)) != []

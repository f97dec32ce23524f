# SPDX-License-Identifier: Apache-2.0
"""A small design mapped to each family, and simulated next to its RTL; netlists that differ are refused."""

import json
from pathlib import Path

import pytest

from scripts.fpga import netlist, simulation
from scripts.fpga.runs import MACROS, SRL16_MAP, SYNTHESIZE
from scripts.fpga.tools import LeftOutError, call, program
from tb.sim.sources import closure

SMALL = Path(__file__).with_name("ik_small.v")

pytestmark = pytest.mark.needs("fpga", "verilator")


def mapped(folder, family, factor="a", square=0):
    """Map the design to a family and simulate its netlist; return what simulated() returns."""
    files = [path for name in ("ik_exact", "ik_delay", "ik_ring", "ik_quadratic") for path in closure(name)]
    for path in (*files, SRL16_MAP):
        (folder / path.name).write_text(path.read_text())
    text = SMALL.read_text()
    for name, value in {"FACTOR": factor, "PRODUCT": square, "PART": int(family == "ecp5")}.items():
        text = text.replace(name, str(value))
    ports = simulation.Ports(text)
    (folder / "ik_small.v").write_text(text)
    (folder / "fpga_top.v").write_text(ports.wrapper({}, "fpga_top"))
    names = " ".join(dict.fromkeys(path.name for path in files))
    script = [
        f"read_verilog -defer{MACROS.get(family, '')} fpga_top.v ik_small.v {names}",
        "hierarchy -check -top fpga_top",
    ]
    script += SYNTHESIZE[family].format(top="fpga_top", family=family, flatten=" -flatten").split("; ")
    (folder / "run.ys").write_text("\n".join([*script, "write_json netlist.json", ""]))
    call([program("yosys"), "-q", "-l", "yosys.log", "run.ys"], folder, family)
    design = json.loads((folder / "netlist.json").read_text())
    if family == "ecp5":
        packed = netlist.pack_registers(design["modules"]["fpga_top"])
        assert packed.pop("flip_flops") > 200
        assert packed == {"multipliers": 13, "memory": 2, "input": 11, "output": 11}
    return simulation.simulated(folder, design, [folder / "ik_small.v", *files], ports, {}, family, True)


@pytest.mark.parametrize(
    "family",
    ["xc7", "ecp5", "up5k", "gowin", *(pytest.param(each, marks=pytest.mark.release) for each in ("xcup", "xc2vp"))],
)
def test_a_netlist_equals_the_rtl(tmp_path, family):
    assert mapped(tmp_path, family, square=int(family == "up5k"))["results"] >= 8000


@pytest.mark.parametrize(
    ("family", "factor"), [("xc7", "{a[17], a[17:0]}"), pytest.param("up5k", "a", marks=pytest.mark.release)]
)
def test_a_wrong_netlist_is_refused(tmp_path, family, factor):
    """Yosys 0.70 loses bits of a product's register on xc7 where an operand is sign-extended, and on iCE40 where there
    is a second register."""
    with pytest.raises(LeftOutError, match="clocks differ from the RTL"):
        mapped(tmp_path, family, factor)

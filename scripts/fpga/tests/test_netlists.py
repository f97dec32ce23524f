# SPDX-License-Identifier: Apache-2.0
"""A small design mapped to each family, and simulated next to its RTL; netlists that differ are refused."""

import json

import pytest

from scripts.fpga import netlist, simulation
from scripts.fpga.runs import MACROS, SRL16_MAP, SYNTHESIZE
from scripts.fpga.tools import call, program
from tb.sim.sources import closure

SMALL = """
module ik_small (
    input  wire clk,
    input  wire rst,
    input  wire in_valid,
    input  wire [18:0] a,
    input  wire [18:0] b,
    input  wire [21:0] word,
    output reg  out_valid,
    output wire [37:0] p,
    output wire [37:0] square,
    output wire [21:0] late,
    output wire [31:0] y,
    output reg  [12:0] row
);
  reg [12:0] rom[0:511];
  integer n;
  initial for (n = 0; n < 512; n = n + 1) rom[n] = n * n * 7;
  always @(posedge clk) begin
    out_valid <= in_valid && !rst;
    row <= rom[a[8:0]];
  end
  ik_exact #(.W(19), .SQUARE(PRODUCT)) u_p (.clk(clk), .a(a), .b(b), .p(p));
  ik_exact #(.W(19), .SQUARE(1)) u_square (.clk(clk), .a(FACTOR), .b(19'd0), .p(square));
  ik_quadratic u_y (.clk(clk), .c0({word[14:0], word}), .c1({a, b[6:0]}), .c2(b[14:0]), .u({a[18:12], b[18:2]}),
      .twice(word[0]), .y(y));
  wire [21:0] shifted;
  ik_delay #(.W(22), .N(20)) u_delay (.clk(clk), .d(word), .q(shifted));
  ik_ring #(.W(22), .N(300)) u_ring (.clk(clk), .rst(rst), .d(shifted), .q(late));
endmodule
"""
"""Products, tiles in logic on ECP5, a shift register, a table and a memory that is written."""

pytestmark = pytest.mark.slow


def mapped(folder, family, factor="a", square=0):
    """Map the design to a family and simulate its netlist; return what simulated() returns."""
    files = [path for name in ("ik_exact", "ik_delay", "ik_ring", "ik_quadratic") for path in closure(name)]
    for path in (*files, SRL16_MAP):
        (folder / path.name).write_text(path.read_text())
    text = SMALL.replace("FACTOR", factor).replace("PRODUCT", str(square))
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
        assert netlist.pack_registers(design["modules"]["fpga_top"])["flip_flops"]
    return simulation.simulated(folder, design, [folder / "ik_small.v", *files], ports, {}, family, True)


@pytest.mark.parametrize("family", ["xc2vp", "xc7", "xcup", "ecp5", "up5k", "gowin"])
def test_a_netlist_equals_the_rtl(tmp_path, family):
    assert mapped(tmp_path, family, square=int(family == "up5k"))["results"] >= 8000


@pytest.mark.parametrize(("family", "factor"), [("xc7", "{a[17], a[17:0]}"), ("up5k", "a")])
def test_a_wrong_netlist_is_refused(tmp_path, family, factor):
    """Yosys 0.70 loses bits of a product's register on xc7 where an operand is sign-extended, and on iCE40 where there
    is a second register."""
    with pytest.raises(simulation.DiffersError):
        mapped(tmp_path, family, factor)

# SPDX-License-Identifier: Apache-2.0
"""scripts/lint.py on small modules written for the occasion."""

from scripts import lint
from tb.sim.sources import LIST

HEAD = "// SPDX-License-Identifier: Apache-2.0\n`default_nettype none\n"
TAIL = "\n`default_nettype wire\n"

CLEAN = """
module ik_sum #(parameter W = 32) (
    input  wire                clk,
    input  wire signed [W-1:0] a,
    input  wire signed [W-1:0] b,
    output reg  signed [W:0]   s
);
    always @(posedge clk)
        s <= {a[W-1], a} + {b[W-1], b};
endmodule
"""

# a 32-bit right side is cut to 31 bits, or an 18-bit one to 17
WIDTH = CLEAN.replace("output reg  signed [W:0]  ", "output reg  signed [W-2:0]")

LATCH = """
module ik_sum (
    input  wire       enable,
    input  wire [3:0] a,
    output reg  [3:0] q
);
    always @(*)
        if (enable)
            q = a;
endmodule
"""


def lint_text(tmp_path, capsys, text, name="ik_sum", folder="lib"):
    """Exit status and output of the lint over a checkout whose list names one more file."""
    rtl = tmp_path / "rtl"
    (rtl / folder).mkdir(parents=True, exist_ok=True)
    (rtl / folder / f"{name}.v").write_text(HEAD + text + TAIL)
    (tmp_path / LIST).write_text("\n".join(["+incdir+cores", *(str(p.relative_to(rtl)) for p in rtl.glob("*/*.v"))]))
    status = lint.main(["--root", str(tmp_path), "--no-python"])
    return status, capsys.readouterr().out


def test_clean_module_passes_at_both_widths(tmp_path, capsys):
    status, out = lint_text(tmp_path, capsys, CLEAN)
    assert status == 0, out
    assert out.startswith("ok   ik_sum") and "W=32, W=18" in out
    assert out.splitlines()[1:] == ["1 of 1 Verilog modules without a finding"]


def test_implicit_width_mismatch_fails(tmp_path, capsys):
    status, out = lint_text(tmp_path, capsys, WIDTH)
    assert status == 1
    assert out.startswith("FAIL ik_sum") and "%Warning-WIDTHTRUNC" in out


def test_mismatch_at_one_width_only_fails(tmp_path, capsys):
    """Right at the default of 32 bits, wrong at 18: what the second parameter set is for."""
    text = CLEAN.replace("output reg  signed [W:0]  ", "output reg  signed [32:0] ")
    status, out = lint_text(tmp_path, capsys, text)
    assert status == 1 and "WIDTHEXPAND" in out


def test_latch_fails(tmp_path, capsys):
    status, out = lint_text(tmp_path, capsys, LATCH)
    assert status == 1 and "%Warning-LATCH" in out


def test_implicit_net_fails(tmp_path, capsys):
    text = CLEAN.replace("s <= {a[W-1], a}", "s <= {a[W-1], typo}")
    status, out = lint_text(tmp_path, capsys, text)
    assert status == 1 and "typo" in out


def test_systemverilog_fails(tmp_path, capsys):
    text = CLEAN.replace("input  wire                clk", "input  logic               clk")
    assert lint_text(tmp_path, capsys, text)[0] == 1


def test_what_lies_beside_rtl_is_looked_at(tmp_path, capsys):
    rules = tmp_path / "tb" / "rules"
    rules.mkdir(parents=True)
    (rules / "ik_rule.v").write_text(HEAD + WIDTH.replace("ik_sum", "ik_rule") + TAIL)
    status, out = lint_text(tmp_path, capsys, CLEAN)
    assert status == 1 and "FAIL ik_rule" in out and "1 of 2" in out


def test_modules_find_each_other_across_folders(tmp_path, capsys):
    (tmp_path / "rtl/cores").mkdir(parents=True)
    (tmp_path / "rtl/cores/ik_width.vh").write_text("`define IK_WIDTH 8\n")
    top = """
`include "ik_width.vh"
module ik_top (
    input  wire                        clk,
    input  wire signed [`IK_WIDTH-1:0] a,
    output wire signed [`IK_WIDTH:0]   s
);
    ik_sum #(.W(`IK_WIDTH)) sum (.clk(clk), .a(a), .b(a), .s(s));
endmodule
"""
    assert lint_text(tmp_path, capsys, CLEAN, folder="lib")[0] == 0
    status, out = lint_text(tmp_path, capsys, top, name="ik_top", folder="cores")
    assert status == 0, out
    assert "2 of 2" in out
    # a port one bit too narrow shows in the module that connects it
    status, out = lint_text(tmp_path, capsys, top.replace("_WIDTH:0]  ", "_WIDTH-1:0]"), "ik_top", "cores")
    assert status == 1 and "FAIL ik_top" in out and "ok   ik_sum" in out


def test_waiver_file_is_used(tmp_path, capsys):
    text = CLEAN.replace("    always", "    wire spare = a[0];\n    always")
    assert lint_text(tmp_path, capsys, text)[0] == 1
    (tmp_path / "rtl/lint.vlt").write_text(
        '`verilator_config\nlint_off -rule UNUSEDSIGNAL -file "*/ik_sum.v" -match "*\'spare\'*"\n'
    )
    status, out = lint_text(tmp_path, capsys, text)
    assert status == 0, out


def test_names_are_checked(tmp_path, capsys):
    status, out = lint_text(tmp_path, capsys, CLEAN, name="ik_other")
    assert status == 1 and "must hold the one module ik_other" in out
    (tmp_path / "rtl/lib/ik_other.v").unlink()
    status, out = lint_text(tmp_path, capsys, CLEAN.replace("ik_sum", "sum"), name="sum")
    assert status == 1 and "starts with ik_" in out


def test_nothing_to_lint_is_an_error(tmp_path, capsys):
    assert lint.main(["--root", str(tmp_path)]) == 2
    assert lint.main(["--root", str(tmp_path / "none")]) == 2
    lint_text(tmp_path, capsys, CLEAN)
    assert lint.main(["--root", str(tmp_path), "ik_none"]) == 2
    assert "no module ik_none" in capsys.readouterr().err


def test_parameter_sets():
    assert lint.parameter_sets("ik_a", "module ik_a (input wire W);") == [{}]
    headers = ("W = 32", "integer W=32", "signed [5:0] W = 32", "N = 4, parameter W = 8", "N=4, W=8")
    for header in ("parameter " + h for h in headers):
        assert lint.parameter_sets("ik_a", f"module ik_a #({header}) ();") == [{"W": 32}, {"W": 18}], header
    assert lint.parameter_sets("ik_a", "module ik_a #(parameter WI = 32, IW = 2) ();") == [{}]
    assert lint.parameter_sets("ik_a", "localparam W = 3;") == [{}]

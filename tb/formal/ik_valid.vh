// SPDX-License-Identifier: Apache-2.0
// Appended to ik_lean, ik_paper or ik_lean_arm without most of its instances: valid and tag have the latency of the
// abstract pipeline, ik_core.v. The tag of ik_lean_arm passes rings; tests/test_exits.py follows it in the netlist.
// No assumptions.

`ifdef IK_ARM
localparam integer T = T_OUT;
(* hierconn *) wire [T_QS_W-T_X-1:0] \u_lean.valid ;
wire [T-1:0] f_line = {valid_after, \u_lean.valid , valid};
`else
`include "ik_latency.vh"
localparam integer T = datapath_latency(`IK_LEAN, W, 18);
wire [T-1:0] f_line = valid;
(* hierconn *) wire [TAG_W*T_OUT-1:0] \u_tag.genblk1.genblk1.g_line.line ;
`endif

reg f_on = 1'b0;  // since the first reset
always @(posedge clk) if (rst) f_on <= 1'b1;

// ---- ghost: the inputs of the last T clocks ----

reg [T-1:0] f_valid;
always @(posedge clk) f_valid <= rst ? {T{1'b0}} : {f_valid[T-2:0], in_valid};

`ifndef IK_ARM
reg [TAG_W*T-1:0] f_tag;
always @(posedge clk) f_tag <= {f_tag[TAG_W*(T-1)-1:0], in_tag};
wire [T-1:0] f_row_tag;
genvar gi;
generate
  for (gi = 0; gi < T; gi = gi + 1) begin : g_f
    assign f_row_tag[gi] = !f_valid[gi] ||
        \u_tag.genblk1.genblk1.g_line.line [TAG_W*gi+:TAG_W] == f_tag[TAG_W*gi+:TAG_W];
  end
endgenerate
always @* if (f_on) begin
  tag_comes_out : assert (!out_valid || out_tag == f_tag[TAG_W*(T-1)+:TAG_W]);
  tag_line : assert (&f_row_tag);
end
`endif

always @* begin
  latency : assert (T_OUT == T);
  if (f_on) begin
    valid_comes_out : assert (out_valid == f_valid[T-1]);
    valid_line : assert (f_line == f_valid);
  end
end

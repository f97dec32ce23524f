// Abstract pipeline that replaces ik_lean, ik_paper or ik_lean_arm (macro IK_CORE): real latency, arbitrary results.
// SPDX-License-Identifier: Apache-2.0
//
// ik_axis and ik_arm pass results on unchanged, so each result may be arbitrary. One arbitrary target is followed: its
// result is the arbitrary constant f_result, with the target's tag. ik_valid.vh proves the latency of valid in the real
// modules, and the latency of the tag in ik_lean and ik_paper.
// Latency: T clocks, as in the real module.
`default_nettype none

module `IK_CORE #(
    parameter integer W     = 32,
    parameter integer TAG_W = 8,
    parameter integer DIGIT = 0,  // of ik_paper only
    parameter integer TILE  = 18,  // of ik_lean and ik_lean_arm only
    parameter integer CHOOSE = 0,  // of ik_lean_arm only, as EPS; ignored
    parameter integer EPS    = 0
) (
    input  wire                 clk,
    input  wire                 rst,
`ifdef IK_ARM
    input  wire [     14*W-1:0] limits,
    input  wire [          2:0] in_branch,
`endif
    input  wire                 in_valid,
    input  wire [    TAG_W-1:0] in_tag,
    input  wire [  `IK_IN*W-1:0] in_data,
    output wire                 out_valid,
    output wire [    TAG_W-1:0] out_tag,
    output wire [`IK_FLAGS-1:0] out_flags,
    output wire [ `IK_OUT*W-1:0] out_data
);

`ifdef IK_ARM
  `include "ik_arm_nodes.vh"
  localparam integer T = T_OUT;
`else
  `include "ik_latency.vh"
  localparam integer T = datapath_latency(`IK_LEAN, W, TILE);
`endif
  localparam integer DATA = `IK_OUT * W;

  (* anyconst *) wire [DATA+`IK_FLAGS-1:0] f_result;
  (* anyseq *) wire [DATA+TAG_W+`IK_FLAGS-1:0] f_any;
  (* anyseq *) wire f_pick;

  reg [T-1:0] valid;  // newest in bit 0
  reg [T-1:0] mark;   // stage of the followed target
  reg taken;          // a target was picked since the reset
  reg [TAG_W-1:0] tag;
  wire take = in_valid && f_pick && !taken;
  always @(posedge clk) begin
    if (rst) begin
      valid <= {T{1'b0}};
      mark  <= {T{1'b0}};
      taken <= 1'b0;
    end else begin
      valid <= {valid[T-2:0], in_valid};
      mark  <= {mark[T-2:0], take};
      taken <= taken || take;
    end
    if (take) tag <= in_tag;
  end

  assign out_valid = valid[T-1];
  assign {out_flags, out_tag, out_data} =
      mark[T-1] ? {f_result[DATA+`IK_FLAGS-1:DATA], tag, f_result[DATA-1:0]} : f_any;

`ifdef IK_COVER
  // the single path of ik_axis.vh: the first target is followed
  always @* assume (f_pick && f_any == 0 && f_result == 0);
`endif

endmodule

// Assertions about one slice of the pipeline's rows, see ik_axis.vh.
module ik_rows (
    input wire on,
    input wire counts,
    input wire bound,
    input wire below,
    input wire mark,
    input wire alone,
    input wire quiet,
    input wire above_if,
    input wire above,
    input wire waiting
);
  always @* if (on) begin
    rows_counts : assert (counts);
    rows_bound : assert (bound);
    rows_below : assert (below);
    rows_mark : assert (mark);
    rows_alone : assert (alone);
    rows_quiet : assert (quiet);
    rows_above_if : assert (above_if);
    rows_above : assert (above);
    rows_waiting : assert (waiting);
  end
endmodule

`default_nettype wire

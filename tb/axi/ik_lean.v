// Exact: returns the target's words, rotated by one; flags are the low bits of x. A quarter of the run time of ik_lean.
// SPDX-License-Identifier: Apache-2.0
//
// For tests of the logic around the core: every bit of a target reaches the result, and the latency equals ik_lean's.
// Latency: datapath_latency clocks.
`default_nettype none

module ik_lean #(
    parameter integer W     = 32,
    parameter integer TAG_W = 8,
    parameter integer TILE  = 18
) (
    input  wire             clk,
    input  wire             rst,
    input  wire             in_valid,
    input  wire [TAG_W-1:0] in_tag,
    input  wire [  6*W-1:0] in_data,
    output wire             out_valid,
    output reg  [TAG_W-1:0] out_tag,
    output reg  [      7:0] out_flags,
    output reg  [  6*W-1:0] out_data
);

  `include "ik_latency.vh"
  localparam integer T = datapath_latency(1, W, TILE);

  reg [T-1:0] valid;
  reg [6*W+TAG_W-1:0] line[0:T-2];
  integer at = 0;
  always @(posedge clk) begin
    valid <= rst ? {T{1'b0}} : {valid[T-2:0], in_valid};
    at <= (at == T - 2) ? 0 : at + 1;
    line[at] <= {in_tag, in_data};
    {out_tag, out_data[W-1:0], out_data[6*W-1:W]} <= line[at];
    out_flags <= line[at][7:0];
  end
  assign out_valid = valid[T-1];

endmodule

`default_nettype wire

// Exact: returns the 11 words of the hand pose, then the first 6 again; flags are the low bits of x XOR the branch.
// SPDX-License-Identifier: Apache-2.0
//
// Replaces ik_lean_arm in tests of the logic around the core, like ik_lean.v. The limits are ignored.
// Latency: T_OUT clocks.
`default_nettype none

module ik_lean_arm #(
    parameter integer W     = 32,
    parameter integer TAG_W = 8,
    parameter integer TILE  = 18,
    parameter integer CHOOSE = 0,  // ignored, as EPS
    parameter integer EPS    = 0
) (
    input  wire             clk,
    input  wire             rst,
    input  wire [ 14*W-1:0] limits,
    input  wire             in_valid,
    input  wire [TAG_W-1:0] in_tag,
    input  wire [      2:0] in_branch,
    input  wire [ 11*W-1:0] in_data,
    output wire             out_valid,
    output reg  [TAG_W-1:0] out_tag,
    output reg  [     15:0] out_flags,
    output reg  [ 17*W-1:0] out_data
);

  `include "ik_arm_nodes.vh"

  reg [T_OUT-1:0] valid;
  reg [11*W+2+TAG_W:0] line[0:T_OUT-2];
  reg [2:0] branch;
  reg [11*W-1:0] data;
  integer at = 0;
  always @(posedge clk) begin
    valid <= rst ? {T_OUT{1'b0}} : {valid[T_OUT-2:0], in_valid};
    at <= (at == T_OUT - 2) ? 0 : at + 1;
    line[at] <= {in_tag, in_branch, in_data};
    {out_tag, branch, data} <= line[at];
  end
  assign out_valid = valid[T_OUT-1];
  always @* begin
    out_data = {data[6*W-1:0], data};
    out_flags = data[15:0] ^ {branch, 13'd0};
  end

endmodule

`default_nettype wire

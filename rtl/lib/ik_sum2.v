// Sum or difference of two words, rounded and saturated: q = sat(floor((a +- b) / 2^SH + 1/2)).
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up and saturates; a and b signed IW bits, q signed OW bits.
// ovf is valid with q and set if q is saturated. SAT = 0 is for sums proved to fit their format
// (docs/generated/wordlengths.md): no check, ovf is 0.
// Throughput: one result per clock.
// Latency: 2 clocks (LAT_SUM2), plus DA from a or DB from b.
`default_nettype none

module ik_sum2 #(
    parameter integer IW    = 40,  // width of a and b, same format
    parameter integer SH    = 8,   // fraction bits dropped
    parameter integer OW    = 32,  // width of q
    parameter integer SUB_B = 0,   // 1: a - b
    parameter integer SAT   = 1,   // 0: q always holds the sum
    parameter integer DA    = 0,   // delay of a, clocks
    parameter integer DB    = 0    // delay of b, clocks
) (
    input  wire                 clk,
    input  wire signed [IW-1:0] a,
    input  wire signed [IW-1:0] b,
    output reg  signed [OW-1:0] q,
    output reg                  ovf
);

  // One bit for the sum and one for the rounding; at least one more than q, for the range check.
  localparam integer RW = (IW + 2 > OW + SH) ? (IW + 2) : (OW + SH + 1);
  localparam [RW-1:0] HALF = (SH > 0) ? ({{(RW - 1) {1'b0}}, 1'b1} << (SH - 1)) : {RW{1'b0}};

  wire signed [IW-1:0] a_in;
  wire signed [IW-1:0] b_in;
  ik_delay #(.W(IW), .N(DA)) u_a (.clk(clk), .d(a), .q(a_in));
  ik_delay #(.W(IW), .N(DB)) u_b (.clk(clk), .d(b), .q(b_in));

  wire signed [RW-1:0] a_x = {{(RW - IW) {a_in[IW-1]}}, a_in};
  wire signed [RW-1:0] b_x = {{(RW - IW) {b_in[IW-1]}}, b_in};
  reg signed  [RW-1:0] sum;
  always @(posedge clk) sum <= (SUB_B != 0) ? (a_x - b_x) : (a_x + b_x);

  // Above HALF's bit, sum + HALF equals sum plus that bit of sum; this saves an inverter for a dropped bit.
  wire signed [RW-1:0] rounded = $signed(sum + (sum & HALF)) >>> SH;
  wire fits = (rounded[RW-1:OW-1] == {(RW - OW + 1) {rounded[RW-1]}});
  always @(posedge clk) begin
    q   <= (SAT == 0 || fits) ? rounded[OW-1:0] : {rounded[RW-1], {(OW - 1) {~rounded[RW-1]}}};
    ovf <= (SAT != 0) && !fits;
  end

endmodule

`default_nettype wire

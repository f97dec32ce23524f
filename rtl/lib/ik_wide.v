// Sum or difference of words twice as wide as the datapath: q = a + b, or a - b with SUB = 1.
// SPDX-License-Identifier: Apache-2.0
//
// Exact modulo 2^W; words of W bits.
// Throughput: one result per clock.
// Latency: 1 clock (LAT_WIDE), plus DA from a or DB from b.
`default_nettype none

module ik_wide #(
    parameter integer W   = 66,  // width of the words
    parameter integer SUB = 0,   // 1: subtract b
    parameter integer DA  = 0,   // delay of a, clocks
    parameter integer DB  = 0    // delay of b, clocks
) (
    input  wire                clk,
    input  wire signed [W-1:0] a,
    input  wire signed [W-1:0] b,
    output reg  signed [W-1:0] q
);

  wire signed [W-1:0] a_in;
  wire signed [W-1:0] b_in;
  ik_delay #(.W(W), .N(DA)) u_a (.clk(clk), .d(a), .q(a_in));
  ik_delay #(.W(W), .N(DB)) u_b (.clk(clk), .d(b), .q(b_in));

  always @(posedge clk) q <= (SUB != 0) ? a_in - b_in : a_in + b_in;

endmodule

`default_nettype wire

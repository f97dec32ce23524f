// Exact, any format: q = a, or b with either sign. -b is modulo 2^W.
// SPDX-License-Identifier: Apache-2.0
//
// Choice and sign change by one carry chain, a LUT a bit: the chosen word, inverted, plus 1. With CUT > 0 the lowest bits
// of both words are dropped, and those of q are 0.
// Latency: 1 clock (LAT_MUX).
`default_nettype none

module ik_pick #(
    parameter integer W   = 32,  // width of the words
    parameter integer CUT = 0    // lowest bits of q that are 0
) (
    input  wire                clk,
    input  wire signed [W-1:0] a,
    input  wire signed [W-1:0] b,
    input  wire                use_b,
    input  wire                minus,  // of b
    output reg  signed [W-1:0] q
);

  wire [W-1:0] word = use_b ? (b ^ {W{minus}}) : a;
  always @(posedge clk) q <= ((word >> CUT) + {{(W - 1) {1'b0}}, use_b & minus}) << CUT;

endmodule

`default_nettype wire

// Selects one of two words, the second with either sign: q = a, b or -b.
// SPDX-License-Identifier: Apache-2.0
//
// Exact, any format; -b is modulo 2^W.
// One carry chain, one LUT per bit: the selected word, inverted, plus 1.
// Throughput: one result per clock.
// Latency: 1 clock (LAT_MUX).
`default_nettype none

module ik_pick #(
    parameter integer W = 32  // width of the words
) (
    input  wire                clk,
    input  wire signed [W-1:0] a,
    input  wire signed [W-1:0] b,
    input  wire                use_b,
    input  wire                minus,  // negate b
    output reg  signed [W-1:0] q
);

  wire [W-1:0] word = use_b ? (b ^ {W{minus}}) : a;
  always @(posedge clk) q <= word + {{(W - 1) {1'b0}}, use_b & minus};

endmodule

`default_nettype wire

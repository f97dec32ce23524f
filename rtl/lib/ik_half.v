// Squared cosine or sine of half an angle, q = (1 +- c) / 2: equations (6), (7).
// SPDX-License-Identifier: Apache-2.0
//
// Exact, limited to [0, 1]; c signed Q2.(W-2), q unsigned, W-1 fraction bits.
// A cosine rounded past +-1 gives 0 or 1.
// Throughput: one result per clock.
// Latency: 1 clock (LAT_MUX).
`default_nettype none

module ik_half #(
    parameter integer W     = 32,  // width of the words
    parameter integer MINUS = 0    // 1: (1 - c) / 2
) (
    input  wire                clk,
    input  wire signed [W-1:0] c,
    output reg         [W-1:0] q
);

  // 1 + c with W-2 fraction bits has the same bits as (1 + c) / 2 with W-1.
  localparam signed [W:0] ONE = {3'b001, {(W - 2) {1'b0}}};
  localparam [W-1:0] TOP = {1'b1, {(W - 1) {1'b0}}};
  wire signed [W:0] c_x = {c[W-1], c};
  wire signed [W:0] u = (MINUS != 0) ? (ONE - c_x) : (ONE + c_x);

  always @(posedge clk) begin
    if (u[W]) q <= {W{1'b0}};
    else if (u[W-1:0] > TOP) q <= TOP;
    else q <= u[W-1:0];
  end

endmodule

`default_nettype wire

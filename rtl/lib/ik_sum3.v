// Sum of three words, rounded and saturated: q = sat(floor((a + b +- c) / 2^SH + 1/2)).
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up and saturates; a, b, c signed IW bits, q signed OW bits.
// One adder in front of ik_sum2; ovf and SAT as there.
// Throughput: one result per clock.
// Latency: 3 clocks (LAT_SUM3).
`default_nettype none

module ik_sum3 #(
    parameter integer IW    = 40,  // width of a, b and c, same format
    parameter integer SH    = 8,   // fraction bits dropped
    parameter integer OW    = 32,  // width of q
    parameter integer SUB_C = 0,   // 1: a + b - c
    parameter integer SAT   = 1    // 0: q always holds the sum
) (
    input  wire                 clk,
    input  wire signed [IW-1:0] a,
    input  wire signed [IW-1:0] b,
    input  wire signed [IW-1:0] c,
    output wire signed [OW-1:0] q,
    output wire                 ovf
);

  wire signed [IW:0] a_x = {a[IW-1], a};
  wire signed [IW:0] b_x = {b[IW-1], b};
  wire signed [IW:0] c_x = {c[IW-1], c};
  reg signed  [IW:0] ab;
  reg signed  [IW:0] c_q;
  always @(posedge clk) begin
    ab  <= a_x + b_x;
    c_q <= c_x;
  end

  ik_sum2 #(
      .IW   (IW + 1),
      .SH   (SH),
      .OW   (OW),
      .SUB_B(SUB_C),
      .SAT  (SAT)
  ) u_sum (
      .clk(clk),
      .a  (ab),
      .b  (c_q),
      .q  (q),
      .ovf(ovf)
  );

endmodule

`default_nettype wire

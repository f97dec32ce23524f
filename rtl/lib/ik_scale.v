// Products of several words with one factor: q_k = a_k * b / 2^SH, each as in ik_mul3.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up after truncation; signed words.
// Throughput: one set of products per clock.
// Latency: 3 clocks (LAT_MUL3), plus DA from a or DB from b.
`default_nettype none

module ik_scale #(
    parameter integer COUNT = 4,  // number of words
    parameter integer AW = 33,  // parameters of ik_mul3
    parameter integer BW = 33,
    parameter integer SH = 31,
    parameter integer OW = 33,
    parameter integer DA = 0,
    parameter integer DB = 0,
    parameter integer TILE = 18
) (
    input  wire                       clk,
    input  wire        [COUNT*AW-1:0] a,
    input  wire signed [      BW-1:0] b,
    output wire        [COUNT*OW-1:0] q
);

  genvar k;
  generate
    for (k = 0; k < COUNT; k = k + 1) begin : g_word
      ik_mul3 #(.AW(AW), .BW(BW), .SH(SH), .OW(OW), .DA(DA), .DB(DB), .TILE(TILE)) u_q (
          .clk(clk), .a(a[AW*k+:AW]), .b(b), .q(q[OW*k+:OW])
      );
    end
  endgenerate

endmodule

`default_nettype wire

// Square root: q = floor(sqrt(n * 2^SH)), 0 if n < 0.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down (floor); n signed NW bits, q signed QW bits, never negative.
// neg is valid with q and set if n is negative. A root that does not fit saturates. DIGIT selects the behavioural
// reference or ik_root_digit, a digit recurrence for synthesis; both give the same bits with the same latency.
// Throughput: one root per clock.
// Latency: LAT clocks. ik_root_digit limits LAT; the behavioural core accepts any.
`default_nettype none

module ik_root #(
    parameter integer NW    = 32,  // width of the radicand
    parameter integer SH    = 30,  // 2 F(q) - F(n)
    parameter integer QW    = 32,  // width of the root
    parameter integer LAT   = 32,  // latency, clocks
    parameter integer DIGIT = 0    // 1: digit recurrence, 0: behavioural
) (
    input  wire                 clk,
    input  wire signed [NW-1:0] n,
    output wire signed [QW-1:0] q,
    output wire                 neg
);

  generate
    if (DIGIT != 0) begin : g_digit
      ik_root_digit #(
          .NW (NW),
          .SH (SH),
          .QW (QW),
          .LAT(LAT)
      ) u_core (
          .clk(clk),
          .n  (n),
          .q  (q),
          .neg(neg)
      );
    end else begin : g_behavioural
      localparam integer XW = (NW + SH > 2 * QW) ? (NW + SH) : (2 * QW);

      // One result bit at a time, highest first: keep it if the square still fits.
      function [QW-1:0] root(input [XW-1:0] v);
        reg [QW-1:0] r;
        reg [XW-1:0] rest;   // v - r^2
        reg [XW-1:0] trial;  // (r + bit)^2 - r^2 = (2 r + bit) bit
        integer i;
        begin
          r = {QW{1'b0}};
          rest = v;
          for (i = QW - 2; i >= 0; i = i - 1) begin
            trial = ({{(XW - QW) {1'b0}}, r} << (i + 1)) | ({{(XW - 1) {1'b0}}, 1'b1} << (2 * i));
            if (rest >= trial) begin
              rest = rest - trial;
              r[i] = 1'b1;
            end
          end
          root = r;
        end
      endfunction

      wire negative = n[NW-1];
      wire [XW-1:0] radicand = {{(XW - NW) {1'b0}}, n} << SH;
      wire [QW-1:0] floor = negative ? {QW{1'b0}} : root(radicand);

      ik_delay #(
          .W(QW + 1),
          .N(LAT)
      ) u_latency (
          .clk(clk),
          .d  ({negative, floor}),
          .q  ({neg, q})
      );
    end
  endgenerate

endmodule

`default_nettype wire

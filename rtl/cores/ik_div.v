// Rounds down (floor), saturates: q = floor(n * 2^SH / d); n signed NW, d signed DW, q signed QW bits.
// SPDX-License-Identifier: Apache-2.0
//
// Behavioural. Where d <= 0 the quotient saturates by the sign of n, and 0 counts as positive. ovf is valid with q and
// says that q was saturated.
// Latency: LAT clocks, those of a pipelined radix-2 divider: magnitude, one row a quotient bit, sign.
`default_nettype none

module ik_div #(
    parameter integer NW  = 40,  // width of the dividend
    parameter integer DW  = 32,  // width of the divisor
    parameter integer SH  = 22,  // F(q) - F(n) + F(d)
    parameter integer QW  = 32,  // width of the quotient
    parameter integer LAT = 34   // clocks
) (
    input  wire                 clk,
    input  wire signed [NW-1:0] n,
    input  wire signed [DW-1:0] d,
    output wire signed [QW-1:0] q,
    output wire                 ovf
);

  // Wide enough for the dividend, the divisor and one sign bit more than q.
  localparam integer MW = ((NW + SH > DW) ? (NW + SH) : DW) + 1;
  localparam integer XW = (MW > QW) ? MW : (QW + 1);

  wire signed [XW-1:0] n_x = {{(XW - NW) {n[NW-1]}}, n};
  wire signed [XW-1:0] d_x = {{(XW - DW) {d[DW-1]}}, d};
  wire signed [XW-1:0] num = n_x <<< SH;
  wire positive = (d > 0);
  wire signed [XW-1:0] den = positive ? d_x : {{(XW - 1) {1'b0}}, 1'b1};
  wire signed [XW-1:0] toward_zero = num / den;
  wire signed [XW-1:0] rest = num - toward_zero * den;
  wire signed [XW-1:0] floor = rest[XW-1] ? (toward_zero - 1) : toward_zero;

  wire fits = positive && (floor[XW-1:QW-1] == {(XW - QW + 1) {floor[XW-1]}});
  wire [QW-1:0] bound = {n[NW-1], {(QW - 1) {~n[NW-1]}}};

  ik_delay #(
      .W(QW + 1),
      .N(LAT)
  ) u_latency (
      .clk(clk),
      .d  ({~fits, fits ? floor[QW-1:0] : bound}),
      .q  ({ovf, q})
  );

endmodule

`default_nettype wire

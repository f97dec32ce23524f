// Quotient of two words: q = floor(n * 2^SH / d).
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down (floor), saturates; n signed NW, d signed DW, q signed QW bits.
// The quotient saturates by the sign of n if d <= 0; n = 0 counts as positive. ovf is valid with q and set if q is
// saturated. DIGIT selects the behavioural reference or ik_div_digit, a digit recurrence for synthesis; both give the
// same bits with the same latency.
// Throughput: one quotient per clock.
// Latency: LAT clocks, plus DD from d. ik_div_digit limits LAT; the behavioural divider accepts any.
`default_nettype none

module ik_div #(
    parameter integer NW    = 40,  // width of the dividend
    parameter integer DW    = 32,  // width of the divisor
    parameter integer SH    = 22,  // F(q) - F(n) + F(d)
    parameter integer QW    = 32,  // width of the quotient
    parameter integer LAT   = 34,  // latency, clocks
    parameter integer DIGIT = 0,   // 1: digit recurrence, 0: behavioural
    parameter integer DD    = 0    // delay of d, clocks
) (
    input  wire                 clk,
    // Operands
    input  wire signed [NW-1:0] n,
    input  wire signed [DW-1:0] d,
    // Quotient
    output wire signed [QW-1:0] q,
    output wire                 ovf
);

  wire signed [DW-1:0] d_in;
  ik_delay #(.W(DW), .N(DD)) u_d (.clk(clk), .d(d), .q(d_in));

  generate
    if (DIGIT != 0) begin : g_digit
      ik_div_digit #(
          .NW (NW),
          .DW (DW),
          .SH (SH),
          .QW (QW),
          .LAT(LAT)
      ) u_core (
          .clk(clk),
          .n  (n),
          .d  (d_in),
          .q  (q),
          .ovf(ovf)
      );
    end else begin : g_behavioural
      // Wide enough for the dividend, the divisor and one sign bit more than q.
      localparam integer MW = ((NW + SH > DW) ? (NW + SH) : DW) + 1;
      localparam integer XW = (MW > QW) ? MW : (QW + 1);

      wire signed [XW-1:0] n_x = {{(XW - NW) {n[NW-1]}}, n};
      wire signed [XW-1:0] d_x = {{(XW - DW) {d_in[DW-1]}}, d_in};
      wire signed [XW-1:0] num = n_x <<< SH;
      wire positive = (d_in > 0);
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
    end
  endgenerate

endmodule

`default_nettype wire

// Reciprocal square root of a mantissa: y = 1/(2 sqrt m).
// SPDX-License-Identifier: Apache-2.0
//
// Faithful rounding; m unsigned with F+3 fraction bits in [1/4, 1), y with F fraction bits.
// The error is below one LSB of y (1.1 with small tables and F = 29), even if m is a truncated longer mantissa; proof
// in model/dataflow/quadratic.py.
// The second bit of m is taken as set if m < 1/4, so m = 0 gives y = 1. Where y is doubled, its LSB is 0.
// Half of the table's segments lie in [1/4, 1/2), half in [1/2, 1). Interpolation is linear up to F = 22, else
// quadratic; likewise for TILE < 18, which has the smallest table.
// The table's address is needed one clock before m is valid: m_next is m before its register.
// Throughput: one result per clock.
// Latency: 5 clocks after m, 8 if quadratic (LAT_RSQRT): the table's output register and ik_quadratic. A name's suffix
// is the clock after m in which it is valid.
`default_nettype none

module ik_rsqrt #(
    parameter integer F    = 31,  // fraction bits of y, 19 to 31; at most 29 with TILE < 18
    parameter integer TILE = 18   // width of the multipliers' longer operand, at least 16
) (
    input  wire         clk,
    input  wire [F+2:0] m_next,
    input  wire         twice,   // 1: y is doubled; valid with m
    output wire [  F:0] y
);

  generate
    if (F < 19 || F > 31 || (TILE < 18 && F > 29) || TILE < 16) begin : g_illegal
      ik_rsqrt_illegal_F u_stop ();
    end
  endgenerate

  // The rounding constant is 3/8 LSB of y, because a truncated mantissa makes y too large by up to 1/4, minus half of
  // the tiles' truncation error.
  `include "ik_rsqrt_table.vh"

  // 0: table; the highest bit of c0, always 1, is not stored
  localparam integer RB = F + 3 - INDEX_BITS;  // bits of m below its segment number
  reg [F+2:0] m_0;
  wire upper = m_next[F+2];
  reg [ROW_BITS-1:0] row_0;
  always @(posedge clk) begin
    m_0   <= m_next;
    row_0 <= rom[{upper, upper ? m_next[F+1:RB] : m_next[F:RB-1]}];
  end

  // 1: the memory's output register; u is the offset from the segment's middle; lower segments are half as wide
  localparam integer UW = U_FRAC - INDEX_BITS;
  wire [RB+UW-1:0] place_x = {m_0[RB-1:0], {UW{1'b0}}};
  wire [UW-1:0] place = place_x[RB+UW-1:RB];
  wire signed [UW-1:0] u_0 = m_0[F+2] ? {~place[UW-1], place[UW-2:0]} : {{2{~place[UW-2]}}, place[UW-3:0]};
  reg [ROW_BITS-1:0] row_1;
  reg signed [UW-1:0] u_1;
  always @(posedge clk) begin
    row_1 <= row_0;
    u_1   <= u_0;
  end

  // from 2 on
  reg [SUM_FRAC:0] c0_2;
  always @(posedge clk) c0_2 <= {2'b01, row_1[ROW_BITS-1-:C0_BITS], LOWEST};
  wire [SLOPE_BITS-1:0] c1_1 = {{(SLOPE_BITS - C1_BITS) {1'b0}}, row_1[C2_BITS+:C1_BITS]} << C1_UP;
  localparam integer C2_TOP = C2_BITS - (C2_BITS > 0 ? 1 : 0);  // one ignored bit if there is no c2
  wire [C2_TOP:0] c2_1 = row_1[C2_TOP:0];
  wire twice_y;
  ik_delay #(.W(1), .N(CLOCKS)) u_twice_y (.clk(clk), .d(twice), .q(twice_y));
  ik_quadratic #(
      .F(F), .SUM_FRAC(SUM_FRAC), .UW(UW), .U_LOW(U_LOW), .SW(SLOPE_BITS), .SLOPE_LOW(SLOPE_LOW), .DROP(DROP), .C2W(C2_BITS),
      .BEND_DROP(BEND_DROP)
  ) u_quadratic (
      .clk(clk),
      .c0 (c0_2),
      .c1 (c1_1[SLOPE_BITS-2:0]),
      .c2 (c2_1),
      .u  (u_1),
      .twice(twice_y),
      .y  (y)
  );

  wire unused = &{1'b0, m_0, place_x, c1_1};

endmodule

`default_nettype wire

// Rounds to nearest, faithful: y = 1/(2 sqrt m), m unsigned with F+3 fraction bits in [1/4, 1), y F fraction bits.
// SPDX-License-Identifier: Apache-2.0
//
// The error is below one place of y, 1.1 with small tables and F = 29, also where m is a longer mantissa cut off
// (model/dataflow/cores.py has the proof).
// Below 1/4 the second bit of m counts as if it were set, so that 0 gives 1. Doubled, y has a zero below its last place.
// From a table: one half of its segments lie in [1/4, 1/2), the other in [1/2, 1). Up to SHORT_FRAC fraction bits the
// function is straight in a segment, beyond a quadratic of it; so it is with TILE < 18, whose table is the smallest.
// The memory of the table has its address a clock before m is valid: m_next is m before a register.
// Latency: 5 clocks after m, 8 with a quadratic (LAT_RSQRT): the table's output register, and ik_quadratic. A name ends
// with the clock after m in which it is valid.
`default_nettype none

module ik_rsqrt #(
    parameter integer F    = 31,  // fraction bits of y, 19 to 31, to 29 with TILE < 18
    parameter integer TILE = 18   // bits of the multipliers' longer operand, 16 and more
) (
    input  wire         clk,
    input  wire [F+2:0] m_next,
    input  wire         twice,   // 1: y is doubled; with m
    output wire [  F:0] y
);

  generate
    if (F < 19 || F > 31 || (TILE < 18 && F > 29) || TILE < 16) begin : g_illegal
      ik_rsqrt_needs_F_from_19_to_31_and_to_29_with_TILE_from_16 u_stop ();
    end
  endgenerate

  // Rounding adds 3/8 of a place of y, because a mantissa cut off makes the root too large by up to a quarter, less half of
  // what the tiles lose by their cuts.
  `include "ik_rsqrt_table.vh"

  // 0: table; a row goes without the highest bit of c0, a one
  localparam integer RB = F + 3 - INDEX_BITS;  // bits of m below the number of its segment
  reg [F+2:0] m_0;
  wire upper = m_next[F+2];
  reg [ROW_BITS-1:0] row_0;
  always @(posedge clk) begin
    m_0   <= m_next;
    row_0 <= rom[{upper, upper ? m_next[F+1:RB] : m_next[F:RB-1]}];
  end

  // 1: the memory's output register; u is the place in the segment less its middle, the lower segments are half as wide
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
  wire [C2_BITS-(C2_BITS>0):0] c2_1 = row_1[C2_BITS-(C2_BITS>0):0];  // one bit, not looked at, if there is no c2
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

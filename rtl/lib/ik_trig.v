// Sine and cosine of phi/2, from a table.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds the magnitude half up, error below one LSB; signed Q2.F.
// phi is a binary angle, one turn = 2^W, so phi/2 lies in [-90, 90) degrees. The table holds the sine of a quarter
// turn; the cosine reads it from the other end, where u changes sign. Interpolation is linear up to F = 23, else
// quadratic; likewise for TILE < 18, which has the smallest table. Proof of the error bound: model/dataflow/quadratic.py.
// Throughput: one angle per clock.
// Latency: 11 clocks, 8 if linear (LAT_TRIG): magnitude, table, its output register, ik_quadratic, sign. A name's
// suffix is the clock in which it is valid.
`default_nettype none

module ik_trig #(
    parameter integer W    = 32,  // width of phi, 16 to 32
    parameter integer F    = 31,  // fraction bits of the results, 19 to 31; at most 29 with TILE < 18
    parameter integer TILE = 18   // width of the multipliers' longer operand, at least 16
) (
    input  wire                clk,
    input  wire signed [W-1:0] phi,
    output reg  signed [F+1:0] sin_h,
    output reg  signed [F+1:0] cos_h
);

  `include "ik_trig_table.vh"

  generate
    if (W < 16 || W > U_FRAC + 1 || F < 19 || F > 31 || (TILE < 18 && F > 29) || TILE < 16) begin : g_illegal
      ik_trig_illegal_width u_stop ();
    end
  endgenerate

  // 1: |phi|; its highest bit set is a quarter turn
  reg [W-1:0] a_1;
  reg minus_1;
  always @(posedge clk) begin
    a_1     <= (phi ^ {W{phi[W-1]}}) + {{(W - 1) {1'b0}}, phi[W-1]};
    minus_1 <= phi[W-1];
  end

  // 2: table; a quarter turn is the end of the last segment
  localparam integer RB = W - 1 - INDEX_BITS;  // bits of a below its segment number
  reg [ROW_BITS-1:0] sine_2;
  reg [ROW_BITS-1:0] cosine_2;
  reg [RB-1:0] rest_2;
  reg end_2;
  reg minus_2;
  wire [INDEX_BITS-1:0] row_1 = a_1[W-2:RB] | {INDEX_BITS{a_1[W-1]}};
  always @(posedge clk) begin
    sine_2   <= rom[row_1];
    cosine_2 <= rom[~row_1];
    rest_2   <= a_1[RB-1:0];
    end_2    <= a_1[W-1];
    minus_2  <= minus_1;
  end

  // 3: the memory's output registers; u is the offset from the segment's middle
  localparam integer UW = U_FRAC - INDEX_BITS + 1;  // also holds the end of the last segment
  wire [UW-1:0] place = {{(UW - RB) {1'b0}}, rest_2} << (UW - 1 - RB);
  reg [ROW_BITS-1:0] sine_3;
  reg [ROW_BITS-1:0] cosine_3;
  reg signed [UW-1:0] u_3;
  always @(posedge clk) begin
    sine_3   <= sine_2;
    cosine_3 <= cosine_2;
    u_3      <= {~place[UW-2] & ~end_2, ~place[UW-2], place[UW-3:0]};
  end

  // from 4 on
  reg [SUM_FRAC:0] sine_c0_4;
  reg [SUM_FRAC:0] cosine_c0_4;
  always @(posedge clk) begin
    sine_c0_4   <= {sine_3[ROW_BITS-1-:C0_BITS], LOWEST};
    cosine_c0_4 <= {cosine_3[ROW_BITS-1-:C0_BITS], LOWEST};
  end
  wire [SLOPE_BITS-1:0] sine_c1_3 = {{(SLOPE_BITS - C1_BITS) {1'b0}}, sine_3[C2_BITS+:C1_BITS]} << C1_UP;
  wire [SLOPE_BITS-1:0] cosine_c1_3 = {{(SLOPE_BITS - C1_BITS) {1'b0}}, cosine_3[C2_BITS+:C1_BITS]} << C1_UP;
  localparam integer C2_TOP = C2_BITS - (C2_BITS > 0 ? 1 : 0);  // one ignored bit if there is no c2
  wire [F:0] sine;
  wire [F:0] cosine;
  ik_quadratic #(
      .F(F), .SUM_FRAC(SUM_FRAC), .UW(UW), .U_LOW(U_LOW), .SW(SLOPE_BITS), .SLOPE_LOW(SLOPE_LOW), .DROP(DROP), .C2W(C2_BITS),
      .BEND_DROP(BEND_DROP), .RISES(1)
  ) u_sine (
      .clk(clk), .c0(sine_c0_4), .c1(sine_c1_3[SLOPE_BITS-2:0]), .c2(sine_3[C2_TOP:0]), .u(u_3), .twice(1'b0), .y(sine)
  );
  ik_quadratic #(
      .F(F), .SUM_FRAC(SUM_FRAC), .UW(UW), .U_LOW(U_LOW), .SW(SLOPE_BITS), .SLOPE_LOW(SLOPE_LOW), .DROP(DROP), .C2W(C2_BITS),
      .BEND_DROP(BEND_DROP), .BENDS_UP(1)
  ) u_cosine (
      .clk(clk), .c0(cosine_c0_4), .c1(cosine_c1_3[SLOPE_BITS-2:0]), .c2(cosine_3[C2_TOP:0]), .u(u_3), .twice(1'b0), .y(cosine)
  );

  // sign
  wire minus;
  ik_delay #(.W(1), .N(1+CLOCKS)) u_minus (.clk(clk), .d(minus_2), .q(minus));
  always @(posedge clk) begin
    sin_h <= ({1'b0, sine} ^ {(F + 2) {minus}}) + {{(F + 1) {1'b0}}, minus};
    cos_h <= {1'b0, cosine};
  end

  wire unused = &{1'b0, sine_c1_3, cosine_c1_3, place[UW-1]};

endmodule

`default_nettype wire

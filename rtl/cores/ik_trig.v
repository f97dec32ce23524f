// Rounds to nearest, sin half away from 0, cos half up: sine and cosine of phi/2, signed Q2.F, error below 0.73 ulp.
// SPDX-License-Identifier: Apache-2.0
//
// phi is a binary angle, one turn = 2^W, so phi/2 lies in [-90, 90) degrees. With the nearest of 512 table points,
// s = sin and c = cos of it, and v = sin(delta) of what is left of |phi|/2 (at most pi/2048):
//   sin = s + v (c - s v/2)    cos = c - v (s + c v/2)
// Words inside have TRIG_GUARD more fraction bits. model/dataflow/trig.py has the proof of the bound.
// Multiplier tiles of 18x18 bits: 9, or 5 up to F = 21.
// Latency: 10 clocks (LAT_TRIG): magnitude, table point, fine product, v, slope product, slope, tiles, tile sums, sum,
// sign.
`default_nettype none

module ik_trig #(
    parameter integer W = 32,  // width of phi, 16 to 32
    parameter integer F = 31   // fraction bits of the results, 19 to 31
) (
    input  wire                clk,
    input  wire signed [W-1:0] phi,
    output reg  signed [F+1:0] sin_h,
    output reg  signed [F+1:0] cos_h
);

  `include "ik_trig_table.vh"

  localparam integer U = F + TRIG_GUARD;  // fraction bits inside
  localparam integer DROP = TRIG_FRAC - U;  // table bits below those
  localparam [0:0] ONE_TILE = F <= 21;  // v times slope
  localparam integer VW = F - 3;  // width of v, signed with U fraction bits
  localparam integer VL = ONE_TILE ? 0 : F - 21;  // bits of v below its tile
  localparam integer VH = VW - VL;
  localparam integer MF = ONE_TILE ? 16 : F - 4;  // fraction bits of a slope
  localparam integer ML = MF - 16;  // bits of it below its tile

  generate
    if (W < 16 || W > 32 || F < 19 || F > 31) begin : g_illegal
      ik_trig_needs_W_of_16_to_32_and_F_of_19_to_31 u_stop ();
    end
  endgenerate

  // |phi|, and the sign for the end
  reg [W-1:0] a_1;
  always @(posedge clk) a_1 <= (phi ^ {W{phi[W-1]}}) + {{(W - 1) {1'b0}}, phi[W-1]};
  wire minus_9;
  ik_delay #(
      .W(1),
      .N(9)
  ) u_minus (
      .clk(clk),
      .d  (phi[W-1]),
      .q  (minus_9)
  );

  // Nearest table point i of 0..512, the point 512 - i of the cosine, and the signed rest. Bit 9 of i says 1.
  wire [9:0] i_floor = a_1[W-1:W-10];
  wire up = a_1[W-11];
  wire [W+11:0] rest_long = {a_1[W-11:0], 22'd0};
  wire [21:0] rest = rest_long[W+11:W-10];
  reg [9:0] i_2;
  reg [9:0] j_2;
  reg signed [17:0] fine_2;
  reg [TRIG_LOW_WIDTH-1:0] low_2;
  reg signed [TRIG_REST_WIDTH-1:0] rest_2;
  always @(posedge clk) begin
    i_2 <= i_floor + {9'd0, up};
    j_2 <= {i_floor[9], ~i_floor[8:0]} + {9'd0, ~up};
    fine_2 <= rest[21:4];
    low_2 <= low_arc(rest[3:0]);
    rest_2 <= rest_sine(rest[21:15]);
  end

  // v = (2 - TRIG_COMPLEMENT) fine, the bits below the tile and the rest of the sine from tables
  wire signed [TRIG_FRAC-9:0] base = {fine_2, low_2};
  wire signed [TRIG_FRAC-9:0] base_u = base >>> DROP;
  wire signed [TRIG_REST_WIDTH-1:0] rest_u = rest_2 >>> DROP;
  reg signed [36:0] fine_product_3;
  reg signed [VW-1:0] x_3;
  reg signed [VW-1:0] v_4;
  wire signed [36:0] fine_product_u = fine_product_3 >>> (40 - F);
  always @(posedge clk) begin
    fine_product_3 <= fine_2 * TRIG_COMPLEMENT;
    x_3 <= base_u[VW-1:0] + {{(VW - TRIG_REST_WIDTH) {rest_u[TRIG_REST_WIDTH-1]}}, rest_u};
    v_4 <= x_3 - fine_product_u[VW-1:0];
  end

  // table values, one dual-port memory
  reg [TRIG_FRAC-1:0] s_3;
  reg [TRIG_FRAC-1:0] c_3;
  reg s_one_3;
  reg c_one_3;
  reg [U:0] s_4;
  reg [U:0] c_4;
  always @(posedge clk) begin
    s_3 <= sine_table[i_2[8:0]];
    c_3 <= sine_table[j_2[8:0]];
    s_one_3 <= i_2[9];
    c_one_3 <= j_2[9];
    s_4 <= {s_one_3, s_3[TRIG_FRAC-1:DROP]};
    c_4 <= {c_one_3, c_3[TRIG_FRAC-1:DROP]};
  end
  wire [U:0] s_5;
  wire [U:0] c_5;
  ik_delay #(
      .W(2 * U + 2),
      .N(1)
  ) u_table_5 (
      .clk(clk),
      .d  ({s_4, c_4}),
      .q  ({s_5, c_5})
  );
  wire [U:0] s_7;
  wire [U:0] c_7;
  ik_delay #(
      .W(2 * U + 2),
      .N(2)
  ) u_table_7 (
      .clk(clk),
      .d  ({s_5, c_5}),
      .q  ({s_7, c_7})
  );
  wire signed [VW-1:0] v_6;
  ik_delay #(
      .W(VW),
      .N(2)
  ) u_v (
      .clk(clk),
      .d  (v_4),
      .q  (v_6)
  );

  // Slopes. Both terms of the sum m_s are rounded down; a - ~b = a + b + 1 takes half of it back.
  localparam integer P_DROP = 16 + U - VL - MF + 1;  // the last bit halves
  wire signed [VH-1:0] v_high_4 = v_4[VW-1:VL];
  wire signed [17:0] s_high_4 = {1'b0, s_4[U:U-16]};
  wire signed [17:0] c_high_4 = {1'b0, c_4[U:U-16]};
  reg signed [VH+17:0] p_s_5;
  reg signed [VH+17:0] p_c_5;
  wire [MF+1:0] p_s_m = {{(MF + 2 + P_DROP - VH - 18) {p_s_5[VH+17]}}, p_s_5[VH+17:P_DROP]};
  wire [MF+1:0] p_c_m = {{(MF + 2 + P_DROP - VH - 18) {p_c_5[VH+17]}}, p_c_5[VH+17:P_DROP]};
  reg signed [MF+1:0] m_c_6;
  reg signed [MF+1:0] m_s_6;
  always @(posedge clk) begin
    p_s_5 <= s_high_4 * v_high_4;
    p_c_5 <= c_high_4 * v_high_4;
    m_c_6 <= {1'b0, c_5[U:U-MF]} - p_s_m;
    m_s_6 <= {1'b0, s_5[U:U-MF]} - ~p_c_m;
  end

  // v times slope: the tile of the high parts, and the sum of the mixed ones. That of the low parts is left out.
  localparam integer HIGH_DROP = 16 - VL;
  wire signed [17:0] m_c_high = m_c_6[MF+1:ML];
  wire signed [17:0] m_s_high = m_s_6[MF+1:ML];
  wire signed [VH-1:0] v_high = v_6[VW-1:VL];
  reg signed [VH+17:0] high_c_7;
  reg signed [VH+17:0] high_s_7;
  wire [U+1:0] high_c_u = {{(U + 2 + HIGH_DROP - VH - 18) {high_c_7[VH+17]}}, high_c_7[VH+17:HIGH_DROP]};
  wire [U+1:0] high_s_u = {{(U + 2 + HIGH_DROP - VH - 18) {high_s_7[VH+17]}}, high_s_7[VH+17:HIGH_DROP]};
  always @(posedge clk) begin
    high_c_7 <= m_c_high * v_high;
    high_s_7 <= m_s_high * v_high;
  end

  wire [U+1:0] middle_c_u;
  wire [U+1:0] middle_s_u;
  generate
    if (ONE_TILE) begin : g_one_tile
      assign middle_c_u = {(U + 2) {1'b0}};
      assign middle_s_u = {(U + 2) {1'b0}};
    end else begin : g_tiles
      wire signed [VL:0] v_low = {1'b0, v_6[VL-1:0]};
      wire signed [ML:0] m_c_low = {1'b0, m_c_6[ML-1:0]};
      wire signed [ML:0] m_s_low = {1'b0, m_s_6[ML-1:0]};
      reg signed [ML+18:0] lh_c;
      reg signed [ML+18:0] lh_s;
      reg signed [VL+18:0] hl_c;
      reg signed [VL+18:0] hl_s;
      reg signed [ML+19:0] middle_c;
      reg signed [ML+19:0] middle_s;
      always @(posedge clk) begin
        lh_c <= m_c_low * v_high;
        lh_s <= m_s_low * v_high;
        hl_c <= m_c_high * v_low;
        hl_s <= m_s_high * v_low;
        // ML = VL + 1
        middle_c <= {lh_c[ML+18], lh_c} + {hl_c[VL+18], hl_c, 1'b0};
        middle_s <= {lh_s[ML+18], lh_s} + {hl_s[VL+18], hl_s, 1'b0};
      end
      assign middle_c_u = {{(U - ML - 1) {middle_c[ML+19]}}, middle_c[ML+19:17]};
      assign middle_s_u = {{(U - ML - 1) {middle_s[ML+19]}}, middle_s[ML+19:17]};
      wire unused_g = &{1'b0, middle_c[16:0], middle_s[16:0]};
    end
  endgenerate

  // Sums. High and middle are rounded down: the first line takes half of it back, by s + high + 1 and c - high - 1.
  reg [U+1:0] outer_s_8;
  reg [U+1:0] outer_c_8;
  reg [U+1:0] sum_s_9;
  reg [U+1:0] sum_c_9;
  always @(posedge clk) begin
    outer_s_8 <= {1'b0, s_7} - ~high_c_u;
    outer_c_8 <= {1'b0, c_7} + ~high_s_u;
    sum_s_9   <= outer_s_8 + middle_c_u;
    sum_c_9   <= outer_c_8 - middle_s_u;
  end

  // x rounded is x + r; negated, ~x + 1 - r
  wire [F+1:0] sin_9 = sum_s_9[U+1:TRIG_GUARD];
  wire [F+1:0] cos_9 = sum_c_9[U+1:TRIG_GUARD];
  wire sin_round = sum_s_9[TRIG_GUARD-1];
  wire cos_round = sum_c_9[TRIG_GUARD-1];
  always @(posedge clk) begin
    sin_h <= (sin_9 ^ {(F + 2) {minus_9}}) + {{(F + 1) {1'b0}}, sin_round ^ minus_9};
    cos_h <= cos_9 + {{(F + 1) {1'b0}}, cos_round};
  end

  // fraction bits that are dropped, and sign bits above a word
  wire unused = &{
    1'b0, rest_long[W-11:0], base_u, fine_product_u, s_3, c_3, s_5, c_5, p_s_5[P_DROP-1:0], p_c_5[P_DROP-1:0],
    high_c_7[HIGH_DROP-1:0], high_s_7[HIGH_DROP-1:0], sum_s_9[TRIG_GUARD-2:0], sum_c_9[TRIG_GUARD-2:0]
  };

endmodule

`default_nettype wire

// Rounds to nearest, faithful: y = 1/(2 sqrt m), m unsigned with F+3 fraction bits in [1/4, 1), y F fraction bits.
// SPDX-License-Identifier: Apache-2.0
//
// The error is below one place of y, also where m is a longer mantissa cut off (model/dataflow/cores.py has the proof).
// m below 1/4 gives 0. A quadratic c0 - u (c1 - c2 u) in each of 256 segments of [0, 1), u in [-1/2, 1/2) the place in
// the segment; with F > 21 it gives a seed y0 of 17 bits for one Newton step, y0 (1 - (4 m y0^2 - 1) / 2).
// The memory of the table has its address a clock before m is valid: m_next is m before a register.
// Latency: 5 clocks after m, 11 with F > 21 (LAT_RSQRT): table's output register, c2 u, slope, slope u, sum; y0^2, tile
// products, middle sum, residual, product, sum. A name ends with the clock after m in which it is valid.
`default_nettype none

module ik_rsqrt #(
    parameter integer F = 31  // fraction bits of y, 19 to 31
) (
    input  wire         clk,
    input  wire [F+2:0] m_next,
    output wire [  F:0] y
);

  `include "ik_rsqrt_table.vh"

  localparam integer NEWTON = (F > SEED_FRAC) ? 1 : 0;
  localparam integer QF = (NEWTON != 0) ? SEED_BITS : F;  // fraction bits of the quadratic's result

  // 0: table, in one memory with two read ports: {c1, c2}, and c0 256 words higher. c0 includes the result's rounding,
  // but the seed of the first segment is rounded down: it has no word for 1.
  localparam integer WORD = C1_BITS + C2_BITS;
  localparam [2*WORD-1:0] HALF = {{(2 * WORD - 1) {1'b0}}, 1'b1} << (WORD + C0_FRAC - QF - 1);
  (* rom_style = "block", ram_style = "block" *)
  reg [WORD-1:0] rom[0:511];
  integer i;
  initial begin
    for (i = 0; i < 256; i = i + 1)
      {rom[256+i], rom[i]} = {{(WORD - C0_BITS) {1'b0}}, rsqrt_row(i)} +
                             ((NEWTON != 0 && i == 64) ? {(2 * WORD) {1'b0}} : HALF);
  end

  // The bits of m below the segment's number; with the highest inverted, u + 1/2 becomes u.
  localparam integer RB = F - 5;
  reg [F+2:0] m_0;
  wire [U_FRAC-1:0] place;
  generate
    if (F < 19 || F > 31) begin : g_illegal
      ik_rsqrt_needs_F_from_19_to_31 u_stop ();
    end
    if (RB < U_FRAC) begin : g_short
      assign place = {m_0[RB-1:0], {(U_FRAC - RB) {1'b0}}};
    end else begin : g_long
      assign place = m_0[RB-1:RB-U_FRAC];
    end
  endgenerate

  reg [WORD-1:0] c0_0;
  reg [WORD-1:0] c12_0;
  always @(posedge clk) begin
    m_0   <= m_next;
    c0_0  <= rom[{1'b1, m_next[F+2:RB]}];
    c12_0 <= rom[{1'b0, m_next[F+2:RB]}];
  end

  // 1: the memory's output register
  reg [C0_BITS-1:0] c0_1;
  reg [WORD-1:0] c12_1;
  reg signed [U_FRAC-1:0] u_1;
  always @(posedge clk) begin
    c0_1  <= c0_0[C0_BITS-1:0];
    c12_1 <= c12_0;
    u_1   <= {~place[U_FRAC-1], place[U_FRAC-2:0]};
  end

  // 2: c2 u
  localparam integer BW = C2_BITS + U_FRAC;
  wire signed [C2_BITS:0] c2_1 = {1'b0, c12_1[C2_BITS-1:0]};
  reg signed [BW-1:0] bend_2;
  reg [C1_BITS-1:0] c1_2;
  reg signed [U_FRAC-1:0] u_2;
  always @(posedge clk) begin
    bend_2 <= c2_1 * u_1;
    c1_2   <= c12_1[WORD-1:C2_BITS];
    u_2    <= u_1;
  end

  // 3: slope, never negative
  localparam integer DROP_2 = C2_FRAC + U_FRAC - C1_FRAC;
  wire signed [C1_BITS:0] bend_x = {{(C1_BITS + 1 - BW + DROP_2) {bend_2[BW-1]}}, bend_2[BW-1:DROP_2]};
  reg signed [C1_BITS:0] slope_3;
  reg signed [U_FRAC-1:0] u_3;
  always @(posedge clk) begin
    slope_3 <= $signed({1'b0, c1_2}) - bend_x;
    u_3     <= u_2;
  end

  // 4: slope u
  localparam integer FW = C1_BITS + U_FRAC;
  localparam integer DROP_4 = C1_FRAC + U_FRAC - C0_FRAC;
  reg signed [FW-1:0] fall_4;
  always @(posedge clk) fall_4 <= slope_3 * u_3;

  // 5: sum
  wire [C0_BITS-1:0] c0_4;
  ik_delay #(.W(C0_BITS), .N(3)) u_c0 (.clk(clk), .d(c0_1), .q(c0_4));
  wire [C0_FRAC:0] fall_x = {{(C0_FRAC + 1 - FW + DROP_4) {fall_4[FW-1]}}, fall_4[FW-1:DROP_4]};
  wire [C0_FRAC:0] sum = {1'b0, c0_4} - fall_x;
  reg [QF:0] y_5;
  always @(posedge clk) y_5 <= sum[C0_FRAC:C0_FRAC-QF];

  wire unused = &{1'b0, m_0, c0_0, bend_2, fall_4, sum};

  generate
    if (NEWTON == 0) begin : g_quadratic
      assign y = y_5;
    end else begin : g_newton
      localparam integer T = SEED_BITS;  // of y0, and of a tile's sides; m and y0^2 have 2 T fraction bits

      // 6: y0^2; y0 is less than 1
      wire [T-1:0] y0_5 = y_5[T-1:0];
      wire signed [T:0] y0_x = {1'b0, y0_5};
      wire [F+2:0] m_5;
      ik_delay #(.W(F + 3), .N(5)) u_m (.clk(clk), .d(m_0), .q(m_5));
      wire [2*T+F+2:0] m_x = {m_5, {(2 * T) {1'b0}}};
      reg [2*T-1:0] q_6;
      reg [2*T-1:0] m_6;
      always @(posedge clk) begin
        q_6 <= y0_x * y0_x;
        m_6 <= m_x[2*T+F+2:F+3];
      end

      // 7: tile products, with a zero sign bit; the integer part of the highest goes
      localparam integer RW = RESIDUAL_BITS + RESIDUAL_GUARD;
      localparam integer HW = RESIDUAL_BITS;  // the highest tile's last place is the residual's
      wire signed [T:0] m_hi = {1'b0, m_6[2*T-1:T]};
      wire signed [T:0] m_lo = {1'b0, m_6[T-1:0]};
      wire signed [T:0] q_hi = {1'b0, q_6[2*T-1:T]};
      wire signed [T:0] q_lo = {1'b0, q_6[T-1:0]};
      reg [HW-1:0] hh_7;
      reg [2*T-1:0] hl_7;
      reg [2*T-1:0] lh_7;
      reg [2*T-1:0] ll_7;
      always @(posedge clk) begin
        hh_7 <= m_hi * q_hi;
        hl_7 <= m_hi * q_lo;
        lh_7 <= m_lo * q_hi;
        ll_7 <= m_lo * q_lo;
      end

      // 8: middle sum; the outer tiles with half a place of the residual
      localparam integer DROP_8 = 4 * T - 2 - RESIDUAL_FRAC - RESIDUAL_GUARD;  // below the guard bits
      wire [2*T:0] middle = {1'b0, hl_7} + {1'b0, lh_7};
      reg [RW-1:0] mid_8;
      reg [RW-1:0] outer_8;
      always @(posedge clk) begin
        mid_8   <= middle[2*T:DROP_8-T];
        outer_8 <= {hh_7, ll_7[2*T-1:DROP_8]} + {{HW{1'b0}}, 1'b1, {(RESIDUAL_GUARD - 1) {1'b0}}};
      end

      // 9: residual 4 m y0^2 - 1
      wire [RW-1:0] residual = outer_8 + mid_8;
      wire [T-1:0] y0_8;
      ik_delay #(.W(T), .N(3)) u_y0 (.clk(clk), .d(y0_5), .q(y0_8));
      reg signed [RESIDUAL_BITS-1:0] e_9;
      reg signed [T:0] y0_9;
      always @(posedge clk) begin
        e_9  <= residual[RW-1:RESIDUAL_GUARD];
        y0_9 <= {1'b0, y0_8};
      end

      // 10: product
      localparam integer PW = RESIDUAL_BITS + T;
      reg signed [PW-1:0] p_10;
      reg [T-1:0] y0_10;
      always @(posedge clk) begin
        p_10  <= e_9 * y0_9;
        y0_10 <= y0_9[T-1:0];
      end

      // 11: sum; the product's rounding bit is borrowed from a place below
      localparam integer DROP_11 = RESIDUAL_FRAC + T - F;  // leaves that place
      wire [F+1:0] y0_w = {1'b0, y0_10, {(F + 1 - T) {1'b0}}};
      wire [F+1:0] p_x = {{(F + 2 - PW + DROP_11) {p_10[PW-1]}}, p_10[PW-1:DROP_11]};
      wire [F+1:0] difference = y0_w - p_x;
      reg [F:0] y_11;
      always @(posedge clk) y_11 <= difference[F+1:1];
      assign y = y_11;

      wire unused_newton = &{1'b0, y_5[T], m_x, ll_7, middle, residual, p_10, difference[0]};
    end
  endgenerate

endmodule

`default_nettype wire

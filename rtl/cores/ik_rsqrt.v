// Rounds to nearest, faithful: y = 1/(2 sqrt m), m unsigned with F+3 fraction bits in [1/4, 1), y F fraction bits.
// SPDX-License-Identifier: Apache-2.0
//
// The error is below one place of y, also where m is a longer mantissa cut off (model/dataflow/cores.py has the proof).
// m below 1/4 gives 0. A quadratic c0 - u (c1 - c2 u), u how far m is from the middle of its segment: 256 segments of
// [0, 1) up to F = SHORT_FRAC; beyond, 512 of [1/4, 1/2) and 512 of [1/2, 1), and slope times u in three tiles: that of
// the low parts is left out. A word's low part, below its tile, has U_LOW or SLOPE_LOW bits.
// The memory of the table has its address a clock before m is valid: m_next is m before a register.
// Latency: 5 clocks after m, 6 with F > SHORT_FRAC (LAT_RSQRT): table's output register, c2 u, slope, slope u; the sum of
// the mixed tiles; sum. A name ends with the clock after m in which it is valid.
`default_nettype none

module ik_rsqrt #(
    parameter integer F = 31  // fraction bits of y, 19 to 31
) (
    input  wire         clk,
    input  wire [F+2:0] m_next,
    output reg  [  F:0] y
);

  `include "ik_rsqrt_table.vh"

  generate
    if (F < 19 || F > 31) begin : g_illegal
      ik_rsqrt_needs_F_from_19_to_31 u_stop ();
    end
  endgenerate

  // Added to c0: 3/8 of a place of y, because a mantissa cut off makes the root too large by up to a quarter, less half
  // of what the tiles lose by their cuts. The bits below c0's words, SPARE, are added later, the rest is in the memory.
  localparam integer SPARE = SUM_FRAC - C0_FRAC;
  localparam integer ROUNDING = (3 << (SUM_FRAC - F - 3)) - (TILES + 1) / 2;
  localparam [ROW_BITS-1:0] ADD = {{(ROW_BITS - 32) {1'b0}}, ROUNDING} >> SPARE << (C1_BITS + C2_BITS);

  // 0: table. The long one has no row for m below 1/4, and its c0 no highest bit, a one.
  localparam integer RB = F + 3 - INDEX_BITS;  // bits of m below the number of its segment
  reg [F+2:0] m_0;
  always @(posedge clk) m_0 <= m_next;
  wire [ROW_BITS-1:0] row_0;
  wire half_0;  // the segment is half as wide
  integer i;
  generate
    if (LONG) begin : g_long_table
      (* rom_style = "block", ram_style = "block" *)
      reg [ROW_BITS-1:0] rom[0:ROWS-1];
      initial for (i = 0; i < ROWS; i = i + 1) rom[i] = long_row(i) + ADD;
      wire upper = m_next[F+2];
      reg [ROW_BITS-1:0] word;
      always @(posedge clk) word <= rom[{upper, upper ? m_next[F+1:RB] : m_next[F:RB-1]}];
      assign row_0  = word;
      assign half_0 = !m_0[F+2];
    end else begin : g_short_table
      // one memory with two read ports: {c1, c2}, and c0 256 words higher
      localparam integer WORD = C1_BITS + C2_BITS;
      (* rom_style = "block", ram_style = "block" *)
      reg [WORD-1:0] rom[0:2*ROWS-1];
      initial begin
        for (i = 0; i < ROWS; i = i + 1) {rom[ROWS+i], rom[i]} = {{(WORD - C0_BITS) {1'b0}}, short_row(i) + ADD};
      end
      reg [WORD-1:0] c0;
      reg [WORD-1:0] c12;
      always @(posedge clk) begin
        c0  <= rom[{1'b1, m_next[F+2:RB]}];
        c12 <= rom[{1'b0, m_next[F+2:RB]}];
      end
      assign row_0  = {c0[C0_BITS-1:0], c12};
      assign half_0 = 1'b0;
      wire unused_c0 = &{1'b0, c0};
    end
  endgenerate

  // 1: the memory's output register; u is the place in the segment less its middle
  localparam integer UW = U_FRAC - INDEX_BITS;  // width of u
  wire [RB+UW-1:0] place_x = {m_0[RB-1:0], {UW{1'b0}}};
  wire [UW-1:0] place = place_x[RB+UW-1:RB];
  reg [ROW_BITS-1:0] row_1;
  reg signed [UW-1:0] u_1;
  always @(posedge clk) begin
    row_1 <= row_0;
    u_1   <= {~place[half_0?UW-2 : UW-1], half_0 ? ~place[UW-2] : place[UW-2], place[UW-3:0]};
  end

  // 2: c2 u
  localparam integer UH = UW - U_LOW;
  localparam integer BW = C2_BITS + UH;
  wire signed [C2_BITS:0] c2_1 = {1'b0, row_1[C2_BITS-1:0]};
  wire signed [UH-1:0] u_hi_1 = u_1[UW-1:U_LOW];
  reg signed [BW-1:0] bend_2;
  reg [C1_BITS-1:0] c1_2;
  reg signed [UW-1:0] u_2;
  always @(posedge clk) begin
    bend_2 <= c2_1 * u_hi_1;
    c1_2   <= row_1[C1_BITS+C2_BITS-1:C2_BITS];
    u_2    <= u_1;
  end

  // 3: slope, never negative
  localparam integer BEND_DROP = C2_FRAC + U_FRAC - U_LOW - SLOPE_FRAC;
  localparam integer SW = C1_BITS + SLOPE_FRAC - C1_FRAC + 1;
  wire signed [SW-1:0] bend_x = {{(SW - BW + BEND_DROP) {bend_2[BW-1]}}, bend_2[BW-1:BEND_DROP]};
  wire [SW-1:0] c1_x = {{(SW - C1_BITS) {1'b0}}, c1_2} << (SLOPE_FRAC - C1_FRAC);
  reg signed [SW-1:0] slope_3;
  reg signed [UW-1:0] u_3;
  always @(posedge clk) begin
    slope_3 <= c1_x - bend_x;
    u_3     <= u_2;
  end

  // 4: slope u, the tile of the high parts
  localparam integer HW = SW - SLOPE_LOW + UH - 1;
  wire signed [SW-SLOPE_LOW-1:0] slope_hi_3 = slope_3[SW-1:SLOPE_LOW];
  wire signed [UH-1:0] u_hi_3 = u_3[UW-1:U_LOW];
  reg signed [HW-1:0] hh_4;
  always @(posedge clk) hh_4 <= slope_hi_3 * u_hi_3;

  wire [C0_BITS-1:0] c0_4;
  ik_delay #(.W(C0_BITS), .N(3)) u_c0 (.clk(clk), .d(row_1[ROW_BITS-1:C1_BITS+C2_BITS]), .q(c0_4));

  // 5: c0 less it
  localparam integer DROP = SLOPE_FRAC - SLOPE_LOW + U_FRAC - U_LOW - SUM_FRAC;
  wire [SUM_FRAC:0] hh_x = {{(SUM_FRAC + 1 - HW + DROP) {hh_4[HW-1]}}, hh_4[HW-1:DROP]};
  generate
    if (LONG) begin : g_long
      // the mixed tiles; a low part gets a zero sign bit
      wire signed [U_LOW:0] u_lo_3 = {1'b0, u_3[U_LOW-1:0]};
      wire signed [SLOPE_LOW:0] slope_lo_3 = {1'b0, slope_3[SLOPE_LOW-1:0]};
      localparam integer HLW = SW - SLOPE_LOW + U_LOW;
      localparam integer LHW = SLOPE_LOW + UH;
      reg signed [HLW-1:0] hl_4;
      reg signed [LHW-1:0] lh_4;
      always @(posedge clk) begin
        hl_4 <= slope_hi_3 * u_lo_3;
        lh_4 <= slope_lo_3 * u_hi_3;
      end

      localparam integer MW = LHW - DROP - SLOPE_LOW + 1;
      wire signed [MW-1:0] lh_x = {lh_4[LHW-1], lh_4[LHW-1:DROP+SLOPE_LOW]};
      wire [MW-1:0] hl_x = {{(MW - HLW + DROP + U_LOW) {1'b0}}, hl_4[HLW-1:DROP+U_LOW]};  // not negative
      reg signed [MW-1:0] mid_5;
      reg [SUM_FRAC:0] outer_5;
      wire mantissa_4;
      ik_delay #(.W(1), .N(4)) u_mantissa (.clk(clk), .d(|m_0[F+2:F+1]), .q(mantissa_4));
      always @(posedge clk) begin
        mid_5   <= mantissa_4 ? hl_x + lh_x : {MW{1'b0}};
        outer_5 <= mantissa_4 ? {2'b01, c0_4, ROUNDING[SPARE-1:0]} - hh_x : {(SUM_FRAC + 1) {1'b0}};
      end

      // 6: and less their sum
      wire [SUM_FRAC:0] sum = outer_5 - {{(SUM_FRAC + 1 - MW) {mid_5[MW-1]}}, mid_5};
      always @(posedge clk) y <= sum[SUM_FRAC:SUM_FRAC-F];
      wire unused_long = &{1'b0, hl_4, lh_4, sum};
    end else begin : g_short
      wire [SUM_FRAC:0] sum = {1'b0, c0_4} - hh_x;
      always @(posedge clk) y <= sum[SUM_FRAC:SUM_FRAC-F];
      wire unused_short = &{1'b0, sum};
    end
  endgenerate

  wire unused = &{1'b0, m_0, place_x, bend_2, hh_4};

endmodule

`default_nettype wire

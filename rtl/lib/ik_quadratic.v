// One segment of a table function: y = c0 -+ u slope, with slope = c1, or c1 -+ c2 u.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down. The sum of y has a plus with RISES = 1, the slope's with BENDS_UP = 1.
// model/dataflow/quadratic.py derives the tables; u is the argument's offset from the segment's middle. High parts have
// at most 18 bits. Slope times u takes one tile, or three: the tile of the low parts is omitted. The slope has the
// fraction bits of c1, the sum has SUM_FRAC, as c0. With the macro IK_LOGIC_TILES, a tile with at most 6 bits of u is
// built from logic, for devices with too few multipliers; bits and latency are the same.
// Throughput: one result per clock.
// Latency: 4 clocks: operands, tile products, sum (three tiles: outer and mixed sums), result; three more with C2W > 0:
// operands, c2 u, slope. A name's suffix is the clock in which it is valid, counted from the slope.
`default_nettype none

module ik_quadratic #(
    parameter integer F         = 31,  // fraction bits of y
    parameter integer SUM_FRAC  = 36,  // fraction bits of c0 and of the sum
    parameter integer UW        = 24,  // width of u
    parameter integer U_LOW     = 6,   // bits of u below its high part
    parameter integer SW        = 27,  // width of a slope, signed
    parameter integer SLOPE_LOW = 9,   // slope bits below its high part
    parameter integer DROP      = 8,   // fraction bits of the high tile below the sum's LSB
    parameter integer C2W       = 15,  // width of c2; 0: no c2
    parameter integer BEND_DROP = 15,  // fraction bits of c2 u below the slope's LSB
    parameter integer RISES     = 0,   // 1: y = c0 + u slope
    parameter integer BENDS_UP  = 0    // 1: slope = c1 + c2 u
) (
    input  wire                        clk,
    // Table row
    input  wire        [   SUM_FRAC:0] c0,  // one clock after c1, c2 and u
    input  wire        [       SW-2:0] c1,
    input  wire        [C2W-(C2W>0 ? 1 : 0):0] c2,
    // Argument
    input  wire signed [       UW-1:0] u,
    input  wire                        twice,  // 1: y is doubled; one clock before y
    // Result
    output reg         [          F:0] y
);

  localparam integer UH = UW - U_LOW;
  localparam integer C0_CLOCKS = (C2W > 0) ? 4 : 1;  // until the product is ready

  // ---- slope ----

  wire signed [SW-1:0] slope_0;
  wire signed [UW-1:0] u_0;
  generate
    if (C2W > 0) begin : g_bend
      localparam integer BW = C2W + UH;
      reg signed [C2W:0] c2_in;  // operands
      reg signed [UH-1:0] u_in;
      reg signed [BW-1:0] bend;
      wire signed [SW-1:0] bend_x = {{(SW - BW + BEND_DROP) {bend[BW-1]}}, bend[BW-1:BEND_DROP]};
      wire signed [SW-1:0] c1_at_bend;
      reg signed [SW-1:0] slope;
      ik_delay #(.W(SW), .N(2)) u_c1_at_bend (.clk(clk), .d({1'b0, c1}), .q(c1_at_bend));
      ik_delay #(.W(UW), .N(3)) u_u_0 (.clk(clk), .d(u), .q(u_0));
      always @(posedge clk) begin
        c2_in <= {1'b0, c2};
        u_in  <= u[UW-1:U_LOW];
        bend  <= c2_in * u_in;
        slope <= (BENDS_UP != 0) ? c1_at_bend + bend_x : c1_at_bend - bend_x;
      end
      assign slope_0 = slope;
      wire unused_bend = &{1'b0, bend};
    end else begin : g_straight
      assign slope_0 = {1'b0, c1};
      assign u_0 = u;
      wire unused_c2 = &{1'b0, c2};
    end
  endgenerate

  // ---- slope times u: operands and the high tile ----

  localparam integer SH = SW - SLOPE_LOW;
  localparam integer HW = SH + UH - 1;
  reg signed [SW-1:0] slope_1;
  reg signed [UW-1:0] u_1;
  wire signed [SH-1:0] slope_hi_1 = slope_1[SW-1:SLOPE_LOW];
  wire signed [UH-1:0] u_hi_1 = u_1[UW-1:U_LOW];
  reg signed [HW-1:0] hh_2;
  always @(posedge clk) begin
    slope_1 <= slope_0;
    u_1     <= u_0;
    hh_2    <= slope_hi_1 * u_hi_1;
  end

  // ---- sum ----

  wire [SUM_FRAC:0] c0_2;
  ik_delay #(.W(SUM_FRAC+1), .N(C0_CLOCKS)) u_c0_2 (.clk(clk), .d(c0), .q(c0_2));
  wire [SUM_FRAC:0] hh_x = {{(SUM_FRAC + 1 - HW + DROP) {hh_2[HW-1]}}, hh_2[HW-1:DROP]};
  wire [SUM_FRAC:0] outer = (RISES != 0) ? c0_2 + hh_x : c0_2 - hh_x;
  wire [SUM_FRAC:0] sum;
  generate
    if (SLOPE_LOW > 0) begin : g_tiles
      // the mixed tiles; a low part gets a zero sign bit
      localparam integer HLW = SH + U_LOW;
      localparam integer LHW = SLOPE_LOW + UH;
      wire signed [U_LOW:0] u_lo_1 = {1'b0, u_1[U_LOW-1:0]};
      wire signed [SLOPE_LOW:0] slope_lo_1 = {1'b0, slope_1[SLOPE_LOW-1:0]};
      wire signed [HLW-1:0] hl_2;
      reg signed [LHW-1:0] lh_2;
`ifdef IK_LOGIC_TILES
      localparam integer LOGIC = (U_LOW <= 6) ? 1 : 0;
`else
      localparam integer LOGIC = 0;
`endif
      if (LOGIC != 0) begin : g_logic
        // hl = slope_hi (pair 0 + 4 pair 1 + 16 pair 2) of u_lo; products by a pair are registered instead of operands
        localparam integer PW = SH + 2;
        wire [PW-1:0] hi_0 = {{2{slope_0[SW-1]}}, slope_0[SW-1:SLOPE_LOW]};
        wire [PW-1:0] twice_hi_0 = hi_0 << 1;
        wire [5:0] lo_0 = {{(6 - U_LOW) {1'b0}}, u_0[U_LOW-1:0]};
        reg [PW-1:0] pair0_1;
        reg [PW-1:0] pair1_1;
        reg [PW-1:0] pair2_1;
        wire [PW+3:0] pair0_x = {{4{pair0_1[PW-1]}}, pair0_1};
        wire [PW+3:0] pair1_x = {{2{pair1_1[PW-1]}}, pair1_1, 2'b0};
        reg [PW+3:0] pairs_2;
        always @(posedge clk) begin
          pair0_1 <= ({PW{lo_0[0]}} & hi_0) + ({PW{lo_0[1]}} & twice_hi_0);
          pair1_1 <= ({PW{lo_0[2]}} & hi_0) + ({PW{lo_0[3]}} & twice_hi_0);
          pair2_1 <= ({PW{lo_0[4]}} & hi_0) + ({PW{lo_0[5]}} & twice_hi_0);
          pairs_2 <= pair0_x + pair1_x + {pair2_1, 4'b0};
        end
        assign hl_2 = pairs_2[HLW-1:0];
        wire unused_pairs = &{1'b0, pairs_2};
      end else begin : g_multiplier
        reg signed [HLW-1:0] product_2;
        always @(posedge clk) product_2 <= slope_hi_1 * u_lo_1;
        assign hl_2 = product_2;
      end
      localparam integer HLC = HLW - DROP - U_LOW;
      localparam integer LHC = LHW - DROP - SLOPE_LOW;
      localparam integer MW = ((HLC > LHC) ? HLC : LHC) + 1;
      wire [MW-1:0] hl_x = {{(MW - HLC) {hl_2[HLW-1]}}, hl_2[HLW-1:DROP+U_LOW]};
      wire [MW-1:0] lh_x = {{(MW - LHC) {lh_2[LHW-1]}}, lh_2[LHW-1:DROP+SLOPE_LOW]};
      reg signed [MW-1:0] mid_3;
      reg [SUM_FRAC:0] outer_3;
      always @(posedge clk) begin
        lh_2    <= slope_lo_1 * u_hi_1;
        mid_3   <= hl_x + lh_x;
        outer_3 <= outer;
      end
      wire [SUM_FRAC:0] mid_x = {{(SUM_FRAC + 1 - MW) {mid_3[MW-1]}}, mid_3};
      assign sum = (RISES != 0) ? outer_3 + mid_x : outer_3 - mid_x;
      wire unused_tiles = &{1'b0, hl_2, lh_2, u_lo_1};
    end else begin : g_tile
      reg [SUM_FRAC:0] sum_3;
      always @(posedge clk) sum_3 <= outer;
      assign sum = sum_3;
    end
  endgenerate
  always @(posedge clk) y <= twice ? {sum[SUM_FRAC-1:SUM_FRAC-F], 1'b0} : sum[SUM_FRAC:SUM_FRAC-F];

  wire unused = &{1'b0, hh_2, sum};

endmodule

`default_nettype wire

// Rounds half up, without the product of the low parts: q = a * b / 2^SH, less than 2^UP + 1/2 places too small, signed.
// SPDX-License-Identifier: Apache-2.0
//
// a and b are cut so that three of the four tile products, which are kept, have 18x18 bits at most: a after its low SH/2
// bits, b after the other SH - SH/2, or after more where a word is longer than 18 bits above that, UP together. The
// fourth is less than 2^UP places of q. Does not saturate: q holds the low OW bits.
// Latency: 4 clocks (LAT_MUL3): operands, tile products, middle sum, rounded sum.
`default_nettype none

module ik_mul3 #(
    parameter integer AW = 33,  // width of a
    parameter integer BW = 33,  // width of b
    parameter integer SH = 31,  // fraction bits dropped: F(a) + F(b) - F(q)
    parameter integer OW = 33   // width of q
) (
    input  wire                 clk,
    input  wire signed [AW-1:0] a,
    input  wire signed [BW-1:0] b,
    output wire signed [OW-1:0] q
);

  localparam integer AL = (AW - 18 > SH / 2) ? AW - 18 : SH / 2;  // width of a's low part, unsigned
  localparam integer BL = (BW - 18 > SH - SH / 2) ? BW - 18 : SH - SH / 2;
  localparam integer ML = (AL < BL) ? AL : BL;
  localparam integer UP = AL + BL - SH;
  localparam integer AH = AW - AL;  // width of a's high part, signed
  localparam integer BH = BW - BL;

  generate
    if (ML < 1 || AL > 17 || BL > 17 || AH < 1 || BH < 1) begin : g_illegal
      ik_mul3_needs_parts_of_a_and_b_that_fit_18x18_bits u_stop ();
    end
  endgenerate

  // operands
  reg signed [AW-1:0] a_q;
  reg signed [BW-1:0] b_q;
  always @(posedge clk) begin
    a_q <= a;
    b_q <= b;
  end

  // tile products; a low part gets a zero sign bit
  wire signed [AH-1:0] a_hi = a_q[AW-1:AL];
  wire signed [BH-1:0] b_hi = b_q[BW-1:BL];
  wire signed [AL:0] a_lo = {1'b0, a_q[AL-1:0]};
  wire signed [BL:0] b_lo = {1'b0, b_q[BL-1:0]};
  reg signed [AH+BH-1:0] hh;
  reg signed [AH+BL-1:0] hl;
  reg signed [AL+BH-1:0] lh;
  always @(posedge clk) begin
    hh <= a_hi * b_hi;
    hl <= a_hi * b_lo;
    lh <= a_lo * b_hi;
  end

  // middle sum, in places of 2^ML; below its rounding bit only the carries count
  localparam integer DROP = SH - ML;
  localparam integer HLW = AH + BL + AL - ML;
  localparam integer LHW = AL + BH + BL - ML;
  localparam integer MW = ((HLW > LHW) ? HLW : LHW) + 1;
  wire signed [MW-1:0] hl_x = {{(MW - AH - BL) {hl[AH+BL-1]}}, hl};
  wire signed [MW-1:0] lh_x = {{(MW - AL - BH) {lh[AL+BH-1]}}, lh};
  wire signed [MW-1:0] middle = (hl_x <<< (AL - ML)) + (lh_x <<< (BL - ML));
  reg signed [MW-DROP:0] mid;
  reg signed [AH+BH-1:0] outer;
  always @(posedge clk) begin
    mid   <= middle[MW-1:DROP-1];
    outer <= hh;
  end

  // The rounding bit comes in as the carry of a place below: one carry chain.
  localparam integer NW = (AH + BH + UP > MW - DROP) ? (AH + BH + UP) : (MW - DROP);
  localparam integer SW = ((NW + 1 > OW) ? (NW + 1) : OW) + 1;
  wire half = mid[0];
  wire signed [SW-1:0] outer_x = {{(SW - AH - BH) {outer[AH+BH-1]}}, outer};
  wire signed [SW-1:0] mid_x = {{(SW - MW + DROP - 1) {mid[MW-DROP]}}, mid};
  wire signed [SW-1:0] rounding = {{(SW - 1) {1'b0}}, half};
  wire signed [SW-1:0] sum = ((outer_x <<< (UP + 1)) | rounding) + mid_x;
  reg signed [OW-1:0] p;
  always @(posedge clk) p <= sum[OW:1];
  assign q = p;

  wire unused = &{1'b0, middle, sum};

endmodule

`default_nettype wire

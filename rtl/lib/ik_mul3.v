// Rounds half up, what is left of a * b / 2^SH without its lowest bits: less than 2^(AL+BL-SH) + 1 places too small.
// SPDX-License-Identifier: Apache-2.0
//
// a is cut below its highest TILE bits, b below its highest TILE or 18, into AL and BL low ones; a shorter word stays
// whole. Three of the four tile products are kept, with TILE = 18 of 18x18 bits each; the fourth is less than
// 2^(AL+BL-SH) places of q. With TILE = 25, for multipliers of 25x18 bits, two are left where a is whole. Each tile is
// cut off two bits below the last place of q, which leaves the sum of the mixed ones short; both halves of half a place
// are carries into the two sums. Where words are so long that the highest tile ends above these two bits, the free bits
// below it take a guess at the fourth: the product of the highest two bits of both low parts. Bits of an operand that two
// signed tiles do not hold are not looked at.
// Does not saturate: q holds the low OW bits.
// Operands come from registers, which a synthesizer moves into the multipliers.
// Latency: 3 clocks (LAT_MUL3): tile products, middle sum, rounded sum; from a DA more, from b DB more.
`default_nettype none

module ik_mul3 #(
    parameter integer AW = 33,  // width of a
    parameter integer BW = 33,  // width of b
    parameter integer SH = 31,  // fraction bits dropped: F(a) + F(b) - F(q)
    parameter integer OW = 33,  // width of q
    parameter integer DA = 0,   // clocks by which a is delayed
    parameter integer DB = 0,   // and b
    parameter integer SQUARE = 0,  // 1: of a with itself, two tiles; b is not looked at
    parameter integer TILE = 18   // bits of the multipliers' longer operand
) (
    input  wire                 clk,
    input  wire signed [AW-1:0] a,
    input  wire signed [BW-1:0] b,
    output wire signed [OW-1:0] q
);

  localparam integer B_TILE = (TILE < 18) ? TILE : 18;
  localparam integer AU = (AW < 2 * TILE) ? 0 : AW - 2 * TILE + 1;  // bits of a that are not looked at
  localparam integer BU = (BW < 2 * B_TILE) ? 0 : BW - 2 * B_TILE + 1;
  localparam integer A = AW - AU;  // and what is left
  localparam integer B = BW - BU;
  localparam integer AL = (A > TILE) ? A - TILE : 0;  // width of a's low part, unsigned
  localparam integer BL = (B > B_TILE) ? B - B_TILE : 0;
  localparam integer AH = A - AL;  // width of a's high part, signed
  localparam integer BH = B - BL;
  localparam integer CUT = SH - AU - BU - 2;  // fraction bits of the product that no sum sees

  generate
    if (AW < 2 || AW > 35 || BW < 2 || BW > 35 || TILE < 2 ||
        CUT < AL || CUT < BL || CUT >= A + BL || CUT >= B + AL) begin : g_illegal
      ik_mul3_needs_words_of_2_to_35_bits_and_a_bit_of_each_tile_on_either_side_of_the_cut u_stop ();
    end
  endgenerate

  wire [AW-1:0] a_in;
  wire [BW-1:0] b_in;
  ik_delay #(.W(AW), .N(DA)) u_a (.clk(clk), .d(a), .q(a_in));
  generate
    if (SQUARE != 0) begin : g_a_twice
      assign b_in = a_in;
      wire unused_b = &{1'b0, b};
    end else begin : g_b
      ik_delay #(.W(BW), .N(DB)) u_b (.clk(clk), .d(b), .q(b_in));
    end
  endgenerate

  // tile products; a low part gets a zero sign bit
  wire [A+1:0] a_padded = {a_in[AW-1:AU], 2'b00};
  wire [B+1:0] b_padded = {b_in[BW-1:BU], 2'b00};
  wire signed [AH-1:0] a_hi = a_in[AW-1:AL+AU];
  wire signed [BH-1:0] b_hi = b_in[BW-1:BL+BU];
  wire signed [AL:0] a_lo = a_padded[AL+1:1] >> 1;
  wire signed [BL:0] b_lo = b_padded[BL+1:1] >> 1;
  reg signed [AH+BH-1:0] hh;
  reg signed [AH+BL-1:0] hl;
  wire signed [AL+BH-1:0] lh;
  wire [3:0] a_two = {2'b00, a_padded[AL+1-:2]};
  wire [1:0] b_two = b_padded[BL+1-:2];
  reg [3:0] ll;
  always @(posedge clk) begin
    hh <= a_hi * b_hi;
    hl <= a_hi * b_lo;
    ll <= (a_two & {4{b_two[0]}}) + ({a_two[2:0], 1'b0} & {4{b_two[1]}});  // logic: too little for a multiplier
  end

  generate
    if (SQUARE != 0 && AL == BL) begin : g_square
      assign lh = hl;
      wire unused_lo = &{1'b0, a_lo};
    end else begin : g_product
      reg signed [AL+BH-1:0] tile;
      always @(posedge clk) tile <= a_lo * b_hi;
      assign lh = tile;
    end
  endgenerate

  // A sum's carry is a place more below it, of two ones: one carry chain.

  // mixed tiles, cut, and their sum
  localparam integer HLW = AH + BL + AL - CUT;
  localparam integer LHW = AL + BH + BL - CUT;
  localparam integer MW = ((HLW > LHW) ? HLW : LHW) + 1;
  wire signed [HLW-1:0] hl_cut = hl[AH+BL-1:CUT-AL];
  wire signed [LHW-1:0] lh_cut = lh[AL+BH-1:CUT-BL];
  wire signed [MW:0] hl_x = {{(MW - HLW) {hl_cut[HLW-1]}}, hl_cut, 1'b1};
  wire signed [MW:0] lh_x = {{(MW - LHW) {lh_cut[LHW-1]}}, lh_cut, 1'b1};
  wire signed [MW:0] middle = hl_x + lh_x;
  reg signed [MW-1:0] mid;
  reg signed [AH+BH+3:0] outer;
  always @(posedge clk) begin
    mid   <= middle[MW:1];
    outer <= {hh, ll};
  end

  // rounded sum
  localparam integer UP = (AL + BL > CUT) ? AL + BL - CUT : 0;
  localparam integer DOWN = (AL + BL > CUT) ? 0 : CUT - AL - BL;
  localparam integer NW = (AH + BH + UP > MW) ? (AH + BH + UP) : MW;
  localparam integer SW = (NW + 1 > OW + 2) ? (NW + 1) : (OW + 2);
  wire signed [SW+3:0] outer_x = {{(SW - AH - BH) {outer[AH+BH+3]}}, outer};
  wire signed [SW+3:0] outer_cut = (outer_x <<< UP) >>> (4 + DOWN);
  wire signed [SW-1:0] mid_x = {{(SW - MW) {mid[MW-1]}}, mid};
  wire signed [SW:0] sum = {outer_cut[SW-1:0], 1'b1} + {mid_x, 1'b1};
  reg signed [OW-1:0] p;
  always @(posedge clk) p <= sum[OW+2:3];
  assign q = p;

  wire unused = &{1'b0, a_in, b_in, a_padded, b_padded, hl, lh, middle[0], outer_cut, sum};

endmodule

`default_nettype wire

// Rounds half up: q = floor(a * b / 2^SH + 1/2), a signed AW bits, b signed BW bits, q signed OW bits.
// SPDX-License-Identifier: Apache-2.0
//
// The product is built from four tiles of half words (17x17 bits for W = 32), so that each fits a multiplier block of
// 18x18 bits with registers on both sides. Does not saturate: the format of q must hold the rounded product.
// Latency: 4 clocks (LAT_MUL).
`default_nettype none

module ik_mul #(
    parameter integer AW = 32,  // width of a
    parameter integer BW = 32,  // width of b
    parameter integer SH = 30,  // fraction bits dropped: F(a) + F(b) - F(q)
    parameter integer OW = 32   // width of q
) (
    input  wire                 clk,
    input  wire signed [AW-1:0] a,
    input  wire signed [BW-1:0] b,
    output wire signed [OW-1:0] q
);

  localparam integer AL = AW / 2;  // width of a's low half, unsigned
  localparam integer BL = BW / 2;
  localparam integer AH = AW - AL;  // width of a's high half, signed
  localparam integer BH = BW - BL;
  localparam integer PW = AW + BW;
  localparam [PW-1:0] HALF = (SH > 0) ? ({{(PW - 1) {1'b0}}, 1'b1} << (SH - 1)) : {PW{1'b0}};

  // operands
  reg signed [AW-1:0] a_q;
  reg signed [BW-1:0] b_q;
  always @(posedge clk) begin
    a_q <= a;
    b_q <= b;
  end

  // tile products; a low half gets a zero sign bit
  wire signed [AH-1:0] a_hi = a_q[AW-1:AL];
  wire signed [BH-1:0] b_hi = b_q[BW-1:BL];
  wire signed [AL:0] a_lo = {1'b0, a_q[AL-1:0]};
  wire signed [BL:0] b_lo = {1'b0, b_q[BL-1:0]};
  reg signed [AH+BH-1:0] hh;
  reg signed [AH+BL:0] hl;
  reg signed [AL+BH:0] lh;
  reg signed [AL+BL+1:0] ll;
  always @(posedge clk) begin
    hh <= a_hi * b_hi;
    hl <= a_hi * b_lo;
    lh <= a_lo * b_hi;
    ll <= a_lo * b_lo;
  end

  // tile sums: hh and ll do not overlap
  reg [PW-1:0] outer;
  reg signed [PW-1:0] inner;
  wire signed [PW-1:0] hl_x = {{(PW - AH - BL - 1) {hl[AH+BL]}}, hl};
  wire signed [PW-1:0] lh_x = {{(PW - AL - BH - 1) {lh[AL+BH]}}, lh};
  always @(posedge clk) begin
    outer <= {hh, ll[AL+BL-1:0]} + HALF;
    inner <= (hl_x <<< AL) + (lh_x <<< BL);
  end

  // rounded product
  reg signed [PW-1:0] p;
  always @(posedge clk) p <= $signed(outer) + inner;
  wire signed [PW-1:0] shifted = p >>> SH;
  assign q = shifted[OW-1:0];

  // ll's top two bits are 0: its factors are not negative. Bits of p above q repeat its sign.
  wire unused = &{1'b0, ll[AL+BL+1:AL+BL], shifted};

endmodule

`default_nettype wire

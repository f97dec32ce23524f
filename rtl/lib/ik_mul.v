// Product of two words, rounded: q = floor(a * b / 2^SH + 1/2).
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up; a signed AW bits, b signed BW bits, q signed OW bits.
// Built from tiles that each fit an 18x18-bit multiplier block with input and output registers. Words of up to 18 bits
// are one tile; longer ones are split above their lowest 17 bits, which keeps the high parts and the tile sums short.
// SQUARE = 1 computes a * a and ignores b: both mixed products are one tile, and their sum is a shift.
// Does not saturate: the format of q must hold the rounded product.
// Throughput: one result per clock.
// Latency: 4 clocks (LAT_MUL): operands, tile products, tile sums, rounding; plus DA from a or DB from b.
`default_nettype none

module ik_mul #(
    parameter integer AW     = 32,  // width of a, at most 35
    parameter integer BW     = 32,  // width of b, at most 35
    parameter integer SH     = 30,  // fraction bits dropped: F(a) + F(b) - F(q)
    parameter integer OW     = 32,  // width of q
    parameter integer SQUARE = 0,   // 1: a * a, AW = BW
    parameter integer DA     = 0,   // delay of a, clocks
    parameter integer DB     = 0    // delay of b, clocks
) (
    input  wire                 clk,
    input  wire signed [AW-1:0] a,
    input  wire signed [BW-1:0] b,
    output wire signed [OW-1:0] q
);

  localparam integer PW = AW + BW;
  localparam [PW-1:0] HALF = (SH > 0) ? ({{(PW - 1) {1'b0}}, 1'b1} << (SH - 1)) : {PW{1'b0}};

  generate
    if (AW > 35 || BW > 35 || (SQUARE != 0 && AW != BW)) begin : g_illegal
      ik_mul_illegal_width u_stop ();
    end
  endgenerate

  // operands
  wire signed [AW-1:0] a_in;
  ik_delay #(.W(AW), .N(DA)) u_a (.clk(clk), .d(a), .q(a_in));
  reg signed [AW-1:0] a_q;
  wire signed [BW-1:0] b_q;
  always @(posedge clk) a_q <= a_in;
  generate
    if (SQUARE != 0) begin : g_same
      assign b_q = a_q;
      wire unused_b = &{1'b0, b};
    end else begin : g_other
      wire signed [BW-1:0] b_in;
      ik_delay #(.W(BW), .N(DB)) u_b (.clk(clk), .d(b), .q(b_in));
      reg signed [BW-1:0] operand;
      always @(posedge clk) operand <= b_in;
      assign b_q = operand;
    end
  endgenerate

  // d + HALF, except that the bit at HALF stays as in d: the consumer inverts it in the LUT of its adder.
  function [PW-1:0] half_up(input [PW-1:0] d);
    half_up = ((d + (d & HALF)) & ~HALF) | (d & HALF);
  endfunction

  // outer: the tiles that do not overlap, plus half an LSB of q; inner: the mixed tiles
  wire signed [PW-1:0] outer;
  wire signed [PW-1:0] inner;
  generate
    if (AW <= 18 && BW <= 18) begin : g_tile
      reg signed [PW-1:0] product;
      reg signed [PW-1:0] sum;
      always @(posedge clk) begin
        product <= a_q * b_q;
        sum     <= half_up(product);
      end
      assign outer = sum ^ HALF;
      assign inner = {PW{1'b0}};
    end else begin : g_tiles
      localparam integer AL = (AW > 18) ? 17 : (AW / 2);  // width of a's low part, unsigned
      localparam integer BL = (BW > 18) ? 17 : (BW / 2);
      localparam integer AH = AW - AL;  // width of a's high part, signed
      localparam integer BH = BW - BL;
      wire signed [AH-1:0] a_hi = a_q[AW-1:AL];
      wire signed [BH-1:0] b_hi = b_q[BW-1:BL];
      wire signed [AL:0] a_lo = {1'b0, a_q[AL-1:0]};  // with a zero sign bit
      wire signed [BL:0] b_lo = {1'b0, b_q[BL-1:0]};
      reg signed [AH+BH-1:0] hh;
      reg signed [AH+BL-1:0] hl;
      reg [AL+BL-1:0] ll;
      reg signed [PW-1:0] sum;
      always @(posedge clk) begin
        hh  <= a_hi * b_hi;
        hl  <= a_hi * b_lo;
        ll  <= a_lo * b_lo;
        sum <= half_up({hh, ll});
      end
      assign outer = sum ^ HALF;

      wire signed [PW-1:0] hl_x = {{(PW - AH - BL) {hl[AH+BL-1]}}, hl};
      reg signed [PW-1:0] mixed;
      assign inner = mixed;
      if (SQUARE != 0) begin : g_twice
        always @(posedge clk) mixed <= hl_x <<< (AL + 1);
      end else begin : g_both
        reg signed [AL+BH-1:0] lh;
        wire signed [PW-1:0] lh_x = {{(PW - AL - BH) {lh[AL+BH-1]}}, lh};
        always @(posedge clk) begin
          lh    <= a_lo * b_hi;
          mixed <= (hl_x <<< AL) + (lh_x <<< BL);
        end
      end
    end
  endgenerate

  // rounded product
  reg signed [PW-1:0] p;
  always @(posedge clk) p <= outer + inner;
  wire signed [PW-1:0] shifted = p >>> SH;
  assign q = shifted[OW-1:0];
  wire unused = &{1'b0, shifted};  // bits of p above q repeat its sign

endmodule

`default_nettype wire

// Adder of the folded datapath: T = S + Y or S - Y, where Y is a product.
// SPDX-License-Identifier: Apache-2.0
//
// The addend supplies the rounding constant: half an LSB, or the constant in a table's c0.
// Y is the product, times 2^-DOWN for table functions and small powers of two. S is a constant, a table word, or
// derived from the previous T. S and T hold a product's XW highest bits, down to the lowest bit of an exact square.
// Throughput: one step per clock with go high.
// Latency: 1 clock to S, 1 clock from S and the product to T.
`default_nettype none

module ik_fold_sum #(
    parameter integer D     = 33,  // width of a word
    parameter integer XW    = 50,  // width of a sum
    parameter integer LAST  = 17,  // position of an inner word's LSB in a sum, plain window
    parameter integer HALF  = 46,  // position of 1/2
    parameter integer ANSWER = 24, // position of half a result's LSB
    parameter integer C0W   = 35,  // widths of the table words c0, c1
    parameter integer C1W   = 24,
    parameter integer C0_AT = 11,  // and positions of their LSBs
    parameter integer C1_AT = 23,
    parameter integer SLOPE = 21,  // position of a slope's LSB
    parameter integer DOWN  = 12   // right shift of Y with `down`
) (
    input  wire           clk,
    input  wire           go,
    // S
    input  wire [    3:0] choice,
    input  wire           by,      // the flag that S_LENGTH and S_NONE_OR_HALF depend on
    input  wire [C0W-1:0] c0,
    input  wire [C1W-1:0] c1,
    // T
    input  wire [2*D-1:0] p,
    input  wire           down,    // Y = 2^-DOWN p
    input  wire           minus,
    input  wire           carry,
    // Sum
    output reg  [ XW-1:0] t
);

  `include "ik_fold_codes.vh"

  localparam integer LOWEST = 2 * D - XW;
  localparam [XW-1:0] ONE = {{(XW - 1) {1'b0}}, 1'b1};
  localparam [XW-1:0] ROUND = ONE << (LAST - 1);
  localparam [XW-1:0] KEPT = ~((ONE << LAST) - ONE);  // clears the bits below an inner word's LSB
  // T is truncated after the subtraction. Ones below the slope's LSB make this a subtraction of a truncated product.
  localparam [XW-1:0] BELOW_SLOPE = (ONE << SLOPE) - ONE;

  wire [XW-1:0] value = {{(XW - C0W) {1'b0}}, c0} << C0_AT;
  wire [XW-1:0] slope = {{(XW - C1W) {1'b0}}, c1} << C1_AT;

  reg [XW-1:0] s;
  always @(posedge clk)
    if (go)
      case (choice)
        S_HOLD: s <= s;
        S_HALF_PLAIN: s <= ROUND;
        S_HALF_DOUBLE: s <= ROUND >> 1;
        S_RESULT_PLAIN: s <= ROUND | ONE << ANSWER;
        S_RESULT_DOUBLE: s <= (ROUND | ONE << ANSWER) >> 1;
        S_T: s <= t;
        S_T_HALF: s <= (t & KEPT) | ROUND;
        S_SLOPE: s <= slope;
        S_SLOPE_LESS: s <= slope | BELOW_SLOPE;
        S_VALUE: s <= value;
        S_LENGTH: s <= by ? ONE << (HALF + 1) : ONE << HALF;
        S_NONE_OR_HALF: s <= by ? ONE << HALF : {XW{1'b0}};
        default: s <= {XW{1'b0}};  // zero
      endcase

  wire [XW-1:0] y = down ? {{DOWN{p[2*D-1]}}, p[2*D-1:LOWEST+DOWN]} : p[2*D-1:LOWEST];
  always @(posedge clk) if (go) t <= s + (minus ? ~y : y) + {{(XW - 1) {1'b0}}, carry};
  wire unused = &{1'b0, p[LOWEST-1:0]};

endmodule

`default_nettype wire

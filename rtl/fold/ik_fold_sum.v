// Rounds by what it adds: halves, and what a table's rows have.
// SPDX-License-Identifier: Apache-2.0
//
// T = S + Y or S - Y, with Y a product, or 2^-DOWN of it for functions from tables.  S is a constant, a table's word, or made
// of a T before.  S and T are what is above the lowest bit of an exact square.
// Latency: S 1 clock, T 1 clock after S and the product.
`default_nettype none

module ik_fold_sum #(
    parameter integer D     = 33,  // bits of a word
    parameter integer XW    = 50,  // bits of a sum
    parameter integer LAST  = 17,  // place of an inner word's last bit in a sum, plain window
    parameter integer HALF  = 46,  // place of 1/2
    parameter integer ANSWER = 24,  // place of half a result's last bit
    parameter integer C0W   = 35,  // bits of a table's words
    parameter integer C1W   = 24,
    parameter integer C0_AT = 11,  // and their places
    parameter integer C1_AT = 23,
    parameter integer SLOPE = 21,  // place of a slope's last bit
    parameter integer DOWN  = 12
) (
    input  wire           clk,
    input  wire           go,
    // for S
    input  wire [    3:0] choice,
    input  wire           by,      // the flag of a length, of a half
    input  wire [C0W-1:0] c0,
    input  wire [C1W-1:0] c1,
    // for T
    input  wire [2*D-1:0] p,
    input  wire           down,    // 2^-DOWN p
    input  wire           minus,
    input  wire           carry,
    output reg  [ XW-1:0] t
);

  `include "ik_fold_codes.vh"

  localparam integer LOWEST = 2 * D - XW;
  localparam [XW-1:0] ONE = {{(XW - 1) {1'b0}}, 1'b1};
  localparam [XW-1:0] ROUND = ONE << (LAST - 1);
  localparam [XW-1:0] KEPT = ~((ONE << LAST) - ONE);  // what is not below the last place
  // A slope is rounded down after its product was taken from it, and is less by what that leaves.
  localparam [XW-1:0] LESS = (ONE << SLOPE) - ONE;

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
        S_SLOPE_LESS: s <= slope | LESS;
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

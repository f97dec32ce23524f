// Multiplier of the folded datapath: p = a * b, from four tiles.
// SPDX-License-Identifier: Apache-2.0
//
// Truncates: the step's `cut` drops low bits of each tile, as ik_mul3 and ik_quadratic do; signed D-bit operands.
// The tiles have high parts of TILE bits, low parts of at most TILE - 1.
// Throughput: one step per clock with go high.
// Latency: 3 clocks: operands, tiles, sum. `cut` is used in the third.
`default_nettype none

module ik_fold_mul #(
    parameter integer D    = 33,  // width of a word, less than 2 TILE
    parameter integer TILE = 18,  // width of a high part
    parameter integer WORD = 33,  // product bits below an inner word's LSB
    parameter integer ROOT = 8,   // bits of the high tile below the LSB of a root's sum
    parameter integer SINE = 7    // and below the LSB of a sine's sum
) (
    input  wire           clk,
    input  wire           go,
    input  wire [  D-1:0] a,
    input  wire [  D-1:0] b,
    input  wire [    2:0] cut,
    output reg  [2*D-1:0] p
);

  `include "ik_fold_codes.vh"

  localparam integer LOW = D - TILE;
  localparam integer BASE = 2 * LOW;
  localparam integer GUESSED = (BASE > WORD - 3) ? 1 : 0;
  localparam [2*D-1:0] ONES = {2 * D{1'b1}};

  reg signed [D-1:0] a_1, b_1;
  wire signed [TILE-1:0] a_hi = a_1[D-1:LOW];
  wire signed [TILE-1:0] b_hi = b_1[D-1:LOW];
  wire signed [LOW:0] a_lo = {1'b0, a_1[LOW-1:0]};
  wire signed [LOW:0] b_lo = {1'b0, b_1[LOW-1:0]};
  reg signed [2*TILE-1:0] hh_2;
  reg signed [D:0] hl_2, lh_2;
  reg [2*LOW+1:0] ll_2;
  // product of the low parts' two highest bits, in logic
  wire [1:0] a_top = a_1[LOW-1:LOW-2];
  wire [1:0] b_top = b_1[LOW-1:LOW-2];
  wire [3:0] guess_1 = {1'b0, b_top & {2{a_top[1]}}, 1'b0} + {2'b00, b_top & {2{a_top[0]}}};
  reg [3:0] guess_2;
  always @(posedge clk)
    if (go) begin
      a_1 <= a;
      b_1 <= b;
      hh_2 <= a_hi * b_hi;
      hl_2 <= a_hi * b_lo;
      lh_2 <= a_lo * b_hi;
      ll_2 <= a_lo * b_lo;
      guess_2 <= (GUESSED != 0) ? guess_1 : 4'd0;
    end

  reg [2*D-1:0] keep;
  always @*
    case (cut)
      CUT_PLAIN: keep = ONES << (WORD - 2);
      CUT_DOUBLE: keep = ONES << (WORD - 3);
      CUT_WORD: keep = ONES << WORD;
      CUT_ROOT: keep = ONES << (BASE + ROOT);
      CUT_SINE: keep = ONES << (BASE + SINE);
      default: keep = ONES;  // exact
    endcase
  wire exact = cut == CUT_EXACT || cut == CUT_POWER;
  wire rounded = cut == CUT_PLAIN || cut == CUT_DOUBLE;

  // The outer tiles do not overlap. Unless exact, the low tile is replaced by an estimate of its highest bits, or by 0.
  wire [BASE-1:0] inner = exact ? ll_2[BASE-1:0] : (rounded ? {guess_2, {(BASE - 4) {1'b0}}} : {BASE{1'b0}});
  wire [2*D-1:0] outer = {hh_2, inner} & keep;
  wire [2*D-1:0] hl = {{(TILE - 1) {hl_2[D]}}, hl_2, {LOW{1'b0}}} & keep;
  wire [2*D-1:0] lh = {{(TILE - 1) {lh_2[D]}}, lh_2, {LOW{1'b0}}} & keep;
  always @(posedge clk) if (go) p <= outer + (hl + lh);
  wire unused = &{1'b0, ll_2};

endmodule

`default_nettype wire

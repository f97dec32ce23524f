// Selects two words from T: the word for the memory, from either window and optionally saturated, and the result.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down: a word is a window of T, truncated at its LSB; T has XW bits, the word D, the result W.
// Latency: 0 clocks.
`default_nettype none

module ik_fold_word #(
    parameter integer W     = 24,  // word length of the core
    parameter integer D     = 33,  // width of a word
    parameter integer XW    = 50,  // width of a sum
    parameter integer INNER = 31,  // width of an inner word
    parameter integer ROOT  = 29,  // fraction bits of a root
    parameter integer SINE  = 29,  // of a sine
    parameter integer SLOPE = 25   // of a slope
) (
    // Sum and format
    input  wire [XW-1:0] t,
    input  wire          doubled,  // use the window one bit lower
    input  wire          limit,    // saturate at the largest word
    input  wire [   1:0] last,     // format of the word: position of its LSB
    input  wire          low,     // a root is doubled: its LSB moves up one bit
    // Word and result
    output wire [ D-1:0] word,
    output wire          negative,
    output wire [ W-1:0] result
);

  `include "ik_fold_codes.vh"

  localparam integer AT = XW - D - 2;  // LSB of the plain window; its MSB is T[XW-3]
  localparam [D-1:0] ONES = {D{1'b1}};
  localparam integer ROOT_DROP = D - 2 - ROOT;

  wire [D-1:0] window = doubled ? t[AT-1+:D] : t[AT+:D];
  wire [2:0] above = doubled ? t[XW-1-:3] : {t[XW-1], t[XW-1-:2]};  // bits above the largest word
  wire most = limit && !t[XW-1] && (above != 3'b000 || window[D-1]);
  reg [D-1:0] keep;
  always @*
    case (last)
      LAST_ROOT: keep = ONES << (low ? ROOT_DROP + 1 : ROOT_DROP);
      LAST_SINE: keep = ONES << (D - 2 - SINE);
      LAST_SLOPE: keep = ONES << (D - 2 - SLOPE);
      default: keep = ONES << (D - INNER);  // inner
    endcase
  assign word = (most ? ONES >> 1 : window) & keep;
  assign negative = word[D-1];
  assign result = window[D-1-:W];

endmodule

`default_nettype wire

// Rounds down: a word is what is in a window of T, above its last place.
// SPDX-License-Identifier: Apache-2.0
//
// What of T is written: from one of two windows, limited where the program says so; and a result.
// Latency: 0.
`default_nettype none

module ik_fold_word #(
    parameter integer W     = 24,
    parameter integer D     = 33,  // bits of a word
    parameter integer XW    = 50,  // bits of a sum
    parameter integer INNER = 31,  // bits of an inner word
    parameter integer ROOT  = 29,  // fraction bits of a root
    parameter integer SINE  = 29,
    parameter integer SLOPE = 25
) (
    input  wire [XW-1:0] t,
    input  wire          doubled,  // the lower window
    input  wire          limit,
    input  wire [   1:0] last,
    input  wire          low,     // a root is doubled: its last place stays
    output wire [ D-1:0] word,
    output wire          negative,
    output wire [ W-1:0] result
);

  `include "ik_fold_codes.vh"

  localparam integer AT = XW - D - 2;  // of the plain window, whose highest bit is T's third but one
  localparam [D-1:0] ONES = {D{1'b1}};
  localparam integer ROOT_DROP = D - 2 - ROOT;

  wire [D-1:0] window = doubled ? t[AT-1+:D] : t[AT+:D];
  wire [2:0] above = doubled ? t[XW-1-:3] : {t[XW-1], t[XW-1-:2]};  // what the largest word does not have
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

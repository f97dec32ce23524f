// Table rows of the folded datapath: {c0, c1, c2} of a word for 1/(2 sqrt m), sine or cosine.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding here: c0 includes the constant that rounds the result.
// model/dataflow/quadratic.py derives the rows: long form; small form with TILE < 18. A mantissa in [1/4, 1/2) uses the
// first half of the root's rows; its segment number reaches one mantissa bit lower than in [1/2, 1). The cosine is the
// sine of the complementary angle.
// Throughput: one step per clock with go high.
// Latency: 1 clock.
`default_nettype none

module ik_fold_table #(
    parameter integer W    = 24,  // word length
    parameter integer TILE = 18,  // multiplier tile width
    parameter integer RW   = 12,  // bits of a row number within its half of the table, plus 2
    parameter integer ROW  = 74   // width of a row
) (
    input  wire           clk,
    input  wire           go,
    input  wire [ RW-1:0] word,   // the highest bits below the sign
    input  wire           angle,  // sine or cosine
    input  wire           cosine,
    output reg  [ROW-1:0] row
);

  `include "ik_fold_formats.vh"
  `include "ik_fold_table.vh"

  wire first = word[RW-1];
  wire [RW-3:0] segment = first ? {(RW - 2) {1'b1}} : word[RW-2:1];
  wire [RW-3:0] mantissa = {first, first ? word[RW-2:2] : word[RW-3:1]};
  wire [RW-3:0] row_at = !angle ? mantissa : cosine ? ~segment : segment;
  always @(posedge clk) if (go) row <= rom[{angle, row_at}];
  wire unused = &{1'b0, word[0]};

endmodule

`default_nettype wire

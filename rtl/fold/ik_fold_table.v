// No rounding of its own: rows of tables.
// SPDX-License-Identifier: Apache-2.0
//
// The row of a word for 1/(2 sqrt m), sine or cosine: {c0, c1, c2} of model/dataflow/quadratic.py, of the long form, or
// with TILE < 18 of the small one; c0 with what rounds the result.  A mantissa in [1/4, 1/2) takes the first half of the root's rows, with a
// bit more of it for the number of the segment than one in [1/2, 1).  The cosine is the sine of the other angle.
// Latency: 1 clock.
`default_nettype none

module ik_fold_table #(
    parameter integer W    = 24,  // word length
    parameter integer TILE = 18,  // bits of a tile
    parameter integer RW   = 12,  // two more than a row's number has in its half of the table
    parameter integer ROW  = 74   // bits of a row
) (
    input  wire           clk,
    input  wire           go,
    input  wire [ RW-1:0] word,   // the highest bits but the sign
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

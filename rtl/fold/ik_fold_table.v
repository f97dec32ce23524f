// No rounding of its own: rows of tables.
// SPDX-License-Identifier: Apache-2.0
//
// The row of a word for 1/(2 sqrt m), sine or cosine: {c0, c1, c2} of model/dataflow/quadratic.py, aligned for the sum and
// the operands, c0 with what rounds the result.  A mantissa in [1/4, 1/2) takes the first half of the root's rows, with a
// bit more of it for the number of the segment than one in [1/2, 1).  The cosine is the sine of the other angle.
// Latency: 1 clock.
`default_nettype none

module ik_fold_table #(
    parameter integer F = 29  // fraction bits of the results
) (
    input  wire        clk,
    input  wire        go,
    input  wire [11:0] word,  // the highest bits but the sign
    input  wire        angle,  // sine or cosine
    input  wire        cosine,
    output wire [35:0] c0,
    output wire [23:0] c1,
    output wire [14:0] c2
);

  `include "ik_fold_table.vh"

  wire first = word[11];
  wire [9:0] segment = first ? 10'h3ff : word[10:1];
  wire [9:0] mantissa = {first, first ? word[10:2] : word[9:1]};
  wire [9:0] row_at = !angle ? mantissa : cosine ? ~segment : segment;
  reg [74:0] row;
  always @(posedge clk) if (go) row <= rom[{angle, row_at}];
  assign {c0, c1, c2} = row;
  wire unused = &{1'b0, word[0]};

endmodule

`default_nettype wire

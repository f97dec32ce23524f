// Doubles a binary angle, negated on request: q = 2 a or -2 a, rounded to fewer bits.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up; binary angles of IW and of OW bits, one turn = 2^IW and 2^OW, so that q wraps.
// Throughput: one angle per clock.
// Latency: 1 clock.
`default_nettype none

module ik_double #(
    parameter integer IW = 36,  // width of a, at least OW + 4
    parameter integer OW = 32   // width of q
) (
    input  wire          clk,
    input  wire [IW-1:0] a,
    input  wire          negate,
    output reg  [OW-1:0] q
);

  // A negated angle: half an LSB of q, and the 1 of -x = ~x + 1, on the same carry chain.
  localparam integer DROP = IW - OW - 1;  // bits of a below q's LSB
  wire [IW-1:0] half = {{(OW + 1) {1'b0}}, 1'b1, {(DROP - 2) {1'b0}}, negate};
  wire [IW-1:0] sum = (a ^ {IW{negate}}) + half;
  always @(posedge clk) q <= sum[DROP+:OW];
  wire unused = &{1'b0, sum};  // dropped by rounding and by a whole turn

endmodule

`default_nettype wire

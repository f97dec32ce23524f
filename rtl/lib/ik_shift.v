// Left: exact modulo 2^W. Right: rounds down (floor). q = d * 2^count or floor(d / 2^count), signed words of W bits.
// SPDX-License-Identifier: Apache-2.0
//
// Latency: 2 clocks (LAT_SHIFT): by eights, by ones.
`default_nettype none

module ik_shift #(
    parameter integer W     = 32,  // width of the word
    parameter integer RIGHT = 0    // 1: shift right
) (
    input  wire                clk,
    input  wire signed [W-1:0] d,
    input  wire        [  5:0] count,
    output reg  signed [W-1:0] q
);

  reg signed [W-1:0] eights;
  reg [2:0] ones;
  always @(posedge clk) begin
    eights <= (RIGHT != 0) ? (d >>> {count[5:3], 3'b000}) : (d <<< {count[5:3], 3'b000});
    ones   <= count[2:0];
    q      <= (RIGHT != 0) ? (eights >>> ones) : (eights <<< ones);
  end

endmodule

`default_nettype wire

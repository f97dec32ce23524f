// Compares a joint with its limits.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; binary angles, one turn = 2^W.
// over: th lies outside the closed arc from low upwards to high, (th - low) mod 2^W > (high - low) mod 2^W. It is
// computed by unsigned comparisons, without a subtractor. high = low - 1: no limit.
// Throughput: one angle per clock.
// Latency: 1 clock.
`default_nettype none

module ik_limit #(
    parameter integer W = 32  // word length
) (
    input  wire         clk,
    input  wire [W-1:0] th,
    input  wire [W-1:0] low,
    input  wire [W-1:0] high,
    output reg          over
);

  always @(posedge clk) over <= (th < low) ^ (high < th) ^ (high < low);

endmodule

`default_nettype wire

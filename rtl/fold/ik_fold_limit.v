// Compares a joint with its limits, as ik_limit does, one joint per clock.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; binary angles, one turn = 2^W.
// over: th lies outside the closed arc from low upwards to high. This is so if (th - low) mod 2^W + (high - th) mod 2^W
// is a whole turn or more: on the arc, the sum is (high - low) mod 2^W.
// Throughput: one angle per clock.
// Latency: 1 clock.
`default_nettype none

module ik_fold_limit #(
    parameter integer W = 24  // word length
) (
    input  wire            clk,
    input  wire [     2:0] joint,   // 1 to 7
    input  wire [   W-1:0] th,
    input  wire [14*W-1:0] limits,  // lower and upper of th1 .. th7, lowest bits first
    output wire            over
);

  reg [W-1:0] not_low, not_high;
  always @*
    case (joint)
      3'd1: {not_high, not_low} = ~limits[0*W+:2*W];
      3'd2: {not_high, not_low} = ~limits[2*W+:2*W];
      3'd3: {not_high, not_low} = ~limits[4*W+:2*W];
      3'd4: {not_high, not_low} = ~limits[6*W+:2*W];
      3'd5: {not_high, not_low} = ~limits[8*W+:2*W];
      3'd6: {not_high, not_low} = ~limits[10*W+:2*W];
      default: {not_high, not_low} = ~limits[12*W+:2*W];
    endcase

  reg [W-1:0] from_low, to_high;
  always @(posedge clk) begin
    from_low <= th + not_low + {{(W - 1) {1'b0}}, 1'b1};
    to_high  <= ~(th + not_high);
  end
  wire [W:0] both = {1'b0, from_low} + {1'b0, to_high};
  assign over = both[W];
  wire unused = &{1'b0, both};

endmodule

`default_nettype wire

// Replaces the elbow quaternion's words for a clamped target: closed is (1, 0), straight (0, -1).
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; Q2.(W-2).
// Latency: 0 clocks.
`default_nettype none

module ik_fold_elbow #(
    parameter integer W = 24  // word length
) (
    input  wire         clamp,
    input  wire         closed,   // not straight
    input  wire         is_w,   // the word is qe_w
    input  wire         is_i,   // or qe_i
    input  wire [W-1:0] word,
    output wire [W-1:0] answer
);

  localparam [W-1:0] UNIT = {2'b01, {(W - 2) {1'b0}}};
  wire [W-1:0] elbow = is_w ? (closed ? UNIT : {W{1'b0}}) : (closed ? {W{1'b0}} : -UNIT);
  assign answer = (clamp && (is_w || is_i)) ? elbow : word;

endmodule

`default_nettype wire

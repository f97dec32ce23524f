// Checks the hand's quaternion and saturates the wrist, in the folded whole arm.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; a sum T holds |Qh|^2 or half a coordinate of the wrist.
// A hand is bad if |Qh| is outside [1 - 2^-8, 1 + 2^-8).
// Throughput: one sum per clock with go high.
// Latency: 1 clock from T to bad_hand and saturated, 0 to wrist.
`default_nettype none

module ik_fold_arm_hand #(
    parameter integer W  = 24,  // word length
    parameter integer XW = 50   // width of a sum
) (
    input  wire          clk,
    input  wire          go,
    // Step
    input  wire [   3:0] sign,      // what T is
    input  wire [XW-1:0] t,
    input  wire [   W:0] rounded,   // the coordinate, by its highest bits
    // Wrist and flags
    output wire [   W:0] wrist,     // saturated
    output reg           bad_hand,
    output wire          saturated
);

  `include "ik_fold_arm_codes.vh"

  wire below = t[XW-1];
  wire outside = t[XW-2-:3] != {3{below}};
  assign wrist = outside ? {below, below, {(W - 1) {!below}}} : rounded;

  // |Qh|^2, T's highest bits in units of 2^-16, lies from 1 - 2^-7 + 2^-16 to 1 + 2^-7.
  wire no_more = t[XW-12-:9] == 9'd0;
  wire above_1 = t[XW-4] && t[XW-5-:6] == 6'h00 && (!t[XW-11] || no_more);
  wire below_1 = !t[XW-4] && t[XW-5-:7] == 7'h7f && !no_more;
  reg outside_x, outside_y, outside_z;
  always @(posedge clk)
    if (go)
      case (sign)
        SIGN_HAND_SQ: bad_hand <= t[XW-1-:3] != 3'd0 || !(above_1 || below_1);
        SIGN_X: outside_x <= outside;
        SIGN_Y: outside_y <= outside;
        SIGN_Z: outside_z <= outside;
        default: ;
      endcase
  assign saturated = outside_x || outside_y || outside_z;
  wire unused = &{1'b0, t};

endmodule

`default_nettype wire

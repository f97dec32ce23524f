// Joint angles of the folded whole arm: passes the words of a result to the CORDIC of ik_fold_angle as they arrive.
// SPDX-License-Identifier: Apache-2.0
//
// Binary angles, one turn = 2^W, rounded half up.
// Vectors of two results, x and then y, and of two lengths give angles; a branch bit turns or negates some of them.
// Latency: set by the program.
`default_nettype none

module ik_fold_arm_joints #(
    parameter integer W = 24  // word length
) (
    input  wire         clk,
    input  wire         go,
    // Step
    input  wire [  4:0] result,
    input  wire [  1:0] again_by,   // the next vector is of two lengths; selects the branch bit that negates its angle
    input  wire         over,       // see ik_fold_angle
    input  wire         to_h,
    input  wire [W-1:0] answer,     // word of the result
    // Branch
    input  wire         elbow_in,   // elbow bit of the target taken last
    input  wire [  2:0] branch,     // branch of the results: shoulder, elbow, wrist, lowest bit first
    // Joint, with `result` TH1 to TH7
    output wire [W-1:0] th,
    // For waves and testbenches, see ik_fold_angle
    output wire [W+2:0] length,
    output wire [W+3:0] z_node,
    output wire         left,
    output wire         opposite
);

  `include "ik_fold_arm_codes.vh"

  wire again = again_by != AGAIN_BY_NONE;
  reg load_x, load_y, minus, negative, half;
  reg [1:0] rounding;
  always @* begin
    {load_x, load_y, minus, half} = 4'b0000;
    negative = again_by == AGAIN_BY_SHOULDER ? branch[0] : again_by == AGAIN_BY_WRIST && branch[2];
    rounding = {1'b0, again};
    case (result)
      RESULT_ELBOW_I, RESULT_QS_I, RESULT_QS_W, RESULT_QW_I, RESULT_QW_W: load_x = 1'b1;
      RESULT_QS_J, RESULT_QW_J: load_y = 1'b1;
      RESULT_QS_K, RESULT_QW_K: {load_y, rounding} = 3'b110;
      RESULT_ELBOW_W: {load_y, rounding, negative} = {3'b101, elbow_in};
      RESULT_TH1: half = branch[0];
      RESULT_TH3: {half, minus} = {branch[0] ^ branch[1], 1'b1};
      RESULT_TH5: half = branch[1] ^ branch[2];
      RESULT_TH7: {half, minus} = {branch[2], 1'b1};
      default: ;
    endcase
  end
  ik_fold_angle #(.W(W)) u_angle (
      .clk(clk), .go(go),
      .word(answer), .load_x(load_x), .load_y(load_y), .opposite(result == RESULT_ELBOW_W), .rounding(rounding),
      .negative(negative), .over(over), .again(again), .to_h(to_h), .minus(minus), .half(half), .th(th),
      .length(length), .z_node(z_node), .left_node(left), .negative_node(opposite)
  );

endmodule

`default_nettype wire

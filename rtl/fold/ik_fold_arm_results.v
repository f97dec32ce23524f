// Collects the words of a result of ik_fold_arm, with its flags and tag, and compares its joints with their limits.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; words Q2.(W-2) and binary angles.
// A word is written in a clock with go and writing high; its place follows from the program's order, stated by AFTER.
// Flags and tag are written with the first word. A comparison is written two clocks after its joint, even if go is low.
// Latency: 1 clock; 3 from a joint to its over_limit.
`default_nettype none

module ik_fold_arm_results #(
    parameter integer W     = 24,  // word length
    parameter integer TAG_W = 8,   // tag width
    parameter [135:0] AFTER = 0    // results written after each one: a byte each, in the order of m_axis_tdata
) (
    input  wire                clk,
    input  wire                rst,
    input  wire                go,
    input  wire [    14*W-1:0] limits,        // lower and upper of th1 .. th7, lowest bits first; static
    // Step
    input  wire                writing,
    input  wire                first_result,
    input  wire [         4:0] result,
    input  wire [       W-1:0] answer,        // the word
    input  wire [       W-1:0] th,            // or the joint
    input  wire [   TAG_W+8:0] head,          // tag, flags of the core, bad_hand
    // Result
    output wire [    17*W-1:0] m_axis_tdata,  // th1 .. th7, qs_w .. qs_k, qe_w, qe_i, qw_w .. qw_k, lowest bits first
    output wire [TAG_W+16-1:0] m_axis_tuser,  // tag, flags of the core, bad_hand, over_limit 1 .. 7
    // For waves and testbenches
    output wire                over           // comparison of the joint before the last
);

  `include "ik_flags.vh"
  `include "ik_fold_arm_codes.vh"

  // Results in the order in which they are written, the last one lowest, and the comparisons with the joints' limits.
  reg [17*W-1:0] words;
  reg [6:0] overs;
  reg [2:0] joint_1;  // joint of the last word
  reg angle_1, angle_2;  // an angle was written in the last clock, in the one before
  reg [TAG_W+8:0] head_1;
  ik_fold_limit #(.W(W)) u_limit (.clk(clk), .joint(joint_1), .th(words[W-1:0]), .limits(limits), .over(over));

  wire writes = go && writing && result != RESULT_NONE && result <= RESULT_QW_K;
  wire is_angle = result <= RESULT_TH7;
  always @(posedge clk) begin
    joint_1 <= result[2:0];  // TH1 to TH7 are 1 to 7
    angle_1 <= writes && is_angle && !rst;
    angle_2 <= angle_1 && !rst;
    if (writes) words <= {words[16*W-1:0], is_angle ? th : answer};
    if (angle_2) overs <= {overs[5:0], over};
    if (go && writing && first_result) head_1 <= head;
  end

  function integer angles_after(input integer joint);  // angles written after th1 (0) to th7 (6)
    integer m;
    begin
      angles_after = 0;
      for (m = 0; m < 7; m = m + 1) if (AFTER[8*m+:8] < AFTER[8*joint+:8]) angles_after = angles_after + 1;
    end
  endfunction
  assign m_axis_tuser[TAG_W+FLAG_BAD_HAND:0] = head_1;
  genvar k;
  generate
    for (k = 0; k < 17; k = k + 1) begin : g_word
      assign m_axis_tdata[W*k+:W] = words[W*AFTER[8*k+:8]+:W];
      if (k < 7) begin : g_over
        localparam integer PLACE = angles_after(k);
        assign m_axis_tuser[TAG_W+FLAG_OVER_1+k] = overs[PLACE];
      end
    end
  endgenerate
  wire unused = &{1'b0, words};

endmodule

`default_nettype wire

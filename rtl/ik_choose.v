// Chooses among the eight branches of a hand pose: the joints nearest to reference joints, inside their limits.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding but of steps, which are rounded towards 0 (ik_step). Binary angles, one turn = 2^W; a step has 12 bits,
// one turn = 2^12, and above them a bit for an angle outside its limits.
// The largest of the seven steps counts. For each elbow bit, shoulder and wrist choose their bits apart, as a maximum
// distributes over a minimum; of equal steps the given branch's bit stays. Where th2 or th6 is less than EPS words from
// 0 or half a turn, only the sum or difference of its neighbours counts: the first takes its reference, the other the
// rest.
// Each operator's equation is in model/dataflow/choose.py. A signal named like a node holds it in the node's clock,
// T_<NODE>. All inputs are valid at T_OVER_2, all results at T_CHOICE; clocks: ik_choose_nodes.vh.
// Throughput: one pose per clock.
// Latency: T_CHOICE - T_OVER_2 clocks.
`default_nettype none

module ik_choose #(
    parameter integer W    = 32,  // word length, 16 to 32
    parameter integer TILE = 18,  // of the datapath; sets the clocks of the nodes
    // th2 and th6 are singular less than EPS words from 0 or half a turn
    parameter integer EPS  = (W > 24) ? 8 : 16
) (
    input  wire            clk,
    input  wire            rst,           // synchronous: resets a delay's pointer only
    input  wire [14*W-1:0] limits,        // lower and upper of th1 .. th7, lowest bits first; static
    // Pose: joints and reference joints 1 to 7, lowest bits first; branch of the joints
    input  wire [ 7*W-1:0] joints,
    input  wire [ 7*W-1:0] refs,
    input  wire [     2:0] branch,        // shoulder, elbow, wrist, lowest bit first
    // Result
    output wire [ 7*W-1:0] joints_chosen,
    output wire [     6:0] outs,          // out_1 .. out_7: joints outside their limits
    // Lowest first: chosen branch; largest step, 12 bits; no branch is inside the limits; for n = 0 to 7, the given
    // branch xor n is inside them; singular
    output wire [    24:0] choice
);

  `include "ik_arm_nodes.vh"
  `include "ik_choose_nodes.vh"

  localparam integer STEP = 12;
  localparam [W-1:0] HALF = {1'b1, {(W - 1) {1'b0}}};

  wire [W-1:0] th1 = joints[0*W+:W];
  wire [W-1:0] th2 = joints[1*W+:W];
  wire [W-1:0] th5 = joints[4*W+:W];
  wire [W-1:0] th6 = joints[5*W+:W];
  wire [W-1:0] ref_1 = refs[0*W+:W];
  wire [W-1:0] ref_5 = refs[4*W+:W];

  // ---- singular shoulder or wrist ----

  localparam [31:0] BELOW = EPS - 1;
  localparam [W-2:0] NEAR = BELOW[W-2:0];
  wire [W-2:0] near_2 = th2[W-2:0] + NEAR;
  wire [W-2:0] near_6 = th6[W-2:0] + NEAR;
  reg singular_2, singular_6, opposite_2, opposite_6;
  reg signed [W-1:0] swing_1, swing_5;
  always @(posedge clk) begin
    singular_2 <= near_2 <= {NEAR[W-3:0], 1'b0};
    singular_6 <= near_6 <= {NEAR[W-3:0], 1'b0};
    // opposite_2 = th2 >= 1/2 or th2 < -1/2
    opposite_2 <= th2[W-1] ^ th2[W-2];
    // opposite_6 = th6 >= 1/2 or th6 < -1/2
    opposite_6 <= th6[W-1] ^ th6[W-2];
    // swing_1 = th1 - ref_1
    swing_1    <= th1 - ref_1;
    // swing_5 = th5 - ref_5
    swing_5    <= th5 - ref_5;
  end

  reg [7*W-1:0] joints_1, refs_1, refs_2;  // one clock later, two clocks later
  reg [W-1:0] th2_2, th4_2, th6_2;
  reg signed [W-1:0] split_1, split_3, split_5, split_7;
  always @(posedge clk) begin
    joints_1 <= joints;
    refs_1   <= refs;
    refs_2   <= refs_1;
    {th6_2, th4_2, th2_2} <= {joints_1[5*W+:W], joints_1[3*W+:W], joints_1[1*W+:W]};
    // split_1 = singular_2 ? ref_1 : th1
    split_1 <= singular_2 ? refs_1[0*W+:W] : joints_1[0*W+:W];
    // split_3 = th3 + (singular_2 ? (opposite_2 ? -swing_1 : swing_1) : 0)
    split_3 <= joints_1[2*W+:W] + ((swing_1 ^ {W{opposite_2}}) & {W{singular_2}})
        + {{(W-1){1'b0}}, singular_2 && opposite_2};
    // split_5 = singular_6 ? ref_5 : th5
    split_5 <= singular_6 ? refs_1[4*W+:W] : joints_1[4*W+:W];
    // split_7 = th7 + (singular_6 ? (opposite_6 ? -swing_5 : swing_5) : 0)
    split_7 <= joints_1[6*W+:W] + ((swing_5 ^ {W{opposite_6}}) & {W{singular_6}})
        + {{(W-1){1'b0}}, singular_6 && opposite_6};
  end

  // ---- steps of both angles of each joint ----

  wire [W-1:0] ref_at_1, at_1_0, at_1_1;
  wire out_1_0, out_1_1;
  wire signed [W:0] gap_1_0, gap_1_1;
  wire [STEP:0] step_1_0, step_1_1;
  ik_step #(.W(W)) u_step_1 (
      .clk(clk), .th(split_1), .ref_th(refs_2[0*W+:W]), .low(limits[0*W+:W]), .high(limits[1*W+:W]),
      .ref_at(ref_at_1), .at_0(at_1_0), .at_1(at_1_1), .out_0(out_1_0), .out_1(out_1_1),
      .gap_0(gap_1_0), .gap_1(gap_1_1), .step_0(step_1_0), .step_1(step_1_1)
  );
  wire [W-1:0] ref_at_2, at_2_0, at_2_1;
  wire out_2_0, out_2_1;
  wire signed [W:0] gap_2_0, gap_2_1;
  wire [STEP:0] step_2_0, step_2_1;
  ik_step #(.W(W), .NEGATED(1)) u_step_2 (
      .clk(clk), .th(th2_2), .ref_th(refs_2[1*W+:W]), .low(limits[2*W+:W]), .high(limits[3*W+:W]),
      .ref_at(ref_at_2), .at_0(at_2_0), .at_1(at_2_1), .out_0(out_2_0), .out_1(out_2_1),
      .gap_0(gap_2_0), .gap_1(gap_2_1), .step_0(step_2_0), .step_1(step_2_1)
  );
  wire [W-1:0] ref_at_3, at_3_0, at_3_1;
  wire out_3_0, out_3_1;
  wire signed [W:0] gap_3_0, gap_3_1;
  wire [STEP:0] step_3_0, step_3_1;
  ik_step #(.W(W)) u_step_3 (
      .clk(clk), .th(split_3), .ref_th(refs_2[2*W+:W]), .low(limits[4*W+:W]), .high(limits[5*W+:W]),
      .ref_at(ref_at_3), .at_0(at_3_0), .at_1(at_3_1), .out_0(out_3_0), .out_1(out_3_1),
      .gap_0(gap_3_0), .gap_1(gap_3_1), .step_0(step_3_0), .step_1(step_3_1)
  );
  wire [W-1:0] ref_at_4, at_4_0, at_4_1;
  wire out_4_0, out_4_1;
  wire signed [W:0] gap_4_0, gap_4_1;
  wire [STEP:0] step_4_0, step_4_1;
  ik_step #(.W(W), .NEGATED(1)) u_step_4 (
      .clk(clk), .th(th4_2), .ref_th(refs_2[3*W+:W]), .low(limits[6*W+:W]), .high(limits[7*W+:W]),
      .ref_at(ref_at_4), .at_0(at_4_0), .at_1(at_4_1), .out_0(out_4_0), .out_1(out_4_1),
      .gap_0(gap_4_0), .gap_1(gap_4_1), .step_0(step_4_0), .step_1(step_4_1)
  );
  wire [W-1:0] ref_at_5, at_5_0, at_5_1;
  wire out_5_0, out_5_1;
  wire signed [W:0] gap_5_0, gap_5_1;
  wire [STEP:0] step_5_0, step_5_1;
  ik_step #(.W(W)) u_step_5 (
      .clk(clk), .th(split_5), .ref_th(refs_2[4*W+:W]), .low(limits[8*W+:W]), .high(limits[9*W+:W]),
      .ref_at(ref_at_5), .at_0(at_5_0), .at_1(at_5_1), .out_0(out_5_0), .out_1(out_5_1),
      .gap_0(gap_5_0), .gap_1(gap_5_1), .step_0(step_5_0), .step_1(step_5_1)
  );
  wire [W-1:0] ref_at_6, at_6_0, at_6_1;
  wire out_6_0, out_6_1;
  wire signed [W:0] gap_6_0, gap_6_1;
  wire [STEP:0] step_6_0, step_6_1;
  ik_step #(.W(W), .NEGATED(1)) u_step_6 (
      .clk(clk), .th(th6_2), .ref_th(refs_2[5*W+:W]), .low(limits[10*W+:W]), .high(limits[11*W+:W]),
      .ref_at(ref_at_6), .at_0(at_6_0), .at_1(at_6_1), .out_0(out_6_0), .out_1(out_6_1),
      .gap_0(gap_6_0), .gap_1(gap_6_1), .step_0(step_6_0), .step_1(step_6_1)
  );
  wire [W-1:0] ref_at_7, at_7_0, at_7_1;
  wire out_7_0, out_7_1;
  wire signed [W:0] gap_7_0, gap_7_1;
  wire [STEP:0] step_7_0, step_7_1;
  ik_step #(.W(W)) u_step_7 (
      .clk(clk), .th(split_7), .ref_th(refs_2[6*W+:W]), .low(limits[12*W+:W]), .high(limits[13*W+:W]),
      .ref_at(ref_at_7), .at_0(at_7_0), .at_1(at_7_1), .out_0(out_7_0), .out_1(out_7_1),
      .gap_0(gap_7_0), .gap_1(gap_7_1), .step_0(step_7_0), .step_1(step_7_1)
  );

  // ---- largest step of each branch; the smallest of these ----

  function [STEP:0] max(input [STEP:0] a, input [STEP:0] b);
    max = (a < b) ? b : a;
  endfunction
  function [STEP:0] min(input [STEP:0] a, input [STEP:0] b);
    min = (b < a) ? b : a;
  endfunction

  // <ball>_<e><b>: elbow bit e and the ball's bit b are changed
  reg [STEP:0] shoulder_pair_0, shoulder_pair_1, shoulder_00, shoulder_01, shoulder_10, shoulder_11;
  reg [STEP:0] wrist_pair_0, wrist_pair_1, wrist_00, wrist_01, wrist_10, wrist_11;
  reg [STEP:0] shoulder_least_0, shoulder_least_1, wrist_least_0, wrist_least_1, balls_0, balls_1, arm_0, arm_1, least;
  reg shoulder_turn_0, shoulder_turn_1, wrist_turn_0, wrist_turn_1, turn_elbow, turn_shoulder, turn_wrist;
  wire [STEP:0] step_3_0_late, step_3_1_late, step_5_0_late, step_5_1_late;
  ik_delay #(.W(4*STEP+4), .N(T_SHOULDER_PAIR_0-T_STEP_3_0)) u_steps_late (
      .clk(clk), .d({step_5_1, step_5_0, step_3_1, step_3_0}),
      .q({step_5_1_late, step_5_0_late, step_3_1_late, step_3_0_late})
  );
  wire [STEP:0] step_4_0_late, step_4_1_late;
  ik_delay #(.W(2*STEP+2), .N(T_BALLS_0-T_STEP_4_0)) u_step_4_late (
      .clk(clk), .d({step_4_1, step_4_0}), .q({step_4_1_late, step_4_0_late})
  );
  wire shoulder_turn_0_late, shoulder_turn_1_late, wrist_turn_0_late, wrist_turn_1_late;
  ik_delay #(.W(4), .N(T_TURN_ELBOW-T_SHOULDER_TURN_0)) u_turns_late (
      .clk(clk), .d({wrist_turn_1, wrist_turn_0, shoulder_turn_1, shoulder_turn_0}),
      .q({wrist_turn_1_late, wrist_turn_0_late, shoulder_turn_1_late, shoulder_turn_0_late})
  );
  always @(posedge clk) begin
    // shoulder_pair_0 = max(step_1_0, step_2_0)
    shoulder_pair_0 <= max(step_1_0, step_2_0);
    // wrist_pair_0 = max(step_6_0, step_7_0)
    wrist_pair_0 <= max(step_6_0, step_7_0);
    // shoulder_pair_1 = max(step_1_1, step_2_1)
    shoulder_pair_1 <= max(step_1_1, step_2_1);
    // wrist_pair_1 = max(step_6_1, step_7_1)
    wrist_pair_1 <= max(step_6_1, step_7_1);
    // shoulder_00 = max(shoulder_pair_0, step_3_0)
    shoulder_00 <= max(shoulder_pair_0, step_3_0_late);
    // shoulder_01 = max(shoulder_pair_1, step_3_1)
    shoulder_01 <= max(shoulder_pair_1, step_3_1_late);
    // shoulder_10 = max(shoulder_pair_0, step_3_1)
    shoulder_10 <= max(shoulder_pair_0, step_3_1_late);
    // shoulder_11 = max(shoulder_pair_1, step_3_0)
    shoulder_11 <= max(shoulder_pair_1, step_3_0_late);
    // wrist_00 = max(wrist_pair_0, step_5_0)
    wrist_00 <= max(wrist_pair_0, step_5_0_late);
    // wrist_01 = max(wrist_pair_1, step_5_1)
    wrist_01 <= max(wrist_pair_1, step_5_1_late);
    // wrist_10 = max(wrist_pair_0, step_5_1)
    wrist_10 <= max(wrist_pair_0, step_5_1_late);
    // wrist_11 = max(wrist_pair_1, step_5_0)
    wrist_11 <= max(wrist_pair_1, step_5_0_late);
    // shoulder_turn_0 = shoulder_01 < shoulder_00
    shoulder_turn_0 <= shoulder_01 < shoulder_00;
    // shoulder_least_0 = min(shoulder_00, shoulder_01)
    shoulder_least_0 <= min(shoulder_00, shoulder_01);
    // shoulder_turn_1 = shoulder_11 < shoulder_10
    shoulder_turn_1 <= shoulder_11 < shoulder_10;
    // shoulder_least_1 = min(shoulder_10, shoulder_11)
    shoulder_least_1 <= min(shoulder_10, shoulder_11);
    // wrist_turn_0 = wrist_01 < wrist_00
    wrist_turn_0 <= wrist_01 < wrist_00;
    // wrist_least_0 = min(wrist_00, wrist_01)
    wrist_least_0 <= min(wrist_00, wrist_01);
    // wrist_turn_1 = wrist_11 < wrist_10
    wrist_turn_1 <= wrist_11 < wrist_10;
    // wrist_least_1 = min(wrist_10, wrist_11)
    wrist_least_1 <= min(wrist_10, wrist_11);
    // balls_0 = max(shoulder_least_0, wrist_least_0)
    balls_0 <= max(shoulder_least_0, wrist_least_0);
    // arm_0 = max(balls_0, step_4_0)
    arm_0 <= max(balls_0, step_4_0_late);
    // balls_1 = max(shoulder_least_1, wrist_least_1)
    balls_1 <= max(shoulder_least_1, wrist_least_1);
    // arm_1 = max(balls_1, step_4_1)
    arm_1 <= max(balls_1, step_4_1_late);
    // turn_elbow = arm_1 < arm_0
    turn_elbow <= arm_1 < arm_0;
    // least = min(arm_0, arm_1)
    least <= min(arm_0, arm_1);
    // turn_shoulder = turn_elbow ? shoulder_turn_1 : shoulder_turn_0
    turn_shoulder <= turn_elbow ? shoulder_turn_1_late : shoulder_turn_0_late;
    // turn_wrist = turn_elbow ? wrist_turn_1 : wrist_turn_0
    turn_wrist <= turn_elbow ? wrist_turn_1_late : wrist_turn_0_late;
  end

  // ---- branches inside the limits: no step of theirs has the top bit ----

  wire out_4_0_late, out_4_1_late;
  ik_delay #(.W(2), .N(T_SHOULDER_00-T_STEP_4_0)) u_out_4_late (
      .clk(clk), .d({step_4_1[STEP], step_4_0[STEP]}), .q({out_4_1_late, out_4_0_late})
  );
  reg feasible_0, feasible_1, feasible_2, feasible_3, feasible_4, feasible_5, feasible_6, feasible_7;
  always @(posedge clk) begin
    feasible_0 <= !(shoulder_00[STEP] || wrist_00[STEP] || out_4_0_late);
    feasible_1 <= !(shoulder_01[STEP] || wrist_00[STEP] || out_4_0_late);
    feasible_2 <= !(shoulder_10[STEP] || wrist_10[STEP] || out_4_1_late);
    feasible_3 <= !(shoulder_11[STEP] || wrist_10[STEP] || out_4_1_late);
    feasible_4 <= !(shoulder_00[STEP] || wrist_01[STEP] || out_4_0_late);
    feasible_5 <= !(shoulder_01[STEP] || wrist_01[STEP] || out_4_0_late);
    feasible_6 <= !(shoulder_10[STEP] || wrist_11[STEP] || out_4_1_late);
    feasible_7 <= !(shoulder_11[STEP] || wrist_11[STEP] || out_4_1_late);
  end

  // ---- joints and limits of the chosen branch ----

  wire [7*W-1:0] angles_at_turn;
  ik_ring #(.W(7*W), .N(T_TURN_WRIST-T_SPLIT_1)) u_angles_at_turn (
      .clk(clk), .rst(rst), .d({split_7, th6_2, split_5, th4_2, split_3, th2_2, split_1}), .q(angles_at_turn)
  );
  wire [13:0] outs_at_turn;
  ik_delay #(.W(14), .N(T_TURN_WRIST-T_OUT_1_0)) u_outs_at_turn (
      .clk(clk),
      .d({out_7_1, out_7_0, out_6_1, out_6_0, out_5_1, out_5_0, out_4_1, out_4_0, out_3_1, out_3_0, out_2_1, out_2_0,
          out_1_1, out_1_0}),
      .q(outs_at_turn)
  );
  wire [2:0] branch_at_turn;
  wire singular_2_at_turn, singular_6_at_turn;
  ik_delay #(.W(3), .N(T_TURN_WRIST-T_OVER_2)) u_branch_at_turn (.clk(clk), .d(branch), .q(branch_at_turn));
  ik_delay #(.W(2), .N(T_TURN_WRIST-T_SINGULAR_2)) u_singular_at_turn (
      .clk(clk), .d({singular_6, singular_2}), .q({singular_6_at_turn, singular_2_at_turn})
  );
  reg turn_elbow_late;
  reg signed [W-1:0] joint_1, joint_2, joint_3, joint_4, joint_5, joint_6, joint_7;
  reg out_1, out_2, out_3, out_4, out_5, out_6, out_7;
  reg choice_shoulder, choice_elbow, choice_wrist, singular;
  wire turn_3 = turn_shoulder ^ turn_elbow_late;
  wire turn_5 = turn_elbow_late ^ turn_wrist;
  always @(posedge clk) begin
    turn_elbow_late <= turn_elbow;
    choice_shoulder <= branch_at_turn[0] ^ turn_shoulder;
    choice_elbow    <= branch_at_turn[1] ^ turn_elbow_late;
    choice_wrist    <= branch_at_turn[2] ^ turn_wrist;
    singular        <= singular_2_at_turn || singular_6_at_turn;
    // joint_1 = split_1 + ((turn_shoulder) ? -1 : 0)
    joint_1 <= angles_at_turn[0*W+:W] ^ (HALF & {W{turn_shoulder}});
    // joint_2 = turn_shoulder ? -th2 : th2
    joint_2 <= turn_shoulder ? -angles_at_turn[1*W+:W] : angles_at_turn[1*W+:W];
    // joint_3 = split_3 + ((turn_shoulder xor turn_elbow) ? -1 : 0)
    joint_3 <= angles_at_turn[2*W+:W] ^ (HALF & {W{turn_3}});
    // joint_4 = turn_elbow ? -th4 : th4
    joint_4 <= turn_elbow_late ? -angles_at_turn[3*W+:W] : angles_at_turn[3*W+:W];
    // joint_5 = split_5 + ((turn_elbow xor turn_wrist) ? -1 : 0)
    joint_5 <= angles_at_turn[4*W+:W] ^ (HALF & {W{turn_5}});
    // joint_6 = turn_wrist ? -th6 : th6
    joint_6 <= turn_wrist ? -angles_at_turn[5*W+:W] : angles_at_turn[5*W+:W];
    // joint_7 = split_7 + ((turn_wrist) ? -1 : 0)
    joint_7 <= angles_at_turn[6*W+:W] ^ (HALF & {W{turn_wrist}});
    out_1 <= turn_shoulder ? outs_at_turn[1] : outs_at_turn[0];
    out_2 <= turn_shoulder ? outs_at_turn[3] : outs_at_turn[2];
    out_3 <= turn_3 ? outs_at_turn[5] : outs_at_turn[4];
    out_4 <= turn_elbow_late ? outs_at_turn[7] : outs_at_turn[6];
    out_5 <= turn_5 ? outs_at_turn[9] : outs_at_turn[8];
    out_6 <= turn_wrist ? outs_at_turn[11] : outs_at_turn[10];
    out_7 <= turn_wrist ? outs_at_turn[13] : outs_at_turn[12];
  end
  assign joints_chosen = {joint_7, joint_6, joint_5, joint_4, joint_3, joint_2, joint_1};
  assign outs = {out_7, out_6, out_5, out_4, out_3, out_2, out_1};
  assign choice[2:0] = {choice_wrist, choice_elbow, choice_shoulder};
  ik_delay #(.W(STEP+1), .N(T_CHOICE-T_LEAST)) u_least_late (.clk(clk), .d(least), .q(choice[3+:STEP+1]));
  ik_delay #(.W(8), .N(T_CHOICE-T_FEASIBLE_0)) u_feasible_late (
      .clk(clk), .d({feasible_7, feasible_6, feasible_5, feasible_4, feasible_3, feasible_2, feasible_1, feasible_0}),
      .q(choice[23:16])
  );
  assign choice[24] = singular;

endmodule

`default_nettype wire

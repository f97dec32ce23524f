// The seven joint angles: three from Qs, one from Qe, three from Qw; and their limits.
// SPDX-License-Identifier: Apache-2.0
//
// Joints half up from angles of W + 4 bits, see ik_vector; binary angles, one turn = 2^W; limits exact.
// Each branch bit turns or negates some of them: th + half a turn, or -th. over_<k> is set if th<k> is outside its
// limits. qs, qw, qe and the branch are valid at clock T_QW_W, each output at its clock T_<NODE>.
// Throughput: one pose per clock.
`default_nettype none

module ik_lean_joints #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer TILE = 18  // width of the multipliers' longer operand; sets the clock of Qw
) (
    // Clock
    input  wire                   clk,
    // Quaternions
    input  wire signed [   W-1:0] qs_w,
    input  wire signed [   W-1:0] qs_i,
    input  wire signed [   W-1:0] qs_j,
    input  wire signed [   W-1:0] qs_k,
    input  wire signed [   W-1:0] qe_i,
    input  wire signed [     W:0] minus_qe_w,
    input  wire signed [   W-1:0] qw_w,
    input  wire signed [   W-1:0] qw_i,
    input  wire signed [   W-1:0] qw_j,
    input  wire signed [   W-1:0] qw_k,
    // Branch
    input  wire                   shoulder,
    input  wire                   elbow,
    input  wire                   wrist,
    // Lower and upper limit of th1, .. th7, lowest bits first; static
    input  wire        [14*W-1:0] limits,
    // Results
    output wire        [   W-1:0] th1,     // T_TH1
    output wire        [   W-1:0] th2,     // T_TH2
    output wire        [   W-1:0] th3,     // T_TH1
    output wire        [   W-1:0] th4,     // T_TH4
    output wire        [   W-1:0] th5,     // T_TH1
    output wire        [   W-1:0] th6,     // T_TH2
    output wire        [   W-1:0] th7,     // T_TH1
    output wire                   over_1,  // T_OVER_1
    output wire                   over_2,
    output wire                   over_3,
    output wire                   over_4,
    output wire                   over_5,
    output wire                   over_6,
    output wire                   over_7
);

  `include "ik_arm_nodes.vh"

  // ---- branch: joints that are turned by half a turn, joints that are negated ----

  wire shoulder_at_d, elbow_at_d, wrist_at_d, minus_2, minus_6;
  ik_delay #(.W(3), .N(T_QS_D-T_QW_W)) u_branch_at_d (
      .clk(clk), .d({wrist, elbow, shoulder}), .q({wrist_at_d, elbow_at_d, shoulder_at_d})
  );
  ik_delay #(.W(2), .N(T_QS_B-T_QS_D)) u_branch_at_b (
      .clk(clk), .d({wrist_at_d, shoulder_at_d}), .q({minus_6, minus_2})
  );
  wire minus_4 = elbow_at_d;
  wire turn_1 = shoulder_at_d;
  wire turn_3 = shoulder_at_d ^ elbow_at_d;
  wire turn_5 = elbow_at_d ^ wrist_at_d;
  wire turn_7 = wrist_at_d;

  localparam integer DROP = F_QS_S - F_TH1;

  // ---- shoulder: th1 and th3 are sum and difference of two angles, th2 twice an angle ----

  wire [W+2:0] qs_ij;
  wire [W+2:0] qs_wk;
  wire [W+3:0] qs_d;
  wire [W+3:0] qs_s;
  wire [W+3:0] qs_b;
  // qs_d = atan2(qs_j, qs_i)
  // qs_ij = K * |(qs_i, qs_j)|
  ik_vector #(.W(W)) u_qs_d (
      .clk(clk), .x({qs_i[W-1], qs_i, 3'b000}), .y({qs_j[W-1], qs_j, 3'b000}), .length(qs_ij), .angle(qs_d)
  );
  // qs_s = atan2(qs_k, qs_w)
  // qs_wk = K * |(qs_w, qs_k)|
  ik_vector #(.W(W)) u_qs_s (
      .clk(clk), .x({qs_w[W-1], qs_w, 3'b000}), .y({qs_k[W-1], qs_k, 3'b000}), .length(qs_wk), .angle(qs_s)
  );
  // qs_b = atan2(qs_ij, qs_wk)
  ik_vector #(.W(W)) u_qs_b (.clk(clk), .x({1'b0, qs_wk}), .y({1'b0, qs_ij}), .length(), .angle(qs_b));
  // th1 = qs_s + qs_d + ((branch_shoulder) ? -1 : 0)
  ik_sum2 #(.IW(W+4), .SH(DROP), .OW(W), .SAT(0)) u_th1 (
      .clk(clk), .a(qs_s ^ {turn_1, {(W + 3) {1'b0}}}), .b(qs_d), .q(th1), .ovf()
  );
  // th3 = qs_s - qs_d + ((branch_shoulder xor branch_elbow) ? -1 : 0)
  ik_sum2 #(.IW(W+4), .SH(DROP), .OW(W), .SUB_B(1), .SAT(0)) u_th3 (
      .clk(clk), .a(qs_s ^ {turn_3, {(W + 3) {1'b0}}}), .b(qs_d), .q(th3), .ovf()
  );
  // th2 = branch_shoulder ? -2 * qs_b : 2 * qs_b
  ik_double #(.IW(W+4), .OW(W)) u_th2 (.clk(clk), .a(qs_b), .negate(minus_2), .q(th2));

  // ---- elbow ----

  wire [W+3:0] qe_e;
  // qe_e = atan2(-qe_w, qe_i)
  ik_vector #(.W(W)) u_qe_e (
      .clk(clk), .x({qe_i[W-1], qe_i, 3'b000}), .y({minus_qe_w, 3'b000}), .length(), .angle(qe_e)
  );
  // th4 = branch_elbow ? -2 * qe_e : 2 * qe_e
  ik_double #(.IW(W+4), .OW(W)) u_th4 (.clk(clk), .a(qe_e), .negate(minus_4), .q(th4));

  // ---- wrist: th5 and th7 are sum and difference of two angles, th6 twice an angle ----

  wire [W+2:0] qw_ij;
  wire [W+2:0] qw_wk;
  wire [W+3:0] qw_d;
  wire [W+3:0] qw_s;
  wire [W+3:0] qw_b;
  // qw_d = atan2(qw_j, qw_i)
  // qw_ij = K * |(qw_i, qw_j)|
  ik_vector #(.W(W)) u_qw_d (
      .clk(clk), .x({qw_i[W-1], qw_i, 3'b000}), .y({qw_j[W-1], qw_j, 3'b000}), .length(qw_ij), .angle(qw_d)
  );
  // qw_s = atan2(qw_k, qw_w)
  // qw_wk = K * |(qw_w, qw_k)|
  ik_vector #(.W(W)) u_qw_s (
      .clk(clk), .x({qw_w[W-1], qw_w, 3'b000}), .y({qw_k[W-1], qw_k, 3'b000}), .length(qw_wk), .angle(qw_s)
  );
  // qw_b = atan2(qw_ij, qw_wk)
  ik_vector #(.W(W)) u_qw_b (.clk(clk), .x({1'b0, qw_wk}), .y({1'b0, qw_ij}), .length(), .angle(qw_b));
  // th5 = qw_s + qw_d + ((branch_elbow xor branch_wrist) ? -1 : 0)
  ik_sum2 #(.IW(W+4), .SH(DROP), .OW(W), .SAT(0)) u_th5 (
      .clk(clk), .a(qw_s ^ {turn_5, {(W + 3) {1'b0}}}), .b(qw_d), .q(th5), .ovf()
  );
  // th7 = qw_s - qw_d + ((branch_wrist) ? -1 : 0)
  ik_sum2 #(.IW(W+4), .SH(DROP), .OW(W), .SUB_B(1), .SAT(0)) u_th7 (
      .clk(clk), .a(qw_s ^ {turn_7, {(W + 3) {1'b0}}}), .b(qw_d), .q(th7), .ovf()
  );
  // th6 = branch_wrist ? -2 * qw_b : 2 * qw_b
  ik_double #(.IW(W+4), .OW(W)) u_th6 (.clk(clk), .a(qw_b), .negate(minus_6), .q(th6));

  // ---- limits ----

  ik_limit #(.W(W)) u_over_1 (
      .clk(clk), .th(th1), .low(limits[0*W+:W]), .high(limits[1*W+:W]), .over(over_1)
  );
  ik_limit #(.W(W)) u_over_2 (
      .clk(clk), .th(th2), .low(limits[2*W+:W]), .high(limits[3*W+:W]), .over(over_2)
  );
  ik_limit #(.W(W)) u_over_3 (
      .clk(clk), .th(th3), .low(limits[4*W+:W]), .high(limits[5*W+:W]), .over(over_3)
  );
  ik_limit #(.W(W)) u_over_4 (
      .clk(clk), .th(th4), .low(limits[6*W+:W]), .high(limits[7*W+:W]), .over(over_4)
  );
  ik_limit #(.W(W)) u_over_5 (
      .clk(clk), .th(th5), .low(limits[8*W+:W]), .high(limits[9*W+:W]), .over(over_5)
  );
  ik_limit #(.W(W)) u_over_6 (
      .clk(clk), .th(th6), .low(limits[10*W+:W]), .high(limits[11*W+:W]), .over(over_6)
  );
  ik_limit #(.W(W)) u_over_7 (
      .clk(clk), .th(th7), .low(limits[12*W+:W]), .high(limits[13*W+:W]), .over(over_7)
  );

endmodule

`default_nettype wire

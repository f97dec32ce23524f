// The whole arm around the lean dataflow: hand pose in, seven joint angles out.
// SPDX-License-Identifier: Apache-2.0
//
// Results Q2.(W-2) and binary angles, half up; inputs Q2.(W-2), a binary angle; each node's format: ik_arm_nodes.vh.
// Each operator has the equation of its node above it, as in model/dataflow/arm.py; signals without one are flags, aligned
// copies or intermediate terms. The pipeline has no enable, and only the valid bits and the pointers of ik_ring are
// reset; valid and tag travel with the data.
// Throughput: one pose per clock.
//
// A signal named like a node holds it in the node's clock, T_<NODE>; x_at_y is x in clock T_<Y>. ik_lean gets the
// wrist in clock T_X, and its results leave in clock T_QS_W.
// Latency: T_OUT clocks; with CHOOSE, T_CHOICE (ik_choose_nodes.vh).
`default_nettype none

module ik_lean_arm #(
    parameter integer W     = 32,  // word length, 16 to 32, at most 24 with TILE = 16
    parameter integer TAG_W = 8,   // tag width, at least 1
    parameter integer TILE  = 18,  // width of the multipliers' longer operand: 18, 25 or 16
    parameter integer CHOOSE = 0,  // 1: ik_choose replaces the joints by the joints of the branch nearest to a reference
    parameter integer EPS    = 16  // see ik_choose
) (
    // Clock
    input  wire             clk,
    input  wire             rst,         // synchronous: discards the poses in flight
    // Lower and upper limit of th1, .. th7, lowest bits first; static
    input  wire [ 14*W-1:0] limits,
    // Hand pose
    input  wire             in_valid,
    input  wire [TAG_W-1:0] in_tag,
    input  wire [      2:0] in_branch,   // shoulder, elbow, wrist, lowest bit first
    // hand_x .. hand_z, phi, d1, d2, tool, qh_w .. qh_k, lowest bits first; with CHOOSE, above them reference joints
    input  wire [(11+7*CHOOSE)*W-1:0] in_data,
    // Result
    output wire             out_valid,
    output wire [TAG_W-1:0] out_tag,
    output wire [16+25*CHOOSE-1:0] out_flags,  // positions: ik_flags.vh; above them `choice` of ik_choose
    output wire [ 17*W-1:0] out_data     // th1 .. th7, qs_w .. qs_k, qe_w, qe_i, qw_w .. qw_k, lowest bits first
);

  `include "ik_flags.vh"
  `include "ik_arm_nodes.vh"
  `include "ik_choose_nodes.vh"

  generate
    if (W < 16 || W > ((TILE == 16) ? 24 : 32)) begin : g_no_words
      ik_lean_arm_illegal_W u_stop ();
    end
    if (TAG_W < 1) begin : g_no_tag
      ik_lean_arm_illegal_TAG_W u_stop ();
    end
    if (TILE != 16 && TILE != 18 && TILE != 25) begin : g_no_tile
      ik_lean_arm_illegal_TILE u_stop ();
    end
  endgenerate

  localparam integer N = FRAC + 2;  // width of an inner word

  localparam integer T_LAST = (CHOOSE != 0) ? T_CHOICE : T_OUT;  // clock of the results

  // ---- valid, outside ik_lean ----

  localparam integer T_AFTER = T_LAST - T_QS_W;
  reg [T_X-1:0] valid;  // newest in bit 0
  reg [T_AFTER-1:0] valid_after;
  wire lean_valid;
  always @(posedge clk) begin
    if (rst) begin
      valid       <= {T_X{1'b0}};
      valid_after <= {T_AFTER{1'b0}};
    end else begin
      valid       <= {valid[T_X-2:0], in_valid};
      valid_after <= {valid_after[T_AFTER-2:0], lean_valid};
    end
  end
  assign out_valid = valid_after[T_AFTER-1];

  // ---- wrist ----

  wire signed [W-1:0] hand_x = in_data[0*W+:W];
  wire signed [W-1:0] hand_y = in_data[1*W+:W];
  wire signed [W-1:0] hand_z = in_data[2*W+:W];
  wire signed [W-1:0] phi = in_data[3*W+:W];
  wire signed [W-1:0] d1 = in_data[4*W+:W];
  wire signed [W-1:0] d2 = in_data[5*W+:W];
  wire signed [W-1:0] tool = in_data[6*W+:W];
  wire signed [W-1:0] qh_w = in_data[7*W+:W];
  wire signed [W-1:0] qh_i = in_data[8*W+:W];
  wire signed [W-1:0] qh_j = in_data[9*W+:W];
  wire signed [W-1:0] qh_k = in_data[10*W+:W];
  wire branch_shoulder = in_branch[0];
  wire branch_elbow = in_branch[1];
  wire branch_wrist = in_branch[2];

  wire bad_hand, saturated;
  wire signed [W-1:0] x, y, z, h_w, h_i, h_j, h_k;
  ik_lean_hand #(.W(W), .N(N), .TILE(TILE)) u_hand (
      .clk(clk), .rst(rst),
      .hand_x(hand_x), .hand_y(hand_y), .hand_z(hand_z), .tool(tool),
      .qh_w(qh_w), .qh_i(qh_i), .qh_j(qh_j), .qh_k(qh_k),
      .bad_hand(bad_hand), .h_w(h_w), .h_i(h_i), .h_j(h_j), .h_k(h_k),
      .x(x), .y(y), .z(z), .saturated(saturated)
  );

  // ---- shoulder and elbow: the tag carries what belongs to the pose ----

  wire signed [W-1:0] phi_at_x, d1_at_x, d2_at_x;
  wire [TAG_W-1:0] tag_at_x;
  wire [2:0] branch_at_x;
  wire bad_hand_at_x;
  ik_ring #(.W(3*W+3+TAG_W), .N(T_X)) u_at_x (
      .clk(clk), .rst(rst),
      .d({branch_wrist, branch_elbow, branch_shoulder, in_tag, d2, d1, phi}),
      .q({branch_at_x, tag_at_x, d2_at_x, d1_at_x, phi_at_x})
  );
  ik_delay #(.W(1), .N(T_X-T_BAD_HAND)) u_bad_hand_at_x (.clk(clk), .d(bad_hand), .q(bad_hand_at_x));

  wire [2:0] branch_at_qs;
  wire saturated_at_qs, bad_hand_at_qs;
  wire [TAG_W-1:0] tag_at_qs;
  wire [7:0] flags_at_qs;
  wire [6*W-1:0] qse_at_qs;
  ik_lean #(.W(W), .TAG_W(TAG_W+5), .TILE(TILE)) u_lean (
      .clk(clk), .rst(rst),
      .in_valid(valid[T_X-1]), .in_tag({branch_at_x, saturated, bad_hand_at_x, tag_at_x}),
      .in_data({d2_at_x, d1_at_x, phi_at_x, z, y, x}),
      .out_valid(lean_valid), .out_tag({branch_at_qs, saturated_at_qs, bad_hand_at_qs, tag_at_qs}),
      .out_flags(flags_at_qs), .out_data(qse_at_qs)
  );
  wire unused_flags = &{1'b0, flags_at_qs[7:FLAG_SATURATED]};  // 0

  // ---- wrist quaternion ----

  wire signed [W-1:0] h_w_at_qs, h_i_at_qs, h_j_at_qs, h_k_at_qs;
  ik_ring #(.W(4*W), .N(T_QS_W-T_H_W)) u_h_at_qs (
      .clk(clk), .rst(rst), .d({h_k, h_j, h_i, h_w}), .q({h_k_at_qs, h_j_at_qs, h_i_at_qs, h_w_at_qs})
  );
  wire signed [W-1:0] qw_w, qw_i, qw_j, qw_k;
  ik_lean_frame #(.W(W), .N(N), .TILE(TILE)) u_frame (
      .clk(clk),
      .h_w(h_w_at_qs), .h_i(h_i_at_qs), .h_j(h_j_at_qs), .h_k(h_k_at_qs),
      .qs_w(qse_at_qs[0*W+:W]), .qs_i(qse_at_qs[1*W+:W]), .qs_j(qse_at_qs[2*W+:W]), .qs_k(qse_at_qs[3*W+:W]),
      .qe_w(qse_at_qs[4*W+:W]), .qe_i(qse_at_qs[5*W+:W]),
      .qw_w(qw_w), .qw_i(qw_i), .qw_j(qw_j), .qw_k(qw_k)
  );

  // ---- joints, of the words that leave ----

  // The last clock of the delay negates qe_w.
  localparam integer SIDE_W = TAG_W + 2 + FLAG_BAD_LENGTH + 1;  // saturated, bad_hand, tag, flags of ik_lean
  wire [2:0] branch_before;
  wire [SIDE_W-1:0] side_before;
  wire [6*W-1:0] qse_before;
  ik_ring #(.W(3+SIDE_W+6*W), .N(T_QW_W-T_QS_W-1)) u_before_qw (
      .clk(clk), .rst(rst),
      .d({branch_at_qs, saturated_at_qs, bad_hand_at_qs, tag_at_qs, flags_at_qs[FLAG_BAD_LENGTH:0], qse_at_qs}),
      .q({branch_before, side_before, qse_before})
  );
  wire signed [W-1:0] qe_w_before = qse_before[4*W+:W];
  reg [2:0] branch_at_qw;
  reg [SIDE_W-1:0] side_at_qw;
  reg [6*W-1:0] qse_at_qw;
  reg signed [W:0] minus_qe_w;
  always @(posedge clk) begin
    branch_at_qw <= branch_before;
    side_at_qw   <= side_before;
    qse_at_qw    <= qse_before;
    minus_qe_w   <= -{qe_w_before[W-1], qe_w_before};
  end

  wire [W-1:0] th1, th2, th3, th4, th5, th6, th7;
  wire over_1, over_2, over_3, over_4, over_5, over_6, over_7;
  ik_lean_joints #(.W(W), .TILE(TILE)) u_joints (
      .clk(clk),
      .qs_w(qse_at_qw[0*W+:W]), .qs_i(qse_at_qw[1*W+:W]), .qs_j(qse_at_qw[2*W+:W]), .qs_k(qse_at_qw[3*W+:W]),
      .qe_i(qse_at_qw[5*W+:W]), .minus_qe_w(minus_qe_w), .qw_w(qw_w), .qw_i(qw_i), .qw_j(qw_j), .qw_k(qw_k),
      .shoulder(branch_at_qw[0]), .elbow(branch_at_qw[1]), .wrist(branch_at_qw[2]),
      .limits(limits),
      .th1(th1), .th2(th2), .th3(th3), .th4(th4), .th5(th5), .th6(th6), .th7(th7),
      .over_1(over_1), .over_2(over_2), .over_3(over_3), .over_4(over_4), .over_5(over_5), .over_6(over_6),
      .over_7(over_7)
  );

  // ---- align the results ----

  wire [10*W-1:0] words_at_out;
  wire saturated_at_out, bad_hand_at_out;
  wire [FLAG_BAD_LENGTH:0] flags_at_out;  // of ik_lean
  ik_ring #(.W(SIDE_W+10*W), .N(T_LAST-T_QW_W)) u_words_at_out (
      .clk(clk), .rst(rst),
      .d({side_at_qw, qw_k, qw_j, qw_i, qw_w, qse_at_qw}),
      .q({saturated_at_out, bad_hand_at_out, out_tag, flags_at_out, words_at_out})
  );
  wire [W-1:0] th1_at_out, th2_at_out, th3_at_out, th4_at_out, th5_at_out, th6_at_out, th7_at_out;
  ik_ring #(.W(4*W), .N(T_OUT-T_TH1)) u_th1_at_out (
      .clk(clk), .rst(rst), .d({th7, th5, th3, th1}), .q({th7_at_out, th5_at_out, th3_at_out, th1_at_out})
  );
  ik_ring #(.W(W), .N(T_OUT-T_TH4)) u_th4_at_out (.clk(clk), .rst(rst), .d(th4), .q(th4_at_out));
  ik_delay #(.W(2*W), .N(T_OUT-T_TH2)) u_th2_at_out (.clk(clk), .d({th6, th2}), .q({th6_at_out, th2_at_out}));
  wire [7*W-1:0] joints_at_out = {th7_at_out, th6_at_out, th5_at_out, th4_at_out, th3_at_out, th2_at_out, th1_at_out};
  assign out_data[7*W+:10*W] = words_at_out;
  assign out_flags[FLAG_BAD_LENGTH:0] = flags_at_out;
  assign out_flags[FLAG_SATURATED] = saturated_at_out;
  assign out_flags[FLAG_BAD_HAND-1:FLAG_SATURATED+1] = 0;
  assign out_flags[FLAG_BAD_HAND] = bad_hand_at_out;

  generate
    if (CHOOSE == 0) begin : g_given
      wire over_1_at_out, over_3_at_out, over_4_at_out, over_5_at_out, over_7_at_out;
      ik_delay #(.W(4), .N(T_OUT-T_OVER_1)) u_over_1_at_out (
          .clk(clk), .d({over_7, over_5, over_3, over_1}),
          .q({over_7_at_out, over_5_at_out, over_3_at_out, over_1_at_out})
      );
      ik_delay #(.W(1), .N(T_OUT-T_OVER_4)) u_over_4_at_out (.clk(clk), .d(over_4), .q(over_4_at_out));
      assign out_data[0+:7*W] = joints_at_out;
      assign out_flags[FLAG_OVER_1+:7] = {
        over_7_at_out, over_6, over_5_at_out, over_4_at_out, over_3_at_out, over_2, over_1_at_out
      };
    end else begin : g_choose
      wire [W-1:0] ref_1 = in_data[11*W+:W];
      wire [W-1:0] ref_2 = in_data[12*W+:W];
      wire [W-1:0] ref_3 = in_data[13*W+:W];
      wire [W-1:0] ref_4 = in_data[14*W+:W];
      wire [W-1:0] ref_5 = in_data[15*W+:W];
      wire [W-1:0] ref_6 = in_data[16*W+:W];
      wire [W-1:0] ref_7 = in_data[17*W+:W];
      wire [7*W-1:0] refs_at_out;
      wire [2:0] branch_at_out;
      ik_ring #(.W(7*W), .N(T_OUT)) u_refs_at_out (
          .clk(clk), .rst(rst), .d({ref_7, ref_6, ref_5, ref_4, ref_3, ref_2, ref_1}), .q(refs_at_out)
      );
      ik_ring #(.W(3), .N(T_OUT-T_QW_W)) u_branch_at_out (.clk(clk), .rst(rst), .d(branch_at_qw), .q(branch_at_out));
      ik_choose #(.W(W), .TILE(TILE), .EPS(EPS)) u_choose (
          .clk(clk), .rst(rst),
          .limits(limits),
          .joints(joints_at_out), .refs(refs_at_out), .branch(branch_at_out),
          .joints_chosen(out_data[0+:7*W]), .outs(out_flags[FLAG_OVER_1+:7]), .choice(out_flags[FLAG_OVER_1+7+:25])
      );
      wire unused_overs = &{1'b0, over_1, over_2, over_3, over_4, over_5, over_6, over_7};
    end
  endgenerate

endmodule

`default_nettype wire

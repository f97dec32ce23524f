// The wrist of a hand pose, and the check of the hand's quaternion.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_arm_nodes.vh; rounding: flags exact, products as in ik_mul3, the wrist half up, saturated.
// The wrist is hand - 2 t r, where t is the tool's length and r is half the third column of Qh's rotation matrix. A
// hand is bad if |Qh| is outside [1 - 2^-8, 1 + 2^-8); then Qh is replaced by 1 and t by 0. Inputs are valid at clock
// 0, each output at its clock T_<NODE>.
// Throughput: one pose per clock.
`default_nettype none

module ik_lean_hand #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = 35,  // inner word width: FRAC + 2
    parameter integer TILE = 18  // see ik_mul3
) (
    // Clock
    input  wire                clk,
    input  wire                rst,        // synchronous: see ik_ring
    // Hand pose
    input  wire signed [W-1:0] hand_x,
    input  wire signed [W-1:0] hand_y,
    input  wire signed [W-1:0] hand_z,
    input  wire signed [W-1:0] tool,
    input  wire signed [W-1:0] qh_w,
    input  wire signed [W-1:0] qh_i,
    input  wire signed [W-1:0] qh_j,
    input  wire signed [W-1:0] qh_k,
    // Orientation
    output reg                 bad_hand,   // T_BAD_HAND
    output reg  signed [W-1:0] h_w,        // T_H_W
    output reg  signed [W-1:0] h_i,
    output reg  signed [W-1:0] h_j,
    output reg  signed [W-1:0] h_k,
    // Wrist
    output wire signed [W-1:0] x,          // T_X
    output wire signed [W-1:0] y,
    output wire signed [W-1:0] z,
    output wire                saturated   // T_SATURATED
);

  `include "ik_arm_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_hand_illegal_N u_stop ();
    end
  endgenerate

  // ---- squared length; a sum of 8 or more wraps to one that is not near 1 ----

  localparam integer XW = 2 * W;
  wire signed [W-1:0] none = {W{1'b0}};
  wire signed [XW-1:0] hi_sq;
  wire signed [XW-1:0] hj_sq;
  wire signed [XW-1:0] hk_sq;
  wire signed [XW-1:0] hw_sq;
  wire signed [XW-1:0] hij_sq;
  wire signed [XW-1:0] hijk_sq;
  wire signed [XW-1:0] hand_sq;
  // hi_sq = qh_i^2
  ik_exact #(.W(W), .SQUARE(1)) u_hi_sq (.clk(clk), .a(qh_i), .b(none), .p(hi_sq));
  // hj_sq = qh_j^2
  ik_exact #(.W(W), .SQUARE(1)) u_hj_sq (.clk(clk), .a(qh_j), .b(none), .p(hj_sq));
  // hk_sq = qh_k^2
  ik_exact #(.W(W), .SQUARE(1)) u_hk_sq (.clk(clk), .a(qh_k), .b(none), .p(hk_sq));
  // hw_sq = qh_w^2
  ik_exact #(.W(W), .SQUARE(1)) u_hw_sq (.clk(clk), .a(qh_w), .b(none), .p(hw_sq));
  // hij_sq = hi_sq + hj_sq
  ik_wide #(.W(XW)) u_hij_sq (.clk(clk), .a(hi_sq), .b(hj_sq), .q(hij_sq));
  // hijk_sq = hij_sq + hk_sq
  ik_wide #(.W(XW), .DB(T_HIJ_SQ-T_HK_SQ)) u_hijk_sq (.clk(clk), .a(hij_sq), .b(hk_sq), .q(hijk_sq));
  // hand_sq = hijk_sq + hw_sq
  ik_wide #(.W(XW), .DB(T_HIJK_SQ-T_HW_SQ)) u_hand_sq (.clk(clk), .a(hijk_sq), .b(hw_sq), .q(hand_sq));

  // (1 -+ 2^-8)^2 = 1 + 2^-16 -+ 2^-7
  localparam signed [XW-1:0] ONE = {{(XW - 1) {1'b0}}, 1'b1} << F_HAND_SQ;
  localparam signed [XW-1:0] LEAST = ONE + (ONE >>> 16) - (ONE >>> 7);
  localparam signed [XW-1:0] MOST = ONE + (ONE >>> 16) + (ONE >>> 7);
  always @(posedge clk) bad_hand <= (hand_sq < LEAST) || (hand_sq >= MOST);

  // ---- orientation and tool of a good hand ----

  wire signed [W-1:0] qh_w_at_bad, qh_i_at_bad, qh_j_at_bad, qh_k_at_bad, tool_at_bad;
  ik_ring #(.W(5*W), .N(T_BAD_HAND)) u_qh_at_bad (
      .clk(clk), .rst(rst), .d({tool, qh_k, qh_j, qh_i, qh_w}),
      .q({tool_at_bad, qh_k_at_bad, qh_j_at_bad, qh_i_at_bad, qh_w_at_bad})
  );
  localparam signed [W-1:0] UNIT = {2'b01, {(W - 2) {1'b0}}};
  reg signed [W-1:0] tool_h;
  always @(posedge clk) begin
    h_w    <= bad_hand ? UNIT : qh_w_at_bad;
    h_i    <= bad_hand ? {W{1'b0}} : qh_i_at_bad;
    h_j    <= bad_hand ? {W{1'b0}} : qh_j_at_bad;
    h_k    <= bad_hand ? {W{1'b0}} : qh_k_at_bad;
    tool_h <= bad_hand ? {W{1'b0}} : tool_at_bad;
  end

  // ---- half the third column of Qh's rotation matrix; multiplied by 0 for a bad hand ----

  localparam integer SH_H = F_QH_I + F_QH_K - F_H_IK;
  wire signed [N-1:0] h_ik;
  wire signed [N-1:0] h_wj;
  wire signed [N-1:0] h_jk;
  wire signed [N-1:0] h_wi;
  wire signed [N-1:0] h_ii;
  wire signed [N-1:0] h_jj;
  // h_ik = qh_i * qh_k
  ik_mul3 #(.AW(W), .BW(W), .SH(SH_H), .OW(N), .TILE(TILE)) u_h_ik (.clk(clk), .a(qh_i), .b(qh_k), .q(h_ik));
  // h_wj = qh_w * qh_j
  ik_mul3 #(.AW(W), .BW(W), .SH(SH_H), .OW(N), .TILE(TILE)) u_h_wj (.clk(clk), .a(qh_w), .b(qh_j), .q(h_wj));
  // h_jk = qh_j * qh_k
  ik_mul3 #(.AW(W), .BW(W), .SH(SH_H), .OW(N), .TILE(TILE)) u_h_jk (.clk(clk), .a(qh_j), .b(qh_k), .q(h_jk));
  // h_wi = qh_w * qh_i
  ik_mul3 #(.AW(W), .BW(W), .SH(SH_H), .OW(N), .TILE(TILE)) u_h_wi (.clk(clk), .a(qh_w), .b(qh_i), .q(h_wi));
  // h_ii = qh_i^2
  ik_mul3 #(.AW(W), .BW(W), .SH(SH_H), .OW(N), .SQUARE(1), .TILE(TILE)) u_h_ii (
      .clk(clk), .a(qh_i), .b(qh_i), .q(h_ii)
  );
  // h_jj = qh_j^2
  ik_mul3 #(.AW(W), .BW(W), .SH(SH_H), .OW(N), .SQUARE(1), .TILE(TILE)) u_h_jj (
      .clk(clk), .a(qh_j), .b(qh_j), .q(h_jj)
  );
  localparam signed [N-1:0] HALF = {{(N - 1) {1'b0}}, 1'b1} << (FRAC - 1);
  reg signed [N-1:0] r_x;
  reg signed [N-1:0] r_y;
  reg signed [N-1:0] r_z;
  always @(posedge clk) begin
    r_x <= h_ik + h_wj;
    r_y <= h_jk - h_wi;
    r_z <= HALF - h_ii - h_jj;
  end

  // ---- the wrist: off is half the offset ----

  localparam integer T_OFF_IN = T_OFF_X - LAT_MUL3;
  localparam integer SH_OFF = F_R_X + F_TOOL_H - F_OFF_X;
  wire signed [W-1:0] tool_at_off;
  wire signed [N-1:0] off_x;
  wire signed [N-1:0] off_y;
  wire signed [N-1:0] off_z;
  ik_delay #(.W(W), .N(T_OFF_IN-T_TOOL_H)) u_tool_at_off (.clk(clk), .d(tool_h), .q(tool_at_off));
  // off_x = r_x * tool_h
  // off_y = r_y * tool_h
  // off_z = r_z * tool_h
  ik_scale #(.COUNT(3), .AW(N), .BW(W), .SH(SH_OFF), .OW(N), .DA(T_OFF_IN-T_R_X), .TILE(TILE)) u_by_tool_h (
      .clk(clk), .a({r_z, r_y, r_x}), .b(tool_at_off), .q({off_z, off_y, off_x})
  );

  localparam integer DROP = F_OFF_X - F_X - 1;
  wire signed [W-1:0] hand_x_at_off, hand_y_at_off, hand_z_at_off;
  wire x_over, y_over, z_over;
  ik_ring #(.W(3*W), .N(T_OFF_X)) u_hand_at_off (
      .clk(clk), .rst(rst), .d({hand_z, hand_y, hand_x}), .q({hand_z_at_off, hand_y_at_off, hand_x_at_off})
  );
  // half the point, with the fraction bits of off
  wire signed [N-1:0] half_x = {hand_x_at_off[W-1], hand_x_at_off, {DROP{1'b0}}};
  wire signed [N-1:0] half_y = {hand_y_at_off[W-1], hand_y_at_off, {DROP{1'b0}}};
  wire signed [N-1:0] half_z = {hand_z_at_off[W-1], hand_z_at_off, {DROP{1'b0}}};
  // x = hand_x - 2 * off_x
  ik_sum2 #(.IW(N), .SH(DROP), .OW(W), .SUB_B(1)) u_x (.clk(clk), .a(half_x), .b(off_x), .q(x), .ovf(x_over));
  // y = hand_y - 2 * off_y
  ik_sum2 #(.IW(N), .SH(DROP), .OW(W), .SUB_B(1)) u_y (.clk(clk), .a(half_y), .b(off_y), .q(y), .ovf(y_over));
  // z = hand_z - 2 * off_z
  ik_sum2 #(.IW(N), .SH(DROP), .OW(W), .SUB_B(1)) u_z (.clk(clk), .a(half_z), .b(off_z), .q(z), .ovf(z_over));
  assign saturated = x_over || y_over || z_over;

endmodule

`default_nettype wire

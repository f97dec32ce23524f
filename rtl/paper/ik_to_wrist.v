// The rotation to the wrist (17), and the shoulder quaternion Qs (18): section 3.5.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_paper_nodes.vh; rounding: products and sums half up, roots and quotient floor.
// theta_3 is the angle between the rotated y-z plane and the swivel plane; Qs = Q12 Q3. The division by |pi_swivel| is
// a product with its reciprocal, computed long before c3 needs it. Each port is valid at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_to_wrist #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer DIGIT = 0    // dividers and roots: 1 digit recurrence, 0 behavioural
) (
    // Clock
    input  wire                clk,
    input  wire                rst,                 // synchronous, for ik_ring
    // From swivel
    input  wire signed [W-1:0] pi_swivel_x,         // T_PI_SWIVEL_X
    input  wire signed [W-1:0] pi_swivel_y,
    input  wire signed [W-1:0] pi_swivel_z,
    // Target
    input  wire signed [W-1:0] p_w_x_at_pi_swivel,  // the target, delayed to T_PI_SWIVEL_X
    input  wire signed [W-1:0] p_w_y_at_pi_swivel,
    input  wire signed [W-1:0] p_w_z_at_pi_swivel,
    // From elbow
    input  wire signed [W-1:0] pp_1_m,              // T_PP_1_M
    input  wire signed [W-1:0] pp_2_m,
    input  wire signed [W-1:0] pp_3_m,
    input  wire                flat,                // T_FLAT
    input  wire                back,                // T_BACK
    // From to_elbow
    input  wire signed [W-1:0] q12_i,               // T_Q12_I
    input  wire signed [W-1:0] q12_j,
    input  wire signed [W-1:0] q12_k,
    // Results
    output wire signed [W-1:0] qs_w,                // T_QS_W
    output wire signed [W-1:0] qs_i,                // T_QS_I
    output wire signed [W-1:0] qs_j,                // T_QS_J
    output wire signed [W-1:0] qs_k                 // T_QS_K
);

  `include "ik_paper_nodes.vh"

  localparam integer WW = W + GUARD;  // width of an unrounded product

  // ---- (17) 1 / |pi_swivel| ----

  wire signed [WW-1:0] pi_sq_x, pi_sq_y, pi_sq_z;
  wire signed [W-1:0] pi_sq, pi_abs, pi_inv;
  localparam integer SH_PI = 2 * F_PI_SWIVEL_X - F_PI_SQ_X;
  localparam signed [W-1:0] ONE = {2'b01, {(W - 2) {1'b0}}};
  // (17) pi_sq_x = pi_swivel_x^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_PI), .OW(WW), .SQUARE(1)) u_pi_sq_x (
      .clk(clk), .a(pi_swivel_x), .b(pi_swivel_x), .q(pi_sq_x)
  );
  // (17) pi_sq_y = pi_swivel_y^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_PI), .OW(WW), .SQUARE(1)) u_pi_sq_y (
      .clk(clk), .a(pi_swivel_y), .b(pi_swivel_y), .q(pi_sq_y)
  );
  // (17) pi_sq_z = pi_swivel_z^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_PI), .OW(WW), .SQUARE(1)) u_pi_sq_z (
      .clk(clk), .a(pi_swivel_z), .b(pi_swivel_z), .q(pi_sq_z)
  );
  // (17) pi_sq = pi_sq_x + pi_sq_y + pi_sq_z
  ik_sum3 #(.IW(WW), .SH(F_PI_SQ_X-F_PI_SQ), .OW(W), .SAT(0)) u_pi_sq (
      .clk(clk), .a(pi_sq_x), .b(pi_sq_y), .c(pi_sq_z), .q(pi_sq), .ovf()
  );
  // (17) pi_abs = sqrt pi_sq
  ik_root #(.NW(W), .SH(2*F_PI_ABS-F_PI_SQ), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_pi_abs (
      .clk(clk), .n({1'b0, pi_sq[W-2:0]}), .q(pi_abs), .neg()  // a sum of squares has no sign
  );
  // (17) pi_inv = 1 / pi_abs
  ik_div #(.NW(W), .DW(W), .SH(F_PI_INV-(W-2)+F_PI_ABS), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_pi_inv (
      .clk(clk), .n(ONE), .d(pi_abs), .q(pi_inv), .ovf()
  );

  wire signed [W-1:0] pi_swivel_x_at_q12_i, pi_swivel_y_at_q12_i, pi_swivel_z_at_q12_i;
  ik_ring #(.W(3*W), .N(T_Q12_I-T_PI_SWIVEL_X)) u_pi_swivel_at_q12_i (
      .clk(clk), .rst(rst), .d({pi_swivel_z, pi_swivel_y, pi_swivel_x}),
      .q({pi_swivel_z_at_q12_i, pi_swivel_y_at_q12_i, pi_swivel_x_at_q12_i})
  );

  // ---- (17) the x axis rotated by Q12: -r_x, 2 q12_i q12_j, 2 q12_i q12_k ----

  wire signed [WW-1:0] q12_i_sq, q12_j_sq, q12_k_sq;
  wire signed [W-1:0] r_x;  // q12_k^2 + q12_j^2 - q12_i^2
  localparam integer SH_QQ = 2 * F_Q12_I - F_Q12_I_SQ;
  // (17) q12_i_sq = q12_i^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_QQ), .OW(WW), .SQUARE(1)) u_q12_i_sq (.clk(clk), .a(q12_i), .b(q12_i), .q(q12_i_sq));
  // (17) q12_j_sq = q12_j^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_QQ), .OW(WW), .SQUARE(1)) u_q12_j_sq (.clk(clk), .a(q12_j), .b(q12_j), .q(q12_j_sq));
  // (17) q12_k_sq = q12_k^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_QQ), .OW(WW), .SQUARE(1)) u_q12_k_sq (.clk(clk), .a(q12_k), .b(q12_k), .q(q12_k_sq));
  // (17) r_x = q12_k_sq + q12_j_sq - q12_i_sq
  ik_sum3 #(.IW(WW), .SH(F_Q12_K_SQ-F_R_X), .OW(W), .SUB_C(1), .SAT(0)) u_r_x (
      .clk(clk), .a(q12_k_sq), .b(q12_j_sq), .c(q12_i_sq), .q(r_x), .ovf()
  );

  // ---- (17) c3: the swivel plane's normal along that axis ----

  wire signed [WW-1:0] g_y, g_z;
  wire signed [W-1:0] g;  // q12_j pi_swivel_y + q12_k pi_swivel_z
  // (17) g_y = q12_j * pi_swivel_y
  ik_mul #(.AW(W), .BW(W), .SH(F_Q12_J+F_PI_SWIVEL_Y-F_G_Y), .OW(WW)) u_g_y (
      .clk(clk), .a(q12_j), .b(pi_swivel_y_at_q12_i), .q(g_y)
  );
  // (17) g_z = q12_k * pi_swivel_z
  ik_mul #(.AW(W), .BW(W), .SH(F_Q12_K+F_PI_SWIVEL_Z-F_G_Z), .OW(WW)) u_g_z (
      .clk(clk), .a(q12_k), .b(pi_swivel_z_at_q12_i), .q(g_z)
  );
  // (17) g = g_y + g_z
  ik_sum2 #(.IW(WW), .SH(F_G_Y-F_G), .OW(W), .SAT(0)) u_g (.clk(clk), .a(g_y), .b(g_z), .q(g), .ovf());

  wire signed [WW-1:0] c3_r, c3_g;
  wire signed [W-1:0] c3_num;
  // (17) c3_r = pi_swivel_x * r_x
  ik_mul #(.AW(W), .BW(W), .SH(F_PI_SWIVEL_X+F_R_X-F_C3_R), .OW(WW), .DA(T_R_X-T_Q12_I)) u_c3_r (
      .clk(clk), .a(pi_swivel_x_at_q12_i), .b(r_x), .q(c3_r)
  );
  // (17) c3_g = 2 * q12_i * g
  ik_mul #(.AW(W), .BW(W), .SH(F_Q12_I+F_G-1-F_C3_G), .OW(WW), .DA(T_G-T_Q12_I)) u_c3_g (
      .clk(clk), .a(q12_i), .b(g), .q(c3_g)
  );
  // (17) c3_num = c3_r - c3_g
  ik_sum2 #(.IW(WW), .SH(F_C3_R-F_C3_NUM), .OW(W), .SUB_B(1), .DB(T_C3_R-T_C3_G)) u_c3_num (
      .clk(clk), .a(c3_r), .b(c3_g), .q(c3_num), .ovf()
  );

  wire signed [W-1:0] pi_inv_at_c3_num, c3;
  ik_ring #(.W(W), .N(T_C3_NUM-T_PI_INV)) u_pi_inv_at_c3_num (.clk(clk), .rst(rst), .d(pi_inv), .q(pi_inv_at_c3_num));
  // (17) c3 = c3_num * pi_inv
  ik_mul #(.AW(W), .BW(W), .SH(F_C3_NUM+F_PI_INV-F_C3), .OW(W)) u_c3 (
      .clk(clk), .a(c3_num), .b(pi_inv_at_c3_num), .q(c3)
  );

  // ---- (17) sign: the side of the rotated plane on which the target lies. If shoulder, elbow and target are
  // collinear, the target lies in the plane, and the elbow's side of the line decides. Only the sign of the sum
  // matters, so PP_m^- is used unscaled ----

  wire signed [W-1:0] p_w_x_at_flat, p_w_y_at_flat, p_w_z_at_flat, pp_1_m_at_flat, pp_2_m_at_flat, pp_3_m_at_flat;
  wire back_at_flat;
  ik_ring #(.W(3*W), .N(T_FLAT-T_PI_SWIVEL_X)) u_p_w_at_flat (
      .clk(clk), .rst(rst), .d({p_w_z_at_pi_swivel, p_w_y_at_pi_swivel, p_w_x_at_pi_swivel}),
      .q({p_w_z_at_flat, p_w_y_at_flat, p_w_x_at_flat})
  );
  ik_ring #(.W(3*W), .N(T_FLAT-T_PP_1_M)) u_pp_at_flat (
      .clk(clk), .rst(rst), .d({pp_3_m, pp_2_m, pp_1_m}), .q({pp_3_m_at_flat, pp_2_m_at_flat, pp_1_m_at_flat})
  );
  ik_delay #(.W(1), .N(T_FLAT-T_BACK)) u_back_at_flat (.clk(clk), .d(back), .q(back_at_flat));
  wire signed [W-1:0] side_x, side_y, side_z;
  ik_pick #(.W(W)) u_side_x (
      .clk(clk), .a(p_w_x_at_flat), .b(pp_1_m_at_flat), .use_b(flat), .minus(!back_at_flat), .q(side_x)
  );
  ik_pick #(.W(W)) u_side_y (
      .clk(clk), .a(p_w_y_at_flat), .b(pp_2_m_at_flat), .use_b(flat), .minus(!back_at_flat), .q(side_y)
  );
  ik_pick #(.W(W)) u_side_z (
      .clk(clk), .a(p_w_z_at_flat), .b(pp_3_m_at_flat), .use_b(flat), .minus(!back_at_flat), .q(side_z)
  );

  wire signed [W-1:0] side_x_at_q12_i, side_y_at_q12_i, side_z_at_q12_i;
  ik_ring #(.W(3*W), .N(T_Q12_I-T_SIDE_X)) u_side_at_q12_i (
      .clk(clk), .rst(rst), .d({side_z, side_y, side_x}), .q({side_z_at_q12_i, side_y_at_q12_i, side_x_at_q12_i})
  );

  wire signed [WW-1:0] sg_r, sg_y, sg_z;
  wire signed [W-1:0] sg;
  wire signed [WW-1:0] sg_g, sign;
  // (17) sg_r = side_x * r_x
  ik_mul #(.AW(W), .BW(W), .SH(F_SIDE_X+F_R_X-F_SG_R), .OW(WW), .DA(T_R_X-T_Q12_I)) u_sg_r (
      .clk(clk), .a(side_x_at_q12_i), .b(r_x), .q(sg_r)
  );
  // (17) sg_y = q12_j * side_y
  ik_mul #(.AW(W), .BW(W), .SH(F_Q12_J+F_SIDE_Y-F_SG_Y), .OW(WW)) u_sg_y (
      .clk(clk), .a(q12_j), .b(side_y_at_q12_i), .q(sg_y)
  );
  // (17) sg_z = q12_k * side_z
  ik_mul #(.AW(W), .BW(W), .SH(F_Q12_K+F_SIDE_Z-F_SG_Z), .OW(WW)) u_sg_z (
      .clk(clk), .a(q12_k), .b(side_z_at_q12_i), .q(sg_z)
  );
  // (17) sg = sg_y + sg_z
  ik_sum2 #(.IW(WW), .SH(F_SG_Y-F_SG), .OW(W), .SAT(0)) u_sg (.clk(clk), .a(sg_y), .b(sg_z), .q(sg), .ovf());
  // (17) sg_g = 2 * q12_i * sg
  ik_mul #(.AW(W), .BW(W), .SH(F_Q12_I+F_SG-1-F_SG_G), .OW(WW), .DA(T_G-T_Q12_I)) u_sg_g (
      .clk(clk), .a(q12_i), .b(sg), .q(sg_g)
  );
  // (17) sign = sg_g - sg_r
  ik_sum2 #(.IW(WW), .SH(F_SG_R-F_SIGN), .OW(WW), .SUB_B(1), .SAT(0), .DA(T_SG_R-T_SG_G)) u_sign (
      .clk(clk), .a(sg_g), .b(sg_r), .q(sign), .ovf()
  );

  // ---- (17) q3_scalar = sqrt((1 + c3)/2), q3_k = sign sqrt((1 - c3)/2) ----

  wire [W-1:0] h3_p, h3_m;
  wire signed [W-1:0] q3_scalar, q3_abs;
  localparam integer SH_ROOT = 2 * F_Q3_SCALAR - (W - 1);
  // (17) h3_p = min(max((1 + c3) / 2, 0), 1)
  ik_half #(.W(W)) u_h3_p (.clk(clk), .c(c3), .q(h3_p));
  // (17) h3_m = min(max((1 - c3) / 2, 0), 1)
  ik_half #(.W(W), .MINUS(1)) u_h3_m (.clk(clk), .c(c3), .q(h3_m));
  // (17) q3_scalar = sqrt h3_p
  ik_root #(.NW(W+1), .SH(SH_ROOT), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_q3_scalar (
      .clk(clk), .n({1'b0, h3_p}), .q(q3_scalar), .neg()
  );
  // (17) q3_abs = sqrt h3_m
  ik_root #(.NW(W+1), .SH(SH_ROOT), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_q3_abs (
      .clk(clk), .n({1'b0, h3_m}), .q(q3_abs), .neg()
  );
  wire negative_at_q3_abs;
  wire signed [W-1:0] q3_k;
  ik_delay #(.W(1), .N(T_Q3_ABS-T_SIGN)) u_negative_at_q3_abs (.clk(clk), .d(sign[WW-1]), .q(negative_at_q3_abs));
  // 0 counts as positive; either sign is correct there.
  ik_pick #(.W(W)) u_q3_k (
      .clk(clk), .a(q3_abs), .b(q3_abs), .use_b(1'b1), .minus(negative_at_q3_abs), .q(q3_k)
  );

  // ---- (18) Qs = Q12 Q3 ----

  wire signed [W-1:0] q12_i_at_q3_scalar, q12_j_at_q3_scalar, q12_k_at_q3_scalar;
  ik_ring #(.W(3*W), .N(T_Q3_SCALAR-T_Q12_I)) u_q12_at_q3_scalar (
      .clk(clk), .rst(rst), .d({q12_k, q12_j, q12_i}), .q({q12_k_at_q3_scalar, q12_j_at_q3_scalar, q12_i_at_q3_scalar})
  );
  wire signed [WW-1:0] w_kk, i_is, i_jk, j_js, j_ik, k_ks;
  localparam integer SH_S = F_Q12_I + F_Q3_SCALAR - F_I_IS;
  localparam integer SH_K = F_Q12_K + F_Q3_K - F_W_KK;
  // (18) w_kk = q12_k * q3_k
  ik_mul #(.AW(W), .BW(W), .SH(SH_K), .OW(WW), .DA(T_Q3_K-T_Q3_SCALAR)) u_w_kk (
      .clk(clk), .a(q12_k_at_q3_scalar), .b(q3_k), .q(w_kk)
  );
  // (18) i_is = q12_i * q3_scalar
  ik_mul #(.AW(W), .BW(W), .SH(SH_S), .OW(WW)) u_i_is (.clk(clk), .a(q12_i_at_q3_scalar), .b(q3_scalar), .q(i_is));
  // (18) i_jk = q12_j * q3_k
  ik_mul #(.AW(W), .BW(W), .SH(SH_K), .OW(WW), .DA(T_Q3_K-T_Q3_SCALAR)) u_i_jk (
      .clk(clk), .a(q12_j_at_q3_scalar), .b(q3_k), .q(i_jk)
  );
  // (18) j_js = q12_j * q3_scalar
  ik_mul #(.AW(W), .BW(W), .SH(SH_S), .OW(WW)) u_j_js (.clk(clk), .a(q12_j_at_q3_scalar), .b(q3_scalar), .q(j_js));
  // (18) j_ik = q12_i * q3_k
  ik_mul #(.AW(W), .BW(W), .SH(SH_K), .OW(WW), .DA(T_Q3_K-T_Q3_SCALAR)) u_j_ik (
      .clk(clk), .a(q12_i_at_q3_scalar), .b(q3_k), .q(j_ik)
  );
  // (18) k_ks = q12_k * q3_scalar
  ik_mul #(.AW(W), .BW(W), .SH(SH_S), .OW(WW)) u_k_ks (.clk(clk), .a(q12_k_at_q3_scalar), .b(q3_scalar), .q(k_ks));

  // q3_scalar is ready one clock before q3_k.
  // (18) qs_w = -w_kk
  ik_sum2 #(.IW(WW), .SH(F_W_KK-F_QS_W), .OW(W), .SUB_B(1), .SAT(0)) u_qs_w (
      .clk(clk), .a({WW{1'b0}}), .b(w_kk), .q(qs_w), .ovf()
  );
  // (18) qs_i = i_is + i_jk
  ik_sum2 #(.IW(WW), .SH(F_I_JK-F_QS_I), .OW(W), .SAT(0), .DA(T_I_JK-T_I_IS)) u_qs_i (
      .clk(clk), .a(i_is), .b(i_jk), .q(qs_i), .ovf()
  );
  // (18) qs_j = j_js - j_ik
  ik_sum2 #(.IW(WW), .SH(F_J_IK-F_QS_J), .OW(W), .SUB_B(1), .SAT(0), .DA(T_I_JK-T_I_IS)) u_qs_j (
      .clk(clk), .a(j_js), .b(j_ik), .q(qs_j), .ovf()
  );
  // (18) qs_k = k_ks
  ik_sum2 #(.IW(WW), .SH(F_K_KS-F_QS_K), .OW(W), .SAT(0)) u_qs_k (
      .clk(clk), .a({WW{1'b0}}), .b(k_ks), .q(qs_k), .ovf()
  );

  wire unused = &{1'b0, pi_sq[W-1]};

endmodule

`default_nettype wire

// The elbow: section 3.2, the point pair (12) in the form (19), and the elbow point (13).
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_paper_nodes.vh; rounding: products and sums half up, root and quotients floor.
// The point pair is homogeneous: it is scaled by 2 as in (19) and by the ratio of the two units of length; the elbow
// point is in the unit of d1 and d2.
//
// Names: pp_i, pp_j, pp_k are PP_i, PP_j, PP_k; pp_1_m is PP_1^- = PP_15 - PP_14, pp_1_p is PP_1^+ = PP_15 + PP_14;
// 2 and 3 likewise. Each port is valid at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_elbow #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer DIGIT = 0    // dividers and roots: 1 digit recurrence, 0 behavioural
) (
    // Clock
    input  wire                clk,
    input  wire                rst,                 // synchronous, for ik_ring
    // From guard
    input  wire signed [W-1:0] d_1,                 // T_D_1
    input  wire signed [W-1:0] d_2,
    input  wire        [  5:0] scale_j,             // T_SCALE_J
    input  wire signed [W-1:0] d_dif_j,             // T_D_DIF_J
    input  wire                clamp,               // T_CLAMP
    input  wire                away,                // T_AWAY
    // From swivel
    input  wire signed [W-1:0] s,                   // T_S
    input  wire signed [W-1:0] l_sw,                // T_L_SW
    input  wire signed [W-1:0] pi_swivel_x,         // T_PI_SWIVEL_X
    input  wire signed [W-1:0] pi_swivel_y,
    input  wire signed [W-1:0] pi_swivel_z,
    // Target
    input  wire signed [W-1:0] p_w_x_at_pi_swivel,  // the target, delayed to T_PI_SWIVEL_X
    input  wire signed [W-1:0] p_w_y_at_pi_swivel,
    input  wire signed [W-1:0] p_w_z_at_pi_swivel,
    // For the sign of (17)
    output wire signed [W-1:0] pp_1_m,              // T_PP_1_M
    output wire signed [W-1:0] pp_2_m,
    output wire signed [W-1:0] pp_3_m,
    output reg                 flat,                // T_FLAT: shoulder, elbow and target are collinear
    output reg                 back,                // T_BACK: seen from the target, the elbow is behind the shoulder
    // Results
    output wire signed [W-1:0] p_e_x,               // T_P_E_X
    output wire signed [W-1:0] p_e_y,
    output wire signed [W-1:0] p_e_z,
    output reg  signed [W-1:0] d_e                  // T_D_E: length of the upper arm in the unit of p_e
);

  `include "ik_paper_nodes.vh"

  localparam integer WW = W + GUARD;  // width of an unrounded product

  // ---- (12) the factor p_w^2 + d1^2 - d2^2 = p_w^2 + (d1 + d2)(d1 - d2), times 2^scale_j ----

  reg signed [W-1:0] d_sum;
  always @(posedge clk) d_sum <= d_1 + d_2;  // below 1

  wire signed [W-1:0] s_j;
  ik_shift #(.W(W), .RIGHT(1), .DC(T_S-T_SCALE_J)) u_s_j (.clk(clk), .d(s), .count(scale_j), .q(s_j));

  wire signed [W-1:0] dd_j, k_e;
  // (12) dd_j = d_sum * d_dif_j
  ik_mul #(.AW(W), .BW(W), .SH(F_D_SUM+F_D_DIF_J-F_DD_J), .OW(W), .DB(T_D_SUM-T_D_DIF_J)) u_dd_j (
      .clk(clk), .a(d_sum), .b(d_dif_j), .q(dd_j)
  );
  // (12) k_e = s_j + dd_j
  ik_sum2 #(.IW(W), .SH(F_S_J-F_K_E), .OW(W), .DA(T_DD_J-T_S_J)) u_k_e (
      .clk(clk), .a(s_j), .b(dd_j), .q(k_e), .ovf()
  );

  // ---- (12) PP_i, PP_j, PP_k ----

  wire signed [W-1:0] k_e_at_pi_swivel, pp_i, pp_j, pp_k;
  ik_ring #(.W(W), .N(T_PI_SWIVEL_X-T_K_E)) u_k_e_at_pi_swivel (.clk(clk), .rst(rst), .d(k_e), .q(k_e_at_pi_swivel));
  // (12) pp_i = pi_swivel_x * k_e
  ik_mul #(.AW(W), .BW(W), .SH(F_PI_SWIVEL_X+F_K_E-F_PP_I), .OW(W)) u_pp_i (
      .clk(clk), .a(pi_swivel_x), .b(k_e_at_pi_swivel), .q(pp_i)
  );
  // (12) pp_j = pi_swivel_y * k_e
  ik_mul #(.AW(W), .BW(W), .SH(F_PI_SWIVEL_Y+F_K_E-F_PP_J), .OW(W)) u_pp_j (
      .clk(clk), .a(pi_swivel_y), .b(k_e_at_pi_swivel), .q(pp_j)
  );
  // (12) pp_k = pi_swivel_z * k_e
  ik_mul #(.AW(W), .BW(W), .SH(F_PI_SWIVEL_Z+F_K_E-F_PP_K), .OW(W)) u_pp_k (
      .clk(clk), .a(pi_swivel_z), .b(k_e_at_pi_swivel), .q(pp_k)
  );

  // ---- (19) PP_m^- = 2 (p_w x pi_swivel); the formats contain the factor 2 ----

  wire signed [WW-1:0] c_1_zy, c_1_yz, c_2_xz, c_2_zx, c_3_yx, c_3_xy;
  localparam integer SH_C = F_P_W_X + F_PI_SWIVEL_X - 1 - F_C_1_ZY;
  // (19) c_1_zy = 2 * p_w_z * pi_swivel_y
  ik_mul #(.AW(W), .BW(W), .SH(SH_C), .OW(WW)) u_c_1_zy (
      .clk(clk), .a(p_w_z_at_pi_swivel), .b(pi_swivel_y), .q(c_1_zy)
  );
  // (19) c_1_yz = 2 * p_w_y * pi_swivel_z
  ik_mul #(.AW(W), .BW(W), .SH(SH_C), .OW(WW)) u_c_1_yz (
      .clk(clk), .a(p_w_y_at_pi_swivel), .b(pi_swivel_z), .q(c_1_yz)
  );
  // (19) c_2_xz = 2 * p_w_x * pi_swivel_z
  ik_mul #(.AW(W), .BW(W), .SH(SH_C), .OW(WW)) u_c_2_xz (
      .clk(clk), .a(p_w_x_at_pi_swivel), .b(pi_swivel_z), .q(c_2_xz)
  );
  // (19) c_2_zx = 2 * p_w_z * pi_swivel_x
  ik_mul #(.AW(W), .BW(W), .SH(SH_C), .OW(WW)) u_c_2_zx (
      .clk(clk), .a(p_w_z_at_pi_swivel), .b(pi_swivel_x), .q(c_2_zx)
  );
  // (19) c_3_yx = 2 * p_w_y * pi_swivel_x
  ik_mul #(.AW(W), .BW(W), .SH(SH_C), .OW(WW)) u_c_3_yx (
      .clk(clk), .a(p_w_y_at_pi_swivel), .b(pi_swivel_x), .q(c_3_yx)
  );
  // (19) c_3_xy = 2 * p_w_x * pi_swivel_y
  ik_mul #(.AW(W), .BW(W), .SH(SH_C), .OW(WW)) u_c_3_xy (
      .clk(clk), .a(p_w_x_at_pi_swivel), .b(pi_swivel_y), .q(c_3_xy)
  );
  // (19) pp_1_m = c_1_zy - c_1_yz
  ik_sum2 #(.IW(WW), .SH(F_C_1_ZY-F_PP_1_M), .OW(W), .SUB_B(1), .SAT(0)) u_pp_1_m (
      .clk(clk), .a(c_1_zy), .b(c_1_yz), .q(pp_1_m), .ovf()
  );
  // (19) pp_2_m = c_2_xz - c_2_zx
  ik_sum2 #(.IW(WW), .SH(F_C_2_XZ-F_PP_2_M), .OW(W), .SUB_B(1), .SAT(0)) u_pp_2_m (
      .clk(clk), .a(c_2_xz), .b(c_2_zx), .q(pp_2_m), .ovf()
  );
  // (19) pp_3_m = c_3_yx - c_3_xy
  ik_sum2 #(.IW(WW), .SH(F_C_3_YX-F_PP_3_M), .OW(W), .SUB_B(1), .SAT(0)) u_pp_3_m (
      .clk(clk), .a(c_3_yx), .b(c_3_xy), .q(pp_3_m), .ovf()
  );

  // ---- (19) PP_m^+ = d1^2 PP_m^- ----

  wire signed [W-1:0] d_1_sq, d_1_sq_at_pp_1_m, pp_1_p, pp_2_p, pp_3_p;
  localparam integer SH_P = F_D_1_SQ + F_PP_1_M - F_PP_1_P;
  // (12) d_1_sq = d_1^2
  ik_mul #(.AW(W), .BW(W), .SH(2*F_D_1-F_D_1_SQ), .OW(W), .SQUARE(1)) u_d_1_sq (
      .clk(clk), .a(d_1), .b(d_1), .q(d_1_sq)
  );
  ik_ring #(.W(W), .N(T_PP_1_M-T_D_1_SQ)) u_d_1_sq_at_pp_1_m (.clk(clk), .rst(rst), .d(d_1_sq), .q(d_1_sq_at_pp_1_m));
  // (19) pp_1_p = d_1_sq * pp_1_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_P), .OW(W)) u_pp_1_p (.clk(clk), .a(d_1_sq_at_pp_1_m), .b(pp_1_m), .q(pp_1_p));
  // (19) pp_2_p = d_1_sq * pp_2_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_P), .OW(W)) u_pp_2_p (.clk(clk), .a(d_1_sq_at_pp_1_m), .b(pp_2_m), .q(pp_2_p));
  // (19) pp_3_p = d_1_sq * pp_3_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_P), .OW(W)) u_pp_3_p (.clk(clk), .a(d_1_sq_at_pp_1_m), .b(pp_3_m), .q(pp_3_p));

  // ---- (19) PP_m^+ PP_m^-, the last part of tmp1 ----

  wire signed [WW-1:0] pp_1_pm, pp_2_pm, pp_3_pm;
  localparam integer SH_PM = F_PP_1_P + F_PP_1_M - F_PP_1_PM;
  // (19) pp_1_pm = pp_1_p * pp_1_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_PM), .OW(WW), .DB(T_PP_1_P-T_PP_1_M)) u_pp_1_pm (
      .clk(clk), .a(pp_1_p), .b(pp_1_m), .q(pp_1_pm)
  );
  // (19) pp_2_pm = pp_2_p * pp_2_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_PM), .OW(WW), .DB(T_PP_2_P-T_PP_2_M)) u_pp_2_pm (
      .clk(clk), .a(pp_2_p), .b(pp_2_m), .q(pp_2_pm)
  );
  // (19) pp_3_pm = pp_3_p * pp_3_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_PM), .OW(WW), .DB(T_PP_3_P-T_PP_3_M)) u_pp_3_pm (
      .clk(clk), .a(pp_3_p), .b(pp_3_m), .q(pp_3_pm)
  );

  // ---- (13) inf_PP ----

  wire signed [WW-1:0] pp_1_sq, pp_2_sq, pp_3_sq;
  wire signed [W-1:0] inf_pp;
  localparam integer SH_MM = 2 * F_PP_1_M - F_PP_1_SQ;
  // (13) pp_1_sq = pp_1_m^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_MM), .OW(WW), .SQUARE(1)) u_pp_1_sq (.clk(clk), .a(pp_1_m), .b(pp_1_m), .q(pp_1_sq));
  // (13) pp_2_sq = pp_2_m^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_MM), .OW(WW), .SQUARE(1)) u_pp_2_sq (.clk(clk), .a(pp_2_m), .b(pp_2_m), .q(pp_2_sq));
  // (13) pp_3_sq = pp_3_m^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_MM), .OW(WW), .SQUARE(1)) u_pp_3_sq (.clk(clk), .a(pp_3_m), .b(pp_3_m), .q(pp_3_sq));
  // (13) inf_pp = pp_1_sq + pp_2_sq + pp_3_sq
  ik_sum3 #(.IW(WW), .SH(F_PP_1_SQ-F_INF_PP), .OW(W)) u_inf_pp (
      .clk(clk), .a(pp_1_sq), .b(pp_2_sq), .c(pp_3_sq), .q(inf_pp), .ovf()
  );

  // ---- (13) tmp1 and its root ----

  wire signed [WW-1:0] pp_i_sq, pp_j_sq, pp_k_sq, pp_sq, pp_pm;
  wire signed [W-1:0] tmp1, tmp_sqr;
  localparam integer SH_II = 2 * F_PP_I - F_PP_I_SQ;
  // (13) pp_i_sq = pp_i^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_II), .OW(WW), .SQUARE(1)) u_pp_i_sq (.clk(clk), .a(pp_i), .b(pp_i), .q(pp_i_sq));
  // (13) pp_j_sq = pp_j^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_II), .OW(WW), .SQUARE(1)) u_pp_j_sq (.clk(clk), .a(pp_j), .b(pp_j), .q(pp_j_sq));
  // (13) pp_k_sq = pp_k^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_II), .OW(WW), .SQUARE(1)) u_pp_k_sq (.clk(clk), .a(pp_k), .b(pp_k), .q(pp_k_sq));
  // (13) pp_sq = pp_i_sq + pp_j_sq + pp_k_sq
  ik_sum3 #(.IW(WW), .SH(F_PP_I_SQ-F_PP_SQ), .OW(WW)) u_pp_sq (
      .clk(clk), .a(pp_i_sq), .b(pp_j_sq), .c(pp_k_sq), .q(pp_sq), .ovf()
  );
  // (13) pp_pm = pp_1_pm + pp_2_pm + pp_3_pm
  ik_sum3 #(.IW(WW), .SH(F_PP_1_PM-F_PP_PM), .OW(WW)) u_pp_pm (
      .clk(clk), .a(pp_1_pm), .b(pp_2_pm), .c(pp_3_pm), .q(pp_pm), .ovf()
  );
  // (13) tmp1 = pp_pm - pp_sq
  ik_sum2 #(.IW(WW), .SH(F_PP_PM-F_TMP1), .OW(W), .SUB_B(1), .DB(T_PP_PM-T_PP_SQ)) u_tmp1 (
      .clk(clk), .a(pp_pm), .b(pp_sq), .q(tmp1), .ovf()
  );
  // (13) tmp_sqr = sqrt tmp1
  ik_root #(.NW(W), .SH(2*F_TMP_SQR-F_TMP1), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_tmp_sqr (
      .clk(clk), .n(tmp1), .q(tmp_sqr), .neg()
  );

  // ---- side of the shoulder on which a straight or closed arm lies, for (17) ----

  wire clamp_at_tmp1, clamp_at_k_e, away_at_k_e;
  ik_delay #(.W(2), .N(T_K_E-T_CLAMP)) u_clamp_at_k_e (.clk(clk), .d({away, clamp}), .q({away_at_k_e, clamp_at_k_e}));
  ik_delay #(.W(1), .N(T_TMP1-T_K_E)) u_clamp_at_tmp1 (.clk(clk), .d(clamp_at_k_e), .q(clamp_at_tmp1));
  always @(posedge clk) begin
    flat <= clamp_at_tmp1 || (tmp1 <= 0);
    back <= clamp_at_k_e ? away_at_k_e : k_e[W-1];
  end

  // ---- (13) numerators of p_e ----

  wire signed [WW-1:0] e_x_k, e_x_j, e_y_i, e_y_k, e_z_j, e_z_i;
  localparam integer SH_E = F_PP_K + F_PP_2_M - F_E_X_K;
  // (13) e_x_k = pp_k * pp_2_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_E), .OW(WW), .DA(T_PP_1_M-T_PP_I)) u_e_x_k (
      .clk(clk), .a(pp_k), .b(pp_2_m), .q(e_x_k)
  );
  // (13) e_x_j = pp_j * pp_3_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_E), .OW(WW), .DA(T_PP_1_M-T_PP_I)) u_e_x_j (
      .clk(clk), .a(pp_j), .b(pp_3_m), .q(e_x_j)
  );
  // (13) e_y_i = pp_i * pp_3_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_E), .OW(WW), .DA(T_PP_1_M-T_PP_I)) u_e_y_i (
      .clk(clk), .a(pp_i), .b(pp_3_m), .q(e_y_i)
  );
  // (13) e_y_k = pp_k * pp_1_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_E), .OW(WW), .DA(T_PP_1_M-T_PP_I)) u_e_y_k (
      .clk(clk), .a(pp_k), .b(pp_1_m), .q(e_y_k)
  );
  // (13) e_z_j = pp_j * pp_1_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_E), .OW(WW), .DA(T_PP_1_M-T_PP_I)) u_e_z_j (
      .clk(clk), .a(pp_j), .b(pp_1_m), .q(e_z_j)
  );
  // (13) e_z_i = pp_i * pp_2_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_E), .OW(WW), .DA(T_PP_1_M-T_PP_I)) u_e_z_i (
      .clk(clk), .a(pp_i), .b(pp_2_m), .q(e_z_i)
  );

  wire signed [WW-1:0] e_x_pp;  // PP_k PP_2^- - PP_j PP_3^-
  wire signed [WW-1:0] e_y_pp;  // PP_i PP_3^- - PP_k PP_1^-
  wire signed [WW-1:0] e_z_pp;  // PP_j PP_1^- - PP_i PP_2^-
  // (13) e_x_pp = e_x_k - e_x_j
  ik_sum2 #(.IW(WW), .SH(F_E_X_K-F_E_X_PP), .OW(WW), .SUB_B(1), .SAT(0)) u_e_x_pp (
      .clk(clk), .a(e_x_k), .b(e_x_j), .q(e_x_pp), .ovf()
  );
  // (13) e_y_pp = e_y_i - e_y_k
  ik_sum2 #(.IW(WW), .SH(F_E_Y_I-F_E_Y_PP), .OW(WW), .SUB_B(1), .SAT(0)) u_e_y_pp (
      .clk(clk), .a(e_y_i), .b(e_y_k), .q(e_y_pp), .ovf()
  );
  // (13) e_z_pp = e_z_j - e_z_i
  ik_sum2 #(.IW(WW), .SH(F_E_Z_J-F_E_Z_PP), .OW(WW), .SUB_B(1), .SAT(0)) u_e_z_pp (
      .clk(clk), .a(e_z_j), .b(e_z_i), .q(e_z_pp), .ovf()
  );

  wire signed [W-1:0] pp_1_m_at_tmp_sqr, pp_2_m_at_tmp_sqr, pp_3_m_at_tmp_sqr;
  ik_ring #(.W(3*W), .N(T_TMP_SQR-T_PP_1_M)) u_pp_at_tmp_sqr (
      .clk(clk), .rst(rst), .d({pp_3_m, pp_2_m, pp_1_m}), .q({pp_3_m_at_tmp_sqr, pp_2_m_at_tmp_sqr, pp_1_m_at_tmp_sqr})
  );
  wire signed [WW-1:0] e_x_sqr, e_y_sqr, e_z_sqr;
  localparam integer SH_SQR = F_TMP_SQR + F_PP_1_M - F_E_X_SQR;
  // (13) e_x_sqr = tmp_sqr * pp_1_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_SQR), .OW(WW)) u_e_x_sqr (.clk(clk), .a(tmp_sqr), .b(pp_1_m_at_tmp_sqr), .q(e_x_sqr));
  // (13) e_y_sqr = tmp_sqr * pp_2_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_SQR), .OW(WW)) u_e_y_sqr (.clk(clk), .a(tmp_sqr), .b(pp_2_m_at_tmp_sqr), .q(e_y_sqr));
  // (13) e_z_sqr = tmp_sqr * pp_3_m
  ik_mul #(.AW(W), .BW(W), .SH(SH_SQR), .OW(WW)) u_e_z_sqr (.clk(clk), .a(tmp_sqr), .b(pp_3_m_at_tmp_sqr), .q(e_z_sqr));

  wire signed [WW-1:0] e_x_pp_at_e_x_sqr, e_y_pp_at_e_x_sqr, e_z_pp_at_e_x_sqr;
  ik_ring #(.W(3*WW), .N(T_E_X_SQR-T_E_X_PP)) u_e_at_e_x_sqr (
      .clk(clk), .rst(rst), .d({e_z_pp, e_y_pp, e_x_pp}), .q({e_z_pp_at_e_x_sqr, e_y_pp_at_e_x_sqr, e_x_pp_at_e_x_sqr})
  );
  wire signed [WW-1:0] e_x_num, e_y_num, e_z_num;
  // (13) e_x_num = e_x_pp + e_x_sqr
  ik_sum2 #(.IW(WW), .SH(F_E_X_SQR-F_E_X_NUM), .OW(WW)) u_e_x_num (
      .clk(clk), .a(e_x_pp_at_e_x_sqr), .b(e_x_sqr), .q(e_x_num), .ovf()
  );
  // (13) e_y_num = e_y_pp + e_y_sqr
  ik_sum2 #(.IW(WW), .SH(F_E_Y_SQR-F_E_Y_NUM), .OW(WW)) u_e_y_num (
      .clk(clk), .a(e_y_pp_at_e_x_sqr), .b(e_y_sqr), .q(e_y_num), .ovf()
  );
  // (13) e_z_num = e_z_pp + e_z_sqr
  ik_sum2 #(.IW(WW), .SH(F_E_Z_SQR-F_E_Z_NUM), .OW(WW)) u_e_z_num (
      .clk(clk), .a(e_z_pp_at_e_x_sqr), .b(e_z_sqr), .q(e_z_num), .ovf()
  );

  // ---- (13) p_e: division by inf_PP ----

  wire signed [W-1:0] inf_pp_at_e_x_num, e_x_quo, e_y_quo, e_z_quo;
  localparam integer SH_QUO = F_E_X_QUO - F_E_X_NUM + F_INF_PP;
  ik_ring #(.W(W), .N(T_E_X_NUM-T_INF_PP)) u_inf_pp_at_e_x_num (
      .clk(clk), .rst(rst), .d(inf_pp), .q(inf_pp_at_e_x_num)
  );
  // (13) e_x_quo = e_x_num / inf_pp
  ik_div #(.NW(WW), .DW(W), .SH(SH_QUO), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_e_x_quo (
      .clk(clk), .n(e_x_num), .d(inf_pp_at_e_x_num), .q(e_x_quo), .ovf()
  );
  // (13) e_y_quo = e_y_num / inf_pp
  ik_div #(.NW(WW), .DW(W), .SH(SH_QUO), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_e_y_quo (
      .clk(clk), .n(e_y_num), .d(inf_pp_at_e_x_num), .q(e_y_quo), .ovf()
  );
  // (13) e_z_quo = e_z_num / inf_pp
  ik_div #(.NW(WW), .DW(W), .SH(SH_QUO), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_e_z_quo (
      .clk(clk), .n(e_z_num), .d(inf_pp_at_e_x_num), .q(e_z_quo), .ovf()
  );

  // A clamped arm's elbow lies on the line to the target, at half its distance, in the target's unit.
  wire clamp_at_e_x_quo, away_at_e_x_quo;
  wire signed [W-1:0] p_w_x_at_e_x_quo, p_w_y_at_e_x_quo, p_w_z_at_e_x_quo;
  ik_ring #(.W(2), .N(T_E_X_QUO-T_K_E)) u_clamp_at_e_x_quo (
      .clk(clk), .rst(rst), .d({away_at_k_e, clamp_at_k_e}), .q({away_at_e_x_quo, clamp_at_e_x_quo})
  );
  ik_ring #(.W(3*W), .N(T_E_X_QUO-T_PI_SWIVEL_X)) u_p_w_at_e_x_quo (
      .clk(clk), .rst(rst), .d({p_w_z_at_pi_swivel, p_w_y_at_pi_swivel, p_w_x_at_pi_swivel}),
      .q({p_w_z_at_e_x_quo, p_w_y_at_e_x_quo, p_w_x_at_e_x_quo})
  );
  wire signed [W-1:0] half_x = p_w_x_at_e_x_quo >>> 2;  // the formats differ by one bit
  wire signed [W-1:0] half_y = p_w_y_at_e_x_quo >>> 2;
  wire signed [W-1:0] half_z = p_w_z_at_e_x_quo >>> 2;
  ik_pick #(.W(W)) u_p_e_x (
      .clk(clk), .a(e_x_quo), .b(half_x), .use_b(clamp_at_e_x_quo), .minus(away_at_e_x_quo), .q(p_e_x)
  );
  ik_pick #(.W(W)) u_p_e_y (
      .clk(clk), .a(e_y_quo), .b(half_y), .use_b(clamp_at_e_x_quo), .minus(away_at_e_x_quo), .q(p_e_y)
  );
  ik_pick #(.W(W)) u_p_e_z (
      .clk(clk), .a(e_z_quo), .b(half_z), .use_b(clamp_at_e_x_quo), .minus(away_at_e_x_quo), .q(p_e_z)
  );

  wire clamp_at_l_sw;
  wire signed [W-1:0] d_1_at_l_sw;
  ik_delay #(.W(1), .N(T_L_SW-T_K_E)) u_clamp_at_l_sw (.clk(clk), .d(clamp_at_k_e), .q(clamp_at_l_sw));
  ik_ring #(.W(W), .N(T_L_SW-T_D_1)) u_d_1_at_l_sw (.clk(clk), .rst(rst), .d(d_1), .q(d_1_at_l_sw));
  always @(posedge clk) d_e <= clamp_at_l_sw ? (l_sw >>> 1) : (d_1_at_l_sw >>> 1);

endmodule

`default_nettype wire

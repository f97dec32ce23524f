// Distance of the target and the swivel plane: section 3.1, equations (10) and (11).
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_paper_nodes.vh; rounding: products and sums half up, root and quotients floor.
// Sine and cosine of phi/2 come from a CORDIC in parallel with the first root. Every term of (11) has the target's
// horizontal direction as a factor; here it has its own unit (b), which changes the length of the plane's normal but
// not the plane. Each port is valid at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_swivel #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer DIGIT = 0    // dividers and roots: 1 digit recurrence, 0 behavioural
) (
    // Clock
    input  wire                clk,
    input  wire                rst,          // synchronous, for ik_ring
    // Target
    input  wire signed [W-1:0] phi,          // binary angle, at clock 0
    // From guard
    input  wire signed [W-1:0] p_w_x,        // T_P_W_X
    input  wire signed [W-1:0] p_w_y,
    input  wire signed [W-1:0] p_w_z,
    input  wire signed [W-1:0] b_x,          // T_B_X
    input  wire signed [W-1:0] b_y,
    // Results
    output wire signed [W-1:0] s,            // |p_w|^2, T_S
    output wire signed [W-1:0] l_sw,         // T_L_SW
    output wire signed [W-1:0] pi_swivel_x,  // T_PI_SWIVEL_X
    output wire signed [W-1:0] pi_swivel_y,
    output wire signed [W-1:0] pi_swivel_z
);

  `include "ik_paper_nodes.vh"

  localparam integer WW = W + GUARD;  // width of an unrounded product

  // ---- (10) |L_sw| = sqrt(p_x^2 + p_y^2 + p_z^2) ----

  wire signed [WW-1:0] s_x, s_y, s_z;
  // (10) s_x = p_w_x^2
  ik_mul #(.AW(W), .BW(W), .SH(2*F_P_W_X-F_S_X), .OW(WW), .SQUARE(1)) u_s_x (.clk(clk), .a(p_w_x), .b(p_w_x), .q(s_x));
  // (10) s_y = p_w_y^2
  ik_mul #(.AW(W), .BW(W), .SH(2*F_P_W_Y-F_S_Y), .OW(WW), .SQUARE(1)) u_s_y (.clk(clk), .a(p_w_y), .b(p_w_y), .q(s_y));
  // (10) s_z = p_w_z^2
  ik_mul #(.AW(W), .BW(W), .SH(2*F_P_W_Z-F_S_Z), .OW(WW), .SQUARE(1)) u_s_z (.clk(clk), .a(p_w_z), .b(p_w_z), .q(s_z));
  // (10) s = s_x + s_y + s_z
  ik_sum3 #(.IW(WW), .SH(F_S_X-F_S), .OW(W), .SAT(0)) u_s (.clk(clk), .a(s_x), .b(s_y), .c(s_z), .q(s), .ovf());
  // (10) l_sw = sqrt s
  ik_root #(.NW(W), .SH(2*F_L_SW-F_S), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_l_sw (
      .clk(clk), .n({1'b0, s[W-2:0]}), .q(l_sw), .neg()  // a sum of squares has no sign
  );

  // ---- (11) sin phi = 2 cos(phi/2) sin(phi/2), cos phi = 2 cos^2(phi/2) - 1; the paper omits the square ----

  wire signed [W-1:0] sin_h, cos_h;
  // (11) sin_h = sin(phi / 2)
  // (11) cos_h = cos(phi / 2)
  ik_sincos #(.W(W)) u_sincos (.clk(clk), .phi(phi), .sin_h(sin_h), .cos_h(cos_h));

  wire signed [W-1:0] sin_phi;
  wire signed [WW-1:0] cos2_sq;
  wire signed [W-1:0] cos_phi;
  localparam signed [WW-1:0] ONE = {{(WW - 1) {1'b0}}, 1'b1} << F_COS2_SQ;
  // (11) sin_phi = 2 * sin_h * cos_h
  ik_mul #(.AW(W), .BW(W), .SH(F_SIN_H+F_COS_H-1-F_SIN_PHI), .OW(W)) u_sin_phi (
      .clk(clk), .a(sin_h), .b(cos_h), .q(sin_phi)
  );
  // (11) cos2_sq = 2 * cos_h^2
  ik_mul #(.AW(W), .BW(W), .SH(2*F_COS_H-1-F_COS2_SQ), .OW(WW), .SQUARE(1)) u_cos2_sq (
      .clk(clk), .a(cos_h), .b(cos_h), .q(cos2_sq)
  );
  // (11) cos_phi = cos2_sq - 1
  ik_sum2 #(.IW(WW), .SH(F_COS2_SQ-F_COS_PHI), .OW(W), .SUB_B(1), .SAT(0)) u_cos_phi (
      .clk(clk), .a(cos2_sq), .b(ONE), .q(cos_phi), .ovf()
  );

  // ---- (11) products of the target with itself: ready before sin and cos ----

  wire signed [W-1:0] a_x;  // p_z b_x
  wire signed [W-1:0] a_y;  // p_z b_y
  wire signed [WW-1:0] rho_x, rho_y;
  wire signed [W-1:0] rho;  // p_x b_x + p_y b_y, the p_x^2 + p_y^2 of the third row
  // (11) a_x = p_w_z * b_x
  ik_mul #(.AW(W), .BW(W), .SH(F_P_W_Z+F_B_X-F_A_X), .OW(W)) u_a_x (.clk(clk), .a(p_w_z), .b(b_x), .q(a_x));
  // (11) a_y = p_w_z * b_y
  ik_mul #(.AW(W), .BW(W), .SH(F_P_W_Z+F_B_Y-F_A_Y), .OW(W)) u_a_y (.clk(clk), .a(p_w_z), .b(b_y), .q(a_y));
  // (11) rho_x = p_w_x * b_x
  ik_mul #(.AW(W), .BW(W), .SH(F_P_W_X+F_B_X-F_RHO_X), .OW(WW)) u_rho_x (.clk(clk), .a(p_w_x), .b(b_x), .q(rho_x));
  // (11) rho_y = p_w_y * b_y
  ik_mul #(.AW(W), .BW(W), .SH(F_P_W_Y+F_B_Y-F_RHO_Y), .OW(WW)) u_rho_y (.clk(clk), .a(p_w_y), .b(b_y), .q(rho_y));
  // (11) rho = rho_x + rho_y
  ik_sum2 #(.IW(WW), .SH(F_RHO_X-F_RHO), .OW(W), .SAT(0)) u_rho (.clk(clk), .a(rho_x), .b(rho_y), .q(rho), .ovf());

  wire signed [W-1:0] a_x_at_sin_phi, a_y_at_sin_phi, rho_at_sin_phi;
  ik_ring #(.W(2*W), .N(T_SIN_PHI-T_A_X)) u_a_at_sin_phi (
      .clk(clk), .rst(rst), .d({a_y, a_x}), .q({a_y_at_sin_phi, a_x_at_sin_phi})
  );
  ik_ring #(.W(W), .N(T_SIN_PHI-T_RHO)) u_rho_at_sin_phi (.clk(clk), .rst(rst), .d(rho), .q(rho_at_sin_phi));

  wire signed [WW-1:0] sa_x;  // sin phi p_z b_x
  wire signed [WW-1:0] sa_y;
  wire signed [WW-1:0] sa_z;  // sin phi (p_x^2 + p_y^2)
  // (11) sa_x = sin_phi * a_x
  ik_mul #(.AW(W), .BW(W), .SH(F_SIN_PHI+F_A_X-F_SA_X), .OW(WW)) u_sa_x (
      .clk(clk), .a(sin_phi), .b(a_x_at_sin_phi), .q(sa_x)
  );
  // (11) sa_y = sin_phi * a_y
  ik_mul #(.AW(W), .BW(W), .SH(F_SIN_PHI+F_A_Y-F_SA_Y), .OW(WW)) u_sa_y (
      .clk(clk), .a(sin_phi), .b(a_y_at_sin_phi), .q(sa_y)
  );
  // (11) sa_z = sin_phi * rho
  ik_mul #(.AW(W), .BW(W), .SH(F_SIN_PHI+F_RHO-F_SA_Z), .OW(WW)) u_sa_z (
      .clk(clk), .a(sin_phi), .b(rho_at_sin_phi), .q(sa_z)
  );

  wire signed [W-1:0] b_x_at_cos_phi, b_y_at_cos_phi;
  ik_ring #(.W(2*W), .N(T_COS_PHI-T_B_X)) u_b_at_cos_phi (
      .clk(clk), .rst(rst), .d({b_y, b_x}), .q({b_y_at_cos_phi, b_x_at_cos_phi})
  );

  wire signed [W-1:0] cb_x;  // cos phi b_x
  wire signed [W-1:0] cb_y;
  // (11) cb_x = cos_phi * b_x
  ik_mul #(.AW(W), .BW(W), .SH(F_COS_PHI+F_B_X-F_CB_X), .OW(W)) u_cb_x (
      .clk(clk), .a(cos_phi), .b(b_x_at_cos_phi), .q(cb_x)
  );
  // (11) cb_y = cos_phi * b_y
  ik_mul #(.AW(W), .BW(W), .SH(F_COS_PHI+F_B_Y-F_CB_Y), .OW(W)) u_cb_y (
      .clk(clk), .a(cos_phi), .b(b_y_at_cos_phi), .q(cb_y)
  );

  wire signed [WW-1:0] lcb_x;  // |L_sw| cos phi b_x
  wire signed [WW-1:0] lcb_y;
  // (11) lcb_x = l_sw * cb_x
  ik_mul #(.AW(W), .BW(W), .SH(F_L_SW+F_CB_X-F_LCB_X), .OW(WW), .DA(T_CB_X-T_L_SW)) u_lcb_x (
      .clk(clk), .a(l_sw), .b(cb_x), .q(lcb_x)
  );
  // (11) lcb_y = l_sw * cb_y
  ik_mul #(.AW(W), .BW(W), .SH(F_L_SW+F_CB_Y-F_LCB_Y), .OW(WW), .DA(T_CB_X-T_L_SW)) u_lcb_y (
      .clk(clk), .a(l_sw), .b(cb_y), .q(lcb_y)
  );

  // ---- (11) numerators ----

  wire signed [WW-1:0] pi_num_x, pi_num_y, pi_num_z;
  // (11) pi_num_x = sa_x + lcb_y
  ik_sum2 #(.IW(WW), .SH(F_SA_X-F_PI_NUM_X), .OW(WW), .SAT(0), .DA(T_LCB_X-T_SA_X)) u_pi_num_x (
      .clk(clk), .a(sa_x), .b(lcb_y), .q(pi_num_x), .ovf()
  );
  // (11) pi_num_y = sa_y - lcb_x
  ik_sum2 #(.IW(WW), .SH(F_SA_Y-F_PI_NUM_Y), .OW(WW), .SUB_B(1), .SAT(0), .DA(T_LCB_X-T_SA_X)) u_pi_num_y (
      .clk(clk), .a(sa_y), .b(lcb_x), .q(pi_num_y), .ovf()
  );
  // (11) pi_num_z = -sa_z
  ik_sum2 #(.IW(WW), .SH(F_SA_Z-F_PI_NUM_Z), .OW(WW), .SUB_B(1), .SAT(0), .DB(T_LCB_X-T_SA_X)) u_pi_num_z (
      .clk(clk), .a({WW{1'b0}}), .b(sa_z), .q(pi_num_z), .ovf()
  );

  // ---- (11) division by |L_sw| ----

  // (11) pi_swivel_x = pi_num_x / l_sw
  ik_div #(.NW(WW), .DW(W), .SH(F_PI_SWIVEL_X-F_PI_NUM_X+F_L_SW), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT),
      .DD(T_PI_NUM_X-T_L_SW)) u_pi_swivel_x (
      .clk(clk), .n(pi_num_x), .d(l_sw), .q(pi_swivel_x), .ovf()
  );
  // (11) pi_swivel_y = pi_num_y / l_sw
  ik_div #(.NW(WW), .DW(W), .SH(F_PI_SWIVEL_Y-F_PI_NUM_Y+F_L_SW), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT),
      .DD(T_PI_NUM_X-T_L_SW)) u_pi_swivel_y (
      .clk(clk), .n(pi_num_y), .d(l_sw), .q(pi_swivel_y), .ovf()
  );
  // (11) pi_swivel_z = pi_num_z / l_sw
  ik_div #(.NW(WW), .DW(W), .SH(F_PI_SWIVEL_Z-F_PI_NUM_Z+F_L_SW), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT),
      .DD(T_PI_NUM_X-T_L_SW)) u_pi_swivel_z (
      .clk(clk), .n(pi_num_z), .d(l_sw), .q(pi_swivel_z), .ovf()
  );

endmodule

`default_nettype wire

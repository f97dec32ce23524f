// The rotation to the elbow, Q12 (15): section 3.4.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_paper_nodes.vh; rounding: products and sums half up, root and quotients floor.
// Q12 is the half turn about the middle line L_m that takes the z axis to the elbow.
//
// L_m = d1 (p_ex (d1 - p_ez), p_ey (d1 - p_ez), p_ex^2 + p_ey^2) may have any length:
// - elbow below the shoulder: d1 is dropped, and one factor (p_ex, p_ey) is scaled up to (u_x, u_y). On the z axis,
//   where (15) is 0/0, u is (1/2, 0) and L_m is (d1, 0, 0);
// - elbow above: L_m is divided by d1 - p_ez, which suffers from cancellation; p_ex^2 + p_ey^2 = (d1 - p_ez)(d1 + p_ez)
//   leaves (p_ex, p_ey, d1 + p_ez). On the z axis, where (15) is 0/0, this is (0, 0, 2 d1).
// Each port is valid at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_to_elbow #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer DIGIT = 0    // dividers and roots: 1 digit recurrence, 0 behavioural
) (
    // Clock
    input  wire                clk,
    input  wire                rst,          // synchronous, for ik_ring
    // From elbow
    input  wire signed [W-1:0] d_e,          // length of the upper arm in the unit of p_e, T_D_E
    input  wire signed [W-1:0] p_e_x,        // T_P_E_X
    input  wire signed [W-1:0] p_e_y,
    input  wire signed [W-1:0] p_e_z,
    // Results
    output wire signed [W-1:0] q12_i,        // T_Q12_I
    output wire signed [W-1:0] q12_j,
    output wire signed [W-1:0] q12_k
);

  `include "ik_paper_nodes.vh"

  localparam integer WW = W + GUARD;  // width of an unrounded product

  // ---- (15) h = d1 - p_ez below, d1 + p_ez above the shoulder ----

  wire signed [W-1:0] d_e_at_p_e_z, h;
  ik_ring #(.W(W), .N(T_P_E_Z-T_D_E)) u_d_e_at_p_e_z (.clk(clk), .rst(rst), .d(d_e), .q(d_e_at_p_e_z));
  wire signed [W-1:0] abs_z;
  ik_pick #(.W(W)) u_abs_z (.clk(clk), .a(p_e_z), .b(p_e_z), .use_b(1'b1), .minus(p_e_z[W-1]), .q(abs_z));
  reg signed [W-1:0] d_e_q, h_q;
  wire [W:0] h_sum = {1'b0, d_e_q} + {1'b0, abs_z};
  always @(posedge clk) begin
    d_e_q <= d_e_at_p_e_z;
    // h can round up to 2 if d2 is close to 0; it saturates.
    h_q   <= (h_sum[W:W-1] != 2'b00) ? {1'b0, {(W - 1) {1'b1}}} : h_sum[W-1:0];
  end
  assign h = h_q;

  // ---- (15) the direction of (p_ex, p_ey), normalized to full words ----

  wire signed [W-1:0] u_x, u_y;
  wire [5:0] lz_u;
  // (15) lz_u = leading_sign_bits(p_e_x, p_e_y)
  // (15) u_x = p_e_x << lz_u
  // (15) u_y = p_e_y << lz_u
  ik_norm #(.W(W), .N(2)) u_norm_u (.clk(clk), .d({p_e_y, p_e_x}), .q({u_y, u_x}), .count(lz_u));

  // ---- (15) elbow below: u (d1 - p_ez), u . (p_ex, p_ey) ----

  wire signed [W-1:0] uh_x, uh_y;
  wire signed [WW-1:0] uu_x, uu_y;
  wire signed [W-1:0] uu;
  // (15) uh_x = u_x * h
  ik_mul #(.AW(W), .BW(W), .SH(F_U_X+F_H-F_UH_X), .OW(W), .DB(T_U_X-T_H)) u_uh_x (.clk(clk), .a(u_x), .b(h), .q(uh_x));
  // (15) uh_y = u_y * h
  ik_mul #(.AW(W), .BW(W), .SH(F_U_Y+F_H-F_UH_Y), .OW(W), .DB(T_U_Y-T_H)) u_uh_y (.clk(clk), .a(u_y), .b(h), .q(uh_y));
  // (15) uu_x = u_x * p_e_x
  ik_mul #(.AW(W), .BW(W), .SH(F_U_X+F_P_E_X-F_UU_X), .OW(WW), .DB(T_U_X-T_P_E_X)) u_uu_x (
      .clk(clk), .a(u_x), .b(p_e_x), .q(uu_x)
  );
  // (15) uu_y = u_y * p_e_y
  ik_mul #(.AW(W), .BW(W), .SH(F_U_Y+F_P_E_Y-F_UU_Y), .OW(WW), .DB(T_U_Y-T_P_E_Y)) u_uu_y (
      .clk(clk), .a(u_y), .b(p_e_y), .q(uu_y)
  );
  // (15) uu = uu_x + uu_y
  ik_sum2 #(.IW(WW), .SH(F_UU_X-F_UU), .OW(W), .SAT(0)) u_uu (.clk(clk), .a(uu_x), .b(uu_y), .q(uu), .ovf());

  // ---- (15) the form that does not cancel; x and y are ready before z ----

  wire signed [W-1:0] p_e_x_at_uh_x, p_e_y_at_uh_x, h_at_uu;
  wire below_at_uh_x, below_at_uu;
  ik_delay #(.W(2*W+1), .N(T_UH_X-T_P_E_X)) u_p_e_x_at_uh_x (
      .clk(clk), .d({p_e_z[W-1], p_e_y, p_e_x}), .q({below_at_uh_x, p_e_y_at_uh_x, p_e_x_at_uh_x})
  );
  ik_delay #(.W(1), .N(T_UU-T_UH_X)) u_below_at_uu (.clk(clk), .d(below_at_uh_x), .q(below_at_uu));
  ik_delay #(.W(W), .N(T_UU-T_H)) u_h_at_uu (.clk(clk), .d(h), .q(h_at_uu));
  reg signed [W-1:0] m_x, m_y, m_z;
  always @(posedge clk) begin
    m_x <= below_at_uh_x ? uh_x : p_e_x_at_uh_x;
    m_y <= below_at_uh_x ? uh_y : p_e_y_at_uh_x;
    m_z <= below_at_uu ? uu : h_at_uu;
  end

  wire signed [W-1:0] m_x_at_m_z, m_y_at_m_z;
  ik_delay #(.W(2*W), .N(T_M_Z-T_M_X)) u_m_at_m_z (.clk(clk), .d({m_y, m_x}), .q({m_y_at_m_z, m_x_at_m_z}));

  // ---- (15) L_m in its own unit, tmp2 = L_m^2, |L_m| ----

  wire signed [W-1:0] l_m_x, l_m_y, l_m_z;
  wire [5:0] lz_m;
  // (15) lz_m = leading_sign_bits(m_z, m_x, m_y)
  // (15) l_m_x = m_x << lz_m
  // (15) l_m_y = m_y << lz_m
  // (15) l_m_z = m_z << lz_m
  ik_norm #(.W(W), .N(3)) u_norm_m (
      .clk(clk), .d({m_y_at_m_z, m_x_at_m_z, m_z}), .q({l_m_y, l_m_x, l_m_z}), .count(lz_m)
  );

  wire signed [WW-1:0] tmp2_x, tmp2_y, tmp2_z;
  wire signed [W-1:0] tmp2, l_m;
  localparam integer SH_TMP2 = 2 * F_L_M_X - F_TMP2_X;
  // (15) tmp2_x = l_m_x^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_TMP2), .OW(WW), .SQUARE(1)) u_tmp2_x (.clk(clk), .a(l_m_x), .b(l_m_x), .q(tmp2_x));
  // (15) tmp2_y = l_m_y^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_TMP2), .OW(WW), .SQUARE(1)) u_tmp2_y (.clk(clk), .a(l_m_y), .b(l_m_y), .q(tmp2_y));
  // (15) tmp2_z = l_m_z^2
  ik_mul #(.AW(W), .BW(W), .SH(SH_TMP2), .OW(WW), .SQUARE(1)) u_tmp2_z (.clk(clk), .a(l_m_z), .b(l_m_z), .q(tmp2_z));
  // (15) tmp2 = tmp2_x + tmp2_y + tmp2_z
  ik_sum3 #(.IW(WW), .SH(F_TMP2_X-F_TMP2), .OW(W), .SAT(0)) u_tmp2 (
      .clk(clk), .a(tmp2_x), .b(tmp2_y), .c(tmp2_z), .q(tmp2), .ovf()
  );
  // (15) l_m = sqrt tmp2
  ik_root #(.NW(W), .SH(2*F_L_M-F_TMP2), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_l_m (
      .clk(clk), .n({1'b0, tmp2[W-2:0]}), .q(l_m), .neg()  // a sum of squares has no sign
  );

  // ---- (15) q12 = L_m / |L_m| ----

  wire signed [W-1:0] l_m_x_at_l_m, l_m_y_at_l_m, l_m_z_at_l_m;
  localparam integer SH_Q = F_Q12_I - F_L_M_X + F_L_M;
  ik_ring #(.W(3*W), .N(T_L_M-T_L_M_X)) u_l_m_at_l_m (
      .clk(clk), .rst(rst), .d({l_m_z, l_m_y, l_m_x}), .q({l_m_z_at_l_m, l_m_y_at_l_m, l_m_x_at_l_m})
  );
  // (15) q12_i = l_m_x / l_m
  ik_div #(.NW(W), .DW(W), .SH(SH_Q), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_q12_i (
      .clk(clk), .n(l_m_x_at_l_m), .d(l_m), .q(q12_i), .ovf()
  );
  // (15) q12_j = l_m_y / l_m
  ik_div #(.NW(W), .DW(W), .SH(SH_Q), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_q12_j (
      .clk(clk), .n(l_m_y_at_l_m), .d(l_m), .q(q12_j), .ovf()
  );
  // (15) q12_k = l_m_z / l_m
  ik_div #(.NW(W), .DW(W), .SH(SH_Q), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_q12_k (
      .clk(clk), .n(l_m_z_at_l_m), .d(l_m), .q(q12_k), .ovf()
  );

  wire unused = &{1'b0, lz_u, lz_m, tmp2[W-1]};

endmodule

`default_nettype wire

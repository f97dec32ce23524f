// The elbow quaternion Qe = qe_w + qe_i i: section 3.3, equation (14).
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_paper_nodes.vh; rounding: products and sums half up, roots and quotient floor.
// Each port is valid at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_elbow_q #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer DIGIT = 0    // dividers and roots: 1 digit recurrence, 0 behavioural
) (
    // Clock
    input  wire                clk,
    input  wire                rst,         // synchronous, for ik_ring
    // From guard
    input  wire signed [W-1:0] d_1,         // T_D_1
    input  wire signed [W-1:0] d_2,
    input  wire signed [W-1:0] p_a_x,       // the target in the unit of d1 and d2, T_P_A_X
    input  wire signed [W-1:0] p_a_y,
    input  wire signed [W-1:0] p_a_z,
    input  wire                clamp,       // T_CLAMP
    input  wire                closed,        // T_CLOSED
    // From elbow
    input  wire signed [W-1:0] p_e_x,       // T_P_E_X
    input  wire signed [W-1:0] p_e_y,
    input  wire signed [W-1:0] p_e_z,
    // Results
    output wire signed [W-1:0] qe_w,        // T_QE_W
    output reg  signed [W-1:0] qe_i         // T_QE_I
);

  `include "ik_paper_nodes.vh"

  localparam integer WW = W + GUARD;  // width of an unrounded product

  // ---- (14) p_e^2 - p_e p_w = p_e (p_e - p_w) ----

  wire signed [W-1:0] p_a_x_at_p_e_x, p_a_y_at_p_e_x, p_a_z_at_p_e_x;
  ik_ring #(.W(3*W), .N(T_P_E_X-T_P_A_X)) u_p_a_at_p_e_x (
      .clk(clk), .rst(rst), .d({p_a_z, p_a_y, p_a_x}), .q({p_a_z_at_p_e_x, p_a_y_at_p_e_x, p_a_x_at_p_e_x})
  );
  wire signed [W-1:0] f_x;  // p_e - p_w
  wire signed [W-1:0] f_y, f_z;
  localparam integer SH_F = F_P_A_X - F_F_X;
  // (14) f_x = p_e_x - p_a_x
  ik_sum2 #(.IW(W+1), .SH(SH_F), .OW(W), .SUB_B(1), .SAT(0)) u_f_x (
      .clk(clk), .a({p_e_x, 1'b0}), .b({p_a_x_at_p_e_x[W-1], p_a_x_at_p_e_x}), .q(f_x), .ovf()
  );
  // (14) f_y = p_e_y - p_a_y
  ik_sum2 #(.IW(W+1), .SH(SH_F), .OW(W), .SUB_B(1), .SAT(0)) u_f_y (
      .clk(clk), .a({p_e_y, 1'b0}), .b({p_a_y_at_p_e_x[W-1], p_a_y_at_p_e_x}), .q(f_y), .ovf()
  );
  // (14) f_z = p_e_z - p_a_z
  ik_sum2 #(.IW(W+1), .SH(SH_F), .OW(W), .SUB_B(1), .SAT(0)) u_f_z (
      .clk(clk), .a({p_e_z, 1'b0}), .b({p_a_z_at_p_e_x[W-1], p_a_z_at_p_e_x}), .q(f_z), .ovf()
  );

  wire signed [WW-1:0] t_x, t_y, t_z;
  wire signed [W-1:0] t_e;
  localparam integer SH_T = F_P_E_X + F_F_X - F_T_X;
  // (14) t_x = p_e_x * f_x
  ik_mul #(.AW(W), .BW(W), .SH(SH_T), .OW(WW), .DA(T_F_X-T_P_E_X)) u_t_x (.clk(clk), .a(p_e_x), .b(f_x), .q(t_x));
  // (14) t_y = p_e_y * f_y
  ik_mul #(.AW(W), .BW(W), .SH(SH_T), .OW(WW), .DA(T_F_X-T_P_E_X)) u_t_y (.clk(clk), .a(p_e_y), .b(f_y), .q(t_y));
  // (14) t_z = p_e_z * f_z
  ik_mul #(.AW(W), .BW(W), .SH(SH_T), .OW(WW), .DA(T_F_X-T_P_E_X)) u_t_z (.clk(clk), .a(p_e_z), .b(f_z), .q(t_z));
  // (14) t_e = t_x + t_y + t_z
  ik_sum3 #(.IW(WW), .SH(F_T_X-F_T_E), .OW(W)) u_t_e (
      .clk(clk), .a(t_x), .b(t_y), .c(t_z), .q(t_e), .ovf()  // overflows only if clamped; c4 is overridden below
  );

  // ---- (14) c4 = (p_e^2 - p_e p_w) / (d1 d2) ----

  wire signed [W-1:0] d_12, d_12_at_t_e, c4_quo;
  // (14) d_12 = d_1 * d_2
  ik_mul #(.AW(W), .BW(W), .SH(2*F_D_1-F_D_12), .OW(W)) u_d_12 (.clk(clk), .a(d_1), .b(d_2), .q(d_12));
  ik_ring #(.W(W), .N(T_T_E-T_D_12)) u_d_12_at_t_e (.clk(clk), .rst(rst), .d(d_12), .q(d_12_at_t_e));
  // (14) c4_quo = t_e / d_12
  ik_div #(.NW(W), .DW(W), .SH(F_C4_QUO-F_T_E+F_D_12), .QW(W), .LAT(LAT_DIV), .DIGIT(DIGIT)) u_c4_quo (
      .clk(clk), .n(t_e), .d(d_12_at_t_e), .q(c4_quo), .ovf()  // saturation at 2 is harmless: ik_half limits c4 to 1
  );

  // A clamped arm is straight (-1) or closed (+1).
  wire clamp_at_t_e, closed_at_t_e, clamp_at_c4_quo, closed_at_c4_quo;
  ik_ring #(.W(2), .N(T_T_E-T_CLAMP)) u_clamp_at_t_e (
      .clk(clk), .rst(rst), .d({closed, clamp}), .q({closed_at_t_e, clamp_at_t_e})
  );
  ik_delay #(.W(2), .N(T_C4_QUO-T_T_E)) u_clamp_at_c4_quo (
      .clk(clk), .d({closed_at_t_e, clamp_at_t_e}), .q({closed_at_c4_quo, clamp_at_c4_quo})
  );
  localparam signed [W-1:0] ONE = {2'b01, {(W - 2) {1'b0}}};
  reg signed [W-1:0] c4;
  always @(posedge clk) c4 <= !clamp_at_c4_quo ? c4_quo : closed_at_c4_quo ? ONE : -ONE;

  // ---- (14) qe_w = sqrt((1 + c4)/2), qe_i = -sqrt((1 - c4)/2) ----

  wire [W-1:0] h4_p, h4_m;
  wire signed [W-1:0] qe_abs;
  localparam integer SH_ROOT = 2 * F_QE_W - (W - 1);
  // (14) h4_p = min(max((1 + c4) / 2, 0), 1)
  ik_half #(.W(W)) u_h4_p (.clk(clk), .c(c4), .q(h4_p));
  // (14) h4_m = min(max((1 - c4) / 2, 0), 1)
  ik_half #(.W(W), .MINUS(1)) u_h4_m (.clk(clk), .c(c4), .q(h4_m));
  // (14) qe_w = sqrt h4_p
  ik_root #(.NW(W+1), .SH(SH_ROOT), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_qe_w (
      .clk(clk), .n({1'b0, h4_p}), .q(qe_w), .neg()
  );
  // (14) qe_abs = sqrt h4_m
  ik_root #(.NW(W+1), .SH(SH_ROOT), .QW(W), .LAT(LAT_ROOT), .DIGIT(DIGIT)) u_qe_abs (
      .clk(clk), .n({1'b0, h4_m}), .q(qe_abs), .neg()
  );
  always @(posedge clk) qe_i <= -qe_abs;

endmodule

`default_nettype wire

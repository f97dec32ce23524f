// Rounding and format of each node: ik_lean_nodes.vh; products by ik_mul3, roots faithful, shifts and halves floor.
// SPDX-License-Identifier: Apache-2.0
//
// Azimuth (u_x, u_y) = (x, y)/rho and elevation sin_el = z/|p|, cos_el = rho/|p| of the target, and of each the half angle
// h(c, s): (1 + c, s)/2, or (s, 1 - c)/2 where c < 0, a quaternion of squared length (1 + |c|)/2: (az_c, az_s) and az_sq,
// (tilt_c, tilt_s) and tilt_sq.
`default_nettype none

module ik_lean_direction #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = (W < 16) ? 23 : ((W < 28) ? W + 7 : 35)  // of an inner word: follows from W
) (
    input  wire                  clk,
    input  wire signed [  W-1:0] x,
    input  wire signed [  W-1:0] y,
    input  wire signed [  W-1:0] z,
    input  wire signed [2*W+1:0] rho_sq,       // T_RHO_SQ
    input  wire signed [2*W+1:0] s,            // T_S
    input  wire                  on_axis,      // T_ON_AXIS
    input  wire                  at_shoulder,  // T_AT_SHOULDER
    output wire        [    5:0] e_s,          // (L9) T_E_S
    output wire signed [  N-1:0] inv_s,        // (L9) T_INV_S
    output reg  signed [  N-1:0] az_sq,        // (L29) T_AZ_SQ
    output reg  signed [  N-1:0] az_c,         // (L32) T_AZ_C
    output reg  signed [  N-1:0] az_s,         // (L33)
    output reg  signed [  N-1:0] tilt_sq,      // (L30) T_TILT_SQ
    output reg  signed [  N-1:0] tilt_c,       // (L34) T_TILT_C
    output reg  signed [  N-1:0] tilt_s        // (L35)
);

  `include "ik_lean_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_direction_N_is_FRAC_and_2 u_stop ();
    end
  endgenerate

  localparam integer MW = ROOT_FRAC + 3;  // of a mantissa

  // ---- (L8) (L9) roots of rho^2 and |p|^2 ----

  wire [5:0] e_rho;  // (L8)
  wire [MW-1:0] m_rho;  // (L8)
  wire [MW-1:0] m_s;  // (L9)
  wire signed [N-1:0] inv_rho;  // (L8)
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N)) u_rho (.clk(clk), .v(rho_sq[2*W-1:0]), .e(e_rho), .m(m_rho), .inv(inv_rho));
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N)) u_s (.clk(clk), .v(s[2*W-1:0]), .e(e_s), .m(m_s), .inv(inv_s));
  wire unused = &{1'b0, rho_sq[2*W+1:2*W], s[2*W+1:2*W], m_s};  // sums of squares below 2^2W; m_s is watched only

  // ---- (L14)-(L16) (u_x, u_y) = (x, y)/rho and z/|p|: the target shifted as its root was ----

  wire signed [W-1:0] x_e;
  wire signed [W-1:0] y_e;
  wire signed [W-1:0] z_e;
  ik_delay #(.W(2*W), .N(T_E_RHO)) u_xy_e (.clk(clk), .d({y, x}), .q({y_e, x_e}));
  ik_delay #(.W(W), .N(T_E_S)) u_z_e (.clk(clk), .d(z), .q(z_e));
  localparam integer CW = F_X_N + 1;  // of a coordinate: short words get zeros below
  wire signed [CW-1:0] x_w = {{(CW - W) {x_e[W-1]}}, x_e};
  wire signed [CW-1:0] y_w = {{(CW - W) {y_e[W-1]}}, y_e};
  wire signed [CW-1:0] z_w = {{(CW - W) {z_e[W-1]}}, z_e};
  wire signed [CW-1:0] x_n;  // (L14)
  wire signed [CW-1:0] y_n;  // (L15)
  wire signed [CW-1:0] z_n;  // (L16)
  ik_shift #(.W(CW)) u_x_n (.clk(clk), .d(x_w <<< (F_X_N - W)), .count(e_rho), .q(x_n));
  ik_shift #(.W(CW)) u_y_n (.clk(clk), .d(y_w <<< (F_X_N - W)), .count(e_rho), .q(y_n));
  ik_shift #(.W(CW)) u_z_n (.clk(clk), .d(z_w <<< (F_X_N - W)), .count(e_s), .q(z_n));

  wire signed [CW-1:0] x_inv;
  wire signed [CW-1:0] y_inv;
  wire signed [CW-1:0] z_inv;
  ik_delay #(.W(2*CW), .N(T_INV_RHO-T_X_N)) u_xy_inv (.clk(clk), .d({y_n, x_n}), .q({y_inv, x_inv}));
  ik_delay #(.W(CW), .N(T_INV_S-T_Z_N)) u_z_inv (.clk(clk), .d(z_n), .q(z_inv));
  wire signed [N-1:0] u_x;  // (L14)
  wire signed [N-1:0] u_y;  // (L15)
  wire signed [N-1:0] sin_el;  // (L16)
  localparam integer SH_U = F_X_N + F_INV_RHO - 1 - F_U_X;
  ik_mul3 #(.AW(CW), .BW(N), .SH(SH_U), .OW(N)) u_u_x (.clk(clk), .a(x_inv), .b(inv_rho), .q(u_x));
  ik_mul3 #(.AW(CW), .BW(N), .SH(SH_U), .OW(N)) u_u_y (.clk(clk), .a(y_inv), .b(inv_rho), .q(u_y));
  ik_mul3 #(.AW(CW), .BW(N), .SH(SH_U), .OW(N)) u_sin_el (.clk(clk), .a(z_inv), .b(inv_s), .q(sin_el));

  // ---- (L17) (L18) cos_el = rho/|p|: sqrt(m) in rho's unit, the inverse brought to it ----

  wire [MW-1:0] m_rho_inv;
  wire signed [N-1:0] root_rho;  // (L17)
  ik_delay #(.W(MW), .N(T_INV_RHO-T_M_RHO)) u_m_rho_inv (.clk(clk), .d(m_rho), .q(m_rho_inv));
  ik_mul3 #(.AW(N), .BW(MW+1), .SH(F_INV_RHO+MW-1-F_ROOT_RHO), .OW(N)) u_root_rho (
      .clk(clk), .a(inv_rho), .b({1'b0, m_rho_inv}), .q(root_rho)
  );

  wire [5:0] e_rho_s;
  wire [5:0] n_el_inv;
  reg [5:0] n_el;  // (L18) rho^2 <= |p|^2: not negative
  ik_delay #(.W(6), .N(T_E_S-T_E_RHO)) u_e_rho_s (.clk(clk), .d(e_rho), .q(e_rho_s));
  always @(posedge clk) n_el <= e_rho_s - e_s;
  ik_delay #(.W(6), .N(T_INV_S-T_N_EL)) u_n_el_inv (.clk(clk), .d(n_el), .q(n_el_inv));
  wire signed [N-1:0] inv_s_el;  // (L18)
  ik_shift #(.W(N), .RIGHT(1)) u_inv_s_el (.clk(clk), .d(inv_s), .count(n_el_inv), .q(inv_s_el));

  localparam integer T_COS_EL_IN = T_COS_EL - LAT_MUL3;
  wire signed [N-1:0] root_rho_el;
  wire signed [N-1:0] inv_s_in;
  wire signed [N-1:0] cos_el;  // (L18)
  ik_delay #(.W(N), .N(T_COS_EL_IN-T_ROOT_RHO)) u_root_rho_el (.clk(clk), .d(root_rho), .q(root_rho_el));
  ik_delay #(.W(N), .N(T_COS_EL_IN-T_INV_S_EL)) u_inv_s_in (.clk(clk), .d(inv_s_el), .q(inv_s_in));
  ik_mul3 #(.AW(N), .BW(N), .SH(F_ROOT_RHO+F_INV_S_EL-1-F_COS_EL), .OW(N)) u_cos_el (
      .clk(clk), .a(root_rho_el), .b(inv_s_in), .q(cos_el)
  );

  // ---- (L29) (L32) (L33) az: the first rotation turns by the azimuth and 90 degrees, cosine -u_y, sine u_x ----

  localparam signed [N-1:0] ONE = {{(N - 1) {1'b0}}, 1'b1} << FRAC;
  wire axis_u;
  wire axis_h;
  wire signed [N-1:0] u_x_h;
  wire sign_u_y_h;
  ik_delay #(.W(1), .N(T_U_Y-T_ON_AXIS)) u_axis_u (.clk(clk), .d(on_axis), .q(axis_u));
  ik_delay #(.W(N+2), .N(T_AZ_SQ-T_U_Y)) u_az (
      .clk(clk), .d({axis_u, u_y[N-1], u_x}), .q({axis_h, sign_u_y_h, u_x_h})
  );
  wire [N-1:0] sum_az = ONE + (u_y ^ {N{u_y[N-1]}});  // 1 + |u_y|, by the one's complement
  always @(posedge clk) begin
    az_sq  <= sum_az >> 1;
    // on the z axis u_x = u_y = 0, and azimuth 0 is taken: (1, 1)/2
    az_c <= (sign_u_y_h || axis_h) ? az_sq : (u_x_h >>> 1);
    az_s <= sign_u_y_h ? (u_x_h >>> 1) : az_sq;
  end

  // ---- (L30) (L34) (L35) tilt: the second turns by the angle between p and the z axis, cosine sin_el, sine cos_el ----

  wire shoulder_el;
  wire signed [N-1:0] tilt_sq_h;
  wire sign_h;
  ik_delay #(.W(1), .N(T_SIN_EL-T_AT_SHOULDER)) u_shoulder_el (.clk(clk), .d(at_shoulder), .q(shoulder_el));
  wire [N-1:0] sum_tilt = ONE + (sin_el ^ {N{sin_el[N-1]}});
  ik_delay #(.W(N), .N(T_COS_EL-T_TILT_SQ)) u_tilt_sq_h (.clk(clk), .d(tilt_sq), .q(tilt_sq_h));
  ik_delay #(.W(1), .N(T_COS_EL-T_SIN_EL)) u_sign_h (.clk(clk), .d(sin_el[N-1]), .q(sign_h));
  always @(posedge clk) begin
    tilt_sq  <= shoulder_el ? ONE : (sum_tilt >> 1);
    tilt_c <= sign_h ? (cos_el >>> 1) : tilt_sq_h;
    tilt_s <= sign_h ? tilt_sq_h : (cos_el >>> 1);
  end

endmodule

`default_nettype wire

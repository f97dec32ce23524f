// Direction of the target: azimuth, elevation, and a half angle for each.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_lean_nodes.vh; rounding: products as in ik_mul3, roots faithful, shifts and halves floor.
// Azimuth (u_x, u_y) = (x, y)/rho and elevation sin_el = z/|p|, cos_el = rho/|p| of the target, and a half angle for
// each. The half angle of (c, s) is (1 + c, s)/2, or (s, 1 - c)/2 if c < 0: a quaternion of squared length (1 + |c|)/2.
// Results: (az_c, az_s) and az_sq, (tilt_c, tilt_s) and tilt_sq. Inputs at clock 0, each output at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_lean_direction #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = 35,  // inner word width: FRAC + 2
    parameter integer TILE = 18  // see ik_mul3
) (
    // Clock
    input  wire                  clk,
    // Target
    input  wire signed [  W-1:0] x,
    input  wire signed [  W-1:0] y,
    input  wire signed [  W-1:0] z,
    // From guard
    input  wire signed [2*W+1:0] rho_sq,       // T_RHO_SQ
    input  wire signed [2*W+1:0] s,            // T_S
    input  wire                  on_axis,      // T_ON_AXIS
    input  wire                  at_shoulder,  // T_AT_SHOULDER
    // For the triangle
    output wire        [    5:0] e_s,          // T_E_S
    output wire signed [  N-1:0] inv_s,        // T_INV_S
    // Azimuth
    output reg  signed [  N-1:0] az_sq,        // T_AZ_SQ
    output reg  signed [  N-1:0] az_c,         // T_AZ_C
    output reg  signed [  N-1:0] az_s,
    // Tilt
    output reg  signed [  N-1:0] tilt_sq,      // T_TILT_SQ
    output reg  signed [  N-1:0] tilt_c,       // T_TILT_C
    output reg  signed [  N-1:0] tilt_s
);

  `include "ik_lean_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_direction_illegal_N u_stop ();
    end
  endgenerate

  localparam integer MW = ROOT_FRAC + 3;  // width of a mantissa

  // ---- roots of rho^2 and |p|^2 ----

  wire [5:0] e_rho;
  wire [MW-1:0] m_rho;
  wire [MW-1:0] m_s;
  wire signed [N-1:0] inv_rho;
  // e_rho = clz(rho_sq) / 2
  // m_rho = rho_sq << 2 * e_rho
  // inv_rho = 1 / (2 * sqrt m_rho)
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N), .TILE(TILE)) u_rho (
      .clk(clk), .v(rho_sq[2*W-1:0]), .e(e_rho), .m(m_rho), .inv(inv_rho)
  );
  // e_s = clz(s) / 2
  // m_s = s << 2 * e_s
  // inv_s = 1 / (2 * sqrt m_s)
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N), .TILE(TILE)) u_s (.clk(clk), .v(s[2*W-1:0]), .e(e_s), .m(m_s), .inv(inv_s));
  wire unused = &{1'b0, rho_sq[2*W+1:2*W], s[2*W+1:2*W], m_s};  // sums of squares are below 2^2W; m_s is for waves only

  // ---- (u_x, u_y) = (x, y)/rho and z/|p|: coordinates are shifted by the root's count ----

  localparam integer CW = F_X_N + 1;  // width of a coordinate; short words are padded with zeros below
  wire signed [CW-1:0] x_w = {{(CW - W) {x[W-1]}}, x};
  wire signed [CW-1:0] y_w = {{(CW - W) {y[W-1]}}, y};
  wire signed [CW-1:0] z_w = {{(CW - W) {z[W-1]}}, z};
  wire signed [CW-1:0] x_n;
  wire signed [CW-1:0] y_n;
  wire signed [CW-1:0] z_n;
  ik_shift #(.W(CW), .DD(T_E_RHO)) u_x_n (.clk(clk), .d(x_w <<< (F_X_N - W)), .count(e_rho), .q(x_n));
  ik_shift #(.W(CW), .DD(T_E_RHO)) u_y_n (.clk(clk), .d(y_w <<< (F_X_N - W)), .count(e_rho), .q(y_n));
  ik_shift #(.W(CW), .DD(T_E_S)) u_z_n (.clk(clk), .d(z_w <<< (F_X_N - W)), .count(e_s), .q(z_n));

  wire signed [N-1:0] u_x;
  wire signed [N-1:0] u_y;
  wire signed [N-1:0] sin_el;
  localparam integer SH_U = F_X_N + F_INV_RHO - 1 - F_U_X;
  // u_x = 2 * x_n * inv_rho
  // u_y = 2 * y_n * inv_rho
  ik_scale #(.COUNT(2), .AW(CW), .BW(N), .SH(SH_U), .OW(N), .DA(T_INV_RHO-T_X_N), .TILE(TILE)) u_by_inv_rho (
      .clk(clk), .a({y_n, x_n}), .b(inv_rho), .q({u_y, u_x})
  );
  // sin_el = 2 * z_n * inv_s
  ik_mul3 #(.AW(CW), .BW(N), .SH(SH_U), .OW(N), .DA(T_INV_S-T_Z_N), .TILE(TILE)) u_sin_el (
      .clk(clk), .a(z_n), .b(inv_s), .q(sin_el)
  );

  // ---- cos_el = rho/|p|: sqrt(m) in rho's unit, the inverse shifted to the same unit ----

  wire signed [N-1:0] root_rho;
  // root_rho = 2 * inv_rho * m_rho
  ik_mul3 #(.AW(N), .BW(MW+1), .SH(F_INV_RHO+MW-1-F_ROOT_RHO), .OW(N), .DB(T_INV_RHO-T_M_RHO), .TILE(TILE)) u_root_rho (
      .clk(clk), .a(inv_rho), .b({1'b0, m_rho}), .q(root_rho)
  );

  wire [5:0] e_rho_at_e_s;
  reg [5:0] n_el;  // rho^2 <= |p|^2: not negative
  ik_delay #(.W(6), .N(T_E_S-T_E_RHO)) u_e_rho_at_e_s (.clk(clk), .d(e_rho), .q(e_rho_at_e_s));
  always @(posedge clk) n_el <= e_rho_at_e_s - e_s;
  wire signed [N-1:0] inv_s_el;
  ik_shift #(.W(N), .RIGHT(1), .DC(T_INV_S-T_N_EL)) u_inv_s_el (.clk(clk), .d(inv_s), .count(n_el), .q(inv_s_el));

  localparam integer T_COS_EL_IN = T_COS_EL - LAT_MUL3;
  wire signed [N-1:0] cos_el;
  // cos_el = 2 * root_rho * inv_s_el
  ik_mul3 #(.AW(N), .BW(N), .SH(F_ROOT_RHO+F_INV_S_EL-1-F_COS_EL), .OW(N), .DA(T_COS_EL_IN-T_ROOT_RHO),
      .DB(T_COS_EL_IN-T_INV_S_EL), .TILE(TILE)) u_cos_el (
      .clk(clk), .a(root_rho), .b(inv_s_el), .q(cos_el)
  );

  // ---- az: the first rotation is by the azimuth plus 90 degrees, cosine -u_y, sine u_x ----

  localparam signed [N-1:0] ONE = {{(N - 1) {1'b0}}, 1'b1} << FRAC;
  wire on_axis_at_u_y;
  ik_delay #(.W(1), .N(T_U_Y-T_ON_AXIS)) u_on_axis_at_u_y (.clk(clk), .d(on_axis), .q(on_axis_at_u_y));
  wire [N-1:0] sum_az = ONE + (u_y ^ {N{u_y[N-1]}});  // 1 + |u_y|, by the one's complement
  wire signed [N-1:0] half_az = sum_az >> 1;
  wire signed [N-1:0] half_u_x = u_x >>> 1;
  always @(posedge clk) begin
    az_sq <= half_az;
    // On the z axis u_x = u_y = 0; azimuth 0 is used: (1, 1)/2.
    az_c  <= (u_y[N-1] || on_axis_at_u_y) ? half_az : half_u_x;
    az_s  <= u_y[N-1] ? half_u_x : half_az;
  end

  // ---- tilt: the second rotation is by the angle between p and z, cosine sin_el, sine cos_el ----

  wire at_shoulder_at_sin_el;
  wire signed [N-1:0] tilt_sq_at_cos_el;
  wire sign_at_cos_el;
  ik_delay #(.W(1), .N(T_SIN_EL-T_AT_SHOULDER)) u_at_shoulder_at_sin_el (
      .clk(clk), .d(at_shoulder), .q(at_shoulder_at_sin_el)
  );
  wire [N-1:0] sum_tilt = ONE + (sin_el ^ {N{sin_el[N-1]}});
  ik_delay #(.W(N), .N(T_COS_EL-T_TILT_SQ)) u_tilt_sq_at_cos_el (.clk(clk), .d(tilt_sq), .q(tilt_sq_at_cos_el));
  ik_delay #(.W(1), .N(T_COS_EL-T_SIN_EL)) u_sign_at_cos_el (.clk(clk), .d(sin_el[N-1]), .q(sign_at_cos_el));
  always @(posedge clk) begin
    tilt_sq  <= at_shoulder_at_sin_el ? ONE : (sum_tilt >> 1);
    tilt_c <= sign_at_cos_el ? (cos_el >>> 1) : tilt_sq_at_cos_el;
    tilt_s <= sign_at_cos_el ? tilt_sq_at_cos_el : (cos_el >>> 1);
  end

endmodule

`default_nettype wire

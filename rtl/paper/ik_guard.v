// Prepares arbitrary input words for the paper's equations.
// SPDX-License-Identifier: Apache-2.0
//
// Comparisons exact; scaling drops at most one bit: ORed into the LSB, floor for d_dif_j; Q2.(W-2) to Q1.(W-1).
// This section:
// - detects targets without an elbow: too far, too near, at the shoulder, or no length. These are clamped: the
//   datapath sees an ordinary arm, and three later nodes (p_e, c4 and the side for (17)) are overridden;
// - scales lengths to full words. Kinematics is scale-free: d1 and d2 are scaled to 1/2 <= d1 + d2 < 1; the target has
//   its own unit, 2^scale_j finer, and so has its horizontal direction (b).
//
// Inputs at clock 0; output OUT at clock T_OUT of ik_paper_nodes.vh.
// Throughput: one target per clock.
`default_nettype none

module ik_guard #(
    parameter integer W = 32  // word length, 16 to 32
) (
    // Clock
    input  wire                clk,
    // Target, Q2.(W-2)
    input  wire signed [W-1:0] x,
    input  wire signed [W-1:0] y,
    input  wire signed [W-1:0] z,
    input  wire signed [W-1:0] d1,
    input  wire signed [W-1:0] d2,
    // Target and its horizontal direction, each in its own unit, Q1.(W-1)
    output wire signed [W-1:0] p_w_x,
    output wire signed [W-1:0] p_w_y,
    output wire signed [W-1:0] p_w_z,
    output wire signed [W-1:0] b_x,
    output wire signed [W-1:0] b_y,
    // Lengths and target in the unit of d1 and d2, Q1.(W-1)
    output reg  signed [W-1:0] d_1,
    output reg  signed [W-1:0] d_2,
    output reg  signed [W-1:0] p_a_x,
    output reg  signed [W-1:0] p_a_y,
    output reg  signed [W-1:0] p_a_z,
    output reg         [  5:0] scale_j,      // p_w = 2^scale_j p_a
    output reg  signed [W-1:0] d_dif_j,      // d1 - d2 in the target's unit, Q2.(W-2)
    // Decisions
    output reg                 too_far,
    output reg                 too_near,
    output reg                 on_axis,
    output reg                 at_shoulder,
    output reg                 bad_length,
    output reg                 clamp,        // no elbow: straight or closed
    output reg                 closed,         // clamped, not straight
    output reg                 away          // clamped, upper arm points away from the target
);

  `include "ik_paper_nodes.vh"

  localparam integer XW = 2 * W + 2;  // width of an exact sum of squares

  // ---- lengths and positions outside the equations' domain ----

  always @(posedge clk) begin
    bad_length  <= (d1 <= 0) || (d2 <= 0);
    on_axis     <= (x == 0) && (y == 0);
    at_shoulder <= (x == 0) && (y == 0) && (z == 0);
  end

  // ---- reach: compare d1 + d2 and d1 - d2 with |p| as exact squares ----

  wire signed [W:0] d1_x = {d1[W-1], d1};
  wire signed [W:0] d2_x = {d2[W-1], d2};
  reg signed  [W:0] r_raw;
  reg signed  [W:0] d_raw;
  always @(posedge clk) begin
    r_raw <= d1_x + d2_x;
    d_raw <= d1_x - d2_x;
  end

  // x, y and z are squared as W bits, as in ik_lean_guard: Yosys' xilinx_dsp loses bits of a product's register where an
  // operand has two equal sign bits. A square is not negative.
  wire [2*W-1:0] x_sq_w, y_sq_w, z_sq_w;
  wire signed [XW-1:0] x_sq = {2'b00, x_sq_w};
  wire signed [XW-1:0] y_sq = {2'b00, y_sq_w};
  wire signed [XW-1:0] z_sq = {2'b00, z_sq_w};
  wire signed [XW-1:0] r_sq, d_sq;
  // x_sq = x^2
  ik_mul #(.AW(W), .BW(W), .SH(0), .OW(2*W), .SQUARE(1)) u_x_sq (.clk(clk), .a(x), .b(x), .q(x_sq_w));
  // y_sq = y^2
  ik_mul #(.AW(W), .BW(W), .SH(0), .OW(2*W), .SQUARE(1)) u_y_sq (.clk(clk), .a(y), .b(y), .q(y_sq_w));
  // z_sq = z^2
  ik_mul #(.AW(W), .BW(W), .SH(0), .OW(2*W), .SQUARE(1)) u_z_sq (.clk(clk), .a(z), .b(z), .q(z_sq_w));
  // r_sq = r_raw^2
  ik_mul #(.AW(W+1), .BW(W+1), .SH(0), .OW(XW), .SQUARE(1)) u_r_sq (.clk(clk), .a(r_raw), .b(r_raw), .q(r_sq));
  // d_sq = d_raw^2
  ik_mul #(.AW(W+1), .BW(W+1), .SH(0), .OW(XW), .SQUARE(1)) u_d_sq (.clk(clk), .a(d_raw), .b(d_raw), .q(d_sq));

  reg signed  [XW-1:0] xy_sq;
  reg signed  [XW-1:0] s_raw;
  wire signed [XW-1:0] z_sq_at_xy_sq;
  ik_delay #(.W(XW), .N(T_XY_SQ - T_Z_SQ)) u_z_sq_at_xy_sq (.clk(clk), .d(z_sq), .q(z_sq_at_xy_sq));
  always @(posedge clk) begin
    xy_sq <= x_sq + y_sq;
    s_raw <= xy_sq + z_sq_at_xy_sq;
  end

  wire signed [XW-1:0] r_sq_at_s_raw, d_sq_at_s_raw;
  wire bad_length_at_s_raw;
  ik_delay #(.W(XW), .N(T_S_RAW - T_R_SQ)) u_r_sq_at_s_raw (.clk(clk), .d(r_sq), .q(r_sq_at_s_raw));
  ik_delay #(.W(XW), .N(T_S_RAW - T_D_SQ)) u_d_sq_at_s_raw (.clk(clk), .d(d_sq), .q(d_sq_at_s_raw));
  ik_delay #(.W(1), .N(T_S_RAW - T_BAD_LENGTH)) u_bad_length_at_s_raw (
      .clk(clk), .d(bad_length), .q(bad_length_at_s_raw)
  );
  always @(posedge clk) begin
    too_far  <= (s_raw > r_sq_at_s_raw) && !bad_length_at_s_raw;
    too_near <= (s_raw < d_sq_at_s_raw) && !bad_length_at_s_raw;
  end

  // ---- decisions for targets without an elbow ----

  wire bad_length_at_too_far, at_shoulder_at_too_far, d_raw_negative_at_too_far;
  ik_delay #(.W(3), .N(T_TOO_FAR - T_BAD_LENGTH)) u_d_raw_negative_at_too_far (
      .clk(clk), .d({bad_length, at_shoulder, d_raw[W]}),
      .q({bad_length_at_too_far, at_shoulder_at_too_far, d_raw_negative_at_too_far})
  );
  always @(posedge clk) begin
    clamp <= too_far || too_near || at_shoulder_at_too_far || bad_length_at_too_far;
    closed  <= (too_near || at_shoulder_at_too_far) && !bad_length_at_too_far;
    away  <= too_near && d_raw_negative_at_too_far;
  end

  // ---- the target in its own unit; at the shoulder, straight up is used ----

  wire [5:0] lz_p;
  // lz_p = leading_sign_bits(z, x, y)
  // p_w_x = x << lz_p
  // p_w_y = y << lz_p
  // p_w_z = z << lz_p
  ik_norm #(.W(W), .N(3)) u_norm_p (.clk(clk), .d({y, x, z}), .q({p_w_y, p_w_x, p_w_z}), .count(lz_p));

  // ---- its horizontal direction; on the axis, azimuth 0 is used ----

  wire [5:0] lz_b;
  // lz_b = leading_sign_bits(x, y)
  // b_x = x << lz_b
  // b_y = y << lz_b
  ik_norm #(.W(W), .N(2)) u_norm_b (.clk(clk), .d({y, x}), .q({b_y, b_x}), .count(lz_b));

  // ---- d1 and d2 scaled to d1 + d2 in [1/2, 1), and the target in the same unit ----

  wire [5:0] lz_r;
  wire r_empty;
  ik_lzc #(.W(W+1), .N(1)) u_lz_r (.clk(clk), .d(r_raw), .count(lz_r), .empty(r_empty));

  wire signed [W:0] x_x = {x[W-1], x};
  wire signed [W:0] y_x = {y[W-1], y};
  wire signed [W:0] z_x = {z[W-1], z};
  wire signed [W:0] d_1_sh, d_2_sh, p_a_x_sh, p_a_y_sh, p_a_z_sh;
  ik_shift #(.W(W+1), .PRODUCT(1), .DD(T_LZ_R)) u_d_1_sh (.clk(clk), .d(d1_x), .count(lz_r), .q(d_1_sh));
  ik_shift #(.W(W+1), .PRODUCT(1), .DD(T_LZ_R)) u_d_2_sh (.clk(clk), .d(d2_x), .count(lz_r), .q(d_2_sh));
  ik_shift #(.W(W+1), .PRODUCT(1), .DD(T_LZ_R)) u_p_a_x_sh (.clk(clk), .d(x_x), .count(lz_r), .q(p_a_x_sh));
  ik_shift #(.W(W+1), .PRODUCT(1), .DD(T_LZ_R)) u_p_a_y_sh (.clk(clk), .d(y_x), .count(lz_r), .q(p_a_y_sh));
  ik_shift #(.W(W+1), .PRODUCT(1), .DD(T_LZ_R)) u_p_a_z_sh (.clk(clk), .d(z_x), .count(lz_r), .q(p_a_z_sh));

  wire signed [W:0] d_1_sh_at_clamp, d_2_sh_at_clamp, p_a_x_sh_at_clamp, p_a_y_sh_at_clamp, p_a_z_sh_at_clamp;
  ik_delay #(.W(5*(W+1)), .N(T_CLAMP - T_D_1_SH)) u_d_1_sh_at_clamp (
      .clk(clk), .d({p_a_z_sh, p_a_y_sh, p_a_x_sh, d_2_sh, d_1_sh}),
      .q({p_a_z_sh_at_clamp, p_a_y_sh_at_clamp, p_a_x_sh_at_clamp, d_2_sh_at_clamp, d_1_sh_at_clamp})
  );

  // A bit is dropped only if d1 + d2 >= 2; ORing it in keeps the shortest length from becoming 0.
  localparam signed [W-1:0] QUARTER = {3'b001, {(W - 3) {1'b0}}};
  always @(posedge clk) begin
    d_1   <= clamp ? QUARTER : {d_1_sh_at_clamp[W:2], d_1_sh_at_clamp[1] | d_1_sh_at_clamp[0]};
    d_2   <= clamp ? QUARTER : {d_2_sh_at_clamp[W:2], d_2_sh_at_clamp[1] | d_2_sh_at_clamp[0]};
    p_a_x <= clamp ? {W{1'b0}} : {p_a_x_sh_at_clamp[W:2], p_a_x_sh_at_clamp[1] | p_a_x_sh_at_clamp[0]};
    p_a_y <= clamp ? {W{1'b0}} : {p_a_y_sh_at_clamp[W:2], p_a_y_sh_at_clamp[1] | p_a_y_sh_at_clamp[0]};
    p_a_z <= clamp ? {W{1'b0}} : {p_a_z_sh_at_clamp[W:2], p_a_z_sh_at_clamp[1] | p_a_z_sh_at_clamp[0]};
  end

  // ---- d1 - d2 in the target's unit, from the exact difference: rounded lengths could put a target close to the shoulder
  // out of reach ----

  wire signed [W:0] d_dif_sh, d_dif_sh_at_clamp;
  ik_shift #(.W(W+1), .PRODUCT(1), .DD(T_LZ_P - T_D_RAW)) u_d_dif_sh (.clk(clk), .d(d_raw), .count(lz_p), .q(d_dif_sh));
  ik_delay #(.W(W+1), .N(T_CLAMP - T_D_DIF_SH)) u_d_dif_sh_at_clamp (.clk(clk), .d(d_dif_sh), .q(d_dif_sh_at_clamp));
  always @(posedge clk) d_dif_j <= clamp ? {W{1'b0}} : d_dif_sh_at_clamp[W:1];

  // ---- ratio of the target's unit to the unit of d1 and d2 ----

  wire [5:0] lz_p_at_clamp, lz_r_at_clamp;
  ik_delay #(.W(6), .N(T_CLAMP - T_LZ_P)) u_lz_p_at_clamp (.clk(clk), .d(lz_p), .q(lz_p_at_clamp));
  ik_delay #(.W(6), .N(T_CLAMP - T_LZ_R)) u_lz_r_at_clamp (.clk(clk), .d(lz_r), .q(lz_r_at_clamp));
  always @(posedge clk) scale_j <= clamp ? 6'd2 : (lz_p_at_clamp - lz_r_at_clamp + 6'd1);

  wire unused = &{1'b0, lz_b, r_empty, d_dif_sh_at_clamp[0]};

endmodule

`default_nettype wire

// Squares of the input words and their sums, and the flags that follow from their signs.
// SPDX-License-Identifier: Apache-2.0
//
// Exact, no rounding; words of 2W + 2 bits, fraction bits in ik_lean_nodes.vh.
// The sums: rho^2, s = |p|^2, A = (d1 + d2)^2 - s, B = s - (d1 - d2)^2 and K = s + d1^2 - d2^2. The signs of A and B
// give too_far and too_near. Inputs at clock 0, each output at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_lean_guard #(
    parameter integer W    = 32,  // word length, 16 to 32
    parameter integer TILE = 18   // width of the multipliers' longer operand; sets the latency of roots
) (
    // Clock
    input  wire                  clk,
    // Target
    input  wire signed [  W-1:0] x,
    input  wire signed [  W-1:0] y,
    input  wire signed [  W-1:0] z,
    input  wire signed [  W-1:0] d1,
    input  wire signed [  W-1:0] d2,
    // Results
    output wire signed [2*W+1:0] rho_sq,       // T_RHO_SQ
    output wire signed [2*W+1:0] s,            // T_S
    output wire signed [2*W+1:0] a_far,        // T_A_FAR
    output wire signed [2*W+1:0] b_near,
    output wire signed [2*W+1:0] k_law,
    // Flags
    output reg                   bad_length,   // T_BAD_LENGTH
    output reg                   on_axis,      // T_ON_AXIS
    output reg                   at_shoulder,  // T_AT_SHOULDER
    output reg                   too_far,      // T_TOO_FAR
    output reg                   too_near,
    // Decisions
    output reg                   clamp,        // T_CLAMP
    output reg                   closed,
    output reg                   away
);

  `include "ik_lean_nodes.vh"

  localparam integer XW = 2 * W + 2;

  wire no_xy = (x == {W{1'b0}}) && (y == {W{1'b0}});
  always @(posedge clk) begin
    bad_length  <= d1[W-1] || (d1 == {W{1'b0}}) || d2[W-1] || (d2 == {W{1'b0}});
    on_axis     <= no_xy;
    at_shoulder <= no_xy && (z == {W{1'b0}});
  end

  // ---- sum and difference of the lengths, and squares ----

  reg signed [W:0] d_sum;
  reg signed [W:0] d_dif;
  always @(posedge clk) begin
    d_sum <= {d1[W-1], d1} + {d2[W-1], d2};
    d_dif <= {d1[W-1], d1} - {d2[W-1], d2};
  end
  // x, y and z are squared as W bits, not sign-extended: Yosys' xilinx_dsp loses bits of a product's register where an
  // operand has two equal sign bits. A square is not negative.
  wire signed [W-1:0] none = {W{1'b0}};
  wire signed [W:0] none_d = {(W + 1) {1'b0}};
  wire [2*W-1:0] x_sq_w, y_sq_w, z_sq_w;
  wire signed [XW-1:0] x_sq = {2'b00, x_sq_w};
  wire signed [XW-1:0] y_sq = {2'b00, y_sq_w};
  wire signed [XW-1:0] z_sq = {2'b00, z_sq_w};
  wire signed [XW-1:0] d_sum_sq;
  wire signed [XW-1:0] d_dif_sq;
  wire signed [XW-1:0] sum_dif;  // d1^2 - d2^2
  // x_sq = x^2
  ik_exact #(.W(W), .SQUARE(1)) u_x_sq (.clk(clk), .a(x), .b(none), .p(x_sq_w));
  // y_sq = y^2
  ik_exact #(.W(W), .SQUARE(1)) u_y_sq (.clk(clk), .a(y), .b(none), .p(y_sq_w));
  // z_sq = z^2
  ik_exact #(.W(W), .SQUARE(1)) u_z_sq (.clk(clk), .a(z), .b(none), .p(z_sq_w));
  // d_sum_sq = d_sum^2
  ik_exact #(.W(W+1), .SQUARE(1)) u_d_sum_sq (.clk(clk), .a(d_sum), .b(none_d), .p(d_sum_sq));
  // d_dif_sq = d_dif^2
  ik_exact #(.W(W+1), .SQUARE(1)) u_d_dif_sq (.clk(clk), .a(d_dif), .b(none_d), .p(d_dif_sq));
  // sum_dif = d_sum * d_dif
  ik_exact #(.W(W+1)) u_sum_dif (.clk(clk), .a(d_sum), .b(d_dif), .p(sum_dif));

  // ---- sums, each as soon as its terms are ready ----

  // rho_sq = x_sq + y_sq
  ik_wide #(.W(XW)) u_rho_sq (.clk(clk), .a(x_sq), .b(y_sq), .q(rho_sq));
  // s = rho_sq + z_sq
  ik_wide #(.W(XW), .DB(T_RHO_SQ-T_Z_SQ)) u_s (.clk(clk), .a(rho_sq), .b(z_sq), .q(s));
  // a_far = d_sum_sq - s
  ik_wide #(.W(XW), .SUB(1), .DA(T_S-T_D_SUM_SQ)) u_a_far (.clk(clk), .a(d_sum_sq), .b(s), .q(a_far));
  // b_near = s - d_dif_sq
  ik_wide #(.W(XW), .SUB(1), .DB(T_S-T_D_DIF_SQ)) u_b_near (.clk(clk), .a(s), .b(d_dif_sq), .q(b_near));
  // k_law = s + sum_dif
  ik_wide #(.W(XW), .DB(T_S-T_SUM_DIF)) u_k_law (.clk(clk), .a(s), .b(sum_dif), .q(k_law));

  // ---- flags ----

  wire bad_length_at_a_far, bad_length_at_too_far, at_shoulder_at_too_far;
  wire shorter_at_too_near;  // d1 < d2
  ik_delay #(.W(1), .N(T_A_FAR-T_BAD_LENGTH)) u_bad_length_at_a_far (
      .clk(clk), .d(bad_length), .q(bad_length_at_a_far)
  );
  ik_delay #(.W(1), .N(T_TOO_FAR-T_A_FAR)) u_bad_length_at_too_far (
      .clk(clk), .d(bad_length_at_a_far), .q(bad_length_at_too_far)
  );
  ik_delay #(.W(1), .N(T_TOO_FAR-T_AT_SHOULDER)) u_at_shoulder_at_too_far (
      .clk(clk), .d(at_shoulder), .q(at_shoulder_at_too_far)
  );
  ik_delay #(.W(1), .N(T_TOO_NEAR-T_D_DIF)) u_shorter_at_too_near (.clk(clk), .d(d_dif[W]), .q(shorter_at_too_near));
  always @(posedge clk) begin
    too_far  <= a_far[XW-1] && !bad_length_at_a_far;
    too_near <= b_near[XW-1] && !bad_length_at_a_far;
    // No elbow: the arm is straight or closed along the line to the target.
    clamp    <= too_far || too_near || at_shoulder_at_too_far || bad_length_at_too_far;
    closed     <= (too_near || at_shoulder_at_too_far) && !bad_length_at_too_far;
    away     <= too_near && shorter_at_too_near;
  end

endmodule

`default_nettype wire

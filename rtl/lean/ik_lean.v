// The lean dataflow: the problem of ik_paper, on the same ports, with two levels of reciprocal square roots.
// SPDX-License-Identifier: Apache-2.0
//
// Results Q2.(W-2), half up; inputs Q2.(W-2) and a binary angle; rounding and format of each node: ik_lean_nodes.vh.
// Each operator has the equation of its node above it, as in docs/generated/lean.md; signals without one are flags, aligned
// copies or intermediate terms. The pipeline has no enable, and only the valid bits and the pointers of ik_ring are
// reset; valid and tag travel with the data.
// Throughput: one target per clock.
//
// A signal named like a node holds it in the node's clock, T_<NODE>. Operators delay their own operands (DA, DB, ..:
// clocks). Operands that several operators share, or that inline logic needs, are delayed here: x_at_y is x in clock
// T_<Y>.
// Latency: T_OUT clocks.
`default_nettype none

module ik_lean #(
    parameter integer W     = 32,  // word length, 3 to 32, or 16 to 24 with TILE = 16; below 16 for tests only
    parameter integer TAG_W = 8,   // tag width, at least 1
    parameter integer TILE  = 18   // width of the multipliers' longer operand: 18, 25 or 16
) (
    // Clock
    input  wire             clk,
    input  wire             rst,        // synchronous: discards the targets in flight
    // Target
    input  wire             in_valid,
    input  wire [TAG_W-1:0] in_tag,
    input  wire [  6*W-1:0] in_data,    // x, y, z, phi, d1, d2, lowest bits first
    // Result
    output wire             out_valid,
    output wire [TAG_W-1:0] out_tag,
    output wire [      7:0] out_flags,  // too_far, too_near, on_axis, at_shoulder, bad_length, 0, 0, 0
    output wire [  6*W-1:0] out_data    // qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first
);

  `include "ik_lean_nodes.vh"

  generate
    if (W < ((TILE == 16) ? 16 : 3) || W > ((TILE == 16) ? 24 : 32)) begin : g_no_words
      ik_lean_illegal_W u_stop ();
    end
    if (TAG_W < 1) begin : g_no_tag
      ik_lean_illegal_TAG_W u_stop ();
    end
    if (TILE != 16 && TILE != 18 && TILE != 25) begin : g_no_tile
      ik_lean_illegal_TILE u_stop ();
    end
  endgenerate

  localparam integer N = FRAC + 2;  // width of an inner word

  // ---- valid and tag ----

  reg [T_OUT-1:0] valid;  // newest in bit 0
  always @(posedge clk) begin
    if (rst) valid <= {T_OUT{1'b0}};
    else valid <= {valid[T_OUT-2:0], in_valid};
  end
  assign out_valid = valid[T_OUT-1];

  ik_delay #(.W(TAG_W), .N(T_OUT)) u_tag (.clk(clk), .d(in_tag), .q(out_tag));

  // ---- exact squares and flags ----

  wire signed [W-1:0] x = in_data[0*W+:W];
  wire signed [W-1:0] y = in_data[1*W+:W];
  wire signed [W-1:0] z = in_data[2*W+:W];
  wire signed [W-1:0] phi = in_data[3*W+:W];
  wire signed [W-1:0] d1 = in_data[4*W+:W];
  wire signed [W-1:0] d2 = in_data[5*W+:W];

  wire signed [2*W+1:0] rho_sq, s, a_far, b_near, k_law;
  wire bad_length, on_axis, at_shoulder, too_far, too_near, clamp, closed, away;
  ik_lean_guard #(.W(W), .TILE(TILE)) u_guard (
      .clk(clk),
      .x(x), .y(y), .z(z), .d1(d1), .d2(d2),
      .rho_sq(rho_sq), .s(s), .a_far(a_far), .b_near(b_near), .k_law(k_law),
      .bad_length(bad_length), .on_axis(on_axis), .at_shoulder(at_shoulder), .too_far(too_far), .too_near(too_near),
      .clamp(clamp), .closed(closed), .away(away)
  );

  // ---- azimuth and elevation of the target ----

  wire [5:0] e_s;
  wire signed [N-1:0] inv_s, az_sq, az_c, az_s, tilt_sq, tilt_c, tilt_s;
  ik_lean_direction #(.W(W), .N(N), .TILE(TILE)) u_direction (
      .clk(clk),
      .x(x), .y(y), .z(z), .rho_sq(rho_sq), .s(s), .on_axis(on_axis), .at_shoulder(at_shoulder),
      .e_s(e_s), .inv_s(inv_s), .az_sq(az_sq), .az_c(az_c), .az_s(az_s), .tilt_sq(tilt_sq), .tilt_c(tilt_c), .tilt_s(tilt_s)
  );

  // ---- angle at the shoulder, elbow quaternion ----

  wire signed [W-1:0] qe_w, qe_i;
  wire bend_swap;
  wire signed [N-1:0] bend_sq, bend_c, bend_sum, bend_dif;
  ik_lean_triangle #(.W(W), .N(N), .TILE(TILE)) u_triangle (
      .clk(clk),
      .d1(d1), .d2(d2), .a_far(a_far), .b_near(b_near), .k_law(k_law), .e_s(e_s), .inv_s(inv_s),
      .clamp(clamp), .closed(closed), .away(away),
      .qe_w(qe_w), .qe_i(qe_i), .bend_sq(bend_sq), .bend_swap(bend_swap), .bend_c(bend_c), .bend_sum(bend_sum), .bend_dif(bend_dif)
  );

  // ---- shoulder quaternion ----

  wire signed [W-1:0] qs_w, qs_i, qs_j, qs_k;
  ik_lean_turn #(.W(W), .N(N), .TILE(TILE)) u_turn (
      .clk(clk),
      .phi(phi), .az_sq(az_sq), .az_c(az_c), .az_s(az_s), .tilt_sq(tilt_sq), .tilt_c(tilt_c), .tilt_s(tilt_s),
      .bend_sq(bend_sq), .bend_swap(bend_swap), .bend_c(bend_c), .bend_sum(bend_sum), .bend_dif(bend_dif),
      .qs_w(qs_w), .qs_i(qs_i), .qs_j(qs_j), .qs_k(qs_k)
  );

  // ---- align the results ----

  wire signed [W-1:0] qe_w_at_out, qe_i_at_out;
  ik_ring #(.W(2*W), .N(T_OUT-T_QE_W)) u_qe_at_out (
      .clk(clk), .rst(rst), .d({qe_i, qe_w}), .q({qe_i_at_out, qe_w_at_out})
  );
  assign out_data = {qe_i_at_out, qe_w_at_out, qs_k, qs_j, qs_i, qs_w};

  wire too_far_at_out, too_near_at_out, on_axis_at_out, at_shoulder_at_out, bad_length_at_out;
  ik_delay #(.W(2), .N(T_OUT-T_TOO_FAR)) u_too_at_out (
      .clk(clk), .d({too_near, too_far}), .q({too_near_at_out, too_far_at_out})
  );
  ik_delay #(.W(3), .N(T_OUT-T_ON_AXIS)) u_on_axis_at_out (
      .clk(clk), .d({bad_length, at_shoulder, on_axis}), .q({bad_length_at_out, at_shoulder_at_out, on_axis_at_out})
  );
  // No overflow flag: every node fits its word.
  assign out_flags = {3'b000, bad_length_at_out, at_shoulder_at_out, on_axis_at_out, too_near_at_out, too_far_at_out};

endmodule

`default_nettype wire

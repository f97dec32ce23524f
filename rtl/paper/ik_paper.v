// The paper's dataflow, equations (10) to (19).
// SPDX-License-Identifier: Apache-2.0
//
// Results Q2.(W-2); inputs Q2.(W-2) and a binary angle; rounding and format of each node: ik_paper_nodes.vh.
// The pipeline has no enable. Only the valid bits and the pointers of ik_ring are reset; valid and tag travel with the
// data.
//
// A signal named like a node holds it in the node's clock, T_<NODE>. Operators delay their own operands (DA, DB, ..:
// clocks). Operands that several operators share, or that inline logic needs, are delayed here: x_at_y is x in the
// clock of node y, or of the first node whose name begins with y.
// Throughput: one target per clock.
// Latency: T_OUT clocks.
`default_nettype none

module ik_paper #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer TAG_W = 8,   // tag width, at least 1
    parameter integer DIGIT = 0    // dividers and roots: 1 digit recurrence, 0 behavioural
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

  `include "ik_paper_nodes.vh"

  generate
    if (W < 16 || W > 32) begin : g_no_words
      ik_paper_illegal_W u_stop ();
    end
    if (TAG_W < 1) begin : g_no_tag
      ik_paper_illegal_TAG_W u_stop ();
    end
    if (DIGIT != 0 && DIGIT != 1) begin : g_no_cores
      ik_paper_illegal_DIGIT u_stop ();
    end
  endgenerate

  // ---- valid and tag ----

  reg [T_OUT-1:0] valid;  // newest in bit 0
  always @(posedge clk) begin
    if (rst) valid <= {T_OUT{1'b0}};
    else valid <= {valid[T_OUT-2:0], in_valid};
  end
  assign out_valid = valid[T_OUT-1];

  ik_delay #(.W(TAG_W), .N(T_OUT)) u_tag (.clk(clk), .d(in_tag), .q(out_tag));

  // ---- targets outside the equations' domain, scaling ----

  wire signed [W-1:0] x = in_data[0*W+:W];
  wire signed [W-1:0] y = in_data[1*W+:W];
  wire signed [W-1:0] z = in_data[2*W+:W];
  wire signed [W-1:0] phi = in_data[3*W+:W];
  wire signed [W-1:0] d1 = in_data[4*W+:W];
  wire signed [W-1:0] d2 = in_data[5*W+:W];

  wire signed [W-1:0] p_w_x, p_w_y, p_w_z, b_x, b_y, d_1, d_2, p_a_x, p_a_y, p_a_z;
  wire [5:0] scale_j;
  wire signed [W-1:0] d_dif_j;
  wire too_far, too_near, on_axis, at_shoulder, bad_length, clamp, closed, away;
  ik_guard #(.W(W)) u_guard (
      .clk(clk),
      .x(x), .y(y), .z(z), .d1(d1), .d2(d2),
      .p_w_x(p_w_x), .p_w_y(p_w_y), .p_w_z(p_w_z), .b_x(b_x), .b_y(b_y),
      .d_1(d_1), .d_2(d_2), .p_a_x(p_a_x), .p_a_y(p_a_y), .p_a_z(p_a_z), .scale_j(scale_j), .d_dif_j(d_dif_j),
      .too_far(too_far), .too_near(too_near), .on_axis(on_axis), .at_shoulder(at_shoulder), .bad_length(bad_length),
      .clamp(clamp), .closed(closed), .away(away)
  );

  // ---- 3.1 swivel plane ----

  wire signed [W-1:0] s, l_sw, pi_swivel_x, pi_swivel_y, pi_swivel_z;
  ik_swivel #(.W(W), .DIGIT(DIGIT)) u_swivel (
      .clk(clk), .rst(rst),
      .phi(phi), .p_w_x(p_w_x), .p_w_y(p_w_y), .p_w_z(p_w_z), .b_x(b_x), .b_y(b_y),
      .s(s), .l_sw(l_sw), .pi_swivel_x(pi_swivel_x), .pi_swivel_y(pi_swivel_y), .pi_swivel_z(pi_swivel_z)
  );

  // Align the target with its swivel plane; 3.2 and 3.5 use both.
  wire signed [W-1:0] p_w_x_at_pi_swivel, p_w_y_at_pi_swivel, p_w_z_at_pi_swivel;
  ik_ring #(.W(3*W), .N(T_PI_SWIVEL_X-T_P_W_X)) u_p_w_at_pi_swivel (
      .clk(clk), .rst(rst), .d({p_w_z, p_w_y, p_w_x}), .q({p_w_z_at_pi_swivel, p_w_y_at_pi_swivel, p_w_x_at_pi_swivel})
  );

  // ---- 3.2 elbow point ----

  wire signed [W-1:0] pp_1_m, pp_2_m, pp_3_m;
  wire flat, back;
  wire signed [W-1:0] p_e_x, p_e_y, p_e_z, d_e;
  ik_elbow #(.W(W), .DIGIT(DIGIT)) u_elbow (
      .clk(clk), .rst(rst),
      .d_1(d_1), .d_2(d_2), .scale_j(scale_j), .d_dif_j(d_dif_j), .clamp(clamp), .away(away), .s(s), .l_sw(l_sw),
      .pi_swivel_x(pi_swivel_x), .pi_swivel_y(pi_swivel_y), .pi_swivel_z(pi_swivel_z),
      .p_w_x_at_pi_swivel(p_w_x_at_pi_swivel), .p_w_y_at_pi_swivel(p_w_y_at_pi_swivel),
      .p_w_z_at_pi_swivel(p_w_z_at_pi_swivel),
      .pp_1_m(pp_1_m), .pp_2_m(pp_2_m), .pp_3_m(pp_3_m), .flat(flat), .back(back),
      .p_e_x(p_e_x), .p_e_y(p_e_y), .p_e_z(p_e_z), .d_e(d_e)
  );

  // ---- 3.3 elbow quaternion ----

  wire signed [W-1:0] qe_w, qe_i;
  ik_elbow_q #(.W(W), .DIGIT(DIGIT)) u_elbow_q (
      .clk(clk), .rst(rst),
      .d_1(d_1), .d_2(d_2), .p_a_x(p_a_x), .p_a_y(p_a_y), .p_a_z(p_a_z), .clamp(clamp), .closed(closed),
      .p_e_x(p_e_x), .p_e_y(p_e_y), .p_e_z(p_e_z),
      .qe_w(qe_w), .qe_i(qe_i)
  );

  // ---- 3.4 rotate to the elbow position ----

  wire signed [W-1:0] q12_i, q12_j, q12_k;
  ik_to_elbow #(.W(W), .DIGIT(DIGIT)) u_to_elbow (
      .clk(clk), .rst(rst),
      .d_e(d_e), .p_e_x(p_e_x), .p_e_y(p_e_y), .p_e_z(p_e_z),
      .q12_i(q12_i), .q12_j(q12_j), .q12_k(q12_k)
  );

  // ---- 3.5 rotate to the wrist location ----

  wire signed [W-1:0] qs_w, qs_i, qs_j, qs_k;
  ik_to_wrist #(.W(W), .DIGIT(DIGIT)) u_to_wrist (
      .clk(clk), .rst(rst),
      .pi_swivel_x(pi_swivel_x), .pi_swivel_y(pi_swivel_y), .pi_swivel_z(pi_swivel_z),
      .p_w_x_at_pi_swivel(p_w_x_at_pi_swivel), .p_w_y_at_pi_swivel(p_w_y_at_pi_swivel),
      .p_w_z_at_pi_swivel(p_w_z_at_pi_swivel),
      .pp_1_m(pp_1_m), .pp_2_m(pp_2_m), .pp_3_m(pp_3_m), .flat(flat), .back(back),
      .q12_i(q12_i), .q12_j(q12_j), .q12_k(q12_k),
      .qs_w(qs_w), .qs_i(qs_i), .qs_j(qs_j), .qs_k(qs_k)
  );

  // ---- align the results ----

  wire signed [W-1:0] qs_k_at_out, qe_w_at_out, qe_i_at_out;
  ik_delay #(.W(W), .N(T_OUT-T_QS_K)) u_qs_k_at_out (.clk(clk), .d(qs_k), .q(qs_k_at_out));
  ik_ring #(.W(W), .N(T_OUT-T_QE_W)) u_qe_w_at_out (.clk(clk), .rst(rst), .d(qe_w), .q(qe_w_at_out));
  ik_ring #(.W(W), .N(T_OUT-T_QE_I)) u_qe_i_at_out (.clk(clk), .rst(rst), .d(qe_i), .q(qe_i_at_out));
  assign out_data = {qe_i_at_out, qe_w_at_out, qs_k_at_out, qs_j, qs_i, qs_w};

  wire too_far_at_out, too_near_at_out, on_axis_at_out, at_shoulder_at_out, bad_length_at_out;
  wire on_axis_at_too_far, at_shoulder_at_too_far, bad_length_at_too_far;
  ik_delay #(.W(3), .N(T_TOO_FAR-T_ON_AXIS)) u_on_axis_at_too_far (
      .clk(clk), .d({bad_length, at_shoulder, on_axis}),
      .q({bad_length_at_too_far, at_shoulder_at_too_far, on_axis_at_too_far})
  );
  ik_ring #(.W(5), .N(T_OUT-T_TOO_FAR)) u_too_far_at_out (
      .clk(clk), .rst(rst), .d({bad_length_at_too_far, at_shoulder_at_too_far, on_axis_at_too_far, too_near, too_far}),
      .q({bad_length_at_out, at_shoulder_at_out, on_axis_at_out, too_near_at_out, too_far_at_out})
  );
  assign out_flags = {
    3'b000, bad_length_at_out, at_shoulder_at_out, on_axis_at_out, too_near_at_out, too_far_at_out
  };

endmodule

`default_nettype wire

// The whole arm with AXI4-Stream ports: hand pose in, seven joint angles out.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding here. Inputs: Q2.(W-2) and a binary angle; results: Q2.(W-2) and binary angles.
// As in ik_axis, ik_credit_fifo admits poses to the datapath and holds results.
//
// A pose is admitted only when a FIFO slot is free for its result, so the datapath never stalls and no result is lost,
// repeated or reordered. tready and tvalid do not depend on each other combinationally. The folded datapath has its own
// flow control and bypasses the FIFO.
// Throughput: one pose per clock; folded, one per PERIOD clocks (ik_fold_arm_program.vh).
// Latency: T_OUT (ik_arm_nodes.vh) plus 2 clocks in the FIFO; folded, see ik_fold_arm. With CHOOSE, T_CHOICE
// (ik_choose_nodes.vh) instead of T_OUT.
`default_nettype none

module ik_arm #(
    parameter integer W        = 32,  // word length, 16 to 32; at most 24 with TILE = 16
    parameter integer TAG_W    = 8,   // tag width, at least 1
    parameter integer DATAPATH = 1,   // 1 lean, 2 fold (on one multiplier): W even, 20 or more
    // multiplier blocks: 18 for 18x18 bits; 25 for 25x18, lean only; 16 for 16x16, and fold from W = 18
    parameter integer TILE     = 18,
    parameter integer CHOOSE   = 0,  // 1: of the eight branches, answer with the one nearest to reference joints
    // CHOOSE: words next to 0 and half a turn within which th2 and th6 count as singular, see ik_choose
    parameter integer EPS      = (W > 24) ? 8 : 16
) (
    // Clock; attributes for block designs of Vivado, which infers the streams from the ports' names
    (* X_INTERFACE_INFO = "xilinx.com:signal:clock:1.0 clk CLK" *)
    (* X_INTERFACE_PARAMETER = "ASSOCIATED_BUSIF s_axis:m_axis, ASSOCIATED_RESET rst" *)
    input  wire                clk,
    (* X_INTERFACE_INFO = "xilinx.com:signal:reset:1.0 rst RST" *)
    (* X_INTERFACE_PARAMETER = "POLARITY ACTIVE_HIGH" *)
    input  wire                rst,  // synchronous, active high: discards all poses
    // Lower and upper limit of th1, .. th7, lowest bits first: arcs from low upwards to high, one turn = 2^W; static
    input  wire [    14*W-1:0] limits,
    // Hand pose: hand_x, hand_y, hand_z, phi, d1, d2, tool, qh_w, qh_i, qh_j, qh_k, lowest bits first; Q2.(W-2), one turn
    // of phi = 2^W. Above the tag in tuser, lowest first: the branch of shoulder, elbow, wrist.
    // CHOOSE: above qh_k, reference joints 1 to 7; the branch is the one that equal steps prefer
    input  wire [(11+7*CHOOSE)*W-1:0] s_axis_tdata,
    input  wire [ TAG_W+3-1:0] s_axis_tuser,
    input  wire                s_axis_tvalid,
    output wire                s_axis_tready,
    // Result: th1 to th7, qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, qw_w, qw_i, qw_j, qw_k, lowest bits first; Q2.(W-2), one
    // turn of th = 2^W. Above the tag in tuser, lowest first: too_far, too_near, on_axis, at_shoulder, bad_length,
    // saturated, 0, 0, bad_hand, over_1 to over_7.
    // CHOOSE: th and over are the chosen branch's; above over_7, lowest first: this branch; its largest step from the
    // reference, 12 bits, one turn = 2^12; no branch is inside the limits; for n = 0 to 7, the given branch xor n is
    // inside them; singular
    output wire [    17*W-1:0] m_axis_tdata,
    output wire [TAG_W+16+25*CHOOSE-1:0] m_axis_tuser,
    output wire                m_axis_tvalid,
    input  wire                m_axis_tready
);

  `include "ik_arm_nodes.vh"
  `include "ik_choose_nodes.vh"

  localparam integer FLAGS_W = 16 + 25 * CHOOSE;

  // ---- reject unsupported parameters at elaboration ----

  // An illegal parameter value instantiates an undefined module, named after the parameter:
  //   ik_arm_illegal_TAG_W     1 or more
  //   ik_arm_illegal_DATAPATH  1 or 2
  //   ik_arm_illegal_TILE      16 or 18; 25 unless folded
  //   ik_arm_illegal_CHOOSE    0 or 1
  //   ik_arm_illegal_EPS       1 to 1024
  //   ik_arm_illegal_W         16 to 32, at most 24 with TILE = 16; folded: even, at least 20, or 18 with TILE = 16
  localparam TAG_OK = TAG_W >= 1;
  localparam DATAPATH_OK = DATAPATH == 1 || DATAPATH == 2;
  localparam TILE_OK = TILE == 16 || TILE == 18 || (TILE == 25 && DATAPATH != 2);
  localparam integer LEAST = (DATAPATH == 2) ? ((TILE == 16) ? 18 : 20) : 16;
  localparam W_OK = W >= LEAST && W <= ((TILE == 16) ? 24 : 32) && (DATAPATH != 2 || W % 2 == 0);
  localparam CHOOSE_OK = CHOOSE == 0 || CHOOSE == 1;
  localparam EPS_OK = EPS >= 1 && EPS <= 1024;
  localparam LEGAL = TAG_OK && DATAPATH_OK && TILE_OK && W_OK && CHOOSE_OK && EPS_OK;
  generate
    if (!TAG_OK) begin : g_no_tag
      ik_arm_illegal_TAG_W u_stop ();
    end
    if (!DATAPATH_OK) begin : g_no_datapath
      ik_arm_illegal_DATAPATH u_stop ();
    end
    if (!TILE_OK) begin : g_no_tile
      ik_arm_illegal_TILE u_stop ();
    end
    if (!CHOOSE_OK) begin : g_no_choice
      ik_arm_illegal_CHOOSE u_stop ();
    end
    if (!EPS_OK) begin : g_no_eps
      ik_arm_illegal_EPS u_stop ();
    end
    if (!W_OK) begin : g_no_words
      ik_arm_illegal_W u_stop ();
    end
  endgenerate

  // ---- the datapath ----

  wire admit;
  wire core_valid;
  wire [TAG_W-1:0] core_tag;
  wire [FLAGS_W-1:0] core_flags;
  wire [17*W-1:0] core_data;
  generate
    if (LEGAL && DATAPATH == 2) begin : g_fold
      ik_fold_arm #(
          .W     (W),
          .TAG_W (TAG_W),
          .TILE  (TILE),
          .CHOOSE(CHOOSE),
          .EPS   (EPS)
      ) u_core (
          .clk          (clk),
          .rst          (rst),
          .s_axis_tdata (s_axis_tdata),
          .s_axis_tuser (s_axis_tuser),
          .s_axis_tvalid(s_axis_tvalid),
          .s_axis_tready(s_axis_tready),
          .limits       (limits),
          .m_axis_tdata (m_axis_tdata),
          .m_axis_tuser (m_axis_tuser),
          .m_axis_tvalid(m_axis_tvalid),
          .m_axis_tready(m_axis_tready)
      );
    end
    if (LEGAL && DATAPATH == 1) begin : g_lean
      ik_lean_arm #(
          .W     (W),
          .TAG_W (TAG_W),
          .TILE  (TILE),
          .CHOOSE(CHOOSE),
          .EPS   (EPS)
      ) u_core (
          .clk      (clk),
          .rst      (rst),
          .limits   (limits),
          .in_valid (admit),
          .in_tag   (s_axis_tuser[TAG_W-1:0]),
          .in_branch(s_axis_tuser[TAG_W+:3]),
          .in_data  (s_axis_tdata),
          .out_valid(core_valid),
          .out_tag  (core_tag),
          .out_flags(core_flags),
          .out_data (core_data)
      );
    end
  endgenerate

  // ---- admission and output; the folded datapath has its own ----

  generate
    if (DATAPATH != 2) begin : g_fifo
      ik_credit_fifo #(
          .W      (17 * W + FLAGS_W + TAG_W),
          .LATENCY((CHOOSE != 0) ? T_CHOICE : T_OUT)
      ) u_credits (
          .clk    (clk),
          .rst    (rst),
          .s_valid(s_axis_tvalid),
          .s_ready(s_axis_tready),
          .admit  (admit),
          .wr_en  (core_valid),
          .wr_data({core_flags, core_tag, core_data}),
          .m_valid(m_axis_tvalid),
          .m_ready(m_axis_tready),
          .m_data ({m_axis_tuser, m_axis_tdata})
      );
    end
  endgenerate

endmodule

`default_nettype wire

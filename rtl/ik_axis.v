// The inverse kinematics core with AXI4-Stream ports: one datapath and its output FIFO.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding here. Inputs: Q2.(W-2) and a binary angle; results: Q2.(W-2).
// ik_credit_fifo admits targets to the datapath and holds results.
//
// A target is admitted only when a FIFO slot is free for its result, so the datapath never stalls and no result is
// lost, repeated or reordered. tready and tvalid do not depend on each other combinationally. The folded datapath has
// its own flow control and bypasses the FIFO.
// Throughput: one target per clock; folded, one per period of its program.
// Latency: datapath_latency (ik_latency.vh) plus 2 clocks in the FIFO; folded, see ik_fold.
`default_nettype none

module ik_axis #(
    parameter integer W        = 32,  // word length, 16 to 32; at most 24 with TILE = 16
    parameter integer TAG_W    = 8,   // tag width, at least 1
    parameter integer DATAPATH = 1,   // 0 paper, 1 lean, 2 fold (lean on one multiplier): W even, 20 or more
    parameter integer DIGIT    = 0,   // paper dividers and roots: 1 digit recurrence, 0 behavioural
    // multiplier blocks of lean and fold: 18 for 18x18 bits; 25 for 25x18, lean only; 16 for 16x16, with smaller tables
    // and fold from W = 18
    parameter integer TILE     = 18
) (
    // Clock; attributes for block designs of Vivado, which infers the streams from the ports' names
    (* X_INTERFACE_INFO = "xilinx.com:signal:clock:1.0 clk CLK" *)
    (* X_INTERFACE_PARAMETER = "ASSOCIATED_BUSIF s_axis:m_axis, ASSOCIATED_RESET rst" *)
    input  wire               clk,
    (* X_INTERFACE_INFO = "xilinx.com:signal:reset:1.0 rst RST" *)
    (* X_INTERFACE_PARAMETER = "POLARITY ACTIVE_HIGH" *)
    input  wire               rst,  // synchronous, active high: discards all targets
    // Target: x, y, z, phi, d1, d2, lowest bits first; Q2.(W-2), phi one turn = 2^W
    input  wire [    6*W-1:0] s_axis_tdata,
    input  wire [  TAG_W-1:0] s_axis_tuser,
    input  wire               s_axis_tvalid,
    output wire               s_axis_tready,
    // Result: qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first; Q2.(W-2). Above the tag in tuser, lowest first:
    // too_far, too_near, on_axis, at_shoulder, bad_length, 0, 0, 0
    output wire [    6*W-1:0] m_axis_tdata,
    output wire [TAG_W+8-1:0] m_axis_tuser,
    output wire               m_axis_tvalid,
    input  wire               m_axis_tready
);

  `include "ik_latency.vh"

  // ---- reject unsupported parameters at elaboration ----

  // An illegal parameter value instantiates an undefined module, named after the parameter:
  //   ik_axis_illegal_TAG_W     1 or more
  //   ik_axis_illegal_DATAPATH  0, 1 or 2
  //   ik_axis_illegal_DIGIT     0 or 1
  //   ik_axis_illegal_TILE      16 or 18; 25 unless folded
  //   ik_axis_illegal_W         16 to 32, at most 24 with TILE = 16; folded: even, at least 20, or 18 with TILE = 16
  localparam TAG_OK = TAG_W >= 1;
  localparam DATAPATH_OK = DATAPATH >= 0 && DATAPATH <= 2;
  localparam DIGIT_OK = DIGIT == 0 || DIGIT == 1;
  localparam TILE_OK = TILE == 16 || TILE == 18 || (TILE == 25 && DATAPATH != 2);
  localparam integer LEAST = (DATAPATH == 2) ? ((TILE == 16) ? 18 : 20) : 16;
  localparam W_OK = W >= LEAST && W <= ((TILE == 16) ? 24 : 32) && (DATAPATH != 2 || W % 2 == 0);
  localparam LEGAL = TAG_OK && DATAPATH_OK && DIGIT_OK && TILE_OK && W_OK;
  generate
    if (!TAG_OK) begin : g_no_tag
      ik_axis_illegal_TAG_W u_stop ();
    end
    if (!DATAPATH_OK) begin : g_no_datapath
      ik_axis_illegal_DATAPATH u_stop ();
    end
    if (!DIGIT_OK) begin : g_no_cores
      ik_axis_illegal_DIGIT u_stop ();
    end
    if (!TILE_OK) begin : g_no_tile
      ik_axis_illegal_TILE u_stop ();
    end
    if (!W_OK) begin : g_no_words
      ik_axis_illegal_W u_stop ();
    end
  endgenerate

  // ---- the datapath ----

  wire admit;
  wire core_valid;
  wire [TAG_W-1:0] core_tag;
  wire [7:0] core_flags;
  wire [6*W-1:0] core_data;
  generate
    if (LEGAL && DATAPATH == 2) begin : g_fold
      ik_fold #(
          .W    (W),
          .TAG_W(TAG_W),
          .TILE (TILE)
      ) u_core (
          .clk          (clk),
          .rst          (rst),
          .s_axis_tdata (s_axis_tdata),
          .s_axis_tuser (s_axis_tuser),
          .s_axis_tvalid(s_axis_tvalid),
          .s_axis_tready(s_axis_tready),
          .m_axis_tdata (m_axis_tdata),
          .m_axis_tuser (m_axis_tuser),
          .m_axis_tvalid(m_axis_tvalid),
          .m_axis_tready(m_axis_tready)
      );
    end
    if (LEGAL && DATAPATH == 1) begin : g_lean
      ik_lean #(
          .W    (W),
          .TAG_W(TAG_W),
          .TILE (TILE)
      ) u_core (
          .clk      (clk),
          .rst      (rst),
          .in_valid (admit),
          .in_tag   (s_axis_tuser),
          .in_data  (s_axis_tdata),
          .out_valid(core_valid),
          .out_tag  (core_tag),
          .out_flags(core_flags),
          .out_data (core_data)
      );
    end
    if (LEGAL && DATAPATH == 0) begin : g_paper
      ik_paper #(
          .W    (W),
          .TAG_W(TAG_W),
          .DIGIT(DIGIT)
      ) u_core (
          .clk      (clk),
          .rst      (rst),
          .in_valid (admit),
          .in_tag   (s_axis_tuser),
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
          .W      (6 * W + 8 + TAG_W),
          .LATENCY(datapath_latency(DATAPATH, W, TILE))
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

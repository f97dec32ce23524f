// ik_arm with streams of whole bytes, which vendors' packagers require.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding here. Words as in ik_arm, each in the lowest bits of the next multiple of 8 bits.
// A hand pose has 11*B bits of tdata (18*B with CHOOSE), a result 17*B, B = 8*ceil(W/8). The padding of a pose is
// ignored; results are sign-extended. Everything else is as in ik_arm; if W is a multiple of 8, so are the streams.
`default_nettype none

module ik_arm_bytes #(
    parameter integer W        = 32,  // parameters of ik_arm
    parameter integer TAG_W    = 8,
    parameter integer DATAPATH = 1,
    parameter integer TILE     = 18,
    parameter integer CHOOSE   = 0,
    parameter integer EPS      = (W > 24) ? 8 : 16
) (
    // Clock; attributes as in ik_arm
    (* X_INTERFACE_INFO = "xilinx.com:signal:clock:1.0 clk CLK" *)
    (* X_INTERFACE_PARAMETER = "ASSOCIATED_BUSIF s_axis:m_axis, ASSOCIATED_RESET rst" *)
    input  wire                                  clk,
    (* X_INTERFACE_INFO = "xilinx.com:signal:reset:1.0 rst RST" *)
    (* X_INTERFACE_PARAMETER = "POLARITY ACTIVE_HIGH" *)
    input  wire                                  rst,  // synchronous, active high: discards all poses
    input  wire [                      14*W-1:0] limits,  // not padded
    // Hand pose: hand_x to qh_k, with CHOOSE also reference joints, lowest bits first; the branch above the tag in tuser
    input  wire [(11+7*CHOOSE)*8*((W+7)/8)-1:0]  s_axis_tdata,
    input  wire [                   TAG_W+3-1:0] s_axis_tuser,
    input  wire                                  s_axis_tvalid,
    output wire                                  s_axis_tready,
    // Result: th1 to qw_k, lowest bits first; flags, and with CHOOSE the choice, above the tag in tuser
    output wire [              17*8*((W+7)/8)-1:0] m_axis_tdata,
    output wire [         TAG_W+16+25*CHOOSE-1:0] m_axis_tuser,
    output wire                                  m_axis_tvalid,
    input  wire                                  m_axis_tready
);

  localparam integer B = 8 * ((W + 7) / 8);  // bits of a padded word
  localparam integer INPUTS = 11 + 7 * CHOOSE;
  wire [INPUTS*W-1:0] pose;
  wire [17*W-1:0] result;

  genvar k;
  generate
    for (k = 0; k < INPUTS; k = k + 1) begin : g_input
      assign pose[W*k+:W] = s_axis_tdata[B*k+:W];
    end
    for (k = 0; k < 17; k = k + 1) begin : g_result
      assign m_axis_tdata[B*k+:B] = {{(B - W + 1) {result[W*k+W-1]}}, result[W*k+:W-1]};
    end
  endgenerate

  ik_arm #(
      .W       (W),
      .TAG_W   (TAG_W),
      .DATAPATH(DATAPATH),
      .TILE    (TILE),
      .CHOOSE  (CHOOSE),
      .EPS     (EPS)
  ) u_arm (
      .clk          (clk),
      .rst          (rst),
      .limits       (limits),
      .s_axis_tdata (pose),
      .s_axis_tuser (s_axis_tuser),
      .s_axis_tvalid(s_axis_tvalid),
      .s_axis_tready(s_axis_tready),
      .m_axis_tdata (result),
      .m_axis_tuser (m_axis_tuser),
      .m_axis_tvalid(m_axis_tvalid),
      .m_axis_tready(m_axis_tready)
  );

endmodule

`default_nettype wire

// ik_axis with streams of whole bytes, which vendors' packagers require.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding here. Words as in ik_axis, each in the lowest bits of the next multiple of 8 bits.
// tdata has 6*B bits, B = 8*ceil(W/8), which is 144 at W = 18. The padding of a target is ignored; results are
// sign-extended. Everything else is as in ik_axis; if W is a multiple of 8, the streams are the same too.
`default_nettype none

module ik_axis_bytes #(
    parameter integer W        = 32,  // parameters of ik_axis
    parameter integer TAG_W    = 8,
    parameter integer DATAPATH = 1,
    parameter integer DIGIT    = 0,
    parameter integer TILE     = 18
) (
    // Clock; attributes as in ik_axis
    (* X_INTERFACE_INFO = "xilinx.com:signal:clock:1.0 clk CLK" *)
    (* X_INTERFACE_PARAMETER = "ASSOCIATED_BUSIF s_axis:m_axis, ASSOCIATED_RESET rst" *)
    input  wire                    clk,
    (* X_INTERFACE_INFO = "xilinx.com:signal:reset:1.0 rst RST" *)
    (* X_INTERFACE_PARAMETER = "POLARITY ACTIVE_HIGH" *)
    input  wire                    rst,  // synchronous, active high: discards all targets
    // Target: x, y, z, phi, d1, d2, lowest bits first
    input  wire [48*((W+7)/8)-1:0] s_axis_tdata,
    input  wire [       TAG_W-1:0] s_axis_tuser,
    input  wire                    s_axis_tvalid,
    output wire                    s_axis_tready,
    // Result: qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first; flags above the tag in tuser
    output wire [48*((W+7)/8)-1:0] m_axis_tdata,
    output wire [     TAG_W+8-1:0] m_axis_tuser,
    output wire                    m_axis_tvalid,
    input  wire                    m_axis_tready
);

  localparam integer B = 8 * ((W + 7) / 8);  // bits of a padded word
  wire [6*W-1:0] target, result;

  genvar k;
  generate
    for (k = 0; k < 6; k = k + 1) begin : g_word
      assign target[W*k+:W] = s_axis_tdata[B*k+:W];
      assign m_axis_tdata[B*k+:B] = {{(B - W + 1) {result[W*k+W-1]}}, result[W*k+:W-1]};
    end
  endgenerate

  ik_axis #(
      .W       (W),
      .TAG_W   (TAG_W),
      .DATAPATH(DATAPATH),
      .DIGIT   (DIGIT),
      .TILE    (TILE)
  ) u_axis (
      .clk          (clk),
      .rst          (rst),
      .s_axis_tdata (target),
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

// Inputs Q2.22 and a binary angle, results Q2.22, as bytes of a serial line; no rounding outside the core.
// SPDX-License-Identifier: Apache-2.0
//
// Core with the fold datapath on an iCEBreaker (iCE40 UP5K); targets and answers are serial frames:
//   target: A5, tag, x, y, z, phi, d1, d2 (3 bytes each, little endian), CRC-16    22 bytes
//   answer: 5A, tag, flags, qs_w, qs_i, qs_j, qs_k, qe_w, qe_i likewise, CRC-16    23 bytes
// With ARM = 1 the folded whole arm, hand poses and joint angles; words as in ik_arm:
//   pose:   A5, tag, branch, 11 words, CRC-16                                      38 bytes
//   answer: 5A, tag, flags (2 bytes), 17 words, CRC-16                             57 bytes
// The button resets.  Green LED: out of reset; red LED: the last frame was dropped.
// Two targets may be in flight: one answer is sent while the next is computed.
`default_nettype none

module icebreaker #(
    parameter integer CLOCK      = 24000000,  // PLL output, Hz
    parameter integer BAUD       = 1000000,
    parameter integer LOG2_QUIET = 16,        // log2 of the pause that drops a frame, clocks
    parameter integer ARM        = 0,         // 1: ik_arm instead of ik_axis
    parameter [335:0] LIMITS     = {7{24'h7FFFFF, 24'h800000}}  // of th1 to th7 as in ik_arm; default: none
) (
    input  wire CLK,     // 12 MHz
    input  wire BTN_N,
    input  wire RX,
    output wire TX,
    output wire LEDG_N,
    output wire LEDR_N
);

  // ---- clock and reset ----

  wire clk, locked;
  SB_PLL40_PAD #(  // 12 MHz * 64 / 32
      .FEEDBACK_PATH("SIMPLE"),
      .DIVR(4'd0),
      .DIVF(7'd63),
      .DIVQ(3'd5),
      .FILTER_RANGE(3'd1)
  ) u_pll (
      .PACKAGEPIN(CLK), .PLLOUTGLOBAL(clk), .LOCK(locked), .RESETB(1'b1), .BYPASS(1'b0)
  );

  reg [1:0] button;  // synchronizer: the pin is asynchronous
  reg [3:0] up;      // clocks since the reset cause ended
  initial begin
    button = 2'b00;
    up = 4'd0;
  end
  wire rst = !(&up);
  always @(posedge clk) begin
    button <= {button[0], BTN_N};
    if (!button[1] || !locked) up <= 4'd0;
    else if (rst) up <= up + 4'd1;
  end

  // ---- in, core, out ----

  localparam integer BIT = CLOCK / BAUD;
  localparam integer W = 24;

  wire [7:0] rx_data, tx_data;
  wire rx_valid, rx_bad, tx_valid, tx_ready;
  uart_rx #(.BIT(BIT)) u_uart_rx (.clk(clk), .rst(rst), .rx(RX), .data(rx_data), .valid(rx_valid), .bad(rx_bad));
  uart_tx #(.BIT(BIT)) u_uart_tx (.clk(clk), .rst(rst), .data(tx_data), .valid(tx_valid), .ready(tx_ready), .tx(TX));

  localparam integer ASKED = (ARM == 1) ? 2 + 33 : 1 + 18;  // bytes of tag, branch, words
  localparam integer TOLD = (ARM == 1) ? 3 + 51 : 2 + 18;   // bytes of tag, flags, words
  wire [8*ASKED-1:0] target;
  wire [8*TOLD-1:0] answer;
  wire offered, taken, dropped, answered, sent;
  frame_rx #(.BYTES(ASKED), .LOG2_QUIET(LOG2_QUIET)) u_frame_rx (
      .clk(clk), .rst(rst), .data(rx_data), .valid(rx_valid), .bad(rx_bad),
      .frame(target), .offered(offered), .taken(offered && taken), .dropped(dropped)
  );
  generate
    if (ARM == 1) begin : g_arm
      wire unused = &{1'b0, target[15:11]};
      ik_arm #(.W(W), .DATAPATH(2), .TILE(16)) u_core (
          .clk(clk), .rst(rst), .limits(LIMITS),
          .s_axis_tdata(target[8*ASKED-1:16]), .s_axis_tuser(target[10:0]),
          .s_axis_tvalid(offered), .s_axis_tready(taken),
          .m_axis_tdata(answer[8*TOLD-1:24]), .m_axis_tuser(answer[23:0]),
          .m_axis_tvalid(answered), .m_axis_tready(sent)
      );
    end else begin : g_axis
      ik_axis #(.W(W), .DATAPATH(2), .TILE(16)) u_core (
          .clk(clk), .rst(rst),
          .s_axis_tdata(target[8*ASKED-1:8]), .s_axis_tuser(target[7:0]),
          .s_axis_tvalid(offered), .s_axis_tready(taken),
          .m_axis_tdata(answer[8*TOLD-1:16]), .m_axis_tuser(answer[15:0]),
          .m_axis_tvalid(answered), .m_axis_tready(sent)
      );
    end
  endgenerate
  frame_tx #(.BYTES(TOLD)) u_frame_tx (
      .clk(clk), .rst(rst), .frame(answer), .offered(answered), .taken(sent),
      .data(tx_data), .valid(tx_valid), .ready(tx_ready)
  );

  // ---- LEDs, active low ----

  reg red;
  always @(posedge clk) red <= !rst && (dropped || (red && !offered));
  assign LEDG_N = rst;
  assign LEDR_N = !red;

endmodule

`default_nettype wire

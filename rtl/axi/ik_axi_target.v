// Rounds half up to W bits: lengths from Q2.30, saturated; phi (one turn = 2^32) wraps.
// SPDX-License-Identifier: Apache-2.0
//
// Unpacks a record of 32 bytes into a target of ik_axis. Words, lowest first: x, y, z, phi, d1, d2, tag, unused.
// Throughput: one record per clock.
// Latency: 1 clock.
`default_nettype none

module ik_axi_target #(
    parameter integer W     = 32,  // word length, 16 to 32
    parameter integer TAG_W = 24   // tag bits kept
) (
    input  wire             clk,
    input  wire             rst,
    input  wire             record_valid,
    input  wire [    255:0] record,
    output reg              target_valid,
    output reg  [  6*W-1:0] target,
    output reg  [TAG_W-1:0] tag
);

  localparam integer PHI = 3;  // index of phi among the words

  wire [6*W-1:0] rounded;
  genvar i;
  generate
    for (i = 0; i < 6; i = i + 1) begin : g_word
      if (W == 32) begin : g_whole
        assign rounded[W*i+:W] = record[32*i+:32];
      end else begin : g_round
        wire [W-1:0] kept = record[32*i+32-W+:W];
        wire [W-1:0] up = kept + {{(W - 1) {1'b0}}, record[32*i+31-W]};
        wire over = (i != PHI) && up[W-1] && !kept[W-1];  // rounding up overflowed
        assign rounded[W*i+:W] = over ? {1'b0, {(W - 1) {1'b1}}} : up;
      end
    end
  endgenerate

  always @(posedge clk) begin
    target_valid <= record_valid && !rst;
    target <= rounded;
    tag <= record[192+:TAG_W];
  end

endmodule

`default_nettype wire

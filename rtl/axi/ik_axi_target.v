// Unpacks a record into a target of ik_axis or a hand pose of ik_arm.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up to W bits: lengths and parts of a quaternion from Q2.30, saturated; phi (one turn = 2^32) wraps.
// Words, lowest first: with 32 bytes x, y, z, phi, d1, d2, tag, unused; with 64 bytes x, y, z, phi, d1, d2, tool, tag
// with the branch above it, qh_w, qh_i, qh_j, qh_k, 4 unused.
// Throughput: one record per clock.
// Latency: 1 clock.
`default_nettype none

module ik_axi_target #(
    parameter integer W           = 32,  // word length, 16 to 32
    parameter integer TAG_W       = 24,  // bits of the tag's word that are kept
    parameter integer LOG2_RECORD = 5    // log2 of a record's bytes: 5 target, 6 hand pose
) (
    input  wire                                 clk,
    input  wire                                 rst,
    input  wire                                 record_valid,
    input  wire [         (8<<LOG2_RECORD)-1:0] record,
    output reg                                  target_valid,
    output reg  [((LOG2_RECORD==6)?11:6)*W-1:0] target,
    output reg  [                    TAG_W-1:0] tag
);

  localparam integer WORDS = (LOG2_RECORD == 6) ? 11 : 6;
  localparam integer PHI = 3;  // index of phi among the words
  localparam integer TAG = (LOG2_RECORD == 6) ? 7 : 6;  // index of the tag in the record

  wire [WORDS*W-1:0] rounded;
  genvar i;
  generate
    for (i = 0; i < WORDS; i = i + 1) begin : g_word
      wire [31:0] word = record[32*((i<TAG)?i:i+1)+:32];
      if (W == 32) begin : g_whole
        assign rounded[W*i+:W] = word;
      end else begin : g_round
        wire [W-1:0] kept = word[31-:W];
        wire [W-1:0] up = kept + {{(W - 1) {1'b0}}, word[31-W]};
        wire over = (i != PHI) && up[W-1] && !kept[W-1];  // rounding up overflowed
        assign rounded[W*i+:W] = over ? {1'b0, {(W - 1) {1'b1}}} : up;
      end
    end
  endgenerate

  always @(posedge clk) begin
    target_valid <= record_valid && !rst;
    target <= rounded;
    tag <= record[32*TAG+:TAG_W];
  end

endmodule

`default_nettype wire

// Packs a result of ik_axis or ik_arm into a record, which leaves in beats.
// SPDX-License-Identifier: Apache-2.0
//
// Exact: words of W bits are shifted left to 32, Q2.30 and one turn = 2^32; beats leave lowest first.
// Words, lowest first: with 32 bytes qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, {flags, tag} (8 and 24 bits), index; with 64
// bytes th1 to th7, {flags, tag}, qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, index, over_limit. A record is accepted while
// `allowed` is high and all earlier beats have left or leave in this clock, so beats follow each other without a gap.
// wvalid does not wait for wready.
// Throughput: one beat per clock.
// Latency: 1 clock to the first beat.
`default_nettype none

module ik_axi_result #(
    parameter integer W           = 32,  // word length, 16 to 32
    parameter integer DATA_W      = 64,  // data bus width: 32, 64 or 128
    parameter integer LOG2_RECORD = 5    // log2 of a record's bytes: 5 ik_axis, 6 ik_arm
) (
    input  wire                                 clk,
    input  wire                                 rst,
    // Results
    input  wire [((LOG2_RECORD==6)?13:6)*W-1:0] result,
    input  wire [                         31:0] flags_tag,
    input  wire [                         31:0] index,
    input  wire [                         31:0] over_limit,    // of ik_arm
    input  wire                                 result_valid,
    output wire                                 result_ready,
    input  wire                                 allowed,       // the next record belongs to an announced burst
    input  wire                                 ends_burst,    // and is that burst's last
    // AXI4
    output wire [                   DATA_W-1:0] m_axi_wdata,
    output wire                                 m_axi_wlast,
    output reg                                  m_axi_wvalid,
    input  wire                                 m_axi_wready
);

  localparam integer WORDS = (LOG2_RECORD == 6) ? 13 : 6;
  localparam integer TAG = (LOG2_RECORD == 6) ? 7 : 6;  // index of {flags, tag} in the record
  localparam integer BITS = 8 << LOG2_RECORD;
  localparam integer B = LOG2_RECORD - 2;  // width of a beat's number within a record
  localparam integer LAST = BITS / DATA_W - 1;
  localparam [B-1:0] LAST_BEAT = LAST[B-1:0];

  wire [BITS-1:0] words;
  assign words[32*TAG+:32] = flags_tag;
  assign words[32*(WORDS+1)+:32] = index;
  genvar i;
  generate
    for (i = 0; i < WORDS; i = i + 1) begin : g_word
      if (W == 32) begin : g_whole
        assign words[32*((i<TAG)?i:i+1)+:32] = result[W*i+:W];
      end else begin : g_shift
        assign words[32*((i<TAG)?i:i+1)+:32] = {result[W*i+:W], {(32 - W) {1'b0}}};
      end
    end
    if (LOG2_RECORD == 6) begin : g_over
      assign words[480+:32] = over_limit;
    end
  endgenerate

  reg [BITS-1:0] record;
  reg [B-1:0] beat;
  reg ends;
  wire gone = m_axi_wvalid && m_axi_wready;
  wire room = !m_axi_wvalid || (gone && beat == LAST_BEAT);
  assign result_ready = room && allowed;

  initial m_axi_wvalid = 1'b0;

  always @(posedge clk) begin
    if (room) begin
      record <= words;
      ends   <= ends_burst;
      beat   <= {B{1'b0}};
    end else if (gone) begin
      record <= {{DATA_W{1'b0}}, record[BITS-1:DATA_W]};
      beat   <= beat + 1'b1;
    end
    if (rst) m_axi_wvalid <= 1'b0;
    else if (room) m_axi_wvalid <= result_valid && allowed;
  end

  assign m_axi_wdata = record[DATA_W-1:0];
  assign m_axi_wlast = ends && beat == LAST_BEAT;

endmodule

`default_nettype wire

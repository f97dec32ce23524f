// Exact: Q2.(W-2) results are shifted left to Q2.30; records leave in beats of DATA_W bits, lowest first.
// SPDX-License-Identifier: Apache-2.0
//
// Packs a result of ik_axis into a record of 32 bytes. Words, lowest first: qs_w, qs_i, qs_j, qs_k, qe_w, qe_i,
// {flags, tag} (8 and 24 bits), index. A record is accepted while `allowed` is high and all earlier beats have left or
// leave in this clock, so beats follow each other without a gap. wvalid does not wait for wready.
// Throughput: one beat per clock.
// Latency: 1 clock to the first beat.
`default_nettype none

module ik_axi_result #(
    parameter integer W      = 32,  // word length, 16 to 32
    parameter integer DATA_W = 64   // data bus width: 32, 64 or 128
) (
    input  wire              clk,
    input  wire              rst,
    // Results
    input  wire [   6*W-1:0] result,
    input  wire [      31:0] flags_tag,
    input  wire [      31:0] index,
    input  wire              result_valid,
    output wire              result_ready,
    input  wire              allowed,       // the next record belongs to an announced burst
    input  wire              ends_burst,    // and is that burst's last
    // AXI4
    output wire [DATA_W-1:0] m_axi_wdata,
    output wire              m_axi_wlast,
    output reg               m_axi_wvalid,
    input  wire              m_axi_wready
);

  localparam [2:0] LAST_BEAT = (DATA_W == 32) ? 3'd7 : (DATA_W == 64) ? 3'd3 : 3'd1;  // of a record, from 0

  wire [191:0] words;
  genvar i;
  generate
    for (i = 0; i < 6; i = i + 1) begin : g_word
      if (W == 32) begin : g_whole
        assign words[32*i+:32] = result[W*i+:W];
      end else begin : g_shift
        assign words[32*i+:32] = {result[W*i+:W], {(32 - W) {1'b0}}};
      end
    end
  endgenerate

  reg [255:0] record;
  reg [2:0] beat;
  reg ends;
  wire gone = m_axi_wvalid && m_axi_wready;
  wire room = !m_axi_wvalid || (gone && beat == LAST_BEAT);
  assign result_ready = room && allowed;

  initial m_axi_wvalid = 1'b0;

  always @(posedge clk) begin
    if (room) begin
      record <= {index, flags_tag, words};
      ends   <= ends_burst;
      beat   <= 3'd0;
    end else if (gone) begin
      record <= {{DATA_W{1'b0}}, record[255:DATA_W]};
      beat   <= beat + 3'd1;
    end
    if (rst) m_axi_wvalid <= 1'b0;
    else if (room) m_axi_wvalid <= result_valid && allowed;
  end

  assign m_axi_wdata = record[DATA_W-1:0];
  assign m_axi_wlast = ends && beat == LAST_BEAT;

endmodule

`default_nettype wire

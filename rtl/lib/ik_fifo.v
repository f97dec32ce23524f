// A first-word-fall-through FIFO of 2^LOG2 words behind a register.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, any format.
// There is no full flag: the writer reserves a slot beforehand (see ik_credit_fifo). Memory and output register are not
// reset; m_valid is, and it is initially 0.
// Throughput: one word per clock.
// Latency: 2 clocks from write to m_valid.
`default_nettype none

module ik_fifo #(
    parameter integer W    = 32,  // width of a word
    parameter integer LOG2 = 9    // log2 of the depth
) (
    input  wire         clk,
    input  wire         rst,      // synchronous: empties the FIFO
    // Write
    input  wire         wr_en,
    input  wire [W-1:0] wr_data,
    // Read
    output reg          m_valid,
    input  wire         m_ready,
    output reg  [W-1:0] m_data
);

  // A write and a read use the same address only while the FIFO is empty; the word read is then ignored.
  (* no_rw_check *)
  reg [W-1:0] mem[0:(1<<LOG2)-1];
  reg [LOG2:0] wr_ptr;  // one bit more than an address, to distinguish full from empty
  reg [LOG2:0] rd_ptr;
  wire empty = (wr_ptr == rd_ptr);
  wire load = !m_valid || m_ready;

  initial m_valid = 1'b0;

  always @(posedge clk) begin
    if (wr_en) mem[wr_ptr[LOG2-1:0]] <= wr_data;
    if (load) m_data <= mem[rd_ptr[LOG2-1:0]];
  end

  always @(posedge clk) begin
    if (rst) begin
      wr_ptr  <= {(LOG2 + 1) {1'b0}};
      rd_ptr  <= {(LOG2 + 1) {1'b0}};
      m_valid <= 1'b0;
    end else begin
      if (wr_en) wr_ptr <= wr_ptr + 1'b1;
      if (load) begin
        m_valid <= !empty;
        if (!empty) rd_ptr <= rd_ptr + 1'b1;
      end
    end
  end

endmodule

`default_nettype wire

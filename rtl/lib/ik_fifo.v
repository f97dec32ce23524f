// No rounding, any format: a first-word-fall-through FIFO of 2^LOG2 words behind a register.
// SPDX-License-Identifier: Apache-2.0
//
// There is no full flag: whoever writes has reserved the place before (see ik_axis). Memory and output register are not
// reset; m_valid is, and it is 0 before the first clock.
// Latency: a word written in one clock is offered two clocks later.
`default_nettype none

module ik_fifo #(
    parameter integer W    = 32,  // width of a word
    parameter integer LOG2 = 9    // log2 of the depth
) (
    input  wire         clk,
    input  wire         rst,      // synchronous: empties the FIFO
    input  wire         wr_en,
    input  wire [W-1:0] wr_data,
    output reg          m_valid,
    input  wire         m_ready,
    output reg  [W-1:0] m_data
);

  // Written and read address are the same only where the FIFO is empty, and what is read is not looked at.
  (* no_rw_check *)
  reg [W-1:0] mem[0:(1<<LOG2)-1];
  reg [LOG2:0] wr_ptr;  // one bit more than an address tells full from empty
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

// Output FIFO of a pipeline that cannot stall, with credits that admit a target only if its result has a free slot.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, any format.
// Contract with the pipeline between `admit` and `wr_en`:
//   - a target enters it in each clock with admit = s_valid && s_ready, and in no other;
//   - its result is written exactly LATENCY clocks later, unless rst comes first: rst discards all targets in it.
// Then no result is lost, repeated or reordered, and s_ready and m_valid depend on neither s_valid nor m_ready
// combinationally. s_ready is low under rst.
// Throughput: one target per clock, as the slots cover the pipeline, the FIFO and its output register.
// Latency: 2 clocks from wr_en to m_valid.
`default_nettype none

module ik_credit_fifo #(
    parameter integer W       = 32,  // width of a result
    parameter integer LATENCY = 44   // clocks of the pipeline
) (
    input  wire         clk,
    input  wire         rst,      // synchronous: discards all results
    // Admission
    input  wire         s_valid,
    output wire         s_ready,
    output wire         admit,
    // Result of the pipeline
    input  wire         wr_en,
    input  wire [W-1:0] wr_data,
    // Output
    output wire         m_valid,
    input  wire         m_ready,
    output wire [W-1:0] m_data
);

  function integer clog2(input integer n);
    begin
      clog2 = 0;
      while ((1 << clog2) < n) clog2 = clog2 + 1;
    end
  endfunction

  // A slot is reserved from admission until the result leaves: pipeline, FIFO, output register.
  localparam integer LOG2 = clog2(LATENCY + 3);

  wire leave = m_valid && m_ready;
  reg [LOG2:0] credits;  // unreserved FIFO slots
  always @(posedge clk) begin
    if (rst) credits <= {1'b1, {LOG2{1'b0}}};
    else if (admit && !leave) credits <= credits - 1'b1;
    else if (leave && !admit) credits <= credits + 1'b1;
  end
  assign s_ready = !rst && (credits != 0);
  assign admit   = s_valid && s_ready;

  ik_fifo #(
      .W   (W),
      .LOG2(LOG2)
  ) u_fifo (
      .clk    (clk),
      .rst    (rst),
      .wr_en  (wr_en),
      .wr_data(wr_data),
      .m_valid(m_valid),
      .m_ready(m_ready),
      .m_data (m_data)
  );

endmodule

`default_nettype wire

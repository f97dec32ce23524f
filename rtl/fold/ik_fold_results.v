// Collects the words of a result of ik_fold, with its flags and tag, at the output stream.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; words Q2.(W-2).
// A word is written in a clock with go and writing high; `result` selects its place. Flags and tag are written with the
// first word.
// Latency: 1 clock.
`default_nettype none

module ik_fold_results #(
    parameter integer W     = 24,  // word length
    parameter integer TAG_W = 8    // tag width
) (
    input  wire               clk,
    input  wire               go,
    // Target
    input  wire               accept,        // a target is taken
    input  wire [  TAG_W-1:0] s_axis_tuser,
    // Step
    input  wire               writing,
    input  wire               first_result,
    input  wire [        2:0] result,
    input  wire [      W-1:0] answer,        // the word
    input  wire [        7:0] flags,
    // Result
    output reg  [    6*W-1:0] m_axis_tdata,  // qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first
    output reg  [TAG_W+8-1:0] m_axis_tuser   // tag; above it the flags
);

  `include "ik_fold_codes.vh"

  reg [TAG_W-1:0] tag;  // of the target taken last
  always @(posedge clk) begin
    if (accept) tag <= s_axis_tuser;
    if (go && writing) begin
      if (first_result) m_axis_tuser <= {flags, tag};
      case (result)
        RESULT_QS_W: m_axis_tdata[0*W+:W] <= answer;
        RESULT_QS_I: m_axis_tdata[1*W+:W] <= answer;
        RESULT_QS_J: m_axis_tdata[2*W+:W] <= answer;
        RESULT_QS_K: m_axis_tdata[3*W+:W] <= answer;
        RESULT_QE_W: m_axis_tdata[4*W+:W] <= answer;
        RESULT_QE_I: m_axis_tdata[5*W+:W] <= answer;
        default: ;
      endcase
    end
  end

endmodule

`default_nettype wire

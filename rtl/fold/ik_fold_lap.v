// Follows the targets of a folded datapath through laps of its program, and drives the handshakes of both streams.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; single bits.
// A target present when a lap begins is loaded in this lap, and accepted at the step with `last_input`. Its results
// begin and end at the steps with `first_result` and `last_result`, FIRST_LAP and LAST_LAP laps later. If an earlier
// result still waits at the step with `hold`, HOLD_LAP laps later, the datapath stops as a whole, `go` low, until that
// result leaves. Without a target the datapath waits in the first step of a lap.
// s_ready and m_valid depend on neither s_valid nor m_ready combinationally.
// Latency: 0 clocks from the step to waits, restart and writing.
`default_nettype none

module ik_fold_lap #(
    parameter integer HOLD_LAP  = 0,  // laps from a target's loading to its step `hold`: 0 or 1
    parameter integer FIRST_LAP = 1,  // to its first result: 0 or 1
    parameter integer LAST_LAP  = 1   // to its last one: 0 to 2
) (
    input  wire clk,
    input  wire rst,           // synchronous: discards all targets
    // Current step
    input  wire begins,        // the first of a lap
    input  wire last,          // the last
    input  wire last_input,    // the step's fields of these names
    input  wire hold,
    input  wire first_result,
    input  wire last_result,
    // Streams
    input  wire s_valid,
    output wire s_ready,
    output reg  m_valid,
    input  wire m_ready,
    // Control of the datapath
    output reg  go,
    output wire waits,         // no target: stay in the first step
    output wire restart,       // the last target's results are complete: begin a lap
    output wire writing        // results of a target are written
);

  // The target of the current lap, the previous one, or the one before is in progress.
  reg current, previous, earlier;
  wire occupied = begins ? s_valid : current;  // the current lap has a target
  wire oldest = (LAST_LAP == 2) ? earlier : previous;  // the target whose results end in this lap
  wire younger = occupied || (LAST_LAP == 2 && previous);
  assign waits   = begins && !occupied && !previous && !earlier;
  assign restart = last_result && oldest && !younger;

  wire holding = (HOLD_LAP != 0) ? previous : occupied;  // `hold` concerns a target
  wire answered = (FIRST_LAP != 0) ? previous : occupied;  // so does `first_result`
  reg begun;  // first_result has been, last_result has not
  assign writing = first_result ? answered : begun;

  wire full = m_valid && !m_ready;
  // Accept no target and write no word before the first reset.
  initial go = 1'b0;
  initial m_valid = 1'b0;
  always @(posedge clk)
    if (rst) begin
      go       <= 1'b1;
      current  <= 1'b0;
      previous <= 1'b0;
      earlier  <= 1'b0;
      begun    <= 1'b0;
      m_valid  <= 1'b0;
    end else begin
      go <= !full || (go && !(hold && holding));
      if (go) begin
        current <= occupied && !last;
        if (last) begin
          previous <= (LAST_LAP != 0) && occupied;
          earlier  <= (LAST_LAP == 2) && previous;
        end else if (last_result) begin
          earlier <= 1'b0;
          if (LAST_LAP != 2) previous <= 1'b0;
        end
        begun <= writing && !last_result;
      end
      if (go && last_result && writing) m_valid <= 1'b1;
      else if (m_ready) m_valid <= 1'b0;
    end
  // `current`, not `occupied`: s_ready must not depend on s_valid
  assign s_ready = go && current && last_input && !rst;

endmodule

`default_nettype wire

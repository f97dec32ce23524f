// Fetches the steps of a folded datapath's program, one after another, lap after lap.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; a step has STEP_W bits, its number CLOCK_W bits.
// The register behind the program's memory is outside: it gets step `fetched` in each clock with `load`. From it the
// step moves into `step`. With REGISTERS = 1 it is `step`, for small chips, where another register costs logic cells;
// then step NONE, numbered with all ones, must do nothing, and after the first clock of a reset `step` may be any step:
// `no_step` is high there.
// Throughput: one step per clock with go high, waits low.
// Latency: REGISTERS clocks from fetched to step.
`default_nettype none

module ik_fold_fetch #(
    parameter integer STEP_W = 88,  // bits of a step
    parameter integer CLOCK_W = 7,  // bits of a step's number
    parameter [CLOCK_W-1:0] END = 87,  // number of a lap's last step
    parameter integer REGISTERS = 2,  // 1 or 2 from the program's memory to the step
    parameter integer EARLY = 0  // 1: registers for begins and last, found a clock before
) (
    input  wire               clk,
    input  wire               rst,           // synchronous: no step until the lap begins
    // Control
    input  wire               go,
    input  wire               waits,         // keep the current step
    input  wire               restart,       // fetch the first step next
    // Memory of the program
    output reg  [CLOCK_W-1:0] fetched,
    output wire               load,
    input  wire [ STEP_W-1:0] fetched_step,  // the memory's register
    // Current step
    output wire [ STEP_W-1:0] step,
    output reg  [CLOCK_W-1:0] clock,         // its number
    output wire               begins,        // it is the first of the lap
    output wire               last,          // it is the last
    output wire               no_step        // it is none, and must write nothing
);

  localparam [CLOCK_W-1:0] NONE = {CLOCK_W{1'b1}};

  reg [CLOCK_W-1:0] read;  // number of the step in the memory's register
  wire [CLOCK_W-1:0] next = (REGISTERS == 1) ? fetched : read;  // number that follows `clock`
  wire moves = go && !waits;
  always @(posedge clk) begin
    if (rst) begin  // no valid step number until the first step arrives
      read  <= NONE;
      clock <= NONE;
    end
    if (rst) fetched <= (REGISTERS == 1) ? NONE : {CLOCK_W{1'b0}};
    else if (go && (restart || (!waits && fetched == END))) fetched <= {CLOCK_W{1'b0}};
    else if (moves) fetched <= fetched + 1'b1;
    if (moves && !rst) begin
      read  <= fetched;
      clock <= next;
    end
  end

  generate
    if (REGISTERS == 1) begin : g_step
      initial {fetched, read} = {NONE, NONE};
      assign load = rst || moves;
      assign step = fetched_step;
      assign no_step = fetched[CLOCK_W-1:CLOCK_W-2] == 2'b11;
    end else begin : g_steps
      reg [STEP_W-1:0] this_step;
      initial this_step = 0;
      always @(posedge clk) begin
        if (rst || read == NONE) this_step <= {STEP_W{1'b0}};  // fetched_step holds no step yet
        else if (moves) this_step <= fetched_step;
      end
      assign load = moves;
      assign step = this_step;
      assign no_step = 1'b0;
    end
    if (EARLY != 0) begin : g_early
      reg begins_next, last_next;
      always @(posedge clk) begin
        if (rst) {begins_next, last_next} <= 2'b00;
        else if (moves) begin
          begins_next <= next == {CLOCK_W{1'b0}};
          last_next   <= next == END;
        end
      end
      assign begins = begins_next;
      assign last   = last_next;
    end else begin : g_compared
      assign begins = clock == {CLOCK_W{1'b0}};
      assign last   = clock == END;
    end
  endgenerate

endmodule

`default_nettype wire

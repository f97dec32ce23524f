// SPDX-License-Identifier: Apache-2.0
// Appended to ik_fifo: words leave as written, in order, for any receiver and reset.
//
// One assumption about an input: the writer has reserved a slot (f_contract). ik_axis.vh proves this for ik_axis.
// f_contract limits the words counted at the ports; within_places limits the words in memory and output register.
// No register is constrained: the state before the first reset is arbitrary, and a reset may occur at any time.

`include "ik_fifo_port.vh"

localparam [LOG2:0] PLACES = {1'b1, {LOG2{1'b0}}};

reg f_on = 1'b0;  // since the first reset
reg f_reset;      // rst in the previous clock
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

// ---- ghost: words written and left since the reset, modulo 2 PLACES ----

wire leave = m_valid && m_ready;
reg [LOG2:0] f_written;
reg [LOG2:0] f_left;
wire [LOG2:0] f_inside = f_written - f_left;
always @(posedge clk) begin
  f_written <= rst ? {(LOG2 + 1) {1'b0}} : f_written + {{LOG2{1'b0}}, wr_en};
  f_left <= rst ? {(LOG2 + 1) {1'b0}} : f_left + {{LOG2{1'b0}}, leave};
end

always @* f_contract : assume (!f_on || !wr_en || f_inside < PLACES);

// ---- ghost: one arbitrary word, followed from its writing to its departure ----

(* anyseq *) wire f_pick;
reg f_taken;           // a word was picked since the reset
reg f_done;            // it has left
reg [LOG2:0] f_ahead;  // words that must leave before it
reg [LOG2:0] f_index;  // number of words written before it
reg [W-1:0] f_data;
wire f_take = wr_en && f_pick && !f_taken;
wire f_due = f_taken && !f_done && (f_ahead == 0);
always @(posedge clk) begin
  if (rst) begin
    f_taken <= 1'b0;
    f_done  <= 1'b0;
  end else begin
    if (f_take) begin
      f_taken <= 1'b1;
      f_index <= f_written;
      f_ahead <= f_inside - {{LOG2{1'b0}}, leave};
      f_data  <= wr_data;
    end
    if (leave && f_taken && !f_done) begin
      f_ahead <= f_ahead - 1'b1;
      f_done  <= f_due;
    end
  end
end

// ---- properties ----

wire [LOG2:0] f_in_mem = wr_ptr - rd_ptr;
wire [LOG2+1:0] f_held_words = {1'b0, f_in_mem} + {{(LOG2 + 1) {1'b0}}, m_valid};  // in memory and output register

reg f_stall;  // in the previous clock, a word was offered and not accepted
reg [W-1:0] f_held;
reg f_waited;  // in the previous clock, a word was inside and none was offered
always @(posedge clk) begin
  f_stall  <= m_valid && !m_ready && !rst;
  f_held   <= m_data;
  f_waited <= !rst && !m_valid && (f_inside != 0);
end

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || !m_valid);
  stable : assert (!f_stall || (m_valid && m_data == f_held));
  in_order : assert (!(f_due && m_valid) || m_data == f_data);
  nothing_invented : assert (!m_valid || f_inside != 0);
  within_places : assert (f_held_words <= {1'b0, PLACES});
  // no word is read at the address that is written: its value would depend on the kind of memory
  read_apart : assert (!wr_en || !load || empty || wr_ptr[LOG2-1:0] != rd_ptr[LOG2-1:0]);
  // a word is offered after one clock at most, for any receiver
  no_deadlock : assert (!f_waited || m_valid);
end

// ---- helping invariants, asserted as well ----

wire [LOG2:0] f_depth = f_index - rd_ptr;
wire f_is_in_mem = f_depth < f_in_mem;
wire f_is_out = m_valid && (f_index + 1'b1 == rd_ptr);
assign f_addr = f_index[LOG2-1:0];

always @* if (f_on) begin
  counted : assert (f_inside <= PLACES);  // follows from f_contract alone
  count_written : assert (wr_ptr == f_written);
  count_left : assert (rd_ptr - {{LOG2{1'b0}}, m_valid} == f_left);
  memory_fits : assert (f_in_mem <= PLACES);
  stall_inside : assert (!f_waited || f_inside != 0);
  done_was_taken : assert (!f_done || f_taken);
  if (f_taken && !f_done) begin
    ahead : assert (f_ahead == f_index - f_left);
    ahead_inside : assert (f_ahead < f_inside);
    somewhere : assert (f_is_in_mem || f_is_out);
    kept_in_memory : assert (!f_is_in_mem || f_word == f_data);
    kept_in_register : assert (!f_is_out || m_data == f_data);
  end
end

// ---- covers ----

reg f_wrapped;
always @(posedge clk) f_wrapped <= !rst && (f_wrapped || (wr_en && (&wr_ptr)));

always @* if (f_on && !rst) begin
  full : cover (f_inside == PLACES);
  full_then_one_leaves : cover (f_inside == PLACES && leave);
  write_and_leave : cover (wr_en && leave && f_inside != 0);
  followed_word_leaves : cover (f_due && leave);
  stalled : cover (f_stall && m_valid);
  pointers_wrapped : cover (f_wrapped && leave);
end

`ifdef IK_COVER
// A single path, so that the search has no choices: the FIFO fills up, then words leave and enter.
reg f_go = 1'b0;
always @(posedge clk) f_go <= f_on && (f_go || f_inside == PLACES);
always @* begin
  assume (rst == !f_on);
  assume (wr_en == (f_inside < PLACES) && m_ready == f_go && wr_data == 0);
end
`endif

// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axis or ik_arm, with their real credits and FIFO and the abstract pipeline of ik_core.v. Results leave
// in the order of the targets, each once, for any sender, receiver and reset. No assumptions: every input is free in
// every clock, and so is the state before the first reset.
//
// Counts are modulo 2 PLACES. A: targets admitted; D: results that left the pipeline; L: results that left the core.

`ifdef IK_ARM
localparam integer T = T_OUT;
`else
localparam integer T = datapath_latency(DATAPATH, W, TILE);
`endif
localparam integer DATA = `IK_OUT * W;
localparam integer RESULT = DATA + `IK_FLAGS;
localparam integer LOG2 = $clog2(T + 3);  // as in ik_credit_fifo
localparam integer K = LOG2 + 1;
localparam [K-1:0] T_K = T;
localparam [LOG2:0] PLACES = {1'b1, {LOG2{1'b0}}};

// signals of the instances, connected by name when the hierarchy is flattened
`ifdef IK_IS_LEAN
(* hierconn *) wire [T-1:0] \g_lean.u_core.valid ;
(* hierconn *) wire [T-1:0] \g_lean.u_core.mark ;
(* hierconn *) wire \g_lean.u_core.take ;
(* hierconn *) wire \g_lean.u_core.taken ;
(* hierconn *) wire [TAG_W-1:0] \g_lean.u_core.tag ;
(* hierconn *) wire [RESULT-1:0] \g_lean.u_core.f_result ;
wire [T-1:0] f_valid = \g_lean.u_core.valid ;
wire [T-1:0] f_mark = \g_lean.u_core.mark ;
wire f_take = \g_lean.u_core.take ;
wire f_taken = \g_lean.u_core.taken ;
wire [TAG_W-1:0] f_core_tag = \g_lean.u_core.tag ;
wire [RESULT-1:0] f_result = \g_lean.u_core.f_result ;
`else
(* hierconn *) wire [T-1:0] \g_paper.u_core.valid ;
(* hierconn *) wire [T-1:0] \g_paper.u_core.mark ;
(* hierconn *) wire \g_paper.u_core.take ;
(* hierconn *) wire \g_paper.u_core.taken ;
(* hierconn *) wire [TAG_W-1:0] \g_paper.u_core.tag ;
(* hierconn *) wire [RESULT-1:0] \g_paper.u_core.f_result ;
wire [T-1:0] f_valid = \g_paper.u_core.valid ;
wire [T-1:0] f_mark = \g_paper.u_core.mark ;
wire f_take = \g_paper.u_core.take ;
wire f_taken = \g_paper.u_core.taken ;
wire [TAG_W-1:0] f_core_tag = \g_paper.u_core.tag ;
wire [RESULT-1:0] f_result = \g_paper.u_core.f_result ;
`endif
(* hierconn *) wire [LOG2:0] \g_fifo.u_credits.credits ;
(* hierconn *) wire [LOG2:0] \g_fifo.u_credits.u_fifo.wr_ptr ;
(* hierconn *) wire [LOG2:0] \g_fifo.u_credits.u_fifo.rd_ptr ;
(* hierconn *) wire [LOG2-1:0] \g_fifo.u_credits.u_fifo.f_addr ;
(* hierconn *) wire [RESULT+TAG_W-1:0] \g_fifo.u_credits.u_fifo.f_word ;
wire [LOG2:0] f_wr_ptr = \g_fifo.u_credits.u_fifo.wr_ptr ;
wire [LOG2:0] f_rd_ptr = \g_fifo.u_credits.u_fifo.rd_ptr ;

reg f_on = 1'b0;  // since the first reset
reg f_reset;      // rst in the previous clock
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

// ---- ghost: counts at the ports ----

wire f_admit = s_axis_tvalid && s_axis_tready;
wire f_leave = m_axis_tvalid && m_axis_tready;

reg [K-1:0] f_A;
reg [K-1:0] f_D;
reg [K-1:0] f_L;
wire [K-1:0] f_total = f_A - f_L;
always @(posedge clk) begin
  f_A <= rst ? {K{1'b0}} : f_A + {{LOG2{1'b0}}, f_admit};
  f_D <= rst ? {K{1'b0}} : f_D + {{LOG2{1'b0}}, core_valid};
  f_L <= rst ? {K{1'b0}} : f_L + {{LOG2{1'b0}}, f_leave};
end

// ---- ghost: one arbitrary target, followed ----

reg f_done;            // its result has left
reg [K-1:0] f_ahead;   // results that must leave before its result
reg [K-1:0] f_index;   // number of targets admitted before it
reg [TAG_W-1:0] f_tag; // its tag at the input
wire f_due = f_taken && !f_done && (f_ahead == 0);
always @(posedge clk) begin
  if (rst) f_done <= 1'b0;
  else if (f_take) begin
    f_done  <= 1'b0;
    f_index <= f_A;
    f_ahead <= f_total - {{LOG2{1'b0}}, f_leave};
    f_tag   <= s_axis_tuser[TAG_W-1:0];
  end else if (f_leave && f_taken && !f_done) begin
    f_ahead <= f_ahead - 1'b1;
    f_done  <= f_due;
  end
end
wire [RESULT+TAG_W-1:0] f_expected = {f_result[RESULT-1:DATA], f_tag, f_result[DATA-1:0]};

// ---- ghost: clocks waited, in thermometer code ----

reg [T:0] f_quiet;   // bit i: for i+1 clocks a target was inside and no result offered
reg [T+1:0] f_shut;  // bit i: for i+1 clocks the receiver was ready and no target could enter
reg f_never_stalled;  // since the reset, the receiver has accepted every offer at once
always @(posedge clk) begin
  f_quiet <= (rst || m_axis_tvalid || f_total == 0) ? {(T + 1) {1'b0}} : {f_quiet[T-1:0], 1'b1};
  f_shut <= (rst || s_axis_tready || !m_axis_tready) ? {(T + 2) {1'b0}} : {f_shut[T:0], 1'b1};
  f_never_stalled <= rst || (f_never_stalled && (m_axis_tready || !m_axis_tvalid));
end

// ---- properties ----

// f_inside: targets in the pipeline, as rows_counts and last_row prove, in the FIFO's memory and its output register
wire [K-1:0] f_flight = f_A - f_D;
wire [K-1:0] f_in_mem = f_wr_ptr - f_rd_ptr;
wire [K+1:0] f_inside = {2'b00, f_flight} + {2'b00, f_in_mem} + {{(K + 1) {1'b0}}, m_axis_tvalid};

reg f_stall;
reg [RESULT+TAG_W-1:0] f_held;
always @(posedge clk) begin
  f_stall <= m_axis_tvalid && !m_axis_tready && !rst;
  f_held  <= {m_axis_tuser, m_axis_tdata};
end

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || !m_axis_tvalid);
  stable : assert (!f_stall || (m_axis_tvalid && {m_axis_tuser, m_axis_tdata} == f_held));
  in_order : assert (!(f_due && m_axis_tvalid) || {m_axis_tuser, m_axis_tdata} == f_expected);
  nothing_invented : assert (!m_axis_tvalid || f_total != 0);
  within_places : assert (f_inside <= {2'b00, PLACES});
  place_for_every_write : assert (!core_valid || f_D - f_L < PLACES);  // f_contract of ik_fifo.vh
  ready_when_places : assert (s_axis_tready == (!rst && f_total < PLACES));
  // no deadlock: if a target is inside, a result is offered after at most T+1 clocks, whatever m_axis_tready is; if the
  // receiver stays ready, s_axis_tready is high after at most T+2 clocks
  offered_in_time : assert (!f_quiet[T] || m_axis_tvalid);
  ready_in_time : assert (!f_shut[T+1] || s_axis_tready || rst);
  // one target can enter in every clock as long as the receiver has never stalled
  full_rate : assert (!f_never_stalled || rst || s_axis_tready);
end

// ---- helping invariants, asserted as well ----

// f_count, row i: targets admitted up to and including the one in stage i. A valid bit is the difference of two rows.
reg [K*T-1:0] f_count;
always @(posedge clk) begin
  if (rst) f_count <= {(K * T) {1'b0}};
  else f_count <= {f_count[K*(T-1)-1:0], f_A + {{LOG2{1'b0}}, f_admit}};
end
wire [T-1:0] f_row_counts;
wire [T-1:0] f_row_bound;
wire [T-1:0] f_row_mark;
wire [T-1:0] f_row_alone;
wire [T-1:0] f_marked_below;  // a stage below i holds the mark
wire [T-1:0] f_later;         // stage i or a later one holds a target
wire [T-1:0] f_row_quiet;
wire [T-1:0] f_row_below;
wire [T-1:0] f_row_above;     // stages above i hold at most T-1-i targets
wire [T-1:0] f_row_above_if;  // f_row_above of row i+1 implies f_row_above of row i
wire [T-1:0] f_row_waiting;   // at most T-1 targets are before the marked one
wire [T-1:0] f_below;         // a stage below i holds a target
wire f_in_fifo = (f_D != f_L);
genvar gi;
generate
  for (gi = 0; gi < T; gi = gi + 1) begin : g_row
    localparam [K-1:0] I = gi;
    wire [K-1:0] c = f_count[K*gi+:K];
    if (gi == 0) begin : g_first
      assign f_row_counts[gi] = (c == f_A);
      assign f_marked_below[gi] = 1'b0;
      assign f_below[gi] = 1'b0;
    end else begin : g_next
      assign f_row_counts[gi] = (f_count[K*(gi-1)+:K] == c + {{LOG2{1'b0}}, f_valid[gi-1]});
      assign f_marked_below[gi] = f_marked_below[gi-1] || f_mark[gi-1];
      assign f_below[gi] = f_below[gi-1] || f_valid[gi-1];
    end
    if (gi == T - 1) begin : g_last
      assign f_later[gi] = f_valid[gi];
      assign f_row_quiet[gi] = !f_quiet[gi] || f_in_fifo;
      assign f_row_above_if[gi] = f_row_above[gi];
    end else begin : g_before
      assign f_later[gi] = f_valid[gi] || f_later[gi+1];
      assign f_row_quiet[gi] = !f_quiet[gi] || f_later[gi+1] || f_in_fifo;
      assign f_row_above_if[gi] = f_row_above[gi] || !f_row_above[gi+1];
    end
    assign f_row_bound[gi] = (f_A - c <= I);
    assign f_row_mark[gi] = !f_mark[gi] || (f_valid[gi] && f_taken && c == f_index + 1'b1);
    assign f_row_alone[gi] = !f_mark[gi] || !f_marked_below[gi];
    assign f_row_above[gi] = (c - f_D - {{LOG2{1'b0}}, f_valid[gi]} <= T_K - 1'b1 - I);
    assign f_row_waiting[gi] = !f_mark[gi] || f_index - f_D < T_K;
    assign f_row_below[gi] = (f_below[gi] == (f_A != c));
  end
endgenerate

// Rows are checked in slices, so that a question is small at any pipeline length.
localparam integer SLICE = 16;
generate
  for (gi = 0; gi < T; gi = gi + SLICE) begin : g_slice
    localparam integer N = (T - gi < SLICE) ? (T - gi) : SLICE;
    ik_rows u (
        .on(f_on), .counts(&f_row_counts[gi+:N]), .bound(&f_row_bound[gi+:N]), .below(&f_row_below[gi+:N]),
        .mark(&f_row_mark[gi+:N]), .alone(&f_row_alone[gi+:N]), .quiet(&f_row_quiet[gi+:N]),
        .above_if(&f_row_above_if[gi+:N]), .above(&f_row_above[gi+:N]), .waiting(&f_row_waiting[gi+:N])
    );
  end
endgenerate

reg f_stored;  // the followed result has left the pipeline
always @(posedge clk) begin
  if (rst) f_stored <= 1'b0;
  else if (f_mark[T-1]) f_stored <= 1'b1;
end

wire [K-1:0] f_depth = f_index - f_rd_ptr;
wire f_is_in_mem = f_depth < f_in_mem;
wire f_is_out = m_axis_tvalid && (f_index + 1'b1 == f_rd_ptr);
assign \g_fifo.u_credits.u_fifo.f_addr = f_index[LOG2-1:0];

always @* if (f_on) begin
  not_yet_stored : assert (!f_taken || f_stored || f_index - f_D < T_K);
  last_row : assert (f_count[K*(T-1)+:K] == f_D + {{LOG2{1'b0}}, f_valid[T-1]});
  flight : assert (f_flight <= T_K);
  counted : assert (f_total <= PLACES);  // at the ports
  credits_are_free_places : assert (\g_fifo.u_credits.credits == PLACES - f_total);
  count_written : assert (f_wr_ptr == f_D);
  count_left : assert (f_rd_ptr - {{LOG2{1'b0}}, m_axis_tvalid} == f_L);
  memory_fits : assert (f_in_mem <= PLACES);
  fifo_fits : assert (f_D - f_L <= PLACES);
  fifo_part : assert (f_D - f_L <= f_total);
  quiet_inside : assert (f_quiet == 0 || f_total != 0);
  shut_is_quiet : assert (f_total != PLACES || (f_shut[T:0] & ~f_quiet) == 0);
  done_was_taken : assert (!f_done || f_taken);
  stored_was_taken : assert (!f_stored || f_taken);
  done_was_stored : assert (!f_done || f_stored);
  tag_kept : assert (!f_taken || f_core_tag == f_tag);
  mark_or_stored : assert (!f_taken || ((|f_mark) != f_stored));
  free_flow : assert (!f_never_stalled || f_in_mem <= 1);
  if (f_taken && !f_done) begin
    ahead : assert (f_ahead == f_index - f_L);
    ahead_inside : assert (f_ahead < f_total);
    somewhere : assert (!f_stored || f_is_in_mem || f_is_out);
    kept_in_memory : assert (!f_stored || !f_is_in_mem || \g_fifo.u_credits.u_fifo.f_word == f_expected);
    kept_in_register : assert (!f_stored || !f_is_out || {m_axis_tuser, m_axis_tdata} == f_expected);
  end
end

// ---- covers ----

always @* if (f_on && !rst) begin
  no_place_left : cover (f_total == PLACES);
  admit_and_leave : cover (f_admit && f_leave);
  stalled : cover (f_stall && m_axis_tvalid);
  followed_result_leaves : cover (f_due && f_leave);
end

`ifdef IK_COVER
// A single path, so that the search has no choices: the receiver waits until no slot is free, then accepts all results.
reg f_go = 1'b0;
always @(posedge clk) f_go <= f_on && (f_go || f_total == PLACES);
always @* begin
  assume (rst == !f_on);
  assume (s_axis_tvalid && m_axis_tready == f_go);
  assume (s_axis_tdata == 0 && s_axis_tuser == 0);
end
`endif

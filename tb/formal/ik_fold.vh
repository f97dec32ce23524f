// SPDX-License-Identifier: Apache-2.0
// Appended to ik_fold, whose multiplier, memory, sum, counts and flags are left out: streams and sequencer, with the
// real program. Words are arbitrary; the program's checker shows that it computes the dataflow.
//
// One assumption, the stream's rule: the sender offers a target until it is taken (f_sender). The state before the
// first reset is arbitrary, and a reset may occur at any time.

reg f_on = 1'b0;  // there was a reset
reg f_reset;      // in the previous clock
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

wire f_admit = s_axis_tvalid && s_axis_tready;
wire f_leave = m_axis_tvalid && m_axis_tready;
reg f_waits;  // a target was offered and not taken
always @(posedge clk) f_waits <= s_axis_tvalid && !s_axis_tready && !rst;
always @* f_sender : assume (!f_on || !f_waits || s_axis_tvalid);

// ---- from the program: clocks that take a target, may stop, begin an answer and complete it ----

wire [PERIOD-1:0] f_takes, f_holds, f_begins, f_ends;
wire [7*PERIOD-1:0] f_take_at, f_end_at;  // sums of the clocks so far
wire [6*(PERIOD+1)-1:0] f_so_far;  // words of an answer before a clock
assign f_so_far[5:0] = 6'd0;
genvar gi;
generate
  for (gi = 0; gi < PERIOD; gi = gi + 1) begin : g_f
    wire [STEP_W-1:0] step = rom[gi];
    localparam [6:0] CLOCK = gi;
    `include "ik_fold_fields.vh"
    assign f_takes[gi] = f_last_input;
    assign f_holds[gi] = f_hold;
    assign f_begins[gi] = f_first_result;
    assign f_ends[gi] = f_last_result;
    assign f_so_far[6*gi+6+:6] = f_so_far[6*gi+:6] |
        (f_result == RESULT_NONE ? 6'd0 : 6'd1 << (f_result - RESULT_QS_W));
    assign f_take_at[7*gi+:7] = (f_last_input ? CLOCK : 7'd0) + (gi == 0 ? 7'd0 : f_take_at[7*(gi==0?0:gi-1)+:7]);
    assign f_end_at[7*gi+:7] = (f_last_result ? CLOCK : 7'd0) + (gi == 0 ? 7'd0 : f_end_at[7*(gi==0?0:gi-1)+:7]);
  end
endgenerate
wire [6:0] f_take_clock = f_take_at[7*(PERIOD-1)+:7];
wire [6:0] f_end_clock = f_end_at[7*(PERIOD-1)+:7];
wire f_some = clock <= END;  // there is a step

// ---- ghost: targets taken and answers left since the reset ----

reg [2:0] f_A, f_L;
wire [2:0] f_total = f_A - f_L;
reg f_accepted;  // the target of this lap has been taken
always @(posedge clk) begin
  f_A <= rst ? 3'd0 : f_A + {2'd0, f_admit};
  f_L <= rst ? 3'd0 : f_L + {2'd0, f_leave};
  f_accepted <= !rst && (f_accepted || f_admit) && !(go && last);
end

// ---- ghost: one arbitrary target, followed ----

(* anyseq *) wire f_pick;
localparam [1:0] OUT = 2'd0, LAP = 2'd1, NEXT = 2'd2, OFFERED = 2'd3;
reg f_taken;      // picked since the reset
reg [1:0] f_at;   // its position: in its own lap, in the next one, offered
reg [1:0] f_ahead;  // answers that leave before its own
reg [TAG_W-1:0] f_tag;
wire f_take = f_admit && f_pick && !f_taken;
always @(posedge clk) begin
  f_taken <= !rst && (f_taken || f_take);
  if (f_take) begin
    f_tag <= s_axis_tuser;
    f_ahead <= f_total[1:0] - {1'b0, f_leave};
  end else if (f_leave) f_ahead <= f_ahead - 2'd1;
  if (rst) f_at <= OUT;
  else if (f_take) f_at <= LAP;
  else if (f_at == LAP && go && last) f_at <= NEXT;
  else if (f_at == NEXT && go && f_last_result) f_at <= OFFERED;
  else if (f_at == OFFERED && f_leave) f_at <= OUT;
end

// ---- ghost: the words of the answer, each written once ----

reg [5:0] f_words;     // written
reg [6*W-1:0] f_data;  // their values
wire [5:0] f_word = (go && giving && f_result != RESULT_NONE) ? 6'd1 << (f_result - RESULT_QS_W) : 6'd0;
always @(posedge clk) f_words <= rst ? 6'd0 : ((go && f_first_result && giving) ? 6'd0 : f_words) | f_word;
wire [5:0] f_kept;
generate
  for (gi = 0; gi < 6; gi = gi + 1) begin : g_word
    always @(posedge clk) if (f_word[gi]) f_data[W*gi+:W] <= answer;
    assign f_kept[gi] = !f_words[gi] || m_axis_tdata[W*gi+:W] == f_data[W*gi+:W];
  end
endgenerate

// ---- ghost: clocks waited ----

reg [7:0] f_quiet;  // a target was inside and no answer offered
reg [7:0] f_shut;   // a target was offered and not taken, and the receiver was ready
reg [7:0] f_since;  // since the last target was taken
reg f_steady;       // since then, the next one has been offered and the receiver ready
always @(posedge clk) begin
  f_quiet <= (rst || m_axis_tvalid || f_total == 0) ? 8'd0 : f_quiet + 8'd1;
  f_shut <= (rst || !s_axis_tvalid || s_axis_tready || !m_axis_tready) ? 8'd0 : f_shut + 8'd1;
  f_since <= f_admit ? 8'd1 : f_since + 8'd1;
  f_steady <= !rst && (f_admit || (f_steady && s_axis_tvalid)) && m_axis_tready;
end

// ---- properties ----

reg f_stall;
reg [6*W+TAG_W+7:0] f_held;
always @(posedge clk) begin
  f_stall <= m_axis_tvalid && !m_axis_tready && !rst;
  f_held  <= {m_axis_tuser, m_axis_tdata};
end

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || (!m_axis_tvalid && !s_axis_tready));
  stable : assert (!f_stall || (m_axis_tvalid && {m_axis_tuser, m_axis_tdata} == f_held));
  in_order : assert (!(m_axis_tvalid && f_at != OUT && f_ahead == 0) ||
      (f_at == OFFERED && m_axis_tuser[TAG_W-1:0] == f_tag));  // the n-th result has the n-th target's tag
  nothing_invented : assert (!m_axis_tvalid || f_total != 0);
  two_at_most : assert (f_total <= 2);
  taken_when_offered : assert (!s_axis_tready || s_axis_tvalid);
  loads_what_is_offered : assert (!(go && here && f_source == SOURCE_INPUT) || (s_axis_tvalid && !f_accepted));
  // all six words are written, and they are those of the program
  answer_whole : assert (!m_axis_tvalid || (f_words == 6'b111111 && m_axis_tdata == f_data));
  word_once : assert (!(go && giving && !f_first_result) || (f_word & f_words) == 0);
  step_of_clock : assert (!f_some || step == rom[clock]);
  // no deadlock: two laps at most until a result is offered, and until a target is taken
  offered_in_time : assert (f_quiet <= PERIOD + f_end_clock - f_take_clock);
  ready_in_time : assert (f_shut <= PERIOD + f_take_clock);
  // a target in every PERIOD clocks while neither side waits
  full_rate : assert (rst || !f_steady || f_since < PERIOD || (f_since == PERIOD && s_axis_tready));
end

// ---- helping invariants, asserted as well, for a program that answers in the next lap ----

wire [6:0] f_broken_at = f_end_clock + 7'd2;  // last clock of a lap that ends early after an answer
wire f_broken = (clock == f_broken_at && read == 0) || (read == f_broken_at && fetched == 0);
wire f_early = current && clock <= f_take_clock && !f_accepted;

always @* if (f_on) begin
  next_lap : assert (HOLD_LAP == 0 && FIRST_LAP == 1 && LAST_LAP == 1);
  once_a_lap : assert (f_takes == {{(PERIOD - 1) {1'b0}}, 1'b1} << f_take_clock && f_takes[0] == 0);
  ends_once : assert (f_ends == {{(PERIOD - 1) {1'b0}}, 1'b1} << f_end_clock && f_ends[0] == 0);
  begins_at_0 : assert (f_begins == 1);
  holds_at_end : assert (f_holds == {1'b1, {(PERIOD - 1) {1'b0}}});
  step_read_of_clock : assert (!(read <= END) || step_read == rom[read]);
  fetched_in_lap : assert (fetched <= END);
  read_in_lap : assert (read <= END || read == 7'd127);
  clock_in_lap : assert (f_some || clock == 7'd127);
  read_follows : assert (fetched == 0 ? read == 7'd127 || read == END || read == f_broken_at : fetched == read + 7'd1);
  clock_follows : assert (read == 7'd127 ? clock == 7'd127 : read == 0 ? clock == 7'd127 || clock == END ||
      clock == f_broken_at : read == clock + 7'd1);
  nothing_broken_off : assert (!f_broken || (!current && !previous));
  current_in_lap : assert (!current || (f_some && clock != 0));
  accepted_in_lap : assert (f_accepted == (current && clock > f_take_clock));
  early_is_offered : assert (!f_early || f_waits);
  previous_in_lap : assert (!previous || clock <= f_end_clock);
  given_in_lap : assert (given == (previous && clock != 0));
  words_so_far : assert (!given || f_words == f_so_far[6*clock+:6]);
  words_kept : assert (&f_kept);
  stops : assert (go || (m_axis_tvalid && previous && clock == 0));
  stopped : assert (!(m_axis_tvalid && previous) || !go);
  count : assert (f_total == {2'd0, f_accepted} + {2'd0, previous} + {2'd0, m_axis_tvalid});
  at_lap : assert (f_at != LAP || (f_accepted && tag == f_tag && f_ahead == {1'b0, previous} + {1'b0, m_axis_tvalid}));
  at_next : assert (f_at != NEXT || (previous && f_ahead == {1'b0, m_axis_tvalid}));
  at_next_tag : assert (f_at != NEXT || (given ? m_axis_tuser[TAG_W-1:0] : tag) == f_tag);
  at_offered : assert (f_at != OFFERED || (m_axis_tvalid && f_ahead == 0 && m_axis_tuser[TAG_W-1:0] == f_tag));
  quiet : assert (f_quiet == 0 || m_axis_tvalid || f_quiet <= (previous ? PERIOD : 0) + clock - f_take_clock - 1);
  quiet_inside : assert (f_quiet == 0 || f_total != 0);
  shut : assert (clock == 7'd127 ? f_shut <= (read != 7'd127) : f_shut <= (f_early || clock == 0 ? PERIOD : 0) + clock);
  shut_runs : assert (go || f_shut == 0);
  steady_runs : assert (!f_steady || (go && f_some && (current || clock == 0)));
  steady_clock : assert (!f_steady || f_since == (f_accepted ? 0 : PERIOD) + clock - f_take_clock);
end

// ---- covers ----

always @* if (f_on && !rst) begin
  two_inside : cover (f_accepted && previous);
  held : cover (!go);
  leaves : cover (f_leave && f_at == OFFERED);
  broken_off : cover (f_broken);
end

`ifdef IK_COVER
// A single path, so that the search has no choices: two targets; the receiver waits until the datapath has stopped.
reg f_go = 1'b0;
always @(posedge clk) f_go <= f_on && (f_go || !go);
always @* begin
  assume (rst == !f_on);
  assume (s_axis_tvalid == (f_A < 2));
  assume (m_axis_tready == f_go && f_pick && s_axis_tuser == 0);
end
`endif

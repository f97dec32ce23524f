// SPDX-License-Identifier: Apache-2.0
// Appended to ik_fold or, with IK_ARM, to ik_fold_arm: laps, steps and results are correct with the real program. The
// modules for arithmetic, memory, flags and limits are left out, so words are arbitrary. The checker of the program, in
// model/dataflow/fold, shows that the program computes the dataflow.
//
// One assumption, a rule of AXI4-Stream: the sender offers a target until it is accepted (f_sender). The state before
// the first reset is arbitrary, and a reset may occur at any time.

`ifdef IK_ARM
localparam integer WORDS = 17, CLOCK_W = 8, SIDE_W = TAG_W + 3;
`else
localparam integer WORDS = 6, CLOCK_W = 7, SIDE_W = TAG_W;
`endif
// signals of the instances, connected by name when the hierarchy is flattened
(* hierconn *) wire [CLOCK_W-1:0] \u_fetch.read ;
(* hierconn *) wire \u_lap.current ;
(* hierconn *) wire \u_lap.previous ;
(* hierconn *) wire \u_lap.earlier ;
(* hierconn *) wire \u_lap.occupied ;
(* hierconn *) wire \u_lap.begun ;
wire [CLOCK_W-1:0] read = \u_fetch.read ;
wire current = \u_lap.current ;
wire previous = \u_lap.previous ;
wire f_earlier = \u_lap.earlier ;
wire f_begun = \u_lap.begun ;
`ifdef IK_ARM
wire [SIDE_W-1:0] f_side = {branch_in, tag};  // branch and tag of the last accepted target
wire [SIDE_W-1:0] f_side_given = {branch, m_axis_tuser[TAG_W-1:0]};  // of the result
wire [W*WORDS-1:0] f_value = {{10{answer}}, {7{th}}};
(* hierconn *) wire [17*W-1:0] \u_results.words ;
(* hierconn *) wire [6:0] \u_results.overs ;
(* hierconn *) wire [2:0] \u_results.joint_1 ;
(* hierconn *) wire \u_results.angle_1 ;
(* hierconn *) wire \u_results.angle_2 ;
wire [17*W-1:0] words = \u_results.words ;
wire [6:0] overs = \u_results.overs ;
wire [2:0] joint_1 = \u_results.joint_1 ;
wire angle_1 = \u_results.angle_1 ;
wire angle_2 = \u_results.angle_2 ;
function integer angles_after(input integer joint);  // number of angles written after angle th1 (joint = 0) to th7 (6)
  integer m;
  begin
    angles_after = 0;
    for (m = 0; m < 7; m = m + 1) if (AFTER[8*m+:8] < AFTER[8*joint+:8]) angles_after = angles_after + 1;
  end
endfunction
`else
(* hierconn *) wire [TAG_W-1:0] \u_results.tag ;
wire [SIDE_W-1:0] f_side = \u_results.tag ;
wire [SIDE_W-1:0] f_side_given = m_axis_tuser[TAG_W-1:0];
wire [W*WORDS-1:0] f_value = {WORDS{answer}};
`endif
localparam [CLOCK_W-1:0] NEVER = {CLOCK_W{1'b1}};
localparam [WORDS-1:0] ONE = 1;

reg f_on = 1'b0;  // since the first reset
reg f_reset;      // rst in the previous clock
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

wire f_admit = s_axis_tvalid && s_axis_tready;
wire f_leave = m_axis_tvalid && m_axis_tready;
reg f_waits;  // in the previous clock, a target was offered and not accepted
always @(posedge clk) f_waits <= s_axis_tvalid && !s_axis_tready && !rst;
always @* f_sender : assume (!f_on || !f_waits || s_axis_tvalid);

// ---- from the program: the clocks that accept a target, may stop, begin a result and complete it ----

wire [PERIOD-1:0] f_takes, f_holds, f_begins, f_ends;
wire [CLOCK_W*PERIOD-1:0] f_take_at, f_first_at, f_end_at;  // running sums: the last is the clock itself
// words of a result that are written before a clock: in the same lap; in the same lap and the one before
wire [WORDS*(PERIOD+1)-1:0] f_in_lap, f_so_far;
wire [7*PERIOD-1:0] f_angles;  // angles, the first seven words, written in each clock
assign f_in_lap[WORDS-1:0] = {WORDS{1'b0}};
assign f_so_far[WORDS-1:0] = f_in_lap[WORDS*PERIOD+:WORDS];
genvar gi;
generate
  for (gi = 0; gi < PERIOD; gi = gi + 1) begin : g_f
    wire [STEP_W-1:0] f_step = rom[gi];
    localparam [CLOCK_W-1:0] CLOCK = gi;
    localparam integer BEFORE = CLOCK_W * (gi == 0 ? 0 : gi - 1);
    wire f_first_result = f_step[AT_FIRST_RESULT], f_last_result = f_step[AT_LAST_RESULT];
    wire f_last_input = f_step[AT_LAST_INPUT];
    wire [BITS_RESULT-1:0] f_result = f_step[AT_RESULT+:BITS_RESULT];
    assign f_takes[gi] = f_last_input;
    assign f_holds[gi] = f_step[AT_HOLD];
    assign f_begins[gi] = f_first_result;
    assign f_ends[gi] = f_last_result;
    wire [WORDS-1:0] of_clock = f_result == RESULT_NONE ? {WORDS{1'b0}} : ONE << (f_result - 1);
    assign f_angles[7*gi+:7] = of_clock;
    assign f_in_lap[WORDS*(gi+1)+:WORDS] = (f_first_result ? {WORDS{1'b0}} : f_in_lap[WORDS*gi+:WORDS]) | of_clock;
    assign f_so_far[WORDS*(gi+1)+:WORDS] = (f_first_result ? {WORDS{1'b0}} : f_so_far[WORDS*gi+:WORDS]) | of_clock;
    assign f_take_at[CLOCK_W*gi+:CLOCK_W] = (f_last_input ? CLOCK : 0) + (gi == 0 ? 0 : f_take_at[BEFORE+:CLOCK_W]);
    assign f_first_at[CLOCK_W*gi+:CLOCK_W] = (f_first_result ? CLOCK : 0) + (gi == 0 ? 0 : f_first_at[BEFORE+:CLOCK_W]);
    assign f_end_at[CLOCK_W*gi+:CLOCK_W] = (f_last_result ? CLOCK : 0) + (gi == 0 ? 0 : f_end_at[BEFORE+:CLOCK_W]);
  end
endgenerate
wire [CLOCK_W-1:0] f_take_clock = f_take_at[CLOCK_W*(PERIOD-1)+:CLOCK_W];
wire [CLOCK_W-1:0] f_first_clock = f_first_at[CLOCK_W*(PERIOD-1)+:CLOCK_W];
wire [CLOCK_W-1:0] f_end_clock = f_end_at[CLOCK_W*(PERIOD-1)+:CLOCK_W];
wire f_some = clock <= END;  // there is a current step

// ---- ghost: targets accepted, and results left, since the reset ----

reg [2:0] f_A, f_L;
wire [2:0] f_total = f_A - f_L;
reg f_accepted;  // the target of this lap has been accepted
always @(posedge clk) begin
  f_A <= rst ? 3'd0 : f_A + {2'd0, f_admit};
  f_L <= rst ? 3'd0 : f_L + {2'd0, f_leave};
  f_accepted <= !rst && (f_accepted || f_admit) && !(go && last);
end

// ---- ghost: one arbitrary target, followed ----

(* anyseq *) wire f_pick;
localparam [2:0] OUT = 3'd0, LAP = 3'd1, NEXT = 3'd2, THIRD = 3'd3, OFFERED = 3'd4;
reg f_taken;      // a target was picked since the reset
reg [2:0] f_at;   // its position: out, in its own lap, in the next, in a third if the program has one, offered
reg [1:0] f_ahead;  // results that leave before its result
reg [SIDE_W-1:0] f_tag;
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
  else if (f_at == NEXT && go && last && LAST_LAP == 2) f_at <= THIRD;
  else if (f_at == LAST_LAP + LAP && go && step[AT_LAST_RESULT]) f_at <= OFFERED;
  else if (f_at == OFFERED && f_leave) f_at <= OUT;
end

// ---- ghost: the words of the result, each written once ----

reg [WORDS-1:0] f_words;   // words written
reg [W*WORDS-1:0] f_data;  // their values
wire [WORDS-1:0] f_word = (go && writing && result_field != RESULT_NONE) ? ONE << (result_field - 1) : {WORDS{1'b0}};
always @(posedge clk)
  f_words <= rst ? {WORDS{1'b0}} : ((go && first_result && writing) ? {WORDS{1'b0}} : f_words) | f_word;
wire [WORDS-1:0] f_kept;
`ifdef IK_ARM
// Words are stored in the order in which the program writes them, the last one lowest. f_ordered is a whole result,
// f_shifted the part that is written so far.
wire [W*WORDS-1:0] f_ordered;
wire [4:0] f_left = 5'd17 - $countones(f_words);
wire [W*WORDS-1:0] f_shifted_4 = f_left[4] ? f_ordered >> 16 * W : f_ordered;
wire [W*WORDS-1:0] f_shifted_3 = f_left[3] ? f_shifted_4 >> 8 * W : f_shifted_4;
wire [W*WORDS-1:0] f_shifted_2 = f_left[2] ? f_shifted_3 >> 4 * W : f_shifted_3;
wire [W*WORDS-1:0] f_shifted_1 = f_left[1] ? f_shifted_2 >> 2 * W : f_shifted_2;
wire [W*WORDS-1:0] f_shifted = f_left[0] ? f_shifted_1 >> W : f_shifted_1;
`endif
generate
  for (gi = 0; gi < WORDS; gi = gi + 1) begin : g_kept
    always @(posedge clk) if (f_word[gi]) f_data[W*gi+:W] <= f_value[W*gi+:W];
`ifdef IK_ARM
    assign f_ordered[W*AFTER[8*gi+:8]+:W] = f_data[W*gi+:W];
    assign f_kept[gi] = gi + f_left >= WORDS || words[W*gi+:W] == f_shifted[W*gi+:W];
`else
    assign f_kept[gi] = !f_words[gi] || m_axis_tdata[W*gi+:W] == f_data[W*gi+:W];
`endif
  end
endgenerate

`ifdef IK_ARM
// The comparison of an angle with its limits is stored two clocks after the angle, in the same order.
reg [6:0] f_angle_1, f_angle_2, f_judged, f_beyond;  // written one clock ago, two clocks ago; compared; beyond a limit
wire [6:0] f_over_ordered, f_joint;
wire [6:0] f_over_wrong = (overs ^ (f_over_ordered >> 3'd7 - $countones(f_judged))) & (7'h7f >> 3'd7 - $countones(f_judged));
generate
  for (gi = 0; gi < 7; gi = gi + 1) begin : g_over_kept
    localparam integer PLACE = angles_after(gi);
    always @(posedge clk) if (f_angle_2[gi]) f_beyond[gi] <= over;
    assign f_over_ordered[PLACE] = f_beyond[gi];
    assign f_joint[gi] = !f_angle_1[gi] || joint_1 == gi + 1;
  end
endgenerate
always @(posedge clk) begin
  f_angle_1 <= rst ? 7'd0 : f_word[6:0];
  f_angle_2 <= rst ? 7'd0 : f_angle_1;
  f_judged <= rst ? 7'd0 : (go && first_result && writing) ? f_angle_2 : f_judged | f_angle_2;
end
wire [CLOCK_W-1:0] f_before = clock == 0 ? END : clock - 1;
wire [CLOCK_W-1:0] f_two_before = f_before == 0 ? END : f_before - 1;
always @* if (f_on) begin
  limits_whole : assert (!m_axis_tvalid || m_axis_tuser[TAG_W+9+:7] == f_beyond);
  compared : assert (angle_1 == |f_angle_1 && angle_2 == |f_angle_2 && &f_joint);
  compared_once : assert (f_words[6:0] == (f_judged | f_angle_1 | f_angle_2) && (f_angle_2 & f_angle_1) == 0 &&
      (f_judged & (f_angle_1 | f_angle_2)) == 0);
  angle_of_clock : assert (f_angle_1 == (f_begun ? f_angles[7*f_before+:7] : 7'd0));
  angle_before : assert (f_angle_2 == (f_begun && f_before != f_first_clock ? f_angles[7*f_two_before+:7] : 7'd0));
  judged : assert (f_begun || f_judged == 7'd0 || f_judged == 7'h7f);
  over_kept : assert (f_over_wrong == 7'd0);
end
`endif

// ---- ghost: clocks waited ----

reg [9:0] f_quiet;  // clocks in a row with a target inside and no result offered
reg [9:0] f_shut;   // clocks in a row with a target offered, not accepted, and the receiver ready
reg [9:0] f_since;  // clocks since the last target was accepted
reg f_steady;       // since then, a target has been offered and the receiver ready in every clock
always @(posedge clk) begin
  f_quiet <= (rst || m_axis_tvalid || f_total == 0) ? 10'd0 : f_quiet + 10'd1;
  f_shut <= (rst || !s_axis_tvalid || s_axis_tready || !m_axis_tready) ? 10'd0 : f_shut + 10'd1;
  f_since <= f_admit ? 10'd1 : f_since + 10'd1;
  f_steady <= !rst && (f_admit || (f_steady && s_axis_tvalid)) && m_axis_tready;
end

// ---- properties ----

reg f_stall;
reg [$bits(m_axis_tuser)+W*WORDS-1:0] f_held;
always @(posedge clk) begin
  f_stall <= m_axis_tvalid && !m_axis_tready && !rst;
  f_held  <= {m_axis_tuser, m_axis_tdata};
end

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || (!m_axis_tvalid && !s_axis_tready));
  stable : assert (!f_stall || (m_axis_tvalid && {m_axis_tuser, m_axis_tdata} == f_held));
  in_order : assert (!(m_axis_tvalid && f_at != OUT && f_ahead == 0) ||
      (f_at == OFFERED && m_axis_tuser[TAG_W-1:0] == f_tag[TAG_W-1:0]));  // the n-th result has the n-th target's tag
  nothing_invented : assert (!m_axis_tvalid || f_total != 0);
  two_at_most : assert (f_total <= 2);
  taken_when_offered : assert (!s_axis_tready || s_axis_tvalid);
  loads_what_is_offered : assert (!(go && \u_lap.occupied && source == SOURCE_INPUT) || (s_axis_tvalid && !f_accepted));
  // all words are written, with the values that the program has written
  answer_whole : assert (!m_axis_tvalid || (f_words == {WORDS{1'b1}} && m_axis_tdata == f_data));
  word_once : assert (!(go && writing && !first_result) || (f_word & f_words) == 0);
  step_of_clock : assert (!f_some || step == rom[clock]);
  // no deadlock: bounds of the clocks until a result is offered, and until a target is accepted
  offered_in_time : assert (f_quiet <= LAST_LAP * PERIOD + f_end_clock - f_take_clock);
  ready_in_time : assert (f_shut <= PERIOD + f_take_clock);
  // one target per PERIOD clocks while neither side waits
  full_rate : assert (rst || !f_steady || f_since < PERIOD || (f_since == PERIOD && s_axis_tready));
end

// ---- helping invariants, asserted as well, for a program that begins a result in the next lap ----

wire [CLOCK_W-1:0] f_broken_at = f_end_clock + 2;  // last clock of a lap that ends early, after a result
wire f_broken = (clock == f_broken_at && read == 0) || (read == f_broken_at && fetched == 0);
wire f_early = current && clock <= f_take_clock && !f_accepted;

always @* if (f_on) begin
  // the hold is in the clock before the first result; in the whole arm's program, a result ends before the next hold
  next_lap : assert (FIRST_LAP == 1 && HOLD_LAP == (f_first_clock != 0) && LAST_LAP == HOLD_LAP + 1);
  apart : assert (LAST_LAP == 1 || (f_end_clock + 1 < f_first_clock && f_first_clock < f_take_clock));
  once_a_lap : assert (f_takes == {{(PERIOD - 1) {1'b0}}, 1'b1} << f_take_clock && f_takes[0] == 0);
  ends_once : assert (f_ends == {{(PERIOD - 1) {1'b0}}, 1'b1} << f_end_clock && f_ends[0] == 0);
  begins_once : assert (f_begins == {{(PERIOD - 1) {1'b0}}, 1'b1} << f_first_clock);
  holds_before : assert (f_holds == {{(PERIOD - 1) {1'b0}}, 1'b1} << (f_first_clock == 0 ? END : f_first_clock - 1));
  step_read_of_clock : assert (!(read <= END) || fetched_step == rom[read]);
  fetched_in_lap : assert (fetched <= END);
  read_in_lap : assert (read <= END || read == NEVER);
  clock_in_lap : assert (f_some || clock == NEVER);
  ends_of_lap : assert (begins == (clock == 0) && last == (clock == END));
  read_follows : assert (fetched == 0 ? read == NEVER || read == END || read == f_broken_at : fetched == read + 1);
  clock_follows : assert (read == NEVER ? clock == NEVER : read == 0 ? clock == NEVER || clock == END ||
      clock == f_broken_at : read == clock + 1);
  nothing_broken_off : assert (!f_broken || (!current && !previous && !f_earlier));
  current_in_lap : assert (!current || (f_some && clock != 0));
  accepted_in_lap : assert (f_accepted == (current && clock > f_take_clock));
  early_is_offered : assert (!f_early || f_waits);
  previous_in_lap : assert (!previous || clock <= (LAST_LAP == 1 ? f_end_clock : END));
  earlier_if_third : assert (!f_earlier || LAST_LAP == 2);
  earlier_in_lap : assert (!f_earlier || clock <= f_end_clock);
  begun_in_lap : assert (f_begun == (f_earlier || (previous && clock > f_first_clock)));
  begun_is_not_offered : assert (!f_begun || !m_axis_tvalid);
  words_so_far : assert (!f_begun || f_words == f_so_far[WORDS*clock+:WORDS]);
  words_kept : assert (&f_kept);
  stops : assert (go || (m_axis_tvalid && previous && clock == f_first_clock));
  stopped : assert (!(m_axis_tvalid && previous && clock >= f_first_clock) || !go);
  count : assert (f_total == {2'd0, f_accepted} + {2'd0, previous} + {2'd0, f_earlier} + {2'd0, m_axis_tvalid});
  at_a_place : assert (f_at <= OFFERED);
  at_lap : assert (f_at != LAP || (f_accepted && f_side == f_tag &&
      f_ahead == {1'b0, previous} + {1'b0, m_axis_tvalid}));
  at_next : assert (f_at != NEXT || (previous && f_ahead == {1'b0, f_earlier} + {1'b0, m_axis_tvalid}));
  at_next_tag : assert (f_at != NEXT || (f_begun && !f_earlier ? f_side_given : f_side) == f_tag);
  at_third : assert (f_at != THIRD || (f_earlier && f_ahead == 0 && f_side_given == f_tag));
  at_offered : assert (f_at != OFFERED || (m_axis_tvalid && f_ahead == 0 &&
      m_axis_tuser[TAG_W-1:0] == f_tag[TAG_W-1:0]));
  quiet : assert (f_quiet == 0 || m_axis_tvalid || 
      f_quiet <= (f_earlier ? 2 * PERIOD : previous ? PERIOD : 0) + clock - f_take_clock - 1);
  quiet_inside : assert (f_quiet == 0 || f_total != 0);
  shut : assert (clock == NEVER ? f_shut <= (read != NEVER) : f_shut <= (f_early || clock == 0 ? PERIOD : 0) + clock);
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

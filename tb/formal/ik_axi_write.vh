// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axi_write: issued bursts are inside the destination, cross no 4 KiB boundary, do not exceed the
// permitted number of bursts, contain only records whose targets have been read, and are stable until accepted.
// ends_burst marks the last record of each burst. A response acknowledges the records of its own burst.
//
// Assumptions about inputs: a job starts only if nothing is outstanding, in an area inside the address space (f_go,
// f_area: ik_axi_job). No more targets are read than the job has, and none after `ended` (f_got_some, f_ended:
// ik_axi_read). A record leaves only if allowed (f_leave: ik_axi_result). A response belongs to a burst whose records
// have left (f_answer: AXI4).

localparam integer R = ADDR_W - LOG2_RECORD;  // width of a record's address
localparam [P-1:0] PLACES = {1'b1, {LOG2_PLACES{1'b0}}};

reg f_on = 1'b0;  // since the first reset
reg f_reset;
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

// ---- ghost: the job, the bursts on W and the bursts that wait for a response ----

reg [R-1:0] f_base;
reg [31:0] f_count;
reg [31:0] f_got;   // records read
reg [31:0] f_issued;  // records in issued bursts
reg [31:0] f_ok;    // records with response OKAY before the first error
reg f_bad;          // an error response has arrived
reg f_was_ended;
wire [N-1:0] f_size = {1'b0, m_axi_awlen} / BEATS + 1'b1;
wire [7:0] f_open, f_sum, f_waits, f_waiting;
wire [N-1:0] f_oldest, f_newest, f_first, f_last;
wire f_middle, f_between;
ik_bursts #(.N(N), .S(8), .WHOLE(WHOLE)) f_w (
    .clk(clk), .clear(rst || go), .push(issue), .size(size), .pop(leave), .drop(1'b0),
    .n(f_open), .oldest(f_oldest), .newest(f_newest), .sum(f_sum), .middle(f_middle)
);
ik_bursts #(.N(N), .S(8), .WHOLE(WHOLE)) f_b (
    .clk(clk), .clear(rst || go), .push(issue), .size(size), .pop(1'b0), .drop(m_axi_bvalid),
    .n(f_waits), .oldest(f_first), .newest(f_last), .sum(f_waiting), .middle(f_between)
);
always @(posedge clk) begin
  if (go) f_base <= destination;
  if (rst) f_count <= 32'd0;
  else if (go) f_count <= f_next_count;
  f_got <= (rst || go) ? 32'd0 : f_got + got;
  f_issued <= (rst || go) ? 32'd0 : f_issued + issued;
  f_ok <= (rst || go) ? 32'd0 : f_ok + ((m_axi_bvalid && !bad && !f_bad) ? f_first : {N{1'b0}});
  f_bad <= !rst && !go && (f_bad || bad);
  f_was_ended <= !rst && !go && ended;
end
(* anyseq *) wire [31:0] f_next_count;

always @* if (f_on) begin
  f_go : assume (!go || (stop && !m_axi_awvalid && f_open == 0 && f_waits == 0));
  f_area : assume (!go || {1'b0, destination} + f_next_count <= {1'b1, {R{1'b0}}});
  f_got_some : assume (!got || (!ended && f_got < f_count && {1'b0, ready} + to_send < PLACES));
  f_ended : assume (!f_was_ended || ended);
  f_leave : assume (!leave || allowed);
  f_answer : assume (!m_axi_bvalid || f_waits > f_open);
end

// ---- properties ----

reg f_stall;
reg [ADDR_W+7:0] f_held;
reg f_may;           // in the previous clock, a burst was offered or could be issued
reg [1:0] f_waited;  // clocks in a row in which a burst could be offered but was not
always @(posedge clk) begin
  f_stall <= m_axi_awvalid && !m_axi_awready && !rst;
  f_held <= {m_axi_awaddr, m_axi_awlen};
  f_may <= m_axi_awvalid || !stop;
  f_waited <= (rst || go || m_axi_awvalid || stop || f_waits[LOG2_BURSTS] ||
               !(ready >= to_edge || (ended && ready != 0))) ? 2'd0 : f_waited + (f_waited != 3);
end

wire [R-1:0] f_at = m_axi_awaddr[ADDR_W-1:LOG2_RECORD];
wire [R-1:0] f_offset = f_at - f_base;
wire [32:0] f_end = {{(33 - R > 0 ? 33 - R : 1) {1'b0}}, f_offset} + f_size;
wire [8:0] f_page = {2'b00, m_axi_awaddr[11:LOG2_RECORD]} + f_size;

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || !m_axi_awvalid);
  stable : assert (!f_stall || (m_axi_awvalid && {m_axi_awaddr, m_axi_awlen} == f_held));
  inside_destination : assert (!m_axi_awvalid || f_end <= {1'b0, f_count});
  within_4k : assert (!m_axi_awvalid || (f_page <= 4096 >> LOG2_RECORD && m_axi_awaddr[LOG2_RECORD-1:0] == 0));
  whole_records : assert (!m_axi_awvalid || f_size * BEATS == m_axi_awlen + 1'b1);
  read_before : assert (f_issued <= f_got && f_got <= f_count);
  within_promise : assert (f_waits <= (1 << LOG2_BURSTS));
  none_when_stopped : assert (!m_axi_awvalid || f_may);
  ends_with_burst : assert (!allowed || (f_open != 0 && ends_burst == (f_oldest == 1)));
  // `written` counts the records of bursts with response OKAY before the first error
  written_is_answered : assert (written == f_ok);
  written_no_more : assert (written <= f_issued);
  // a burst that may be issued is offered two clocks later
  issued_in_time : assert (f_waited < 2 || m_axi_awvalid);
end

// ---- helping invariants, asserted as well ----

wire [LOG2_BURST-1:0] f_next_sent = sending + to_send[LOG2_BURST-1:0];
wire [LOG2_BURST-1:0] f_next_answered = answering + to_answer[LOG2_BURST-1:0];
wire [LOG2_BURST-1:0] f_low = next[LOG2_BURST-1:0];
always @* if (f_on) begin
  between_whole : assert (f_middle && f_between);
  counted : assert (f_sum == to_send && f_waits == bursts && f_waiting == to_answer);
  some_in_each : assert ((f_open == 0 || (f_oldest != 0 && f_oldest <= WHOLE)) && (f_open < 2 || (f_newest != 0 &&
      f_newest <= WHOLE)));
  some_in_all : assert ((f_waits == 0 || (f_first != 0 && f_first <= WHOLE)) && (f_waits < 2 || (f_last != 0 &&
      f_last <= WHOLE)));
  oldest_to_edge : assert ((f_open < 2 || sending + f_oldest == WHOLE) && (f_waits < 2 || answering +
      f_first == WHOLE));
  oldest_fits : assert ((f_open == 0 || {1'b0, sending} + f_oldest <= WHOLE) && (f_waits == 0 || {1'b0, answering} +
      f_first <= WHOLE));
  next_behind : assert (f_count == 0 || (f_low == f_next_sent && f_low == f_next_answered));
  edge_before : assert (f_count == 0 || f_issued == 0 || f_low == 0 || (f_was_ended && ready == 0));
  edge_fits : assert (to_edge != 0 && to_edge <= WHOLE);
  edge_is : assert (f_count == 0 || (f_was_ended && ready == 0) || to_edge == WHOLE - {1'b0, f_low});
  size_is : assert (!sized || (size != 0 && {{(P - N) {1'b0}}, size} <= ready && (size == to_edge || (f_was_ended &&
      size == ready && size < to_edge))));
  position : assert (f_count == 0 || next == f_base + f_issued[R-1:0]);
  area : assert (f_count == 0 || {1'b0, f_base} + f_count <= {1'b1, {R{1'b0}}});
  ready_is : assert (f_got - f_issued == ready && {1'b0, ready} + to_send <= PLACES);
  offered : assert (!m_axi_awvalid || (f_at == next - f_size && f_issued >= f_size));
  offered_to_edge : assert (!m_axi_awvalid || {1'b0, f_at[LOG2_BURST-1:0]} + f_size <= WHOLE);
  waits_sized : assert (f_waited == 0 || m_axi_awvalid || sized);
  error_is : assert (error == f_bad);
  answered_are_issued : assert (f_issued >= f_waiting && f_ok <= f_issued - f_waiting);
  sent_first : assert (f_waits >= f_open);
end

// ---- covers ----

always @* if (f_on && !rst) begin
  two_bursts : cover (f_waits == 2 && m_axi_awvalid);
  all_answered : cover (f_count == 2 && written == 2 && idle);
  error_seen : cover (error && idle && written == 0);
end

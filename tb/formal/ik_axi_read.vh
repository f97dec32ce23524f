// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axi_read: requests are inside the source, cross no 4 KiB boundary, do not exceed the permitted number
// of bursts, and are stable until accepted, for any timing and responses of the memory.
//
// Assumptions about inputs: a job starts only if nothing is outstanding and `stop` is high (f_go), in an area inside
// the address space (f_area); ik_axi_job ensures both. A slot is freed only for a record that was delivered (f_leave).
// Data come only if they were requested (f_data), a rule of AXI4.

localparam integer R = ADDR_W - LOG2_RECORD;  // width of a record's address
localparam [P-1:0] PLACES = {1'b1, {LOG2_PLACES{1'b0}}};

reg f_on = 1'b0;  // since the first reset
reg f_reset;
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

// ---- ghost: the job, outstanding bursts, records in the core ----

reg [R-1:0] f_base;
reg [31:0] f_count;
reg [P-1:0] f_core;  // records delivered whose results have not left
reg [7:0] f_taken;   // beats of bursts accepted by the memory, which it may send
wire [N-1:0] f_size = {1'b0, m_axi_arlen} / BEATS + 1'b1;
wire [7:0] f_open;
wire [N-1:0] f_oldest;
wire [N-1:0] f_newest;
wire [7:0] f_sum;
wire f_middle;
ik_bursts #(.N(N), .S(8), .WHOLE(WHOLE)) f_bursts (
    .clk(clk), .clear(rst || go), .push(ask), .size(size), .pop(last), .drop(1'b0),
    .n(f_open), .oldest(f_oldest), .newest(f_newest), .sum(f_sum), .middle(f_middle)
);
always @(posedge clk) begin
  if (go) f_base <= source;
  if (rst) f_count <= 32'd0;
  else if (go) f_count <= count;
  f_core <= (rst || go) ? {P{1'b0}} : f_core + got - leave;
end

// records that the memory may send: those of all bursts except one that is still offered
wire [7:0] f_due = f_sum - (m_axi_arvalid ? {{(8 - N) {1'b0}}, f_newest} : 8'd0);
wire [P:0] f_inside = {1'b0, f_core} + due;  // records requested whose results have not left

always @* if (f_on) begin
  f_go : assume (!go || (stop && !m_axi_arvalid && f_open == 0));
  f_area : assume (!go || {1'b0, source} + {{(R > 32 ? R - 31 : 1) {1'b0}}, count} <= {1'b1, {R{1'b0}}});
  f_leave : assume (!leave || f_core != 0);
  f_data : assume (!m_axi_rvalid || f_due != 0);
end

// ---- properties ----

reg f_stall;
reg [ADDR_W+7:0] f_held;
reg f_may;            // in the previous clock, a burst was offered or could be requested
reg [1:0] f_waited;   // clocks in a row with records left to request and none outstanding or in the core
always @(posedge clk) begin
  f_stall <= m_axi_arvalid && !m_axi_arready && !rst;
  f_held <= {m_axi_araddr, m_axi_arlen};
  f_may <= m_axi_arvalid || (!stop && !error);
  f_waited <= (rst || go || m_axi_arvalid || f_open != 0 || f_core != 0 || left == 0 || error || stop) ? 2'd0 :
              f_waited + (f_waited != 3);
end

wire [R-1:0] f_at = m_axi_araddr[ADDR_W-1:LOG2_RECORD];
wire [R-1:0] f_offset = f_at - f_base;
wire [32:0] f_end = {{(33 - R > 0 ? 33 - R : 1) {1'b0}}, f_offset} + f_size;
wire [8:0] f_page = {2'b00, m_axi_araddr[11:LOG2_RECORD]} + f_size;

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || !m_axi_arvalid);
  stable : assert (!f_stall || (m_axi_arvalid && {m_axi_araddr, m_axi_arlen} == f_held));
  inside_source : assert (!m_axi_arvalid || f_end <= {1'b0, f_count});
  within_4k : assert (!m_axi_arvalid || (f_page <= 4096 >> LOG2_RECORD && m_axi_araddr[LOG2_RECORD-1:0] == 0));
  whole_records : assert (!m_axi_arvalid || f_size * BEATS == m_axi_arlen + 1'b1);
  within_promise : assert (f_open <= (1 << LOG2_BURSTS));
  place_for_every_record : assert (f_inside <= PLACES);
  none_when_stopped : assert (!m_axi_arvalid || f_may);
  // if records are left to request, and none is outstanding or in the core, a burst is offered two clocks later
  asked_in_time : assert (f_waited < 2 || m_axi_arvalid);
end

// ---- helping invariants, asserted as well ----

wire [R-1:0] f_done = f_count[R-1:0] - left[R-1:0];  // records requested
wire [N-1:0] f_low = {1'b0, next[LOG2_BURST-1:0]};
wire [LOG2_BURST-1:0] f_next_due = coming + due[LOG2_BURST-1:0];
always @* if (f_on) begin
  between_whole : assert (f_middle);
  counted : assert (f_open == bursts && f_sum == due);
  some_in_each : assert ((f_open == 0 || (f_oldest != 0 && f_oldest <= WHOLE)) && (f_open < 2 || (f_newest != 0 &&
      f_newest <= WHOLE)));
  oldest_to_edge : assert (f_open < 2 || coming + f_oldest == WHOLE);
  oldest_fits : assert (f_open == 0 || {1'b0, coming} + f_oldest <= WHOLE);
  next_behind : assert (left == 0 || next[LOG2_BURST-1:0] == f_next_due);
  edge_before : assert (f_open == 0 || left == 0 || next[LOG2_BURST-1:0] == 0);
  position : assert (left <= f_count && (f_count == 0 || next == f_base + f_done));
  area : assert (f_count == 0 || {1'b0, f_base} + f_count <= {1'b1, {R{1'b0}}});
  size_is : assert (!sized || (left != 0 && size == ((left < to_edge) ? left[N-1:0] : to_edge)));
  offered : assert (!m_axi_arvalid || (f_open != 0 && f_at == next - f_size && f_count - left >= f_size &&
                    f_size == f_newest && (f_open != 1 || f_oldest == f_newest)));
  offered_to_edge : assert (!m_axi_arvalid || {1'b0, f_at[LOG2_BURST-1:0]} + f_size <= WHOLE);
  free_places : assert (free <= PLACES && f_inside <= PLACES - free);
  none_lost : assert (error || f_inside == PLACES - free);
  waits : assert (f_waited != 1 || m_axi_arvalid || (left != 0 && sized));
end

// ---- covers ----

always @* if (f_on && !rst) begin
  two_bursts : cover (f_open == 2 && m_axi_arvalid);
  result_left : cover (good == 1 && leave);
  all_read : cover (f_count == 2 && good == 2 && idle && f_core == 0);
end

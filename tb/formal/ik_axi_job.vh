// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axi_job: a job starts only if its areas are disjoint, aligned and inside the address space. It ends
// when the engines are idle, and it reports its outcome once. No assumptions.

reg f_on = 1'b0;  // since the first reset
reg f_reset;
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

reg f_run, f_idle, f_abort, f_start, f_go;
always @(posedge clk) begin
  f_run   <= state == RUN && !rst;
  f_idle  <= read_idle && write_idle;
  f_abort <= aborted;
  f_start <= start && !soft_reset && !busy && !rst;
  f_go    <= go && !rst;
end

// ---- ghost: the registers when the job started, and the areas that they give ----

reg [63:0] f_source, f_destination;
reg [31:0] f_count;
always @(posedge clk) begin
  if (start && !soft_reset && !busy) {f_source, f_destination, f_count} <= {source, destination, count};
end
wire [65:0] f_size = {{(34 - LOG2_RECORD) {1'b0}}, f_count, {LOG2_RECORD{1'b0}}};
wire [65:0] f_source_end = {2'b00, f_source} + f_size;
wire [65:0] f_destination_end = {2'b00, f_destination} + f_size;
wire [65:0] f_limit = 66'd1 << ADDR_W;
wire f_apart = f_source_end <= f_destination || f_destination_end <= f_source;
wire f_low = f_source < f_limit && f_destination < f_limit;  // both areas begin inside the address space

always @* if (f_on) begin
  areas_apart : assert (!go || f_apart);
  areas_inside : assert (!go || (f_source_end <= f_limit && f_destination_end <= f_limit));
  areas_aligned : assert (!go || (f_source[LOG2_RECORD-1:0] == 0 && f_destination[LOG2_RECORD-1:0] == 0 && f_count != 0));
  areas_copied : assert (!go || ({job_source, {LOG2_RECORD{1'b0}}} == f_source && {job_destination, {LOG2_RECORD{1'b0}}} == f_destination &&
      job_count == f_count));
  stopped_outside : assert (stop || (state == RUN && !write_error && !aborted));
  runs_to_the_end : assert (!f_run || state == (f_idle ? FINISH : RUN) || f_reset);
  go_is_run : assert (!f_go || state == RUN);
  one_event : assert (!(event_done && event_error) && (!(event_done || event_error) || !busy));
  done_or_error : assert (!(done && error) && (busy || error == (code != 0)));
  events_match : assert ((!event_done || done) && (!event_error || error));
  starts : assert (!f_start || (busy && !done && !error && code == 0));
  legal_state : assert (state <= FINISH);
  not_done_yet : assert (state == IDLE || state == FINISH || (!done && !error));
  copies : assert (state == IDLE || (source_at == f_source[ADDR_W-1:0] &&
      destination_at == f_destination[ADDR_W-1:0] && job_count == f_count));
  high_is : assert (state == IDLE || high == {f_destination >= f_limit, f_source >= f_limit});
  ends_are : assert (state != COMPARE || ((f_source >= f_limit || source_end == f_source_end) &&
                     (f_destination >= f_limit || destination_end == f_destination_end)));
  crooked_is : assert (state == IDLE || crooked == {f_destination[LOG2_RECORD-1:0] != 0, f_source[LOG2_RECORD-1:0] != 0});
  past_is : assert (state != DECIDE || !f_low || (overlap == !f_apart || f_count == 0));
  limits_are : assert (state != DECIDE || (past[0] == (f_source_end > f_limit || f_source >= f_limit) &&
                       past[1] == (f_destination_end > f_limit || f_destination >= f_limit)));
  code_is : assert ((state != ENDS && state != COMPARE && state != DECIDE) || code == 0);
end

always @* if (f_on && !rst) begin
  ends_well : cover (event_done && clocks > 4);
  ends_badly : cover (event_error && code == WRITE_SLVERR);
  is_refused : cover (event_error && code == 4'd5);
  is_aborted : cover (f_abort && state == IDLE && clocks > 4);
end

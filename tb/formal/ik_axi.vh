// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axi. The engines' assumptions about each other hold, so their separate proofs apply to the whole. A
// job is never stuck; docs/verification.md derives from this that a job ends if the memory responds.
//
// Assumptions about the memory: it sends data only if they were requested (f_data of ik_axi_read.vh), and a response
// only for a burst of which it has accepted the address and all data (f_answered). f_length restricts nothing: it sets
// the free job length of ik_axi_write.vh. All other assumptions of the engines are asserted (chformal -assume2assert).
// Wires \u_*.* are signals of the engines, connected by name when the hierarchy is flattened.

(* hierconn *) wire [9:0] \u_records.g_axis.u_axis.inside ;
(* hierconn *) wire \u_records.g_axis.u_axis.s_axis_tready ;
`ifdef IK_FOLD
// targets that wait in front of a folded core: in memory, and with the output register
(* hierconn *) wire [LOG2_PLACES:0] \u_records.g_wait.u_targets.wr_ptr ;
(* hierconn *) wire [LOG2_PLACES:0] \u_records.g_wait.u_targets.rd_ptr ;
(* hierconn *) wire \u_records.core_valid ;
wire [LOG2_PLACES:0] f_stored = \u_records.g_wait.u_targets.wr_ptr - \u_records.g_wait.u_targets.rd_ptr ;
wire [9:0] f_inside = \u_records.g_axis.u_axis.inside + f_stored + \u_records.core_valid ;
wire f_free = !f_stored[LOG2_PLACES];
wire f_moved = (f_stored != 0 && !\u_records.core_valid ) ||
    (\u_records.core_valid && \u_records.g_axis.u_axis.s_axis_tready );
`else
wire [9:0] f_inside = \u_records.g_axis.u_axis.inside ;
wire f_free = \u_records.g_axis.u_axis.s_axis_tready ;
wire f_moved = 1'b0;
`endif
(* hierconn, init = 1'b0 *) wire \u_job.f_on ;
(* hierconn *) wire [2:0] \u_job.state ;
(* hierconn *) wire \u_read.ask ;
(* hierconn *) wire [2:0] \u_read.at ;
(* hierconn *) wire [LOG2_PLACES:0] \u_read.due ;
(* hierconn *) wire [ADDR_W-6:0] \u_read.f_base ;
(* hierconn *) wire [LOG2_PLACES:0] \u_read.f_core ;
(* hierconn *) wire [31:0] \u_read.f_count ;
(* hierconn *) wire [7:0] \u_read.f_due ;
(* hierconn, init = 1'b0 *) wire \u_read.f_on ;
(* hierconn *) wire [7:0] \u_read.f_open ;
(* hierconn *) wire [31:0] \u_read.left ;
(* hierconn *) wire [LOG2_BURST:0] \u_read.size ;
(* hierconn *) wire \u_read.sized ;
(* hierconn *) wire [2:0] \u_records.u_result.beat ;
(* hierconn *) wire \u_records.u_result.ends ;
(* hierconn *) wire \u_records.target_valid ;
(* hierconn *) wire \u_records.result_valid ;
(* hierconn *) wire \u_write.ended ;
(* hierconn *) wire [ADDR_W-6:0] \u_write.f_base ;
(* hierconn *) wire [31:0] \u_write.f_count ;
(* hierconn *) wire [31:0] \u_write.f_got ;
(* hierconn *) wire [LOG2_BURST:0] \u_write.f_last ;
(* hierconn *) wire [LOG2_BURST:0] \u_write.f_newest ;
(* hierconn *) wire [31:0] \u_write.f_next_count ;
(* hierconn *) wire [LOG2_BURST:0] \u_write.f_oldest ;
(* hierconn, init = 1'b0 *) wire \u_write.f_on ;
(* hierconn *) wire [7:0] \u_write.f_open ;
(* hierconn *) wire [7:0] \u_write.f_waits ;
(* hierconn *) wire [LOG2_PLACES:0] \u_write.ready ;
(* hierconn *) wire [LOG2_BURST:0] \u_write.size ;
(* hierconn *) wire \u_write.sized ;
(* hierconn *) wire \u_write.issue ;
(* hierconn *) wire [LOG2_PLACES:0] \u_write.to_send ;
(* hierconn *) wire \u_write.whole ;
localparam [2:0] F_ENDS = 3'd1, F_DECIDE = 3'd3, F_RUN = 3'd4, F_FINISH = 3'd5;
localparam [2:0] F_LAST = 256 / DATA_W - 1;
wire f_running = \u_job.state == F_RUN;

// ---- ghost: bursts on the bus that still have beats to send on W ----

wire f_gone = m_axi_wvalid && m_axi_wready;
wire [7:0] f_open;
wire [LOG2_BURST:0] f_oldest, f_newest;
ik_bursts #(.N(LOG2_BURST + 1), .S(8), .WHOLE(1 << LOG2_BURST)) f_bus (
    .clk(clk), .clear(rst || go), .push(\u_write.issue ), .size(\u_write.size ), .pop(f_gone &&
        \u_records.u_result.beat == F_LAST), .drop(1'b0),
    .n(f_open), .oldest(f_oldest), .newest(f_newest), .sum(), .middle()
);
wire f_owes_answer = \u_write.f_waits - m_axi_awvalid > f_open;  // a burst accepted as a whole has no response yet
always @* begin
  f_answered : assume (!m_axi_bvalid || f_owes_answer);
  f_length : assume (\u_write.f_next_count == job_count);
end

// ---- ghost: events of a job, and whether the memory or ik_axis has to act ----

wire f_event = \u_read.ask || (m_axi_arvalid && m_axi_arready) || m_axi_rvalid || record_valid ||
    \u_records.target_valid || \u_write.issue || f_moved ||
    (m_axi_awvalid && m_axi_awready) || leave || f_gone || m_axi_bvalid;
// the memory or ik_axis has to act next
wire f_owed = m_axi_arvalid || \u_read.due != 0 || m_axi_awvalid || m_axi_wvalid || f_owes_answer ||
    (f_inside != 0 && !\u_records.result_valid );
reg [1:0] f_still;  // clocks of a job in a row with neither f_event nor f_owed
always @(posedge clk) begin
  f_still <= (rst || !f_running || f_event || f_owed) ? 2'd0 : f_still + (f_still != 3);
end

// ---- properties ----

wire [ADDR_W+1:0] f_source = {2'b00, job_source, 5'd0};
wire [ADDR_W+1:0] f_destination = {2'b00, job_destination, 5'd0};
wire [ADDR_W+1:0] f_bytes = {job_count[ADDR_W-4:0], 5'd0};
wire [ADDR_W+1:0] f_read_end = m_axi_araddr + ((m_axi_arlen + 1'b1) << m_axi_arsize);
wire [ADDR_W+1:0] f_write_end = m_axi_awaddr + ((m_axi_awlen + 1'b1) << m_axi_awsize);

always @* if (\u_job.f_on ) begin
  read_inside : assert (!m_axi_arvalid || (m_axi_araddr >= f_source && f_read_end <= f_source + f_bytes));
  written_inside : assert (!m_axi_awvalid || (m_axi_awaddr >= f_destination && f_write_end <= f_destination + f_bytes));
  wlast_as_announced : assert (!m_axi_wvalid || (f_open != 0 && m_axi_wlast == (f_oldest == 1 &&
      \u_records.u_result.beat == F_LAST)));
  never_refused : assert (rst || !\u_records.target_valid || f_free);
  quiet : assert (f_running || (!m_axi_arvalid && \u_read.f_open == 0 && !m_axi_awvalid && !m_axi_wvalid &&
      \u_write.f_waits == 0 && \u_write.f_open == 0));
  some_in_each_burst : assert ((!\u_read.ask || \u_read.size != 0) && (!\u_write.issue || \u_write.size != 0));
  // a job never has two clocks in a row without an event in which neither the memory nor ik_axis has to act
  never_stuck : assert (!f_running || f_still < 2);
end

// ---- helping invariants ----

always @* if (\u_job.f_on || \u_read.f_on || \u_write.f_on ) together : assert (\u_job.f_on && \u_read.f_on &&
    \u_write.f_on );
always @* if (\u_job.f_on ) begin
  none_on_the_way : assert (f_running || (!record_valid && (!\u_records.target_valid || \u_job.state == F_FINISH)));
`ifdef IK_FOLD
  stored_fits : assert (f_stored <= 1 << LOG2_PLACES && \u_records.g_axis.u_axis.inside <= 2);
`endif
  inside_fits : assert (f_inside <= 1 << LOG2_PLACES);
  emptied : assert (\u_job.state <= F_ENDS || \u_job.state > F_DECIDE || f_inside == 0);
  core_is : assert (\u_read.f_core >= record_valid + \u_records.target_valid + f_inside &&
      (!f_running || \u_read.f_core == record_valid + \u_records.target_valid + f_inside ));
  to_write_is : assert (!f_running || {1'b0, \u_read.f_core } == \u_write.ready + \u_write.to_send );
  counts_are : assert (!f_running || (\u_read.f_count == job_count && \u_write.f_count == job_count && job_count != 0));
  bases_are : assert (!f_running || (\u_read.f_base == job_source && \u_write.f_base == job_destination));
  areas_are : assert (!f_running || (f_source + {3'd0, job_count, 5'd0} <= {2'b01, {ADDR_W{1'b0}}} && f_destination +
      {3'd0, job_count, 5'd0} <= {2'b01, {ADDR_W{1'b0}}}));
  got_is : assert (!f_running || read_error || \u_write.f_got + \u_read.due + \u_read.left == job_count);
  beat_is : assert (\u_records.u_result.beat <= F_LAST || !m_axi_wvalid);
  at_is : assert (\u_read.at <= F_LAST && (\u_read.due != 0 || \u_read.at == 0 || !f_running));
  bus_is : assert (!m_axi_wvalid ? f_open == \u_write.f_open && (f_open == 0 || f_oldest == \u_write.f_oldest ) :
                   \u_records.u_result.ends ? f_open == \u_write.f_open + 1 && f_oldest == 1 : f_open == \u_write.f_open &&
                       f_open != 0 && f_oldest == \u_write.f_oldest + 1);
  bus_newest : assert ((f_open == 0 || f_newest == \u_write.f_newest ) && (\u_write.f_waits == 0 ||
      \u_write.f_last == \u_write.f_newest ));
  bus_behind : assert (\u_write.f_waits >= f_open && \u_write.f_waits <= 8);
  offered_waits : assert (!m_axi_awvalid || \u_write.f_waits != 0);
  bus_next : assert (!m_axi_wvalid || !\u_records.u_result.ends || \u_write.f_open == 0 ||
      \u_write.f_oldest == ((\u_write.f_open == 1) ? \u_write.f_newest : 1 << LOG2_BURST));
  still_sized : assert (!f_running || f_still == 0 || \u_read.sized || \u_write.sized || f_event || f_owed || stop);
  still_issued : assert (!f_running || f_still == 0 || \u_write.sized || f_event || f_owed || stop ||
      !(\u_write.whole || (\u_write.ended && \u_write.ready != 0)));
end

// ---- cover: a job of one record, started through the registers, with a memory that never waits ----

`ifdef IK_COVER
reg [5:0] f_clock = 6'd0;
always @(posedge clk) f_clock <= f_clock + 1'b1;
wire [1:0] f_nth = (f_clock - 2) / 4;  // COUNT = 1, DESTINATION_LO = 4096, CONTROL = start
wire [11:0] f_register = (f_nth == 0) ? 12'h1c : (f_nth == 1) ? 12'h28 : 12'h0c;
wire f_write = f_clock >= 2 && f_clock < 14 && f_clock[1:0] == 2;
always @* begin
  assume (rst == (f_clock == 0) && m_axi_arready && m_axi_awready && m_axi_wready && s_axi_bready && !s_axi_arvalid);
  assume (m_axi_rvalid == (\u_read.f_due != 0) && m_axi_bvalid == f_owes_answer && {m_axi_rresp, m_axi_bresp,
      m_axi_rdata} == 0);
  assume (s_axi_awvalid == f_write && s_axi_wvalid == f_write && s_axi_awaddr == f_register && s_axi_wstrb == 4'hf);
  assume (s_axi_wdata == ((f_nth == 1) ? 32'h1000 : 32'd1) && s_axi_rready);
end
`endif
always @* if (\u_job.f_on && !rst) begin
  job_done : cover (event_done && job_count == 1 && written == 1);
end

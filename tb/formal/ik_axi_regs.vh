// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axi_regs: each access gets one response, stable until accepted, and no other responses occur; only
// writes change parameters; reported events stay in IRQ_STATUS until cleared. No assumptions.

reg f_on = 1'b0;  // since the first reset
reg f_reset;
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

// ---- ghost: accesses that wait for a response ----

reg [1:0] f_addresses, f_words, f_reads;  // accepted accesses whose response is not accepted yet
wire f_answered = s_axi_bvalid && s_axi_bready;
always @(posedge clk) begin
  f_addresses <= rst ? 2'd0 : f_addresses + (s_axi_awvalid && s_axi_awready) - f_answered;
  f_words <= rst ? 2'd0 : f_words + (s_axi_wvalid && s_axi_wready) - f_answered;
  f_reads <= rst ? 2'd0 : f_reads + (s_axi_arvalid && s_axi_arready) - (s_axi_rvalid && s_axi_rready);
end

// ---- properties ----

reg f_bstall, f_rstall, f_write, f_soft, f_erase;
reg [1:0] f_bheld;
reg [33:0] f_rheld;
reg [159:0] f_kept;
reg [2:0] f_events, f_irq;
always @(posedge clk) begin
  f_bstall <= s_axi_bvalid && !s_axi_bready && !rst;
  f_bheld <= s_axi_bresp;
  f_rstall <= s_axi_rvalid && !s_axi_rready && !rst;
  f_rheld <= {s_axi_rresp, s_axi_rdata};
  f_write <= write || rst;
  f_kept <= {count, source, destination};
  f_events <= (rst || soft_reset) ? 3'd0 : events;
  f_irq <= irq_status;
  f_erase <= rst || soft_reset || (write && waddr == A_IRQ_STATUS);
end

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || (!s_axi_bvalid && !s_axi_rvalid && !irq && !start && !soft_reset));
  b_stable : assert (!f_bstall || (s_axi_bvalid && s_axi_bresp == f_bheld));
  r_stable : assert (!f_rstall || (s_axi_rvalid && {s_axi_rresp, s_axi_rdata} == f_rheld));
  b_for_a_write : assert (!s_axi_bvalid || (f_addresses != 0 && f_words != 0));
  r_for_a_read : assert (!s_axi_rvalid || f_reads != 0);
  parameters_stay : assert (f_write || {count, source, destination} == f_kept);
  event_is_kept : assert ((f_events & ~irq_status) == 0);
  kept_until_erased : assert (f_erase || (f_irq & ~irq_status) == 0);
  start_or_reset : assert (!(start && soft_reset));
  counted : assert (f_addresses == waddr_held + s_axi_bvalid && f_words == wdata_held + s_axi_bvalid &&
      f_reads == raddr_held + s_axi_rvalid);
end

always @* if (f_on && !rst) begin
  word_first : cover (f_words == 2 && f_addresses == 1);
  refused : cover (s_axi_bvalid && s_axi_bresp == SLVERR);
  two_reads : cover (f_reads == 2);
end

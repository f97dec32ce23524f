// SPDX-License-Identifier: Apache-2.0
// Appended to ik_axi_result: beats are stable until accepted, and the beats of a record are its words, in order, once
// each. No assumptions.

reg f_on = 1'b0;  // since the first reset
reg f_reset;
always @(posedge clk) begin
  if (rst) f_on <= 1'b1;
  f_reset <= rst;
end

// ---- ghost: the record that is leaving ----

reg [BITS-1:0] f_record;
reg f_ends;
reg [B-1:0] f_gone;  // beats sent
wire f_take = result_valid && result_ready;
always @(posedge clk) begin
  if (f_take) begin
    f_record <= words;
    f_ends   <= ends_burst;
    f_gone   <= {B{1'b0}};
  end else if (gone) f_gone <= f_gone + 1'b1;
end

// ---- properties ----

reg f_stall, f_took;
reg [DATA_W:0] f_held;
always @(posedge clk) begin
  f_stall <= m_axi_wvalid && !m_axi_wready && !rst;
  f_held <= {m_axi_wlast, m_axi_wdata};
  f_took <= f_take && !rst;
end
wire [DATA_W-1:0] f_due = f_record >> {{(32 - B) {1'b0}}, f_gone} * DATA_W;

always @* if (f_on) begin
  low_after_reset : assert (!f_reset || !m_axi_wvalid);
  stable : assert (!f_stall || (m_axi_wvalid && {m_axi_wlast, m_axi_wdata} == f_held));
  in_order : assert (!m_axi_wvalid || m_axi_wdata == f_due);
  last_of_burst : assert (!m_axi_wvalid || m_axi_wlast == (f_ends && f_gone == LAST_BEAT));
  at_once : assert (!f_took || m_axi_wvalid);
  none_lost : assert (!result_ready || rst || !m_axi_wvalid || (m_axi_wready && f_gone == LAST_BEAT));
  allowed_only : assert (!result_ready || allowed);
  beat_is : assert (!m_axi_wvalid || (beat == f_gone && beat <= LAST_BEAT && ends == f_ends &&
      record == f_record >> {{(32 - B) {1'b0}}, f_gone} * DATA_W));
end

always @* if (f_on && !rst) begin
  record_after_record : cover (f_take && m_axi_wvalid);
  last_beat : cover (m_axi_wvalid && m_axi_wlast && gone);
end

// Solves the records of a job: rounds a target to W bits, passes it through the core, and returns its result's record.
// SPDX-License-Identifier: Apache-2.0
//
// Rounding as in ik_axi_target; results are exact.
// Records, see ik_axi: of 32 bytes through ik_axis, of 64 through ik_arm. A record is taken whenever it is valid:
// ik_axi_read requests it only if a slot is free, of the core's FIFO or, for a folded core, of the one here.
// Throughput: one record per clock in, one beat per clock out.
// Latency: 1 clock from record_valid to the core, 3 clocks to a folded one; 1 clock from its result to the first beat.
`default_nettype none

module ik_axi_records #(
    parameter integer W           = 32,  // word length, 16 to 32
    parameter integer DATAPATH    = 1,   // of the core
    parameter integer DIGIT       = 0,
    parameter integer TILE        = 18,
    parameter integer DATA_W      = 64,  // data bus width
    parameter integer LOG2_PLACES = 4,   // log2 of the targets in front of a folded core
    parameter integer LOG2_RECORD = 5    // log2 of a record's bytes: 5 for ik_axis, 6 for ik_arm
) (
    input  wire                          clk,
    input  wire                          rst,
    // Job
    input  wire                          go,            // a job begins: the next result has index 0
    input  wire                          clear,         // discards all targets
    input  wire [             14*32-1:0] limits,        // lower ends of th1 .. th7, then upper ends; static
    // Target
    input  wire                          record_valid,
    input  wire [(8<<LOG2_RECORD)-1:0]   record,
    // Result
    output wire                          leave,         // a result leaves the core
    input  wire                          allowed,       // see ik_axi_result
    input  wire                          ends_burst,
    output wire [            DATA_W-1:0] m_axi_wdata,
    output wire                          m_axi_wlast,
    output wire                          m_axi_wvalid,
    input  wire                          m_axi_wready
);

  localparam integer ARM = (LOG2_RECORD == 6) ? 1 : 0;
  localparam integer TAG_W = 24;
  localparam integer USER_W = (ARM == 1) ? TAG_W + 3 : TAG_W;  // with the branch
  localparam integer INPUTS = (ARM == 1) ? 11 : 6;  // words of a target
  localparam integer RESULTS = (ARM == 1) ? 13 : 6;  // words of a result's record, without tag, index and over_limit

  // ---- target ----

  wire target_valid, result_valid, result_ready;
  wire [INPUTS*W-1:0] target;
  wire [RESULTS*W-1:0] result;
  wire [USER_W-1:0] tag;
  wire [TAG_W+7:0] flags_tag;
  wire [31:0] over_limit;

  ik_axi_target #(
      .W          (W),
      .TAG_W      (USER_W),
      .LOG2_RECORD(LOG2_RECORD)
  ) u_target (
      .clk         (clk),
      .rst         (rst),
      .record_valid(record_valid),
      .record      (record),
      .target_valid(target_valid),
      .target      (target),
      .tag         (tag)
  );

  // ---- core ----

  // A pipeline's tready is always high, as a slot is reserved. Targets wait for a folded core, which takes one per lap.
  wire core_valid, core_ready;
  wire [INPUTS*W-1:0] core_target;
  wire [USER_W-1:0] core_tag;
  generate
    if (DATAPATH == 2) begin : g_wait
      ik_fifo #(
          .W   (USER_W + INPUTS * W),
          .LOG2(LOG2_PLACES)
      ) u_targets (
          .clk    (clk),
          .rst    (rst || clear),
          .wr_en  (target_valid),
          .wr_data({tag, target}),
          .m_valid(core_valid),
          .m_ready(core_ready),
          .m_data ({core_tag, core_target})
      );
    end else begin : g_direct
      assign {core_valid, core_tag, core_target} = {target_valid, tag, target};
    end
  endgenerate

  generate
    if (ARM == 1) begin : g_arm
      wire [17*W-1:0] words;  // th1 .. th7, qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, qw_w, qw_i, qw_j, qw_k
      wire [14*W-1:0] pairs;  // lower and upper limit of th1, .. th7
      wire [7:0] over;  // bad_hand, th1 .. th7
      genvar i;
      for (i = 0; i < 7; i = i + 1) begin : g_joint
        assign pairs[2*W*i+:2*W] = {limits[32*(i+7)+31-:W], limits[32*i+31-:W]};
      end
      assign result = words[RESULTS*W-1:0];
      assign over_limit = {23'd0, over[0], 1'b0, over[7:1]};

      ik_arm #(
          .W       (W),
          .TAG_W   (TAG_W),
          .DATAPATH(DATAPATH),
          .TILE    (TILE)
      ) u_arm (
          .clk          (clk),
          .rst          (rst || clear),
          .limits       (pairs),
          .s_axis_tdata (core_target),
          .s_axis_tuser (core_tag),
          .s_axis_tvalid(core_valid),
          .s_axis_tready(core_ready),
          .m_axis_tdata (words),
          .m_axis_tuser ({over, flags_tag}),
          .m_axis_tvalid(result_valid),
          .m_axis_tready(result_ready)
      );
    end else begin : g_axis
      assign over_limit = 32'd0;

      ik_axis #(
          .W       (W),
          .TAG_W   (TAG_W),
          .DATAPATH(DATAPATH),
          .DIGIT   (DIGIT),
          .TILE    (TILE)
      ) u_axis (
          .clk          (clk),
          .rst          (rst || clear),
          .s_axis_tdata (core_target),
          .s_axis_tuser (core_tag),
          .s_axis_tvalid(core_valid),
          .s_axis_tready(core_ready),
          .m_axis_tdata (result),
          .m_axis_tuser (flags_tag),
          .m_axis_tvalid(result_valid),
          .m_axis_tready(result_ready)
      );
    end
  endgenerate

  // ---- result ----

  assign leave = result_valid && result_ready;
  reg [31:0] index;
  always @(posedge clk) begin
    if (go) index <= 32'd0;
    else if (leave) index <= index + 32'd1;
  end

  ik_axi_result #(
      .W          (W),
      .DATA_W     (DATA_W),
      .LOG2_RECORD(LOG2_RECORD)
  ) u_result (
      .clk         (clk),
      .rst         (rst),
      .result      (result),
      .flags_tag   (flags_tag),
      .index       (index),
      .over_limit  (over_limit),
      .result_valid(result_valid),
      .result_ready(result_ready),
      .allowed     (allowed),
      .ends_burst  (ends_burst),
      .m_axi_wdata (m_axi_wdata),
      .m_axi_wlast (m_axi_wlast),
      .m_axi_wvalid(m_axi_wvalid),
      .m_axi_wready(m_axi_wready)
  );

endmodule

`default_nettype wire

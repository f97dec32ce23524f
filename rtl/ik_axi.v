// Inverse kinematics from memory to memory: AXI4-Lite registers, and an AXI4 master around ik_axis or ik_arm.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds Q2.30 input words half up to W bits: lengths saturate, phi wraps. Results are exact, shifted left to 32 bits.
// The master reads targets and writes results in bursts. Records are little endian, the same for every W; ik_axi_target
// and ik_axi_result have their words. 32 bytes, target: x, y, z, phi, d1, d2, tag, 0; result: qs_w, qs_i, qs_j, qs_k,
// qe_w, qe_i, flags << 24 | tag, index. 64 bytes with ARM = 1, hand pose: x, y, z, phi, d1, d2, tool, branch << 24 |
// tag, qh_w .. qh_k, 4 unused; result: th1 .. th7, flags << 24 | tag, qs_w .. qs_k, qe_w, qe_i, index, over_limit (bit
// k-1: th k; bit 8: bad_hand).
//
// Accesses stay within the two areas. No burst crosses 4 KiB; rready and bready are always high. A record is requested
// only when there is a slot for it, in the core's FIFO of results or in a folded core's FIFO of targets, so none is
// refused and no deadlock is possible.
// Latency: 2 clocks from a record's last R beat to the core, or 4 if it is folded; 1 clock from a result to its first W
// beat.
`default_nettype none

module ik_axi #(
    parameter integer W          = 32,  // word length, 16 to 32
    parameter integer DATAPATH   = 1,   // 0 paper, 1 lean, 2 fold (lean on one multiplier): W even, 20 or more
    parameter integer DIGIT      = 0,   // paper dividers and roots: 1 digit recurrence, 0 behavioural
    parameter integer TILE       = 18,  // multiplier blocks of lean and fold, see ik_axis and ik_arm
    parameter integer ADDR_W     = 32,  // address width: 12 to 64, 13 to 64 with ARM = 1
    parameter integer DATA_W     = 64,  // data bus width: 32, 64 or 128
    parameter integer LOG2_BURST = 3,   // log2 of records per full burst, 1 to 5; at most 256 beats
    parameter integer ARM        = 0    // 1: hand pose to joint angles, with DATAPATH 1 or 2
) (
    // Clock, reset, interrupt; attributes for block designs of Vivado, which infers the buses from the ports' names
    (* X_INTERFACE_INFO = "xilinx.com:signal:clock:1.0 clk CLK" *)
    (* X_INTERFACE_PARAMETER = "ASSOCIATED_BUSIF s_axi:m_axi, ASSOCIATED_RESET rst" *)
    input  wire                clk,
    (* X_INTERFACE_INFO = "xilinx.com:signal:reset:1.0 rst RST" *)
    (* X_INTERFACE_PARAMETER = "POLARITY ACTIVE_HIGH" *)
    input  wire                rst,            // synchronous, active high: the interconnect's aresetn, inverted
    (* X_INTERFACE_INFO = "xilinx.com:signal:interrupt:1.0 irq INTERRUPT" *)
    (* X_INTERFACE_PARAMETER = "SENSITIVITY LEVEL_HIGH" *)
    output wire                irq,
    // Registers (ik_axi.rdl)
    input  wire [        11:0] s_axi_awaddr,
    input  wire [         2:0] s_axi_awprot,
    input  wire                s_axi_awvalid,
    output wire                s_axi_awready,
    input  wire [        31:0] s_axi_wdata,
    input  wire [         3:0] s_axi_wstrb,
    input  wire                s_axi_wvalid,
    output wire                s_axi_wready,
    output wire [         1:0] s_axi_bresp,
    output wire                s_axi_bvalid,
    input  wire                s_axi_bready,
    input  wire [        11:0] s_axi_araddr,
    input  wire [         2:0] s_axi_arprot,
    input  wire                s_axi_arvalid,
    output wire                s_axi_arready,
    output wire [        31:0] s_axi_rdata,
    output wire [         1:0] s_axi_rresp,
    output wire                s_axi_rvalid,
    input  wire                s_axi_rready,
    // Memory, read
    output wire [         0:0] m_axi_arid,
    output wire [  ADDR_W-1:0] m_axi_araddr,
    output wire [         7:0] m_axi_arlen,
    output wire [         2:0] m_axi_arsize,
    output wire [         1:0] m_axi_arburst,
    output wire [         3:0] m_axi_arcache,
    output wire [         2:0] m_axi_arprot,
    output wire                m_axi_arvalid,
    input  wire                m_axi_arready,
    input  wire [         0:0] m_axi_rid,
    input  wire [  DATA_W-1:0] m_axi_rdata,
    input  wire [         1:0] m_axi_rresp,
    input  wire                m_axi_rlast,
    input  wire                m_axi_rvalid,
    output wire                m_axi_rready,
    // Memory, write
    output wire [         0:0] m_axi_awid,
    output wire [  ADDR_W-1:0] m_axi_awaddr,
    output wire [         7:0] m_axi_awlen,
    output wire [         2:0] m_axi_awsize,
    output wire [         1:0] m_axi_awburst,
    output wire [         3:0] m_axi_awcache,
    output wire [         2:0] m_axi_awprot,
    output wire                m_axi_awvalid,
    input  wire                m_axi_awready,
    output wire [  DATA_W-1:0] m_axi_wdata,
    output wire [DATA_W/8-1:0] m_axi_wstrb,
    output wire                m_axi_wlast,
    output wire                m_axi_wvalid,
    input  wire                m_axi_wready,
    input  wire [         0:0] m_axi_bid,
    input  wire [         1:0] m_axi_bresp,
    input  wire                m_axi_bvalid,
    output wire                m_axi_bready
);

  `include "ik_latency.vh"
  `include "ik_arm_nodes.vh"

  function integer clog2(input integer n);
    begin
      clog2 = 0;
      while ((1 << clog2) < n) clog2 = clog2 + 1;
    end
  endfunction

  localparam integer LOG2_RECORD = (ARM == 1) ? 6 : 5;  // log2 of a record's bytes
  localparam FOLDED = DATAPATH == 2;
  localparam integer FOLD_LATENCY = (ARM == 0) ? 99 : (W <= 24) ? 238 : 246;  // as in the model: a test compares them
  localparam integer PIPELINE_LATENCY = ((ARM == 1) ? T_OUT : datapath_latency(DATAPATH, W, TILE)) + 2;
  localparam integer LATENCY = FOLDED ? FOLD_LATENCY : PIPELINE_LATENCY;
  // FIFO slots: of the core's results, or of two bursts of targets in front of a folded core
  localparam integer LOG2_PLACES = FOLDED ? LOG2_BURST + 1 : clog2(LATENCY + 1);
  localparam integer LOG2_BURSTS = 3;  // at most 8 outstanding bursts in each direction

  generate
    if (DATA_W != 32 && DATA_W != 64 && DATA_W != 128) begin : g_data
      ik_axi_illegal_DATA_W u_stop ();
    end
    if (ADDR_W < LOG2_RECORD + 7 || ADDR_W > 64) begin : g_address
      ik_axi_illegal_ADDR_W u_stop ();
    end
    if (LOG2_BURST < 1 || LOG2_BURST > 5 || (8 << LOG2_BURST << LOG2_RECORD) > 256 * DATA_W) begin : g_burst
      ik_axi_illegal_LOG2_BURST u_stop ();
    end
    if (DATAPATH < ARM || DATAPATH > 2) begin : g_datapath
      ik_axi_illegal_DATAPATH u_stop ();
    end
    if (ARM != 0 && ARM != 1) begin : g_kind
      ik_axi_illegal_ARM u_stop ();
    end
  endgenerate

  // ---- AXI constants: one ID, full-width beats, INCR, normal non-cacheable bufferable memory ----

  localparam [2:0] SIZE = (DATA_W == 32) ? 3'd2 : (DATA_W == 64) ? 3'd3 : 3'd4;
  assign {m_axi_arid, m_axi_arsize, m_axi_arburst, m_axi_arcache, m_axi_arprot} = {1'b0, SIZE, 2'b01, 4'b0011, 3'b000};
  assign {m_axi_awid, m_axi_awsize, m_axi_awburst, m_axi_awcache, m_axi_awprot} = {1'b0, SIZE, 2'b01, 4'b0011, 3'b000};
  assign m_axi_wstrb = {(DATA_W / 8) {1'b1}};
  assign m_axi_rready = 1'b1;
  assign m_axi_bready = 1'b1;

  // ---- registers and the job ----

  wire start, soft_reset, busy, done, error, event_done, event_error, event_refused;
  wire [63:0] source, destination, error_address;
  wire [31:0] count, written, clocks, read_stalls, write_stalls;
  wire [3:0] code;
  wire [14*32-1:0] limits;

  ik_axi_regs #(
      .W      (W),
      .DATAPATH   (DATAPATH),
      .DIGIT  (DIGIT),
      .ADDR_W (ADDR_W),
      .DATA_W (DATA_W),
      .LATENCY(LATENCY),
      .PLACES (1 << LOG2_PLACES),
      .ARM    (ARM)
  ) u_regs (
      .clk          (clk),
      .rst          (rst),
      .s_axi_awaddr (s_axi_awaddr),
      .s_axi_awvalid(s_axi_awvalid),
      .s_axi_awready(s_axi_awready),
      .s_axi_wdata  (s_axi_wdata),
      .s_axi_wstrb  (s_axi_wstrb),
      .s_axi_wvalid (s_axi_wvalid),
      .s_axi_wready (s_axi_wready),
      .s_axi_bresp  (s_axi_bresp),
      .s_axi_bvalid (s_axi_bvalid),
      .s_axi_bready (s_axi_bready),
      .s_axi_araddr (s_axi_araddr),
      .s_axi_arvalid(s_axi_arvalid),
      .s_axi_arready(s_axi_arready),
      .s_axi_rdata  (s_axi_rdata),
      .s_axi_rresp  (s_axi_rresp),
      .s_axi_rvalid (s_axi_rvalid),
      .s_axi_rready (s_axi_rready),
      .start        (start),
      .soft_reset   (soft_reset),
      .source       (source),
      .destination  (destination),
      .count        (count),
      .busy         (busy),
      .done         (done),
      .error        (error),
      .code         (code),
      .error_address(error_address),
      .written      (written),
      .clocks       (clocks),
      .read_stalls  (read_stalls),
      .write_stalls (write_stalls),
      .events       ({event_refused, event_error, event_done}),
      .irq          (irq),
      .limits       (limits)
  );

  wire clear, go, stop;
  wire [ADDR_W-1:LOG2_RECORD] job_source, job_destination;
  wire [31:0] job_count, good;
  wire [LOG2_RECORD-3:0] error_beat;
  wire read_idle, ended, read_error, read_decode, read_waiting, write_idle, write_error, write_decode;

  ik_axi_job #(
      .ADDR_W     (ADDR_W),
      .DATA_W     (DATA_W),
      .LOG2_RECORD(LOG2_RECORD)
  ) u_job (
      .clk            (clk),
      .rst            (rst),
      .start          (start),
      .soft_reset     (soft_reset),
      .source         (source),
      .destination    (destination),
      .count          (count),
      .busy           (busy),
      .done           (done),
      .error          (error),
      .code           (code),
      .error_address  (error_address),
      .event_done     (event_done),
      .event_error    (event_error),
      .event_refused  (event_refused),
      .clocks         (clocks),
      .read_stalls    (read_stalls),
      .write_stalls   (write_stalls),
      .clear          (clear),
      .go             (go),
      .stop           (stop),
      .job_source     (job_source),
      .job_destination(job_destination),
      .job_count      (job_count),
      .read_idle      (read_idle),
      .read_waiting   (read_waiting),
      .read_error     (read_error),
      .read_decode    (read_decode),
      .read_good      (good),
      .read_beat      (error_beat),
      .write_idle     (write_idle),
      .write_waiting  (m_axi_wvalid && !m_axi_wready),
      .write_error    (write_error),
      .write_decode   (write_decode),
      .written        (written)
  );

  // ---- memory to core to memory ----

  wire got, record_valid, leave, allowed, ends_burst;
  wire [(8<<LOG2_RECORD)-1:0] record;

  ik_axi_read #(
      .ADDR_W     (ADDR_W),
      .DATA_W     (DATA_W),
      .LOG2_BURST (LOG2_BURST),
      .LOG2_PLACES(LOG2_PLACES),
      .LOG2_BURSTS(LOG2_BURSTS),
      .LOG2_RECORD(LOG2_RECORD)
  ) u_read (
      .clk          (clk),
      .rst          (rst),
      .go           (go),
      .stop         (stop),
      .source       (job_source),
      .count        (job_count),
      .idle         (read_idle),
      .ended        (ended),
      .error        (read_error),
      .error_decode (read_decode),
      .good         (good),
      .error_beat   (error_beat),
      .waiting      (read_waiting),
      .got          (got),
      .record_valid (record_valid),
      .record       (record),
      .leave        (leave),
      .m_axi_araddr (m_axi_araddr),
      .m_axi_arlen  (m_axi_arlen),
      .m_axi_arvalid(m_axi_arvalid),
      .m_axi_arready(m_axi_arready),
      .m_axi_rdata  (m_axi_rdata),
      .m_axi_rresp  (m_axi_rresp),
      .m_axi_rvalid (m_axi_rvalid)
  );

  ik_axi_records #(
      .W          (W),
      .DATAPATH   (DATAPATH),
      .DIGIT      (DIGIT),
      .TILE       (TILE),
      .DATA_W     (DATA_W),
      .LOG2_PLACES(LOG2_PLACES),
      .LOG2_RECORD(LOG2_RECORD)
  ) u_records (
      .clk         (clk),
      .rst         (rst),
      .go          (go),
      .clear       (clear),
      .limits      (limits),
      .record_valid(record_valid),
      .record      (record),
      .leave       (leave),
      .allowed     (allowed),
      .ends_burst  (ends_burst),
      .m_axi_wdata (m_axi_wdata),
      .m_axi_wlast (m_axi_wlast),
      .m_axi_wvalid(m_axi_wvalid),
      .m_axi_wready(m_axi_wready)
  );

  ik_axi_write #(
      .ADDR_W     (ADDR_W),
      .DATA_W     (DATA_W),
      .LOG2_BURST (LOG2_BURST),
      .LOG2_PLACES(LOG2_PLACES),
      .LOG2_BURSTS(LOG2_BURSTS),
      .LOG2_RECORD(LOG2_RECORD)
  ) u_write (
      .clk          (clk),
      .rst          (rst),
      .go           (go),
      .stop         (stop),
      .destination  (job_destination),
      .got          (got),
      .ended        (ended),
      .idle         (write_idle),
      .error        (write_error),
      .error_decode (write_decode),
      .written      (written),
      .allowed      (allowed),
      .ends_burst   (ends_burst),
      .leave        (leave),
      .m_axi_wvalid (m_axi_wvalid),
      .m_axi_awaddr (m_axi_awaddr),
      .m_axi_awlen  (m_axi_awlen),
      .m_axi_awvalid(m_axi_awvalid),
      .m_axi_awready(m_axi_awready),
      .m_axi_bresp  (m_axi_bresp),
      .m_axi_bvalid (m_axi_bvalid)
  );

endmodule

`default_nettype wire

// Read engine of ik_axi: requests bursts, and assembles R beats, in order, into records.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; beats of DATA_W bits.
// A burst ends at the next multiple of 2^LOG2_BURST records or with the job, so none crosses 4 KiB; the same rule finds
// its end on R, so rlast is not used. A burst is requested only when a result slot is free for each of its records
// (2^LOG2_PLACES slots, returned by `leave`), so rready is always high. After an error no record is delivered and no
// burst requested; outstanding beats are accepted and dropped.
// Throughput: one beat per clock.
// Latency: 1 clock from a record's last beat; the record is valid for one clock.
`default_nettype none

module ik_axi_read #(
    parameter integer ADDR_W      = 32,  // address width
    parameter integer DATA_W      = 64,  // data bus width: 32, 64 or 128
    parameter integer LOG2_BURST  = 3,   // log2 of records per full burst, 1 to 5
    parameter integer LOG2_PLACES = 6,   // log2 of the result slots, at least LOG2_BURST + 1
    parameter integer LOG2_BURSTS = 3,   // log2 of the outstanding bursts allowed
    parameter integer LOG2_RECORD = 5    // log2 of a record's bytes, 5 or 6
) (
    input  wire              clk,
    input  wire              rst,
    // Job
    input  wire              go,           // loads source and count, clears all other state
    input  wire              stop,         // request no new burst
    input  wire [ADDR_W-1:LOG2_RECORD] source,
    input  wire [      31:0] count,
    output wire              idle,         // nothing outstanding and nothing left to request
    output wire              ended,        // `got` stays low until the next job
    output reg               error,        // sticky until go
    output reg               error_decode, // the error was DECERR
    output reg  [      31:0] good,         // records received before the first error
    output reg  [LOG2_RECORD-3:0] error_beat,   // failed beat within the next record
    output wire              waiting,      // data outstanding, none in this clock
    // Records
    output wire              got,          // record received; record_valid rises one clock later
    output reg               record_valid,
    output reg  [(8<<LOG2_RECORD)-1:0] record,
    input  wire              leave,        // a result has left; its slot is free
    // AXI4
    output reg  [ADDR_W-1:0] m_axi_araddr,
    output reg  [       7:0] m_axi_arlen,
    output reg               m_axi_arvalid,
    input  wire              m_axi_arready,
    input  wire [DATA_W-1:0] m_axi_rdata,
    input  wire [       1:0] m_axi_rresp,
    input  wire              m_axi_rvalid
);

  localparam integer BEATS = (8 << LOG2_RECORD) / DATA_W;  // per record
  localparam integer B = LOG2_RECORD - 2;  // width of a beat's number within a record
  localparam integer LAST = BEATS - 1;
  localparam [B-1:0] LAST_BEAT = LAST[B-1:0];
  localparam integer N = LOG2_BURST + 1;  // width of a record count within a burst
  localparam integer P = LOG2_PLACES + 1;
  localparam [N-1:0] WHOLE = {1'b1, {LOG2_BURST{1'b0}}};

  // ---- AR ----

  reg [ADDR_W-LOG2_RECORD-1:0] next;  // first record of the next burst
  reg [31:0] left;        // records not requested yet
  reg sized;              // `size` holds the next burst's size
  reg [N-1:0] size;
  reg [P-1:0] free;       // result slots
  reg [P-1:0] due;        // records requested and not received
  reg [LOG2_BURSTS:0] bursts;  // outstanding

  wire [N-1:0] to_edge = WHOLE - {1'b0, next[LOG2_BURST-1:0]};
  wire all_left = left < {{(32 - N) {1'b0}}, to_edge};
  wire ask = sized && !m_axi_arvalid && !stop && !error && !bursts[LOG2_BURSTS] && free >= {{(P - N) {1'b0}}, size};
  wire [P-1:0] asked = ask ? {{(P - N) {1'b0}}, size} : {P{1'b0}};
  wire [7:0] size_8 = {{(8 - N) {1'b0}}, size};

  initial m_axi_arvalid = 1'b0;
  always @(posedge clk) begin
    if (rst) begin
      left  <= 32'd0;
      sized <= 1'b0;
    end else if (go) begin
      next  <= source;
      left  <= count;
      sized <= 1'b0;
    end else if (ask) begin
      next  <= next + {{(ADDR_W - LOG2_RECORD - N) {1'b0}}, size};
      left  <= left - {{(32 - N) {1'b0}}, size};
      sized <= 1'b0;
    end else if (!sized) begin
      size  <= all_left ? left[N-1:0] : to_edge;
      sized <= left != 0;
    end
    if (ask) begin
      m_axi_araddr <= {next, {LOG2_RECORD{1'b0}}};
      m_axi_arlen  <= size_8 * BEATS[7:0] - 8'd1;
    end
    if (rst) m_axi_arvalid <= 1'b0;
    else if (ask) m_axi_arvalid <= 1'b1;
    else if (m_axi_arready) m_axi_arvalid <= 1'b0;
  end

  // ---- R ----

  reg [B-1:0] at;  // beat within the record
  reg [LOG2_BURST-1:0] coming;  // low bits of the record's address
  wire last = m_axi_rvalid && at == LAST_BEAT;
  wire burst_in = last && ((&coming) || due == {{LOG2_PLACES{1'b0}}, 1'b1});  // boundary, or last record requested
  wire bad = m_axi_rvalid && m_axi_rresp[1];
  assign got = last && !bad && !error;

  always @(posedge clk) begin
    if (rst || go) begin
      free   <= {1'b1, {LOG2_PLACES{1'b0}}};
      due    <= {P{1'b0}};
      bursts <= {(LOG2_BURSTS + 1) {1'b0}};
      coming <= source[LOG2_RECORD+:LOG2_BURST];
      at     <= {B{1'b0}};
      good   <= 32'd0;
      error  <= 1'b0;
    end else begin
      free   <= free - asked + {{LOG2_PLACES{1'b0}}, leave};
      due    <= due + asked - {{LOG2_PLACES{1'b0}}, last};
      bursts <= bursts + {{LOG2_BURSTS{1'b0}}, ask} - {{LOG2_BURSTS{1'b0}}, burst_in};
      if (last) coming <= coming + 1'b1;
      if (m_axi_rvalid) at <= last ? {B{1'b0}} : at + 1'b1;
      if (got) good <= good + 32'd1;
      if (bad) error <= 1'b1;
    end
    if (bad && !error) begin
      error_decode <= m_axi_rresp[0];
      error_beat   <= at;
    end
    record_valid <= !rst && !go && got;
    if (m_axi_rvalid) record <= {m_axi_rdata, record[(8<<LOG2_RECORD)-1:DATA_W]};
  end

  assign ended = error || (left == 0 && due == 0);
  assign idle = !m_axi_arvalid && due == 0 && (left == 0 || error || stop);
  assign waiting = due != 0 && !m_axi_rvalid;

endmodule

`default_nettype wire

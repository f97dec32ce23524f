// No rounding: beats of R, DATA_W bits, to whole records of 256 bits, in order.
// SPDX-License-Identifier: Apache-2.0
//
// Read engine of ik_axi. A burst ends at the next multiple of 2^LOG2_BURST records, or with the job, so that none crosses
// 4 KiB; where one ends on R follows from the same rule, without rlast. It is asked for only when a place is free for the
// result of each of its records (2^LOG2_PLACES places, given back by `leave`), which is why rready never has to be low.
// After an error no record is handed on and no burst asked for; what is under way is taken and dropped.
// Latency: a record is offered in the clock after its last beat, for one clock.
`default_nettype none

module ik_axi_read #(
    parameter integer ADDR_W      = 32,  // width of an address
    parameter integer DATA_W      = 64,  // width of the bus: 32, 64, 128
    parameter integer LOG2_BURST  = 3,   // log2 of the records of a whole burst, 1 to 5
    parameter integer LOG2_PLACES = 6,   // log2 of the results there is room for, LOG2_BURST + 1 or more
    parameter integer LOG2_BURSTS = 3    // log2 of the bursts that may be under way
) (
    input  wire              clk,
    input  wire              rst,
    // job
    input  wire              go,           // takes over source and count, forgets all else
    input  wire              stop,         // no new burst
    input  wire [ADDR_W-1:5] source,
    input  wire [      31:0] count,
    output wire              idle,         // nothing under way, and nothing more to come
    output wire              ended,        // no record will be handed on any more
    output reg               error,        // sticky until go
    output reg               error_decode, // it was DECERR
    output reg  [      31:0] good,         // records that came without error
    output reg  [       2:0] error_beat,   // of the record after these
    output wire              waiting,      // data are due and there are none
    // records
    output wire              got,          // one has come: a clock before it is offered
    output reg               record_valid,
    output reg  [     255:0] record,
    input  wire              leave,        // a result has left: its place is free
    // AXI4
    output reg  [ADDR_W-1:0] m_axi_araddr,
    output reg  [       7:0] m_axi_arlen,
    output reg               m_axi_arvalid,
    input  wire              m_axi_arready,
    input  wire [DATA_W-1:0] m_axi_rdata,
    input  wire [       1:0] m_axi_rresp,
    input  wire              m_axi_rvalid
);

  localparam integer BEATS = 256 / DATA_W;  // of a record
  localparam [2:0] LAST_BEAT = (DATA_W == 32) ? 3'd7 : (DATA_W == 64) ? 3'd3 : 3'd1;  // of a record
  localparam integer N = LOG2_BURST + 1;  // width of the records of a burst
  localparam integer P = LOG2_PLACES + 1;
  localparam [N-1:0] WHOLE = {1'b1, {LOG2_BURST{1'b0}}};

  // ---- AR ----

  reg [ADDR_W-6:0] next;  // record that the next burst starts with, as an address
  reg [31:0] left;        // records not asked for
  reg sized;              // `size` is that of the next burst
  reg [N-1:0] size;
  reg [P-1:0] free;       // places
  reg [P-1:0] due;        // records asked for that have not come
  reg [LOG2_BURSTS:0] bursts;  // under way

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
      next  <= next + {{(ADDR_W - 5 - N) {1'b0}}, size};
      left  <= left - {{(32 - N) {1'b0}}, size};
      sized <= 1'b0;
    end else if (!sized) begin
      size  <= all_left ? left[N-1:0] : to_edge;
      sized <= left != 0;
    end
    if (ask) begin
      m_axi_araddr <= {next, 5'd0};
      m_axi_arlen  <= size_8 * BEATS[7:0] - 8'd1;
    end
    if (rst) m_axi_arvalid <= 1'b0;
    else if (ask) m_axi_arvalid <= 1'b1;
    else if (m_axi_arready) m_axi_arvalid <= 1'b0;
  end

  // ---- R ----

  reg [2:0] at;  // beat of the record
  reg [LOG2_BURST-1:0] coming;  // low bits of the record's address
  wire last = m_axi_rvalid && at == LAST_BEAT;
  wire burst_in = last && ((&coming) || due == {{LOG2_PLACES{1'b0}}, 1'b1});  // at an edge, or the last asked for
  wire bad = m_axi_rvalid && m_axi_rresp[1];
  assign got = last && !bad && !error;

  always @(posedge clk) begin
    if (rst || go) begin
      free   <= {1'b1, {LOG2_PLACES{1'b0}}};
      due    <= {P{1'b0}};
      bursts <= {(LOG2_BURSTS + 1) {1'b0}};
      coming <= source[LOG2_BURST+4:5];
      at     <= 3'd0;
      good   <= 32'd0;
      error  <= 1'b0;
    end else begin
      free   <= free - asked + {{LOG2_PLACES{1'b0}}, leave};
      due    <= due + asked - {{LOG2_PLACES{1'b0}}, last};
      bursts <= bursts + {{LOG2_BURSTS{1'b0}}, ask} - {{LOG2_BURSTS{1'b0}}, burst_in};
      if (last) coming <= coming + 1'b1;
      if (m_axi_rvalid) at <= last ? 3'd0 : at + 3'd1;
      if (got) good <= good + 32'd1;
      if (bad) error <= 1'b1;
    end
    if (bad && !error) begin
      error_decode <= m_axi_rresp[0];
      error_beat   <= at;
    end
    record_valid <= !rst && !go && got;
    if (m_axi_rvalid) record <= {m_axi_rdata, record[255:DATA_W]};
  end

  assign ended = error || (left == 0 && due == 0);
  assign idle = !m_axi_arvalid && due == 0 && (left == 0 || error || stop);
  assign waiting = due != 0 && !m_axi_rvalid;

endmodule

`default_nettype wire

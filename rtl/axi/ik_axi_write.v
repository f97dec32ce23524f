// Write engine of ik_axi: groups records into bursts and handles AW and B.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, no data.
// A burst ends at the next multiple of 2^LOG2_BURST records, at the end of the job, or before a record that could not
// be read. It is announced only when all its targets have been read, so its data do not wait for the bus. Data may
// leave before AW is accepted. Responses arrive in order, so the same rule gives the size of the burst that a B
// answers.
`default_nettype none

module ik_axi_write #(
    parameter integer ADDR_W      = 32,  // address width
    parameter integer DATA_W      = 64,  // data bus width: 32, 64 or 128
    parameter integer LOG2_BURST  = 3,   // log2 of records per full burst, 1 to 5
    parameter integer LOG2_PLACES = 6,   // log2 of the records allowed between AR and W, at least LOG2_BURST + 1
    parameter integer LOG2_BURSTS = 3,   // log2 of the bursts allowed to await B
    parameter integer LOG2_RECORD = 5    // log2 of a record's bytes, 5 or 6
) (
    input  wire              clk,
    input  wire              rst,
    // Job
    input  wire              go,            // loads destination, clears all other state
    input  wire              stop,          // announce no new burst; must be high after a write error
    input  wire [ADDR_W-1:LOG2_RECORD] destination,
    input  wire              got,           // a target has been read
    input  wire              ended,         // no further target will be read
    output wire              idle,          // all bursts answered, no record left to announce
    output reg               error,         // sticky until go
    output reg               error_decode,  // the error was DECERR
    output reg  [      31:0] written,       // records acknowledged before the first error
    // W records
    output wire              allowed,       // the next record belongs to an announced burst
    output wire              ends_burst,    // and is that burst's last
    input  wire              leave,         // the record was accepted
    input  wire              m_axi_wvalid,
    // AXI4
    output reg  [ADDR_W-1:0] m_axi_awaddr,
    output reg  [       7:0] m_axi_awlen,
    output reg               m_axi_awvalid,
    input  wire              m_axi_awready,
    input  wire [       1:0] m_axi_bresp,
    input  wire              m_axi_bvalid
);

  localparam integer BEATS = (8 << LOG2_RECORD) / DATA_W;  // per record
  localparam integer N = LOG2_BURST + 1;  // width of a record count within a burst
  localparam integer P = LOG2_PLACES + 1;
  localparam integer U = LOG2_BURST + LOG2_BURSTS + 1;
  localparam [N-1:0] WHOLE = {1'b1, {LOG2_BURST{1'b0}}};

  // ---- AW ----

  reg [ADDR_W-LOG2_RECORD-1:0] next;  // first record of the next burst
  reg [P-1:0] ready;      // records read and not announced
  reg [P-1:0] to_send;    // records announced and not sent
  reg [U-1:0] to_answer;  // records announced and not answered
  reg [LOG2_BURSTS:0] bursts;  // announced and not answered

  // A burst is sized in one clock and announced in a later one. The remainder at the end of a job is its last burst.
  reg [N-1:0] to_edge;  // records from `next` to the boundary
  reg [N-1:0] size;
  reg sized;
  wire whole = ready >= {{(P - N) {1'b0}}, to_edge};
  wire issue = sized && !m_axi_awvalid && !stop && !bursts[LOG2_BURSTS];
  wire [N-1:0] issued = issue ? size : {N{1'b0}};
  wire [7:0] size_8 = {{(8 - N) {1'b0}}, size};

  // ---- W: same boundaries as AW; the last record announced also ends a burst ----

  reg [LOG2_BURST-1:0] sending;  // low bits of the next record's address
  wire [P-1:0] to_send_less = to_send - {{LOG2_PLACES{1'b0}}, 1'b1};
  assign allowed = to_send != 0;
  assign ends_burst = (&sending) || to_send == {{LOG2_PLACES{1'b0}}, 1'b1};

  // ---- B ----

  reg [LOG2_BURST-1:0] answering;  // low bits of the record address of the burst that the next B answers
  wire [N-1:0] answer_edge = WHOLE - {1'b0, answering};
  wire answer_whole = to_answer >= {{(U - N) {1'b0}}, answer_edge};
  wire [N-1:0] answer_size = answer_whole ? answer_edge : to_answer[N-1:0];
  wire [N-1:0] answered = m_axi_bvalid ? answer_size : {N{1'b0}};
  wire bad = m_axi_bvalid && m_axi_bresp[1];

  initial m_axi_awvalid = 1'b0;
  always @(posedge clk) begin
    if (go) next <= destination;
    else if (issue) next <= next + {{(ADDR_W - LOG2_RECORD - N) {1'b0}}, size};
    if (go) to_edge <= WHOLE - {1'b0, destination[LOG2_RECORD+:LOG2_BURST]};
    else if (rst || issue) to_edge <= WHOLE;
    if (!sized) size <= whole ? to_edge : ready[N-1:0];
    if (rst || go || issue) sized <= 1'b0;
    else if (!sized) sized <= whole || (ended && ready != 0);
    if (issue) begin
      m_axi_awaddr <= {next, {LOG2_RECORD{1'b0}}};
      m_axi_awlen  <= size_8 * BEATS[7:0] - 8'd1;
    end
    if (rst) m_axi_awvalid <= 1'b0;
    else if (issue) m_axi_awvalid <= 1'b1;
    else if (m_axi_awready) m_axi_awvalid <= 1'b0;
  end

  always @(posedge clk) begin
    if (rst || go) begin
      ready     <= {P{1'b0}};
      to_send   <= {P{1'b0}};
      to_answer <= {U{1'b0}};
      bursts    <= {(LOG2_BURSTS + 1) {1'b0}};
      sending   <= destination[LOG2_RECORD+:LOG2_BURST];
      answering <= destination[LOG2_RECORD+:LOG2_BURST];
      written   <= 32'd0;
      error     <= 1'b0;
    end else begin
      ready     <= ready + {{LOG2_PLACES{1'b0}}, got} - {{(P - N) {1'b0}}, issued};
      // compute both sums, so that `leave`, which arrives late, only selects
      to_send   <= leave ? to_send_less + {{(P - N) {1'b0}}, issued} : to_send + {{(P - N) {1'b0}}, issued};
      to_answer <= to_answer + {{(U - N) {1'b0}}, issued} - {{(U - N) {1'b0}}, answered};
      bursts    <= bursts + {{LOG2_BURSTS{1'b0}}, issue} - {{LOG2_BURSTS{1'b0}}, m_axi_bvalid};
      if (leave) sending <= sending + 1'b1;
      answering <= answering + answered[LOG2_BURST-1:0];
      if (m_axi_bvalid && !bad && !error) written <= written + {{(32 - N) {1'b0}}, answer_size};
      if (bad) error <= 1'b1;
    end
    if (bad && !error) error_decode <= m_axi_bresp[0];
  end

  assign idle = !m_axi_awvalid && !m_axi_wvalid && to_send == 0 && bursts == 0 && (stop || ready == 0);

endmodule

`default_nettype wire

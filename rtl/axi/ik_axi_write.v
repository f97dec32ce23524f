// No rounding: counts records into bursts, AW and B of the write channel.
// SPDX-License-Identifier: Apache-2.0
//
// Write engine of ik_axi. A burst ends at the next multiple of 2^LOG2_BURST records, at the end of the job or before the
// record that could not be read, and is announced only when the targets of all its records are in the core: its data need
// nothing more from the bus. They may leave before AW is taken. Responses come in order, so the size of the burst that a B
// belongs to follows from the rule that AW follows.
`default_nettype none

module ik_axi_write #(
    parameter integer ADDR_W      = 32,  // width of an address
    parameter integer DATA_W      = 64,  // width of the bus: 32, 64, 128
    parameter integer LOG2_BURST  = 3,   // log2 of the records of a whole burst, 1 to 5
    parameter integer LOG2_PLACES = 6,   // log2 of the records that may be between AR and W, LOG2_BURST + 1 or more
    parameter integer LOG2_BURSTS = 3    // log2 of the bursts that may wait for their B
) (
    input  wire              clk,
    input  wire              rst,
    // job
    input  wire              go,            // takes over the destination, forgets all else
    input  wire              stop,          // no new burst; behind an error too
    input  wire [ADDR_W-1:5] destination,
    input  wire              got,           // a target has been read
    input  wire              ended,         // and it was the last
    output wire              idle,          // every burst has been answered, and no record waits for one
    output reg               error,         // sticky until go
    output reg               error_decode,  // it was DECERR
    output reg  [      31:0] written,       // records of bursts answered OKAY, up to the first that was not
    // records of W
    output wire              allowed,       // the next is of a burst that is announced
    output wire              ends_burst,    // and it is its last
    input  wire              leave,         // it has been taken
    input  wire              m_axi_wvalid,
    // AXI4
    output reg  [ADDR_W-1:0] m_axi_awaddr,
    output reg  [       7:0] m_axi_awlen,
    output reg               m_axi_awvalid,
    input  wire              m_axi_awready,
    input  wire [       1:0] m_axi_bresp,
    input  wire              m_axi_bvalid
);

  localparam integer BEATS = 256 / DATA_W;  // of a record
  localparam integer N = LOG2_BURST + 1;  // width of the records of a burst
  localparam integer P = LOG2_PLACES + 1;
  localparam integer U = LOG2_BURST + LOG2_BURSTS + 1;
  localparam [N-1:0] WHOLE = {1'b1, {LOG2_BURST{1'b0}}};

  // ---- AW ----

  reg [ADDR_W-6:0] next;  // record that the next burst starts with, as an address
  reg [P-1:0] ready;      // records read and not announced
  reg [P-1:0] to_send;    // records announced and not sent
  reg [U-1:0] to_answer;  // records announced and not answered
  reg [LOG2_BURSTS:0] bursts;  // announced and not answered

  // The next burst is sized in one clock and announced in a later one. What is left at the end of a job is its last.
  reg [N-1:0] to_edge;  // records from next to the edge
  reg [N-1:0] size;
  reg sized;
  wire whole = ready >= {{(P - N) {1'b0}}, to_edge};
  wire tell = sized && !m_axi_awvalid && !stop && !bursts[LOG2_BURSTS];
  wire [N-1:0] told = tell ? size : {N{1'b0}};
  wire [7:0] size_8 = {{(8 - N) {1'b0}}, size};

  // ---- W: edges lie where they lie for AW; the last record announced ends a burst too ----

  reg [LOG2_BURST-1:0] sending;  // low bits of the next record's address
  wire [P-1:0] to_send_less = to_send - {{LOG2_PLACES{1'b0}}, 1'b1};
  assign allowed = to_send != 0;
  assign ends_burst = (&sending) || to_send == {{LOG2_PLACES{1'b0}}, 1'b1};

  // ---- B ----

  reg [LOG2_BURST-1:0] answering;  // low bits of the address of the burst that the next B belongs to
  wire [N-1:0] answer_edge = WHOLE - {1'b0, answering};
  wire answer_whole = to_answer >= {{(U - N) {1'b0}}, answer_edge};
  wire [N-1:0] answer_size = answer_whole ? answer_edge : to_answer[N-1:0];
  wire [N-1:0] answered = m_axi_bvalid ? answer_size : {N{1'b0}};
  wire bad = m_axi_bvalid && m_axi_bresp[1];

  initial m_axi_awvalid = 1'b0;
  always @(posedge clk) begin
    if (go) next <= destination;
    else if (tell) next <= next + {{(ADDR_W - 5 - N) {1'b0}}, size};
    if (go) to_edge <= WHOLE - {1'b0, destination[LOG2_BURST+4:5]};
    else if (rst || tell) to_edge <= WHOLE;
    if (!sized) size <= whole ? to_edge : ready[N-1:0];
    if (rst || go || tell) sized <= 1'b0;
    else if (!sized) sized <= whole || (ended && ready != 0);
    if (tell) begin
      m_axi_awaddr <= {next, 5'd0};
      m_axi_awlen  <= size_8 * BEATS[7:0] - 8'd1;
    end
    if (rst) m_axi_awvalid <= 1'b0;
    else if (tell) m_axi_awvalid <= 1'b1;
    else if (m_axi_awready) m_axi_awvalid <= 1'b0;
  end

  always @(posedge clk) begin
    if (rst || go) begin
      ready     <= {P{1'b0}};
      to_send   <= {P{1'b0}};
      to_answer <= {U{1'b0}};
      bursts    <= {(LOG2_BURSTS + 1) {1'b0}};
      sending   <= destination[LOG2_BURST+4:5];
      answering <= destination[LOG2_BURST+4:5];
      written   <= 32'd0;
      error     <= 1'b0;
    end else begin
      ready     <= ready + {{LOG2_PLACES{1'b0}}, got} - {{(P - N) {1'b0}}, told};
      // both sums, so that the late leave only chooses
      to_send   <= leave ? to_send_less + {{(P - N) {1'b0}}, told} : to_send + {{(P - N) {1'b0}}, told};
      to_answer <= to_answer + {{(U - N) {1'b0}}, told} - {{(U - N) {1'b0}}, answered};
      bursts    <= bursts + {{LOG2_BURSTS{1'b0}}, tell} - {{LOG2_BURSTS{1'b0}}, m_axi_bvalid};
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

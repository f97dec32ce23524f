// Job control of ik_axi: from the area checks to done or error.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, no data.
// Source, destination and count are copied at start. The checks take 3 clocks, before any access. After an R error, the
// records before it are still written. After a B error or a soft reset, no new burst starts and the outstanding ones
// complete. The first error is reported. Codes: 0 none, 1 source and 2 destination not a multiple of the record size,
// 3 source and 4 destination beyond the address space, 5 areas overlap, 6 SLVERR and 7 DECERR on R, 8 SLVERR and
// 9 DECERR on B.
`default_nettype none

module ik_axi_job #(
    parameter integer ADDR_W      = 32,  // address width, LOG2_RECORD + 7 to 64
    parameter integer DATA_W      = 64,  // data bus width: 32, 64 or 128
    parameter integer LOG2_RECORD = 5    // log2 of a record's bytes, 5 or 6
) (
    input  wire              clk,
    input  wire              rst,
    // Registers
    input  wire              start,
    input  wire              soft_reset,
    input  wire [      63:0] source,
    input  wire [      63:0] destination,
    input  wire [      31:0] count,
    output wire              busy,
    output reg               done,
    output reg               error,
    output reg  [       3:0] code,
    output reg  [      63:0] error_address,
    output reg               event_done,     // interrupt pulses: done, error, start while busy
    output reg               event_error,
    output reg               event_refused,
    output reg  [      31:0] clocks,         // duration of the job, modulo 2^32
    output reg  [      31:0] read_stalls,
    output reg  [      31:0] write_stalls,
    // Read and write engines
    output wire              clear,          // resets ik_axis at start: an earlier job may have left targets in it
    output wire              go,
    output wire              stop,
    output wire [ADDR_W-1:LOG2_RECORD] job_source,  // in records
    output wire [ADDR_W-1:LOG2_RECORD] job_destination,
    output reg  [      31:0] job_count,
    input  wire              read_idle,
    input  wire              read_waiting,
    input  wire              read_error,
    input  wire              read_decode,
    input  wire [      31:0] read_good,
    input  wire [LOG2_RECORD-3:0] read_beat,
    input  wire              write_idle,
    input  wire              write_waiting,
    input  wire              write_error,
    input  wire              write_decode,
    input  wire [      31:0] written
);

  localparam [2:0] IDLE = 3'd0, ENDS = 3'd1, COMPARE = 3'd2, DECIDE = 3'd3, RUN = 3'd4, FINISH = 3'd5;
  localparam [3:0] READ_SLVERR = 4'd6, WRITE_SLVERR = 4'd8;
  localparam integer SHIFT = (DATA_W == 32) ? 2 : (DATA_W == 64) ? 3 : 4;  // log2 of bytes per beat

  reg [2:0] state;
  reg aborted;  // by a soft reset
  assign busy = state != IDLE;
  assign clear = state == ENDS;
  assign stop = state != RUN || aborted || write_error;

  // ---- checks ----

  reg [ADDR_W-1:0] source_at, destination_at;
  assign job_source = source_at[ADDR_W-1:LOG2_RECORD];
  assign job_destination = destination_at[ADDR_W-1:LOG2_RECORD];
  wire [63:0] beyond = {64{1'b1}} << (ADDR_W - 1) << 1;  // bits above the address width
  reg [1:0] crooked;  // {destination, source}: not a multiple of the record size
  reg [1:0] high;     // first byte beyond the address space
  reg [1:0] past;     // first or last byte beyond it
  reg overlap;
  reg [64:0] source_end, destination_end;
  wire [64:0] limit = 65'd1 << ADDR_W;
  wire [64:0] source_e = {{(65 - ADDR_W) {1'b0}}, source_at};
  wire [64:0] destination_e = {{(65 - ADDR_W) {1'b0}}, destination_at};
  wire [64:0] bytes = {{(33 - LOG2_RECORD) {1'b0}}, job_count, {LOG2_RECORD{1'b0}}};

  always @(posedge clk) begin
    if (state == IDLE) begin
      source_at       <= source[ADDR_W-1:0];
      destination_at  <= destination[ADDR_W-1:0];
      job_count       <= count;
      crooked         <= {destination[LOG2_RECORD-1:0] != 0, source[LOG2_RECORD-1:0] != 0};
      high            <= {(destination & beyond) != 0, (source & beyond) != 0};
    end
    source_end      <= source_e + bytes;
    destination_end <= destination_e + bytes;
    past            <= high | {destination_end > limit, source_end > limit};
    overlap         <= source_e < destination_end && destination_e < source_end;
  end

  wire [3:0] refused = crooked[0] ? 4'd1 : crooked[1] ? 4'd2 : past[0] ? 4'd3 : past[1] ? 4'd4 : overlap ? 4'd5 : 4'd0;
  assign go = state == DECIDE && refused == 0 && job_count != 0 && !aborted;

  // ---- states ----

  always @(posedge clk) begin
    event_done    <= 1'b0;
    event_error   <= 1'b0;
    event_refused <= start && !soft_reset && busy && !rst;
    if (rst) begin
      state   <= IDLE;
      done    <= 1'b0;
      error   <= 1'b0;
      code    <= 4'd0;
      aborted <= 1'b0;
    end else begin
      case (state)
        IDLE: begin
          aborted <= 1'b0;
          if (soft_reset || start) begin
            done  <= 1'b0;
            error <= 1'b0;
            code  <= 4'd0;
          end
          if (start && !soft_reset) state <= ENDS;
        end
        ENDS: state <= COMPARE;
        COMPARE: state <= DECIDE;
        DECIDE: begin
          if (job_count != 0) code <= refused;
          state <= go ? RUN : FINISH;
        end
        RUN: begin
          if (code == 0 && read_error) code <= READ_SLVERR + {3'd0, read_decode};
          else if (code == 0 && write_error) code <= WRITE_SLVERR + {3'd0, write_decode};
          if (read_idle && write_idle) state <= FINISH;
        end
        default: begin
          done       <= code == 0 && !aborted && !soft_reset;
          error      <= code != 0 && !aborted && !soft_reset;
          event_done  <= code == 0 && !aborted && !soft_reset;
          event_error <= code != 0 && !aborted && !soft_reset;
          if (aborted || soft_reset) code <= 4'd0;
          state <= IDLE;
        end
      endcase
      if (soft_reset && busy) aborted <= 1'b1;
    end
  end

  // ---- error address and counters ----

  wire of_source = code == 4'd1 || code == 4'd3 || code == READ_SLVERR || code == READ_SLVERR + 4'd1;
  wire [LOG2_RECORD-1:0] beat_bytes = {2'd0, read_beat} << SHIFT;
  reg [LOG2_RECORD+31:0] offset;
  always @(*) begin
    case (code)
      READ_SLVERR, READ_SLVERR + 4'd1: offset = {read_good, beat_bytes};
      WRITE_SLVERR, WRITE_SLVERR + 4'd1: offset = {written, {LOG2_RECORD{1'b0}}};
      default: offset = {(LOG2_RECORD + 32) {1'b0}};
    endcase
  end
  wire [63:0] failing = (of_source ? source_e[63:0] : destination_e[63:0]) + {{(32 - LOG2_RECORD) {1'b0}}, offset};

  always @(posedge clk) begin
    if (rst || (start && !soft_reset && !busy)) begin
      error_address <= 64'd0;
      clocks        <= 32'd0;
      read_stalls   <= 32'd0;
      write_stalls  <= 32'd0;
    end else if (busy) begin
      clocks <= clocks + 32'd1;
      if (state == RUN && read_waiting) read_stalls <= read_stalls + 32'd1;
      if (state == RUN && write_waiting) write_stalls <= write_stalls + 32'd1;
      if (state == FINISH && code != 0 && !aborted) error_address <= failing;
    end
  end

endmodule

`default_nettype wire

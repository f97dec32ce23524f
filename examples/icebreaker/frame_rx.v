// Bytes to a target frame; words unchanged, no rounding.
// SPDX-License-Identifier: Apache-2.0
//
// A frame is START, BYTES of payload and their CRC-16, high byte first.  A valid frame is offered until taken.  Between
// frames all bytes except START are ignored.
// A frame is dropped, with a pulse on `dropped`, on a missing stop bit, a wrong CRC, a pause of 2^LOG2_QUIET clocks, or
// if it begins while the previous frame is offered; the host sends it again.
// Latency: 1 clock from the last byte.
`default_nettype none

module frame_rx #(
    parameter [7:0]   START      = 8'hA5,
    parameter integer BYTES      = 19,  // up to 61
    parameter integer LOG2_QUIET = 16
) (
    input  wire               clk,
    input  wire               rst,
    input  wire [        7:0] data,
    input  wire               valid,
    input  wire               bad,
    output reg  [8*BYTES-1:0] frame,     // the first byte lowest
    output reg                offered,
    input  wire               taken,
    output reg                dropped    // for one clock
);

  localparam [31:0] ALL = BYTES + 2;
  localparam integer BITS = (BYTES > 29) ? 6 : 5;
  reg [BITS-1:0] left;  // bytes to come, 0 between frames
  reg [15:0] crc;
  reg [LOG2_QUIET-1:0] quiet;
  wire [15:0] crc_next;
  crc16 u_crc (.crc(crc), .data(data), .next(crc_next));

  wire begun = left != 0;
  wire first = valid && !begun && data == START;
  wire ends = valid && left == 1;
  wire right = crc_next == 16'd0;  // over payload and CRC
  wire late = begun && (&quiet);
  always @(posedge clk) begin
    quiet <= (valid || !begun) ? {LOG2_QUIET{1'b0}} : quiet + 1'b1;
    if (first && !offered) left <= ALL[BITS-1:0];
    else if (valid && begun) left <= left - 1'b1;
    crc <= begun ? (valid ? crc_next : crc) : 16'hFFFF;
    if (valid && left > 2) frame <= {data, frame[8*BYTES-1:8]};
    if (ends && right) offered <= 1'b1;
    else if (taken) offered <= 1'b0;
    dropped <= (first && offered) || (ends && !right) || (begun && (bad || late));
    if (rst || (begun && (bad || late))) left <= {BITS{1'b0}};
    if (rst) begin
      offered <= 1'b0;
      dropped <= 1'b0;
    end
  end

endmodule

`default_nettype wire

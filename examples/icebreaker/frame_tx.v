// Answer frame to bytes; words unchanged, no rounding.
// SPDX-License-Identifier: Apache-2.0
//
// Frame as in frame_rx: START, BYTES of payload and their CRC-16, high byte first.
// Latency: START is output in the clock after the answer is taken.
`default_nettype none

module frame_tx #(
    parameter [7:0]   START = 8'h5A,
    parameter integer BYTES = 20  // up to 60
) (
    input  wire               clk,
    input  wire               rst,
    input  wire [8*BYTES-1:0] frame,   // the first byte lowest
    input  wire               offered,
    output wire               taken,
    output wire [        7:0] data,
    output wire               valid,
    input  wire               ready
);

  localparam [31:0] ALL = BYTES + 3;
  localparam integer BITS = (BYTES > 28) ? 6 : 5;
  reg [BITS-1:0] left;  // bytes left to send
  reg [15:0] crc;
  reg [8*BYTES+7:0] shift;
  wire [15:0] crc_next;
  crc16 u_crc (.crc(crc), .data(shift[7:0]), .next(crc_next));

  assign taken = offered && left == 0;
  assign valid = left != 0;
  assign data = (left == 2) ? crc[15:8] : (left == 1) ? crc[7:0] : shift[7:0];
  always @(posedge clk) begin
    if (taken) begin
      shift <= {frame, START};
      left  <= ALL[BITS-1:0];
    end else if (valid && ready) begin
      shift <= {8'd0, shift[8*BYTES+7:8]};
      left  <= left - 1'b1;
    end
    if (left == 0 || (valid && ready && left == ALL[BITS-1:0])) crc <= 16'hFFFF;  // excludes START
    else if (valid && ready && left > 2) crc <= crc_next;
    if (rst) left <= {BITS{1'b0}};
  end

endmodule

`default_nettype wire

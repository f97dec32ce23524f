// CRC-16 of a frame; no rounding.
// SPDX-License-Identifier: Apache-2.0
//
// Updates the CRC by one byte, MSB first. Polynomial x^16 + x^12 + x^5 + 1, initial value all ones; Python's
// binascii.crc_hqx. Latency: none (combinational).
`default_nettype none

module crc16 (
    input  wire [15:0] crc,
    input  wire [ 7:0] data,
    output wire [15:0] next
);

  function [15:0] after(input [15:0] old, input [7:0] byte_in);
    integer i;
    begin
      after = old ^ {byte_in, 8'd0};
      for (i = 0; i < 8; i = i + 1) after = {after[14:0], 1'b0} ^ (after[15] ? 16'h1021 : 16'h0000);
    end
  endfunction

  assign next = after(crc, data);

endmodule

`default_nettype wire

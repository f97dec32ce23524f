// Bytes to a serial line; no rounding.
// SPDX-License-Identifier: Apache-2.0
//
// UART transmitter, 8N1.  `ready` is high in the last clock of a stop bit, so that bytes follow without a gap.
// Latency: the start bit begins in the next clock.
`default_nettype none

module uart_tx #(
    parameter integer BIT = 24  // clocks per bit, 2 to 256
) (
    input  wire       clk,
    input  wire       rst,
    input  wire [7:0] data,
    input  wire       valid,
    output wire       ready,
    output wire       tx     // to the pin
);

  localparam [31:0] LAST = BIT - 1;
  reg [7:0] count;
  reg [9:0] shift;  // current level and following bits, filled with ones: the line idles high
  reg [3:0] bits;   // bits left to send, including the current one
  wire ended = count == LAST[7:0];
  assign ready = !rst && (bits == 4'd0 || (bits == 4'd1 && ended));
  assign tx = shift[0];
  always @(posedge clk) begin
    count <= (ended || bits == 4'd0) ? 8'd0 : count + 8'd1;
    if (valid && ready) begin
      shift <= {1'b1, data, 1'b0};
      bits  <= 4'd10;
    end else if (ended && bits != 4'd0) begin
      shift <= {1'b1, shift[9:1]};
      bits  <= bits - 4'd1;
    end
    if (rst) begin
      shift <= {10{1'b1}};
      bits  <= 4'd0;
    end
  end

endmodule

`default_nettype wire

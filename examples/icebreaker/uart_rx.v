// Serial line to bytes; no rounding.
// SPDX-License-Identifier: Apache-2.0
//
// UART receiver, 8N1, samples each bit in its middle.  A start bit that is high in its middle is ignored as noise.
// Latency: 2 clocks from the middle of the stop bit.
`default_nettype none

module uart_rx #(
    parameter integer BIT = 24  // clocks per bit, 4 to 256
) (
    input  wire       clk,
    input  wire       rst,
    input  wire       rx,     // from the pin
    output reg  [7:0] data,
    output reg        valid,  // for one clock
    output reg        bad     // for one clock: no stop bit
);

  reg [1:0] line;  // synchronizer: the pin is asynchronous
  always @(posedge clk) line <= {line[0], rx};
  wire level = line[1];

  localparam [31:0] LAST = BIT - 1;
  localparam [31:0] HALF = BIT - BIT / 2;
  reg [7:0] count;
  reg [3:0] bits;  // bits to come, start bit included; 0: idle
  wire middle = count == LAST[7:0];
  always @(posedge clk) begin
    valid <= 1'b0;
    bad   <= 1'b0;
    count <= middle ? 8'd0 : count + 8'd1;
    if (bits == 4'd0) begin
      count <= HALF[7:0];
      if (!level) bits <= 4'd10;
    end else if (middle) begin
      bits <= bits - 4'd1;
      if (bits == 4'd10 && level) bits <= 4'd0;
      if (bits == 4'd1) begin
        valid <= level;
        bad   <= !level;
      end else data <= {level, data[7:1]};
    end
    if (rst) bits <= 4'd0;
  end

endmodule

`default_nettype wire

// Rules of an AXI4 address channel: legal bursts. AxPROT may have any value (A4.7).
// SPDX-License-Identifier: Apache-2.0
`default_nettype none
`include "ik_rules.vh"

module ik_rules_address #(
    parameter integer DATA_W = 64,
    parameter integer STOP   = 1
) (
    input wire        clk,
    input wire        offered,  // valid, not under reset, without X
    input wire [11:0] addr,
    input wire [ 7:0] len,
    input wire [ 2:0] size,
    input wire [ 1:0] burst,
    input wire [ 3:0] cache
);

  localparam [1:0] FIXED = 2'b00, INCR = 2'b01, WRAP = 2'b10;

  reg [5:0] broken = 6'd0;
  wire [12:0] aligned = {1'b0, addr >> size << size};
  wire [15:0] bytes = {7'd0, {1'b0, len} + 9'd1} << size;
  wire power = len == 8'd1 || len == 8'd3 || len == 8'd7 || len == 8'd15;

  always @(posedge clk) begin
    if (offered) begin
      // table A3-3: 2'b11 is reserved
      `IK_RULE(0, burst != 2'b11, "BURST_TYPE", "IHI 0022E A3.4.1")
      // at most the width of the bus
      `IK_RULE(1, (8 << size) <= DATA_W, "BURST_SIZE", "IHI 0022E A3.4.1")
      // INCR 1 to 256, FIXED 1 to 16, WRAP 2, 4, 8 or 16
      `IK_RULE(2, burst != FIXED || len < 8'd16, "FIXED_LENGTH", "IHI 0022E A3.4.1")
      `IK_RULE(3, burst != WRAP || (power && addr == aligned[11:0]), "WRAP_LENGTH", "IHI 0022E A3.4.1")
      `IK_RULE(4, burst != INCR || {3'd0, aligned} + bytes <= 16'd4096, "WITHIN_4K", "IHI 0022E A3.4.1")
      // a non-modifiable transaction must not set allocate bits
      `IK_RULE(5, cache[1] || cache[3:2] == 2'b00, "CACHE", "IHI 0022E A4.4")
    end
  end

endmodule

`default_nettype wire

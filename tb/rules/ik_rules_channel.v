// Rules of one AXI or AXI4-Stream channel from the specifications, sampled at rising edges like the receiver.
// SPDX-License-Identifier: Apache-2.0
//
// IHI 0022E is AXI4 and AXI4-Lite, IHI 0051A is AXI4-Stream. Rules apply from the first reset on.
`default_nettype none
`include "ik_rules.vh"

module ik_rules_channel #(
    parameter integer N      = 1,  // payload bits: all signals except valid and ready
    parameter integer STREAM = 0,  // 1: AXI4-Stream
    parameter integer STOP   = 1   // 0: continue, and collect broken rules in `broken`
) (
    input wire         clk,
    input wire         rst,      // active high: aresetn inverted
    input wire         valid,
    input wire         ready,
    input wire [N-1:0] payload
);

  reg [5:0] broken = 6'd0;
  reg on;  // a reset has occurred
  reg was_reset;
  reg waits;  // offered but not accepted
  initial {on, was_reset, waits} = 3'b000;
  reg [N-1:0] held;

  always @(posedge clk) begin
    if (rst !== 1'b0 || was_reset || !on) begin
      // A3.1.2, 2.7.2: valid is low during reset, and may rise at the earliest at an edge after one with reset deasserted. It
      // may still be high at the edge that first samples reset, since reset can be asserted between edges.
      if (on && was_reset && STREAM != 0) begin `IK_RULE(0, valid === 1'b0, "LOW_AFTER_RESET", "IHI 0051A 2.7.2") end
      else if (on && was_reset) begin `IK_RULE(0, valid === 1'b0, "LOW_AFTER_RESET", "IHI 0022E A3.1.2") end
      waits = 1'b0;
      was_reset = rst !== 1'b0;
      if (rst === 1'b1) on = 1'b1;
    end else if (valid === 1'b0) begin
      // A3.2.1, 2.2.1: once asserted, valid stays high and the payload stable until the handshake
      if (waits && STREAM != 0) begin `IK_RULE(2, 1'b0, "VALID_STAYS", "IHI 0051A 2.2.1") end
      else if (waits) begin `IK_RULE(2, 1'b0, "VALID_STAYS", "IHI 0022E A3.2.1") end
      waits = 1'b0;
    end else begin
      // valid must be 0 or 1
      `IK_RULE(1, valid === 1'b1, "VALID_KNOWN", "X or Z")
      if (valid !== 1'b1) waits = 1'b0;
      else if (!waits) begin `IK_RULE(4, (^payload) !== 1'bx, "PAYLOAD_KNOWN", "X or Z") end
      else if (STREAM != 0) begin `IK_RULE(3, payload === held, "PAYLOAD_STAYS", "IHI 0051A 2.2.1") end
      else begin `IK_RULE(3, payload === held, "PAYLOAD_STAYS", "IHI 0022E A3.2.1") end
      waits = valid === 1'b1 && ready !== 1'b1;
      if (waits) held = payload;
    end
    if (ready !== 1'b0 && ready !== 1'b1 && on && rst === 1'b0) begin `IK_RULE(5, 1'b0, "READY_KNOWN", "X or Z") end
  end

endmodule

`default_nettype wire

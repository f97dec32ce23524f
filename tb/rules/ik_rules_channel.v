// The rules of one channel of AXI or AXI4-Stream, as the specifications have them; looks at rising edges, as its receiver does.
// SPDX-License-Identifier: Apache-2.0
//
// IHI 0022E is AXI4 and AXI4-Lite, IHI 0051A AXI4-Stream. Nothing holds before the first reset.
`default_nettype none
`include "ik_rules.vh"

module ik_rules_channel #(
    parameter integer N      = 1,  // bits of the payload, all that is not valid or ready
    parameter integer STREAM = 0,  // 1: of AXI4-Stream
    parameter integer STOP   = 1   // 0: go on, and keep in `broken` what has been
) (
    input wire         clk,
    input wire         rst,      // active high: aresetn inverted
    input wire         valid,
    input wire         ready,
    input wire [N-1:0] payload
);

  reg [5:0] broken = 6'd0;
  reg on;  // there was a reset
  reg was_reset;
  reg waits;  // offered and not taken
  initial {on, was_reset, waits} = 3'b000;
  reg [N-1:0] held;

  always @(posedge clk) begin
    if (rst !== 1'b0 || was_reset || !on) begin
      // A3.1.2, 2.7.2: low during reset; high at the earliest at an edge behind one at which reset is not asserted. The edge
      // at which a reset is first seen may still find it high, as reset comes between edges.
      if (on && was_reset && STREAM != 0) begin `IK_RULE(0, valid === 1'b0, "LOW_AFTER_RESET", "IHI 0051A 2.7.2") end
      else if (on && was_reset) begin `IK_RULE(0, valid === 1'b0, "LOW_AFTER_RESET", "IHI 0022E A3.1.2") end
      waits = 1'b0;
      was_reset = rst !== 1'b0;
      if (rst === 1'b1) on = 1'b1;
    end else if (valid === 1'b0) begin
      // A3.2.1, 2.2.1: once asserted, valid stays until the handshake, and what it is valid for does not change
      if (waits && STREAM != 0) begin `IK_RULE(2, 1'b0, "VALID_STAYS", "IHI 0051A 2.2.1") end
      else if (waits) begin `IK_RULE(2, 1'b0, "VALID_STAYS", "IHI 0022E A3.2.1") end
      waits = 1'b0;
    end else begin
      // a handshake is of two levels
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

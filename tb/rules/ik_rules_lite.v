// All rules of an AXI4-Lite port, for both sides.
// SPDX-License-Identifier: Apache-2.0
`default_nettype none
`include "ik_rules.vh"

module ik_rules_lite #(
    parameter integer ADDR_W = 12,
    parameter integer STOP   = 1
) (
    input wire              clk,
    input wire              rst,
    input wire [ADDR_W-1:0] awaddr,
    input wire [       2:0] awprot,
    input wire              awvalid,
    input wire              awready,
    input wire [      31:0] wdata,
    input wire [       3:0] wstrb,
    input wire              wvalid,
    input wire              wready,
    input wire [       1:0] bresp,
    input wire              bvalid,
    input wire              bready,
    input wire [ADDR_W-1:0] araddr,
    input wire [       2:0] arprot,
    input wire              arvalid,
    input wire              arready,
    input wire [      31:0] rdata,
    input wire [       1:0] rresp,
    input wire              rvalid,
    input wire              rready
);

  localparam [1:0] EXOKAY = 2'b01;

  ik_rules_channel #(.N(ADDR_W + 3), .STOP(STOP)) aw (
      .clk(clk), .rst(rst), .valid(awvalid), .ready(awready), .payload({awaddr, awprot})
  );
  wire [31:0] lanes = {{8{wstrb[3] !== 1'b0}}, {8{wstrb[2] !== 1'b0}}, {8{wstrb[1] !== 1'b0}}, {8{wstrb[0] !== 1'b0}}};
  ik_rules_channel #(.N(36), .STOP(STOP)) w (
      .clk(clk), .rst(rst), .valid(wvalid), .ready(wready), .payload({wdata & lanes, wstrb})
  );
  ik_rules_channel #(.N(2), .STOP(STOP)) b (.clk(clk), .rst(rst), .valid(bvalid), .ready(bready), .payload(bresp));
  ik_rules_channel #(.N(ADDR_W + 3), .STOP(STOP)) ar (
      .clk(clk), .rst(rst), .valid(arvalid), .ready(arready), .payload({araddr, arprot})
  );
  ik_rules_channel #(.N(34), .STOP(STOP)) r (
      .clk(clk), .rst(rst), .valid(rvalid), .ready(rready), .payload({rdata, rresp})
  );

  reg [4:0] broken = 5'd0;
  reg [7:0] addresses, words, reads;  // accepted at earlier edges and not yet answered
  reg on;  // a reset has occurred
  initial on = 1'b0;

  always @(posedge clk) begin
    if (rst === 1'b1) on = 1'b1;
    if (rst !== 1'b0) {addresses, words, reads} = 0;
    else if (on) begin
      // A3.3.1: a response follows everything it responds to, and comes once
      if (bvalid === 1'b1) begin
        `IK_RULE(0, addresses != 0, "B_AFTER_ADDRESS", "IHI 0022E A3.3.1")
        `IK_RULE(1, words != 0, "B_AFTER_DATA", "IHI 0022E A3.3.1")
        // B1.1.1: no exclusive accesses
        if ((^bresp) !== 1'bx) begin `IK_RULE(2, bresp != EXOKAY, "BRESP", "IHI 0022E B1.1.1") end
      end
      if (rvalid === 1'b1) begin
        `IK_RULE(3, reads != 0, "R_AFTER_ADDRESS", "IHI 0022E A3.3.1")
        if ((^rresp) !== 1'bx) begin `IK_RULE(4, rresp != EXOKAY, "RRESP", "IHI 0022E B1.1.1") end
      end
      if (bvalid === 1'b1 && bready === 1'b1) {addresses, words} = {addresses - 8'd1, words - 8'd1};
      if (rvalid === 1'b1 && rready === 1'b1) reads = reads - 8'd1;
      if (awvalid === 1'b1 && awready === 1'b1) addresses = addresses + 8'd1;
      if (wvalid === 1'b1 && wready === 1'b1) words = words + 8'd1;
      if (arvalid === 1'b1 && arready === 1'b1) reads = reads + 8'd1;
    end
  end

endmodule

`default_nettype wire

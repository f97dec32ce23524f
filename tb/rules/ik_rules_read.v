// Rules between AR and R of AXI4: data only for a requested burst, ARLEN + 1 beats, the last one marked.
// SPDX-License-Identifier: Apache-2.0
//
// Bursts of one ID stay in order; other IDs may interleave (A5.3). Without ARLOCK no access is exclusive.
`default_nettype none
`include "ik_rules.vh"

module ik_rules_read #(
    parameter integer ID_W = 1,
    parameter integer STOP = 1
) (
    input wire            clk,
    input wire            rst,
    input wire [ID_W-1:0] arid,
    input wire [     7:0] arlen,
    input wire            arvalid,
    input wire            arready,
    input wire [ID_W-1:0] rid,
    input wire [     1:0] rresp,
    input wire            rlast,
    input wire            rvalid,
    input wire            rready
);

  localparam [1:0] EXOKAY = 2'b01;

  reg [4:0] broken = 5'd0;
  reg [7:0] lens[0:(256<<ID_W)-1];  // index: ID, burst number
  reg [7:0] asked[0:(1<<ID_W)-1];
  reg [7:0] given[0:(1<<ID_W)-1];
  reg [7:0] beat[0:(1<<ID_W)-1];  // beats of the oldest burst already sent
  reg [7:0] open;  // outstanding bursts of all IDs
  integer k;

  always @(posedge clk) begin
    if (rst) begin
      open = 8'd0;
      for (k = 0; k < (1 << ID_W); k = k + 1) {asked[k], given[k], beat[k]} = 0;
    end else begin
      if (rvalid === 1'b1) begin
        // A3.3.1: R follows an address accepted at an earlier edge
        `IK_RULE(0, open != 0, "R_AFTER_ADDRESS", "IHI 0022E A3.3.1")
        if (open != 0) begin `IK_RULE(1, asked[rid] != given[rid], "RID", "IHI 0022E A5.3.1") end
        // A3.2.2, A3.4.1: RLAST marks exactly the beat given by ARLEN; no burst ends early
        if (asked[rid] != given[rid]) begin
          `IK_RULE(2, rlast == (beat[rid] == lens[{rid, given[rid]}]), "RLAST", "IHI 0022E A3.2.2")
        end
        `IK_RULE(3, rresp != EXOKAY, "RRESP", "IHI 0022E A7.2.4")
        if (rready === 1'b1 && asked[rid] != given[rid]) begin
          if (beat[rid] == lens[{rid, given[rid]}]) begin
            beat[rid] = 8'd0;
            given[rid] = given[rid] + 8'd1;
            open = open - 8'd1;
          end else beat[rid] = beat[rid] + 8'd1;
        end
      end
      if (arvalid === 1'b1 && arready === 1'b1) begin
        lens[{arid, asked[arid]}] = arlen;
        asked[arid] = asked[arid] + 8'd1;
        open = open + 8'd1;
      end
      // limit of this monitor, which counts modulo 256
      `IK_RULE(4, open < 8'd200, "MONITOR_ROOM", "200 bursts")
    end
  end

endmodule

`default_nettype wire

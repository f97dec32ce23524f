// Rules between AW, W and B of AXI4: bursts in order, data beats as announced, one response per burst.
// SPDX-License-Identifier: Apache-2.0
//
// Data may precede the address (A3.3.1). Without AWLOCK no access is exclusive.
`default_nettype none
`include "ik_rules.vh"

module ik_rules_write #(
    parameter integer ID_W   = 1,
    parameter integer DATA_W = 64,
    parameter integer STOP   = 1
) (
    input wire                clk,
    input wire                rst,
    input wire [    ID_W-1:0] awid,
    input wire [        11:0] awaddr,
    input wire [         7:0] awlen,
    input wire [         2:0] awsize,
    input wire [         1:0] awburst,
    input wire                awvalid,
    input wire                awready,
    input wire [DATA_W/8-1:0] wstrb,
    input wire                wlast,
    input wire                wvalid,
    input wire                wready,
    input wire [    ID_W-1:0] bid,
    input wire [         1:0] bresp,
    input wire                bvalid,
    input wire                bready
);

  localparam integer LANES = DATA_W / 8;
  localparam [1:0] FIXED = 2'b00, INCR = 2'b01;
  localparam [1:0] EXOKAY = 2'b01;

  reg [6:0] broken = 7'd0;

  // Bursts are numbered from the reset. `told`: number of bursts offered on AW.
  reg [7:0] told, taken, ended, joined, answered;
  reg seen;  // the offered burst has been counted
  reg [ID_W-1:0] ids[0:255];
  reg [7:0] lens[0:255];
  reg [11:0] addrs[0:255];
  reg [2:0] sizes[0:255];
  reg [1:0] bursts[0:255];
  reg [8:0] lengths[0:255];  // data beats of a burst
  reg [8:0] beat;  // beats of the current W burst already sent
  reg [7:0] due[0:(1<<ID_W)-1];  // responses that may come

  // lanes that a beat may use (A3.4.3, A9.3: from its address to the next multiple of its size)
  reg [11:0] at, base;
  reg [LANES-1:0] allowed;
  integer k;

  always @(posedge clk) begin
    if (rst) begin
      {told, taken, ended, joined, answered, seen, beat} = 0;
      for (k = 0; k < (1 << ID_W); k = k + 1) due[k] = 8'd0;
    end else begin
      // A3.3.1: B follows the address and the last data beat, both accepted at earlier edges; one per burst (A3.4.4)
      if (bvalid === 1'b1) begin
        if (due[bid] == 0) begin
          `IK_RULE(0, ended != answered, "B_AFTER_LAST_DATA", "IHI 0022E A3.3.1")
          if (ended != answered) begin
            `IK_RULE(1, taken != answered, "B_AFTER_ADDRESS", "IHI 0022E A3.3.1")
            if (taken != answered) begin `IK_RULE(2, 1'b0, "BID", "IHI 0022E A5.3.1") end
          end
        end
        `IK_RULE(3, bresp != EXOKAY, "BRESP", "IHI 0022E A7.2.4")
        if (bready === 1'b1 && due[bid] != 0) begin
          due[bid] = due[bid] - 8'd1;
          answered = answered + 8'd1;
        end
      end

      if (awvalid === 1'b1) begin
        if (!seen) begin
          ids[told] = awid;
          lens[told] = awlen;
          addrs[told] = awaddr;
          sizes[told] = awsize;
          bursts[told] = awburst;
          // data that preceded the address
          if (told == ended) begin `IK_RULE(4, beat <= {1'b0, awlen}, "WLAST", "IHI 0022E A3.4.1") end
          else if (told - joined < ended - joined) begin
            `IK_RULE(4, lengths[told] == {1'b0, awlen} + 9'd1, "WLAST", "IHI 0022E A3.4.1")
          end
          told = told + 8'd1;
        end
        seen = awready !== 1'b1;
        if (awready === 1'b1) taken = taken + 8'd1;
      end

      if (wvalid === 1'b1) begin
        if (told != ended && told - joined > ended - joined) begin
          // A3.2.2, A3.4.1: WLAST marks exactly the beat given by AWLEN; no burst ends early
          `IK_RULE(4, wlast == (beat == {1'b0, lens[ended]}), "WLAST", "IHI 0022E A3.2.2")
          base = addrs[ended] >> sizes[ended] << sizes[ended];
          at = (beat == 0 || bursts[ended] == FIXED) ? addrs[ended] : base + ({3'd0, beat} << sizes[ended]);
          base = at >> sizes[ended] << sizes[ended];
          for (k = 0; k < LANES; k = k + 1) begin
            allowed[k] = k >= {20'd0, at} % LANES && k < {20'd0, base} % LANES + (1 << sizes[ended]);
          end
          if (bursts[ended] == FIXED || bursts[ended] == INCR) begin
            `IK_RULE(5, (wstrb & ~allowed) == 0, "WSTRB", "IHI 0022E A3.4.3")
          end
        end
        if (wready === 1'b1) begin
          beat = beat + 9'd1;
          if (wlast === 1'b1) begin
            lengths[ended] = beat;
            ended = ended + 8'd1;
            beat = 9'd0;
          end
        end
      end

      while (joined != taken && joined != ended) begin
        due[ids[joined]] = due[ids[joined]] + 8'd1;
        joined = joined + 8'd1;
      end
      // limit of this monitor, which counts modulo 256
      `IK_RULE(6, told - answered < 8'd200 && ended - answered < 8'd200, "MONITOR_ROOM", "200 bursts")
    end
  end

endmodule

`default_nettype wire

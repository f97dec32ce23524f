// Registers of ik_axi on AXI4-Lite, as described in ik_axi.rdl.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; 32-bit words.
// Write strobes are honoured. Writes to read-only registers and accesses to unmapped addresses have no effect and
// return SLVERR; such reads return 0. With ARM = 0 the limits of the joints are unmapped. Outputs do not depend
// combinationally on inputs.
`default_nettype none

module ik_axi_regs #(
    parameter integer W        = 32,
    parameter integer DATAPATH = 1,
    parameter integer DIGIT    = 0,
    parameter integer ADDR_W   = 32,
    parameter integer DATA_W   = 64,
    parameter integer LATENCY  = 44,  // latency of ik_axis, clocks
    parameter integer PLACES   = 64,  // most records in flight from AR to W
    parameter integer ARM      = 0    // 1: limits of seven joints
) (
    input  wire        clk,
    input  wire        rst,
    // AXI4-Lite
    input  wire [11:0] s_axi_awaddr,
    input  wire        s_axi_awvalid,
    output wire        s_axi_awready,
    input  wire [31:0] s_axi_wdata,
    input  wire [ 3:0] s_axi_wstrb,
    input  wire        s_axi_wvalid,
    output wire        s_axi_wready,
    output reg  [ 1:0] s_axi_bresp,
    output reg         s_axi_bvalid,
    input  wire        s_axi_bready,
    input  wire [11:0] s_axi_araddr,
    input  wire        s_axi_arvalid,
    output wire        s_axi_arready,
    output reg  [31:0] s_axi_rdata,
    output reg  [ 1:0] s_axi_rresp,
    output reg         s_axi_rvalid,
    input  wire        s_axi_rready,
    // Job
    output reg         start,        // pulse
    output reg         soft_reset,   // pulse
    output reg  [63:0] source,
    output reg  [63:0] destination,
    output reg  [31:0] count,
    input  wire        busy,
    input  wire        done,
    input  wire        error,
    input  wire [ 3:0] code,
    input  wire [63:0] error_address,
    input  wire [31:0] written,
    input  wire [31:0] clocks,
    input  wire [31:0] read_stalls,
    input  wire [31:0] write_stalls,
    input  wire [ 2:0] events,       // pulses: refused, error, done
    output reg         irq,
    // Limits of th1 to th7, then again: lower ends, upper ends; one turn = 2^32
    output wire [14*32-1:0] limits
);

  localparam [31:0] ID = 32'h494b_0100;  // "IK", version 1.0
  localparam [1:0] OKAY = 2'b00, SLVERR = 2'b10;

  // Word addresses
  localparam [9:0] A_ID = 0, A_CONFIG = 1, A_PIPELINE = 2, A_CONTROL = 3, A_STATUS = 4, A_IRQ_ENABLE = 5;
  localparam [9:0] A_IRQ_STATUS = 6, A_COUNT = 7, A_SOURCE_LO = 8, A_SOURCE_HI = 9, A_DESTINATION_LO = 10;
  localparam [9:0] A_DESTINATION_HI = 11, A_ERROR_LO = 12, A_ERROR_HI = 13, A_WRITTEN = 14, A_CLOCKS = 15;
  localparam [9:0] A_READ_STALLS = 16, A_WRITE_STALLS = 17, A_LIMITS = 18;

  function [31:0] merged(input [31:0] old, input [31:0] data, input [3:0] strobes);
    integer i;
    begin
      merged = old;
      for (i = 0; i < 4; i = i + 1) if (strobes[i]) merged[8*i+:8] = data[8*i+:8];
    end
  endfunction

  initial {s_axi_bvalid, s_axi_rvalid, irq} = 3'b000;

  // ---- write: address and data are each held in a register until both have arrived ----

  reg [9:0] waddr;
  reg waddr_held;
  reg [31:0] wdata;
  reg [3:0] wstrb;
  reg wdata_held;
  assign s_axi_awready = !waddr_held && !rst;
  assign s_axi_wready = !wdata_held && !rst;
  wire write = waddr_held && wdata_held && !s_axi_bvalid;

  always @(posedge clk) begin
    if (s_axi_awvalid && s_axi_awready) waddr <= s_axi_awaddr[11:2];
    if (s_axi_wvalid && s_axi_wready) {wdata, wstrb} <= {s_axi_wdata, s_axi_wstrb};
    if (rst || write) {waddr_held, wdata_held} <= 2'b00;
    else {waddr_held, wdata_held} <= {waddr_held || s_axi_awvalid, wdata_held || s_axi_wvalid};
    if (rst) s_axi_bvalid <= 1'b0;
    else if (write) s_axi_bvalid <= 1'b1;
    else if (s_axi_bready) s_axi_bvalid <= 1'b0;
  end

  // the limits follow each other; an address below them is a large number here
  wire [9:0] w_limit = waddr - A_LIMITS;
  wire w_limits = ARM == 1 && w_limit < 10'd14;

  reg [2:0] irq_enable;
  reg [2:0] irq_status;  // refused, error, done
  wire [2:0] erased = (write && waddr == A_IRQ_STATUS && wstrb[0]) ? wdata[2:0] : 3'd0;
  wire control = write && waddr == A_CONTROL && wstrb[0];

  always @(posedge clk) begin
    start      <= !rst && control && wdata[0] && !wdata[1];
    soft_reset <= !rst && control && wdata[1];
    irq        <= !rst && (irq_status & irq_enable) != 0;
    irq_status <= (rst || soft_reset) ? 3'd0 : (irq_status & ~erased) | events;  // a new event wins over a clear
    if (rst) begin
      irq_enable  <= 3'd0;
      count       <= 32'd0;
      source      <= 64'd0;
      destination <= 64'd0;
    end else if (write) begin
      s_axi_bresp <= OKAY;
      case (waddr)
        A_CONTROL, A_IRQ_STATUS: ;
        A_IRQ_ENABLE: if (wstrb[0]) irq_enable <= wdata[2:0];
        A_COUNT: count <= merged(count, wdata, wstrb);
        A_SOURCE_LO: source[31:0] <= merged(source[31:0], wdata, wstrb);
        A_SOURCE_HI: source[63:32] <= merged(source[63:32], wdata, wstrb);
        A_DESTINATION_LO: destination[31:0] <= merged(destination[31:0], wdata, wstrb);
        A_DESTINATION_HI: destination[63:32] <= merged(destination[63:32], wdata, wstrb);
        default: s_axi_bresp <= w_limits ? OKAY : SLVERR;
      endcase
    end
  end

  // ---- limits ----

  generate
    if (ARM == 1) begin : g_limits
      reg [14*32-1:0] ends;
      always @(posedge clk) begin
        if (rst) ends <= {{7{32'h7fff_ffff}}, {7{32'h8000_0000}}};
        else if (write && w_limits) ends[32*w_limit[3:0]+:32] <= merged(ends[32*w_limit[3:0]+:32], wdata, wstrb);
      end
      assign limits = ends;
    end else begin : g_no_limits
      assign limits = {(14 * 32) {1'b0}};
    end
  endgenerate

  // ---- read ----

  reg [9:0] raddr;
  reg raddr_held;
  assign s_axi_arready = !raddr_held && !rst;
  wire read = raddr_held && !s_axi_rvalid;
  wire [9:0] r_limit = raddr - A_LIMITS;
  wire r_limits = ARM == 1 && r_limit < 10'd14;

  always @(posedge clk) begin
    if (s_axi_arvalid && s_axi_arready) raddr <= s_axi_araddr[11:2];
    if (rst || read) raddr_held <= 1'b0;
    else if (s_axi_arvalid) raddr_held <= 1'b1;
    if (rst) s_axi_rvalid <= 1'b0;
    else if (read) s_axi_rvalid <= 1'b1;
    else if (s_axi_rready) s_axi_rvalid <= 1'b0;
    if (read) begin
      s_axi_rresp <= OKAY;
      case (raddr)
        A_ID: s_axi_rdata <= ID;
        A_CONFIG: s_axi_rdata <= {4'd0, DATAPATH == 2, ARM == 1, DIGIT != 0, DATAPATH != 0, ADDR_W[7:0], DATA_W[7:0], W[7:0]};
        A_PIPELINE: s_axi_rdata <= {PLACES[15:0], LATENCY[15:0]};
        A_CONTROL: s_axi_rdata <= 32'd0;
        A_STATUS: s_axi_rdata <= {20'd0, code, 5'd0, error, done, busy};
        A_IRQ_ENABLE: s_axi_rdata <= {29'd0, irq_enable};
        A_IRQ_STATUS: s_axi_rdata <= {29'd0, irq_status};
        A_COUNT: s_axi_rdata <= count;
        A_SOURCE_LO: s_axi_rdata <= source[31:0];
        A_SOURCE_HI: s_axi_rdata <= source[63:32];
        A_DESTINATION_LO: s_axi_rdata <= destination[31:0];
        A_DESTINATION_HI: s_axi_rdata <= destination[63:32];
        A_ERROR_LO: s_axi_rdata <= error_address[31:0];
        A_ERROR_HI: s_axi_rdata <= error_address[63:32];
        A_WRITTEN: s_axi_rdata <= written;
        A_CLOCKS: s_axi_rdata <= clocks;
        A_READ_STALLS: s_axi_rdata <= read_stalls;
        A_WRITE_STALLS: s_axi_rdata <= write_stalls;
        default: begin
          s_axi_rdata <= r_limits ? limits[32*r_limit[3:0]+:32] : 32'd0;
          s_axi_rresp <= r_limits ? OKAY : SLVERR;
        end
      endcase
    end
  end

endmodule

`default_nettype wire

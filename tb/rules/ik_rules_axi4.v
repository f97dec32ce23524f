// All rules of an AXI4 port, for both sides.
// SPDX-License-Identifier: Apache-2.0
`default_nettype none

module ik_rules_axi4 #(
    parameter integer ID_W   = 1,
    parameter integer ADDR_W = 32,  // 12 or more
    parameter integer DATA_W = 64,
    parameter integer STOP   = 1
) (
    input wire                clk,
    input wire                rst,
    input wire [    ID_W-1:0] awid,
    input wire [  ADDR_W-1:0] awaddr,
    input wire [         7:0] awlen,
    input wire [         2:0] awsize,
    input wire [         1:0] awburst,
    input wire [         3:0] awcache,
    input wire [         2:0] awprot,
    input wire                awvalid,
    input wire                awready,
    input wire [  DATA_W-1:0] wdata,
    input wire [DATA_W/8-1:0] wstrb,
    input wire                wlast,
    input wire                wvalid,
    input wire                wready,
    input wire [    ID_W-1:0] bid,
    input wire [         1:0] bresp,
    input wire                bvalid,
    input wire                bready,
    input wire [    ID_W-1:0] arid,
    input wire [  ADDR_W-1:0] araddr,
    input wire [         7:0] arlen,
    input wire [         2:0] arsize,
    input wire [         1:0] arburst,
    input wire [         3:0] arcache,
    input wire [         2:0] arprot,
    input wire                arvalid,
    input wire                arready,
    input wire [    ID_W-1:0] rid,
    input wire [  DATA_W-1:0] rdata,
    input wire [         1:0] rresp,
    input wire                rlast,
    input wire                rvalid,
    input wire                rready
);

  localparam integer A = ID_W + ADDR_W + 20;

  // ---- single channels ----

  wire [A-1:0] aw_beat = {awid, awaddr, awlen, awsize, awburst, awcache, awprot};
  wire [A-1:0] ar_beat = {arid, araddr, arlen, arsize, arburst, arcache, arprot};
  wire [DATA_W-1:0] used;  // lanes without a strobe are ignored
  genvar k;
  generate
    for (k = 0; k < DATA_W / 8; k = k + 1) begin : g_lane
      assign used[8*k+:8] = (wstrb[k] === 1'b0) ? 8'd0 : wdata[8*k+:8];
    end
  endgenerate

  ik_rules_channel #(.N(A), .STOP(STOP)) aw (.clk(clk), .rst(rst), .valid(awvalid), .ready(awready), .payload(aw_beat));
  ik_rules_channel #(.N(DATA_W + DATA_W / 8 + 1), .STOP(STOP)) w (
      .clk(clk), .rst(rst), .valid(wvalid), .ready(wready), .payload({used, wstrb, wlast})
  );
  ik_rules_channel #(.N(ID_W + 2), .STOP(STOP)) b (
      .clk(clk), .rst(rst), .valid(bvalid), .ready(bready), .payload({bid, bresp})
  );
  ik_rules_channel #(.N(A), .STOP(STOP)) ar (.clk(clk), .rst(rst), .valid(arvalid), .ready(arready), .payload(ar_beat));
  ik_rules_channel #(.N(ID_W + DATA_W + 3), .STOP(STOP)) r (
      .clk(clk), .rst(rst), .valid(rvalid), .ready(rready), .payload({rid, rdata, rresp, rlast})
  );

  // ---- bursts; the channel rules report X ----

  reg on;  // a reset has occurred
  initial on = 1'b0;
  always @(posedge clk) if (rst === 1'b1) on <= 1'b1;
  wire off = !on || rst !== 1'b0;
  wire aw_known = awvalid === 1'b1 && !off && (^aw_beat) !== 1'bx;
  wire ar_known = arvalid === 1'b1 && !off && (^ar_beat) !== 1'bx;
  wire w_known = wvalid === 1'b1 && (^{wstrb, wlast}) !== 1'bx;
  wire b_known = bvalid === 1'b1 && (^{bid, bresp}) !== 1'bx;
  wire r_known = rvalid === 1'b1 && (^{rid, rresp, rlast}) !== 1'bx;

  ik_rules_address #(.DATA_W(DATA_W), .STOP(STOP)) aw_burst (
      .clk(clk), .offered(aw_known), .addr(awaddr[11:0]), .len(awlen), .size(awsize), .burst(awburst), .cache(awcache)
  );
  ik_rules_address #(.DATA_W(DATA_W), .STOP(STOP)) ar_burst (
      .clk(clk), .offered(ar_known), .addr(araddr[11:0]), .len(arlen), .size(arsize), .burst(arburst), .cache(arcache)
  );
  ik_rules_write #(.ID_W(ID_W), .DATA_W(DATA_W), .STOP(STOP)) write (
      .clk(clk), .rst(off),
      .awid(awid), .awaddr(awaddr[11:0]), .awlen(awlen), .awsize(awsize), .awburst(awburst), .awvalid(aw_known), .awready(awready),
      .wstrb(wstrb), .wlast(wlast), .wvalid(w_known), .wready(wready),
      .bid(bid), .bresp(bresp), .bvalid(b_known), .bready(bready)
  );
  ik_rules_read #(.ID_W(ID_W), .STOP(STOP)) read (
      .clk(clk), .rst(off), .arid(arid), .arlen(arlen), .arvalid(ar_known), .arready(arready),
      .rid(rid), .rresp(rresp), .rlast(rlast), .rvalid(r_known), .rready(rready)
  );

endmodule

`default_nettype wire

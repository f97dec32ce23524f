// Rules of AXI4, AXI4-Lite and AXI4-Stream from the specifications, for both sides of a port.
// SPDX-License-Identifier: Apache-2.0
//
// IHI 0022E is AXI4 and AXI4-Lite, IHI 0051A is AXI4-Stream. Signals are sampled at rising edges, as by the receiver.
// Rules apply from the first reset after time 0: Verilator starts a module's copy of the clock at random, and a copy
// that starts at 1 has an edge at time 0. $time is read only until that reset: once a bench has failed, Icarus stops a
// process at its next system call, and a rule broken at the same edge would not be printed.
`default_nettype none

// Action on a broken rule: set its bit in `broken`; with STOP, print it and end the simulation.
// A condition must be 1: X counts as broken. %m ends with the instance name of the port.
`define IK_RULE(number, holds, name, clause) \
  if ((holds) !== 1'b1) begin \
    broken[number] = 1'b1; \
    if (STOP != 0) begin \
      $display("error: rule %0s (%0s) is broken at %m, %0d ns", name, clause, $time); \
      $finish; \
    end \
  end

// Rules of one channel.
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
      // A3.1.2, 2.7.2: valid is low during reset and at the first edge after it. It may still be high at the edge that
      // first samples reset, since reset can be asserted between edges.
      if (on && was_reset && STREAM != 0) begin `IK_RULE(0, valid === 1'b0, "LOW_AFTER_RESET", "IHI 0051A 2.7.2") end
      else if (on && was_reset) begin `IK_RULE(0, valid === 1'b0, "LOW_AFTER_RESET", "IHI 0022E A3.1.2") end
      waits = 1'b0;
      was_reset = rst !== 1'b0;
      if (!on && rst === 1'b1) if ($time != 0) on = 1'b1;
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

// All rules of an AXI4-Lite port, for both sides.
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
    if (!on && rst === 1'b1) if ($time != 0) on = 1'b1;
    if (rst !== 1'b0) {addresses, words, reads} = 0;
    else if (on) begin
      // A3.3.1: one response per transfer, after its address and data
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

// All rules of an AXI4 port, for both sides.
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

  // ---- bursts; signals with X are left to the channel rules ----

  reg on;  // a reset has occurred
  initial on = 1'b0;
  always @(posedge clk) if (!on && rst === 1'b1) if ($time != 0) on <= 1'b1;
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

// Rules of an AXI4 address channel: legal bursts. AxPROT may have any value (A4.7).
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

// Rules between AW, W and B of AXI4: bursts in order, data beats as announced, one response per burst.
// Data may precede the address (A3.3.1). Without AWLOCK no access is exclusive.
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

  // Bursts since the reset: offered on AW, accepted on AW, with all data sent, accepted with all data, answered on B.
  reg [7:0] addressed, taken, ended, joined, answered;
  reg seen;  // the offered burst has been counted
  reg [ID_W-1:0] ids[0:255];
  reg [7:0] lens[0:255];
  reg [11:0] addrs[0:255];
  reg [2:0] sizes[0:255];
  reg [1:0] bursts[0:255];
  reg [8:0] lengths[0:255];  // data beats of a burst
  reg [8:0] beat;  // beats of the current W burst already sent
  reg [7:0] due[0:(1<<ID_W)-1];  // ID -> responses that are due

  // byte lanes that a beat may use: from its address to the next multiple of its size (A3.4.3, A9.3)
  reg [11:0] at, base;
  reg [LANES-1:0] allowed;
  integer k;

  always @(posedge clk) begin
    if (rst) begin
      {addressed, taken, ended, joined, answered, seen, beat} = 0;
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
          ids[addressed] = awid;
          lens[addressed] = awlen;
          addrs[addressed] = awaddr;
          sizes[addressed] = awsize;
          bursts[addressed] = awburst;
          // data that preceded the address
          if (addressed == ended) begin `IK_RULE(4, beat <= {1'b0, awlen}, "WLAST", "IHI 0022E A3.4.1") end
          else if (addressed - joined < ended - joined) begin
            `IK_RULE(4, lengths[addressed] == {1'b0, awlen} + 9'd1, "WLAST", "IHI 0022E A3.4.1")
          end
          addressed = addressed + 8'd1;
        end
        seen = awready !== 1'b1;
        if (awready === 1'b1) taken = taken + 8'd1;
      end

      if (wvalid === 1'b1) begin
        if (addressed != ended && addressed - joined > ended - joined) begin
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
      `IK_RULE(6, addressed - answered < 8'd200 && ended - answered < 8'd200, "MONITOR_ROOM", "200 bursts")
    end
  end

endmodule

// Rules between AR and R of AXI4: data only for a requested burst, ARLEN + 1 beats, the last one marked.
// Bursts of one ID stay in order; other IDs may interleave (A5.3). Without ARLOCK no access is exclusive.
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

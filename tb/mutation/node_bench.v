// SPDX-License-Identifier: Apache-2.0
// Bench of a netlist. tb/mutation/benches.py writes values.vh, compared.vh and the data. Compares each node of every
// target: without stalls, with stalls on both sides, with a full FIFO, and after a reset.

`timescale 1ns / 1ps
module node_bench;
  `include "values.vh"
  reg clk, rst, in_valid, out_ready;
  reg [BITS-1:0] data[0:N-1];
  reg [BITS-1:0] want, next, owed;
  wire in_ready, out_valid;
  wire [OUT-1:0] result;
  wire [TAG+FLAGS-1:0] user;
  integer sent, left, clock, ran, target, first, blocked, held, k, seed;
  integer ring[0:RING-1];
  reg stalled, runs;
  reg [8*1000-1:0] file;
  reg [OUT+TAG+FLAGS-1:0] stood;
  reg [TAG-1:0] tag;
  reg [SELECT-1:0] selected;
  `CORE u_axis (
      .clk(clk), .rst(rst), .mutant(selected),
`ifdef LIMITS
      .limits(`LIMITS), .s_axis_tuser({next[IN-1:WORDS], tag}),
`else
      .s_axis_tuser(tag),
`endif
      .s_axis_tdata(next[WORDS-1:0]), .s_axis_tvalid(in_valid), .s_axis_tready(in_ready),
      .m_axis_tdata(result), .m_axis_tuser(user), .m_axis_tvalid(out_valid), .m_axis_tready(out_ready)
  );
  task fails(input [8*40-1:0] why);
    begin
      $display("%0s: target %0d in, %0d out, clock %0d", why, sent, left, clock);
      $finish(0);
      forever #1000;
    end
  endtask
  task differs(input [8*40-1:0] node);
    begin
      $display("%0s of target %0d differs in clock %0d", node, target, clock);
      $finish(0);
      forever #1000;
    end
  endtask
  // sets `target` to the target admitted `ago` clocks ago, or -1, and `want` to its words
  task find(input integer ago);
    begin
      target = ran >= ago ? ring[(ran - ago) % RING] : -1;
      if (target >= 0) want = data[target];
    end
  endtask
  task step;
    begin
      #4 clk = 0;
      #4;
      clock = clock + 1;
      if (clock > MOST) fails("no end");
      if (rst) begin
        for (k = 0; k < RING; k = k + 1) ring[k] = -1;
        stalled = 0;
        left = sent;
      end else begin
        if ((in_ready ^ out_valid) === 1'bx) fails("X of a handshake");
        if (in_valid && in_ready) begin
          ring[ran%RING] = sent;
          sent = sent + 1;
          if (first < 0) first = clock;
          blocked = 0;
        end else blocked = blocked + 1;
        if (stalled && {out_valid, result, user} !== {1'b1, stood}) fails("changed while stalled");
        stood = {result, user};
        stalled = out_valid && !out_ready;
        if (out_valid && out_ready) begin
          if (left >= sent) fails("result without a target");
          owed = data[left];
          k = left;
          if (user[TAG-1:0] !== k[TAG-1:0]) fails("tag");
          if (result !== owed[IN+:OUT]) fails("result");
          if (user[TAG+:FLAGS] !== owed[IN+OUT+:FLAGS]) fails("flags");
          if (left == 0) $display("latency %0d", clock - first);
          left = left + 1;
        end
`include "compared.vh"
        if (runs) begin
          ran = ran + 1;
          ring[ran%RING] = -1;
        end
      end
      #1 clk = 1;
      #1 next = data[sent < N ? sent : N-1];  // the caller sets the other inputs
      tag = sent;
    end
  endtask
  initial begin
    if (!$value$plusargs("data=%s", file)) fails("no data");
    if (!$value$plusargs("mutant=%d", selected)) selected = 0;
    $readmemh(file, data);
    {clk, in_valid, stalled} = 0;
    {rst, out_ready} = 3;
    {sent, left, clock, ran, blocked, held} = 0;
    first = -1;
    seed = 1;
    next = data[0];
    tag = 0;
    for (k = 0; k < RING; k = k + 1) ring[k] = -1;
    repeat (4) step;
    rst = 0;
    // no stalls
    in_valid = 1;
    while (sent < N / 2) step;
    in_valid = 0;
    while (left < sent) step;
    $display("clocks %0d", clock);
    // stalls on both sides
    while (sent < 3 * N / 4) begin
      if (held == 0) begin
        held = $dist_uniform(seed, 1, 8);
        in_valid = $random(seed) | (in_valid && blocked != 0);  // an offer stays
        out_ready = $random(seed);
      end else held = held - 1;
      step;
    end
    // no result is taken until the FIFO is full, then a reset
    in_valid = 1;
    out_ready = 0;
    blocked = 0;
    while (sent < N - 12 && blocked < FULL) step;
    $display("full at %0d", sent);
    out_ready = 1;
    repeat (3) step;
    rst = 1;
    repeat (3) step;
    rst = 0;
    while (sent < N) step;
    in_valid = 0;
    while (left < sent) step;
    repeat (8 + RING) step;
    $display("all right: %0d targets, %0d clocks", left, clock);
    $finish(0);
  end
endmodule

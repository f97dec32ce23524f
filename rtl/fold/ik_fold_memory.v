// Word memory of the folded datapath, with constants.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; words of D bits. a returns their high bits, r the bits below the sign.
// Read/write words at the addresses 0 to 63, followed by the constants 2^(1-n), n = 0 to 63, but -2 for n = 0, and
// 2^(1-n+DOWN) from n = AD on, which underflows to 0. The address n + 32 may be another one of the word n.
// Three copies, one per read port. With the macro IK_NO_INITIAL, for chips without initial values, one copy of WORDS
// words, and constants from logic.
// Throughput: three reads and one write per clock with go high.
// Latency: 1 clock from address to word. A word can be read in the clock after its write.
`default_nettype none

module ik_fold_memory #(
    parameter integer D  = 33,  // width of a word
    parameter integer AD = 33,  // high bits read as a
    parameter integer DOWN = 12,  // shift applied to small powers
    parameter integer RW = 12,  // bits below the sign that select a table row
    // verilator lint_off UNUSEDPARAM
    parameter integer WORDS = 32  // read/write words in use, with IK_NO_INITIAL
    // verilator lint_on UNUSEDPARAM
) (
    input  wire          clk,
    input  wire          go,    // clock enable
    // Read addresses
    input  wire [   6:0] a_at,
    input  wire [   6:0] b_at,
    input  wire [   5:0] r_at,
    // Words read
    output reg  [AD-1:0] a,
    output reg  [ D-1:0] b,
    output reg  [RW-1:0] r,
    // Write
    input  wire          w_en,
    input  wire [   5:0] w_at,
    input  wire [ D-1:0] w
);

  function [D-1:0] power(input integer k);
    power = {1'b1, {(D - 1) {1'b0}}} >> ((k < AD) ? k : k - DOWN);
  endfunction

`ifdef IK_NO_INITIAL

  reg [D-1:0] words[0:WORDS-1];
  wire [D-1:0] a_word = a_at[6] ? power({26'd0, a_at[5:0]}) : words[a_at[4:0]];
  wire [D-1:0] r_word = words[r_at[4:0]];
  always @(posedge clk) begin
    if (go) begin
      a <= a_word[D-1-:AD];
      b <= b_at[6] ? power({26'd0, b_at[5:0]}) : words[b_at[4:0]];
      r <= r_word[D-2-:RW];
    end
    if (go && w_en) words[w_at[4:0]] <= w;
  end
  wire unused = &{1'b0, a_word, r_word, r_at[5], w_at[5]};

`else

  (* no_rw_check, ram_style = "block" *)
  reg [AD-1:0] mem_a[0:127];
  (* no_rw_check, ram_style = "block" *)
  reg [D-1:0] mem_b[0:127];
  (* no_rw_check, ram_style = "block" *)
  reg [RW-1:0] mem_r[0:63];

  integer i;
  reg [D-1:0] word;
  initial begin
    for (i = 0; i < 64; i = i + 1) begin
      word = power(i);
      mem_a[64+i] = word[D-1-:AD];
      mem_b[64+i] = word;
    end
  end

  always @(posedge clk) begin
    if (go) begin
      a <= mem_a[a_at];
      b <= mem_b[b_at];
      r <= mem_r[r_at];
    end
    if (go && w_en) begin
      mem_a[{1'b0, w_at}] <= w[D-1-:AD];
      mem_b[{1'b0, w_at}] <= w;
      mem_r[w_at] <= w[D-2-:RW];
    end
  end

`endif

endmodule

`default_nettype wire

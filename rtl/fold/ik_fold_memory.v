// Words of D bits; no rounding.
// SPDX-License-Identifier: Apache-2.0
//
// The folded machine's words: 64 places that are written, 0 until then, and behind them the powers 2^(1-n), n = 0 to 63:
// -2 for n = 0; from n = AD on 2^(1-n+DOWN), until that is 0, too.  Three copies, so that three words are read in a clock.
// Latency: 1 clock from an address to its word; a word that is written in a clock is read in the next one.
`default_nettype none

module ik_fold_memory #(
    parameter integer D  = 33,  // bits of a word
    parameter integer AD = 33,  // bits of it that are read as a
    parameter integer DOWN = 12,
    parameter integer RW = 12   // bits of one that choose a table's row: the highest but the sign
) (
    input  wire          clk,
    input  wire          go,    // 0: nothing changes
    input  wire [   6:0] a_at,
    input  wire [   6:0] b_at,
    input  wire [   5:0] r_at,
    output reg  [AD-1:0] a,
    output reg  [ D-1:0] b,
    output reg  [RW-1:0] r,
    input  wire          w_en,
    input  wire [   5:0] w_at,
    input  wire [ D-1:0] w
);

  (* no_rw_check, ram_style = "block" *)
  reg [AD-1:0] mem_a[0:127];
  (* no_rw_check, ram_style = "block" *)
  reg [D-1:0] mem_b[0:127];
  (* no_rw_check, ram_style = "block" *)
  reg [RW-1:0] mem_r[0:63];

  function [D-1:0] power(input integer n);
    power = {1'b1, {(D - 1) {1'b0}}} >> ((n < AD) ? n : n - DOWN);
  endfunction

  integer i;
  reg [D-1:0] word;
  initial begin
    for (i = 0; i < 64; i = i + 1) begin
      mem_a[i] = {AD{1'b0}};
      mem_b[i] = {D{1'b0}};
      mem_r[i] = {RW{1'b0}};
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

endmodule

`default_nettype wire

// Mantissa in [1/4, 1) by an even shift: m = floor(v 4^k / 2^(VW-MW)).
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down; k = leading zero pairs of v, unsigned VW bits.
// v = 0 gives m = 0 and k = VW/2 - 1. If MW > VW, m ends in zeros.
// Throughput: one result per clock.
// Latency: 3 clocks (LAT_EVEN): count in groups of eight pairs, shift by groups, shift by pairs.
`default_nettype none

module ik_even #(
    parameter integer VW = 64,  // width of v: even, 4 to 64
    parameter integer MW = 34   // width of the mantissa, at most 50
) (
    input  wire          clk,
    input  wire [VW-1:0] v,
    output reg  [   5:0] k,
    output reg  [MW-1:0] m
);

  generate
    if (VW < 4 || VW > 64 || VW % 2 != 0 || MW < 1 || MW > 50) begin : g_illegal
      ik_even_illegal_width u_stop ();
    end
  endgenerate

  // Leading zero pairs of a group. The eighth pair is not tested: if the first seven are zero, the count is 7.
  function [2:0] pairs(input [13:0] d);
    reg [6:0] any;
    begin
      any = {|d[13:12], |d[11:10], |d[9:8], |d[7:6], |d[5:4], |d[3:2], |d[1:0]};
      pairs[2] = ~|any[6:3];
      pairs[1] = pairs[2] ? ~|any[2:1] : ~|any[6:5];
      pairs[0] = pairs[2] ? (pairs[1] ? ~any[0] : ~any[2]) : (pairs[1] ? ~any[4] : ~any[6]);
    end
  endfunction

  // v as the high bits of four groups of 16, highest first. STOP sets a bit in v's last pair to end the count if v = 0.
  localparam [63:0] STOP = 64'd1 << (64 - VW);
  wire [63:0] wide;
  generate
    if (VW == 64) begin : g_whole
      assign wide = v;
    end else begin : g_part
      assign wide = {v, {(64 - VW) {1'b0}}};
    end
  endgenerate
  wire [63:0] stopped = wide | STOP;

  // count in groups
  reg [63:0] v_1;
  reg [11:0] fine_1;
  reg [2:0] any_1;  // nonzero: the first three groups
  always @(posedge clk) begin
    v_1 <= wide;
    fine_1 <= {pairs(stopped[63:50]), pairs(stopped[47:34]), pairs(stopped[31:18]), pairs(stopped[15:2])};
    any_1 <= {|stopped[63:48], |stopped[47:32], |stopped[31:16]};
  end

  // shift by groups; only a mantissa and seven pairs remain
  localparam integer KW = MW + 14;
  wire [1:0] group = any_1[2] ? 2'd0 : any_1[1] ? 2'd1 : any_1[0] ? 2'd2 : 2'd3;
  wire [63:0] by_groups = v_1 << {group, 4'b0000};
  reg [KW-1:0] v_2;
  reg [1:0] group_2;
  reg [2:0] fine_2;
  always @(posedge clk) begin
    v_2 <= by_groups[63-:KW];
    group_2 <= group;
    case (group)
      2'd0: fine_2 <= fine_1[11:9];
      2'd1: fine_2 <= fine_1[8:6];
      2'd2: fine_2 <= fine_1[5:3];
      default: fine_2 <= fine_1[2:0];
    endcase
  end

  // shift by pairs
  wire [KW-1:0] by_pairs = v_2 << {fine_2, 1'b0};
  always @(posedge clk) begin
    m <= by_pairs[KW-1:14];
    k <= {1'b0, group_2, fine_2};
  end

  wire unused = &{1'b0, stopped[1:0], by_groups, by_pairs[13:0]};

endmodule

`default_nettype wire

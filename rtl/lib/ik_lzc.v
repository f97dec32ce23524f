// Largest common left shift of N words without overflow; 0 if all are 0.
// SPDX-License-Identifier: Apache-2.0
//
// Exact; signed words of W bits.
// Throughput: one result per clock.
// Latency: 2 clocks (LAT_LZC).
`default_nettype none

module ik_lzc #(
    parameter integer W = 32,  // width of a word, at most 64
    parameter integer N = 3    // words
) (
    input  wire           clk,
    input  wire [N*W-1:0] d,      // word 0 in the low bits
    output reg  [    5:0] count,
    output reg            empty   // all are 0
);

  // A bit of mag is set if any word differs from its sign there; the highest set bit limits the shift. If no bit is set
  // and no word is negative, all words are 0.
  reg [W-2:0] any;
  reg negative;
  integer k;
  always @* begin
    any = {(W - 1) {1'b0}};
    negative = 1'b0;
    for (k = 0; k < N; k = k + 1) begin
      any = any | (d[k*W+:W-1] ^ {(W - 1) {d[k*W+W-1]}});
      negative = negative | d[k*W+W-1];
    end
  end
  reg [W-2:0] mag;
  reg minus;
  always @(posedge clk) begin
    mag   <= any;
    minus <= negative;
  end

  integer room;
  integer i;
  always @* begin
    room = W - 1;
    for (i = 0; i < W - 1; i = i + 1) if (mag[i]) room = W - 2 - i;
  end
  wire zero = (mag == {(W - 1) {1'b0}}) && !minus;
  always @(posedge clk) begin
    count <= zero ? 6'd0 : room[5:0];
    empty <= zero;
  end
  wire unused = &{1'b0, room[31:6]};

endmodule

`default_nettype wire

// Shifts N words left together until the largest fills its word.
// SPDX-License-Identifier: Apache-2.0
//
// Exact; signed words of W bits, mantissas in [-1, 1).
// The scale removed is 2^count. The all-zero vector, which has no direction, becomes (1/2, 0, ..).
// Throughput: one result per clock.
// Latency: 3 clocks (LAT_NORM).
`default_nettype none

module ik_norm #(
    parameter integer W = 32,  // width of a word
    parameter integer N = 3    // words
) (
    input  wire           clk,
    input  wire [N*W-1:0] d,     // word 0 in the low bits
    output reg  [N*W-1:0] q,
    output reg  [    5:0] count
);

  wire [5:0] room;
  wire empty;
  ik_lzc #(
      .W(W),
      .N(N)
  ) u_lzc (
      .clk  (clk),
      .d    (d),
      .count(room),
      .empty(empty)
  );

  // Align the words with the count.
  reg [N*W-1:0] d_1;
  reg [N*W-1:0] d_2;
  always @(posedge clk) begin
    d_1 <= d;
    d_2 <= d_1;
  end

  integer k;
  always @(posedge clk) begin
    for (k = 0; k < N; k = k + 1) q[k*W+:W] <= d_2[k*W+:W] << room;
    if (empty) q[W-2] <= 1'b1;  // (1/2, 0, ..)
    count <= room;
  end

endmodule

`default_nettype wire

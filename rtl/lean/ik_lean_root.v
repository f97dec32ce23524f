// Reciprocal square root with full relative precision for any argument.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds the mantissa m down, inv = 1/(2 sqrt m) faithfully; v unsigned, inv with N - 2 fraction bits.
// v 4^e = m 2^VW with m in [1/4, 1), so 1/sqrt v = 2 inv 2^(e - VW/2).
// Throughput: one result per clock.
// Latency: LAT_EVEN for e and m, LAT_RSQRT_FAR more for inv: m, already registered, drives ik_rsqrt's m_next.
`default_nettype none

module ik_lean_root #(
    parameter integer VW = 64,  // width of v, even
    parameter integer R  = 31,  // fraction bits of the root, 19 to 31
    parameter integer N  = 35,  // width of inv; its N - 2 fraction bits are at least R
    parameter integer TILE = 18  // width of the multipliers' longer operand
) (
    input  wire                clk,
    input  wire        [VW-1:0] v,
    // Shift count in pairs, mantissa, reciprocal root
    output wire        [   5:0] e,
    output wire        [ R+2:0] m,
    output wire signed [ N-1:0] inv
);

  ik_even #(.VW(VW), .MW(R+3)) u_even (.clk(clk), .v(v), .k(e), .m(m));

  wire [R:0] y;
  // y = hand_y - 2 * off_y
  ik_rsqrt #(.F(R), .TILE(TILE)) u_rsqrt (.clk(clk), .m_next(m), .twice(1'b0), .y(y));
  wire [N-1:0] y_x = {{(N - R - 1) {1'b0}}, y};
  assign inv = y_x << (N - 2 - R);

endmodule

`default_nettype wire

// No rounding, integers: one row of a restoring square root, q = (4 r + pair >= 4 root + 1).
// SPDX-License-Identifier: Apache-2.0
//
// root has the K highest bits of the result, r = v - root^2 is the remainder of the radicand's 2 K highest bits v, pair
// its next two bits. root_next = 2 root + q, and r_next = 4 r + pair - q (4 root + 1).
// Invariant: root < 2^K and r <= 2 root in, root_next < 2^(K+1) and r_next <= 2 root_next out, and
// 4 (root^2 + r) + pair == root_next^2 + r_next. After the rows of all bits, high to low, from root = r = 0 therefore:
// radicand == result^2 + remainder, remainder <= 2 result. Where r > 2 root, outputs mean nothing.
// Latency: 0 clocks.
`default_nettype none

module ik_root_row #(
    parameter integer K = 15  // bits of the root so far, 0 included
) (
    input  wire [  K:0] r,
    input  wire [  K:0] root,   // its highest bit is 0
    input  wire [  1:0] pair,
    output wire [K+1:0] r_next,
    output wire         q
);

  wire [K+2:0] four = {r, pair};
  wire [K+2:0] difference = four - {root, 2'b01};  // from -4 root - 1 to 4 root + 2
  assign q = ~difference[K+2];
  assign r_next = q ? difference[K+1:0] : four[K+1:0];

endmodule

`default_nettype wire

// No rounding, integers: one row of a non-restoring square root, r_next = 4 r + pair - (4 root + 1) where r >= 0, else
// 4 r + pair + (4 root + 3).
// SPDX-License-Identifier: Apache-2.0
//
// root has the K highest bits of the result, pair is the radicand's next two bits, r the remainder, with a sign: ge and
// ge_next say r >= 0 and r_next >= 0, and the ports r and r_next are all bits but the sign, which is ~ge. ge is root's
// last bit too (before the first row, root is 0 and ge 1), ge_next the result's next one: root_next = 2 root + ge_next.
// With v, the radicand's 2 K highest bits: r = v - root^2 where r >= 0, else v - (root + 1)^2, what was tried last and
// came out negative. From there + 4 (2 root + 1) restores, - (4 root + 1) tries the next bit, together + (4 root + 3).
// One subtractor does both, a LUT a bit, without a multiplexer: {root, 2'b01} is 4 root + 1, and with root inverted it is
// 4 (-root - 1) + 1 = -(4 root + 3). A borrow out is a negative r_next: it takes the 1 above, and ge_next is what is left.
// Invariant: root < 2^K, -(2 root + 1) <= r <= 2 root in; the same for root_next, K + 1 and r_next out. The remainder of
// a restoring row, R = r where r >= 0, else r + 2 root + 1, goes on as R_next = 4 R + pair - ge_next (4 root + 1). After
// the rows of all bits, high to low, from root = r = 0 therefore: radicand == result^2 + R, 0 <= R <= 2 result.
// Where r is out of range, outputs mean nothing.
// Latency: 0 clocks.
`default_nettype none

module ik_root_row #(
    parameter integer K = 15  // bits of the root so far
) (
    input  wire [  K:0] r,
    input  wire         ge,
    input  wire [  K:0] root,    // its highest bit is 0
    input  wire [  1:0] pair,
    output wire [K+1:0] r_next,
    output wire         ge_next
);

  wire sign;  // of r_next
  assign {ge_next, sign, r_next} = {1'b1, r, pair} - {1'b0, root ^ {(K + 1) {~ge}}, 2'b01};
  wire unused = sign;

endmodule

`default_nettype wire

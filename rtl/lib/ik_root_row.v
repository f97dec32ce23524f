// A non-restoring root row: r_next = 4 r + pair + (r >= 0 ? -(4 root + 1) : 4 root + 3).
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, integers.
// root holds the K highest bits of the result, pair the radicand's next two bits. The remainder r is signed:
// ge = (r >= 0), ge_next = (r_next >= 0); the ports r and r_next carry the bits below the sign, ~ge. ge is also root's
// last bit (before the first row, root = 0 and ge = 1), ge_next the result's next: root_next = 2 root + ge_next.
// Let v be the radicand's 2 K highest bits: r = v - root^2 if r >= 0, else v - (root + 1)^2, a trial that failed.
// Then + 4 (2 root + 1) restores and - (4 root + 1) tries the next bit; the sum is + (4 root + 3).
// One subtractor without a multiplexer, one LUT per bit: {root, 2'b01} is 4 root + 1; with root inverted it is
// 4 (-root - 1) + 1 = -(4 root + 3). A negative r_next borrows from the 1 above the sign, which leaves ge_next.
// Invariant: root < 2^K, -(2 root + 1) <= r <= 2 root in; the same for root_next, K + 1 and r_next out. The remainder
// of a restoring row, R = r if r >= 0, else r + 2 root + 1, follows R_next = 4 R + pair - ge_next (4 root + 1). So
// after the rows of all bits, high to low, from root = r = 0: radicand == result^2 + R, 0 <= R <= 2 result.
// The outputs are meaningless if r is out of range.
// Latency: 0 clocks.
`default_nettype none

module ik_root_row #(
    parameter integer K = 15  // root bits found so far
) (
    // Remainder, root so far, next radicand bits
    input  wire [  K:0] r,
    input  wire         ge,
    input  wire [  K:0] root,    // its highest bit is 0
    input  wire [  1:0] pair,
    // Next remainder; ge_next is the root bit
    output wire [K+1:0] r_next,
    output wire         ge_next
);

  wire sign;  // of r_next
  assign {ge_next, sign, r_next} = {1'b1, r, pair} - {1'b0, root ^ {(K + 1) {~ge}}, 2'b01};
  wire unused = sign;

endmodule

`default_nettype wire

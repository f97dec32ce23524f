// A non-restoring division row: r_next = 2 r + bit_in - d if r >= 0, else 2 r + bit_in + d.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, integers.
// The partial remainder r is signed: ge = (r >= 0), ge_next = (r_next >= 0); the ports r and r_next carry the bits
// below the sign, which is ~ge. bit_in is the dividend's next bit, ge_next the quotient's.
// One subtractor without a multiplexer, one LUT per bit: 2 r + bit + d = 2 r + bit - ~d - 1, with the 1 as a borrow
// from the extra bit `low`. A negative r_next borrows from the 1 above the sign, which leaves ge_next.
// Invariant: -d <= r < d in, -d <= r_next < d out. The remainder of a restoring row, R = r if r >= 0, else r + d,
// follows R_next = 2 R + bit - ge_next d. So after the rows of all bits, high to low, from a first 0 <= r < d:
// dividend == quotient * d + R, 0 <= R < d. No final row restores R from r, because the quotient does not need it.
// The outputs are meaningless if r is out of range.
// Latency: 0 clocks.
`default_nettype none

module ik_div_row #(
    parameter integer W = 31  // width of the divisor and of the remainder without sign
) (
    // Partial remainder, divisor, next dividend bit
    input  wire [W-1:0] r,
    input  wire         ge,
    input  wire [W-1:0] d,
    input  wire         bit_in,
    // Next remainder; ge_next is the quotient bit
    output wire [W-1:0] r_next,
    output wire         ge_next
);

  wire sign;  // of r_next
  wire low;
  assign {ge_next, sign, r_next, low} = {1'b1, r, bit_in, 1'b0} - {1'b0, {1'b0, d, 1'b0} ^ {(W + 2) {~ge}}};
  wire unused = &{1'b0, sign, low};

endmodule

`default_nettype wire

// No rounding, integers: one row of a non-restoring division, r_next = 2 r + bit - d where r >= 0, else 2 r + bit + d.
// SPDX-License-Identifier: Apache-2.0
//
// r is the partial remainder, with a sign: ge and ge_next say r >= 0 and r_next >= 0, and the ports r and r_next are all
// bits but the sign, which is ~ge. bit_in is the dividend's next bit, ge_next the quotient's.
// One subtractor does both, a LUT a bit, without a multiplexer: 2 r + bit + d = 2 r + bit - ~d - 1, the 1 as a borrow
// from the bit `low` below. A borrow out is a negative r_next: it takes the 1 above, and ge_next is what is left of it.
// Invariant: -d <= r < d in, -d <= r_next < d out. The remainder of a restoring row, R = r where r >= 0, else r + d, goes
// on as R_next = 2 R + bit - ge_next d. After the rows of all bits, high to low, from a first 0 <= r < d therefore:
// dividend == quotient * d + R, 0 <= R < d. No last row turns r into R, as the quotient has no use for it.
// Where r is out of range, outputs mean nothing.
// Latency: 0 clocks.
`default_nettype none

module ik_div_row #(
    parameter integer W = 31  // width of the divisor, and of the remainder without its sign
) (
    input  wire [W-1:0] r,
    input  wire         ge,
    input  wire [W-1:0] d,
    input  wire         bit_in,
    output wire [W-1:0] r_next,
    output wire         ge_next
);

  wire sign;  // of r_next
  wire low;
  assign {ge_next, sign, r_next, low} = {1'b1, r, bit_in, 1'b0} - {1'b0, {1'b0, d, 1'b0} ^ {(W + 2) {~ge}}};
  wire unused = &{1'b0, sign, low};

endmodule

`default_nettype wire

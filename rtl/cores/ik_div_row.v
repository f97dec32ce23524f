// No rounding, integers: one row of a restoring division, q = (2 r + bit >= d) and r_next = 2 r + bit - q d.
// SPDX-License-Identifier: Apache-2.0
//
// r is the partial remainder, bit the dividend's next bit, q the quotient's. Invariant: r < d in, r_next < d out, and
// 2 r + bit == q d + r_next. After the rows of all bits, high to low, from a first r < d therefore:
// dividend == quotient * d + remainder, remainder < d. Where r >= d, outputs mean nothing.
// Latency: 0 clocks.
`default_nettype none

module ik_div_row #(
    parameter integer W = 31  // width of the divisor and of the remainder
) (
    input  wire [W-1:0] r,
    input  wire [W-1:0] d,
    input  wire         bit_in,
    output wire [W-1:0] r_next,
    output wire         q
);

  wire [W:0] twice = {r, bit_in};
  wire [W:0] difference = twice - {1'b0, d};  // from -d to d - 1
  assign q = ~difference[W];
  assign r_next = q ? difference[W-1:0] : twice[W-1:0];

endmodule

`default_nettype wire

// q is d delayed by N clocks, to balance pipeline paths.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, any format.
// Without reset and enable, so that it maps to shift-register primitives.
// Throughput: one word per clock.
// Latency: N clocks; 0 is a wire.
`default_nettype none

module ik_delay #(
    parameter integer W = 32,  // width of the word
    parameter integer N = 1    // delay, clocks
) (
    input  wire         clk,
    input  wire [W-1:0] d,
    output wire [W-1:0] q
);

  generate
    if (N < 0) begin : g_illegal
      ik_delay_illegal_N u_stop ();
    end else if (N == 0) begin : g_wire
      wire unused = clk;
      assign q = d;
    end else if (N == 1) begin : g_one
      reg [W-1:0] line;
      always @(posedge clk) line <= d;
      assign q = line;
    end else begin : g_line
      reg [W*N-1:0] line;  // newest word in the low bits
      always @(posedge clk) line <= {line[W*(N-1)-1:0], d};
      assign q = line[W*N-1:W*(N-1)];
    end
  endgenerate

endmodule

`default_nettype wire

// No rounding, any format: q is d, N clocks later; ik_delay for wide words that wait long.
// SPDX-License-Identifier: Apache-2.0
//
// The words stay where they are, in a ring that a pointer goes around: each clock writes one place and reads that of
// N-2 clocks before. A block memory of 512 places of 36 bits takes what would be up to 1152 shift registers of 16, or
// flip-flops where an FPGA has none. No reset and no enable, and any start of the pointer will do: until N clocks later,
// q is what the memory held before.
// Latency: N clocks, at least 3.
`default_nettype none

module ik_ring #(
    parameter integer W = 32,  // width of the word
    parameter integer N = 64   // clocks
) (
    input  wire         clk,
    input  wire [W-1:0] d,
    output reg  [W-1:0] q
);

  function integer clog2(input integer n);
    begin
      clog2 = 0;
      while ((1 << clog2) < n) clog2 = clog2 + 1;
    end
  endfunction

  generate
    if (N < 3) begin : g_illegal
      ik_ring_needs_N_of_at_least_3 u_stop ();
    end
  endgenerate

  localparam integer AGE = N - 2;  // a clock in oldest and one in q
  localparam integer AW = clog2(AGE + 1);

  (* ram_style = "block" *) reg [W-1:0] ring[0:(1<<AW)-1];
  reg [AW-1:0] place;
  initial place = {AW{1'b0}};
  wire [AW-1:0] place_read = place - AGE[AW-1:0];

  reg [W-1:0] oldest;
  always @(posedge clk) begin
    place       <= place + {{(AW - 1) {1'b0}}, 1'b1};
    ring[place] <= d;
    oldest      <= ring[place_read];
    q           <= oldest;
  end

endmodule

`default_nettype wire

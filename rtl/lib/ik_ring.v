// q is d delayed by N clocks, through a memory: ik_delay for wide words and long delays.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding, any format.
// A ring buffer: each clock writes one word and reads the word written N-2 clocks earlier. One 512x36 block RAM
// replaces up to 1152 16-bit shift registers, or flip-flops on FPGAs without them. No enable. The pointer may start
// anywhere; it is reset for four-state simulation without initial values. For the first N clocks, q is the memory's
// initial content.
// Throughput: one word per clock.
// Latency: N clocks.
`default_nettype none

module ik_ring #(
    parameter integer W = 32,  // width of the word
    parameter integer N = 64   // delay, clocks, at least 3
) (
    input  wire         clk,
    input  wire         rst,  // synchronous: resets the pointer only
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
      ik_ring_illegal_N u_stop ();
    end
  endgenerate

  localparam integer AGE = N - 2;  // minus one clock in `oldest` and one in q
  localparam integer AW = clog2(AGE + 1);

  (* ram_style = "block" *) reg [W-1:0] ring[0:(1<<AW)-1];
  reg [AW-1:0] place;
  initial place = {AW{1'b0}};
  wire [AW-1:0] place_read = place - AGE[AW-1:0];

  reg [W-1:0] oldest;
  always @(posedge clk) begin
    place       <= rst ? {AW{1'b0}} : place + {{(AW - 1) {1'b0}}, 1'b1};
    ring[place] <= d;
    oldest      <= ring[place_read];
    q           <= oldest;
  end

endmodule

`default_nettype wire

// Product of two words: p = a * b.
// SPDX-License-Identifier: Apache-2.0
//
// Exact; a and b signed W bits, p 2W bits.
// Four tiles of half words (17x17 bits for W = 33); a square (SQUARE = 1, b is ignored) needs three.
// Throughput: one result per clock.
// Latency: 4 clocks (LAT_PRODUCT): operands, tile products, tile sums, sum; a square 3 (LAT_SQUARE).
`default_nettype none

module ik_exact #(
    parameter integer W      = 33,  // width of a and b, 3 to 35
    parameter integer SQUARE = 0    // 1: p = a * a
) (
    input  wire                  clk,
    input  wire signed [  W-1:0] a,
    input  wire signed [  W-1:0] b,
    output reg  signed [2*W-1:0] p
);

  generate
    if (W < 3 || W > 35) begin : g_illegal
      ik_exact_illegal_W u_stop ();
    end
  endgenerate

  // Width of the low half, unsigned; not 9, because Yosys' synth_intel_alm takes an unsigned 9x9 product for a signed one
  localparam integer L = (W / 2 == 9) ? 8 : W / 2;
  localparam integer H = W - L;  // width of the high half, signed

  // operands
  reg signed [W-1:0] a_q;
  always @(posedge clk) a_q <= a;
  wire signed [H-1:0] a_hi = a_q[W-1:L];
  wire signed [L:0] a_lo = {1'b0, a_q[L-1:0]};

  // tile products
  reg signed [2*H-1:0] hh;
  reg signed [H+L:0] hl;
  reg signed [2*L+1:0] ll;
  // tile sums; hh and ll do not overlap
  wire [2*W-1:0] outer;
  wire signed [H+L:0] inner;  // |a_hi b_lo + a_lo b_hi| < 2^W
  generate
    if (SQUARE != 0) begin : g_square
      always @(posedge clk) begin
        hh <= a_hi * a_hi;
        hl <= a_hi * a_lo;
        ll <= a_lo * a_lo;
      end
      assign outer = {hh, ll[2*L-1:0]};
      assign inner = hl <<< 1;
      wire unused = &{1'b0, b};
    end else begin : g_product
      reg signed [W-1:0] b_q;
      wire signed [H-1:0] b_hi = b_q[W-1:L];
      wire signed [L:0] b_lo = {1'b0, b_q[L-1:0]};
      reg signed [H+L:0] lh;
      reg [2*W-1:0] outer_q;
      reg signed [H+L:0] inner_q;
      always @(posedge clk) begin
        b_q     <= b;
        hh      <= a_hi * b_hi;
        hl      <= a_hi * b_lo;
        lh      <= a_lo * b_hi;
        ll      <= a_lo * b_lo;
        outer_q <= {hh, ll[2*L-1:0]};
        inner_q <= hl + lh;
      end
      assign outer = outer_q;
      assign inner = inner_q;
    end
  endgenerate
  wire unused_ll = &{1'b0, ll[2*L+1:2*L]};  // always 0: the factors are not negative

  // sum; the lowest L bits pass through
  wire signed [2*W-1:0] inner_x = {{(2 * W - H - L - 1) {inner[H+L]}}, inner};
  always @(posedge clk) p <= outer + (inner_x <<< L);

endmodule

`default_nettype wire

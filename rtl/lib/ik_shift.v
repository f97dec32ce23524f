// Left: exact modulo 2^W. Right: rounds down (floor). q = d * 2^count or floor(d / 2^count), signed words of W bits.
// SPDX-License-Identifier: Apache-2.0
//
// To the left, the shift by 0 to 15 is a product with a power of two, two multiplier blocks instead of three or four
// LUTs a bit; then by sixteens. To the right, by eights, by ones.
// Latency: 2 clocks (LAT_SHIFT).
`default_nettype none

module ik_shift #(
    parameter integer W     = 32,  // width of the word, at most 35
    parameter integer RIGHT = 0    // 1: shift right
) (
    input  wire                clk,
    input  wire signed [W-1:0] d,
    input  wire        [  5:0] count,
    output reg  signed [W-1:0] q
);

  generate
    if (W > 35) begin : g_illegal
      ik_shift_needs_W_of_at_most_35 u_stop ();
    end
    if (RIGHT != 0) begin : g_right
      reg signed [W-1:0] eights;
      reg [2:0] ones;
      always @(posedge clk) begin
        eights <= d >>> {count[5:3], 3'b000};
        ones   <= count[2:0];
        q      <= eights >>> ones;
      end
    end else begin : g_left
      localparam integer LOW = (W > 17) ? 17 : W;  // bits in the low product, without a sign
      wire [15:0] power = 16'd1 << count[3:0];
      reg [W-1:0] low;
      reg [1:0] sixteens;
      always @(posedge clk) begin
        low      <= {{(W - LOW) {1'b0}}, d[LOW-1:0]} * {{W{1'b0}}, power};
        sixteens <= count[5:4];
      end
      wire [W-1:0] high;
      if (W > LOW) begin : g_two
        reg [W-LOW-1:0] product;
        always @(posedge clk) product <= d[W-1:LOW] * {{(W - LOW) {1'b0}}, power};
        assign high = {product, {LOW{1'b0}}};
      end else begin : g_one
        assign high = {W{1'b0}};
      end
      always @(posedge clk) q <= (low | high) << {sixteens, 4'd0};  // where one has a bit, the other has none
    end
  endgenerate

endmodule

`default_nettype wire

// Shifts a word left or right: q = d * 2^count or d / 2^count.
// SPDX-License-Identifier: Apache-2.0
//
// Left exact modulo 2^W, right rounded down (floor); signed words of W bits.
// Two stages: by eights, by ones. With PRODUCT = 1 (left shifts only), one or two multiplier blocks shift by 0 to 15 as
// a product with a power of two, and LUTs shift by sixteens; that takes one LUT per bit instead of four.
// Throughput: one result per clock.
// Latency: 2 clocks (LAT_SHIFT), plus DD from d or DC from count.
`default_nettype none

module ik_shift #(
    parameter integer W       = 32,  // width of the word; at most 33 with PRODUCT
    parameter integer RIGHT   = 0,   // 1: shift right
    parameter integer PRODUCT = 0,   // 1: use multipliers
    parameter integer DD      = 0,   // delay of d, clocks
    parameter integer DC      = 0    // delay of count, clocks
) (
    input  wire                clk,
    input  wire signed [W-1:0] d,
    input  wire        [  5:0] count,
    output reg  signed [W-1:0] q
);

  wire signed [W-1:0] d_in;
  wire [5:0] count_in;
  ik_delay #(.W(W), .N(DD)) u_d (.clk(clk), .d(d), .q(d_in));
  ik_delay #(.W(6), .N(DC)) u_count (.clk(clk), .d(count), .q(count_in));

  generate
    if (PRODUCT == 0) begin : g_levels
      reg signed [W-1:0] eights;
      reg [2:0] ones;
      always @(posedge clk) begin
        eights <= (RIGHT != 0) ? (d_in >>> {count_in[5:3], 3'b000}) : (d_in <<< {count_in[5:3], 3'b000});
        ones   <= count_in[2:0];
        q      <= (RIGHT != 0) ? (eights >>> ones) : (eights <<< ones);
      end
    end else if (W > 33 || RIGHT != 0) begin : g_illegal
      ik_shift_illegal_PRODUCT u_stop ();
    end else begin : g_product
      localparam integer LOW = (W > 17) ? 17 : W;  // bits in the low product, unsigned
      wire [15:0] power = 16'd1 << count_in[3:0];
      wire [LOW+15:0] low_product = {16'd0, d_in[LOW-1:0]} * {{LOW{1'b0}}, power};
      reg [W-1:0] low;
      reg [1:0] sixteens;
      always @(posedge clk) begin
        low      <= low_product[W-1:0];
        sixteens <= count_in[5:4];
      end
      wire unused = &{1'b0, low_product};
      wire [W-1:0] high;
      if (W > LOW) begin : g_two
        wire [W-LOW+15:0] high_product = {16'd0, d_in[W-1:LOW]} * {{(W - LOW) {1'b0}}, power};
        reg [W-LOW-1:0] high_q;
        always @(posedge clk) high_q <= high_product[W-LOW-1:0];
        assign high = {high_q, {LOW{1'b0}}};
        wire unused_high = &{1'b0, high_product};
      end else begin : g_one
        assign high = {W{1'b0}};
      end
      always @(posedge clk) q <= (low | high) << {sixteens, 4'd0};  // set bits never overlap
    end
  endgenerate

endmodule

`default_nettype wire

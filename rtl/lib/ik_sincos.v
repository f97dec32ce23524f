// Sine and cosine of phi/2, by CORDIC.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up; each iteration rounds down with 6 guard bits. Results signed Q2.(W-2).
// phi is a binary angle, one turn = 2^W, so phi/2 lies in [-90, 90) degrees: within the range of convergence without
// quadrant folding. The start vector compensates the gain of the rotations.
// The vector after FIRST iterations depends only on the first FIRST signs of the angle, so it is read from a memory;
// only the angle passes through all iterations. The memory is read for both values of the last of these signs.
// Throughput: one angle per clock.
// Latency: W + 1 clocks (LAT_SINCOS): one iteration per bit, rounding.
`default_nettype none

module ik_sincos #(
    parameter integer W = 32  // word length, 16 to 40
) (
    input  wire                clk,
    input  wire signed [W-1:0] phi,
    output wire signed [W-1:0] sin_h,
    output wire signed [W-1:0] cos_h
);

  `include "ik_sincos_table.vh"

  localparam integer XW = W + SINCOS_GUARD;
  localparam integer DROP = TABLE_BITS - XW;  // table bits below the angle's
  localparam integer DROP_GAIN = DROP + 2;  // x and y have two integer bits, the table none

  localparam [TABLE_BITS-1:0] GAIN_W = (GAIN + (48'd1 << (DROP_GAIN - 1))) >> DROP_GAIN;

  // ---- remaining angle ----

  // Each iteration halves the remaining angle, so from the third on z loses one bit per iteration; its sign bit
  // extends. a +- b uses one adder with the sign as carry: a + (b ^ s) + s. The bits of z below the lowest 1 of the
  // rotation angle do not change; the first angle, 1/8 turn, has a single 1.
  function integer zeros(input [XW-1:0] angle);
    begin
      zeros = 0;
      while (zeros < XW - 1 && !angle[zeros]) zeros = zeros + 1;
    end
  endfunction

  genvar i;
  generate
    for (i = 0; i < W; i = i + 1) begin : g_angle
      localparam integer ZW = (i > 1) ? (XW + 1 - i) : XW;
      localparam integer NEXT = (i > 0) ? (XW - i) : XW;
      localparam [TABLE_BITS-1:0] ATAN = (atan_turn(i) + (48'd1 << (DROP - 1))) >> DROP;
      localparam [XW-1:0] ANGLE = ATAN[XW-1:0];
      localparam integer STAY = zeros(ANGLE);
      localparam [NEXT-1:0] BELOW = ~({NEXT{1'b1}} << STAY);
      wire [ZW-1:0] z;
      if (i == 0) begin : g_first
        assign z = {phi, {SINCOS_GUARD{1'b0}}};
      end else begin : g_next
        assign z = g_angle[i-1].z_q;
      end
      wire right = z[ZW-1];
      wire left = ~right;
      wire [NEXT-1:0] step = ANGLE[NEXT-1:0] >> STAY;
      wire [NEXT-1:0] high = (z[NEXT-1:0] >> STAY) + (step ^ {NEXT{left}}) + {{(NEXT - 1) {1'b0}}, left};
      reg [NEXT-1:0] z_q;
      always @(posedge clk) z_q <= (high << STAY) | (z[NEXT-1:0] & BELOW);
      wire unused_z = &{1'b0, z_q};  // last iteration
    end
  endgenerate

  // ---- first iterations of the vector ----

  localparam integer FIRST = 10;

  // {x, y} after FIRST iterations; bit FIRST-1-i of row: iteration i turns right
  function [2*XW-1:0] vector(input integer row);
    reg signed [XW-1:0] x_k;
    reg signed [XW-1:0] y_k;
    reg signed [XW-1:0] x_s;
    reg signed [XW-1:0] y_s;
    integer k;
    begin
      x_k = GAIN_W[XW-1:0];
      y_k = {XW{1'b0}};
      for (k = 0; k < FIRST; k = k + 1) begin
        x_s = x_k >>> k;
        y_s = y_k >>> k;
        if (((row >> (FIRST - 1 - k)) & 1) != 0) begin
          x_k = x_k + y_s;
          y_k = y_k - x_s;
        end else begin
          x_k = x_k - y_s;
          y_k = y_k + x_s;
        end
      end
      vector = {x_k, y_k};
    end
  endfunction

  // Rows are computed as constants of EACH rows: nested loops in `initial` exceed the limits of some tools.
  localparam integer EACH = 32;
  function [2*XW*EACH-1:0] vectors(input integer first);
    integer k;
    begin
      vectors = 0;
      for (k = 0; k < EACH; k = k + 1) vectors[2*XW*k+:2*XW] = vector(first + k);
    end
  endfunction

  reg [2*XW-1:0] start[0:(1<<FIRST)-1];
  integer n;
  generate
    for (i = 0; i < (1 << FIRST); i = i + EACH) begin : g_rows
      localparam [2*XW*EACH-1:0] ROWS = vectors(i);
      initial for (n = 0; n < EACH; n = n + 1) start[i+n] = ROWS[2*XW*n+:2*XW];
    end
  endgenerate

  // Align the signs: the sign of iteration i waits for the sign of iteration FIRST-2.
  wire [FIRST-2:0] signs;
  generate
    for (i = 0; i < FIRST - 1; i = i + 1) begin : g_sign
      ik_delay #(
          .W(1),
          .N(FIRST - 2 - i)
      ) u_wait (
          .clk(clk),
          .d  (g_angle[i].right),
          .q  (signs[FIRST-2-i])
      );
    end
  endgenerate

  reg [2*XW-1:0] start_left;
  reg [2*XW-1:0] start_right;
  reg signed [XW-1:0] x_first;
  reg signed [XW-1:0] y_first;
  always @(posedge clk) begin
    start_left <= start[{signs, 1'b0}];
    start_right <= start[{signs, 1'b1}];
    {x_first, y_first} <= g_angle[FIRST-1].right ? start_right : start_left;
  end

  // ---- remaining iterations: x[i], y[i] after i iterations ----

  wire signed [XW-1:0] x[FIRST:W];
  wire signed [XW-1:0] y[FIRST:W];
  assign x[FIRST] = x_first;
  assign y[FIRST] = y_first;

  generate
    for (i = FIRST; i < W; i = i + 1) begin : g_turn
      wire right = g_angle[i].right;
      wire left = ~right;
      wire [XW-1:0] x_i = x[i] >>> i;
      wire [XW-1:0] y_i = y[i] >>> i;
      reg signed [XW-1:0] x_q;
      reg signed [XW-1:0] y_q;
      always @(posedge clk) begin
        x_q <= x[i] + (y_i ^ {XW{left}}) + {{(XW - 1) {1'b0}}, left};
        y_q <= y[i] + (x_i ^ {XW{right}}) + {{(XW - 1) {1'b0}}, right};
      end
      assign x[i+1] = x_q;
      assign y[i+1] = y_q;
    end
  endgenerate

  localparam signed [XW-1:0] HALF = {{(XW - 1) {1'b0}}, 1'b1} << (SINCOS_GUARD - 1);
  wire signed [XW-1:0] x_round = x[W] + HALF;
  wire signed [XW-1:0] y_round = y[W] + HALF;
  reg [W-1:0] cos_q;
  reg [W-1:0] sin_q;
  always @(posedge clk) begin
    cos_q <= x_round[XW-1:SINCOS_GUARD];
    sin_q <= y_round[XW-1:SINCOS_GUARD];
  end
  assign cos_h = cos_q;
  assign sin_h = sin_q;

  // dropped by rounding
  wire unused = &{1'b0, x_round[SINCOS_GUARD-1:0], y_round[SINCOS_GUARD-1:0]};

endmodule

`default_nettype wire

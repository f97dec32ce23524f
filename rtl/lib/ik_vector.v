// Length and angle of a vector, by CORDIC.
// SPDX-License-Identifier: Apache-2.0
//
// No final rounding: each iteration rounds X down, the table's angles are rounded.
// x, y and length have 3 guard bits below a word's LSB: W+1 fraction bits. The length is 1.6468 times the vector's. The
// angle is binary, one turn = 2^(W+4). Bits and error bounds: model/dataflow/angles.py.
// A vector left of the y axis is first turned by half a turn. Iteration i turns it towards the x axis by atan(2^-i). The
// angle of a vector on an axis is exact.
// Y = 2^i y, so that no bit is lost:
//     X += |Y| / 4^i          Y = 2 (Y - X) for Y >= 0, else 2 (Y + X)
// Only the first HEAD iterations change X. The angles of the others are short words, which are summed separately.
// Throughput: one vector per clock.
// Latency: HEAD + 1 clocks to the length, LAST + 1 to the angle: half a turn, iterations.
`default_nettype none

module ik_vector #(
    parameter integer W = 32  // word length, 5 to 32
) (
    input  wire                clk,
    input  wire signed [W+3:0] x,
    input  wire signed [W+3:0] y,
    output wire        [W+2:0] length,
    output reg         [W+3:0] angle
);

  `include "ik_vector_table.vh"

  generate
    if (W < 5 || W > 32) begin : g_illegal
      ik_vector_illegal_W u_stop ();
    end
  endgenerate

  // ---- half a turn: X is a one's complement ----

  wire left = x[W+3];
  reg [XW-1:0] x_0;
  reg [YW-1:0] y_0;
  always @(posedge clk) begin
    x_0 <= x[XW-1:0] ^ {XW{left}};
    y_0 <= ({y[W+3], y} ^ {YW{left}}) + {{(YW - 1) {1'b0}}, left};
  end

  // ---- iterations; z and t: sums of the angles of the first HEAD iterations and of the others ----

  localparam integer TW = ZW - HEAD;  // twice an angle below 2^-HEAD rad, and the sign
  genvar i;
  generate
    for (i = 0; i < LAST; i = i + 1) begin : g_turn
      localparam [ZW-1:0] TURN = turn(i);
      wire [XW-1:0] x_i;
      wire [YW-1:0] y_i;
      wire [ZW-1:0] z_i;
      wire [TW-1:0] t_i;
      if (i == 0) begin : g_first
        assign x_i = x_0;
        assign y_i = y_0;
        assign z_i = {ZW{1'b0}};
      end else begin : g_next
        assign x_i = g_turn[i-1].x_q;
        assign y_i = g_turn[i-1].y_q;
        assign z_i = g_turn[i-1].z_q;
      end
      if (i <= HEAD) begin : g_head
        assign t_i = {TW{1'b0}};
      end else begin : g_tail
        assign t_i = g_turn[i-1].t_q;
      end
      wire below = y_i[YW-1];
      wire [YW-1:0] step = (y_i ^ {YW{below}}) >> (2 * i);  // |Y| as a one's complement
      wire [YW-1:0] nearer = y_i + ({2'b00, x_i} ^ {YW{!below}}) + {{(YW - 1) {1'b0}}, !below};
      reg [XW-1:0] x_q;
      reg [YW-1:0] y_q;
      reg [ZW-1:0] z_q;
      reg [TW-1:0] t_q;
      always @(posedge clk) begin
        x_q <= (i < HEAD) ? x_i + step[XW-1:0] : x_i;
        y_q <= nearer << 1;
        z_q <= (i < HEAD) ? z_i + (TURN ^ {ZW{below}}) + {{(ZW - 1) {1'b0}}, below} : z_i;
        t_q <= t_i + (TURN[TW-1:0] ^ {TW{below}}) + {{(TW - 1) {1'b0}}, below};
      end
      wire unused = &{1'b0, step, nearer[YW-1], x_q, y_q, z_q, t_q};  // of the last iterations
    end
  endgenerate
  assign length = g_turn[HEAD].x_i;

  // ---- angle: the two last iterations have their turns added to the sum of both words ----

  localparam integer FROM = LAST - 2;
  localparam [ZW-1:0] BOTH = turn(FROM) + turn(FROM + 1);
  localparam [ZW-1:0] CHANGE = turn(FROM) - turn(FROM + 1);
  wire left_end, exact_end;  // of a vector on the x axis or on the y axis
  wire [1:0] quarters_end;
  wire [1:0] quarters = (y == 0) ? {left, 1'b0} : {y[W+3], 1'b1};  // angle of a vector on an axis
  ik_delay #(.W(4), .N(LAST)) u_end (
      .clk(clk), .d({left, x == 0 || y == 0, quarters}), .q({left_end, exact_end, quarters_end})
  );

  wire signed [TW-1:0] t = g_turn[FROM].t_i;
  reg [ZW-1:0] z;
  reg minus;
  always @(posedge clk) begin
    z <= g_turn[FROM].z_i + {{HEAD{t[TW-1]}}, t};
    minus <= g_turn[FROM].below;
  end

  // Both sums are computed, because the sign of the last Y arrives late; it chooses one of them.
  wire [ZW-1:0] sum_both = z + (BOTH ^ {ZW{minus}}) + {{(ZW - 1) {1'b0}}, minus};
  wire [ZW-1:0] sum_change = z + (CHANGE ^ {ZW{minus}}) + {{(ZW - 1) {1'b0}}, minus};
  wire [ZW-1:0] sum = (g_turn[FROM+1].below == minus) ? sum_both : sum_change;
  always @(posedge clk)
    if (exact_end) angle <= {quarters_end, {(ZW - 2) {1'b0}}};
    else angle <= {sum[ZW-1] ^ left_end, sum[ZW-2:0]};

endmodule

`default_nettype wire

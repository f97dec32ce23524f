// The CORDIC of ik_vector, bit for bit, one iteration per clock; sums of its angles are the joints.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds half up, from 4 guard bits: an angle, doubled or with another one added or subtracted; one turn = 2^W.
// Two stages: the HEAD iterations that change X, and the others. While the second stage finishes a vector, the first
// begins the next.
//     clock 0         load_x     Y = x
//     clock 1                    X = |Y|, the sign is kept
//     clock 2         load_y     Y = y, negated for x < 0; starts the iterations
//     from HEAD + 3   over       hands the vector over; clears X and Y, to which loads add
// With `over` and `again`, the next vector is (present length, length handed over before), and starts at once: for a
// quaternion's (i, j) and then (w, k), its angle is half the tilt. z starts at the rounding constant of the result.
// The first `over` replaces a reset. Nothing changes, and no input has an effect, while go is low.
// Throughput: one vector per HEAD + 4 clocks with go high.
// Latency: LAST - HEAD + 1 clocks from `over` to the angle, which stays until the next `over`.
`default_nettype none

module ik_fold_angle #(
    parameter integer W = 24  // word length, 5 to 32
) (
    input  wire         clk,
    input  wire         go,
    // Load x or y; with load_y or again also the highest bits of the rounding constant and the sign of the angle
    input  wire [W-1:0] word,
    input  wire         load_x,
    input  wire         load_y,
    input  wire         opposite,  // y = -word
    input  wire [  1:0] rounding,  // 10: angle + or - h; 01: angle to h, then angle + h; 00: angle to h
    input  wire         negative,  // minus the angle
    // Hand over
    input  wire         over,
    input  wire         again,     // with over
    input  wire         to_h,      // h = angle of the second stage
    // Result: angle + h or angle - h; plus half a turn
    input  wire         minus,
    input  wire         half,
    output wire [W-1:0] th,
    // For waves and testbenches: X of the first stage; angle of the second, half a turn more, and its sign
    output wire [W+2:0] length,
    output wire [W+3:0] z_node,
    output wire         left_node,
    output wire         negative_node
);

  `include "ik_vector_table.vh"

  localparam integer GUARD = XW - W;
  localparam integer ANGLE = ZW - W;
  localparam integer TW = ZW - HEAD;  // width of the turns of the second stage

  reg [XW-1:0] x_2;  // X in the second stage: the length

  // ---- first stage ----

  reg [XW-1:0] x;
  reg [YW-1:0] y;
  reg [ZW-1:0] z;
  reg [3:0] i;
  reg x_loaded, run, left, flat, upright, negative_1;  // flat: on the x axis; upright: on the y axis
  reg down;  // upright: its angle is minus a quarter of a turn
  reg [1:0] rounding_1;
  wire load = load_x || load_y;

  wire below = y[YW-1];
  wire [YW-1:0] size = y ^ {YW{below}};  // |Y| as a one's complement
  wire [YW-1:0] step = size >> {i, 1'b0};
  wire [YW-1:0] word_half = {{(YW - XW + 1) {word[W-1]}}, word, {(GUARD - 1) {1'b0}}};
  wire subtract = load ? load_y && (left ^ opposite) : !below;
  wire [YW-1:0] term = (load ? word_half : {2'b00, x}) ^ {YW{subtract}};
  wire [YW-1:0] nearer = y + term + {{(YW - 1) {1'b0}}, subtract};

  // z starts at minus the sum of all turns, and iteration i adds its turn twice or not at all.
  function [ZW-1:0] turns_from(input integer first);
    integer k;
    begin
      turns_from = {ZW{1'b0}};
      for (k = first; k < HEAD; k = k + 1) turns_from = turns_from + turn(k);
    end
  endfunction
  localparam [ZW-1:0] ALL = turns_from(0);
  wire [ZW-1:0] turns[0:15];
  genvar n;
  generate
    for (n = 0; n < 16; n = n + 1) begin : g_turn
      localparam [ZW-1:0] TURN = turn(n);
      assign turns[n] = (n < HEAD) ? TURN << 1 : {ZW{1'b0}};
    end
  endgenerate
  wire [ZW-1:0] start = {{W{1'b0}}, rounding_1, {(ANGLE - 2) {1'b0}}};

  // The angle of a vector on an axis is exact: its z is the initial value, on the y axis with a quarter of a turn.
  localparam integer HEAD_END = HEAD - 1;

  always @(posedge clk)
    if (go) begin
      x_loaded <= load_x;
      run   <= load_y || again || (run && !over && i != HEAD_END[3:0]);
      i     <= (run && !over) ? i + 4'd1 : 4'd0;
      if (x_loaded) left <= below;
      if (over && !again) x <= {XW{1'b0}};
      else if (x_loaded || run) x <= x + step[XW-1:0];
      if (again) y <= {2'b00, x_2};
      else if (x_loaded || over) y <= {YW{1'b0}};
      else if (load || run) y <= nearer << 1;
      if (load_y || again) {negative_1, rounding_1} <= {negative, rounding};
      if (load_y || again) z <= {{W{1'b0}}, rounding, {(ANGLE - 2) {1'b0}}} - ALL;
      else if (run && below == negative_1) z <= z + turns[i];
      if (run && i == 4'd0) begin
        flat <= y == {YW{1'b0}};
        upright <= x == {XW{1'b0}};
        down <= below != negative_1;
      end
    end

  // ---- second stage ----

  reg [YW-1:0] y_2;
  reg [ZW-1:0] z_2;
  reg [TW-1:0] t_2;  // turn of the present iteration; 0 for a vector on an axis
  reg [4:0] i_2;
  reg left_2, negative_2;

  localparam [ZW-1:0] TURN_2 = turn(HEAD);
  localparam integer LAST_END = LAST - HEAD - 1;
  wire iterates = !i_2[4];
  wire above_2 = !y_2[YW-1];
  wire [YW-1:0] nearer_2 = y_2 + ({2'b00, x_2} ^ {YW{above_2}}) + {{(YW - 1) {1'b0}}, above_2};

  // Adds turns while it iterates, then h
  reg [ZW-1:0] h;
  reg left_h;
  wire subtract_2 = iterates ? above_2 == negative_2 : minus;
  wire [ZW-1:0] term_2 = (iterates ? {{HEAD{1'b0}}, t_2} : h) ^ {ZW{subtract_2}};
  wire [ZW-1:0] sum = z_2 + term_2 + {{(ZW - 1) {1'b0}}, subtract_2};

  always @(posedge clk)
    if (go) begin
      if (over && flat) z_2 <= start;
      else if (over && upright) z_2 <= start | {down, 1'b1, {(ZW - 2) {1'b0}}};
      else if (over) z_2 <= z;
      else if (iterates) z_2 <= sum;
      if (over) begin
        x_2 <= x;
        y_2 <= y;
        t_2 <= TURN_2[TW-1:0] & {TW{!flat && !upright}};
        i_2 <= 5'd0;
        left_2 <= left;
        negative_2 <= negative_1;
      end else if (iterates) begin
        y_2 <= nearer_2 << 1;
        t_2 <= t_2 >> 1;
        i_2 <= (i_2 == LAST_END[4:0]) ? 5'd16 : i_2 + 5'd1;
      end
      if (to_h) begin
        h <= z_2;
        left_h <= left_2;
      end
    end

  assign th = {sum[ZW-1] ^ half ^ left_2 ^ left_h, sum[ZW-2:ANGLE]};
  assign length = x;
  assign z_node = z_2;
  assign left_node = left_2;
  assign negative_node = negative_2;
  wire unused = &{1'b0, step, nearer[YW-1], nearer_2[YW-1], sum};

endmodule

`default_nettype wire

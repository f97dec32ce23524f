// SPDX-License-Identifier: Apache-2.0
//
// Bench in plain Verilog: sends one hand pose through hand_top in two branches and prints the joints.
`default_nettype none

module hand_tb;

  localparam real ONE = 1073741824.0;  // 2^30
  localparam real DEGREE = 4294967296.0 / 360.0;  // LSBs per degree

  reg clk = 1'b0;
  always #5 clk = !clk;

  reg rst = 1'b1;
  reg go = 1'b0;
  reg [2:0] branch = 3'd0;
  wire signed [31:0] x = $rtoi(0.50 * ONE);
  wire signed [31:0] y = $rtoi(0.10 * ONE);
  wire signed [31:0] z = $rtoi(0.20 * ONE);
  wire signed [31:0] hand_i = $rtoi(0.80 * ONE);
  wire signed [31:0] hand_w = $rtoi(0.60 * ONE);
  wire [31:0] phi = $rtoi(150.0 * DEGREE);

  wire done, bad_hand;
  wire [7*32-1:0] joints;
  wire [7:0] flags;
  wire [6:0] over;

  hand_top u_hand (
      .clk(clk), .rst(rst), .go(go), .x(x), .y(y), .z(z), .hand({32'd0, 32'd0, hand_i, hand_w}), .phi(phi),
      .branch(branch), .done(done), .joints(joints), .flags(flags), .bad_hand(bad_hand), .over(over)
  );

  // Inputs change at the falling edge, away from the core's sampling edge.
  integer k, answers;
  reg signed [31:0] joint;
  initial begin
    repeat (4) @(negedge clk);
    rst = 1'b0;
    @(negedge clk);
    go = 1'b1;
    @(negedge clk);
    branch = 3'd2;
    @(negedge clk);
    go = 1'b0;
    answers = 0;
    for (k = 0; k < 1000 && answers < 2; k = k + 1) begin
      @(negedge clk);
      if (done) begin
        answers = answers + 1;
        show;
      end
    end
    if (answers < 2) $display("no answer");
    $finish;
  end

  task show;
    integer n;
    begin
      $write("th =");
      for (n = 0; n < 7; n = n + 1) begin
        joint = joints[32*n+:32];
        $write(" %.3f", joint / DEGREE);
      end
      $display(" degrees; flags %b %b, over %b", bad_hand, flags, over);
    end
  endtask

endmodule

`default_nettype wire

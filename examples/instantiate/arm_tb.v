// SPDX-License-Identifier: Apache-2.0
//
// Bench in plain Verilog: sends one target through arm_top and prints the result.
`default_nettype none

module arm_tb;

  localparam real ONE = 1073741824.0;  // 2^30
  localparam real TURN = 4294967296.0 / 6.283185307179586;  // LSBs per radian

  reg clk = 1'b0;
  always #5 clk = !clk;

  reg rst = 1'b1;
  reg go = 1'b0;
  reg signed [31:0] x = 0;
  reg signed [31:0] y = 0;
  reg signed [31:0] z = 0;
  reg [31:0] phi = 0;

  wire done;
  wire signed [31:0] qs_w, qs_i, qs_j, qs_k, qe_w, qe_i;
  wire [7:0] flags;

  arm_top u_arm (
      .clk(clk), .rst(rst), .go(go), .x(x), .y(y), .z(z), .phi(phi),
      .done(done), .qs_w(qs_w), .qs_i(qs_i), .qs_j(qs_j), .qs_k(qs_k), .qe_w(qe_w), .qe_i(qe_i), .flags(flags)
  );

  // Inputs change at the falling edge, away from the core's sampling edge.
  integer clocks;
  initial begin
    repeat (4) @(negedge clk);
    rst = 1'b0;
    @(negedge clk);
    x   = $rtoi(0.30 * ONE);
    y   = $rtoi(0.10 * ONE);
    z   = $rtoi(0.05 * ONE);
    phi = $rtoi(2.9 * TURN);
    go  = 1'b1;
    @(negedge clk);
    go = 1'b0;
    clocks = 1;
    while (!done && clocks < 1000) begin
      @(negedge clk);
      clocks = clocks + 1;
    end
    if (!done) $display("no answer");
    $display("Qs = %f %f %f %f", qs_w / ONE, qs_i / ONE, qs_j / ONE, qs_k / ONE);
    $display("Qe = %f %f", qe_w / ONE, qe_i / ONE);
    $display("flags %b, after %0d clocks", flags, clocks);
    $finish;
  end

endmodule

`default_nettype wire

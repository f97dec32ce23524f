// SPDX-License-Identifier: Apache-2.0
// Products, tiles in logic on ECP5, a shift register, a table and a memory that is written. test_fpga.py replaces FACTOR
// by an operand, PRODUCT by 1 for a square, and PART by 1 for products, some of whose registers cannot be packed.

module ik_small (
    input  wire clk,
    input  wire rst,
    input  wire in_valid,
    input  wire [18:0] a,
    input  wire [18:0] b,
    input  wire [21:0] word,
    output reg  out_valid,
    output wire [37:0] p,
    output wire [37:0] square,
    output wire [21:0] late,
    output wire [31:0] y,
    output reg  [12:0] row,
    output reg  [35:0] part
);
  reg [12:0] rom[0:511];
  integer n;
  initial for (n = 0; n < 512; n = n + 1) rom[n] = n * n * 7;
  always @(posedge clk) begin
    out_valid <= in_valid && !rst;
    row <= rom[a[8:0]];
  end
  ik_exact #(.W(19), .SQUARE(PRODUCT)) u_p (.clk(clk), .a(a), .b(b), .p(p));
  ik_exact #(.W(19), .SQUARE(1)) u_square (.clk(clk), .a(FACTOR), .b(19'd0), .p(square));
  ik_quadratic u_y (.clk(clk), .c0({word[14:0], word}), .c1({a, b[6:0]}), .c2(b[14:0]), .u({a[18:12], b[18:2]}),
      .twice(word[0]), .y(y));
  wire [21:0] shifted;
  ik_delay #(.W(22), .N(20)) u_delay (.clk(clk), .d(word), .q(shifted));
  ik_ring #(.W(22), .N(300)) u_ring (.clk(clk), .rst(rst), .d(shifted), .q(late));
  generate
    if (PART) begin : g_part
      // an operand from logic, a register with other readers, products read by logic, a register that starts with 1
      reg signed [17:0] f, g;
      reg [35:0] first, second, third = {36{1'b1}};
      wire signed [17:0] mixed = word[17:0] ^ a[17:0];
      wire signed [17:0] other = word[21:4] ^ b[17:0];
      wire signed [35:0] fm = f * mixed, fg = f * g, gm = g * mixed;
      always @(posedge clk) begin
        f <= b[17:0] & ~word[17:0];
        g <= a[17:0] | word[17:0];
        first <= fm;
        second <= fg;
        third <= mixed * other;
        part <= first ^ second ^ third ^ {g, g} ^ gm ^ {35'd0, ^fg};
      end
    end else begin : g_none
      always @(posedge clk) part <= 36'd0;
    end
  endgenerate
endmodule

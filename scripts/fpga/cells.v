// Exact models of block memories, multipliers and a flip-flop, for netlists of families without models in Yosys.
// SPDX-License-Identifier: Apache-2.0
//
// cells.py replaces the vendors' cells by these modules. A memory has bytes of nine bits and at most two sides on one
// clock. Both sides read what the memory held before the clock.
`default_nettype none

module block_ram #(
    parameter integer UNITS = 2048,    // bytes of nine bits
    parameter [UNITS*9-1:0] INIT = 0,  // lowest byte first
    parameter integer WIDTH_A = 0,     // width of a word: 1, 2, 4, or 9 and its multiples up to 72; 0 unused
    parameter integer WIDTH_B = 0,
    parameter integer REG_A = 0,       // 1: a register behind the output
    parameter integer REG_B = 0,
    parameter integer BYTES_A = 0,     // 1: the lowest bits of the address enable the bytes of a write
    parameter integer BYTES_B = 0,
    parameter integer OLD_A = 1,       // 0: a side that writes outputs the complement of its word, which must not be used
    parameter integer OLD_B = 1
) (
    input  wire        CLK,
    input  wire        ENA,
    input  wire [ 7:0] WEA,  // one bit for each byte
    input  wire [15:0] ADA,  // address of a bit; ninth bits do not count
    input  wire [71:0] DIA,
    output wire [71:0] DOA,
    input  wire        ENB,
    input  wire [ 7:0] WEB,
    input  wire [15:0] ADB,
    input  wire [71:0] DIB,
    output wire [71:0] DOB
);

  reg [8:0] unit[0:UNITS-1];
  integer k;
  initial for (k = 0; k < UNITS; k = k + 1) unit[k] = INIT[9*k+:9];

  // Address of a word's first byte
  function integer first(input [15:0] address, input integer width);
    first = (width < 9) ? address[15:3] : address[15:3] / (width / 9) * (width / 9);
  endfunction

  // Lowest bit of a word of less than a byte
  function integer lowest(input [15:0] address, input integer width);
    lowest = (width < 9) ? address[2:0] / width * width : 0;
  endfunction

  function [71:0] word(input [15:0] address, input integer width);
    integer n;
    begin
      word = 72'd0;
      for (n = 0; 9 * n < width; n = n + 1) word[9*n+:9] = unit[first(address, width)+n];
      word = (word >> lowest(address, width)) & ~({72{1'b1}} << width);
    end
  endfunction

  task write(input [15:0] address, input integer width, input [7:0] enable, input integer bytes, input [71:0] data);
    integer n;
    begin
      for (n = 0; 9 * n < width; n = n + 1) begin
        if (enable[n] && (bytes == 0 || address[n])) begin
          if (width < 9) begin
            unit[first(address, width)] = (unit[first(address, width)]
                & ~((9'd1 << width) - 9'd1 << lowest(address, width))) | (data[8:0] << lowest(address, width));
          end else unit[first(address, width)+n] = data[9*n+:9];
        end
      end
    end
  endtask

  reg [71:0] a = 72'd0, a_q = 72'd0, b = 72'd0, b_q = 72'd0;
  always @(posedge CLK) begin
    a_q <= a;
    b_q <= b;
    if (ENA && WIDTH_A > 0) a <= word(ADA, WIDTH_A) ^ {72{OLD_A == 0 && WEA != 8'd0}};
    if (ENB && WIDTH_B > 0) b <= word(ADB, WIDTH_B) ^ {72{OLD_B == 0 && WEB != 8'd0}};
    if (ENA) write(ADA, WIDTH_A, WEA, BYTES_A, DIA);
    if (ENB) write(ADB, WIDTH_B, WEB, BYTES_B, DIB);
  end
  assign DOA = (REG_A != 0) ? a_q : a;
  assign DOB = (REG_B != 0) ? b_q : b;

endmodule

module product #(
    parameter integer AW = 18,      // width of A
    parameter integer BW = 18,      // width of B
    parameter integer REG_IN = 0,   // 1: registers at A and B
    parameter integer REG_OUT = 0   // 1: a register behind the product
) (
    input  wire             CLK,
    input  wire [   AW-1:0] A,
    input  wire [   BW-1:0] B,
    input  wire             SA,  // 1: signed
    input  wire             SB,
    output wire [AW+BW-1:0] P
);

  reg [AW-1:0] a_q = 0;
  reg [BW-1:0] b_q = 0;
  reg [AW+BW-1:0] p_q = 0;
  wire [AW-1:0] a = (REG_IN != 0) ? a_q : A;
  wire [BW-1:0] b = (REG_IN != 0) ? b_q : B;
  wire signed [AW:0] a_x = {SA & a[AW-1], a};
  wire signed [BW:0] b_x = {SB & b[BW-1], b};
  wire signed [AW+BW+1:0] p = a_x * b_x;
  always @(posedge CLK) begin
    a_q <= A;
    b_q <= B;
    p_q <= p[AW+BW-1:0];
  end
  assign P = (REG_OUT != 0) ? p_q : p[AW+BW-1:0];

endmodule

module flip_flop (
    input  wire CLK,
    input  wire D,
    output reg  Q
);

  always @(posedge CLK) Q <= D;

endmodule

`default_nettype wire

// SPDX-License-Identifier: Apache-2.0
// For scripts/fpga/runs.py: shift registers of xilinx_srl as SRL16E, which Virtex-II Pro has. Yosys's own map uses SRLC32E from
// 18 places on, which it does not have.

module \$__XILINX_SHREG_ (input C, input D, input [31:0] L, input E, output Q, output SO);
  parameter DEPTH = 1;
  parameter [DEPTH-1:0] INIT = 0;
  parameter CLKPOL = 1;
  parameter ENPOL = 2;

  // what a delay line needs: rising edge, enable 1 or none, any start value
  wire _TECHMAP_FAIL_ = CLKPOL != 1 || ENPOL == 0;

  generate
    if (DEPTH <= 16) begin
      localparam [3:0] A = DEPTH - 1;
      SRL16E _TECHMAP_REPLACE_ (.A0(A[0]), .A1(A[1]), .A2(A[2]), .A3(A[3]), .CE(E), .CLK(C), .D(D), .Q(Q));
    end else if (DEPTH <= 20) begin
      // up to four clocks more are flip-flops
      wire [DEPTH-16:0] line;
      SRL16E first (.A0(1'b1), .A1(1'b1), .A2(1'b1), .A3(1'b1), .CE(E), .CLK(C), .D(D), .Q(line[0]));
      genvar k;
      for (k = 1; k <= DEPTH - 16; k = k + 1) begin : rest
        FDRE place (.C(C), .CE(E), .D(line[k-1]), .Q(line[k]), .R(1'b0));
      end
      assign Q = line[DEPTH-16];
    end else begin
      wire next;
      SRL16E first (.A0(1'b1), .A1(1'b1), .A2(1'b1), .A3(1'b1), .CE(E), .CLK(C), .D(D), .Q(next));
      \$__XILINX_SHREG_ #(.DEPTH(DEPTH - 16), .CLKPOL(CLKPOL), .ENPOL(ENPOL)) rest (.C(C), .D(next), .L(L), .E(E), .Q(Q));
    end
  endgenerate
endmodule

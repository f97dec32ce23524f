// Exact modulo 2^W: q = a + b, or a - b with SUB = 1; words of W bits.
// SPDX-License-Identifier: Apache-2.0
//
// For words twice as long as the datapath's: the lower half is added first, the upper half with its carry afterwards.
// Latency: 2 clocks (LAT_WIDE); from a DA more, from b DB more.
`default_nettype none

module ik_wide #(
    parameter integer W   = 66,  // width of the words, at least 3
    parameter integer SUB = 0,   // 1: subtract b
    parameter integer DA  = 0,   // clocks by which a is delayed
    parameter integer DB  = 0    // and b
) (
    input  wire                clk,
    input  wire signed [W-1:0] a,
    input  wire signed [W-1:0] b,
    output reg  signed [W-1:0] q
);

  localparam integer H = W / 2;

  wire [W-1:0] a_in;
  wire [W-1:0] b_in;
  ik_delay #(.W(W), .N(DA)) u_a (.clk(clk), .d(a), .q(a_in));
  ik_delay #(.W(W), .N(DB)) u_b (.clk(clk), .d(b), .q(b_in));

  wire [W-1:0] b_n = (SUB != 0) ? ~b_in : b_in;
  reg carry;
  reg [H-1:0] low;
  reg [W-H-1:0] a_hi;
  reg [W-H-1:0] b_hi;
  always @(posedge clk) begin
    {carry, low} <= {1'b0, a_in[H-1:0]} + {1'b0, b_n[H-1:0]} + ((SUB != 0) ? {{H{1'b0}}, 1'b1} : {(H + 1) {1'b0}});
    a_hi         <= a_in[W-1:H];
    b_hi         <= b_n[W-1:H];
    q            <= {a_hi + b_hi + {{(W - H - 1) {1'b0}}, carry}, low};
  end

endmodule

`default_nettype wire

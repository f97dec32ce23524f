// Shifts a long word left and keeps its upper end: q = d * 2^count / 2^DROP.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down (floor); d signed IW bits, q the low OW bits.
// Throughput: one result per clock.
// Latency: 3 clocks (LAT_SHIFT3): shift by sixteens, by fours, by ones; plus DD from d.
`default_nettype none

module ik_shift3 #(
    parameter integer IW   = 66,  // width of d
    parameter integer DROP = 33,  // low bits dropped, at least 1
    parameter integer OW   = 33,  // width of q
    parameter integer DD   = 0    // delay of d, clocks
) (
    input  wire                 clk,
    input  wire signed [IW-1:0] d,
    input  wire        [   5:0] count,
    output reg  signed [OW-1:0] q
);

  generate
    if (DROP < 1) begin : g_illegal
      ik_shift3_illegal_DROP u_stop ();
    end
  endgenerate

  // Bits above the result are not kept; bits below it are kept because they can still be shifted up.
  localparam integer TOP = DROP + OW;
  wire signed [IW-1:0] d_in;
  ik_delay #(.W(IW), .N(DD)) u_d (.clk(clk), .d(d), .q(d_in));
  wire signed [TOP-1:0] wide;
  generate
    if (TOP > IW) begin : g_longer
      assign wide = {{(TOP - IW) {d_in[IW-1]}}, d_in};
    end else begin : g_shorter
      assign wide = d_in[TOP-1:0];
    end
  endgenerate

  reg signed [TOP-1:0] by_16;
  reg signed [TOP-1:0] by_4;
  reg [3:0] fours;
  reg [1:0] ones;
  wire signed [TOP-1:0] by_1 = by_4 <<< ones;
  always @(posedge clk) begin
    by_16 <= wide <<< {count[5:4], 4'b0000};
    fours <= count[3:0];
    by_4  <= by_16 <<< {fours[3:2], 2'b00};
    ones  <= fours[1:0];
    q     <= by_1[TOP-1:DROP];
  end
  wire unused = &{1'b0, by_1[DROP-1:0]};

endmodule

`default_nettype wire

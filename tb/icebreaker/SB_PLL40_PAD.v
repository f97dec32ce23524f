// Model of the iCE40 PLL. The bench drives PACKAGEPIN at the output frequency; LOCK rises after 63 clocks.
// SPDX-License-Identifier: Apache-2.0
`default_nettype none

module SB_PLL40_PAD #(
    parameter FEEDBACK_PATH = "SIMPLE",
    parameter [3:0] DIVR = 4'd0,
    parameter [6:0] DIVF = 7'd0,
    parameter [2:0] DIVQ = 3'd0,
    parameter [2:0] FILTER_RANGE = 3'd0
) (
    input  wire PACKAGEPIN,
    input  wire RESETB,
    input  wire BYPASS,
    output wire PLLOUTGLOBAL,
    output wire LOCK
);

  assign PLLOUTGLOBAL = PACKAGEPIN;
  wire unused = &{1'b0, FEEDBACK_PATH, DIVR, DIVF, DIVQ, FILTER_RANGE};

  reg [5:0] clocks;
  initial clocks = 6'd0;
  always @(posedge PACKAGEPIN) if (RESETB && !BYPASS && !LOCK) clocks <= clocks + 6'd1;
  assign LOCK = &clocks;

endmodule

`default_nettype wire

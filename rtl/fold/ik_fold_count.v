// Shift counts of the folded datapath: n = (base or n) +- (1 or 2) x the pair count of a normalization.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; unsigned integers modulo 64.
// Throughput: one step per clock with go high.
// Latency: 1 clock to n, 2 clocks to the outputs `none` and `unscaled`.
`default_nettype none

module ik_fold_count #(
    parameter integer D = 33  // width of a multiplier operand
) (
    input  wire       clk,
    input  wire       go,
    // Step
    input  wire [2:0] base,
    input  wire [2:0] pair,   // selects the pair count; N_E_NONE: n is kept
    input  wire       minus,
    input  wire       twice,
    input  wire [2:0] load,   // pair count to load from `pairs`
    // Pair count of the current normalization
    input  wire [5:0] pairs,
    // Count and conditions
    output reg  [5:0] n,
    output reg        none,   // n = 0
    output reg        unscaled,  // n < D: the power of two of n is stored as it is
    output reg        low    // m_q is the mantissa of four times the squared length
);

  `include "ik_fold_codes.vh"

  reg [5:0] e_rho, e_s, e_far, e_near, e_1, e_2, e_q;
  always @(posedge clk)
    if (go)
      case (load)
        E_SET_E_RHO: e_rho <= pairs;
        E_SET_E_S: e_s <= pairs;
        E_SET_E_FAR: e_far <= pairs;
        E_SET_E_NEAR: e_near <= pairs;
        E_SET_E_1: e_1 <= pairs;
        E_SET_E_2: e_2 <= pairs;
        E_SET_E_Q: e_q <= pairs;
        default: ;
      endcase

  reg [5:0] e;
  always @*
    case (pair)
      N_E_E_RHO: e = e_rho;
      N_E_E_S: e = e_s;
      N_E_E_FAR: e = e_far;
      N_E_E_NEAR: e = e_near;
      N_E_E_1: e = e_1;
      default: e = e_2;
    endcase
  reg [5:0] from;
  always @*
    case (base)
      N_BASE_1: from = 6'd1;
      N_BASE_2: from = 6'd2;
      N_BASE_4: from = 6'd4;
      N_BASE_MINUS_2: from = 6'd62;
      default: from = n;
    endcase
  wire [5:0] term = twice ? {e[4:0], 1'b0} : e;
  always @(posedge clk) if (go && pair != N_E_NONE) n <= from + (minus ? ~term : term) + {5'd0, minus};

  localparam [63:0] UNSCALED = (64'd1 << D) - 64'd1;
  always @(posedge clk)
    if (go) begin
      none <= n == 6'd0;
      unscaled <= UNSCALED[n];
      low  <= e_q == 6'd2;
    end

endmodule

`default_nettype wire

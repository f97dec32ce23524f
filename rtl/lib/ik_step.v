// Steps of one joint from its reference to two angles, for the choice of a branch.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds towards 0; binary angles, one turn = 2^W; a step has STEP bits, one turn = 2^STEP, and above them a bit that is
// set, with all others, for an angle outside its limits.
// The two angles are th, and th plus half a turn or, with NEGATED = 1, -th. An angle is counted from the lower limit
// upwards, so that a step never crosses the gap between the limits. high = low - 1: no limits; then the step is the
// shorter way around.
// Throughput: one joint per clock.
// Latency: 1 clock to ref_at and at, 2 to out and gap, 3 to step.
`default_nettype none

module ik_step #(
    parameter integer W       = 32,  // word length, at least STEP
    parameter integer STEP    = 12,  // bits of a step
    parameter integer NEGATED = 0    // second angle: 0 th plus half a turn, 1 -th
) (
    input  wire                clk,
    input  wire       [ W-1:0] th,
    input  wire       [ W-1:0] ref_th,  // valid with th
    input  wire       [ W-1:0] low,     // limits; static
    input  wire       [ W-1:0] high,
    // Arcs from the lower limit, of the reference and of both angles
    output reg        [ W-1:0] ref_at,
    output reg        [ W-1:0] at_0,
    output reg        [ W-1:0] at_1,
    // Outside the limits; difference from the reference
    output reg                 out_0,
    output reg                 out_1,
    output reg signed [   W:0] gap_0,
    output reg signed [   W:0] gap_1,
    // Steps
    output reg        [STEP:0] step_0,
    output reg        [STEP:0] step_1
);

  localparam [W-1:0] HALF = {1'b1, {(W - 1) {1'b0}}};

  reg [W-1:0] span;  // static, as the limits are
  wire whole = &span;
  // One's complement of a negative difference, modulo a turn for a joint without limits; its leading bits
  wire [W-1:0] size_0 = gap_0[W-1:0] ^ {W{whole ? gap_0[W-1] : gap_0[W]}};
  wire [W-1:0] size_1 = gap_1[W-1:0] ^ {W{whole ? gap_1[W-1] : gap_1[W]}};
  always @(posedge clk) begin
    span   <= high - low;
    ref_at <= ref_th - low;
    at_0   <= th - low;
    at_1   <= (NEGATED != 0) ? -th - low : (th - low) ^ HALF;
    out_0  <= at_0 > span;
    out_1  <= at_1 > span;
    gap_0  <= {1'b0, at_0} - {1'b0, ref_at};
    gap_1  <= {1'b0, at_1} - {1'b0, ref_at};
    step_0 <= {out_0, size_0[W-1-:STEP]} | {(STEP + 1) {out_0}};
    step_1 <= {out_1, size_1[W-1-:STEP]} | {(STEP + 1) {out_1}};
  end
  wire unused = &{1'b0, size_0, size_1};

endmodule

`default_nettype wire
